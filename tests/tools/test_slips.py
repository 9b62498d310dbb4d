"""Slips of a digit, a unit, a sign or a name: each is refused with what would do, before anything is solved."""

from __future__ import annotations

import pytest
from gearheat.model.errors import GearheatError
from gearheat.model.units import to_si
from gearheat.scenarios.load import load
from gearheat.scenarios.ranges import RANGES, override
from gearheat.scenarios.shipped import RIGS
from gearheat.tools.solve.settings import adjust

RIG = "helical_two_stage"
BEYOND = "is beyond what gear units have"
#: What is set -> words of the answer.
SET = {
    "room.T=293 degC": "out of range",
    "room.T=20": "has no unit",
    "room.T=20 bar": "does not fit",
    "room.T=-300 degC": "at least -60 degC",
    "room.air_speed=300 m/s": f"{BEYOND}, 0 m/s to 60 m/s",
    "room.air_speed=-1 m/s": "out of range",
    "input.w=1450": 'has no unit. Write "1450 rpm"',
    "input.w=1450 Hz": BEYOND,
    "input.w=1,450 rpm": "decimal comma",
    "input.w=145000 rpm": BEYOND,
    "input.n=1450 rpm": 'unknown name "input.n"',
    "inptu.w=1450 rpm": 'Did you mean "input.w"',
    "output.tau=-590 N": "does not fit",
    "output.tau=-590 MN.m": BEYOND,
    "output.load=-590 N.m": "at least 0 N.m",
    "oil.V=3500 m3": BEYOND,
    "oil.V=-3 l": "out of range",
    "oil.nu_40=220 m2/s": "out of range|cannot be of a gearbox|beyond",
    "oil.nu_40=220 cP": "does not fit",
    "oil=ISO VG 222 mineral": "Did you mean",
    "cooling.A=4300 m2": BEYOND,
    "cooling.A=0.43 m": "does not fit",
    "cooling.emissivity=9": "out of range",
    "cooling.height=250 m": BEYOND,
    "cooling.fin_height=25 m": BEYOND,
    "stage_1.z_1=20.5": "whole",
    "stage_1.z_1=0": "out of range",
    "stage_1.m_n=2 m": BEYOND,
    "stage_1.m_n=2": 'has no unit. Write "2 mm"',
    "stage_1.b=32 m": BEYOND,
    "stage_1.b=-32 mm": "out of range",
    "stage_1.a_w=100 m": BEYOND,
    "stage_1.beta=14.07 rad": "beyond|out of range",
    "stage_1.alpha_n=2 deg": BEYOND,
    "stage_1.Ra=0.5 mm": BEYOND,
    "stage_1.E=206 MPa": "at least 500 MPa",
    "stage_1.poisson=3": "out of range",
    "stage_1.k_mu=100": BEYOND,
    "input_seal.d_sh=3 m": BEYOND,
    "rotor.J=0.0016 kg.mm": "does not fit",
    "gears.C=5e10 J/K": BEYOND,
    "foot.G=4 MW/K": BEYOND,
    "input_support.span=128 m": BEYOND,
    "drives=outptu": 'Did you mean "output"',
}
#: In the rig file, what stands for what -> words of the answer.
WRITTEN = {
    ('b = "32 mm"', "b = 32"): 'has no unit. Write "32 mm"',
    ('b = "32 mm"', 'b = "32 cm2"'): "does not fit",
    ('b = "32 mm"', 'b = "3,2 cm"'): "decimal comma",
    ('a_w = "100 mm"', 'a_w = "110 mm"'): "a_w = 100 mm fits these teeth",
    ("z_2 = 77", "z_2 = 70"): "a_w = 92.7",
    ('bearing = "SKF 6306"', 'bearing = "SKF 6366"'): "Did you mean",
    ('bearing = "SKF 6306"', "bearing = 6306"): "Did you mean",
    ('type = "HelicalGearPair"', 'type = "HelicalGear"'): "Did you mean",
    ('span = "128 mm"', 'spam = "128 mm"'): 'Did you mean "span"',
    ('input.w = "1450 rpm"', 'input.w = "1450 m/min"'): "does not fit",
    ('input.w = "1450 rpm"', ""): "input.w is missing",
    ('room.T = "20 degC"', 'room.T = "20 °F/K"'): "room.T",
    ('Ra = "0.5 um"', 'Ra = "0.5 mm"'): BEYOND,
}


@pytest.fixture(scope="module")
def rig():
    return load(RIGS / RIG / "rig.toml")


@pytest.mark.parametrize("text", SET)
def test_what_is_set_by_a_slip_is_refused(rig, text):
    with pytest.raises(GearheatError, match=SET[text]):
        adjust(rig, [text])


@pytest.mark.parametrize(("right", "wrong"), WRITTEN)
def test_what_is_written_by_a_slip_is_refused(rig, tmp_path, right, wrong):
    text = rig.path.read_text("utf-8")
    assert right in text
    (path := tmp_path / "rig.toml").write_text(text.replace(right, wrong, 1), "utf-8")
    with pytest.raises(GearheatError, match=WRITTEN[right, wrong]):
        load(path)


def test_what_is_meant_is_taken_all_the_same(rig, gearheat):
    with override():
        assert adjust(rig, ["room.air_speed=80 m/s"]).spec.part("room").values["air_speed"] == 80.0
    answer = gearheat("steady", RIG, "--set", "room.air_speed=80 m/s", "--override")
    assert answer.code == 0 and "speed of the air" in answer.out
    assert gearheat("steady", RIG, "--set", "room.air_speed=80 m/s").code == 2


def test_ranges_have_ends_in_their_order():
    for unit, by_key in RANGES.items():
        for key, ends in by_key.items():
            low, high = (to_si(end, unit, name=key) for end in ends)
            assert 0 <= low < high, key
