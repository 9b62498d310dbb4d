"""The command `export`: four drives of one rig, what goes beside the FMU, what is inside, and what is refused."""

from __future__ import annotations

import csv
import json
import re
import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.util import read_csv
from fmpy.validation import validate_fmu
from for_each import thin
from gearheat.fmu import compiling
from gearheat.fmu.equations import fix
from gearheat.fmu.play import Player
from gearheat.fmu.related import FOLDER, PARAMETERS
from gearheat.model.errors import FmuError
from gearheat.model.machines.spec import assemble
from gearheat.model.run.rows import evaluate_at
from gearheat.model.run.steady import steady
from gearheat.scenarios.load import load
from gearheat.scenarios.write import rig_text
from gearheat.tools.show.network import network_svg
from gearheat.tools.solve.settings import adjust, flat_of

SSV = "{http://ssp-standard.org/SSP1/SystemStructureParameterValues}"
ABOUT = "{urn:org.gearheat:provenance:1}provenance"

#: What turns on what a rig switches off, so that every parameter has something to act on.
ACTIVE = {"churning.c": 5.0, "carrier_bearing.K_rs": 3e-8, "sun_bearing.K_rs": 3e-8, "planet_bearing.F_r_0": 50.0}

VARIANTS = {
    "carrier-speed": ((), {"carrier.w", "carrier.tau"}),
    "sun-speed": (("--drive", "sun"), {"sun.w", "sun.tau"}),
    "carrier-torque": (("--drive", "carrier", "--given", "torque"), {"carrier.tau", "sun.tau"}),
    "sun-torque": (("--drive", "sun", "--given", "torque"), {"carrier.tau", "sun.tau"}),
}


@pytest.fixture
def elsewhere(monkeypatch):
    """Another platform, whose binary is not really compiled."""
    other = next(n for n in compiling.PLATFORMS if n != compiling.host_platform().name)
    build = compiling.binary

    def binary(source, platform, **options):
        return b"for another machine" if platform.name == other else build(source, platform, **options)

    monkeypatch.setattr("gearheat.fmu.export.binary", binary)
    return other


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    """Every variant with what the command said of it."""
    from gearheat.tools.cli.app import app
    from typer.testing import CliRunner

    folder = tmp_path_factory.mktemp("export")
    found = {}
    for name, (options, _) in VARIANTS.items():
        path = folder / f"{name}.fmu"
        extras = ("--extras", str(folder / name)) if name.startswith("carrier") else ()
        result = CliRunner().invoke(
            app, ["export", "--platform", "host", "planetary", "-o", str(path), *options, *extras, "--json", "-"]
        )
        assert result.exit_code == 0, result.stderr
        found[name] = (path, json.loads(result.stdout))
    return found


def held(path: Path, name: str) -> str:
    with zipfile.ZipFile(path) as file:
        return file.read(name).decode()


def values(content: str | bytes) -> dict[str, float]:
    return {p.get("name", ""): float(p[0].get("value", "")) for p in ET.fromstring(content).iter(f"{SSV}Parameter")}


def provenance(content: str | bytes) -> dict[str, dict[str, str]]:
    parameters = ET.fromstring(content).iter(f"{SSV}Parameter")
    return {p.get("name", ""): dict(said.attrib) for p in parameters for said in p.iter(ABOUT)}


@pytest.mark.parametrize("name", VARIANTS)
def test_each_drive_is_valid_and_has_its_inputs(exported, name):
    path, found = exported[name]
    assert validate_fmu(str(path)) == []
    assert {i for i in found["inputs"] if i.endswith((".w", ".tau"))} == VARIANTS[name][1]
    assert ("rotor.w" in found["outputs"]) == name.endswith("torque")
    assert found["platforms"] == [compiling.host_platform().name]


