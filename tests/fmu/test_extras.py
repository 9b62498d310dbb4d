"""What comes with an FMU: sources, parameter sets, a picture, checks; and which parameters it has at all."""

import dataclasses
import doctest
import hashlib
import re
import xml.etree.ElementTree as ET
import zipfile
from collections.abc import Callable
from pathlib import Path, PurePosixPath
from types import SimpleNamespace
from typing import Any

import casadi as ca
import fmpy
import gearheat.fmu.export
import numpy as np
import pytest
from fmpy.validation import validate_fmu
from gearheat.fmu.equations import effective
from gearheat.fmu.export import export
from gearheat.fmu.parameter_set import PROVENANCE, PROVENANCE_SPACE, SRMD, SSC, SSV, STC, parameter_set
from gearheat.fmu.play import play
from gearheat.fmu.related import FOLDER, MANIFEST, PARAMETERS, Experiment, Related
from gearheat.model.core.component import Component, equation
from gearheat.model.core.connect import Assembly
from gearheat.model.core.declare import Parameter, State
from gearheat.model.core.flat import FlatModel, Quantity
from gearheat.model.core.flatten import flatten
from gearheat.model.errors import FmuError
from gearheat.model.machines.spec import PartSpec, Spec
from gearheat.model.parts.ports import Flange
from gearheat.model.parts.shaft import Inertia, ShaftEnd
from lxml import etree
from small_parts import rc

#: What the schema of each version of FMI-LS-REF takes: roles (of those that are used here), and elements of a file.
REFERENCES = {
    "1.0.0-alpha.1": ({"parameter", "document", "experiment/smoke-test", "result", "other"}, set()),
    "1.0.0-beta.1": ({"parameter", "document", "experiment/smoke-test", "result", "meta-data", "other"}, {"Label"}),
}


