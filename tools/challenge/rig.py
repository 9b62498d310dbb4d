"""A rig under test, whatever its physics: runs the protocol of a plan with hidden effects, reads the instruments."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from .hidden import Effect
from .plan import CHANNELS, Plan
from .scene import PLACES, RATIO, Changes, Scene
from .stepping import Clock, graded, march

#: An effect and how much of it each column has.
Acting = tuple[Effect, np.ndarray]

#: Steps of the protocol, and fewer for what is only compared with each other at the ends of the halves.
CLOCK = Clock((graded(240 * 60.0), graded(90 * 60.0)), graded(5 * 60.0, 20.0, 1.6), 5)
COARSE = Clock(
    (graded(240 * 60.0, 20.0, 1.6, 900.0), graded(90 * 60.0, 20.0, 1.6, 900.0)), graded(5 * 60.0, 40.0, 2.0), 3
)


class Rig(Protocol):
    """The physics of a rig, vectorised over columns. Temperatures in degC."""

    nodes: int

    def temperatures(self, T: np.ndarray) -> dict[str, np.ndarray]:
        """Temperature of every place, from those of the nodes (nodes, columns)."""

    def viscosity(self, T_oil: np.ndarray) -> np.ndarray:
        """Kinematic viscosity of the oil [mm2/s]."""

    def rate(self, T: np.ndarray, scene: Scene, changes: Changes) -> np.ndarray:
        """Slopes of the nodes [K/s]."""

    def loss_torque(self, T: np.ndarray, scene: Scene, changes: Changes) -> np.ndarray:
        """Loss torque at the carrier without what `changes` brakes [N.m]."""

    def second_oil(self, places: Mapping[str, np.ndarray]) -> np.ndarray:
        """Oil temperature at the second place [degC]."""


@dataclass
class Readings:
    """What instruments show: `values` per channel (rows, columns), `true` temperatures of the places and the rest.

    Rows are the ends of both halves, or moments of a time series; `direction` is a column of the rows' directions.
    Instrument effects change `values` in place.
    """

    values: dict[str, np.ndarray]
    true: dict[str, np.ndarray]
    direction: np.ndarray
    order: np.ndarray
    progress: np.ndarray
    minutes: np.ndarray

    @property
    def loss(self) -> np.ndarray:
        """Loss torque at the carrier as the torque readings say [N.m]."""
        sign = np.where(self.direction == 1, 1.0, -1.0)
        return sign * (self.values["T_carrier_Nm"] - RATIO * self.values["T_sun_Nm"])

    def tiled(self, copies: int) -> Readings:
        """The same columns several times over, one copy behind the other; arrays of their own."""
        return replace(
            self,
            values={c: np.tile(v, copies) for c, v in self.values.items()},
            true={c: np.tile(v, copies) for c, v in self.true.items()},
            order=np.tile(self.order, copies),
            progress=np.tile(self.progress, copies),
            minutes=np.tile(self.minutes, copies),
        )

    def stacked(self, channels: Sequence[str]) -> np.ndarray:
        """Channels, rows and columns as one array."""
        return np.array([self.values[c] for c in channels])


@dataclass(frozen=True)
class Run:
    """A simulated plan: the readings at the ends of the halves, and those at every step of both halves."""

    ends: Readings
    steps: Readings


def simulate(
    rig: Rig,
    plan: Plan,
    base: Mapping[str, np.ndarray | float],
    acting: Sequence[Acting] = (),
    *,
    series: bool = False,
    clock: Clock = CLOCK,
) -> Run:
    """Run all columns of a plan through half, stop and half.

    Args:
        rig: the physics
        plan: the tests
        base: factors that hold throughout, e.g. the unequal nominal or the cooling of the day
        acting: hidden effects with their amplitude per column
        series: whether to read at every step; else `steps` are the ends, too
        clock: the steps
    """
    T = np.tile(plan.start, (rig.nodes, 1))
    rooms = _rooms(plan)
    parts: list[Readings] = []
    now = np.zeros(plan.columns)
    for half in (0, 1):
        if half == 1:
            stage = _Stage(rig, plan, base, acting, half, *rooms[1], stopped=True)
            T = march(stage.rate, T, clock.stop, 60.0 * plan.stop, clock.refresh)[-1]
        stage = _Stage(rig, plan, base, acting, half, *rooms[2 * half])
        minutes = plan.dwell[half] * _paces(acting, plan, half)
        path = march(stage.rate, T, clock.halves[half], 60.0 * minutes, clock.refresh)
        T = path[-1]
        which = slice(None) if series else slice(-1, None)
        parts.append(stage.read(path[which], clock.halves[half][which], now, minutes))
        now = now + minutes + plan.stop
    ends = joined([rows(part, slice(-1, None)) for part in parts])
    return Run(ends, joined(parts))


def misread(run: Run, effect: Effect, amounts: np.ndarray) -> Run:
    """A run as an effect of the instruments shows it, for several amounts: one per column, as many copies as they fill.

    The physics need not run again for that.
    """
    copies = len(amounts) // len(run.ends.order)
    shown = Run(run.ends.tiled(copies), run.steps.tiled(copies))
    if effect.read is not None:
        for readings in (shown.ends, shown.steps):
            effect.read(readings, amounts)
    return shown


def joined(parts: Sequence[Readings]) -> Readings:
    """Readings below each other."""
    first = parts[0]
    values = {c: np.concatenate([p.values[c] for p in parts]) for c in first.values}
    true = {c: np.concatenate([p.true[c] for p in parts]) for c in first.true}
    direction = np.concatenate([p.direction for p in parts])
    return replace(
        first, values=values, true=true, direction=direction, minutes=np.concatenate([p.minutes for p in parts])
    )


def rows(readings: Readings, which: slice | np.ndarray) -> Readings:
    """Some rows of readings."""
    return replace(
        readings,
        values={c: v[which] for c, v in readings.values.items()},
        true={c: v[which] for c, v in readings.true.items()},
        direction=readings.direction[which],
        minutes=readings.minutes[which],
    )


def _rooms(plan: Plan) -> list[tuple[np.ndarray, np.ndarray]]:
    """Room at both ends of first half, stop and second half: a line up to the first reading, one to the second."""
    begin, first, second = plan.room
    restart = first + (second - first) * plan.stop / (plan.stop + plan.dwell[1])
    return [(begin, first), (first, restart), (restart, second)]


def _paces(acting: Sequence[Acting], plan: Plan, half: int) -> np.ndarray:
    """Length of a half over what is stated."""
    pace = np.ones(plan.columns)
    for effect, amplitude in acting:
        if effect.pace is not None:
            pace = pace * effect.pace(plan, half, amplitude)
    return pace


class _Stage:
    """A stretch of the protocol: constant speed and load, the room on a line."""

    def __init__(
        self,
        rig: Rig,
        plan: Plan,
        base: Mapping[str, np.ndarray | float],
        acting: Sequence[Acting],
        half: int,
        room_begin: np.ndarray,
        room_end: np.ndarray,
        stopped: bool = False,
    ) -> None:
        self.rig, self.plan, self.base, self.acting, self.half = rig, plan, base, acting, half
        self.room_begin, self.room_end = room_begin, room_end
        self.n = np.zeros(plan.columns) if stopped else plan.n[half]
        self.load = np.zeros(plan.columns) if stopped else plan.load[half]

    def situation(self, T: np.ndarray, share: float) -> tuple[Scene, Changes]:
        """What effects see, and what they make of it."""
        places, plan = self.rig.temperatures(T), self.plan
        room = self.room_begin + share * (self.room_end - self.room_begin)
        scene = Scene(
            self.n,
            self.load,
            self.half + 1.0,
            plan.order,
            plan.progress,
            plan.humidity,
            places,
            room,
            self.rig.viscosity(places["oil"]),
            plan.future,
        )
        changes = Changes(factors=dict(self.base))
        for effect, amplitude in self.acting:
            if effect.act is not None:
                effect.act(scene, amplitude, changes)
        return scene, changes

    def rate(self, T: np.ndarray, share: float) -> np.ndarray:
        """Slopes of the nodes."""
        return self.rig.rate(T, *self.situation(T, share))

    def read(self, path: np.ndarray, shares: np.ndarray, begin: np.ndarray, minutes: np.ndarray) -> Readings:
        """Readings at some steps, with the faults of instruments."""
        moments = [self._moment(T, float(share)) for T, share in zip(path, shares, strict=True)]
        values = {c: np.array([v[c] for v, _ in moments]) for c in CHANNELS}
        true = {c: np.array([t[c] for _, t in moments]) for c in (*PLACES, "room", "load")}
        direction = np.full((len(shares), 1), self.half + 1.0)
        clock = begin + shares[:, None] * minutes
        readings = Readings(values, true, direction, self.plan.order, self.plan.progress, clock)
        for effect, amplitude in self.acting:
            if effect.read is not None:
                effect.read(readings, amplitude)
        return readings

    def _moment(self, T: np.ndarray, share: float) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
        scene, changes = self.situation(T, share)
        loss = self.rig.loss_torque(T, scene, changes) + changes.brake_power / scene.w
        passed = scene.load - loss if self.half == 0 else scene.load + loss
        oil_2 = self.rig.second_oil(scene.T)
        shown = (scene.n, scene.load, passed / RATIO, scene.T["oil"], oil_2, scene.T["wall"], scene.room)
        return dict(zip(CHANNELS, shown, strict=True)), {**scene.T, "room": scene.room, "load": scene.load}