def test_both_shafts_with_a_given_speed_start_at_the_same_operating_point_and_stay_near_it(exported):
    names = ["carrier.w", "carrier.tau", "sun.w", "sun.tau", "efficiency.P_loss", "carrier_bearing.P_loss"]
    seen = {}
    for name in ("carrier-speed", "sun-speed"):
        with Player(exported[name][0]) as player:
            seen[name] = player.run({}, 20, 1.0, record=names)
    first = seen["carrier-speed"]
    assert first["carrier.w"][0] == pytest.approx(250 * np.pi / 30)
    assert first["sun.tau"][0] == pytest.approx(-2500 / 4 + first["efficiency.P_loss"][0] / first["sun.w"][0])
    for name, played in seen.items():
        for column in names:
            assert played[column][0] == pytest.approx(first[column][0], rel=1e-9), (name, column)
        assert played["carrier.w"][-1] == pytest.approx(first["carrier.w"][-1], rel=0.1)


@pytest.mark.parametrize(
    ("rig", "options"),
    thin(
        [("planetary", options) for options, _ in VARIANTS.values()]
        + [("helical_two_stage", options) for options in ((), ("--drive", "output"), ("--given", "torque"))]
    ),
)
def test_every_variant_runs_for_hours_at_its_defaults(gearheat, tmp_path, rig, options):
    """A speed that is given holds while the machine warms up; where torques are given nothing moves from the start."""
    assert gearheat("export", "--platform", "host", rig, "-o", tmp_path / "rig.fmu", *options).code == 0
    with Player(tmp_path / "rig.fmu") as player:
        told = player.described.quantities("output")
        played = player.run({}, 8 * 3600.0, 60.0, record=list(told))
    for name, q in told.items():
        first, last = played[name][0], played[name][-1]
        assert np.isfinite(played[name]).all(), name
        if q.unit == "rad/s":
            assert last == pytest.approx(first, rel=1e-4), name
        if q.unit == "K" and "torque" in options:
            assert last == pytest.approx(first, abs=0.01), name
    assert "torque" not in options or max(abs(played[name]).max() for name in ("efficiency.P_loss",)) > 1


def test_what_is_set_stays_set(gearheat, tmp_path, elsewhere):
    path = tmp_path / "rig.fmu"
    options = (
        "--platform",
        elsewhere,
        "--given",
        "torque",
        "--set",
        "sun.tau=-500 N.m",
        "--set",
        "rotor.w=10 rad/s",
        "--set",
        "oil.T=50 degC",
    )
    assert gearheat("export", "planetary", "-o", path, *options).code == 0
    start = {v.name: v.start for v in fmpy.read_model_description(str(path)).modelVariables}
    assert float(start["sun.tau"]) == -500.0
    assert float(start["rotor.w"]) == 10.0
    assert float(start["oil.T"]) == pytest.approx(323.15)
    assert float(start["carrier.tau"]) == 2500.0


def test_an_oil_that_is_chosen_gives_the_steady_state_of_the_rig_with_it(exported):
    path, found = exported["carrier-speed"]
    assert found["choices"]["start"] == ["given", "room", "steady"]
    item = found["choices"]["oil.oil"].index("PAGD") + 1
    with Player(path) as player:
        played = player.run({}, 60, 60, start={"start": 3, "oil.oil": item})
    flat = flat_of(adjust(load("planetary"), ["oil=PAGD"]))
    expected = steady(flat, {})
    for q in (*flat.states, flat.quantity("efficiency.P_loss")):
        assert played[q.name] == pytest.approx(np.full(2, expected[q.name][0]), rel=1e-9), q.name


def test_what_has_no_effect_is_no_parameter(exported):
    path, found = exported["carrier-speed"]
    assert set(found["without_effect"]) == {
        "grease.X_L", "grease.alpha_T", "grease.rho_15", "grease.s_p", "grease.t_p",
        "churning.inner_share", "planet_bearing.inner_share", "planet_bearing.F_a_0",
    }  # fmt: skip
    described = fmpy.read_model_description(str(path)).modelVariables
    parameters = {v.name: float(v.start) for v in described if v.causality == "parameter" and v.type != "Enumeration"}
    assert set(found["choices"]) == {v.name for v in described if v.type == "Enumeration"}
    assert set(parameters) == set(found["parameters"])
    assert {"churning.a", "churning.b"} < set(parameters)
    still = set(parameters)
    with Player(path) as player:
        for point in (ACTIVE, {"carrier.w": 1e-4, "carrier.tau": 1.0}):
            before = player.run({}, 600, 600.0, start=point).values
            for name in sorted(still):
                usual = point.get(name, parameters[name])
                tried = (0.99 * usual or 1e-3, usual + 1, usual + 3)  # whole numbers, and tooth numbers that fit
                if name == "oil.T_pour":  # bounds the range of a law, so it counts where the oil no longer flows
                    tried = (400.0,)
                for value in tried:
                    try:
                        changed = player.run({}, 600, 600.0, start={**point, name: value}).values
                    except FmuError:
                        continue
                    if (changed != before).any():
                        still.remove(name)
                    break
    assert still == set()


