"""What an importer chooses by name: how a run begins and which oil is filled in; whole numbers; and no audit."""

from __future__ import annotations

import xml.etree.ElementTree as ET
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import casadi as ca
import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model
from fmpy.validation import validate_fmu
from gearheat.fmu.export import export
from gearheat.fmu.play import Player, play
from gearheat.fmu.variables import Choice, Item, start_choice
from gearheat.model.core.flat import FlatModel
from gearheat.model.errors import FmuError
from gearheat.model.run.steady import steady

Open = Callable[..., Any]
THICK = {"oil.C": 4200.0, "oil.b_0": 0.05}
BEGIN = start_choice("room.T")
OIL = Choice("oil.oil", "the oil filled in", (Item("as exported", "own"), Item("thick", "more viscous", THICK)))
HOT = {"governor.w": 220.0, "load.tau": 30.0, "room.T": 303.15}
TEMPERATURES = ("oil.T", "gears.T", "cover.T", "housing.T")
ERROR, WARNING = 3, 1
EVENT_INFO = (
    "newDiscreteStatesNeeded",
    "terminateSimulation",
    "nominalsOfContinuousStatesChanged",
    "valuesOfContinuousStatesChanged",
    "nextEventTimeDefined",
    "nextEventTime",
)


@pytest.fixture(scope="module", params=[2, 3])
def fmu(request: pytest.FixtureRequest, models: SimpleNamespace, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("choices") / f"heat{request.param}.fmu"
    return export(models.heat, path, fmi=request.param, choices=[BEGIN, OIL])


@pytest.fixture(scope="module")
def fmu_2(models: SimpleNamespace, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("choices") / "heat.fmu"
    return export(models.heat, path, choices=[BEGIN, OIL])


def simulated(path: Path, kind: str, **start: float) -> Any:
    values = {name.replace("__", "."): value for name, value in start.items()}
    return fmpy.simulate_fmu(str(path), fmi_type=kind, stop_time=600, output_interval=60, start_values=values)


def settled(flat: FlatModel, values: Mapping[str, float]) -> dict[str, float]:
    found = steady(flat, dict(values))
    return {q.name: float(found[q.name][0]) for q in flat.states}


# --- how a run begins ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_a_run_begins_as_chosen(models: SimpleNamespace, fmu: Path, kind: str) -> None:
    hot = {name.replace(".", "__"): value for name, value in HOT.items()}
    given = simulated(fmu, kind, oil__T=310.0, **hot)
    assert [given[name][0] for name in TEMPERATURES] == [310.0, 293.15, 293.15, 293.15]
    at_room = simulated(fmu, kind, oil__T=310.0, start=2, **hot)
    assert [at_room[name][0] for name in TEMPERATURES] == [303.15] * 4
    assert at_room["shaft.w"][0] == 150.0
    steadily = simulated(fmu, kind, start=3, **hot)
    for name, value in settled(models.heat, HOT).items():
        assert steadily[name][0] == pytest.approx(value, rel=1e-9), name
        assert steadily[name][-1] == pytest.approx(value, rel=1e-9), name
    assert steadily["energy.supplied"][0] == 0.0
    assert steadily["energy.throughput"][0] == 0.0


def test_at_a_steady_start_nothing_moves(opened: Open, fmu_2: Path) -> None:
    one = opened(fmu_2).start(start=3, governor__w=220.0)
    assert np.abs(one.get(*(f"der({name})" for name in TEMPERATURES))).max() < 1e-10
    assert one.get("governor.w") == [220.0]


def test_an_integrator_is_told_that_the_states_are_others(opened: Open, fmu_2: Path) -> None:
    for item in (1, 2, 3):
        one = opened(fmu_2, FMU2Model)
        one.fmu.setInteger([one.whole["start"]], [item])
        told = dict(zip(EVENT_INFO, one.start().fmu.newDiscreteStates(), strict=True))
        assert told["valuesOfContinuousStatesChanged"] == (item > 1)


def test_without_a_steady_state_the_run_begins_as_given_and_says_so(
    models: SimpleNamespace, opened: Open, tmp_path: Path
) -> None:
    """Heat that nothing carries away."""
    flat = models.heat
    closed = replace(flat, ode=ca.substitute(flat.ode, flat.p[6], ca.SX(0)), name="closed")
    ode = ca.vertsplit(closed.ode)
    flow = 40.0 * (flat.x[1] - flat.x[0])
    closed = replace(closed, ode=ca.vertcat(ode[0], ode[1] + (flow + 5e3) / flat.p[1], *ode[2:]))
    one = opened(export(closed, tmp_path / "closed.fmu"))
    one.set(start=2)
    one.fmu.setupExperiment(startTime=0.0)
    one.fmu.enterInitializationMode()
    assert one.fmu.fmi2ExitInitializationMode(one.fmu.component) == WARNING
    status, _, text = one.messages[-1]
    assert status == WARNING
    assert "there is no steady state at the initial inputs: " in text
    assert one.get("oil.T", "shaft.w") == [293.15, 150.0]
    one.fmu.doStep(0.0, 1.0)


def test_items_and_moments_that_do_not_fit_are_refused(opened: Open, fmu_2: Path) -> None:
    one = opened(fmu_2)
    assert "start = 4 is out of range. It must be at least 1 and at most 3." in one.refused(lambda: one.set(start=4))[1]
    real = one.refused(lambda: one.fmu.setReal([one.whole["start"]], [1.0]))
    assert real == (ERROR, "fmi2SetReal: start is an enumeration.")
    one.start()
    assert 'start cannot be set in the mode "step complete"' in one.refused(lambda: one.set(start=2))[1]
    one.set(oil__oil=2)
    assert one.fmu.getInteger([one.whole["oil.oil"], one.whole["start"]]) == [2, 1]
    one.fmu.reset()
    one.start()
    assert one.fmu.getInteger([one.whole["oil.oil"]]) == [1]


# --- oils ---------------------------------------------------------------------------------------------------------


def test_a_chosen_oil_is_the_fmu_exported_with_it(models: SimpleNamespace, fmu: Path, tmp_path: Path) -> None:
    fmi = 3 if fmu.stem.endswith("3") else 2
    other = export(models.heat, tmp_path / "thick.fmu", fmi=fmi, start=THICK, choices=[BEGIN, OIL])
    for start in ({}, {"start": 3}, {"shaft.J": 0.2}):
        chosen = play(fmu, {}, 3600, 60, start={**start, "oil.oil": 2})
        exported = play(other, {}, 3600, 60, start=start)
        assert (chosen.values == exported.values).all()
    assert (play(fmu, {}, 3600, 60).values != exported.values).any()


def test_an_importers_own_value_comes_before_the_oil_in_any_order(fmu_2: Path, opened: Open) -> None:
    names = [*TEMPERATURES, "der(oil.T)", "der(gears.T)"]
    seen = []
    for first, then in (({"oil__oil": 2}, {"oil__C": 5000.0}), ({"oil__C": 5000.0}, {"oil__oil": 2})):
        one = opened(fmu_2).start(**first)
        one.set(**then)
        one.fmu.doStep(0.0, 600.0)
        seen.append(one.get(*names))
        assert one.get("oil.C") == [5000.0]
    own = opened(fmu_2).start(oil__C=5000.0, oil__b_0=0.05)
    own.fmu.doStep(0.0, 600.0)
    assert seen == [own.get(*names)] * 2
    assert one.get(*THICK) == [5000.0, 0.02]
    thick = opened(fmu_2).start(oil__oil=2, oil__b_0=0.03)
    assert thick.get("gears.P_loss") != own.get("gears.P_loss")


def test_a_saved_state_knows_the_oil(opened: Open, fmu_2: Path) -> None:
    one = opened(fmu_2).start(oil__oil=2)
    saved = one.fmu.serializeFMUstate(one.fmu.getFMUstate())
    one.fmu.doStep(0.0, 600.0)
    two = opened(fmu_2).start()
    two.fmu.setFMUstate(two.fmu.deSerializeFMUstate(saved))
    two.fmu.doStep(0.0, 600.0)
    assert two.get(*two.refs) == one.get(*one.refs)


def test_the_description_offers_the_items(fmu: Path) -> None:
    assert validate_fmu(str(fmu)) == []
    described = fmpy.read_model_description(str(fmu))
    by_name = {v.name: v for v in described.modelVariables}
    oil, start = by_name["oil.oil"], by_name["start"]
    assert [(i.name, int(i.value)) for i in oil.declaredType.items] == [("as exported", 1), ("thick", 2)]
    assert [i.name for i in start.declaredType.items] == ["given", "room", "steady"]
    assert (oil.variability, start.variability) == ("tunable", "fixed")
    assert oil.type == "Enumeration"
    assert "sets oil.C, oil.b_0, but for those that differ from their start values" in oil.description
    assert "oil.oil sets it unless it differs from its start value" in by_name["oil.b_0"].description
    depends = {u.variable.name: {v.name for v in u.dependencies} for u in described.initialUnknowns}
    assert "oil.oil" in depends["der(oil.T)"]
    assert "oil.oil" not in depends["oil.dT"]
    assert not {v.declaredType.name for v in (oil, start)} & by_name.keys()
    assert len({v.valueReference for v in described.modelVariables}) == len(described.modelVariables)
    page = zipfile.ZipFile(fmu).read("documentation/index.html").decode()
    assert "more viscous" in page


def test_a_choice_that_moves_nothing_is_none(models: SimpleNamespace, tmp_path: Path) -> None:
    idle = Choice("idle", "no choice", (Item("one", "own"), Item("two", "unknown", {"nothing": 1.0})))
    path = export(models.rc, tmp_path / "rc.fmu", choices=[idle])
    names = [v.name for v in fmpy.read_model_description(str(path)).modelVariables]
    assert "idle" not in names
    wrong = Choice("wrong", "a choice", (Item("one", "own"), Item("two", "negative", {"resistor.R": -1.0})))
    with pytest.raises(FmuError, match=r'wrong, item "two": resistor\.R = -1 ohm is out of range'):
        export(models.rc, tmp_path / "rc.fmu", choices=[wrong])
    with Player(path) as player, pytest.raises(FmuError, match="unknown"):
        player.run({}, 1, 1, start={"idle": 1})


# --- whole numbers and the audit ------------------------------------------------------------------------------------


@pytest.mark.parametrize("fmi", [2, 3])
def test_teeth_are_whole_numbers(models: SimpleNamespace, tmp_path: Path, fmi: int) -> None:
    flat: FlatModel = models.rc
    teeth = replace(flat.parameters[0], name="gear.z_1", unit="1", whole=True, start=20.0, low=0.0, low_open=True)
    path = export(replace(flat, parameters=(teeth, flat.parameters[1])), tmp_path / "teeth.fmu", fmi=fmi)
    assert validate_fmu(str(path)) == []
    root = ET.fromstring(zipfile.ZipFile(path).read("modelDescription.xml"))
    told = next(v for v in root.find("ModelVariables") or () if v.get("name") == "gear.z_1")
    number = told if fmi == 3 else told[0]
    assert number.tag == ("Int32" if fmi == 3 else "Integer")
    assert (number.get("start"), number.get("min"), told.get("variability")) == ("20", "1", "fixed")
    more = play(path, {}, 1, 1, start={"gear.z_1": 40})["resistor.i"][0]
    assert more == pytest.approx(play(path, {}, 1, 1)["resistor.i"][0] / 2)


def test_without_audit_there_are_two_states_less_and_the_same_temperatures(
    models: SimpleNamespace, fmu_2: Path, tmp_path: Path
) -> None:
    path = export(models.heat, tmp_path / "bare.fmu", audit=False, choices=[BEGIN, OIL])
    assert validate_fmu(str(path)) == []
    described = fmpy.read_model_description(str(path))
    assert len(described.derivatives) == described.numberOfContinuousStates == len(models.heat.states)
    assert not any(v.name.startswith(("energy.supplied", "energy.throughput")) for v in described.modelVariables)
    assert "energy.supplied" not in zipfile.ZipFile(path).read("documentation/index.html").decode()
    with_audit, without = (play(p, {}, 3600, 60, tolerance=1e-8) for p in (fmu_2, path))
    for name in (*TEMPERATURES, "shaft.w", "energy.stored", "energy.residual"):
        assert without[name] == pytest.approx(with_audit[name], rel=1e-7, abs=1e-6), name
