"""Faults of the sheets "own" and "foreign": every cause is a family of forms, drawn freely.

A family states what it does with numbers that are drawn (f): a pair is an even range, a list a choice.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from .instruments import BOTH, INSTRUMENTS, LOAD, NU, ROW, T_OIL, UP, Draw, Family, N, add, by_order, family, follow
from .plan import Plan
from .rig import Scene
from .textbook.rig import Fault


def _brake(high: float, shape: Callable[[Scene, Any], Any], *places: str, unit: str = "W", **spans: Any) -> Family:
    """A power, or a torque, that brakes; its heat goes to the first place by the share f.to, evenly to the others."""

    def act(s: Scene, a: np.ndarray, f: SimpleNamespace) -> None:
        power = a * shape(s, f) * (s.running if unit == "W" else s.w)
        first, *others = places
        s.brake(power, {first: f.to, **{place: (1 - f.to) / len(others) for place in others}})

    return family(high, unit, UP, "act", act, spans)


def _scale(high: float, names: str, shape: Callable[[Scene, Any], Any], signs: Any = BOTH, **spans: Any) -> Family:
    """Factors that are an exponential of the amount times a shape."""

    def act(s: Scene, a: np.ndarray, f: SimpleNamespace) -> None:
        for name in (names or f.what).split():
            s.scale(name, np.exp(np.clip(a * shape(s, f), -4.0, 2.0)))

    return family(high, "ln", signs, "act", act, spans)


def step(x: np.ndarray, threshold: float, width: float) -> np.ndarray:
    """0 far below, 1 far above the threshold."""
    return np.asarray(0.5 + 0.5 * np.tanh((x - threshold) / width))


def _churn(s: Scene, f: Any) -> np.ndarray:
    """Power of speed, a sum of two powers, or what sets in at some speed."""
    x = s.n / N
    speed = {
        "power": x**f.p,
        "two": 0.5 * x**1.3 + 0.5 * x**3,
        "onset": (0.08 * np.logaddexp(0.0, (s.n - f.n_0) / 8.0)) ** (0.6 * f.p),
    }[f.kind]
    return np.asarray(speed * (s.nu / NU) ** f.q)


def _overfill(s: Scene, a: np.ndarray, f: Any) -> None:
    """More oil is churned, stores heat and wets more."""
    s.brake(a * (s.n / N) ** f.p * (s.nu / NU) ** f.q * s.running, {"oil": 0.9, "gears": 0.1})
    s.scale("cap_oil", 1 + a / 400.0)
    s.scale("oil_inner", 1 + f.wet * a / 200.0)


def _rub(s: Scene, f: Any) -> np.ndarray:
    """By a power of speed and an exponential of the oil's temperature."""
    return np.asarray((np.maximum(s.n, 1.0) / N) ** f.p * np.exp(f.tilt * (s.T["oil"] - T_OIL) / 40.0))


def _teeth(s: Scene, f: Any) -> np.ndarray:
    """By powers of load and speed."""
    return np.asarray(np.minimum((np.maximum(s.load, 50.0) / LOAD) ** f.p * (np.maximum(s.n, 1.0) / N) ** f.q, 4.0))


def _starve(s: Scene, a: np.ndarray, f: Any) -> None:
    """Teeth rub more where the film is thin: by a power of speed times viscosity, or below some value of it."""
    film = np.maximum(s.n, 20.0) * s.nu / (N * NU)
    below = 0.5 - 0.5 * np.tanh(np.log(film / f.ratio) / f.width)
    s.scale("mesh", 1 + a * (np.minimum(film**-f.p, 5.0) if f.kind == "power" else below))


def _neighbour(s: Scene, a: np.ndarray, f: Any) -> None:
    """Heat at the housing, little of it in the oil, by a power of speed."""
    power = a * (np.maximum(s.n, 1.0) / N) ** f.p * (s.running if f.p > 0.3 else 1.0)
    s.warm("oil", f.oil * power)
    s.warm("wall", (1 - f.oil) * f.wall * power)
    s.warm(f.place, (1 - f.oil) * (1 - f.wall) * power)


def _tilt(place: str) -> Callable[[Scene, Any], Any]:
    return lambda s, f: 1 + f.p * (s.T[place] - 50.0) / 40.0


def _humidity(s: Scene, f: Any) -> np.ndarray:
    x = (s.humidity - 50.0) / 20.0
    return np.asarray(np.clip(x + f.p * x * x, -3.0, 3.0))


def _split(s: Scene, a: np.ndarray, f: Any) -> None:
    """Heat capacity that belongs to the housing instead of to gears and shafts, or the other way round; same sum."""
    inner = np.clip(f.inner * np.exp(a), 0.02, 0.95)
    s.scale("cap_in", inner / f.inner)
    s.scale("cap_out", (1 - inner) / (1 - f.inner))


def _early(dwell: np.ndarray, plan: Plan, a: np.ndarray, f: Any) -> None:
    """Readings before the stated time: in both halves or one, evenly or by chance."""
    hurry = np.abs(by_order(f.z, plan.order)) if f.chance else 1.0
    dwell *= np.exp(-np.minimum(a * np.array(f.halves)[:, None] * hurry, 3.5))


