"""The textbook sheet is frozen: its rig and its faults do what they did before the inference was written."""

from __future__ import annotations

import numpy as np
import pytest
from challenge.cases import Drawn
from challenge.textbook.campaign import draw
from challenge.textbook.faults import CAUSES, OUTSIDE

#: Readings of one test of the rig of seed 2026: channels, both halves.
HEALTHY = [
    [150.175, 150.175],
    [1687.87, 1687.87],
    [414.244, 429.683],
    [59.334, 59.855],
    [47.115, 47.751],
    [25.016, 26.646],
]

#: Root mean square over a campaign of what 0.3 of the largest amount of each fault changes, per channel.
CHANGES = {
    "losses.churning": (0, 0, 2.15, 10.1, 7.58, 0),
    "losses.windage": (0, 0, 1.99, 10.9, 7.59, 0),
    "losses.oil_level": (0, 0, 1.1, 4.28, 3.83, 0),
    "losses.oil_viscosity": (0, 0, 0.166, 0.264, 0.545, 0),
    "losses.bearing_preload": (0, 0, 4.36, 16.7, 13.7, 0),
    "losses.seal_drag": (0, 0, 2.83, 9.67, 7.91, 0),
    "losses.mesh_friction": (0, 0, 1.55, 7.26, 4.86, 0),
    "losses.mesh_direction": (0, 0, 0.841, 3.9, 2.61, 0),
    "losses.film_starvation": (0, 0, 3.04, 13.3, 8.88, 0),
    "losses.torque_only": (0, 0, 2.25, 0, 0, 0),
    "heat.external_source": (0, 0, 0.0274, 3.29, 3.54, 0),
    "cooling.air": (0, 0, 0.0195, 2.22, 2.4, 0),
    "cooling.emissivity": (0, 0, 0.0161, 2.06, 2.23, 0),
    "cooling.foundation": (0, 0, 0.0146, 1.8, 1.95, 0),
    "cooling.contact": (0, 0, 0.0233, 2.84, 3.04, 0),
    "cooling.oil_wall": (0, 0, 0.115, 7.45, 0.107, 0),
    "cooling.humidity": (0, 0, 0.00396, 0.542, 0.586, 0),
    "thermal.mass": (0, 0, 0.00317, 0.48, 0.45, 0),
    "thermal.split": (0, 0, 0.00519, 0.522, 0.0263, 0),
    "sensor.torque.offset": (0, 9, 0, 0, 0, 0),
    "sensor.torque.gain": (0, 17, 0, 0, 0, 0),
    "sensor.torque.drift": (0, 0, 1.52, 0, 0, 0),
    "sensor.torque.step": (0, 0, 1.69, 0, 0, 0),
    "sensor.torque.by_direction": (0, 0, 1.59, 0, 0, 0),
    "sensor.torque.random_walk": (0, 0, 1.12, 0, 0, 0),
    "sensor.oil_temp.offset": (0, 0, 0, 2.4, 0, 0),
    "sensor.oil_temp.gain": (0, 0, 0, 3.59, 0, 0),
    "sensor.oil_temp.position": (0, 0, 0, 3.82, 0, 0),
    "sensor.oil_temp.since": (0, 0, 0, 1.8, 0, 0),
    "sensor.oil_temp.by_direction": (0, 0, 0, 1.7, 0, 0),
    "sensor.oil_temp.random_walk": (0, 0, 0, 1.19, 0, 0),
    "sensor.wall_temp.offset": (0, 0, 0, 0, 2.4, 0),
    "sensor.wall_temp.since": (0, 0, 0, 0, 1.8, 0),
    "sensor.wall_temp.by_direction": (0, 0, 0, 0, 1.7, 0),
    "sensor.ambient.bias": (0, 0, 0, 0, 0, 1.8),
    "sensor.ambient.heated": (0, 0, 0, 0, 0, 2.91),
    "sensor.ambient.since": (0, 0, 0, 0, 0, 1.35),
    "sensor.speed.gain": (8.28, 0, 0, 0, 0, 0),
    "procedure.not_stationary": (0, 0, 0.00256, 0.387, 0.361, 0),
    "procedure.order": (0, 0, 0.00873, 1.21, 1.3, 0),
    "procedure.day_scatter": (0, 0, 0.00697, 0.806, 0.874, 0),
    "outside.crosstalk": (0, 0, 2.6, 0, 0, 0),
    "outside.thermal_zero": (0, 3.61, 0, 0, 0, 0),
    "outside.leak": (0, 0, 0.247, 3.14, 0.926, 0),
    "outside.rub": (0, 0, 0.388, 1.46, 1.25, 0),
    "outside.weather": (0, 0, 0.0125, 2.44, 2.62, 0),
    "outside.gelling": (0, 0, 0.0748, 4.57, 0.112, 0),
}


@pytest.fixture(scope="module")
def drawn() -> tuple[Drawn, np.ndarray]:
    """A rig, and its readings without a fault."""
    d = draw(np.random.default_rng(2026))
    return d, d.run(d.plan, d.base, ())


def test_the_healthy_rig_reads_what_it_read_when_frozen(drawn: tuple[Drawn, np.ndarray]) -> None:
    """Readings of a test."""
    assert drawn[1][:, :, 5] == pytest.approx(np.array(HEALTHY), abs=2e-3)


def test_every_fault_changes_what_it_changed_when_frozen(drawn: tuple[Drawn, np.ndarray]) -> None:
    """The change of every channel over the campaign."""
    d, healthy = drawn
    columns = d.plan.columns
    names = [*CAUSES, *OUTSIDE]
    kinds = ["outside" if name in OUTSIDE else "single" for name in names]
    faults = [d.draw(n, kind, healthy[3], np.random.default_rng(1)) for n, kind in zip(names, kinds, strict=True)]
    acting = [
        (fault, slice(k * columns, (k + 1) * columns), np.full(columns, 0.3 * fault.high))
        for k, fault in enumerate(faults)
    ]
    readings = d.run(d.plan.tile(len(faults)), d.base, acting).reshape(6, 2, len(faults), columns)
    change = np.sqrt(((readings - healthy[:, :, None]) ** 2).mean(axis=(1, 3))).T
    assert set(names) == set(CHANGES)
    wrong = {n: c for n, c in zip(names, change, strict=True) if c != pytest.approx(CHANGES[n], rel=0.01, abs=1e-6)}
    assert not wrong