def test_sources_and_uncertainties_are_inside(exported):
    path, _ = exported["carrier-speed"]
    said = provenance(held(path, PARAMETERS))
    assert said.keys() == values(held(path, PARAMETERS)).keys()
    assert said["foot.G"]["kind"] == "calibrated"
    assert said["foot.G"]["standardUncertainty"] == "0.19"
    assert said["gear_set.b"] == {"kind": "cited", "source": "Dias2014, table 3.1"}
    assert said["oil.c_p"]["source"] == "Cragoe1929, at 60 degC"
    assert {about["kind"] for about in said.values()} == {"cited", "assumed", "inferred", "calibrated"}


def test_the_documentation_says_what_it_is_and_how_it_was_checked(exported):
    page = held(exported["carrier-speed"][0], "documentation/index.html")
    titles = ["Network", "Warm-up", "Where the heat comes from and where it goes", "Use", "Energy and validity"]
    titles += ["Inputs", "Outputs", "States", "Parameters", "Choices", "Parts and their equations", "Laws"]
    titles += ["Ranges that are watched", "Sources", "Verification"]
    assert re.findall(r'<h2 id=".+?">(.+?)</h2>', page) == titles
    listed = re.findall(r'<li><a href="#(.+?)">(.+?)</a>', page)
    assert [title for _, title in listed] == titles
    assert all(f'<h2 id="{place}">' in page for place, _ in listed)
    assert page.count("<figure>") == 3
    for part in assemble(load("planetary").spec).parts:
        assert f"<h3><code>{part.name}</code></h3>" in page
    assert "<td>conduction</td><td><code>Q_flow = G*(a.T-b.T)</code></td>" in page
    for value in ("<td>42 mm</td>", "<td>206 GPa</td>", "<td>250 rpm</td>", "from -60 degC to 500 degC"):
        assert value in page, value
    for text in ("oil_carrier_body</text>", "Torque loss in a planetary multiplier gearbox", "0.19 W/K"):
        assert text in page, text
    within = re.search(r"temperature: largest difference .*?below (1e-\d+) K", page)
    assert within is not None
    assert float(within[1]) <= 1e-2
    assert "below 1e-12" in page


def test_the_picture_shows_every_part_with_a_shaft_or_heat():
    for rig in ("planetary", "helical_two_stage"):
        assembly = assemble(load(rig).spec)
        picture = ET.fromstring(network_svg(assembly))
        shown = {text.text for text in picture.iter("{http://www.w3.org/2000/svg}text")}
        linked = {part.name for part in assembly.parts if {"Flange", "HeatPort", "AirPort"} & _ports(part)}
        assert shown == linked
        assert network_svg(assembly) == network_svg(assembly)


def _ports(part):
    return {type(port).__name__ for port in part.ports.values()}


def test_sets_of_the_rig_and_of_every_oil(exported):
    path, found = exported["carrier-speed"]
    folder = path.with_suffix("")
    names = {Path(name).relative_to(folder).as_posix() for name in found["extras"]}
    oils = {name for name in names if name.startswith("oils/")}
    beside = {f"carrier-speed{ending}" for ending in (".ssv", "_in.csv", "_ref.csv", "_ref.opt")}
    assert names - oils == beside
    assert names == {p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.is_file()}
    assert {"oils/PAOR.ssv", "oils/MINR.ssv", "oils/ISO_VG_220_PAG.ssv"} < oils
    assert "oils/bearing_grease.ssv" not in oils  # it has no specific heat
    rig = values((folder / "carrier-speed.ssv").read_bytes())
    assert rig == values(held(path, PARAMETERS))
    scenario = load("planetary")
    for name in ("PAOR", "MINE", "ISO VG 32 ester"):
        content = (folder / "oils" / f"{name.replace(' ', '_')}.ssv").read_bytes()
        assert values(content) == scenario.entry_values("oil", name)
        assert values(content).keys() <= rig.keys()
        assert ET.fromstring(content).get("name") == name
    said = provenance((folder / "oils" / "PAGD.ssv").read_bytes())
    assert said["oil.c_p"]["kind"] == "assumed"


