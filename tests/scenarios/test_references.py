"""Values that follow from another part of the rig."""

from __future__ import annotations

from pathlib import Path

import pytest
from gearheat.model.errors import GearheatError, ScenarioError
from gearheat.scenarios.load import RIGS, load
from gearheat.tools.solve.settings import adjust

TEXT = (RIGS / "helical_two_stage" / "rig.toml").read_text(encoding="utf-8")
PINION, MIDDLE = 'r = "20.619 mm"', 'r_2 = "29.321 mm"'


@pytest.fixture
def rig(tmp_path: Path):
    """The rig with texts in the place of others."""

    def change(*pairs: tuple[str, str]) -> Path:
        text = TEXT
        for old, new in pairs:
            assert text.count(old) >= 1, old
            text = text.replace(old, new, 1)
        (path := tmp_path / "mine.toml").write_text(text, encoding="utf-8")
        return path

    return change


def values(scenario, part):
    return scenario.spec.part(part).values


def test_it_follows_what_the_file_says_and_what_is_set(rig):
    pairs = (PINION, 'r = "stage_1.r_1"'), (MIDDLE, 'r_2 = "stage_2.r_1"'), ('x = "40 mm"', 'x = "stage_1.b"')
    scenario, usual = load(rig(*pairs)), load("helical_two_stage")
    assert values(scenario, "input_support")["r"] == pytest.approx(values(usual, "input_support")["r"], rel=1e-3)
    assert values(scenario, "input_support")["x"] == values(scenario, "stage_1")["b"]
    larger = {"stage_1.z_1": "21", "stage_1.z_2": "76"}
    other = adjust(scenario, larger)
    ratio = values(other, "input_support")["r"] / values(scenario, "input_support")["r"]
    assert ratio == pytest.approx(21 / 20)
    assert values(other, "middle_support")["r_2"] == values(scenario, "middle_support")["r_2"]
    assert values(adjust(scenario, larger | {"input_support.r": "20 mm"}), "input_support")["r"] == 0.02


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ([(PINION, 'r = "stage_1.r_3"')], 'r = "stage_1.r_3": stage_1 has no value "r_3". Did you mean "r_'),
        ([(PINION, 'r = "stage_1.z_1"')], 'r = "stage_1.z_1" is in 1, expected m'),
        ([(PINION, 'r = "input_support.x"')], "input_support refer to each other. Write a number"),
        ([(PINION, 'r = "stage_9.r_1"')], '"stage_9.r_1" is no number with a unit'),
        ([(PINION, 'r = "stage_1.r_1"'), ("m_n = ", "m_m = ")], 'unknown key "m_m"'),
    ],
)
def test_what_cannot_be_followed_is_told_alone(rig, changes, words):
    with pytest.raises(ScenarioError) as raised:
        load(rig(*changes))
    assert len(raised.value.problems) == 1 and words in raised.value.problems[0]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('level = "63 mm"', 'level = "630 mm"', "oil.level = 630 mm is above the top of the housing: cooling.height"),
        ('V = "4 l"', 'V = "40 l"', "oil.V = 40 l is more than cooling holds, 29.57 l"),
        ('V = "4 l"', 'V = "8 l"', "Give at most 5.821 l, or a level of at least 86.58 mm"),
        ('room.T = "20 degC"', 'room.T = "293 degC"', "out of range. It must be at most 150 degC"),
    ],
)
def test_oil_and_housing_fit_and_the_room_is_no_oven(rig, old, new, words):
    with pytest.raises(ScenarioError) as raised:
        load(rig((old, new)))
    assert words in raised.value.problems[0]


def test_a_seal_is_of_the_size_of_its_shaft(rig):
    with pytest.raises(GearheatError, match=r"output_seal is on a shaft of d_sh = 500 mm, and output_bearing_a on"):
        load(rig(('d_sh = "55 mm"', 'd_sh = "500 mm"'))).spec.flat()


def test_what_is_set_fits_too():
    with pytest.raises(ScenarioError, match=r"oil.level = 400 mm is above the top of the housing"):
        adjust(load("helical_two_stage"), {"oil.level": "400 mm"})