_TORQUE: dict[str, Any] = {"to": (0.2, 0.95), "unit": "N.m"}
_HEATED = lambda y, f: ("T_amb_C", 35.0 * (np.maximum(y[ROW["T_wall_C"]] - y[ROW["T_amb_C"]], 0.0) / 35.0) ** f.p)  # noqa: E731

CAUSES: Mapping[str, Family] = {
    "losses.churning": _brake(
        450.0,
        _churn,
        "oil",
        "gears",
        to=(0.55, 1.0),
        kind=["power", "power", "two", "onset"],
        p=(1.35, 3.0),
        q=(-0.1, 0.45),
        n_0=(50.0, 150.0),
    ),
    "losses.oil_viscosity": _scale(1.6, "viscosity", lambda s, f: 1 + f.p * (s.T["oil"] - T_OIL) / 40, p=(-0.5, 0.5)),
    "losses.oil_level": family(400.0, "W", UP, "act", _overfill, {"p": (1.4, 2.6), "q": (0.0, 0.4), "wet": (0.0, 0.3)}),
    "losses.bearing_preload": _brake(14.0, _rub, "oil", "body", "wall", p=(0.0, 0.35), tilt=(-0.65, 0.45), **_TORQUE),
    "losses.seal_drag": _brake(14.0, _rub, "oil", "body", "wall", p=(-0.3, 0.5), tilt=(-0.7, 0.0), **_TORQUE),
    "losses.mesh_friction": _scale(0.9, "mesh", _teeth, p=(-0.4, 1.0), q=(-0.35, 0.35)),
    "losses.mesh_direction": _scale(
        0.8,
        "mesh",
        lambda s, f: _teeth(s, f) * np.where(s.direction == 1, *f.parts),
        p=(-0.3, 0.7),
        q=[0.0],
        parts=[(0.0, 1.0), (1.0, 0.0), (-0.5, 0.5)],
    ),
    "losses.film_starvation": family(
        1.4,
        "1",
        UP,
        "act",
        _starve,
        {"kind": ["power", "threshold"], "p": (0.7, 2.2), "ratio": (0.6, 1.6), "width": (0.15, 0.5)},
    ),
    "losses.windage": _brake(
        400.0,
        lambda s, f: (s.n / N) ** f.p * 330.0 / (273.15 + s.T["wall"]),
        "oil",
        "gears",
        "wall",
        to=(0.2, 0.8),
        p=(2.1, 3.3),
    ),
    "heat.external_source": family(
        400.0,
        "W",
        UP,
        "act",
        _neighbour,
        {"p": (0.0, 2.0), "oil": (0.0, 0.3), "wall": (0.0, 1.0), "place": ["surface", "surface", "body"]},
    ),
    "cooling.air": _scale(1.2, "conv", lambda s, f: (s.rise / 35.0) ** f.p, p=(-0.5, 0.5)),
    "cooling.emissivity": _scale(2.6, "rad", _tilt("surface"), (-1,), p=(-0.2, 0.2)),
    "cooling.foundation": _scale(1.8, "foot", lambda s, f: (s.rise / 35.0) ** f.p, p=(-0.3, 0.3)),
    "cooling.contact": _scale(4.0, "contact", _tilt("wall"), (-1,), p=(-0.3, 0.3)),
    "cooling.oil_wall": _scale(2.2, "oil_wall", lambda s, f: (np.maximum(s.n, 20.0) / N) ** f.p, p=(-0.5, 0.6)),
    "cooling.humidity": _scale(0.35, "conv", _humidity, p=(-0.4, 0.4)),
    "thermal.mass": _scale(1.0, "", lambda s, f: 1.0, what=["cap_out cap_in", "cap_out cap_in", "cap_out"]),
    "thermal.split": family(1.2, "ln", BOTH, "act", _split, {}),
    **{
        name: INSTRUMENTS[name]
        for kind, errors in (
            ("torque", "offset gain drift since by_direction random_walk"),
            ("oil_temp", "offset gain since by_direction"),
            ("wall_temp", "offset since"),
            ("ambient", "offset since"),
            ("speed", "gain"),
        )
        for name in (f"sensor.{kind}.{error}" for error in errors.split())
    },
    "sensor.oil_temp.position": follow(
        0.5, lambda y, f: ("T_oil_C", y[ROW[f.other]] - y[ROW["T_oil_C"]]), UP, other=["T_wall_C", "T_amb_C"]
    ),
    "sensor.ambient.heated": follow(0.35, _HEATED, UP, p=(0.8, 1.4)),
    "procedure.not_stationary": family(
        2.6, "ln", UP, "pace", _early, {"halves": [(1, 1), (1, 1), (1, 0), (0, 1)], "chance": [False, False, True]}
    ),
    "procedure.order": _scale(
        0.6,
        "",
        lambda s, f: s.progress if f.tau is None else np.exp(-s.progress / f.tau),
        what=["mesh", "mesh bearing seal", "conv rad"],
        tau=[None, 0.2, 0.4],
    ),
    "procedure.day_scatter": _scale(0.25, "conv rad", lambda s, f: by_order(f.z, s.order), UP),
}

