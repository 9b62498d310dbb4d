"""What would be read otherwise than meant, or be lost, is refused: twice the same, in two places, in one file."""

import pytest

DUTY = "time [min],carrier.w [rpm],carrier.tau [N.m]{}\n0,100,1500{}\n60,100,1500{}\n"


@pytest.fixture
def duty(tmp_path):
    """A duty, with a column more."""

    def written(head="", cell=""):
        path = tmp_path / "duty.csv"
        path.write_text(DUTY.format(head, cell, cell))
        return path

    return written


@pytest.fixture(scope="module")
def fmu(tmp_path_factory):
    """An FMU of the planetary gearbox for this machine."""
    from gearheat import export

    path = tmp_path_factory.mktemp("fmu") / "planetary.fmu"
    export("planetary", path, platform="host", sources=False)
    return path


def refused(answer, *words):
    assert answer.code == 2, answer.err
    assert not answer.out
    for word in words:
        assert word in answer.err, answer.err


@pytest.mark.parametrize("head", ["carrier.w [rad/s]", "carrier.w [Hz]", "carrier.tau [kN.m]"])
def test_an_input_of_a_duty_twice(gearheat, duty, tmp_path, head):
    answer = gearheat("simulate", "planetary", "--duty", duty(f",{head}", ",1"), "-o", tmp_path / "out.csv")
    refused(answer, f"duty.csv line 1: {head.split()[0]} is there twice")


#: What is set beside a duty -> words of the answer.
SET = {
    "carrier.w=200 rpm": "carrier.w is set, and duty.csv gives it over time",
    "carrier.tau=2 kN.m": "carrier.tau is set, and duty.csv gives it over time",
}


@pytest.mark.parametrize("text", SET)
def test_what_the_duty_gives_cannot_be_set(gearheat, fmu, duty, tmp_path, text):
    rest = ("--duty", duty(), "-o", tmp_path / "out.csv", "--set", text)
    refused(gearheat("simulate", "planetary", *rest), SET[text])
    refused(gearheat("play", fmu, *rest), SET[text])
    sweep = ("sweep", "planetary", "--kind", "warmup", "--vary", "room.T=20..30 degC", "--sample", "2")
    refused(gearheat(*sweep, *rest), SET[text].replace("duty.csv", "the duty"))


@pytest.mark.parametrize(
    ("texts", "words"),
    [
        (("cooling.A=1 m2", "cooling.A=2 m2"), '"cooling.A" is set twice'),
        (("cooling.A=1e30 m2",), "cannot be of a gearbox"),
        (("cooling.A=-1 m2",), "out of range"),
        (("foot.G=nan W/K",), "not finite"),
        (("oil.T=1e9 degC",), "out of range"),
        (("oil.T=25",), "has no unit"),
        (("oil.T=25 K",), "out of range"),
        (("oil.T=nan degC",), "is not finite"),
        (("oil.V=0 l",), "out of range"),
        (("oil.V=1 m2",), "does not fit"),
        (("oil.P=1 W",), "oil.P"),
        (("gear_set.P_loss_sp=1 W",), "gear_set.P_loss_sp"),
        (("oil.V",), "oil.V"),
        (("oil=nope",), "cannot be set"),
        (("oil=MINR",), 'Write "oil.oil=MINR"'),
    ],
)
def test_what_is_set_of_an_fmu(gearheat, fmu, duty, tmp_path, texts, words):
    given = [word for text in texts for word in ("--set", text)]
    refused(gearheat("play", fmu, "--duty", duty(), "-o", tmp_path / "out.csv", *given), words)


@pytest.mark.parametrize(
    "command",
    [
        "steady planetary --json x.svg --plot x.svg",
        "simulate planetary --duty {duty} -o x.csv --json x.csv",
        "simulate planetary --duty {duty} -o x.svg --plot ./x.svg",
        "sweep planetary --vary room.T=20..30§degC --sample 2 -o x --json x",
        "map planetary -o x.svg --plot x.svg",
        "rating planetary --limit oil.T=90§degC -o x --json ./x",
        "export planetary -o x --json x",
        "play {fmu} --duty {duty} -o x --json x",
        "card planetary -o x.json --json x.json",
        "diagnose {duty} --rig planetary --json x --report x",
        "verify --html x --json x",
    ],
)
def test_two_outputs_in_one_file(gearheat, fmu, duty, tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    words = command.format(duty=duty(), fmu=fmu).split()
    refused(gearheat(*(word.replace("§", " ") for word in words)), "both name", "a file of its own")
    assert not list(tmp_path.glob("x*"))


@pytest.mark.parametrize("depth", ["900 mm", "1 m"])
def test_a_wheel_dips_no_deeper_than_it_is_high(gearheat, depth):
    refused(
        gearheat("losses", "helical_two_stage", "--method", "iso14179-1", "--dip", f"stage_1.wheel={depth}"),
        "cannot dip",
    )


@pytest.mark.parametrize("module", ["ziglang.__main__", "venv.__main__", "antigravity"])
def test_a_rig_file_runs_no_code(gearheat, rig, module):
    rig.line("part.foot", "G", f'type = "{module}:X"\nG = "1 W/K"')
    refused(gearheat("steady", rig), f"add --parts {module}")


def test_a_module_that_the_user_names(gearheat, rig, tmp_path, monkeypatch):
    from gearheat.scenarios import own_types

    monkeypatch.setattr(own_types, "_NAMED", set())
    text = "from gearheat.model.parts.thermal import ThermalConductor as Base\nclass Strap(Base): 'A strap.'\n"
    (tmp_path / "strap_parts.py").write_text(text)
    monkeypatch.syspath_prepend(str(tmp_path))
    rig.line("part.foot", "G", 'type = "strap_parts:Strap"\nG = "1 W/K"')
    refused(gearheat("steady", rig), "add --parts strap_parts")
    assert gearheat("steady", rig, "--parts", "strap_parts").code == 0
