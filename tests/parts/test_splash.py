"""Oil that gears throw: heat transfer follows speed and viscosity, with free convection at rest."""

import itertools
import math

import pytest
from gearheat.model.laws.oil_convection import forced_disc_in_oil, forced_wall_in_oil, speed_along_wall
from gearheat.model.machines.roles import Roles
from gearheat.model.machines.spec import PartSpec
from gearheat.model.run.rows import evaluate_at
from gearheat.model.run.steady import steady
from gearheat.scenarios.load import load
from one_part import between_sources, oil_at

OIL = dict(c_p=2000.0, alpha_T=-6.5e-4)


def coefficient(kind: str, w: float, T: float, dT: float = 5.0) -> float:
    """Of a part by itself in an ISO VG 320 PAO [W/(m2.K)]."""
    flat, oil = between_sources(kind), oil_at(T)
    given = {"a.T": T, "b.T": T - dT, "shaft.w": w} | {f"lubricant.{key}": value for key, value in oil.items()}
    u = [given.get(q.name, q.nominal) for q in flat.inputs]
    y = evaluate_at(flat, [], u, flat.starts("parameter"))["y"]
    return float(y[[q.name for q in flat.outputs].index("part.h")])


@pytest.mark.parametrize("kind", ["SplashConductor", "GearOilConductor"])
def test_faster_and_thinner_transfers_more(kind: str) -> None:
    speeds, temperatures = (0.0, 1.0, 10.0, 50.0, 150.0), (263.15, 293.15, 323.15, 353.15)
    for T in temperatures:
        by_speed = [coefficient(kind, w, T) for w in speeds]
        assert by_speed == sorted(by_speed)
        assert by_speed[-1] == pytest.approx(coefficient(kind, -speeds[-1], T), rel=1e-12)
    for w in speeds:
        by_heat = [coefficient(kind, w, T) for T in temperatures]
        assert by_heat == sorted(by_heat)


@pytest.mark.parametrize("kind", ["SplashConductor", "GearOilConductor"])
def test_free_convection_is_left_at_rest(kind: str) -> None:
    warm, still = coefficient(kind, 0.0, 333.15), coefficient(kind, 0.0, 333.15, 0.0)
    assert 10 < warm < 100
    assert 0 < still < warm
    assert coefficient(kind, 0.0, 333.15, -5.0) == pytest.approx(warm, rel=1e-12)


def test_beside_the_constant_of_the_standard() -> None:
    """ISO/TR 14179-2 has 200 W/(m2.K) for all: here at walls of 0.2 to 0.4 m, half the pitch line speed."""
    found = []
    for v, nu, L in itertools.product((2.0, 5.0, 10.0), (30e-6, 100e-6, 300e-6), (0.2, 0.4)):
        Pr = nu * 870 * 2000 / 0.13
        found.append(float(forced_wall_in_oil(v / 2, nu, Pr, 0.13, L)))
    assert (min(found), max(found)) == pytest.approx((125, 581), abs=1)


@pytest.mark.parametrize("L", [0.1, 0.3, 1.6])
def test_oil_runs_along_a_wall_at_most_as_fast_as_it_falls(L: float) -> None:
    """Slow oil keeps the speed that the gear gives it, fast oil that of a free fall, either way round."""
    fall = math.sqrt(2 * 9.80665 * L)
    speeds = [float(speed_along_wall(v, L)) for v in (0.0, 0.1 * fall, fall, 3 * fall, 10 * fall)]
    assert speeds == sorted(speeds)
    assert speeds == pytest.approx([0.0, 0.1 * fall, 2**-0.25 * fall, fall, fall], rel=4e-3)
    assert float(speed_along_wall(-fall, L)) == -speeds[2]


def test_fast_gears_stay_near_the_standard() -> None:
    """The wheel of an e-axle of 12000 rpm has 25 m/s: in oil of 30 cSt 1.6 times the standard, not 3.7 times."""
    nu, L, v = 30e-6, 0.3, 12.5
    Pr = nu * 820 * 2000 / 0.13
    bound, driven = (float(forced_wall_in_oil(s, nu, Pr, 0.13, L)) for s in (math.sqrt(2 * 9.80665 * L), v))
    assert (bound, driven) == pytest.approx((324, 736), abs=1)
    assert float(forced_wall_in_oil(speed_along_wall(v, L), nu, Pr, 0.13, L)) == pytest.approx(bound, rel=1e-3)
    slow, fast, faster = (coefficient("SplashConductor", w, 353.15) for w in (30.0, 300.0, 3000.0))
    assert slow < fast < faster < 1.1 * fast


@pytest.mark.parametrize(
    "nu, L, v",
    [(27e-6, 0.18, 1.06), (63e-6, 0.21, 1.85), (44e-6, 0.53, 5.5), (16e-6, 0.3, 12.5), (92e-6, 1.6, 9.0)],
    ids=["worm", "two stages", "conveyor", "e-axle", "wind turbine"],
)
def test_beside_a_film_that_runs_down_by_its_weight(nu: float, L: float, v: float) -> None:
    """Another way to the coefficient: Nusselt's film of 1e-3 m2/s, and its heat as in a shear flow, after Lévêque."""
    k, rho, c_p = 0.13, 850.0, 2000.0
    depth = (3 * nu * 1e-3 / 9.81) ** (1 / 3)
    film = 0.807 * k * (9.81 * depth / nu * rho * c_p / (k * L)) ** (1 / 3)
    here = float(forced_wall_in_oil(speed_along_wall(v, L), nu, nu * rho * c_p / k, k, L))
    assert 0.65 * film < here < 1.3 * film


def test_the_radius_of_a_disc_does_not_count() -> None:
    small, large = (float(forced_disc_in_oil(30.0, 1e-4, 1300.0, 0.13, r)) for r in (0.03, 0.2))
    assert small == pytest.approx(large, rel=1e-12)


def test_it_takes_the_place_of_a_constant_in_a_gearbox() -> None:
    """Its heat arrives: the oil of a faster gearbox is nearer to its wall, over the heat that passes."""
    splash = PartSpec("splash", "SplashConductor", dict(A=0.3, r=0.08, share=0.5, L=0.25) | OIL)
    nets = [("splash.a", "oil.heat"), ("splash.b", "wall.heat")]
    nets += [("splash.shaft", "output.flange"), ("splash.lubricant", "oil.lubricant")]
    scenario = load("helical_two_stage")
    spec = scenario.spec.with_values({"oil_wall.G": 0.0}).with_parts([splash], nets)
    flat, at = spec.flat(), scenario.operating_point
    roles = Roles.of(spec)  # to the diagnosis it is between oil and bodies, and brakes nothing
    assert "splash" in roles.oil_side
    assert roles.scaled("splash") == ("splash.A",)
    assert not any("splash" in place.parts for places in roles.places.values() for place in places)
    slow, fast = (steady(flat, at | {"input.w": f * at["input.w"]}) for f in (0.5, 1.0))
    assert fast["splash.h"][0] > 1.3 * slow["splash.h"][0]
    for found in (slow, fast):
        dT = found["oil.T"][0] - found["wall.T"][0]
        assert found["splash.Q_flow"][0] == pytest.approx(0.3 * found["splash.h"][0] * dT, rel=1e-9)