def test_a_set_from_the_folder_moves_the_fmu_as_the_oil_moves_the_rig(exported):
    path, _ = exported["carrier-speed"]
    oil = values((path.with_suffix("") / "oils" / "MINR.ssv").read_bytes())
    flat = flat_of(adjust(load("planetary"), ["oil=MINR"]))
    vectors = [flat.starts(kind) for kind in ("state", "input", "parameter")]
    expected = evaluate_at(flat, *vectors)["y"]
    names = [q.name for q in flat.outputs]
    with Player(path) as player:
        ours = player.run({}, 1, 1.0, start=oil, record=names).values[0]
        before = player.run({}, 1, 1.0, record=names).values[0]
    assert ours == pytest.approx(expected, rel=1e-9, abs=1e-9)
    assert abs(before[names.index("gear_set.mu_sp")] / ours[names.index("gear_set.mu_sp")] - 1) > 0.1


@pytest.mark.parametrize("name", ["carrier-speed", "carrier-torque"])
def test_fmpy_reproduces_the_reference(exported, name):
    path, _ = exported[name]
    folder = path.with_suffix("")
    given, expected = read_csv(str(folder / f"{name}_in.csv")), read_csv(str(folder / f"{name}_ref.csv"))
    options = dict(csv.reader((folder / f"{name}_ref.opt").open(), skipinitialspace=True))
    stop, step = float(options["StopTime"]), float(options["OutputIntervalLength"])
    assert (stop, step) == ((14400.0, 60.0) if name.endswith("speed") else (60.0, 0.5))
    found = fmpy.simulate_fmu(
        str(path), stop_time=stop, output_interval=step, input=given, relative_tolerance=float(options["RelTol"])
    )
    time, first, count = np.unique(expected["time"], return_index=True, return_counts=True)
    for name, within in (("oil.T", 1e-3), ("surface.T", 1e-3), ("sun.w", 1e-2)):
        at = np.interp(time, found["time"], found[name])
        assert at[count == 1] == pytest.approx(expected[name][first[count == 1]], abs=within), name


def test_fmpy_repeats_the_experiment_that_is_inside(exported, tmp_path):
    """Its results are those of the model, integrated by another method."""
    path, _ = exported["carrier-speed"]
    for name in ("reference_in.csv", "reference_ref.csv", "experiments.exp", "parameters.ssv"):
        (tmp_path / name).write_text(held(path, f"{FOLDER}/{name}"), encoding="utf-8")
    (experiment,) = ET.parse(tmp_path / "experiments.exp").getroot()
    named = {child.tag: child.get("source") for child in experiment}
    times = experiment.find("TransientSimulation")
    given, expected = (read_csv(str(tmp_path / named[what])) for what in ("Stimuli", "References"))
    found = fmpy.simulate_fmu(
        str(path),
        stop_time=float(times.get("stopTime")),
        output_interval=float(times.get("stepSize")),
        start_values=values((tmp_path / named["Parameters"]).read_bytes()),
        input=given,
        relative_tolerance=float(experiment.get("tolerance")),
        output=[name for name in expected.dtype.names if name != "time"],
    )
    for name in expected.dtype.names[1:]:
        assert np.interp(expected["time"], found["time"], found[name]) == pytest.approx(expected[name], abs=1e-3)


