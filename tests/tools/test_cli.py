from __future__ import annotations

import os
import re
import subprocess
import sys

import pytest
import typer
from gearheat.scenarios.entries import catalogue
from gearheat.scenarios.shipped import FILES, RIGS
from gearheat.tools.cli.app import app

COMMANDS = (
    "run",
    "losses",
    "steady",
    "design",
    "simulate",
    "export",
    "play",
    "compare",
    "calibrate",
    "list",
    "map",
    "rating",
    "teeth",
    "new",
    "parts",
    "schema",
    "show",
    "plan",
    "verify",
)


@pytest.mark.parametrize("argument", ["--help", "list"])
def test_what_a_user_asks_first_loads_nothing_heavy(argument):
    code = (
        f"import sys; from gearheat.tools.cli.app import app\n"
        f"try:\n    app(['{argument}'])\nexcept SystemExit: pass\n"
        "heavy = {'casadi', 'numpy', 'scipy', 'matplotlib', 'pint', 'fmpy'} & set(sys.modules)\n"
        "print(sorted(heavy), file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr.strip() == "[]"
    for name in COMMANDS if argument == "--help" else ("planetary", "PAOR"):
        assert name in done.stdout


def test_help_sets_the_commands_for_developers_apart(gearheat):
    users, _, developers = gearheat("--help").out.partition("For developers")
    assert " bench " in developers and " bench " not in users


@pytest.mark.parametrize(
    ("typed", "found"),
    [("gearheat stea", "steady"), ("gearheat show plan", "planetary"), ("gearheat map x --pl", "--plot")],
)
def test_the_shell_completes_commands_rigs_and_options(typed, found):
    asked = {"_GEARHEAT_COMPLETE": "complete_bash", "COMP_WORDS": typed, "COMP_CWORD": str(typed.count(" "))}
    code = "from gearheat.tools.cli.app import app; app(prog_name='gearheat')"
    environment = {**os.environ, **asked}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment, check=False)
    assert done.stdout.split() == [found]


def test_options_are_spelt_alike_everywhere():
    commands = typer.main.get_command(app).commands
    names = {name: {o.name: set(o.opts) for o in command.params} for name, command in commands.items()}
    for name, options in names.items():
        assert options.get("json", {"--json"}) == {"--json"}, name
        assert options.get("out", {"-o", "--out"}) == {"-o", "--out"}, name
        assert options.get("jobs", {"-j", "--jobs"}) == {"-j", "--jobs"}, name
        assert not {"workers", "threads", "output_file"} & options.keys(), name


def test_list_tells_what_the_catalogues_hold(gearheat):
    found = gearheat("list", "--json", "-").json
    assert found["catalogues"] == {kind: {n: e.doc for n, e in catalogue(kind).items()} for kind in FILES}
    for kind in FILES:
        for name, e in catalogue(kind).items():
            missing = [key for key in e.values if key not in e.checked]
            told = "all" if not missing else f"not {', '.join(missing)}" if e.checked else "none"
            assert found["checked"][kind][name] == told


def test_every_command_explains_itself(gearheat):
    for command in COMMANDS:
        answer = gearheat(command, "--help")
        assert answer.code == 0
        assert "--json" in answer.out or command == "schema"  # its answer is JSON


def test_json_on_stdout_is_one_object_and_nothing_else(gearheat):
    for arguments in (("list",), ("show", "planetary"), ("steady", "planetary")):
        answer = gearheat(*arguments, "--json", "-")
        assert answer.code == 0
        assert answer.json["schema"] == f"gearheat.{arguments[0]}/1"


def test_json_in_a_file_comes_beside_the_table(gearheat, tmp_path):
    answer = gearheat("steady", "planetary", "--json", tmp_path / "steady.json")
    assert "oil.T" in answer.out
    assert (tmp_path / "steady.json").read_text() == gearheat("steady", "planetary", "--json", "-").out


def test_list_names_rigs_and_oils(gearheat):
    found = gearheat("list", "--json", "-").json
    assert "planetary" in found["rigs"]
    assert {"PAOR", "MINR", "MINE", "PAGD"} <= found["catalogues"]["oil"].keys()


def test_list_says_what_each_rig_reproduces(gearheat):
    found = gearheat("list", "--json", "-").json
    assert found["reproduces"].keys() == found["rigs"].keys()
    assert "Dias2014" in found["reproduces"]["planetary"] and "reproduces" in gearheat("list").out


def test_show_gives_every_parameter_a_value_a_unit_and_a_source(gearheat):
    found = gearheat("show", "planetary", "--json", "-").json
    parameters = {p["name"]: p for p in found["parameters"]}
    assert parameters["cooling.A"]["unit"] == "m2"
    assert parameters["oil.nu_40"]["source"]
    assert parameters["carrier_seal.d_sh"]["value"] == pytest.approx(0.14)
    assert [s["name"] for s in found["states"]] == ["oil.T", "gears.T", "carrier_body.T", "wall.T", "surface.T"]
    assert parameters["foot.G"]["uncertainty"] == pytest.approx(0.19)
    assert parameters["cooling.A"]["uncertainty"] is None
    assert all(law["source"] for law in found["laws"])


