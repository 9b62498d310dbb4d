"""Bad input ends with exit code 2, every problem at once, no traceback, and nothing lost."""

from __future__ import annotations

import subprocess
import sys

import pytest

DUTY = "time [min],carrier.w [rpm],carrier.tau [N.m],room.T [degC]\n0,100,1500,25\n60,100,1500,25\n"


def refused(answer, *words: str) -> None:
    assert answer.code == 2, answer.err
    assert answer.out == ""
    assert "Traceback" not in answer.err
    for word in words:
        assert word in answer.err, answer.err


def test_all_problems_of_a_rig_file_come_at_once(gearheat, rig):
    rig.line("part.gears", "C", 'C = "-3600 J/K"')  # out of range
    rig.line("part.carrier_body", "C", "")  # missing
    rig.line("part.cooling", "material", "emissivity = 1.2")  # out of range
    rig.line("part.cooling", "A", "A = 0.80")  # no unit
    rig.line("part.cooling", "share_ends", "share_end = 0.33")  # unknown
    rig.line("part.oil", "V", 'V = "1 kg"')  # wrong unit
    rig.line("part.oil", "oil", 'oil = "PAOX"')  # unknown oil
    rig.line("part.carrier_bearing", "bearing", 'bearing = "SKF 32022"')  # unknown bearing
    rig.line("operating_point", "room.T", 'room.T = "-300 degC"')  # below absolute zero
    answer = gearheat("steady", rig)
    refused(
        answer, "C = ", "emissivity", "has no unit", "1 kg", "share_end", 'Did you mean "share_ends"', "C is missing"
    )
    refused(answer, 'Did you mean "PAOR"', "SKF 32022 X", "room.T")
    assert len(answer.problems()) >= 9
    assert "rig.toml [part.gears]" in answer.err


def test_unknown_rig_is_answered_with_a_suggestion(gearheat):
    refused(gearheat("steady", "planetry"), '"planetry"', 'Did you mean "planetary"')


@pytest.mark.parametrize("command", ["run", "losses", "show", "steady"])
def test_rig_file_that_is_no_toml(gearheat, tmp_path, command):
    (tmp_path / "bad.toml").write_text("kind = \n")
    arguments = ["--out", tmp_path / "out"] if command == "run" else []
    refused(gearheat(command, tmp_path / "bad.toml", *arguments), "bad.toml line 1")


def test_all_problems_of_the_command_line_come_at_once(gearheat):
    answer = gearheat(
        "steady", "planetary",
        "--set", "carrier.tau=2500", "--set", "carrier.w=250 kg", "--set", "cooling.emissivity=1.2",
        "--set", "room.T=-1 K", "--set", "carier.w=1 rpm", "--set", "cooling", "--set", "oil=PAOX",
        "--set", "gear_set.power_flow=other", "--set", "foot.G=1 W/K", "--set", "foot.G=2 W/K",
    )  # fmt: skip
    refused(answer, "has no unit", "kg", "1.2", "room.T", "carrier.w", "PAOX", "ideal", "set twice")
    assert len(answer.problems()) >= 9


def test_a_result_cannot_be_set(gearheat):
    refused(gearheat("steady", "planetary", "--set", "efficiency.eta=1"), "efficiency.eta")


def test_design_reports_targets_and_free_names_together(gearheat):
    answer = gearheat(
        "design", "planetary", "--free", "cooling.AA", "--target", "oil.T=80", "--target", "oil.X=1 K", "--set", "x=1"
    )
    refused(answer, "cooling.AA", "has no unit", "oil.X", '"x"')


def test_counts_of_free_names_and_targets_must_agree(gearheat):
    refused(gearheat("design", "planetary", "--free", "cooling.A", "--free", "foot.G", "--target", "oil.T=80 degC"))


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        (("carrier.tau=300000 N.m",), ("no solution", "3e+05 N.m", "loss grows faster than the cooling")),
        (("carrier.tau=2500 N.m", "sun.tau=-500 N.m"), ("no solution", "balance at no speed")),
    ],
)
def test_no_steady_state(gearheat, settings, words):
    refused(gearheat("steady", "planetary", *(a for s in settings for a in ("--set", s))), *words)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", ("empty",)),
        ("time [min],carrier.w [rpm]\n", ("no row",)),
        (DUTY.replace("60,100,1500,25", "60,fast,1500,25"), ("line 3", "fast")),
        (DUTY.replace("60,100,1500,25", "60,nan,1500,25"), ("line 3", "finite")),
        (DUTY.replace("60,100,1500,25", "-1,100,1500,25"), ("line 3", "time goes back")),
        (DUTY + "60,90,1500,25\n60,80,1500,25\n", ("line 5", "three times")),
        (DUTY.replace("carrier.w [rpm]", "carier.w [rpm]"), ("carrier.w",)),
        (DUTY.replace("[rpm]", "[kg]"), ("unit does not fit",)),
        (DUTY.replace("[rpm]", "[1/s]"), ("may mean revolutions or radians", "[Hz]", "[rad/s]")),
        (DUTY.replace("60,100,1500,25", "60,100,1500,-400"), ("line 3", "room.T")),
    ],
)
def test_duties_that_are_wrong(gearheat, tmp_path, text, words):
    (tmp_path / "duty.csv").write_text(text)
    answer = gearheat("simulate", "planetary", "--duty", tmp_path / "duty.csv", "-o", tmp_path / "out.csv")
    refused(answer, "duty.csv", *words)
    assert not (tmp_path / "out.csv").exists()


