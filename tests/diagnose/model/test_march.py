"""Marches through tests: exact derivatives, small errors, and runs that do not touch each other."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from itertools import product
from pathlib import Path

import gearheat as gh
import numpy as np
import pytest
from gearheat.model.machines.roles import Roles
from gearheat.model.machines.spec import PartSpec
from gearheat.model.run.steady import steady
from gearheat.scenarios.load import load
from gearheat.scenarios.measured.card import Card, read_card
from gearheat.scenarios.measured.read import read_campaign
from gearheat.scenarios.measured.table import Campaign
from gearheat.scenarios.nuisances import Nuisance
from gearheat.tools.diagnose.library.cause import Cause, Form, Shape, Size
from gearheat.tools.diagnose.model import march as marching
from gearheat.tools.diagnose.model.formula import Formula
from gearheat.tools.diagnose.model.march import STEADY, Phases, march
from gearheat.tools.diagnose.model.observe import Observed
from gearheat.tools.diagnose.model.plant import Plant, with_additions
from gearheat.tools.diagnose.request import Request, read
from gearheat.tools.diagnose.setting import setting

FOLDER = Path(marching.__file__).parents[3] / "scenarios" / "rigs" / "planetary"
SIZE = Size("size", "1", "", 0.1, -1.0, 1.0)
FRICTION, BATH = Nuisance("mu", {"gear_set.k_mu": 1.0}, 0.2, 0.2), Nuisance("c", {"oil.c_p": 1.0}, 0.3, 0.3)
EXTRA = {"G_ref": 0.0, "dT_ref": 30.0, "e": 0.0, "w_ref": 10.0, "tau_ref": 1000.0, "c": 0.0, "forward": 1.0}
EXTRA |= {"backward": 1.0, "T_on": 0.0, "T_side": 1.0, "T_width": 1.0}


def cause(**forms: object) -> Cause:
    return Cause("test", "", SIZE, (Form(**forms),))  # type: ignore[arg-type]


def formulas(campaign: Campaign, roles: Roles) -> list[Formula]:
    """Two parameters at once, a speed sensor, a short dwell, and a conductance whose exponent is a shape."""
    nets = (("extra.a", roles.oil_heat), ("extra.b", f"{roles.room}.floor"), ("extra.reading", roles.reading))
    made = [
        cause(values=lambda t, r: {"oil.V": r.base["oil.V"] * (1 + t["size"]), "extra.w_ref": 10 + t["size"]}),
        cause(truth=lambda t, r: {"n_carrier": r.sensors["n_carrier"] * (1 + t["size"])}),
        cause(pace=lambda t, r: 1 - t["size"] * (1 + r.second)),
        cause(
            shapes=(Shape("e", "1", "", 0.0, 2.0),),
            parts=(PartSpec("extra", "ExtraConductor", EXTRA),),
            connections=nets,
            values=lambda t, r: {"extra.G_ref": 30 * t["size"], "extra.e": t["e"]},
        ),
    ]
    names, reads = [s.name for s in campaign.sensors], [s.name for s in campaign.read]
    return [Formula(c, c.forms[0], names, reads) for c in made]


@pytest.fixture(scope="module")
def planetary() -> tuple[Plant, Campaign, list[Formula]]:
    scenario = load("planetary")
    data = read_campaign(FOLDER / "measured.csv", scenario, read_card(FOLDER / "card.json"))
    known = formulas(data, Roles.of(scenario.spec))
    knobs = dict.fromkeys(["gear_set.k_mu", "oil.c_p", *(p for f in known for p in f.paths)])
    given, shown = [s.reads for s in data.given], [s.reads for s in data.read]
    tried = tuple(dict.fromkeys(path for f in known for path in f.sized))
    added = [(f.form.parts, f.form.connections) for f in known]
    return (
        Plant(with_additions(scenario.spec, added, knobs), tuple(knobs), given, shown, tried),
        data,
        known,
    )


@pytest.fixture
def made(planetary: tuple[Plant, Campaign, list[Formula]]) -> Callable[[], Observed]:
    plant, data, _ = planetary
    return lambda: Observed(plant, data, (FRICTION, BATH), {}, {"room.air_speed": 0.2})


@pytest.fixture
def acting(planetary: tuple[Plant, Campaign, list[Formula]]) -> list[tuple[Formula, np.ndarray]]:
    return [(f, np.full(f.size, 0.4 - 0.2 * k)) for k, f in enumerate(planetary[2])]


Z = np.array([0.3, -0.5])


def central(function: Callable[[float], np.ndarray], h: float) -> np.ndarray:
    return (function(h) - function(-h)) / (2 * h)


def test_derivatives_by_nuisances_and_causes_are_those_of_what_is_shown(made, acting) -> None:
    o = made()
    found = o.at(Z, acting)
    assert np.array_equal(found.shown, o.shown_by(Z, acting))
    x = np.concatenate([Z, *(t for _, t in acting)])
    cuts = np.cumsum([len(Z), *(len(t) for _, t in acting)])[:-1]

    def shown(k: int, h: float) -> np.ndarray:
        z, *ts = np.split(x + h * (np.arange(len(x)) == k), cuts)
        return o.shown_by(z, [(f, t) for (f, _), t in zip(acting, ts, strict=True)])

    for k in range(len(x)):
        expected = central(lambda h, k=k: shown(k, h), 1e-4)
        assert np.abs(expected).max() > 1e-3
        assert found.by[:, k] == pytest.approx(expected, abs=1e-6 * np.abs(expected).max() + 1e-7)


def test_derivatives_by_given_readings_are_those_of_what_is_shown(made) -> None:
    o = made()
    found, test = o.at(Z, []), o.campaign.test
    at = np.flatnonzero(test == 2)
    own = test[o.row] == 2
    for g, sensor in enumerate(o.given):
        for h, row in enumerate(at):
            step = 1e-4 * abs(o.sensors[sensor.name][row])

            def shown(d: float, name: str = sensor.name, row: int = row) -> np.ndarray:
                other = made()
                other.sensors = {**o.sensors, name: o.sensors[name] + d * (np.arange(o.campaign.n) == row)}
                return other.shown_by(Z, [])

            expected = central(shown, step) * o.signs[sensor.name][row]
            assert np.abs(expected[~own]).max() == 0
            scale = np.abs(found.local[own, g]).max()
            assert found.local[own, g, h] == pytest.approx(expected[own], abs=2e-6 * scale + 1e-9)


def test_candidates_of_one_part_with_other_shapes_keep_apart(made, planetary) -> None:
    o, known = made(), planetary[2]
    beside = [(known[0], np.array([0.5])), (known[1], np.array([0.2]))]
    candidates = [(known[3], np.array([0.7, u])) for u in (-1.0, 0.0, 1.0)] + [(known[2], np.array([0.0]))]
    found = o.tangents(Z, beside, candidates)
    for k, (formula, t) in enumerate(candidates):
        expected = central(lambda h, f=formula, t=t: o.shown_by(Z, [*beside, (f, np.concatenate([[h], t[1:]]))]), 1e-3)
        assert found[:, k] == pytest.approx(expected, abs=1e-5 * np.abs(expected).max())
    assert np.abs(found[:, 0] - found[:, 2]).max() > 0.01 * np.abs(found[:, 0]).max()


def test_few_steps_are_enough(made, acting, monkeypatch) -> None:
    found = made().shown_by(Z, acting)
    monkeypatch.setattr(marching, "DWELL", np.linspace(0, 1, 201)[1:] ** 2)
    monkeypatch.setattr(marching, "STOP", np.linspace(0, 1, 41)[1:] ** 2)
    assert found == pytest.approx(made().shown_by(Z, acting), abs=0.01)


def test_an_early_reading_ends_its_dwell_and_leaves_the_stop_before_it(planetary) -> None:
    plant, data, known = planetary
    room = {s.name: np.full(data.n, 295.0) for s in data.given if s.kind == "ambient"}
    steady_room = replace(data, values={**data.values, **room}, room_start=np.full(data.n_tests, np.nan))
    first = np.r_[True, np.diff(data.test) > 0]
    pace = np.where(first, 0.7, 0.4)
    shorter = replace(steady_room, dwell=steady_room.dwell * pace)
    early, stated = (Observed(plant, c, (FRICTION, BATH), {}, {"room.air_speed": 0.2}) for c in (steady_room, shorter))
    found = early.shown_by(Z, [(known[2], np.array([3.0]))])
    assert found == pytest.approx(stated.shown_by(Z, []), abs=1e-9)
    assert np.abs(found - early.shown_by(Z, [])).max() > 1


def test_only_a_run_without_a_solution_is_not_a_number(made) -> None:
    o = made()
    fine = o.shown_by(Z, [])
    row = np.flatnonzero(o.campaign.test == 1)[0]
    torque = next(s.name for s in o.given if s.kind == "torque")
    o.sensors = {**o.sensors, torque: o.sensors[torque] * np.where(np.arange(o.campaign.n) == row, 300.0, 1.0)}
    found, own = o.at(Z, []), o.campaign.test[o.row] == 1
    assert np.isnan(found.shown[own]).all()
    assert np.isnan(found.by[own]).any()
    assert np.array_equal(found.shown[~own], fine[~own])
    assert np.isfinite(found.by[~own]).all()


def test_same_input_same_bytes(made, acting) -> None:
    one, other = (made().at(Z, acting) for _ in range(2))
    assert (one.shown.tobytes(), one.by.tobytes()) == (other.shown.tobytes(), other.by.tobytes())
    assert one.local.tobytes() == other.local.tobytes()


@pytest.mark.parametrize("rig", ["planetary", "helical_two_stage"])
def test_a_very_long_dwell_ends_in_the_steady_state(rig: str) -> None:
    scenario = load(rig)
    flat = scenario.spec.flat()
    plant = Plant(flat, (), (), [q.name for q in flat.states])
    u = plant.u.copy()
    for name, value in scenario.operating_point.items():
        u[plant.u_place[name]] = value
    none = np.zeros((1, 1, 0, 1))
    steps = np.cumsum(STEADY) / STEADY.sum()
    phases = Phases(
        np.array([[STEADY.sum()]]),
        u[None, None],
        u[None, None],
        (0,),
        (steps,),
        ((len(steps) - 1,),),
        none,
        none,
        np.zeros((1, 0)),
        steady=True,
    )
    x0 = np.where([q.unit == "K" for q in flat.states], 293.15, flat.starts("state"))[None]
    found = march(plant, phases, x0, plant.p[None, None, None], np.ones((1, 1)))
    expected = steady(flat, scenario.operating_point)
    assert found.y[0, 0] == pytest.approx([expected[q.name][-1] for q in flat.states], abs=1e-6)


def test_a_steady_state_at_the_steep_middle_of_a_thermostat_is_met(tmp_path: Path) -> None:
    scenario, path = load("wind_turbine"), tmp_path / "data.csv"
    flat, load_ = scenario.spec.flat(), 5000.0
    state = steady(flat, {"generator.w": 1800 * np.pi / 30, "generator.tau": -load_, "nacelle.T": 298.15}).columns
    read = {"T_sump_C": "sump.T", "T_bearing1_C": "bearing_1.T", "T_bearing2_C": "bearing_2.T"}
    values = {"n_hss_rpm": 1800.0, "T_hss_Nm": load_, "T_nacelle_C": 25.0}
    values |= {column: state[name][0] - 273.15 for column, name in read.items()}
    path.write_text("\n".join([",".join(values), *[",".join(f"{v:.6f}" for v in values.values())] * 2]))
    data = read_campaign(path, scenario, Card())
    given, shown = [s.reads for s in data.given], [s.reads for s in data.read]
    plant = Plant(with_additions(scenario.spec, (), ()), ("housing.C",), given, shown)
    found = Observed(plant, data, (), {}, {}).shown_by(np.zeros(0), ())
    assert found == pytest.approx(np.repeat([state[name][0] for name in shown], 2), abs=1e-3)


def test_a_machine_of_which_nothing_is_given_runs_as_its_file_has_it(tmp_path: Path) -> None:
    """An oil thermometer may be all there is."""
    text = (FOLDER.parent / "helical_two_stage" / "rig.toml").read_text(encoding="utf-8")
    (rig := tmp_path / "mine.toml").write_text(re.sub(r"\[sensors\][^[]*", '[sensors]\nT_oil_C = "oil.T"\n\n', text))
    (data := tmp_path / "data.csv").write_text("T_oil_C\n50.1\n50.3\n49.8\n50.0\n50.2\n49.9\n")
    inputs = read(Request(str(rig), data))
    problem = setting(inputs.scenario, inputs.card, inputs.data).problem
    look = problem.look(np.zeros(problem.nz))
    assert np.ptp(look.shown) < 1e-3 and np.isfinite(problem.noise(look).covariance).all()


def test_a_steady_state_is_the_one_that_warming_up_comes_to(tmp_path, monkeypatch) -> None:
    """Thin films make friction grow with the oil's temperature: this unit has a hotter steady state, too."""
    rig, data, card = tmp_path / "mine.toml", tmp_path / "data.csv", tmp_path / "card.json"
    known = {"stages": "bevel,helical", "ratio": 10, "power": "90 kW", "speed": "1485 rpm", "oil": "ISO VG 320 PAO"}
    housing = {"fan": True, "housing": "890x436x528 mm", "oil_volume": "16.4 l", "centre_distance": "268 mm"}
    gh.new("mine", **known, **housing, out=rig)
    points = enumerate(product(np.linspace(400, 1600, 25), np.linspace(500, 6500, 25), (10, 35)))
    rows = "".join(f"{k},{n},{tau},{60 + k % 7},{room}\n" for k, (n, tau, room) in points)
    data.write_text(f"point,n_input_rpm,T_output_Nm,T_oil_C,T_amb_C\n{rows}")
    card.write_text('{"protocol": "steady", "channels": {"T_oil_C": {"repeat_sd": "0.2 K"}}}')
    inputs = read(Request(str(rig), data, card=card))
    o = setting(inputs.scenario, inputs.card, inputs.data, inputs.data).problem.data
    z = np.array([float(nuisance.name == "thin films") for nuisance in o.nuisances])
    found = o.shown_by(z, [])
    monkeypatch.setattr(marching, "STEADY", 60.0 * 1.4 ** np.arange(60))
    o = setting(inputs.scenario, inputs.card, inputs.data, inputs.data).problem.data
    assert found == pytest.approx(o.shown_by(z, []), abs=1e-6)
