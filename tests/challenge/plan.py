"""What is run: the tests of a campaign, drawn, as columns for a simulator."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

#: Catalogue values of the oil of all campaigns: kinematic viscosities [mm2/s], density [kg/m3] and its slope [1/K].
OIL = {"nu40": 324.38, "nu100": 35.27, "rho15": 859.0, "alpha_T": -5.6e-4}
OIL_NAME = "PAOR"

#: Duration of every point of a steady campaign [min]: twenty time constants of the slowest rig.
STEADY_DWELL = 3000.0


@dataclass(frozen=True)
class Plan:
    """Tests as columns; a test is a half as multiplier, a stop, a half as reducer.

    In a steady campaign a test is a day with two steady points, both as reducer.

    Args:
        n, load: carrier speed [rpm] and torque [N.m] in both halves (2, columns)
        order: running order, 1 ...
        tests: tests in the campaign
        room: room at the start, at the end of the first and of the second half [degC] (3, columns)
        start: gearbox at the start [degC]
        dwell: both halves as stated [min] (2, columns)
        stop: between the halves [min]
        humidity: of the room [%]
        steady: whether each half is a steady point
    """

    n: np.ndarray
    load: np.ndarray
    order: np.ndarray
    tests: int
    room: np.ndarray
    start: np.ndarray
    dwell: np.ndarray
    stop: np.ndarray
    humidity: np.ndarray
    steady: bool = False

    @property
    def columns(self) -> int:
        """Number of columns."""
        return len(self.order)

    @property
    def directions(self) -> tuple[int, int]:
        """Direction of both halves: 1 multiplier, 2 reducer."""
        return (2, 2) if self.steady else (1, 2)

    @property
    def progress(self) -> np.ndarray:
        """Running order as a share of the campaign, 0 ... 1."""
        progress: np.ndarray = (self.order - 1.0) / max(self.tests - 1.0, 1.0)
        return progress

    def tile(self, copies: int) -> Plan:
        """The same tests several times over, one copy behind the other."""
        names = ("n", "load", "order", "room", "start", "dwell", "stop", "humidity")
        several: dict[str, Any] = {name: np.concatenate([getattr(self, name)] * copies, axis=-1) for name in names}
        return replace(self, **several)


def draw_plan(rng: np.random.Generator, *, warm_start: bool = False, room_drift: float = 0.0) -> Plan:
    """A grid of speeds and torques like that of the rig's first campaign, in random order.

    Args:
        rng: source of chance
        warm_start: whether tests start warmer than the room, as after a shorter night
        room_drift: room at the start less its first reading, mean over the tests [K]
    """
    speeds, torques = np.array([100.0, 150.0, 200.0, 250.0]), np.array([1600.0, 2000.0, 2400.0, 2800.0])
    if rng.random() < 0.4:
        speeds = np.sort(rng.uniform(0.85, 1.15) * speeds + rng.uniform(-12.0, 12.0, 4))
    if rng.random() < 0.4:
        torques = np.sort(rng.uniform(0.8, 1.05) * torques + rng.uniform(-80.0, 80.0, 4))
    n, load = (grid.ravel() for grid in np.meshgrid(speeds, torques, indexing="ij"))
    m = len(n)
    order = np.arange(1.0, m + 1.0) if rng.random() < 0.3 else rng.permutation(m) + 1.0
    n = n + rng.normal(0.0, 1.0, m)
    load = 0.9675 * load + rng.normal(0.0, 2.0, m)
    return _plan(rng, n, load, order, m, warm_start, room_drift)


def draw_points(rng: np.random.Generator, plan: Plan, tests: int = 12, room_drift: float = 0.0) -> Plan:
    """Conditions to predict: inside the campaign's grid and somewhat outside of it, at running orders of the campaign.

    They start at the room's temperature whatever the campaign does.
    """
    n = rng.uniform(0.85 * plan.n.min(), 1.12 * plan.n.max(), tests)
    load = rng.uniform(0.8 * plan.load.min(), 1.08 * plan.load.max(), tests)
    order = np.sort(rng.choice(np.arange(1.0, plan.tests + 1.0), tests, replace=False))
    return _plan(rng, n, load, order, plan.tests, False, room_drift)


def hold(plan: Plan, rng: np.random.Generator) -> Plan:
    """The steady campaign of a plan: its points in pairs, two on a day in one room, each until nothing changes."""
    other, room = rng.permutation(plan.columns), plan.room[1]
    return replace(
        plan,
        n=np.array([plan.n[0], plan.n[0][other]]),
        load=np.array([plan.load[0], plan.load[0][other]]),
        room=np.tile(room, (3, 1)),
        start=room,
        dwell=np.full((2, plan.columns), STEADY_DWELL),
        steady=True,
    )


def _plan(
    rng: np.random.Generator,
    n: np.ndarray,
    load: np.ndarray,
    order: np.ndarray,
    tests: int,
    warm_start: bool,
    room_drift: float,
) -> Plan:
    m = len(n)
    first = rng.uniform(20.0, 29.0) + rng.normal(0.0, 2.2, m)
    second = first + rng.normal(0.6, 0.8, m)
    begin = first + room_drift * rng.uniform(0.7, 1.3, m)
    start = begin + (rng.uniform(0.0, 8.0, m) if warm_start else 0.0)
    both = np.ones((2, 1))
    return Plan(
        n=both * n,
        load=both * load,
        order=order,
        tests=tests,
        room=np.array([begin, first, second]),
        start=start,
        dwell=np.array([[240.0], [90.0]]) * np.ones(m),
        stop=np.full(m, 5.0),
        humidity=np.clip(rng.normal(52.0, 13.0, m), 20.0, 92.0),
    )
