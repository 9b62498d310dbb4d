"""A rig of the sheets "own" and "foreign" under test, whatever its physics: protocol, hidden faults, instruments."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, Protocol

import numpy as np

from .plan import Plan
from .textbook.rig import Acting

#: What can be scaled: losses, viscosity of the oil, heat paths to and from the housing, heat capacities.
FACTORS = (
    "mesh",
    "bearing",
    "seal",
    "churning",
    "viscosity",
    "conv",
    "rad",
    "foot",
    "contact",
    "oil_wall",
    "oil_inner",
    "cap_oil",
    "cap_in",
    "cap_out",
)

#: Places that heat can go to.
PLACES = ("oil", "gears", "body", "wall", "surface")

#: Sun speed over carrier speed.
RATIO = 4.0

#: Readings, in the order of the rows of what is shown.
CHANNELS = ("n_carrier_rpm", "T_carrier_Nm", "T_sun_Nm", "T_oil_C", "T_wall_C", "T_amb_C", "T_oil2_C")

#: Coefficient of the two-stage method that makes it L-stable.
GAMMA = 1.0 - 1.0 / np.sqrt(2.0)
#: Steps after which its matrix is refreshed.
REFRESH = 4


@dataclass
class Scene:
    """The rig at one moment, arrays over columns; faults change factors, heats and the power they brake in place.

    Args:
        n, load: carrier speed [rpm] and torque, a magnitude [N.m]
        direction: 1 multiplier, 2 reducer
        order, progress: running order of the test, 1 ..., and as a share of the campaign
        humidity: of the room [%]
        room, T: temperatures of the room and of every place [degC]
        nu: viscosity of the oil before any change [mm2/s]
        factor, heat, power: what faults change; heat [W] of every place, power [W] taken from the shafts
    """

    n: np.ndarray
    load: np.ndarray
    direction: np.ndarray
    order: np.ndarray
    progress: np.ndarray
    humidity: np.ndarray
    room: np.ndarray
    T: Mapping[str, np.ndarray]
    nu: np.ndarray
    factor: dict[str, np.ndarray]
    heat: dict[str, np.ndarray]
    power: np.ndarray

    @property
    def w(self) -> np.ndarray:
        """Carrier speed [rad/s]."""
        return np.asarray(self.n * (np.pi / 30.0))

    @property
    def running(self) -> np.ndarray:
        """1 where the shafts turn, else 0."""
        return np.where(self.n > 1.0, 1.0, 0.0)

    @property
    def rise(self) -> np.ndarray:
        """Surface above the room, at least 3 K [K]."""
        return np.asarray(np.maximum(self.T["surface"] - self.room, 3.0))

    def cut(self, s: slice) -> Scene:
        """Views of some columns."""
        views: dict[str, Any] = {}
        for f in fields(self):
            value = getattr(self, f.name)
            views[f.name] = {k: a[s] for k, a in value.items()} if isinstance(value, dict) else value[s]
        return Scene(**views)

    def scale(self, name: str, factor: np.ndarray) -> None:
        """Multiply what the name stands for."""
        self.factor[name] *= factor

    def warm(self, place: str, power: np.ndarray) -> None:
        """Bring heat [W] to a place, without any torque."""
        self.heat[place] += power

    def brake(self, power: np.ndarray, shares: Mapping[str, float]) -> None:
        """Take power [W] from the shafts and make it heat, by shares of places."""
        self.power += power
        for place, share in shares.items():
            self.warm(place, share * power)


class Rig(Protocol):
    """The physics of a rig, vectorised over columns. Temperatures in degC."""

    nodes: int
    power_unit: float  # power that a fault of 1 W brakes [W]

    def temperatures(self, T: np.ndarray) -> dict[str, np.ndarray]:
        """Temperature of every place, from those of the nodes (nodes, columns)."""

    def viscosity(self, T_oil: np.ndarray) -> np.ndarray:
        """Kinematic viscosity of the oil [mm2/s]."""

    def rate(self, T: np.ndarray, scene: Scene) -> np.ndarray:
        """Slopes of the nodes [K/s]."""

    def loss_torque(self, T: np.ndarray, scene: Scene) -> np.ndarray:
        """Loss torque at the carrier without what faults brake [N.m]."""

    def second_oil(self, places: Mapping[str, np.ndarray]) -> np.ndarray:
        """Oil temperature at the second place [degC]."""


def run(rig: Rig, channels: int, plan: Plan, base: Mapping[str, Any], acting: Sequence[Acting]) -> np.ndarray:
    """True readings at the ends of both halves (channels, 2, columns), instruments' faults among them.

    Args:
        rig: the physics
        channels: how many of `CHANNELS` there are
        plan, base: the tests, and factors that hold throughout
        acting: hidden faults, their columns, and how much of them in each
    """
    m = plan.columns
    dwell = plan.dwell * np.ones((2, m))
    for fault, s, amount in acting:
        if "pace" in fault.stages:
            fault.stages["pace"](dwell[:, s], cut(plan, s), amount)
    begin, first, second = plan.room
    restart = first + (second - first) * plan.stop / (plan.stop + plan.dwell[1])
    rooms = [(begin, first), (first, restart), (restart, second)]
    shown = np.empty((len(CHANNELS), 2, m))
    T = np.tile(plan.start, (rig.nodes, 1))
    ends = STEADY_ENDS if plan.steady else ENDS
    for stretch, (half, minutes) in enumerate(((0, dwell[0]), (None, plan.stop), (1, dwell[1]))):
        stage = _Stage(rig, plan, base, acting, half, rooms[stretch])
        T = march(stage.rate, T, ends[stretch], 60.0 * minutes)
        if half is not None:
            shown[:, half] = stage.read(T)
    for fault, s, amount in acting:
        if "read" in fault.stages:
            fault.stages["read"](shown[:, :, s], cut(plan, s), amount)
    return shown[:channels]


def cut(plan: Plan, s: slice) -> Plan:
    """Some columns of a plan."""
    arrays = [f.name for f in fields(plan) if isinstance(getattr(plan, f.name), np.ndarray)]
    return replace(plan, **{name: getattr(plan, name)[..., s] for name in arrays})


class _Stage:
    """A stretch of the protocol: constant speed and load, the room on a line. `half` None: a stop."""

    def __init__(
        self,
        rig: Rig,
        plan: Plan,
        base: Mapping[str, Any],
        acting: Sequence[Acting],
        half: int | None,
        room: tuple[np.ndarray, np.ndarray],
    ) -> None:
        self.rig, self.plan, self.half, self.room = rig, plan, half, room
        self.base = {name: base.get(name, 1.0) * np.ones(plan.columns) for name in FACTORS}
        self.acting = [(fault, s, amount) for fault, s, amount in acting if "act" in fault.stages]

    def _scene(self, T: np.ndarray, share: float) -> Scene:
        plan, m, places = self.plan, self.plan.columns, self.rig.temperatures(T)
        stopped = self.half is None
        half = self.half or 0
        scene = Scene(
            n=np.zeros(m) if stopped else plan.n[half],
            load=np.zeros(m) if stopped else plan.load[half],
            direction=np.full(m, float(plan.directions[half])),
            order=plan.order,
            progress=plan.progress,
            humidity=plan.humidity,
            room=self.room[0] + share * (self.room[1] - self.room[0]),
            T=places,
            nu=self.rig.viscosity(places["oil"]),
            factor={name: f.copy() for name, f in self.base.items()},
            heat={place: np.zeros(m) for place in PLACES},
            power=np.zeros(m),
        )
        for fault, s, amount in self.acting:
            fault.stages["act"](scene.cut(s), amount)
        return scene

    def rate(self, T: np.ndarray, share: float) -> np.ndarray:
        """Slopes of the nodes."""
        return self.rig.rate(T, self._scene(T, share))

    def read(self, T: np.ndarray) -> np.ndarray:
        """All channels at the end (channels, columns)."""
        scene = self._scene(T, 1.0)
        loss = self.rig.loss_torque(T, scene) + self.rig.power_unit * scene.power / scene.w
        sun = (scene.load + np.where(scene.direction == 1, -loss, loss)) / RATIO
        places = scene.T
        second = self.rig.second_oil(places)
        return np.array([scene.n, scene.load, sun, places["oil"], places["wall"], scene.room, second])


def grade(duration: float, first: float, growth: float, largest: float) -> np.ndarray:
    """Shares of a stretch at which steps end: small after the jump at its beginning, then growing.

    Args:
        duration: of the stretch [s]
        first, largest: steps [s]
        growth: of a step over the one before
    """
    ends, step = [0.0], first
    while ends[-1] < duration:
        ends.append(ends[-1] + step)
        step = min(step * growth, largest)
    return np.array(ends) / ends[-1]


#: Steps of the first half, the stop and the second half.
ENDS = (grade(14400.0, 15.0, 1.45, 700.0), grade(300.0, 25.0, 1.7, 700.0), grade(5400.0, 15.0, 1.45, 600.0))
#: The same of steady points, of which only the end counts.
STEADY_ENDS = tuple(grade(duration, 100.0, 2.0, 40000.0) for duration in (180000.0, 300.0, 180000.0))


def march(
    rate: Callable[[np.ndarray, float], np.ndarray], T: np.ndarray, shares: np.ndarray, duration: np.ndarray
) -> np.ndarray:
    """Temperatures at the end of a stretch (nodes, columns).

    The two-stage Rosenbrock method of Verwer: second order whatever matrix it is given, so the matrix (by differences)
    is refreshed now and then only.

    Args:
        rate: slope of all columns: (temperatures (nodes, columns), share of the stretch gone by) -> K/s
        T: temperatures at the beginning
        shares: where steps end, from 0 to 1
        duration: length of the stretch per column [s]
    """
    unit, matrix = np.eye(len(T)), np.zeros(0)
    for i, step in enumerate(np.diff(shares)):
        share = float(shares[i])
        slope = rate(T, share)
        if i % REFRESH == 0:
            columns = [(rate(T + 1e-3 * unit[:, [j]], share) - slope) / 1e-3 for j in range(len(T))]
            matrix = np.array(columns).transpose(2, 1, 0)
        dt = step * duration
        inverse = np.linalg.inv(unit - (GAMMA * dt)[:, None, None] * matrix)
        k_1 = np.einsum("cij,jc->ic", inverse, slope)
        k_2 = np.einsum("cij,jc->ic", inverse, rate(T + dt * k_1, share + step) - 2.0 * k_1)
        T = T + dt * (1.5 * k_1 + 0.5 * k_2)
    return T
