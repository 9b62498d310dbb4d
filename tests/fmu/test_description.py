"""The model description: valid, with units, exact dependencies and the right start values."""

import xml.etree.ElementTree as ET
import zipfile
from collections import Counter
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu
from fmu_in_c import planetary
from gearheat.fmu import units
from gearheat.fmu.description import description, identifier, identity, values
from gearheat.fmu.equations import equations
from gearheat.fmu.export import export
from gearheat.fmu.source import source
from gearheat.fmu.variables import drop_idle, per_second, table
from gearheat.model.errors import FmuError
from gearheat.model.run.rows import evaluate_at
from gearheat.model.units import in_unit
from gearheat.scenarios.load import list_rigs, load
from gearheat.tools.export.fmu import choices_of


@pytest.fixture(scope="module")
def described(heat_fmu: Path) -> SimpleNamespace:
    description = fmpy.read_model_description(str(heat_fmu))
    return SimpleNamespace(root=description, by_name={v.name: v for v in description.modelVariables})


def test_fmpy_finds_no_problem(rc_fmu: Path, heat_fmu: Path) -> None:
    assert validate_fmu(str(rc_fmu)) == []
    assert validate_fmu(str(heat_fmu)) == []


def test_states_are_outputs_with_settable_start(described: SimpleNamespace) -> None:
    oil = described.by_name["oil.T"]
    assert (oil.causality, oil.variability, oil.initial, float(oil.start)) == ("output", "continuous", "exact", 293.15)
    rate = described.by_name["der(oil.T)"]
    assert (rate.causality, rate.derivative.name) == ("local", "oil.T")
    assert described.by_name["oil.C"].variability == "tunable"
    assert described.by_name["room.T"].causality == "input"


def test_units_and_what_is_shown(described: SimpleNamespace) -> None:
    by_name, defined = described.by_name, {u.name: u for u in described.root.unitDefinitions}
    assert (by_name["oil.T"].unit, by_name["oil.T"].displayUnit) == ("K", "degC")
    assert (by_name["shaft.w"].unit, by_name["shaft.w"].displayUnit) == ("rad/s", "rpm")
    assert (by_name["oil.dT"].unit, by_name["oil.dT"].displayUnit) == ("K", None)
    shown = {d.name: (d.factor, d.offset) for u in defined.values() for d in u.displayUnits}
    assert shown["degC"] == (1.0, -273.15)
    assert shown["rpm"][0] == pytest.approx(9.549296585513721, rel=1e-14)
    base = defined["N.m.s/rad"].baseUnit
    assert (base.kg, base.m, base.s, base.rad, base.factor) == (1, 2, -1, -1, 1.0)


def test_a_number_of_the_description_reads_back_everywhere(heat_fmu: Path) -> None:
    """std::stod and others refuse denormal values, so an end that is left open may not be written as one."""
    root = ET.fromstring(zipfile.ZipFile(heat_fmu).read("modelDescription.xml"))
    low = [float(real.get("min", "-inf")) for real in root.iter("Real")]
    assert sum(0 < value < 1e-200 for value in low) > 5, "this model has open ends at zero"
    for real in root.iter("Real"):
        for key in ("min", "max", "start", "nominal"):
            value = float(real.get(key, "0"))
            assert value == 0 or abs(value) >= 1e-300, (key, value)


def test_temperatures_of_a_rig_have_the_limits_of_its_laws() -> None:
    flat = planetary()[0]
    kelvins = [v for v in table(flat) if v.quantity.unit == "K" and v.kind in ("state", "input")]
    assert len(kelvins) == 6
    assert {v.quantity.name: v.bounds for v in kelvins if v.kind == "input"} == {"room.T": (213.15, 423.15)}
    assert {v.bounds for v in kelvins if v.kind == "state"} == {(213.15, 773.15)}
    for temperature in (213.15, 773.15):
        u = [min(temperature, 423.15) if q.name == "room.T" else q.start for q in flat.inputs]
        assert np.isfinite(evaluate_at(flat, [temperature] * len(flat.states), u, flat.starts("parameter"))["y"]).all()