def test_the_same_rig_gives_the_same_bytes_with_and_without_extras(exported, gearheat, tmp_path):
    path, found = exported["carrier-speed"]
    again = gearheat("export", "--platform", "host", "planetary", "-o", tmp_path / "again.fmu", "--json", "-").json
    assert again["sha256"] == found["sha256"]
    assert (tmp_path / "again.fmu").read_bytes() == path.read_bytes()
    assert again["extras"] == []
    assert [p.name for p in tmp_path.iterdir()] == ["again.fmu"]


def test_for_another_machine_the_reference_is_made_all_the_same(gearheat, tmp_path, elsewhere):
    path = tmp_path / "rig.fmu"
    more = ("--platform", elsewhere, "--extras", tmp_path / "more")
    found = gearheat("export", "planetary", "-o", path, *more, "--json", "-").json
    assert found["platforms"] == [elsewhere]
    assert (tmp_path / "more" / "rig_ref.csv").is_file()
    with zipfile.ZipFile(path) as file:
        binaries = [n for n in file.namelist() if n.startswith("binaries/")]
    assert binaries == [f"binaries/{elsewhere}/planetary{compiling.PLATFORMS[elsewhere].suffix}"]
    assert "reference run" not in held(path, "documentation/index.html")


def test_of_fmi_3_on_another_processor(gearheat, tmp_path, monkeypatch):
    monkeypatch.setattr("gearheat.fmu.export.binary", lambda source, platform, **options: b"for another machine")
    path = tmp_path / "rig.fmu"
    found = gearheat("export", "planetary", "-o", path, "--fmi", 3, "--platform", "aarch64-linux", "--json", "-").json
    assert (found["fmi"], found["platforms"]) == ("3.0", ["aarch64-linux"])
    assert validate_fmu(str(path)) == []
    assert 'Terminal name="carrier"' in held(path, "terminalsAndIcons/terminalsAndIcons.xml")
    assert held(path, "binaries/aarch64-linux/planetary.so") == "for another machine"


def test_the_sentence_for_people(gearheat, tmp_path):
    answer = gearheat("export", "--platform", "host", "planetary", "-o", tmp_path / "rig.fmu", "--extras", tmp_path)
    assert answer.code == 0, answer.err
    first, second, third = answer.out.splitlines()
    assert (
        first == f"{tmp_path / 'rig.fmu'}: 9 inputs, 52 outputs, 104 parameters, for {compiling.host_platform().name}"
    )
    assert re.fullmatch(r"\d\d files beside it, from .*rig\.ssv", second)
    assert third == 'catalogue values not checked against a print: oil "PAOR": oil.T_pour'


def test_an_extended_rig_has_its_oils_too(gearheat, tmp_path):
    rig, fmu = tmp_path / "extended.toml", tmp_path / "rig.fmu"
    rig.write_text(rig_text(load("planetary")), encoding="utf-8")
    found = gearheat("export", "--platform", "host", rig, "-o", fmu, "--extras", tmp_path / "more", "--json", "-").json
    assert len(list((tmp_path / "more" / "oils").iterdir())) == len(found["extras"]) - 4 >= 40
    assert provenance(held(fmu, PARAMETERS))["foot.G"]["standardUncertainty"] == "0.19"


def test_a_machine_listed_part_by_part(gearheat, tmp_path, elsewhere):
    path = tmp_path / "rig.fmu"
    answer = gearheat("export", "helical_two_stage", "-o", path, "--given", "torque", "--platform", elsewhere)
    assert answer.code == 0, answer.err
    start = {v.name: v.start for v in fmpy.read_model_description(str(path)).modelVariables}
    assert float(start["rotor.w"]) == pytest.approx(1450 * np.pi / 30)
    assert -590 <= float(start["output.tau"]) < -100  # of the load, as much as friction holds the speed at
    assert float(start["input.tau"]) == pytest.approx(-float(start["output.tau"]) / 12.56, rel=0.06)


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (("--drive", "snu"), 'Did you mean "sun"'),
        (("--platform", "linux46"), 'Did you mean "linux64"'),
        (("--fmi", "3", "--platform", "win32"), 'platform "win32" is unknown'),
        (("--date", "yesterday"), 'the date "yesterday" is no date'),
        (("--set", "carrier.w=100 rpm", "--given", "torque"), "follows from what drives the rig"),
        (("--extras", "/dev/null/more"), "cannot be written"),
        (("--set", "oil.nu_40=-1 mm2/s"), "out of range"),
    ],
)
def test_what_is_wrong_is_told_before_anything_is_written(gearheat, tmp_path, options, told):
    answer = gearheat("export", "planetary", "-o", tmp_path / "rig.fmu", *options)
    assert answer.code == 2
    assert told in answer.err
    assert list(tmp_path.iterdir()) == []


