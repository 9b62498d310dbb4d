"""Logged courses: exact derivatives along them, small errors, and what they tell that steady readings do not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from gearheat.model.parts import PARTS
from gearheat.model.parts.free_form import EXTRA_PARTS
from gearheat.scenarios.load import load
from gearheat.scenarios.measured.card import Card
from gearheat.scenarios.measured.read import read_campaign
from gearheat.scenarios.measured.table import PLACES, Campaign, Course, Series
from gearheat.tools.diagnose.infer.fit import Begin, fitted
from gearheat.tools.diagnose.infer.problem import Problem
from gearheat.tools.diagnose.infer.screen import screened
from gearheat.tools.diagnose.model import march
from gearheat.tools.diagnose.model.formula import Formula, Parts
from gearheat.tools.diagnose.model.observe import Observed
from gearheat.tools.diagnose.setting import Setting, setting
from made_tables import made, written


@pytest.fixture(scope="module")
def prepared(tmp_path_factory) -> Setting:
    """A campaign of six tests in both directions."""
    rig, card = load("planetary", PARTS | EXTRA_PARTS), Card()
    columns = made(rig, directions=(1, 2))
    n = 12
    place = {"test": [k // 2 + 1 for k in range(n)], "direction": [1, 2] * 6, "dwell_min": [240, 90] * 6}
    table = {**place, **columns}
    path = written(tmp_path_factory.mktemp("courses") / "data.csv", table)
    return setting(rig, card, read_campaign(path, rig, card))


def logged(c: Campaign) -> Campaign:
    """With courses of zeros."""
    names = [s.name for s in c.read if s.kind.endswith("_temp")]
    scatter = np.diag(np.full(len(PLACES), 0.3))
    courses = tuple(Course(row, name, np.zeros(len(PLACES)), scatter) for row in range(c.n) for name in names)
    return replace(c, series=Series("S.csv", courses, c.dwell))


def observed(s: Setting, campaign: Campaign) -> Observed:
    return s.problem.data.another(campaign)


def formula(s: Setting, cause: str, form: str = "") -> Formula:
    return next(f for f in s.formulas if f.cause.id == cause and form in f.form.name)


@pytest.fixture(scope="module")
def measured(prepared: Setting):
    """A campaign as measured where something acts: readings, courses and dwells with their scatter."""

    def of(parts: Parts, seed: int, dwell: float | None = None) -> Campaign:
        o, rng = observed(prepared, logged(prepared.problem.data.campaign)), np.random.default_rng(seed)
        c, e = o.campaign, o.entries
        shown = o.shown_by(np.zeros(len(o.nuisances)), parts)
        found = shown + e.repeat * rng.standard_normal(o.m) * np.where(o.kind < len(o.read), 1.0, np.sqrt(0.3))
        values = dict(c.values)
        for i, sensor in enumerate(o.read):
            values[sensor.name] = found[o.kind == i]
        courses = tuple(
            replace(course, values=found[(o.kind == len(o.read) + i) & (o.row == course.row)])
            for course in c.series.courses
            for i, sensor in enumerate(o.read)
            if sensor.name == course.sensor
        )
        held = c.dwell * (1 + (shown[e.sensor < 0] if dwell is None else dwell))
        return replace(c, values=values, series=replace(c.series, courses=courses, dwell=held))

    return of


def log_bf(s: Setting, campaign: Campaign) -> dict[str, float]:
    """Log Bayes factor of the best form of each cause at the first look."""
    problem = Problem([observed(s, campaign)], 0.015)
    null = fitted(problem, (), Begin(np.zeros(problem.nz)))
    found = screened(problem, null.look, null.linear(problem), s.formulas).by_form(len(s.formulas))
    best: dict[str, float] = {}
    for f, log in zip(s.formulas, found, strict=True):
        best[f.cause.id] = max(best.get(f.cause.id, -np.inf), float(log))
    return best


def test_derivatives_along_courses_are_those_of_what_is_shown(prepared) -> None:
    o = observed(prepared, logged(prepared.problem.data.campaign))
    names = ("thermal.mass", "sensor.ambient.bias", "sensor.oil_temp.gain", "procedure.not_stationary")
    acting = [formula(prepared, name) for name in names]
    z = np.linspace(-0.5, 0.5, len(o.nuisances))
    ts = [np.r_[0.4, np.full(f.size - 1, 0.1)] for f in acting]
    found = o.at(z, list(zip(acting, ts, strict=True)))
    x = np.concatenate([z, *ts])
    cuts = np.cumsum([len(z), *map(len, ts)])[:-1]

    def shown(k: int, h: float) -> np.ndarray:
        own, *others = np.split(x + h * (np.arange(len(x)) == k), cuts)
        return o.shown_by(own, list(zip(acting, others, strict=True)))

    assert found.shown == pytest.approx(o.shown_by(z, list(zip(acting, ts, strict=True))), abs=0)
    for k in (0, *range(len(z), len(x))):
        expected = (shown(k, 1e-3) - shown(k, -1e-3)) / 2e-3
        assert found.by[:, k] == pytest.approx(expected, abs=2e-5 * np.abs(expected).max() + 1e-6)


def test_candidates_along_courses_are_as_when_they_act(prepared) -> None:
    o = observed(prepared, logged(prepared.problem.data.campaign))
    z = np.zeros(len(o.nuisances))
    candidates = [(f, np.zeros(f.size)) for f in map(lambda n: formula(prepared, n), ("thermal.mass", "cooling.air"))]
    candidates.append((formula(prepared, "procedure.not_stationary"), np.zeros(1)))
    candidates.append((formula(prepared, "sensor.wall_temp.offset"), np.zeros(1)))
    found = o.tangents(z, [], candidates)
    for k, one in enumerate(candidates):
        assert found[:, k] == pytest.approx(o.at(z, [one]).by[:, len(z)], abs=1e-9)


def test_few_steps_are_enough_along_courses(prepared, monkeypatch) -> None:
    campaign = logged(prepared.problem.data.campaign)
    o, z = observed(prepared, campaign), np.zeros(len(prepared.problem.data.nuisances))
    found = o.shown_by(z, [])
    many = np.unique(np.r_[np.linspace(0, 1, 201)[1:] ** 2, PLACES])
    monkeypatch.setattr(march, "LOGGED", many)
    monkeypatch.setattr(march, "READ", tuple(np.flatnonzero(np.isin(many, [*PLACES, 1.0])).tolist()))
    assert found == pytest.approx(observed(prepared, campaign).shown_by(z, []), abs=0.12)


def test_courses_keep_their_own_clock(prepared) -> None:
    o = observed(prepared, logged(prepared.problem.data.campaign))
    z, early = np.zeros(len(o.nuisances)), formula(prepared, "procedure.not_stationary")
    before, after = o.shown_by(z, []), o.shown_by(z, [(early, np.array([1.0]))])
    ends, dwells = o.kind < len(o.read), o.entries.sensor < 0
    assert np.array_equal(before[~ends & ~dwells], after[~ends & ~dwells])
    assert np.abs(after - before)[ends].max() > 0.2
    assert after[dwells] == pytest.approx(-0.3, abs=0.01)


def test_all_terms_of_courses_are_covariances(prepared) -> None:
    problem = Problem([observed(prepared, logged(prepared.problem.data.campaign)) for _ in range(2)], 0.015)
    look = problem.look(np.zeros(problem.nz))
    noise = problem.noise(look)
    found = {t.name: noise.scaled([t]) for t in noise.terms}
    assert {"courses", "model of courses", "starts", "dwells as logged", "remainder"} <= found.keys()
    for matrix in found.values():
        assert np.abs(matrix - matrix.T).max() < 1e-12 and np.linalg.eigvalsh(matrix).min() > -1e-8
    half = problem.campaigns[0].m
    for name in ("courses", "model of courses", "starts"):
        assert not found[name][:half, half:].any() and found[name].any()


def test_other_capacities_are_found_with_courses_alone(prepared, measured) -> None:
    mass = formula(prepared, "thermal.mass")
    campaign = measured([(mass, np.r_[1.8, np.zeros(mass.size - 1)])], seed=1)
    with_courses, without = (log_bf(prepared, c) for c in (campaign, replace(campaign, series=None)))
    assert max(with_courses, key=lambda name: with_courses[name]) == "thermal.mass"
    assert with_courses["thermal.mass"] > 8 and without["thermal.mass"] < 2


def test_a_logged_dwell_tells_whether_readings_were_taken_early(prepared, measured) -> None:
    early = [(formula(prepared, "procedure.not_stationary"), np.array([0.6]))]
    told, denied = (log_bf(prepared, measured(early, seed=2, dwell=d)) for d in (None, 0.0))
    assert max(told, key=lambda name: told[name]) == "procedure.not_stationary"
    assert told["procedure.not_stationary"] > 50
    assert denied["procedure.not_stationary"] < 0
