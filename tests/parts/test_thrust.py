"""Bearings set against each other: their axial loads by the makers' table of cases, and the friction that follows."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from broken_assemblies import set_against
from gearheat.model.core.flatten import flatten
from gearheat.model.errors import StructureError
from gearheat.model.machines.spec import PartSpec
from gearheat.model.parts import PARTS
from gearheat.scenarios.load import load
from one_part import EXAMPLES

#: A 30208 and a 7208 B [SKF2017, series 302; SKF2018, series 72 BE], in oil of 50 mm2/s at 1450 rpm.
SIZE = dict(count=1.0, F_r_0=0.0, F_a_0=0.0, d=0.040, D=0.080, d_m=0.060, K_rs=0.0, oil_bath=False)
BEARINGS = {
    "TaperedRollerBearing": SIZE | dict(R_1=1.76e-6, R_2=10.9, S_1=0.017, S_2=2.0, Y=1.6),
    "AngularContactBallBearing": SIZE | dict(R_1=4.33e-7, R_2=2.02, R_3=0.0, S_1=0.0182, S_2=0.71, S_3=0.0, Y=0.57),
}
RUNNING = {"shaft.w": 1450 * math.pi / 30, "lubricant.nu": 50e-6, "mu_sl": 0.05}


def bearing(kind: str, **values: float):
    return PARTS[kind]("bearing", **EXAMPLES[kind] | BEARINGS[kind] | values)


def case_table(S_A: float, S_B: float, K_a: float) -> tuple[float, float]:
    """Axial loads of A and B by the makers' six cases; K_a pushes towards B, or where negative towards A."""
    if K_a < 0:
        return case_table(S_B, S_A, -K_a)[::-1]
    if S_A >= S_B or K_a >= S_B - S_A:  # cases 1a and 1b
        return S_A, S_A + K_a
    return S_B - K_a, S_B  # case 1c


@pytest.mark.parametrize("arrangement", ["face-to-face", "back-to-back"])
@pytest.mark.parametrize("loads", [(4000, 2000), (2000, 4000), (3000, 3000), (500, 6000)], ids=str)
@pytest.mark.parametrize("pushed", [0, 300, 2500, -300, -2500])
def test_axial_loads_are_those_of_the_table(arrangement, loads, pushed) -> None:
    """The force of the gear is positive towards a: face to face bearing a carries it, back to back bearing b."""
    parts = [bearing("TaperedRollerBearing", Y=Y) for Y in (1.4, 1.8)]
    thrusts = [F / (2 * Y) for F, Y in zip(loads, (1.4, 1.8), strict=True)]
    support = PARTS["ShaftSupport"]("support", arrangement=arrangement, span=0.1, x=0.05, r=0.0)
    forces = {"mesh.F_t": 0.0, "mesh.F_r": 0.0, "mesh.F_a": pushed}
    own = [p.number_at(p.own_thrust(), p.values | {"load.F_r": F}) for p, F in zip(parts, loads, strict=True)]
    assert own == pytest.approx(thrusts, rel=1e-5)  # rounded over 1 N
    forces |= {f"thrust_{k}.F": S for k, S in zip("ab", own, strict=True)}
    asked = {e.name: support.number_at(e.rhs, support.values | forces) for e in support.equations()}
    carried = [
        p.number_at(p.loads()[1], p.values | {"load.F_r": F, "load.F_a": asked[f"bearing {k} axially"]})
        for k, p, F in zip("ab", parts, loads, strict=True)
    ]
    expected = case_table(*thrusts, -pushed if arrangement == "face-to-face" else pushed)
    assert carried == pytest.approx(expected, abs=1.1)  # rounded over 1 N where cases meet


@pytest.mark.parametrize(
    ("kind", "rolling", "sliding"),
    [
        ("TaperedRollerBearing", (1 + 10.9 / 2) ** 0.31, 1 + 2.0 / 2),  # 1.78 and 2
        ("AngularContactBallBearing", (1 + 2.02 * 0.88) ** 0.54, 1 + 0.71 * 0.88 ** (4 / 3)),  # 1.73 and 1.60
    ],
)
def test_a_radial_load_alone_has_the_friction_of_its_thrust(kind, rolling, sliding) -> None:
    part = bearing(kind)
    at = part.values | RUNNING | {"load.F_r": 3000.0, "load.F_a": 0.0}
    G_rr, G_sl = (part.number_at(G, at) for G in part.geometric_variables())
    F, d_m = 3000.0, 60.0
    if kind == "TaperedRollerBearing":
        plain = 1.76e-6 * d_m**2.38 * F**0.31, 0.017 * d_m**0.82 * F
    else:
        plain = 4.33e-7 * d_m**1.97 * F**0.54, 0.0182 * d_m**0.26 * F ** (4 / 3)
    assert (G_rr, G_sl) == pytest.approx((rolling * plain[0], sliding * plain[1]), rel=3e-3)


def test_two_rows_of_balls_push_no_shaft() -> None:
    part = bearing("AngularContactBallBearing", i_rw=2.0)
    assert part.number_at(part.own_thrust(), part.values | {"load.F_r": 3000.0}) == 0.0
    assert part.holds() == 2


@pytest.mark.parametrize("arrangement", ["face-to-face", "back-to-back"])
def test_a_shaft_on_two_tapered_bearings_flattens(arrangement) -> None:
    assert [q.name for q in flatten(set_against(arrangement)).states] == ["oil.T", "wall.T"]


def test_a_pair_under_a_support_that_is_arranged_otherwise_is_refused() -> None:
    spec = load("helical_two_stage").spec
    values = EXAMPLES["PreloadedPair"] | {"arrangement": "back-to-back"}
    nets = [("pair.support_a", "output_support.load_a"), ("pair.support_b", "output_support.load_b")]
    nets += [(f"pair.{key}", f"{body}.heat") for key, body in (("inner", "shafts"), ("outer", "wall"))]
    nets += [(f"{part}.thrust_{k}", f"output_bearing_{k}.thrust") for part in ("pair", "output_support") for k in "ab"]
    spec = spec.with_parts([PartSpec("pair", "PreloadedPair", values)], nets)
    output = spec.part("output_support")
    given = {key: value for key, value in output.values.items() if key != "axial_share_a"}
    spec = replace(spec, parts=tuple(replace(p, values=given) if p is output else p for p in spec.parts))
    with pytest.raises(StructureError, match="output_support is face-to-face and pair back-to-back") as caught:
        spec.with_values({"output_support.arrangement": "face-to-face"}).flat()
    assert 'Give output_support arrangement = "one locates"' in str(caught.value)
