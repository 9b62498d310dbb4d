"""Forces of a cycloid disc: the closed forms against sums over every pin and roller of the disc of Vasic2022."""

import math

import numpy as np
import pytest
from gearheat.model.laws.convection import HILPERT, flat_wall_coefficient, nusselt_hilpert
from gearheat.model.laws.cycloid import (
    eccentric_force,
    output_roller_power,
    pin_force_along_crank,
    pin_force_sum,
    ring_roller_power,
    roller_force_sum,
)
from gearheat.model.laws.cycloid_pin import greatest_curvature, pin_load, width_coefficient
from gearheat.model.laws.film import film_from_reference, film_of_share, fluid_share

E, R, R_0, PINS, ROLLERS, D_0 = 4e-3, 0.086, 0.0475, 14, 8, 0.014
LOBES = PINS - 1
T = 166.0
K = width_coefficient(E, PINS, R)


def pins(phase: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Force of each pin on the disc, its components along and across the crank, and its distance from the pole."""
    phi = phase + 2 * np.pi * np.arange(PINS) / PINS
    x, y = E * PINS - R * np.cos(phi), -R * np.sin(phi)
    distance = np.hypot(x, y)
    lever = np.maximum(E * LOBES * -y / distance, 0.0)
    force = T * lever / (lever**2).sum()
    return force, force * x / distance, force * y / distance, distance


def rollers(phase: float) -> np.ndarray:
    """Force of each output roller on the disc; all are parallel to the crank."""
    lever = np.maximum(np.sin(phase + 2 * np.pi * np.arange(ROLLERS) / ROLLERS), 0.0)
    return T * lever / (R_0 * (lever**2).sum())


PHASES = np.linspace(0.0, 2 * np.pi, 2000, endpoint=False)


def mean(of: object) -> float:
    return float(np.mean([of(phase) for phase in PHASES]))


def test_pins_carry_the_torque_of_the_disc() -> None:
    """About the pole's lever: the component across the crank is T / (e z_1) at every angle."""
    for phase in PHASES[:50]:
        _, _, across, _ = pins(phase)
        assert -across.sum() == pytest.approx(T / (E * LOBES), rel=1e-12)


def test_closed_forms_are_the_means_over_a_turn() -> None:
    assert pin_force_sum(T, E, LOBES) == pytest.approx(mean(lambda a: pins(a)[0].sum()), rel=1e-4)
    assert roller_force_sum(T, R_0) == pytest.approx(mean(lambda a: rollers(a).sum()), rel=1e-5)
    assert pin_force_along_crank(T, K, E, LOBES) == pytest.approx(mean(lambda a: pins(a)[1].sum()), rel=2e-4)
    along = mean(lambda a: (pins(a)[0] * pins(a)[3]).sum())
    assert R * pin_force_sum(T, E, LOBES) == pytest.approx(along, rel=1e-4)


def test_bearing_balances_pins_and_rollers() -> None:
    """The mean of the force's size at independent angles of both; it is above the size of the mean."""

    def force(phase: float) -> float:
        _, along, across, _ = pins(phase / PINS)
        return math.hypot(rollers(phase / ROLLERS).sum() - along.sum(), across.sum())

    assert mean(force) == pytest.approx(4720.0, abs=1.0)
    assert eccentric_force(T, K, E, LOBES, R_0) == pytest.approx(mean(force), rel=5e-4)


def test_largest_pin_force_of_fourteen_pins() -> None:
    """918.4 N at the worst angle; the closed form, of many pins, is 0.7 % lower."""
    largest = max(pins(phase)[0].max() for phase in PHASES)
    assert largest == pytest.approx(918.4, abs=0.05)
    assert pin_load(T, K, LOBES, R, math.acos(K)) == pytest.approx(largest, rel=8e-3)


def test_powers_are_those_of_every_roller() -> None:
    """Rolling and sliding of each ring roller at its own distance, and of each output roller."""
    w, mu_r, mu_s, d = 11.4386, 0.0045, 0.05, 0.008

    def ring(phase: float) -> float:
        force, _, _, distance = pins(phase)
        return float((force * (distance - D_0 / 2) * w * (mu_r + mu_s * d / D_0)).sum())

    F_N, F_K = pin_force_sum(T, E, LOBES), roller_force_sum(T, R_0)
    assert ring_roller_power(F_N, R, w, D_0, d, mu_r, mu_s) == pytest.approx(mean(ring), rel=1e-4)
    orbit = (LOBES + 1) * w  # of a hole round its roller
    spin = E * orbit / (D_0 / 2)  # of the roller on its pin
    by_hand = F_K * (mu_r * E * orbit + mu_s * 0.0035 * spin)
    assert output_roller_power(F_K, E, orbit, D_0, 0.007, mu_r, mu_s) == pytest.approx(by_hand, rel=1e-12)


def test_rollers_of_the_source_do_not_undercut() -> None:
    assert D_0 / 2 * greatest_curvature(K, PINS, R) < 1


@pytest.mark.parametrize("Re", [1.0, 10.0, 400.0, 3e4, 1e5])
def test_hilpert_is_the_row_of_the_table(Re: float) -> None:
    row = sum(Re > limit for limit in (4, 40, 4e3))
    C, m = HILPERT[row]
    assert nusselt_hilpert(Re, 0.7) == pytest.approx(C * Re**m * 0.7 ** (1 / 3), rel=1e-3)


@pytest.mark.parametrize("Re", [4.0, 40.0, 4e3])
def test_rows_of_hilpert_meet(Re: float) -> None:
    row = sum(limit < Re for limit in (4, 40, 4e3))
    printed = [C * Re**m * 0.7 ** (1 / 3) for C, m in HILPERT[row : row + 2]]
    assert max(printed) <= nusselt_hilpert(Re, 0.7) <= 1.007 * max(printed)


def test_flat_wall() -> None:
    assert flat_wall_coefficient(4.0) == pytest.approx(31.0, rel=1e-6)
    assert flat_wall_coefficient(0.0) == 7.0


def test_film_of_a_share_is_its_inverse() -> None:
    for f in (0.1, 0.4, 0.625, 0.8):
        assert fluid_share(film_of_share(f)) == pytest.approx(f, rel=1e-3)
    assert film_from_reference(0.4, 1.0, 1.0) == pytest.approx(0.4, rel=1e-6)
    assert film_from_reference(0.4, 0.0, 1.0) == 0.0