def test_a_duty_that_is_not_there_and_one_that_is_no_text(gearheat, tmp_path):
    refused(gearheat("simulate", "planetary", "--duty", tmp_path / "no.csv", "-o", tmp_path / "o.csv"), "no such file")
    (tmp_path / "bytes.csv").write_bytes(b"\xff\x00\x00\x9d" * 10)
    refused(gearheat("simulate", "planetary", "--duty", tmp_path / "bytes.csv", "-o", tmp_path / "o.csv"), "UTF-8")


def test_measured_tables_that_are_wrong(gearheat, rig):
    table = rig.folder / "measured.csv"
    good = table.read_text()
    head, first, *rest = good.splitlines()
    cells = dict(zip(head.split(","), first.split(","), strict=True))

    def changed(**values: str) -> str:
        return "\n".join([head, ",".join((cells | values).values()), *rest])

    for text, words in (
        (changed(T_oil_C="warm"), ("line 2", "T_oil_C", "warm")),
        (changed(T_carrier_Nm="nan"), ("line 2", "T_carrier_Nm", "finite")),
        (changed(oil="PAOX"), ("line 2", "PAOX", "PAOR")),
        (good.replace("T_carrier_Nm", "T_carier_Nm"), ("T_carrier_Nm", "T_carier_Nm")),
        (head, ("no row",)),
    ):
        table.write_text(text)
        refused(gearheat("losses", "planetary", "--data", table), "measured.csv", *words)


def test_results_that_cannot_be_compared(gearheat, rig, tmp_path):
    data, result = rig.folder / "measured.csv", tmp_path / "result.csv"
    for text, words in (
        ("T_oil_C\n50\n", ("rows have no name",)),
        ("point,speed\n1,2\n", ("nothing to compare",)),
        ("point,T_oil_C\n1,hot\n2,50\n999,50\n", ("line 2", "hot")),
        ("point,T_oil_C\n1,50\n1,51\n999,50\n", ("line 3", "twice", "line 4", "no reading")),
    ):
        result.write_text(text)
        refused(gearheat("compare", result, data, "--rig", "planetary"), "result.csv", *words)


def test_output_that_cannot_be_written_is_refused_before_the_work(gearheat, tmp_path):
    (tmp_path / "file").write_text("not a folder")
    (tmp_path / "duty.csv").write_text(DUTY)
    refused(gearheat("run", "planetary", "--out", tmp_path / "file"), "cannot be written")
    refused(gearheat("run", "planetary", "--out", tmp_path / "file" / "deeper"), "cannot be written")
    duty = ("--duty", tmp_path / "duty.csv")
    refused(gearheat("simulate", "planetary", *duty, "-o", tmp_path / "no" / "out.csv"), "cannot be written")
    refused(gearheat("export", "planetary", "-o", tmp_path), "cannot be written")
    refused(gearheat("steady", "planetary", "--json", tmp_path / "no" / "a.json"), "cannot be written")
    assert (tmp_path / "file").read_text() == "not a folder"


def test_an_fmu_that_is_none(gearheat, tmp_path):
    (tmp_path / "duty.csv").write_text(DUTY)
    (tmp_path / "no.fmu").write_text("this is no zip file")
    arguments = ("--duty", tmp_path / "duty.csv", "-o", tmp_path / "out.csv")
    refused(gearheat("play", tmp_path / "no.fmu", *arguments), "no FMU")
    refused(gearheat("play", tmp_path / "missing.fmu", *arguments), "no such file")


@pytest.mark.parametrize("tests", ["0", "37", "1-40", "one", "3-", ""])
def test_tests_that_the_campaign_does_not_have(gearheat, tmp_path, tests):
    refused(gearheat("run", "planetary", "--out", tmp_path / "out", "--tests", tests), "--tests")


def test_shaft_ends_that_do_not_exist(gearheat, tmp_path):
    refused(gearheat("export", "planetary", "-o", tmp_path / "a.fmu", "--drive", "carier"), 'Did you mean "carrier"')
    refused(
        gearheat("export", "planetary", "-o", tmp_path / "a.fmu", "--drive", "carrier", "--set", "sun.w=1000 rpm"),
        "sun.w",
    )


def test_calibration_that_makes_no_sense(gearheat):
    refused(gearheat("calibrate", "planetary", "--grid", "PAOR", "--free", "cooling.A"), "PAOR-16")
    refused(
        gearheat("calibrate", "planetary", "--grid", "PAOR-16", "--free", "oil.T", "--free", "cooling.B"),
        "no parameter",
        "cooling.B",
    )
    refused(
        gearheat("calibrate", "planetary", "--grid", "PAOR-16", "--free", "foot.G", "--bounds", "foot.G=5 W/K"),
        "--bounds",
    )


def test_a_process_ends_with_two_and_an_empty_stdout():
    command = [sys.executable, "-m", "gearheat.tools.cli", "steady", "planetry", "--json", "-"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith("error: ") and "Traceback" not in done.stderr


def test_a_path_that_no_system_has(gearheat, tmp_path):
    refused(gearheat("diagnose", "y" * 300, "--rig", "planetary"), "File name too long. Check the path.")
    refused(gearheat("card", "planetary", "-o", tmp_path / "card.xml"), "must end in .toml or .json")
