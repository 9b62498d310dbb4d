"""Squeezing of oil in a mesh against the spaces of involute gears, counted point by point."""

import math

import numpy as np
import pytest
from gearheat.model.laws.squeezing import squeezing_torque

M, ALPHA = 3e-3, math.radians(20)


def half_tooth(rho: np.ndarray, z: int) -> np.ndarray:
    """Half the angle that a tooth takes at a radius."""
    r_b = M * z / 2 * math.cos(ALPHA)
    alpha = np.arccos(np.minimum(r_b / np.maximum(rho, r_b), 1.0))
    return math.pi / (2 * z) + math.tan(ALPHA) - ALPHA - np.tan(alpha) + alpha


def pocket(z_1: int, z_2: int, way: float, n: int = 300) -> float:
    """Section of a space of gear 1 that the tooth of gear 2 leaves, this way from the line of centres [m2]."""
    r_1, r_2 = M * z_1 / 2, M * z_2 / 2
    rho, phi = np.meshgrid(
        np.linspace(r_1 - 1.25 * M, r_1 + M, n), np.linspace(-1, 1, n) * math.pi / z_1, indexing="ij"
    )
    space = math.pi / z_1 - np.abs(phi) > half_tooth(rho, z_1)
    x, y = rho * np.cos(phi + way / r_1), rho * np.sin(phi + way / r_1)
    far, turned = np.hypot(r_1 + r_2 - x, y), np.arctan2(y, r_1 + r_2 - x) - way / r_2
    turned = (turned + math.pi / z_2) % (2 * math.pi / z_2) - math.pi / z_2
    tooth = (far < r_2 - 1.25 * M) | ((far < r_2 + M) & (np.abs(turned) < half_tooth(far, z_2)))
    return float((rho * (space & ~tooth)).sum() * 2.25 * M * 2 * math.pi / z_1 / (n - 1) ** 2)


@pytest.mark.parametrize(("z_1", "z_2"), [(20, 40), (30, 30), (20, 100)])
def test_jets_of_involute_gears(z_1: int, z_2: int) -> None:
    """The mean of the spaces of both gears, full of an oil without viscosity: within 10 %."""
    r_1, r_2, w, rho, b = M * z_1 / 2, M * z_2 / 2, 200.0, 870.0, 10 * M
    v, way = w * r_1, np.linspace(0, 1, 41) * 2 * math.sqrt(M * r_1 * r_2 / (r_1 + r_2))
    energy = 0.0
    for pair in ((z_1, z_2), (z_2, z_1)):
        A = np.array([pocket(*pair, x) for x in way])
        Q = b * np.diff(A) / np.diff(way) * v
        energy += float((0.5 * rho * Q**3 / (A[1:] + A[:-1]) ** 2 * np.diff(way) / v).sum())
    torque = squeezing_torque(w, rho, 1e-12, 1.0, r_1, r_2, b, M, 0.0)
    assert torque == pytest.approx(energy * v / (math.pi * M) / w, rel=0.1)


def test_it_takes_the_same_power_from_either_gear_and_more_with_more_oil() -> None:
    pinion, wheel = (
        squeezing_torque(w, 870, 5e-5, 1, *r, 0.03, M, 1e-4) for w, r in ((200, (0.03, 0.06)), (100, (0.06, 0.03)))
    )
    assert 200 * pinion == pytest.approx(100 * wheel, rel=1e-6)
    fills = [float(squeezing_torque(200, 870, 5e-5, fill, 0.03, 0.06, 0.03, M, 1e-4)) for fill in (0, 0.2, 0.5, 0.9, 1)]
    assert fills == sorted(fills)
    assert fills[0] < 1e-3 * fills[-1]
