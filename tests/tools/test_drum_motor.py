"""Drum motors on the command line: the belt that keeps the oil cool, and what cannot be."""

import pytest

RIGS = ("drum_motor", "drum_motor_planetary")


@pytest.mark.parametrize(("rig", "target", "low", "high"), [("drum_motor", 70, 14, 20), (RIGS[1], 55, 4, 12)])
def test_design_finds_what_the_belt_has_to_take(gearheat, rig: str, target: int, low: float, high: float) -> None:
    answer = gearheat("design", rig, "--free", "belt.h", "--target", f"oil.T={target} degC", "--json", "-")
    assert answer.code == 0, answer.err
    h = answer.json["free"]["belt.h"]
    assert low < h < high
    steady = gearheat("steady", rig, "--set", f"belt.h={h!r} W/(m2.K)", "--json", "-").json
    assert steady["values"]["oil.T"] == pytest.approx(target, abs=1e-6)
    assert steady["energy_residual"] < 1e-9


@pytest.mark.parametrize("rig", RIGS)
@pytest.mark.parametrize(
    ("assignment", "problem"),
    [
        ("motor.eta=1.2", 'motor.eta = "1.2" is out of range. It must be below 1.'),
        ("motor.eta=1", 'motor.eta = "1" is out of range. It must be below 1.'),
        ("motor.eta=0", 'motor.eta = "0" is out of range. It must be above 0.'),
        ("motor.eta=-0.1", 'motor.eta = "-0.1" is out of range. It must be above 0.'),
        ("oil.beta=0", 'oil.beta = "0" is out of range. It must be above 0.'),
        ("oil.beta=1.4", 'oil.beta = "1.4" is out of range. It must be at most 1.'),
        ("belt.h=-3 W/(m2.K)", "belt.h = "),
        ("belt_pull.k_pull=0.5", "belt_pull.k_pull = "),
    ],
)
def test_values_that_cannot_be_are_refused_by_name(gearheat, rig: str, assignment: str, problem: str) -> None:
    answer = gearheat("steady", rig, "--set", assignment)
    assert answer.code == 2
    assert answer.err.startswith(f"error: {problem}") and "Traceback" not in answer.err


def test_an_efficiency_that_a_sweep_takes_out_of_its_range_is_refused(gearheat, tmp_path) -> None:
    answer = gearheat("sweep", RIGS[0], "--vary", "motor.eta=0.5..1.5", "--grid", "5", "-o", tmp_path / "s.csv")
    assert answer.code == 2 and 'motor.eta = "1.5"' in answer.err


@pytest.mark.parametrize(
    ("rig", "target"), [("drum_motor", "mesh.h_min=200 um"), ("drum_motor_planetary", "gear_set.Lambda_sp=50")]
)
def test_a_film_that_no_speed_gives_is_refused_by_name(gearheat, rig: str, target: str) -> None:
    answer = gearheat("design", rig, "--free", "motor_shaft.w", "--target", target)
    assert answer.code == 2
    assert f"design: {target.partition('=')[0]} reaches" in answer.err and "out of reach" in answer.err


@pytest.mark.parametrize("rig", RIGS)
def test_a_run_without_measured_data_is_its_operating_point(gearheat, rig: str, tmp_path) -> None:
    found = gearheat("run", rig, "--out", tmp_path / "out", "--jobs", "1", "--json", "-").json
    assert len(found["rows"]) == 1 and found["energy_residual_max"] < 1e-6
