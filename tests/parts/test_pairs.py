"""Pairs of gears: what each kind becomes in the limit of another, forces that balance, and what does not fit."""

import math

import pytest
from gearheat.model.core.connect import Assembly
from gearheat.model.core.flatten import flatten
from gearheat.model.errors import ScenarioError
from gearheat.model.parts import PARTS
from gearheat.model.run.rows import evaluate_at

OIL = dict(nu_40=2.2e-4, nu_100=1.9e-5, rho_15=895.0, alpha_T=-6.2e-4, s_p=9.904, t_p=0.139, X_L=1.0)
STEEL = dict(Ra=5e-7, k_mu=1.0, line_load="F_bt/b", E=2.06e11, poisson=0.3, alpha_n=math.radians(20))
BEVEL = STEEL | dict(z_1=14.0, z_2=39.0, m_et=4.536e-3, beta=math.radians(35), b=0.0254, x_1=0.4)
BEVEL |= dict(shaft_angle=math.pi / 2)
#: Planet and ring of Dias2014.
RING = STEEL | dict(
    z_1=36.0, z_2=108.0, m_n=2e-3, beta=math.radians(10), b=0.042, a_w=0.073035, x_1=-0.0189, x_2=0.0566
)
#: FZG gears, type C.
SPUR = STEEL | dict(z_1=16.0, z_2=24.0, m_n=4.5e-3, beta=0.0, b=0.014, a_w=0.0915, x_1=0.1817, x_2=0.1715)


def at_work(kind: str, values: dict, w: float = 100.0, tau: float = 50.0, **choices) -> dict[str, float]:
    """All outputs of a pair in warm oil, driven at the pinion."""
    parts = [PARTS[kind]("pair", **values, **choices), PARTS["OilBath"]("oil", V=1e-3, c_p=2000.0, T=333.15, **OIL)]
    parts += [PARTS["ShaftEnd"]("a", given=("w", "tau")), PARTS["ShaftEnd"]("b")]
    nets = (("a.flange", "pair.pinion"), ("b.flange", "pair.wheel"), ("oil.lubricant", "pair.lubricant"))
    flat = flatten(Assembly("pair", "", tuple(parts), (*nets, ("oil.heat", "pair.gears"))))
    inputs = {q.name: q.start for q in flat.inputs} | {"a.w": w, "a.tau": tau}
    x = [q.start for q in flat.states]
    y = evaluate_at(flat, x, list(inputs.values()), flat.starts("parameter"))["y"]
    return dict(zip([q.name for q in flat.outputs], y.tolist(), strict=True))


def test_a_ring_and_its_planet_are_those_in_print():
    """Contact ratio and loss factor of planet and ring of Dias2014, the latter with its misprint corrected."""
    found = at_work("InternalGearPair", RING)
    assert found["pair.eps_alpha"] == pytest.approx(1.883, abs=5e-4)
    assert found["pair.H_v"] == pytest.approx(0.0537, abs=5e-4)
    assert found["b.w"] == pytest.approx(100.0 / 3)  # the same way
    assert found["b.P"] == pytest.approx(found["pair.P_loss"] - 5000.0)


def test_a_pinion_loses_less_in_a_ring_than_on_a_wheel():
    outside = at_work("HelicalGearPair", RING | dict(a_w=0.146221, x_1=0.0, x_2=0.0))
    assert at_work("InternalGearPair", RING)["pair.P_loss"] < 0.6 * outside["pair.P_loss"]


def test_a_spur_pair_has_no_axial_force_and_its_own_loss_factor():
    """H_v of 16 and 24 straight teeth of the FZG gears type C, from the addendum contact ratios by hand."""
    part = PARTS["HelicalGearPair"]("pair", **SPUR)
    axial = next(e for e in part.equations() if e.name == "axial force").rhs
    assert part.number_at(axial / part.symbols["F_t"], part.values | {"F_t": 1.0}) == 0.0
    ratios = [by_hand(z, x) for z, x in ((16, 0.1817), (24, 0.1715))]
    H_v = math.pi * (1 / 16 + 1 / 24) * (1 - sum(ratios) + sum(e**2 for e in ratios))
    assert at_work("HelicalGearPair", SPUR)["pair.H_v"] == pytest.approx(H_v, rel=1e-9)


def by_hand(z: int, x: float) -> float:
    """Addendum contact ratio of a straight FZG gear."""
    r_b = 4.5e-3 * z / 2 * math.cos(math.radians(20))
    r_w = 0.0915 * z / 40
    r_a = 4.5e-3 * (z / 2 + 1 + x)
    return (math.sqrt(r_a**2 - r_b**2) - math.sqrt(r_w**2 - r_b**2)) / (math.pi * 4.5e-3 * math.cos(math.radians(20)))


@pytest.mark.parametrize("tau", [50.0, -50.0])
def test_bevel_gears_become_cylindrical_as_their_shafts_become_parallel(tau):
    flat = BEVEL | dict(shaft_angle=1e-4)
    bevel = at_work("BevelGearPair", flat, tau=tau)
    m_n = bevel["pair.m_n"]
    a_w = m_n * (14 + 39) / 2 / math.cos(flat["beta"])
    same = {k: v for k, v in flat.items() if k not in ("m_et", "shaft_angle")} | dict(m_n=m_n, a_w=a_w, x_2=-0.4)
    helical = at_work("HelicalGearPair", same, tau=tau)
    for key in ("P_loss", "mu", "Lambda", "u_m", "F_t", "eps_alpha"):
        assert bevel[f"pair.{key}"] == pytest.approx(helical[f"pair.{key}"], rel=1e-6), key
    axial = helical["pair.F_t"] * math.tan(flat["beta"])
    assert bevel["pair.F_a_1"] == pytest.approx(math.copysign(axial, tau), rel=1e-3)
    assert bevel["pair.F_a_2"] == pytest.approx(-bevel["pair.F_a_1"], rel=1e-3)


