"""The textbook rig: six bodies, losses and coolings from textbooks, marched through a test. FROZEN, see the package.

Bodies: oil, gears (sun and planets), carrier, wall (ring and inner wall), skin (outer surface), bed (the frame).
All arrays are (columns,): a column is a test, or a copy of a test in another variant.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np

from ..plan import OIL, Plan

N0 = 190.0  # middling speed [rpm]
LOAD0 = 2100.0  # middling torque [N.m]
BODIES = ("oil", "gears", "carrier", "wall", "skin", "bed")
RATIO = 4.0

#: Readings, in the order of the files.
SHOWN = ("n_carrier_rpm", "T_carrier_Nm", "T_sun_Nm", "T_oil_C", "T_wall_C", "T_amb_C")

#: Where losses go as heat: two bodies; the first one's share is the number.
HEATS: Mapping[str, tuple[str, str, float]] = {
    "mesh": ("gears", "oil", 0.6),
    "carrier_bearing": ("carrier", "wall", 0.5),
    "sun_bearing": ("gears", "wall", 0.4),
    "carrier_seal": ("carrier", "skin", 0.6),
    "sun_seal": ("gears", "skin", 0.6),
    "splash": ("oil", "wall", 0.9),
}

#: Conductances between bodies; "room" is outside.
PATHS: Mapping[str, tuple[str, str]] = {
    "oil_gears": ("oil", "gears"),
    "oil_carrier": ("oil", "carrier"),
    "oil_wall": ("oil", "wall"),
    "carrier_wall": ("carrier", "wall"),
    "joint": ("wall", "skin"),
    "feet": ("wall", "bed"),
    "air": ("skin", "room"),
    "radiation": ("skin", "room"),
    "shaft": ("carrier", "room"),
    "floor": ("bed", "room"),
}


@dataclass
class Now:
    """One instant of all columns; faults change it in place.

    Args:
        n, load: carrier speed [rpm] and torque [N.m]
        direction: 1.0 or 2.0
        progress: running order as a share of the campaign
        humidity: of the room [%]
        room: its temperature [degC]
        T: temperatures of the bodies (6, columns) [degC]
        nu: viscosity of the gears' oil [mm2/s]
        P: loss powers [W]; share: of the first body in `HEATS`
        G: conductances [W/K]; Q: further heat of the bodies (6, columns) [W]; extra: further loss power [W]
    """

    n: np.ndarray
    load: np.ndarray
    direction: np.ndarray
    progress: np.ndarray
    humidity: np.ndarray
    room: np.ndarray
    T: np.ndarray
    nu: np.ndarray
    P: dict[str, np.ndarray] = field(default_factory=dict)
    share: dict[str, np.ndarray] = field(default_factory=dict)
    G: dict[str, np.ndarray] = field(default_factory=dict)
    Q: np.ndarray = field(default_factory=lambda: np.zeros(0))
    extra: np.ndarray = field(default_factory=lambda: np.zeros(0))

    def cut(self, s: slice) -> Now:
        """Views of some columns."""
        views: dict[str, Any] = {}
        for key, value in vars(self).items():
            views[key] = {k: a[s] for k, a in value.items()} if isinstance(value, dict) else value[..., s]
        return replace(self, **views)

    @property
    def w(self) -> np.ndarray:
        """Carrier speed [rad/s]."""
        return np.asarray(self.n * np.pi / 30.0)

    def temperature(self, body: str) -> np.ndarray:
        """Of a body [degC]."""
        return np.asarray(self.T[BODIES.index(body)])

    def lose(self, power: np.ndarray, body: str, other: str, share: float) -> None:
        """A further loss: torque, and heat in two bodies."""
        self.extra += power
        self.heat(share * power, body)
        self.heat((1.0 - share) * power, other)

    def heat(self, power: np.ndarray, body: str) -> None:
        """Heat without torque."""
        self.Q[BODIES.index(body)] += power


#: Changes an instant, readings or times of some columns by amounts.
Stage = Callable[..., None]


@dataclass(frozen=True)
class Fault:
    """A fault of a drawn form.

    Args:
        cause: its stable name
        high: largest sensible amount; unit: of the amount; signs: that it may have
        stages: "oil", "loss", "cool" (Now, amounts); "mass" (capacities (6, columns), amounts); "pace" (dwells (2,
            columns), amounts); "read" (readings, plan, amounts)
        form: what was drawn, for the record; regime: the limits of where it acts
    """

    cause: str
    high: float
    unit: str
    stages: Mapping[str, Stage]
    form: Mapping[str, Any] = field(default_factory=dict)
    signs: tuple[int, ...] = (1,)
    regime: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Around:
    """What a fault is drawn for.

    Args:
        n, load, oil: speeds, torques and healthy oil temperatures of the readings
        tests: number of tests
    """

    n: np.ndarray
    load: np.ndarray
    oil: np.ndarray
    tests: int


#: Draws a fault.
Family = Callable[[np.random.Generator, Around], Fault]

#: A fault, its columns, and how much of it in each of them.
Acting = tuple[Fault, slice, np.ndarray]


@dataclass(frozen=True)
class Sizes:
    """What a rig is built like, relative to a middling one, and what lubricates its bearings."""

    factors: Mapping[str, float]
    bearing_oil: bool
    draught: float
    mesh_level: float


#: Spread of sizes in octaves, up and down.
SPREAD: Mapping[str, float] = {
    "seal": 0.6,
    "bearing": 0.5,
    "splash": 0.8,
    "oil_gears": 0.9,
    "oil_wall": 0.9,
    "joint": 0.9,
    "feet": 1.0,
    "skin": 0.5,
    "C_inner": 0.6,
    "C_outer": 0.7,
    "C_oil": 0.5,
}


def draw_sizes(rng: np.random.Generator) -> Sizes:
    """A rig up to a factor of two from the middling one."""
    factors = {name: float(2.0 ** rng.uniform(-octaves, octaves)) for name, octaves in SPREAD.items()}
    return Sizes(factors, bool(rng.random() < 0.5), float(rng.uniform(0.15, 0.9)), float(rng.uniform(0.7, 1.05)))


def viscosity(T: np.ndarray, nu40: float = OIL["nu40"], nu100: float = OIL["nu100"]) -> np.ndarray:
    """Ubbelohde and Walther [mm2/s]."""
    w40, w100 = (np.log10(np.log10(v + 0.7)) for v in (nu40, nu100))
    slope = (w40 - w100) / (np.log10(373.15) - np.log10(313.15))
    w = w40 - slope * (np.log10(np.clip(T, -20.0, 300.0) + 273.15) - np.log10(313.15))
    return np.asarray(10.0 ** (10.0**w) - 0.7)


def losses(now: Now, sizes: Sizes, base: Mapping[str, Any]) -> dict[str, np.ndarray]:
    """Loss powers of a healthy rig [W]."""
    w, n, sun = now.n * np.pi / 30.0, now.n, RATIO * now.n
    eta = 0.85 * now.nu  # mPa.s
    v = np.maximum(np.pi * 0.073 * (sun - n) / 60.0, 1e-3)  # rolling of the pitch circles, carrier held [m/s]
    line = np.maximum(now.load / RATIO / (3 * 0.0365) / 42.0, 1.0)  # N/mm
    mu = 0.0127 * 1.35 * np.log10(np.maximum(29662.0 * line / (eta * 0.25 * v * (0.68 * v) ** 2), 20.0))
    mesh = base["mesh"] * sizes.mesh_level * mu * 0.75 * (0.168 + 0.062) * now.load * w
    greased = now.temperature("carrier"), now.temperature("wall")
    oiled = now.nu if sizes.bearing_oil else None
    nu_c, nu_s = (oiled if oiled is not None else viscosity(T, 110.0, 12.0) for T in greased)
    force = 9000.0 + 1.2 * now.load
    c = 2 * (1e-10 * 4.5 * (nu_c * n) ** (2 / 3) * 140.0**3 + 4e-4 * force * 0.14) * w
    s = (1e-10 * 2.0 * (nu_s * sun) ** (2 / 3) * 117.0**3 + 6e-4 * (0.5 * now.load) * 0.117) * RATIO * w
    stiff = 145.0 + 350.0 * np.log10(np.log10(OIL["nu40"] + 0.8))
    seal_c, seal_s = (
        0.4e-7 * np.maximum(stiff - 1.6 * T, 20.0) * d * d * speed
        for T, d, speed in ((now.temperature("skin"), 140.0, n), (now.temperature("skin"), 85.0, sun))
    )
    splash = 30.0 * (n / 200.0) ** 1.6 * (now.nu / 100.0) ** 0.2
    f, b = sizes.factors, base
    return {
        "mesh": mesh,
        "carrier_bearing": c * f["bearing"] * b["bearing"],
        "sun_bearing": s * f["bearing"] * b["bearing"],
        "carrier_seal": seal_c * f["seal"] * b["seal"],
        "sun_seal": seal_s * f["seal"] * b["seal"],
        "splash": splash * f["splash"] * b["splash"],
    }


def conductances(now: Now, sizes: Sizes, base: Mapping[str, Any]) -> dict[str, np.ndarray]:
    """Of a healthy rig [W/K]."""
    f, area = sizes.factors, 2.1 * sizes.factors["skin"]
    stir = (0.05 + now.n / 200.0) ** 0.6 * (now.nu / 100.0) ** -0.15
    skin, room = now.temperature("skin"), now.room
    h = _convection(skin, room, sizes.draught) * base["conv"]
    a, b = skin + 273.15, room + 273.15
    one = np.ones_like(room)
    return {
        "oil_gears": 55.0 * f["oil_gears"] * stir * base["oil_side"],
        "oil_carrier": 25.0 * f["oil_gears"] * stir * base["oil_side"],
        "oil_wall": 40.0 * f["oil_wall"] * stir * base["oil_side"],
        "carrier_wall": 5.0 * one,
        "joint": 90.0 * f["joint"] * base["joint"] * one,
        "feet": 6.0 * f["feet"] * base["feet"] * one,
        "air": h * area,
        "radiation": 0.85 * 5.67e-8 * (a * a + b * b) * (a + b) * area * 0.8 * base["rad"],
        "shaft": 1.2 * one,
        "floor": 9.0 * f["feet"] ** 0.5 * one,
    }


def _convection(T: np.ndarray, room: np.ndarray, draught: float, d: float = 0.38) -> np.ndarray:
    """Of a horizontal cylinder [W/(m2.K)]: free after Churchill and Chu, in a draught after Churchill and Bernstein."""
    film = 0.5 * (T + room) + 273.15
    k, nu = 0.0241 * (film / 273.15) ** 0.81, 1.33e-5 * (film / 273.15) ** 1.75
    Pr = 0.71
    Ra = 9.81 * np.maximum(np.abs(T - room), 0.05) / film * d**3 / nu**2 * Pr
    free = (0.60 + 0.387 * Ra ** (1 / 6) / (1 + (0.559 / Pr) ** (9 / 16)) ** (8 / 27)) ** 2
    Re = draught * d / nu
    forced = (
        0.3
        + 0.62
        * np.sqrt(Re)
        * Pr ** (1 / 3)
        / (1 + (0.4 / Pr) ** (2 / 3)) ** 0.25
        * (1 + (Re / 282000.0) ** 0.625) ** 0.8
    )
    return np.asarray((free**4 + forced**4) ** 0.25 * k / d)


#: Heat capacities of a middling rig [J/K].
CAPACITIES: Mapping[str, tuple[float, str]] = {
    "oil": (1900.0, "C_oil"),
    "gears": (4200.0, "C_inner"),
    "carrier": (9000.0, "C_inner"),
    "wall": (36000.0, "C_outer"),
    "skin": (22000.0, "C_outer"),
    "bed": (34000.0, "C_outer"),
}

#: Parameters that may differ between rigs of one build, and what a day may change; factors.
BASE: Mapping[str, float] = dict.fromkeys(
    ("mesh", "bearing", "seal", "splash", "conv", "rad", "oil_side", "joint", "feet", "cap"), 1.0
)


def run(sizes: Sizes, plan: Plan, base: Mapping[str, Any], acting: Sequence[Acting]) -> np.ndarray:
    """True readings at the ends of both halves (channels, 2, columns), instruments' faults among them."""
    m = plan.columns
    factors = {**BASE, **base}
    C = np.array([np.full(m, c * sizes.factors[name]) for c, name in CAPACITIES.values()]) * factors["cap"]
    dwell = plan.dwell * np.ones((2, m))
    for fault, s, amount in acting:
        if "mass" in fault.stages:
            fault.stages["mass"](C[:, s], amount)
        if "pace" in fault.stages:
            fault.stages["pace"](dwell[:, s], amount)
    T = np.tile(plan.start, (len(BODIES), 1)) * 1.0
    shown = np.empty((len(SHOWN), 2, m))
    march = _March(sizes, plan, factors, acting, C)
    for half in (0, 1):
        full, real = plan.dwell[half] * np.ones(m), dwell[half]
        edges = np.linspace(0.0, 1.0, 19 if half == 0 else 13) ** 1.7
        for a, b in pairwise(edges):
            T = march.step(T, half, a * real, b * real, full)
        loss = march.loss(T, half, real, full)
        n, load = plan.n[half], plan.load[half]
        sign = -1.0 if half == 0 else 1.0
        room = plan.room[half + 1]
        sun = (load + sign * loss / np.maximum(n * np.pi / 30.0, 1e-6)) / RATIO
        shown[:, half] = n, load, sun, T[BODIES.index("oil")], T[BODIES.index("wall")], room
        if half == 0:
            for _ in range(2):
                T = march.step(T, None, 0.0 * plan.stop, 0.5 * plan.stop, plan.stop)
    for fault, s, amount in acting:
        if "read" in fault.stages:
            fault.stages["read"](shown[:, :, s], _columns(plan, s), amount)
    return shown