#: What has no name: a fan by thermostat on some days, a seal that rubs in waves, resonance, a transducer
#: that remembers where its load came from, an oil sensor that the drive disturbs.
OUTSIDE: Mapping[str, Family] = {
    "outside.thermostat_fan": _scale(
        1.3, "conv", lambda s, f: (by_order(f.z, s.order) > 0) * step(s.T["wall"], f.on - 3.0, 1.5), UP, on="oil"
    ),
    "outside.swinging_seal": _brake(
        14.0,
        lambda s, f: 1 + np.sin(f.phase + 2 * np.pi * f.periods * s.progress),
        "oil",
        "body",
        "wall",
        unit="N.m",
        to=[0.3],
        periods=(1.5, 5.0),
        phase=(0.0, 6.28),
    ),
    "outside.resonance": _brake(
        500.0,
        lambda s, f: np.exp(-(((s.n - f.at) / f.width) ** 2)) * s.load / LOAD,
        "wall",
        "body",
        to=[0.7],
        at="n",
        width=(8.0, 20.0),
    ),
    "outside.hysteresis": add(
        "torque",
        lambda p, f: np.sign(by_order(f.z, p.order)) * np.array([[1.0], [-0.6]]) * 4 * (x := p.load / 3000.0) * (1 - x),
    ),
    "outside.crosstalk": add(
        "oil_temp", lambda p, f: (p.n * p.load / (N * LOAD)) ** 2 * np.array([[1.0], [f.back]]), back=(-1.0, -0.3)
    ),
}

#: Causes that may act in a part of the conditions only -> what may limit them.
REGIMES: Mapping[str, list[str]] = {
    "losses.churning": ["speed", "temperature"],
    "losses.windage": ["speed"],
    "losses.mesh_friction": ["speed", "load", "temperature"],
    "losses.seal_drag": ["speed", "temperature", "direction"],
    "losses.bearing_preload": ["load", "temperature", "direction"],
    "heat.external_source": ["speed", "load", "direction"],
    "cooling.air": ["temperature", "direction"],
}


#: Causes, or their last words, that steady points in one direction do not show.
NOT_STEADY = frozenset(
    ("losses.mesh_direction", "cooling.humidity", "thermal.mass", "thermal.split", "procedure.not_stationary")
    + ("by_direction", "outside.hysteresis", "outside.crosstalk")
)


def names(kind: str) -> Sequence[str]:
    """Causes that a kind of case may hide."""
    return list({"regime": REGIMES, "outside": OUTSIDE}.get(kind, CAUSES))


def steady_names(kind: str) -> Sequence[str]:
    """Causes that a kind of case of steady points may hide."""
    return [name for name in names(kind) if not {name, name.rpartition(".")[2]} & NOT_STEADY]


def misreadings(plan: Plan) -> Sequence[str]:
    """Errors of instruments that the tests may show."""
    return [name for name in INSTRUMENTS if not (plan.steady and name.rpartition(".")[2] in NOT_STEADY)]


def draw(plan: Plan, inner: float, cause: str, kind: str, oil: np.ndarray, rng: np.random.Generator) -> Fault:
    """A fault of a cause in a form for a kind of case; oil: healthy oil temperatures."""
    d = Draw(rng, plan.n.ravel(), plan.load.ravel(), oil.ravel(), plan.tests, inner, plan.steady)
    fault = replace({**INSTRUMENTS, **CAUSES, **OUTSIDE}[cause](d), cause=cause)
    return _limit(fault, d) if kind == "regime" else fault


#: Where a regime may end, and the width of its border; of a direction between 1 and 2.
BORDERS: Mapping[str, tuple[Any, tuple[float, float]]] = {
    "speed": ("n", (2.0, 14.0)),
    "load": ("load", (20.0, 130.0)),
    "temperature": ("oil", (1.0, 4.0)),
    "direction": ([1.5], (0.05, 0.06)),
}


def _limit(fault: Fault, d: Draw) -> Fault:
    """The same on one side of a threshold inside the campaign's range, or in one direction."""
    kind = str(d.rng.choice([kind for kind in REGIMES[fault.cause] if kind != "direction" or not d.steady]))
    f, stage = d.numbers({"at": BORDERS[kind][0], "width": BORDERS[kind][1], "side": [1, -1]}), fault.stages["act"]

    def act(s: Scene, a: np.ndarray) -> None:
        x = {"speed": s.n, "load": s.load, "temperature": s.T["oil"], "direction": s.direction}[kind]
        stage(s, a * step(f.side * x, f.side * f.at, f.width))

    regime = {kind: "above" if f.side > 0 else "below", "threshold": f.at, "width": f.width}
    return replace(fault, stages={"act": act}, regime=regime)
