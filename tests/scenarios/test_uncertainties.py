"""Standard uncertainties of values: read in the unit of the value, gone with a value that is replaced."""

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
