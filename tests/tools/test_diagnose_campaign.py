"""`diagnose` on made-up campaigns in the layout of a measured one: several causes at once, none at all, and courses."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from gearheat.scenarios.load import RIGS
from gearheat.scenarios.measured import Campaign
from gearheat.tools.diagnose import campaign_model, logged
from gearheat.tools.diagnose.campaign_model import CampaignModel, Rig
from gearheat.tools.diagnose.gain import SCHEMES
from gearheat.tools.diagnose.infer import infer
from gearheat.tools.diagnose.inputs import Inputs, Request, read_inputs
from gearheat.tools.diagnose.problem import measured_readings
from gearheat.tools.diagnose.scatter import SCATTER
from gearheat.tools.diagnose.series import Series
from gearheat.tools.diagnose.weigh import family_of
from gearheat.tools.effects.taxonomy import CAUSES

LAYOUT, CARD = RIGS / "planetary" / "measured.csv", RIGS / "planetary" / "card.json"
#: Causes that a hypothesis may hold.
MOST = 6
#: What is wrong with the made-up campaign: loss [W], change over the running order, reading less truth [K].
LOSS, CHANGE, WALL = 110.0, -0.30, 2.5
#: Standard deviations of the readings: temperatures [K], loss torque [N.m], cooling of the days.
NOISE, TORQUE, DAY = 0.35, 1.4, 0.015


@pytest.fixture(scope="module")
def layout() -> Inputs:
    return read_inputs(Request(LAYOUT, card=CARD))


@pytest.fixture(scope="module")
def rig(layout) -> Rig:
    return Rig(layout.spec)


def middle(cause: str, size: float, **shares: float) -> dict[str, float]:
    """Parameters of a cause in the middle of its priors, or at given shares of them."""
    c = CAUSES[cause]
    form = c.forms(np.array([[shares.get(shape.name, 0.5) for shape in c.shapes]]))[0]
    return {**form, c.size.name: size}


def made(path: Path, layout: Inputs, rig: Rig, seed: int, *, faulty: bool) -> Path:
    """A campaign at the conditions of the layout: a rig that differs a little, days that differ, noisy probes."""
    model, rng = CampaignModel(rig, layout.data, layout.oils), np.random.default_rng(seed)
    day = 1 + DAY * rng.standard_normal(len(model.tests))
    values = {"gear_set.k_mu": 1.05 * rig.base["gear_set.k_mu"], "foot.G": rig.base["foot.G"] * day}
    values["cooling.A"] = 0.97 * rig.base["cooling.A"] * day
    if faulty:
        wrong = {"losses.churning": middle("losses.churning", LOSS)}
        wrong["procedure.order"] = middle("procedure.order", CHANGE, target=0.2)
        for cause, theta in wrong.items():
            values |= CAUSES[cause].values({**rig.base, **values}, theta, model.rows)
    (shown,) = model.simulate([values])
    place = {reading.point: k for k, reading in enumerate(model.readings)}
    with LAYOUT.open(newline="") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        k, sign = place[int(row["point"])], 1 if row["direction"] == "1" else -1
        for column, bias in (("T_oil", 0.0), ("T_oil2", 0.0), ("T_wall", WALL if faulty else 0.0)):
            row[f"{column}_C"] = f"{shown[column][k] - 273.15 + bias + NOISE * rng.standard_normal():.2f}"
        loss = shown["loss"][k] + TORQUE * rng.standard_normal()
        row["T_sun_Nm"] = f"{(float(row['T_carrier_Nm']) - sign * loss) / 4:.3f}"
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    return path


def diagnosed(path: Path):
    return infer(read_inputs(Request(path, card=CARD, most=MOST)), alpha=0.05, seed=1)[0]


@pytest.fixture(scope="module")
def faulty(tmp_path_factory, layout, rig):
    return diagnosed(made(tmp_path_factory.mktemp("faulty") / "DATA.csv", layout, rig, 7, faulty=True))


@pytest.fixture(scope="module")
def healthy(tmp_path_factory, layout, rig):
    return diagnosed(made(tmp_path_factory.mktemp("healthy") / "DATA.csv", layout, rig, 5, faulty=False))


def parameter(findings, cause: str, name: str):
    named = next(c for c in findings.causes if c.id == cause)
    return next(e for e in named.parameters if e.name == name)


def test_three_causes_that_act_together_are_found_together(faulty):
    assert faulty.verdict == "explained" and faulty.p_any < 0.001 and faulty.p_adequacy > 0.05
    top = faulty.hypotheses[0]
    wanted = {family_of(c) for c in ("losses.churning", "procedure.order", "sensor.wall_temp.offset")}
    assert {family_of(c) for c in top.causes} - {SCATTER} == wanted
    assert top.probability > 0.9


def test_the_sizes_of_all_three_are_told(faulty):
    top = faulty.hypotheses[0]
    order = parameter(faulty, "procedure.order", "change")
    assert order.low <= CHANGE <= order.high or abs(order.value - CHANGE) < 0.06
    assert order.high < -0.2
    wall = parameter(faulty, "sensor.wall_temp.offset", "offset")
    assert wall.low <= WALL <= wall.high and wall.low > 0.5
    if "losses.churning" in top.causes:  # another of its class has another measure
        loss = parameter(faulty, "losses.churning", "P_ref")
        assert loss.low <= LOSS <= loss.high and loss.low > 30.0


def test_held_out_errors_are_told_for_every_scheme_that_the_layout_has(faulty):
    assert faulty.gain.scheme == "leave-one-operating-point" and faulty.gain.n == 72
    grouped = {g.scheme: g for g in faulty.grouped}
    assert tuple(grouped) == SCHEMES
    assert [grouped[s].n for s in SCHEMES] == [72, 72, 72, 30]  # the other oils have 15 tests
    for g in (faulty.gain, *faulty.grouped):
        assert set(g.rivals) == {"constant cooling", "linear in speed and load"}
        assert g.ratio_ci90[0] < g.rmse_after / g.rmse_before < g.ratio_ci90[1]
        assert g.rmse_after < min(g.rivals.values()), g.scheme


@pytest.mark.parametrize("scheme", ["leave-one-speed", "leave-one-load", "first-oil-to-others"])
def test_what_was_found_halves_the_errors_on_what_was_held_out(faulty, scheme):
    assert faulty.gain.rmse_after < 0.5 * faulty.gain.rmse_before
    held = next(g for g in faulty.grouped if g.scheme == scheme)
    assert held.rmse_after < 0.5 * held.rmse_before


def test_a_healthy_campaign_stays_consistent_however_many_causes_may_act(healthy):
    assert healthy.verdict == "consistent" and healthy.p_any > 0.05
    assert healthy.hypotheses[0].causes == () and healthy.hypotheses[0].probability > 0.5
    assert all(len(h.causes) <= 2 for h in healthy.hypotheses)
    for g in (healthy.gain, *healthy.grouped):
        assert g.rmse_after < 1.1 * g.rmse_before < 1.1, g.scheme  # nothing is made worse by causes that are not there
    assert healthy.gain.rmse_after < 1.5 * healthy.gain.noise_floor


# ------------------------------------------------------------------------------------------------------------- courses


def test_what_curves_through_samples_bend_they_bend_in_data_and_model_alike(layout, rig, monkeypatch):
    """Logged without any noise, the courses at their places are those of the model there."""
    monkeypatch.setattr(campaign_model, "TOLERANCE", 1e-5)
    tests = layout.data.tests()[:2]
    readings = tuple(r for r in layout.data.readings if r.test in {t.number for t in tests})
    data = Campaign(layout.data.name, readings, layout.data.protocol)
    shares = np.array([1.0, *np.arange(3.0, 49.0, 3.0)]) / 48.0  # so few that a curve through them bends
    time = np.concatenate([14400.0 * shares, 14400.0 + 300.0 + 5400.0 * shares])
    columns = {"time_s": time, "direction": np.repeat([1, 2], len(shares))}

    def logged_as(T_oil, T_wall) -> CampaignModel:
        series = {t.number: {**columns, "T_oil_C": T_oil[k], "T_wall_C": T_wall[k]} for k, t in enumerate(tests)}
        return CampaignModel(rig, data, layout.oils, series=Series("SERIES.csv", series))

    with monkeypatch.context() as every_sample:  # a place, so that the model says what all of them are
        every_sample.setattr(logged, "SHARES", tuple(shares))
        every_sample.setattr(logged, "MANY", 1000)  # and no curve
        blank = logged_as([np.zeros(34)] * 2, [np.zeros(34)] * 2)
        assert blank.samples == 4 * len(shares)
        (true,) = blank.simulate([{}])
        found = {c: true[c][blank.n :].reshape(2, 34) - 273.15 for c in ("T_oil", "T_wall")}
    model = logged_as(found["T_oil"], found["T_wall"])
    (shown,) = model.simulate([{}])
    measured = measured_readings(model)
    for c in ("T_oil", "T_wall"):
        there = shown[c][model.n :]
        assert np.abs(measured[f"{c} course"][1] - there).max() < 0.001
        lines = [np.interp(logged.SHARES, shares, half) for half in found[c].reshape(4, -1)]
        assert np.abs(np.ravel(lines) + 273.15 - there).max() > 0.005
    assert measured["dwell"][1] == pytest.approx(np.zeros(4), abs=1e-9)