def test_places_that_hold_no_file_are_told(gearheat, tmp_path):
    answer = gearheat("export", "--platform", "host", "planetary", "-o", tmp_path)
    assert (answer.code, "it is a folder). Name a file in it." in answer.err) == (2, True)
    answer = gearheat("export", "--platform", "host", "planetary", "-o", "/dev/null")
    assert (answer.code, "it is a device). Give the output another name." in answer.err) == (2, True)


def test_what_a_company_may_keep_to_itself(gearheat, tmp_path):
    path, extras = tmp_path / "own.fmu", tmp_path / "extras"
    keep = ("--license", "Example Ltd, all rights reserved", "--no-sources", "--no-parameters-source")
    say = ("--author", "A. Maker, Example Ltd", "--model-version", "1.2", "--date", "2026-01-31T12:00:00Z")
    words = ("helical_two_stage", "-o", path, *keep, "--constant", "stage_1", *say, "--extras", extras)
    found = gearheat("export", *words, "--json", "-").json
    flat = flat_of(load("helical_two_stage"))
    follows = {n for n, those in flat.derived.items() if any(t.startswith("stage_1.") for t in those)}
    assert follows and "stage_1.z_1" in found["constants"] and "stage_2.z_1" in found["parameters"]
    beside = [place.read_text(encoding="utf-8") for place in sorted(extras.rglob("*.ssv"))]
    assert len(beside) > 20 and not any("provenance" in text for text in beside)
    assert found["platforms"] == list(dict.fromkeys([compiling.host_platform().name, "win64"]))
    with zipfile.ZipFile(path) as file:
        description = file.read("modelDescription.xml").decode()
        assert 'license="Example Ltd, all rights reserved"' in description
        told = 'author="A. Maker, Example Ltd" version="1.2"', 'generationDateAndTime="2026-01-31T12:00:00Z"'
        assert all(text in description for text in told)
        assert "SourceFiles" not in description
        assert "sources/all.c" not in file.read("documentation/index.html").decode()
        assert not [name for name in file.namelist() if name.startswith("sources/")]
        for name in (n for n in file.namelist() if n.endswith((".xml", ".html", ".ssv"))):
            assert b"assumed: standard module" not in file.read(name), name
        contents = [file.read(name) for name in file.namelist()] + [text.encode() for text in beside]
        told = {n for n in (*found["constants"], *follows) if any(n.encode() in content for content in contents)}
        assert not told and any(b"stage_2.z_1" in content for content in contents)
    with Player(path) as player:
        assert player.run({}, 600, 60.0).time[-1] == 600
    fixed = fix(flat, found["constants"])
    x, u = flat.starts("state"), flat.starts("input")
    whole, same = (evaluate_at(each, x, u, each.starts("parameter")) for each in (flat, fixed))
    assert same["ode"] == pytest.approx(whole["ode"], rel=1e-12)
    y = dict(zip((q.name for q in flat.outputs), whole["y"], strict=True))
    assert same["y"] == pytest.approx([y[q.name] for q in fixed.outputs], rel=1e-9, abs=1e-9)
    assert gearheat("export", "helical_two_stage", "-o", path, "--constant", "stage_1.z1").code == 2


def test_no_licence_is_told_that_was_not_given(gearheat, tmp_path):
    path = tmp_path / "rig.fmu"
    gearheat("export", "--platform", "host", "helical_two_stage", "-o", path)
    with zipfile.ZipFile(path) as file:
        description = file.read("modelDescription.xml").decode()
        assert not [name for name in ("license=", "author=", "generationDateAndTime=") if name in description]
        assert "assumed: standard module" in file.read("documentation/index.html").decode()
