"""The cycloid disc among its pins: the laws against the moving mechanism, differentiated by central differences."""

import math

import numpy as np
import pytest
from gearheat.model.laws.cycloid_pin import (
    contact_speed,
    curvature,
    entrainment_speed,
    greatest_curvature,
    pin_centre,
    pin_lever,
    pin_load,
    pole_distance,
    profile,
    reduced_radius,
    sliding_speed,
    width_coefficient,
)

#: Zp, Rp, e, r_rp of an RV stage and of a cycloidal reducer (SI).
MACHINES = [(40, 0.064, 0.0013, 0.003), (14, 0.086, 0.004, 0.007), (30, 0.05, 0.001, 0.002)]
ANGLES = np.radians(np.linspace(1.0, 179.0, 90))
W = 61.0
#: What the formula for endlessly many pins misses of the torque at the worst position, by number of pins.
WORST = {40: 1.5e-3, 14: 1.2e-2, 30: 6e-4}


def path(Zp: int, Rp: float, e: float, theta: float) -> complex:
    """Centre of the pin as the disc sees it."""
    return complex(*map(float, pin_centre(e, Zp, Rp, theta)))


@pytest.mark.parametrize(("Zp", "Rp", "e", "r_rp"), MACHINES)
def test_curvature_is_that_of_the_path(Zp: int, Rp: float, e: float, r_rp: float) -> None:
    K = width_coefficient(e, Zp, Rp)
    for theta in ANGLES:
        h = 1e-4
        low, here, high = (path(Zp, Rp, e, theta + s * h) for s in (-1, 0, 1))
        d, dd = (high - low) / (2 * h), (high - 2 * here + low) / h**2
        found = (d.conjugate() * dd).imag / abs(d) ** 3
        assert float(curvature(K, Zp, Rp, theta)) == pytest.approx(found, rel=1e-3, abs=1e-3 / Rp)


@pytest.mark.parametrize(("Zp", "Rp", "e", "r_rp"), MACHINES)
def test_the_greatest_curvature_is_the_largest_over_a_turn(Zp: int, Rp: float, e: float, r_rp: float) -> None:
    K = width_coefficient(e, Zp, Rp)
    largest = max(float(curvature(K, Zp, Rp, theta)) for theta in np.linspace(0, np.pi, 20001))
    assert float(greatest_curvature(K, Zp, Rp)) == pytest.approx(largest, rel=1e-6)
    assert float(reduced_radius(greatest_curvature(K, Zp, Rp), r_rp)) > 0


@pytest.mark.parametrize(("Zp", "Rp", "e", "r_rp"), MACHINES)
def test_the_profile_touches_the_pin_and_looks_at_the_pole(Zp: int, Rp: float, e: float, r_rp: float) -> None:
    """A pin's radius from its centre, at right angles to the path, on the disc's side of it."""
    for theta in ANGLES:
        contact = complex(*map(float, profile(e, Zp, Rp, r_rp, theta)))
        offset = contact - path(Zp, Rp, e, theta)
        tangent = path(Zp, Rp, e, theta + 1e-5) - path(Zp, Rp, e, theta - 1e-5)
        assert abs(offset) == pytest.approx(r_rp, rel=1e-9)
        assert (offset * tangent.conjugate()).real == pytest.approx(0.0, abs=1e-6 * r_rp * abs(tangent))
        assert (offset * tangent.conjugate()).imag > 0


def moving(Zp: int, Rp: float, e: float, r_rp: float, theta: float, t: float) -> complex:
    """Contact point of a pin that stood at `theta` at t = 0, in the frame of the pins."""
    pin, pole = Rp * np.exp(1j * theta), e * Zp * np.exp(1j * W * t)
    return pin + r_rp * (pole - pin) / abs(pole - pin)


@pytest.mark.parametrize(("Zp", "Rp", "e", "r_rp"), MACHINES)
def test_speeds_are_those_of_the_mechanism(Zp: int, Rp: float, e: float, r_rp: float) -> None:
    """Sliding, speed of the contact point and both mean entrainment speeds, by differences of positions."""
    K, Zc = width_coefficient(e, Zp, Rp), Zp - 1
    for theta in ANGLES:
        contact, pin, pole = moving(Zp, Rp, e, r_rp, theta, 0.0), Rp * np.exp(1j * theta), e * Zp
        tangent = 1j * (pole - pin) / abs(pole - pin)
        # the disc's point at the contact: its centre goes round, and it turns back once per Zc turns of the crank
        dt = 1e-7
        moved = [e * np.exp(1j * W * s * dt) + (contact - e) * np.exp(-1j * W * s * dt / Zc) for s in (-1, 1)]
        of_disc = ((moved[1] - moved[0]) / (2 * dt) * tangent.conjugate()).real
        points = [moving(Zp, Rp, e, r_rp, theta, s * dt) for s in (-1, 1)]
        of_point = ((points[1] - points[0]) / (2 * dt) * tangent.conjugate()).real
        scale = abs(of_disc) + abs(of_point)
        v_s, v_c = sliding_speed(W, K, Zc, Rp, r_rp, theta), contact_speed(W, K, r_rp, theta)
        assert float(v_s) == pytest.approx(of_disc, rel=1e-4)
        assert float(v_c) == pytest.approx(of_point, abs=1e-4 * scale)
        held, rolling = ((of_disc + pin_speed) / 2 - of_point for pin_speed in (0.0, of_disc))
        assert float(entrainment_speed(v_s, v_c, 0.0)) == pytest.approx(held, abs=1e-4 * scale)
        assert float(entrainment_speed(v_s, v_c, 1.0)) == pytest.approx(rolling, abs=1e-4 * scale)


@pytest.mark.parametrize(("Zp", "Rp", "e", "r_rp"), MACHINES)
def test_pin_loads_carry_the_torque(Zp: int, Rp: float, e: float, r_rp: float) -> None:
    """Over a mesh cycle in the mean to 1e-4; with a pin on the crank's line to 2 K^Zp, as a trapezoidal sum must.

    At other positions some is missing or too much: the formula stands for endlessly many pins.
    """
    K, T = width_coefficient(e, Zp, Rp), 206.0

    def carried(first: float) -> float:
        angles = [theta for theta in first + 2 * math.pi / Zp * np.arange(Zp) if 0 < theta < math.pi]
        return sum(float(pin_load(T, K, Zp - 1, Rp, a) * pin_lever(K, Zp, Rp, a)) for a in angles)

    assert carried(0.0) == pytest.approx(T, rel=2 * K**Zp)
    over = [carried(first) for first in np.linspace(0, 2 * math.pi / Zp, 41)[:-1]]
    assert np.mean(over) == pytest.approx(T, rel=1e-4)
    assert max(abs(sum_ / T - 1) for sum_ in over) < WORST[Zp]


def test_lever_is_the_distance_of_the_force_from_the_centre() -> None:
    Zp, Rp, e, _ = MACHINES[0]
    for theta in ANGLES:
        pin, pole = Rp * np.exp(1j * theta), e * Zp
        force = (pole - pin) / abs(pole - pin)
        lever = abs(((e - pin) * force.conjugate()).imag)
        K = width_coefficient(e, Zp, Rp)
        assert float(pin_lever(K, Zp, Rp, theta)) == pytest.approx(lever, rel=1e-9)
        assert float(pole_distance(K, theta)) * Rp == pytest.approx(abs(pole - pin), rel=1e-12)
