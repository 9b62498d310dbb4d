"""From a fitted hypothesis to pictures, calibrated values, the extended rig, repeated points and single channels."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from gearheat.scenarios.load import load
from gearheat.tools.diagnose.answer import pictures
from gearheat.tools.diagnose.answer.estimate import posterior
from gearheat.tools.diagnose.answer.evidence import RepeatedPoint
from gearheat.tools.diagnose.answer.quality import list_repeats
from gearheat.tools.diagnose.infer.fit import Begin, fitted
from gearheat.tools.diagnose.infer.found import Found, Hypothesis
from gearheat.tools.diagnose.infer.prior import Prior
from gearheat.tools.diagnose.infer.problem import Acting
from gearheat.tools.diagnose.infer.screen import screened
from gearheat.tools.diagnose.report import extension
from gearheat.tools.diagnose.request import Inputs, Request, read
from gearheat.tools.diagnose.setting import Setting, setting
from gearheat.tools.solve.sampling import reasons
from gearheat.tools.solve.settings import flat_of

CASE = Path(__file__).parents[2] / "challenge" / "practice_cases" / "foreign_006"
CAUSE = "losses.churning"


@dataclass(frozen=True)
class Made:
    """A campaign with one cause fitted."""

    inputs: Inputs
    setting: Setting
    found: Found
    h: Hypothesis


@pytest.fixture(scope="module")
def made() -> Made:
    """The calibrated rig, and churning beside it."""
    request = Request("planetary", CASE / "data.csv", card=CASE / "card.json")
    inputs = read(request)
    assert inputs.data is not None
    made = setting(inputs.scenario, inputs.card, inputs.data)
    null = fitted(made.problem, (), Begin(np.zeros(made.problem.nz)))
    formula = next(f for f in made.formulas if f.cause.id == CAUSE)
    start = Acting(formula, np.r_[0.5, np.zeros(formula.size - 1)])
    fit = fitted(made.problem, [start], Begin(null.look.z, null.noise.scales))
    h = Hypothesis((CAUSE,), fit, 0.0)
    nothing = Hypothesis((), null, -3.0)
    chances = np.array([0.9, 0.1])
    prior = Prior(f.cause for f in made.formulas)
    found = Found(made.problem, made.formulas, null, None, (h, nothing), chances, 0.01, 2.0, np.zeros(9), 0.5, prior)  # type: ignore[arg-type]
    return Made(inputs, made, found, h)


def test_a_picture_shows_what_the_cause_takes_away(made: Made) -> None:
    rows = pictures.rows(made.found, made.h)
    (one,) = pictures.pictures(made.found, made.h, rows.quantities)
    assert one.cause == CAUSE
    assert rows.quantities[one.quantity].unit == "rpm"
    values = rows.channels[one.channel]
    after = np.array(values.measured) - np.array(values.extended)  # type: ignore[operator]
    assert np.array(one.after, dtype=float) == pytest.approx(after.astype(float), abs=2e-3)
    assert one.before != one.after


def test_what_is_not_measured_is_drawn_against_the_running_order(made: Made) -> None:
    (one,) = pictures.pictures(made.found, made.h, {"order"})
    assert one.quantity == "order"


def test_the_extended_rig_has_the_calibrated_values_and_the_cause(made: Made, tmp_path: Path) -> None:
    (path := tmp_path / "extended.toml").write_text(extension.rig_file(made.setting, made.found, made.h)[0])
    rig = load(path)
    theta = made.h.fit.look.acting[0].formula.theta(made.h.fit.look.acting[0].t)
    assert rig.spec.part("found_churning").values["P_ref"] == pytest.approx(theta["P_ref"])
    for told in extension.calibrated(made.setting, made.found, made.h):
        part, _, key = told.path.rpartition(".")
        assert told.extended is not None
        if not told.path.endswith(".V"):  # litres
            assert rig.spec.part(part).values[key] == pytest.approx(told.extended, rel=1e-4)


def test_the_extended_rig_says_how_uncertain_the_data_leave_it(made: Made, tmp_path: Path) -> None:
    """Every parameter by the posterior: of a factor its logarithm's, of the cause its size's, whatever goes with it."""
    (path := tmp_path / "extended.toml").write_text(extension.rig_file(made.setting, made.found, made.h)[0])
    rig = load(path)
    sd, problem = np.sqrt(np.diag(posterior(made.found.problem, made.h.fit))), made.found.problem
    (acting,) = made.h.fit.look.acting
    told = rig.standard_uncertainties
    assert told["found_churning.P_ref"] == pytest.approx(acting.formula.cause.size.sd * sd[problem.nz], rel=1e-2)
    k, mesh = next((k, n) for k, n in enumerate(problem.data.nuisances) if "gear_set.k_mu" in n.paths)
    factor = rig.spec.part("gear_set").values["k_mu"] * mesh.paths["gear_set.k_mu"] * mesh.sd
    assert told["gear_set.k_mu"] == pytest.approx(factor * sd[k], rel=1e-2)
    assert sd[k] < 0.99, "the data tell something of it"
    found = {reason.name: reason.changes for reason in reasons(rig, flat_of(rig))}
    assert found.keys() >= rig.joint_uncertainties.keys() and "mesh friction" not in found


def test_repeated_points_are_told_in_running_order(made: Made) -> None:
    data = made.found.problem.data.campaign
    again = {s: v[[0, 1, 2, 3, 0, 1]] for s, v in data.values.items()}
    oil = next(s.name for s in data.read if s.kind == "oil_temp")
    first = [0, 1, 2, 3, 0, 1]
    short = replace(
        data, values=again, test=np.array([0, 0, 1, 1, 2, 2]), order=np.array([1.0, 2.0, 3.0]),
        direction=data.direction[first], dwell=data.dwell[first], stop=data.stop[first], oil=("A",) * 3,
        mounting=("",) * 3, T_start=data.T_start[:3], room_start=data.room_start[:3], humidity=data.humidity[:3],
        date=("",) * 3, lines=data.lines[first], points=data.points[first],
    )  # fmt: skip
    o = made.found.problem.data.another(short)
    mine = o.kind == [s.name for s in o.read].index(oil)
    shown = o.measured + o.row - np.where(mine & (o.row == 4), 1.0, 0.0) - np.where(o.row > 3, 4, 0)  # another room

    def told(*aside: int) -> dict[str, RepeatedPoint]:
        problem = SimpleNamespace(data=o, measured=o.measured, own=slice(None), entries_aside=list(aside))
        found = SimpleNamespace(problem=problem, null=SimpleNamespace(look=SimpleNamespace(shown=shown)))
        return {p.channel: p for p in list_repeats(found)}

    one = told()[oil]
    assert [r.test for r in one.repeats] == [1, 3]
    assert [r.sum for r in one.repeats] == pytest.approx([-0.25, 0.25])
    assert [r.difference for r in one.repeats] == pytest.approx([-0.25, 0.25])
    assert all(r.sum == pytest.approx(0.0) for name, p in told().items() if name != oil for r in p.repeats)
    assert one.condition.startswith("A, ")
    assert "rpm" in one.condition
    gross = np.flatnonzero(mine & (o.row < 2))
    assert set(told(*gross)) == {s.name for s in o.read} - {oil}, "what is set aside tells nothing"


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_points_repeated_in_one_direction_are_told_in_either(made: Made, way: float) -> None:
    found = made.found
    c, n = found.problem.data.campaign, 4
    short = replace(
        c, values={name: v[[0, 1, 0, 1]] for name, v in c.values.items()}, test=np.arange(n),
        order=np.arange(1.0, n + 1), direction=np.full(n, way), dwell=c.dwell[:n], stop=np.zeros(n), oil=("A",) * n,
        mounting=("",) * n, T_start=c.T_start[:n], room_start=c.room_start[:n], humidity=c.humidity[:n],
        date=("",) * n, lines=c.lines[:n], points=c.points[:n],
    )  # fmt: skip
    o = found.problem.data.another(short)
    problem = SimpleNamespace(data=o, measured=o.measured, own=slice(None), entries_aside=[])
    null = SimpleNamespace(look=SimpleNamespace(shown=o.measured - o.row))
    told = [p for p in list_repeats(SimpleNamespace(problem=problem, null=null)) if p.channel == "T_oil"]
    assert [[r.sum for r in p.repeats] for p in told] == [[-1.0, 1.0]] * 2
    assert all(r.difference is None for p in told for r in p.repeats)
    one = o.campaign.sensor("T_oil").repeat_sd, next(s.repeat_sd for s in o.given if s.kind == "ambient")
    assert [p.card for p in told] == pytest.approx([np.hypot(*one)] * 2, rel=1e-4)


def test_the_channel_that_errs_says_so_on_its_own(made: Made) -> None:
    problem = copy(made.setting.problem)
    o, null = problem.data, made.found.null
    torque = next(i for i, s in enumerate(o.read) if s.kind == "torque")
    rng = np.random.default_rng(1)
    sd = np.array([s.repeat_sd for s in o.read])[o.kind]
    zero = np.where(o.kind == torque, 20 * sd, 0.0)
    problem.measured = null.look.shown + sd * rng.standard_normal(problem.m) + zero
    ids = ("sensor.torque.offset", "sensor.oil_temp.offset", CAUSE)
    formulas = tuple(f for f in made.setting.formulas if f.cause.id in ids and not f.form.spread)
    first = screened(problem, null.look, null.linear(problem), formulas)
    found = replace(made.found, problem=problem, formulas=formulas, first=first)
    told = {v.channel: v for v in pictures.views(found)}
    assert set(told) == {s.name for s in o.read}
    said = told[o.read[torque].name]
    assert said.asks.startswith("torque ")
    assert ", given oil temperature" in said.asks
    assert said.causes[0].id == "sensor.torque.offset"
    assert said.nothing is not None
    assert said.nothing < 0.05
    assert len(said.deviation) == len(said.order) == len(said.direction) == int((o.kind == torque).sum())
    assert abs(np.mean(np.array(said.deviation, dtype=float))) > 10 * o.read[torque].repeat_sd
    oil = next(v for v in told.values() if v.asks.startswith("oil temperature"))
    assert "against the other thermometers" in oil.asks