def test_a_difference_is_marked_so_no_offset_touches_it(heat_fmu: Path) -> None:
    root = ET.fromstring(zipfile.ZipFile(heat_fmu).read("modelDescription.xml"))
    (real,) = root.findall("ModelVariables/ScalarVariable[@name='oil.dT']/Real")
    assert real.get("relativeQuantity") == "true"


@pytest.mark.parametrize(
    ("name", "exponents"),
    [
        ("W/(m2.K)", {"K": -1, "kg": 1, "s": -3}),
        ("Pa.s", {"kg": 1, "m": -1, "s": -1}),
        ("1", {}),
        ("1/K", {"K": -1}),
        ("rad/s2", {"rad": 1, "s": -2}),
    ],
)
def test_base_units(name: str, exponents: dict[str, int]) -> None:
    assert units.unit(name).exponents == exponents


def test_a_unit_nobody_knows_has_no_base() -> None:
    assert units.unit("furlong/s").exponents is None


def test_units_of_derivatives() -> None:
    assert [per_second(u) for u in ("K", "rad/s", "J", "1", "J/K")] == ["K/s", "rad/s2", "W", "1/s", "J/K.s-1"]


def test_dependencies_are_exact(described: SimpleNamespace) -> None:
    def on(group: list, name: str) -> set[str]:
        (unknown,) = [u for u in group if u.variable.name == name]
        return {v.name for v in unknown.dependencies}

    root = described.root
    assert on(root.outputs, "oil.T") == {"oil.T"}
    assert on(root.outputs, "oil.dT") == {"oil.T", "room.T"}
    assert on(root.outputs, "gears.P_loss") == {"oil.T", "shaft.w", "load.tau"}
    assert on(root.derivatives, "der(cover.T)") == {"oil.T", "cover.T", "housing.T"}
    assert on(root.initialUnknowns, "gears.P_loss") == {"oil.T", "shaft.w", "load.tau", "oil.b_0"}
    assert "energy.supplied" not in on(root.derivatives, "der(energy.supplied)")


def test_start_values_can_be_replaced(models: SimpleNamespace) -> None:
    start = {v.name: v.start for v in table(models.rc, {"source.v": 2.5, "capacitor.v": 0.5, "resistor.R": 7.0})}
    assert [start[n] for n in ("source.v", "capacitor.v", "resistor.R", "capacitor.C")] == [2.5, 0.5, 7.0, 3.0]


def test_all_wrong_start_values_are_told_at_once(models: SimpleNamespace, tmp_path: Path) -> None:
    start = {"resistor.r": 1.0, "resistor.i": 1.0, "capacitor.C": -1.0, "source.v": float("nan")}
    with pytest.raises(FmuError) as caught:
        export(models.rc, tmp_path / "rc.fmu", start=start)
    told = "\n".join(caught.value.problems)
    assert len(caught.value.problems) == 4
    for text in ('Did you mean "resistor.R"', '"resistor.i" is calculated', "capacitor.C = -1", "source.v = nan"):
        assert text in told


@pytest.mark.parametrize(
    ("name", "expected"), [("rc", "rc"), ("shaft and heat", "shaft_and_heat"), ("2nd", "model_2nd"), ("Öl", "model__l")]
)
def test_identifier(name: str, expected: str) -> None:
    assert identifier(name) == expected


def test_same_model_same_bytes(models: SimpleNamespace, rc_fmu: Path, tmp_path: Path) -> None:
    again = export(models.rc, tmp_path / "again.fmu")
    assert again.read_bytes() == rc_fmu.read_bytes()
    other = export(models.rc, tmp_path / "other.fmu", start={"source.v": 4.0})
    guids = {fmpy.read_model_description(str(p)).guid for p in (rc_fmu, again, other)}
    assert len(guids) == 2
    assert {i.date_time[0] for i in zipfile.ZipFile(again).infolist()} == {1980}


#: Units that nobody reads in the unit itself.
SHOWN = ("K", "rad/s", "rad", "m", "m2/s", "m3", "Pa", "J", "W")