def _columns(plan: Plan, s: slice) -> Plan:
    names = ("n", "load", "order", "room", "start", "dwell", "stop", "humidity")
    return replace(plan, **{name: getattr(plan, name)[..., s] for name in names if np.ndim(getattr(plan, name))})


class _March:
    """Steps of the six bodies: linearly implicit in the conductances, extrapolated to the second order."""

    def __init__(
        self, sizes: Sizes, plan: Plan, base: Mapping[str, Any], acting: Sequence[Acting], C: np.ndarray
    ) -> None:
        self.sizes, self.plan, self.base, self.acting, self.C = sizes, plan, base, acting, C

    def _now(self, T: np.ndarray, half: int | None, minutes: np.ndarray, full: np.ndarray) -> Now:
        plan, m = self.plan, self.plan.columns
        moving = half is not None
        h = half or 0
        share = minutes / full if moving else np.zeros(m)
        room = plan.room[h] + (plan.room[h + 1] - plan.room[h]) * share if moving else plan.room[1] * 1.0
        n, load = (plan.n[h] * 1.0, plan.load[h] * 1.0) if moving else (np.full(m, 1e-6), np.full(m, 1.0))
        now = Now(n, load, np.full(m, h + 1.0), plan.progress * 1.0, plan.humidity * 1.0, room, T, viscosity(T[0]))
        now.Q, now.extra = np.zeros_like(T), np.zeros(m)
        self._stage("oil", now)
        now.P = losses(now, self.sizes, self.base)
        now.share = {name: np.full(m, share) for name, (_, _, share) in HEATS.items()}
        self._stage("loss", now)
        now.G = conductances(now, self.sizes, self.base)
        self._stage("cool", now)
        return now

    def _stage(self, name: str, now: Now) -> None:
        for fault, s, amount in self.acting:
            if name in fault.stages:
                fault.stages[name](now.cut(s), amount)

    def loss(self, T: np.ndarray, half: int, minutes: np.ndarray, full: np.ndarray) -> np.ndarray:
        """All loss power [W]."""
        now = self._now(T, half, minutes, full)
        return np.asarray(sum(now.P.values()) + now.extra)

    def step(self, T: np.ndarray, half: int | None, a: np.ndarray, b: np.ndarray, full: np.ndarray) -> np.ndarray:
        """Temperatures at minute b from those at minute a."""
        first, middle = self._now(T, half, a, full), 0.5 * (a + b)
        whole = self._euler(first, 60.0 * (b - a))
        half_way = self._euler(first, 30.0 * (b - a))
        twice = self._euler(self._now(half_way, half, middle, full), 30.0 * (b - a))
        return np.asarray(np.clip(2.0 * twice - whole, -50.0, 900.0))

    def _euler(self, now: Now, seconds: np.ndarray) -> np.ndarray:
        m, size = now.T.shape[1], len(BODIES)
        A, rhs = np.zeros((m, size, size)), self.C * now.T / seconds + now.Q
        index = {body: i for i, body in enumerate(BODIES)}
        A[:, range(size), range(size)] = (self.C / seconds).T
        for name, (one, other) in PATHS.items():
            i, G = index[one], now.G[name]
            A[:, i, i] += G
            if other == "room":
                rhs[i] += G * now.room
                continue
            j = index[other]
            A[:, j, j] += G
            A[:, i, j] -= G
            A[:, j, i] -= G
        for name, (one, other, _) in HEATS.items():
            rhs[index[one]] += now.share[name] * now.P[name]
            rhs[index[other]] += (1.0 - now.share[name]) * now.P[name]
        return np.asarray(np.linalg.solve(A, rhs.T[:, :, None])[:, :, 0].T)