def test_show_tells_which_law_is_outside_its_range_at_the_operating_point(gearheat, tmp_path):
    assert gearheat("show", "helical_two_stage", "--json", "-").json["outside"] == []
    rig = (RIGS / "helical_two_stage" / "rig.toml").read_text(encoding="utf-8")
    cold = tmp_path / "cold.toml"
    cold.write_text(rig.replace('room.T = "20 degC"', 'room.T = "-40 degC"'), encoding="utf-8")
    (found,) = [o for o in gearheat("show", cold, "--json", "-").json["outside"] if o["part"] == "input_bearing_a"]
    assert (found["law"], found["argument"], found["range"]) == ("starvation", "s", [0.0, 0.6])
    assert found["met"][0] > 1
    assert "outside its range: input_bearing_a: starvation, s = " in gearheat("show", cold).out


def test_simulate_and_design_tell_which_law_is_outside_its_range(gearheat, tmp_path):
    duty = tmp_path / "duty.csv"
    duty.write_text("time [s],room.T [degC]\n0,-25\n600,-25\n", encoding="utf-8")
    out = gearheat("simulate", "helical_two_stage", "--duty", duty, "-o", tmp_path / "run.csv").out
    assert "outside its range: oil: kinematic_viscosity, T - T_pour = -7 to " in out
    duty.write_text("time [s],room.T [degC]\n0,-25\n14400,-25\n", encoding="utf-8")
    out = gearheat("simulate", "helical_two_stage", "--duty", duty, "-o", tmp_path / "warm.csv").out
    assert re.search(r"laws outside their range: \d far from it \(warning\), \d near it or early \(note\), \d at", out)
    assert re.search(r"warning, outside its range: input_bearing_a: starvation, s = \S+ to \S+ \(", out)
    assert re.search(r"note, outside its range: oil: kinematic_viscosity, T - T_pour = -7 to \S+, until \d+ s \(", out)
    made = ("--free", "cooling.A", "--target", "oil.T=0 degC", "--set", "room.T=-40 degC")
    out = gearheat("design", "helical_two_stage", *made, "--among", "oil=ISO VG 220 mineral,ISO VG 220 PAO").out
    assert out.count("outside its range: input_bearing_a: starvation") == 2


def test_show_errata_prints_what_the_source_should_say(gearheat):
    assert "PAGD" in gearheat("show", "planetary", "--errata").out
    assert "no corrections" in gearheat("show", "helical_two_stage", "--errata").out


def test_show_has_the_units_of_the_rig_file(gearheat):
    shown = {line["name"]: line for line in gearheat("show", "planetary", "--json", "-").json["parameters"]}
    assert (shown["oil.V"]["value"], shown["oil.V"]["unit"]) == (pytest.approx(0.001), "m3")
    assert shown["oil.V"]["written"] == {"value": pytest.approx(1.0), "uncertainty": None, "unit": "l"}
    assert all(line["written"] is None for line in shown.values() if line["unit"] in ("degC", "rpm"))
    lines = [line.split() for line in gearheat("show", "planetary", "--all").out.splitlines()]
    assert next(line[1] for line in lines if line[:1] == ["oil.V"]) == "1"


def test_steady_takes_values_with_units_and_closes_the_power_balance(gearheat):
    answer = gearheat(
        "steady", "planetary", "--json", "-",
        "--set", "carrier.w=100 rpm", "--set", "carrier.tau=1549.5 N.m", "--set", "room.T=298.33 K",
    )  # fmt: skip
    found = answer.json
    assert found["values"]["sun.w"] == pytest.approx(400.0)
    assert found["units"]["sun.w"] == "rpm"
    assert found["values"]["room.T"] == pytest.approx(25.18)
    assert found["energy_residual"] < 1e-6
    assert found["values"]["oil.T"] > found["values"]["room.T"]


def test_a_speed_set_at_the_other_shaft_takes_the_place_of_the_given_one(gearheat):
    ours = gearheat("steady", "planetary", "--json", "-", "--set", "sun.w=1000 rpm").json
    theirs = gearheat("steady", "planetary", "--json", "-", "--set", "carrier.w=250 rpm").json
    assert "sun.w" in ours["inputs"] and "carrier.w" not in ours["inputs"]
    assert ours["values"]["carrier.w"] == pytest.approx(250.0)
    assert ours["values"]["oil.T"] == pytest.approx(theirs["values"]["oil.T"], abs=1e-6)


def test_catalogue_names_and_choices_can_be_set(gearheat):
    base = gearheat("steady", "planetary", "--json", "-").json["values"]["gear_set.mu_sp"]
    mineral = gearheat("steady", "planetary", "--json", "-", "--set", "oil=MINR").json["values"]["gear_set.mu_sp"]
    assert mineral > base
    flows = {
        flow: gearheat("steady", "planetary", "--json", "-", "--set", f"gear_set.power_flow={flow}").json["values"]
        for flow in ("ideal", "successive")
    }
    assert flows["ideal"]["efficiency.P_loss"] != flows["successive"]["efficiency.P_loss"]