@pytest.mark.parametrize("rig", list_rigs())
def test_what_a_user_reads_of_every_variable_of_every_rig(rig: str) -> None:
    """A description of its own, a unit that is understood, the unit people use, a start inside the range."""
    scenario = load(rig)
    flat = scenario.spec.flat()
    deviating = [q.name for q in flat.states]
    variables = list(table(flat, choices=drop_idle(choices_of(scenario), flat), deviating=deviating))
    assert {v.kind for v in variables} >= {"choice", "deviation"}
    told = Counter(identity(v)["description"] for v in variables)
    assert [text for text, n in told.items() if n > 1 or not text] == []
    for v in variables:
        attributes = values(v)
        assert ("unit" in attributes) == (v.type == "Real"), v.name
        unit = units.unit(attributes.get("unit", "1"))
        assert unit.exponents is not None, v.name
        assert unit.shown or unit.name not in SHOWN, unit.name
        size = abs(v.start or v.quantity.nominal)
        if v.type == "Real" and unit.shown and size >= unit.shown[0].least and "relativeQuantity" not in attributes:
            assert attributes["displayUnit"] in {d.name for d in unit.shown}, v.name
        start = float(attributes.get("start", "nan"))
        assert not start < float(attributes.get("min", "-inf")), v.name
        assert not start > float(attributes.get("max", "inf")), v.name


def test_types_say_what_is_measured(described: SimpleNamespace) -> None:
    quantities = {
        name: described.by_name[name].declaredType.quantity for name in ("oil.T", "oil.dT", "shaft.w", "oil.C")
    }
    expected = ("ThermodynamicTemperature", "TemperatureDifference", "AngularVelocity", "HeatCapacity")
    assert tuple(quantities.values()) == expected
    assert described.by_name["validity.count"].declaredType is None


def test_a_start_value_has_no_round_off_of_its_unit(models: SimpleNamespace) -> None:
    start = {"resistor.R": 0.1 + 0.2, "capacitor.C": 250 * np.pi / 30, "capacitor.v": 1 / 3}
    found = {v.name: v.start for v in table(models.rc, start)}
    assert [found[name] for name in start] == [0.3, 250 * np.pi / 30, 1 / 3]


def test_messages_tell_a_number_without_a_unit(models: SimpleNamespace) -> None:
    """The unit of what has no dimension is "1", which would read as another number."""
    plain = replace(models.rc, parameters=tuple(replace(q, unit="1") for q in models.rc.parameters))
    rows = (
        source(plain, equations(plain), table(plain)).partition("model_units[] = {\n")[2].partition("}")[0].split(",")
    )
    assert [row.strip() for row in rows[-6:-3]] == ['""', '""', '" V/s"']
    assert plain.parameters[0].problem(-1.0) == "resistor.R = -1 is out of range. It must be above 0."


def test_values_are_shown_in_the_units_of_their_size() -> None:
    sizes = {("m", 1e-6): "um", ("m", 0.1): "mm", ("m2/s", 1e-4): "mm2/s", ("m3", 1e-3): "l", ("rad", 0.2): "deg"}
    sizes |= {("Pa", 2e11): "GPa", ("Pa", 1e6): "MPa", ("K", 300.0): "degC", ("rad/s", 100.0): "rpm", ("W", 2e3): "kW"}
    for (unit, size), name in sizes.items():
        shown = units.unit(unit).display(size)
        assert shown is not None and shown.name == name, unit
        known = {"degC": size - 273.15, "rpm": size * 30 / np.pi}
        assert shown.factor * size + shown.offset == pytest.approx(known.get(name, in_unit(size, name)), rel=1e-12)
    assert units.unit("W/K").display(10.0) is None
    assert units.unit("W").display(10.0) is None


def test_no_two_variables_of_a_rig_are_described_alike() -> None:
    flat = planetary()[0]
    root = ET.fromstring(description(flat, equations(flat), table(flat), "{1}"))
    told = [v.get("description") for v in root.iterfind("ModelVariables/ScalarVariable")]
    assert all(told)
    assert [text for text, n in Counter(told).items() if n > 1] == []
    units_used = {real.get("displayUnit") or real.get("unit") for real in root.iter("Real")}
    named = {u.get("name") for u in root.iter("Unit")} | {d.get("name") for d in root.iter("DisplayUnit")}
    assert units_used <= named
    assert root.find("DefaultExperiment").attrib.keys() == {"startTime", "stopTime", "stepSize", "tolerance"}