def test_bevel_forces_are_those_of_the_vectors_and_turn_with_the_load():
    there, back = (at_work("BevelGearPair", BEVEL, tau=tau) for tau in (50.0, -50.0))
    assert there["pair.F_a_1"] / there["pair.F_t"] == pytest.approx(0.80915, abs=1e-5)
    assert there["pair.F_a_2"] / there["pair.F_t"] == pytest.approx(0.18162, abs=1e-5)
    assert back["pair.F_a_1"] / back["pair.F_t"] == pytest.approx(-0.50891, abs=1e-5)
    other = at_work("BevelGearPair", BEVEL, spiral="towards")
    assert other["pair.F_a_1"] / other["pair.F_t"] == pytest.approx(-0.50891, abs=1e-5)


@pytest.mark.parametrize("angle", [60.0, 90.0, 105.0])
@pytest.mark.parametrize("spiral", [0.0, 35.0])
def test_a_good_bevel_pair_loses_half_a_percent_or_so(angle, spiral):
    found = at_work("BevelGearPair", BEVEL | dict(shaft_angle=math.radians(angle), beta=math.radians(spiral)))
    assert 0.002 < found["pair.P_loss"] / 5000.0 < 0.02


@pytest.mark.parametrize(
    ("kind", "values", "words"),
    [
        ("BevelGearPair", BEVEL | dict(shaft_angle=2.2), "the wheel is a cone"),
        ("BevelGearPair", BEVEL | dict(b=0.06), "b fits the cones"),
        ("BevelGearPair", BEVEL | dict(m_n=4.5e-3), "m_et fits m_n"),
        ("BevelGearPair", BEVEL | dict(x_2=0.4), "a_w fits"),
        ("InternalGearPair", RING | dict(z_2=40.0, a_w=4.1e-3), "the ring is larger than the pinion"),
        ("InternalGearPair", RING | dict(x_1=0.5), "mm fits these teeth"),
    ],
)
def test_what_does_not_fit_is_refused_by_name(kind, values, words):
    with pytest.raises(ScenarioError, match=words):
        PARTS[kind]("pair", **values)


def test_axial_forces_tilt_a_planet_at_its_own_radius():
    """Sun and ring push a planet of 36 teeth in opposite directions at its reference circle.

    By hand: r = 2 x 36 / (2 cos 10 deg) = 36.555 mm, 1 kN tan 10 deg = 176.33 N at each side, so that the two bearings,
    21 mm apart, carry 2 x 176.33 x 36.555 / 21 = 613.88 N each, at right angles to the 1 kN of the tangential forces.
    """
    values = STEEL | dict(m_n=2e-3, beta=math.radians(10), b=0.042, z_2=36.0, N=3.0, a_w=0.0548, s_planet=0.021)
    values |= dict(eps_alpha_sp=1.6, eps_alpha_pr=1.8, H_v_sp=0.2, H_v_pr=0.1, n_axial_carrier=0.0, n_axial_sun=0.0)
    part = PARTS["PlanetarySet"]("set", **values | dict(z_1=18.0, z_3=90.0))
    carried = next(e for e in part.equations() if e.name == "planet radially").rhs
    found = part.number_at(carried, part.values | {"F_t_sp": 1000.0, "F_t_pr": 1000.0})
    assert found == pytest.approx(math.hypot(1000.0, 613.88), abs=0.01)


def test_the_force_of_a_pair_lies_on_its_line_of_action():
    """FZG gears type C: 1 kN at the reference circle, by hand.

    alpha_wt = acos(90 cos 20 deg / 91.5) = 22.438 deg, the base force 1000 / cos 20 deg = 1064.18 N; its components at
    the working circle are 983.61 N and 406.18 N, where the pressure angle of the reference circle has 363.97 N.
    """
    part = PARTS["HelicalGearPair"]("pair", **SPUR)
    named = {e.name: e.rhs for e in part.equations() if e.name in ("tangential force told", "radial force")}
    told = {name: part.number_at(rhs, part.values | {"F_t": 1000.0}) for name, rhs in named.items()}
    assert told["tangential force told"] == pytest.approx(983.61, abs=0.01)
    assert told["radial force"] == pytest.approx(406.18, abs=0.02)


def test_helical_teeth_share_their_load_along_their_lines_of_contact():
    """Gears H501 and H951 of GEARpie, which integrates 0.188168 and 0.118446; spur gears have pairs alone."""
    h501 = dict(m_n=3.5e-3, beta=math.radians(15), b=23e-3, z_1=20.0, z_2=30.0, x_1=0.1809, x_2=0.0891, a_w=91.5e-3)
    lines, pairs = (PARTS["HelicalGearPair"]("pair", **STEEL | h501, load_sharing=x) for x in ("lines", "pairs"))
    assert lines.values["H_v"] == pytest.approx(0.188168, rel=0.003)
    assert pairs.values["H_v"] == pytest.approx(0.165353, rel=0.001)
    spur, printed = (PARTS["HelicalGearPair"]("pair", **SPUR, load_sharing=x) for x in ("lines", "pairs"))
    assert spur.values["H_v"] == pytest.approx(printed.values["H_v"], rel=1e-6)
