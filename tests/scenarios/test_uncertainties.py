"""Standard uncertainties of values: read in the unit of the value, gone with a value that is replaced."""

import math
from collections.abc import Callable
from pathlib import Path

import pytest
from gearheat.scenarios.load import RIGS, load

G = 'uncertainties = { G = "0.19 W/K" }'


def test_the_calibrated_value_states_its_uncertainty() -> None:
    scenario = load("planetary")
    assert scenario.uncertainties == {"foot.G": 0.19}
    assert scenario.value_sources["foot.G"].startswith("calibrated: ")
    assert scenario.with_values({"foot.G": 9.0}).uncertainties == {}
    assert scenario.with_values({"cooling.A": 0.5}).uncertainties == {"foot.G": 0.19}


def test_values_are_uncertain_together(tmp_path: Path) -> None:
    text = (RIGS / "planetary" / "rig.toml").read_text(encoding="utf-8").replace('data = "measured.csv"\n', "")
    text += '\n[uncertainties.heat]\n"cooling.A" = "-0.03 m2"\nfoot.G = "0.25 W/K"\n'
    (path := tmp_path / "rig.toml").write_text(text, encoding="utf-8")
    rig = load(path)
    assert rig.joint_uncertainties == {"heat": {"cooling.A": -0.03, "foot.G": 0.25}}
    assert rig.standard_uncertainties == pytest.approx({"foot.G": math.hypot(0.19, 0.25), "cooling.A": 0.03})
    assert rig.with_values({"foot.G": 9.0}).joint_uncertainties == {"heat": {"cooling.A": -0.03}}
    assert rig.rough == set()  # both are calibrated
    assert rig.rules == {}


@pytest.mark.parametrize(
    ("written", "told"),
    [
        ('"cooling.B" = "1 m2"', 'there is no value "cooling.B"'),
        ('"cooling.A" = "1 m"', "cooling.A"),
        ('"cooling.A" = 1.0', "has no unit"),
        ('"gear_set.b" = "42 m"', "is 1e+03 times the value. Check its unit."),
    ],
)
def test_what_is_wrong_with_them_is_told(problems: Callable[..., tuple[str, ...]], written: str, told: str) -> None:
    (problem,) = problems(("[sensors]", f"[uncertainties.heat]\n{written}\n\n[sensors]"))
    assert "[uncertainties.heat]" in problem and told in problem


def test_units_are_converted_and_a_temperature_is_uncertain_by_a_difference(tmp_path: Path) -> None:
    text = (RIGS / "planetary" / "rig.toml").read_text(encoding="utf-8").replace('data = "measured.csv"\n', "")
    text = text.replace(G, 'uncertainties = { G = "190 mW/K" }')
    text = text.replace("[part.wall]\n", '[part.wall]\nT = "30 degC"\nuncertainties = { T = "1.5 degC" }\n')
    (path := tmp_path / "rig.toml").write_text(text, encoding="utf-8")
    assert load(path).uncertainties == pytest.approx({"foot.G": 0.19, "wall.T": 1.5})


@pytest.mark.parametrize(
    ("written", "told"),
    [
        ('uncertainties = { g = "0.19 W/K" }', "no such value. Values: G."),
        ('uncertainties = { G = "0.19 m" }', "does not fit W/K"),
        ("uncertainties = { G = 0.19 }", "has no unit"),
        ('uncertainties = { G = "-0.19 W/K" }', "is below zero"),
        ('uncertainties = "0.19 W/K"', "is no table"),
    ],
)
def test_what_is_wrong_is_told(problems: Callable[..., tuple[str, ...]], written: str, told: str) -> None:
    (problem,) = problems((G, written))
    assert "[part.foot]" in problem
    assert told in problem