def held(path: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(path) as file:
        return {name: file.read(name) for name in file.namelist()}


def structure_problems(content: bytes, known: set[str] | None = None) -> list[str]:
    """What is wrong with a parameter set by the rules of SSP 1.0, chapters "common" and "SSV"."""
    root = ET.fromstring(content)
    problems = [] if root.tag == f"{{{SSV}}}ParameterSet" else [f"root {root.tag}"]
    if not re.fullmatch(r"1[.][0-9]+(-.*)?", root.get("version", "")):
        problems.append("version")
    if not root.get("name"):
        problems.append("name")
    children = [child.tag for child in root]
    order = [f"{{{SSV}}}{name}" for name in ("Parameters", "Enumerations", "Units", "Annotations")]
    if children != [tag for tag in order if tag in children] or order[0] not in children:
        problems.append(f"children {children}")
    parameters = root.findall(f"{{{SSV}}}Parameters/*")
    names = [p.get("name") for p in parameters]
    if len(set(names)) < len(names) or not all(names):
        problems.append("names are not unique")
    problems += [f"unknown {name}" for name in names if known is not None and name not in known]
    units = {u.get("name"): u for u in root.findall(f"{{{SSV}}}Units/{{{SSC}}}Unit")}
    problems += [f"{n}: no base unit" for n, u in units.items() if u.find(f"{{{SSC}}}BaseUnit") is None]
    for p in parameters:
        value, *rest = p
        kinds = {f"{{{SSV}}}Real", f"{{{SSV}}}Integer"}
        if p.tag != f"{{{SSV}}}Parameter" or value.tag not in kinds or len(rest) > 1:
            problems.append(f"{p.get('name')}: {[child.tag for child in p]}")
        elif not np.isfinite(float(value.get("value", "nan"))) or value.get("unit", "1") not in units | {"1": None}:
            problems.append(f"{p.get('name')}: {value.attrib}")
        problems += [f"{p.get('name')}: {a.tag}" for r in rest for a in r if a.tag != f"{{{SSC}}}Annotation"]
        problems += [f"{p.get('name')}: {r.tag}" for r in rest if r.tag != f"{{{SSV}}}Annotations"]
    return problems


def schema_problems(content: bytes) -> list[str]:
    """What the schema of SSP 1.0 that comes with FMPy finds."""
    schema = etree.XMLSchema(
        etree.parse(str(Path(fmpy.__file__).parent / "ssp" / "schema" / "SystemStructureParameterValues.xsd"))
    )
    schema.validate(etree.fromstring(content))
    return [error.message for error in schema.error_log]


def provenance(content: bytes) -> dict[str, dict[str, str]]:
    found = {}
    for p in ET.fromstring(content).iter(f"{{{SSV}}}Parameter"):
        for annotation in p.iter(f"{{{SSC}}}Annotation"):
            assert annotation.get("type") == PROVENANCE
            (said,) = annotation
            assert said.tag == f"{{{PROVENANCE_SPACE}}}provenance"
            found[p.get("name", "")] = dict(said.attrib)
    return found


# --- sources inside -----------------------------------------------------------------------------------------------

SOURCES = {"resistor.R": "calibrated: on <five> readings & more", "capacitor.C": "Nobody2000, table 2"}


@pytest.fixture(scope="module")
def sourced(models: SimpleNamespace, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("sourced") / "rc.fmu"
    return export(
        models.rc,
        path,
        sources=SOURCES,
        uncertainties={"resistor.R": 0.05},
        figures={"Circuit": "<svg><!--rc--></svg>"},
    )


def test_a_receiver_finds_source_value_unit_and_uncertainty(sourced: Path) -> None:
    content = held(sourced)[PARAMETERS]
    assert structure_problems(content, {"resistor.R", "capacitor.C"}) == []
    assert schema_problems(content) == []
    assert provenance(content) == {
        "resistor.R": {"kind": "calibrated", "source": SOURCES["resistor.R"], "standardUncertainty": "0.05"},
        "capacitor.C": {"kind": "cited", "source": SOURCES["capacitor.C"]},
    }
    values = {p.get("name"): p[0].attrib for p in ET.fromstring(content).iter(f"{{{SSV}}}Parameter")}
    assert values["resistor.R"] == {"value": "2.0", "unit": "ohm"}
    units = {u.get("name"): u[0].attrib for u in ET.fromstring(content).iter(f"{{{SSC}}}Unit")}
    assert units["ohm"] == {"kg": "1", "m": "2", "s": "-3", "A": "-2"}


def test_the_structure_is_really_checked(sourced: Path) -> None:
    content = held(sourced)[PARAMETERS].decode()
    changes = [
        ('version="1.0"', 'version="2"'),
        ('name="capacitor.C"', 'name="resistor.R"'),
        ('value="2.0"', 'value="two"'),
        ('unit="ohm"', 'unit="Ohm"'),
        ("ssv:Units", "ssv:Unit"),
    ]
    for old, new in changes:
        assert old in content
        try:
            found = structure_problems(content.replace(old, new).encode(), {"resistor.R", "capacitor.C"})
        except ValueError as error:
            found = [str(error)]
        assert found, new


def test_the_manifest_lists_what_is_there(sourced: Path) -> None:
    content = held(sourced)
    root = ET.fromstring(content[MANIFEST])
    space = "{http://fmi-standard.org/fmi-ls-manifest}"
    assert root.tag == "fmiReferences"
    assert root.get(f"{space}fmi-ls-name") == PurePosixPath(MANIFEST).parent.name == "org.fmi-standard.fmi-ls-ref"
    roles, elements = REFERENCES[root.get(f"{space}fmi-ls-version", "")]
    assert root.get(f"{space}fmi-ls-description")
    for related in root:
        assert related.tag == "Related"
        assert related.get("role") in roles
        assert {child.tag for child in related} <= elements
        place = PurePosixPath(MANIFEST).parent
        for step in PurePosixPath(related.get("source", "")).parts:
            place = place.parent if step == ".." else place / step
        assert str(place) in content


def test_the_metadata_tells_sources_uncertainties_and_laws(sourced: Path) -> None:
    content = held(sourced)
    root = ET.fromstring(content[f"{FOLDER}/parameters.srmd"])
    assert root.tag == f"{{{SRMD}}}SimulationResourceMetaData"
    assert bytes.fromhex(root.get("checksum", "")) == hashlib.sha3_256(content[PARAMETERS]).digest()
    assert f"{FOLDER}/{root.get('data')}" == PARAMETERS
    told = {
        c.get("type"): {e.get("keyword"): e.text for e in c.iter(f"{{{STC}}}ClassificationEntry")}
        for c in root.iter(f"{{{STC}}}Classification")
    }
    assert told["org.gearheat.source"] == SOURCES
    assert told["org.gearheat.standard-uncertainty"] == {"resistor.R": "0.05 ohm"}


def test_sets_and_an_experiment_are_listed_with_their_roles(models: SimpleNamespace, tmp_path: Path) -> None:
    run = Experiment("run", "charging", 10.0, 1.0, 1e-8, '"time"\n0.0\n', '"time"\n0\n')
    one = parameter_set("small one", [Quantity("capacitor.C", "F", "", start=2.0)])
    path = export(models.rc, tmp_path / "rc.fmu", others=Related({"small one": one}, run))
    content = held(path)
    listed = {r.get("source"): r for r in ET.fromstring(content[MANIFEST])}
    assert content[f"{FOLDER}/sets/small_one.ssv"] == one
    assert [label.get("name") for label in listed["sets/small_one.ssv"]] == ["variant:small one"]
    assert listed["experiments.exp"].get("type") == "application/x-ma-hs-experiments"
    (experiment,) = ET.fromstring(content[f"{FOLDER}/experiments.exp"])
    assert {child.tag: child.get("source") for child in experiment} == {
        "TransientSimulation": None,
        "Parameters": "parameters.ssv",
        "Stimuli": "reference_in.csv",
        "References": "reference_ref.csv",
    }
    assert all(f"{FOLDER}/{source}" in content for source in listed if not source.startswith(".."))


def test_the_page_says_it_to_people(sourced: Path) -> None:
    page = held(sourced)["documentation/index.html"].decode()
    for text in ("<svg><!--rc--></svg>", "calibrated: on &lt;five&gt; readings &amp; more", "0.05 ohm", "1 calibrated"):
        assert text in page, text
    assert validate_fmu(str(sourced)) == []


def test_what_is_known_of_values_does_not_change_the_model(sourced: Path, rc_fmu: Path, tmp_path: Path) -> None:
    with_sources, without = held(sourced), held(rc_fmu)
    same = [name for name in with_sources if with_sources[name] == without[name]]
    assert {"modelDescription.xml", "sources/all.c", MANIFEST} <= set(same)
    assert PARAMETERS not in same
    assert structure_problems(without[PARAMETERS]) == schema_problems(without[PARAMETERS]) == []
    assert provenance(without[PARAMETERS]) == {}


def test_checks_of_the_finished_file_are_written_down(models: SimpleNamespace, tmp_path: Path) -> None:
    def verify(path: Path, code: str) -> list[tuple[str, str]]:
        assert "fmi2DoStep" in code
        return [("charge after <1 s>", f"{play(path, {}, 1, 1)['capacitor.v'][-1]:.3f} V")]

    pages = []
    for name in ("one.fmu", "two.fmu"):
        path = export(models.rc, tmp_path / name, verify=verify)
        pages.append(held(path)["documentation/index.html"])
        assert validate_fmu(str(path)) == []
    assert pages[0] == pages[1]
    assert f"charge after &lt;1 s&gt;</td><td>{5 - 4 * np.exp(-1 / 6):.3f} V" in pages[0].decode()
    assert (tmp_path / "one.fmu").read_bytes() == (tmp_path / "two.fmu").read_bytes()


def test_a_set_without_units_that_are_understood() -> None:
    content = parameter_set("odd", [Quantity("speed", "furlong/s", "", start=2.0)])
    assert structure_problems(content) == schema_problems(content) == []
    assert b"unit=" not in content


# --- parameters with an effect ------------------------------------------------------------------------------------


def changed(flat: FlatModel, **parts: Callable[..., Any]) -> FlatModel:
    """The model with two more parameters, p[-2] and p[-1], and expressions made of the old one and them."""
    more = ca.SX.sym("more", 2)
    added = tuple(Quantity(f"more.{name}", "1", "one more", start=0.5) for name in "ab")
    a, b = ca.vertsplit(more)
    new = {name: change(getattr(flat, name), a, b) for name, change in parts.items()}
    return dataclasses.replace(flat, parameters=(*flat.parameters, *added), p=ca.vertcat(flat.p, more), **new)


def names(flat: FlatModel) -> set[str]:
    return {q.name for q in effective(flat).parameters}


def test_a_parameter_that_nothing_holds_is_left_out(models: SimpleNamespace) -> None:
    assert names(models.rc) == {"resistor.R", "capacitor.C"}
    assert effective(models.rc) is models.rc
    assert names(changed(models.rc)) == {"resistor.R", "capacitor.C"}


def test_shares_that_end_in_one_place_cancel(models: SimpleNamespace) -> None:
    split = changed(models.rc, ode=lambda ode, a, b: a * ode + (1 - a) * ode)
    assert names(split) == {"resistor.R", "capacitor.C"}
    reduced = effective(split, {"more.a": 0.3})
    rate = ca.Function("rate", [reduced.x, reduced.u, reduced.p], [reduced.ode])
    assert float(rate(1.0, 5.0, [2.0, 3.0])) == pytest.approx((5 - 1) / 6)


def test_a_parameter_without_effect_at_its_value_alone_stays(models: SimpleNamespace) -> None:
    power = changed(models.rc, y=lambda y, a, b: ca.vertcat(y[0] + a * ca.fabs(y[0]) ** b, y[1]))
    off = tuple(dataclasses.replace(q, start=0.0) if q.name == "more.a" else q for q in power.parameters)
    power = dataclasses.replace(power, parameters=off)
    assert names(power) == {"resistor.R", "capacitor.C", "more.a", "more.b"}


@pytest.mark.parametrize(
    "switch",
    [
        lambda y, a, b: ca.vertcat(ca.if_else(y[0] > a, 1.0, 2.0), y[1]),
        lambda y, a, b: ca.vertcat(ca.floor(y[0] * a), y[1]),
        lambda y, a, b: ca.vertcat(ca.sign(y[0] - ca.exp(a)) * y[0], y[1]),
    ],
)
def test_a_parameter_that_decides_when_stays(models: SimpleNamespace, switch: Callable[..., Any]) -> None:
    assert names(changed(models.rc, y=switch)) == {"resistor.R", "capacitor.C", "more.a"}


def test_an_fmu_names_what_it_leaves_out_and_takes_its_start_value(models: SimpleNamespace, tmp_path: Path) -> None:
    idle = changed(models.rc)
    path = export(idle, tmp_path / "idle.fmu", start={"more.a": 2.0, "resistor.R": 4.0})
    described = {v.name: v for v in fmpy.read_model_description(str(path)).modelVariables}
    assert "more.a" not in described
    assert float(described["resistor.R"].start) == 4.0
    assert "therefore no parameters of it: <code>more.a</code>, <code>more.b</code>" in (
        held(path)["documentation/index.html"].decode()
    )
    with pytest.raises(FmuError, match=r"more\.c"):
        export(idle, tmp_path / "idle.fmu", start={"more.c": 2.0})


def test_every_parameter_of_an_fmu_moves_something(heat_fmu: Path) -> None:
    described = fmpy.read_model_description(str(heat_fmu)).modelVariables
    duty = {"governor.w": (np.array([0.0, 60]), np.array([150.0, 200]))}
    before = play(heat_fmu, duty, 60, 60).values
    for v in described:
        if v.causality == "parameter":
            another = 2 if v.type == "Enumeration" else 1.01 * float(v.start)
            after = play(heat_fmu, duty, 60, 60, start={v.name: another}).values
            assert (after != before).any(), v.name


# --- any flat model -----------------------------------------------------------------------------------------------


def test_the_example_of_the_module_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert doctest.testmod(gearheat.fmu.export) == doctest.TestResults(failed=0, attempted=7)
    assert validate_fmu("rc.fmu") == []
    played = play("rc.fmu", {}, 12, 12, tolerance=1e-8)
    assert played["capacitor.v"][-1] == pytest.approx(5 * (1 - np.exp(-2)), abs=1e-6)


def test_a_circuit_of_parts(tmp_path: Path) -> None:
    path = export(rc(R=100.0, C=1e-3), tmp_path / "circuit.fmu")
    assert validate_fmu(str(path)) == []
    played = play(path, {"battery.V": (np.array([0.0, 1]), np.array([5.0, 5]))}, 0.5, 0.05, tolerance=1e-8)
    assert played["capacitor.u"] == pytest.approx(5 * (1 - np.exp(-played.time / 0.1)), abs=1e-6)


class Twist(Component):
    """A shaft that twists without loss; its spring moment is a state, so that no angle is needed."""

    a = Flange()
    b = Flange()

    c = Parameter("N.m/rad", "stiffness", above=0.0)
    tau = State("N.m", "moment from a to b", nominal=10.0)

    def equations(self):
        yield equation("twist", self.der("tau"), self.c * (self.a.w - self.b.w))
        yield equation("into a", self.a.tau, self.tau)
        yield equation("out of b", self.b.tau, -self.tau)

    def stored_energy(self):
        return self.tau**2 / (2 * self.c)


def test_two_masses_on_a_shaft_that_twists(tmp_path: Path) -> None:
    J, c = 0.2, 500.0
    ends = ShaftEnd("left", given=("tau",)), ShaftEnd("right", given=("tau",))
    parts = (*ends, Inertia("m1", J=J), Inertia("m2", J=J), Twist("shaft", c=c))
    nets = (("left.flange", "m1.flange", "shaft.a"), ("shaft.b", "m2.flange", "right.flange"))
    path = export(flatten(Assembly("two_masses", "two masses on a shaft", parts, nets)), tmp_path / "two.fmu")
    assert validate_fmu(str(path)) == []
    played = play(path, {}, 0.5, 0.01, start={"m1.w": 2.0}, tolerance=1e-9)
    swing = np.cos(np.sqrt(2 * c / J) * played.time)
    assert played["m1.w"] == pytest.approx(1 + swing, abs=2e-5)
    assert played["m2.w"] == pytest.approx(1 - swing, abs=2e-5)
    assert played["energy.stored"] == pytest.approx(J * 2.0**2 / 2, rel=1e-5)


def test_an_extended_machine(tmp_path: Path) -> None:
    body = PartSpec("body", "HeatCapacity", {"C": 1000.0})
    wall = PartSpec("wall", "ThermalConductor", {"G": 10.0})
    spec = Spec("block", "a block in a room", (body, wall, PartSpec("room", "Room")), ())
    spec = spec.with_parts([], [("body.heat", "wall.a"), ("wall.b", "room.floor")])
    cooler = PartSpec("cooler", "ThermalConductor", {"G": 30.0})
    extended = spec.with_parts([cooler], [("body.heat", "cooler.a"), ("cooler.b", "room.floor")])
    for machine, G in ((spec, 10.0), (extended, 40.0)):
        flat = machine.flat()
        path = export(flat, tmp_path / f"{G:g}.fmu", start={"body.T": 350.0, "room.T": 300.0})
        played = play(path, {}, 100, 10, tolerance=1e-8)
        assert played["body.T"] == pytest.approx(300 + 50 * np.exp(-G * played.time / 1000), abs=1e-5)
