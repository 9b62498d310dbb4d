from __future__ import annotations

import math

import pytest


def _row(point: int, test: int, direction: int, oil: str, n: float, tau: float, shift: float) -> dict[str, object]:
    """A reading that is linear in speed and torque but for `shift`; the simulated oil is 2 K too warm."""
    rise = 5.0 + 0.1 * n + 0.005 * tau + shift
    loss = 10.0 + 0.01 * tau + shift
    power = loss * n * math.pi / 30
    return {
        "point": point, "test": test, "direction": direction, "oil": oil, "grid": f"{oil}-grid",
        "n_set_rpm": n, "T_set_Nm": tau, "n_carrier_rpm": n, "T_carrier_Nm": tau, "T_amb_C": 20.0 + direction,
        "time_s": 60.0 * (240 if direction == 1 else 335),
        "T_oil_C": 22.0 + direction + rise, "T_oil2_C": 22.0 + direction + rise, "T_wall_C": 19.0 + direction + rise,
        "loss_Nm": loss + 1.0, "P_loss_W": power, "efficiency": 0.98, "P_mesh_W": 0.6 * power, "P_seal_W": 0.4 * power,
        "T_oil_C_meas": 20.0 + direction + rise, "T_oil2_C_meas": 20.0 + direction + rise,
        "T_wall_C_meas": 20.0 + direction + rise, "loss_Nm_meas": loss, "P_loss_W_meas": power, "efficiency_meas": 0.98,
    }  # fmt: skip


@pytest.fixture
def rows() -> list[dict[str, object]]:
    """Twelve tests of two readings each; the point at 100 rpm and 1600 N.m of oil A is there twice, 0.4 apart."""
    found: list[dict[str, object]] = []
    points = [(oil, n, tau, 0.0) for oil in "AB" for n in (100.0, 200.0, 250.0) for tau in (1600.0, 2400.0)]
    for test, (oil, n, tau, shift) in enumerate([*points[:11], ("A", 100.0, 1600.0, 0.4)], start=1):
        for direction in (1, 2):
            found.append(_row(len(found) + 1, test, direction, oil, n, tau, shift))
    return found