def test_design_meets_its_target_and_steady_confirms_it(gearheat):
    found = gearheat("design", "planetary", "--json", "-", "--free", "cooling.A", "--target", "oil.T=70 degC").json
    assert found["targets"]["oil.T"] == pytest.approx(70.0, abs=1e-6)
    area = found["free"]["cooling.A"]
    check = gearheat("steady", "planetary", "--json", "-", "--set", f"cooling.A={area!r} m2").json
    assert check["values"]["oil.T"] == pytest.approx(70.0, abs=1e-5)
    step = gearheat("design", "planetary", "--json", "-", "--free", "cooling.A", "--target", "oil.T=70.01 degC").json
    slope = (step["free"]["cooling.A"] - area) / 0.01
    assert found["sensitivity"]["cooling.A"]["oil.T"] == pytest.approx(slope, rel=1e-2)


@pytest.mark.parametrize(("speed", "told"), [("50 Hz", True), ("60.0Hz", True), ("24 Hz", False), ("3000 rpm", False)])
def test_hertz_of_a_plate_may_be_those_of_the_mains(gearheat, tmp_path, speed, told):
    plate = ("--stages", "helical", "--ratio", 4, "--power", "5 kW", "--speed", speed)
    answer = gearheat("new", "a", *plate, "-o", tmp_path / "a.toml")
    assert answer.code == 0
    assert ("are those of the mains" in answer.err) == told


def test_names_to_free_are_given_one_by_one(gearheat):
    answer = gearheat("design", "planetary", "--free", "cooling.A,foot.G", "--target", "oil.T=70 degC")
    assert answer.code == 2
    assert answer.problems() == ["--free cooling.A,foot.G: is more than one name. Repeat --free for each.\n"]


def test_design_frees_a_torque_as_an_input(gearheat):
    found = gearheat("design", "planetary", "--json", "-", "--free", "carrier.tau", "--target", "oil.T=60 degC").json
    assert 0 < found["free"]["carrier.tau"] < 2500
    assert found["units"]["carrier.tau"] == "N.m"


def test_design_among_oils_solves_each(gearheat):
    found = gearheat(
        "design", "planetary", "--json", "-",
        "--free", "cooling.A", "--target", "oil.T=70 degC", "--among", "oil=PAOR,MINR",
    ).json  # fmt: skip
    areas = {a["oil"]: a["free"]["cooling.A"] for a in found["alternatives"]}
    assert areas["MINR"] > areas["PAOR"]


def test_design_keeps_to_limits_with_the_least_change(gearheat):
    frees = ("--free", "cooling.A", "--free", "foot.G")
    found = gearheat("design", "planetary", "--json", "-", *frees, "--target", "oil.T < 75 degC").json
    assert found["met"] and list(found["free"]) == ["foot.G"]
    assert found["targets"]["oil.T"] == pytest.approx(75.0, abs=1e-6)
    assert found["notes"][0].startswith("or with a larger change: cooling.A = ")
    answer = gearheat("design", "planetary", *frees, "--target", "oil.T<=90 degC")
    assert "met already" in answer.out
    answer = gearheat("design", "planetary", "--target", "oil.T<75 degC")
    assert answer.code == 2 and "oil.T is 81.7787 degC, which is not < 75 degC" in answer.err
    for wrong in ("oil.T", "oil.T<<80 degC", "oil.T<80", "oli.T<80 degC"):
        answer = gearheat("design", "planetary", *frees, "--target", wrong)
        assert answer.code == 2 and "Traceback" not in answer.err, wrong


def test_design_goes_through_a_catalogue_the_best_first(gearheat):
    aims = ("--target", "oil.T<80 degC", "--target", "gear_set.Lambda_sp>0.25")
    found = gearheat("design", "planetary", "--json", "-", *aims, "--among", "oil=all").json
    rows = found["alternatives"]
    assert {"PAOR", "MINR", "ISO VG 220 PAO"} <= {row["oil"] for row in rows} and len(rows) > 20
    met = [row["met"] for row in rows]
    assert met == sorted(met, reverse=True) and 0 < sum(met) < len(met)
    for row in rows:
        values = row["values"]
        assert row["met"] == (values["oil.T"] <= 80 and values["gear_set.Lambda_sp"] >= 0.25)
    answer = gearheat("design", "planetary", *aims, "--among", "foot=all")
    assert answer.code == 2 and "catalogue" in answer.err


def test_design_without_solution_says_so_and_ends_with_two(gearheat):
    answer = gearheat("design", "planetary", "--free", "cooling.A", "--target", "oil.T=5 degC")
    assert answer.code == 2
    assert "design" in answer.err and "Traceback" not in answer.err
