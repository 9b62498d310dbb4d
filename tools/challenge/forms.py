"""Faults of the sheets "own" and "foreign": every cause is a family of forms, drawn freely.

Faults of the torque transducers act on the columns of the files, which are magnitudes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .plan import Plan
from .rig import CHANNELS, RATIO, Scene
from .textbook.rig import Fault

#: Conditions at which amounts are stated: speed [rpm], torque [N.m], viscosity [mm2/s], oil temperature [degC].
N, LOAD, NU, T_OIL = 175.0, 2100.0, 80.0, 60.0

ROW = {c: i for i, c in enumerate(CHANNELS)}


@dataclass(frozen=True)
class Draw:
    """Chance, and what a draw may know of the campaign.

    Args:
        rng: source of chance
        n, load, oil: speeds, torques and healthy oil temperatures of the readings
        tests: number of tests
        inner: share of gears and shafts in the heat capacity of all but the oil
        own: whether the physics are those of the project's model
    """

    rng: np.random.Generator
    n: np.ndarray
    load: np.ndarray
    oil: np.ndarray
    tests: int
    inner: float
    own: bool

    def uniform(self, low: float, high: float) -> float:
        """A number between two."""
        return float(f"{self.rng.uniform(low, high):.4g}")

    def pick(self, *choices: Any) -> Any:
        """One of several."""
        return choices[int(self.rng.integers(len(choices)))]

    def per_test(self) -> np.ndarray:
        """A standard normal number for every running order."""
        return self.rng.normal(0.0, 1.0, self.tests)


Family = Callable[[Draw], Fault]
BOTH = (1, -1)


def _physics(
    cause: str, high: float, unit: str, act: Callable[[Scene, Any], None], signs: Any = (1,), **form: Any
) -> Fault:
    return Fault(cause, high, unit, {"act": act}, form, signs)


def _at(table: np.ndarray, order: np.ndarray) -> np.ndarray:
    return np.asarray(table[order.astype(int) - 1])


def step(x: np.ndarray, threshold: float, width: float) -> np.ndarray:
    """0 far below, 1 far above the threshold."""
    return np.asarray(0.5 + 0.5 * np.tanh((x - threshold) / width))


# ------------------------------------------------------------------------------------------------------- losses


def churning(d: Draw) -> Fault:
    """Power of speed, a sum of two powers, or a loss that sets in at some speed."""
    kind, p, q, oil = (
        d.pick("power", "power", "two", "onset"),
        d.uniform(1.35, 3.0),
        d.uniform(-0.1, 0.45),
        d.uniform(0.55, 1),
    )
    n_0, share = d.uniform(50.0, 150.0), d.uniform(0.2, 0.8)

    def act(s: Scene, a: np.ndarray) -> None:
        x = s.n / N
        speed = {
            "power": x**p,
            "two": share * x**1.3 + (1 - share) * x**3,
            "onset": (0.08 * np.logaddexp(0.0, (s.n - n_0) / 8.0)) ** (0.6 * p),
        }[kind]
        s.brake(a * speed * (s.nu / NU) ** q * s.running, {"oil": oil, "gears": 1 - oil})

    return _physics("losses.churning", 450.0, "W", act, kind=kind, p=p, q=q, oil_share=oil, n_0=n_0, share=share)


def windage(d: Draw) -> Fault:
    """A high power of speed, the lighter the warmer the air is."""
    p, oil = d.uniform(2.1, 3.3), d.uniform(0.2, 0.8)

    def act(s: Scene, a: np.ndarray) -> None:
        power = a * (s.n / N) ** p * 330.0 / (273.15 + s.T["wall"]) * s.running
        s.brake(power, {"oil": oil, "gears": 0.5 * (1 - oil), "wall": 0.5 * (1 - oil)})

    return _physics("losses.windage", 400.0, "W", act, p=p, oil_share=oil)


def oil_level(d: Draw) -> Fault:
    """More oil: it is churned, stores heat and wets more."""
    p, q, wet = d.uniform(1.4, 2.6), d.uniform(0.0, 0.4), d.uniform(0.0, 0.3)

    def act(s: Scene, a: np.ndarray) -> None:
        s.brake(a * (s.n / N) ** p * (s.nu / NU) ** q * s.running, {"oil": 0.9, "gears": 0.1})
        s.scale("cap_oil", 1 + a / 400.0)
        s.scale("oil_inner", 1 + wet * a / 200.0)

    return _physics("losses.oil_level", 400.0, "W", act, p=p, q=q, wet=wet)


def oil_viscosity(d: Draw) -> Fault:
    """Another viscosity, by a factor that may depend on temperature."""
    tilt = d.uniform(-0.5, 0.5)

    def act(s: Scene, a: np.ndarray) -> None:
        s.scale("viscosity", np.exp(a * (1 + tilt * (s.T["oil"] - T_OIL) / 40.0)))

    return _physics("losses.oil_viscosity", 1.6, "ln", act, BOTH, tilt=tilt)


def _rubbing(cause: str, p: tuple[float, float], tilt: tuple[float, float]) -> Family:
    """A friction torque that depends on speed by a power and on oil temperature by an exponential."""

    def draw(d: Draw) -> Fault:
        exponent, slope, oil, out = d.uniform(*p), d.uniform(*tilt), d.uniform(0.2, 0.95), d.uniform(0.2, 0.8)
        heat = {"oil": oil, "body": (1 - oil) * (1 - out), "wall": (1 - oil) * out}

        def act(s: Scene, a: np.ndarray) -> None:
            torque = a * (np.maximum(s.n, 1.0) / N) ** exponent * np.exp(slope * (s.T["oil"] - T_OIL) / 40.0)
            s.brake(torque * s.w, heat)

        return _physics(cause, 14.0, "N.m", act, p=exponent, tilt=slope, heat=heat)

    return draw


def mesh_friction(d: Draw) -> Fault:
    """Teeth that rub differently, by powers of load and speed."""
    p, q = d.uniform(-0.4, 1.0), d.uniform(-0.35, 0.35)

    def act(s: Scene, a: np.ndarray) -> None:
        shape = (np.maximum(s.load, 50.0) / LOAD) ** p * (np.maximum(s.n, 1.0) / N) ** q
        s.scale("mesh", np.exp(a * np.minimum(shape, 4.0)))

    return _physics("losses.mesh_friction", 0.9, "ln", act, BOTH, p=p, q=q)


def mesh_direction(d: Draw) -> Fault:
    """Teeth that rub differently in one direction, or apart in both."""
    p, (first, second) = d.uniform(-0.3, 0.7), d.pick((0.0, 1.0), (1.0, 0.0), (-0.5, 0.5))

    def act(s: Scene, a: np.ndarray) -> None:
        shape = (np.maximum(s.load, 50.0) / LOAD) ** p
        s.scale("mesh", np.exp(a * shape * np.where(s.direction == 1, first, second)))

    return _physics("losses.mesh_direction", 0.8, "ln", act, BOTH, p=p, parts=(first, second))


def film_starvation(d: Draw) -> Fault:
    """Teeth that rub more where the film is thin: by a power of speed times viscosity, or below some value of it."""
    kind, p, ratio, width = d.pick("power", "threshold"), d.uniform(0.7, 2.2), d.uniform(0.6, 1.6), d.uniform(0.15, 0.5)

    def act(s: Scene, a: np.ndarray) -> None:
        film = np.maximum(s.n, 20.0) * s.nu / (N * NU)
        thin = np.minimum(film**-p, 5.0) if kind == "power" else 0.5 - 0.5 * np.tanh(np.log(film / ratio) / width)
        s.scale("mesh", 1 + a * thin)

    return _physics("losses.film_starvation", 1.4, "1", act, kind=kind, p=p, ratio=ratio, width=width)


def external_source(d: Draw) -> Fault:
    """Heat from a neighbour at the housing, little of it in the oil, by a power of speed."""
    p, oil, wall, place = (
        d.uniform(0.0, 2.0),
        d.uniform(0.0, 0.3),
        d.uniform(0.0, 1.0),
        d.pick("surface", "surface", "body"),
    )

    def act(s: Scene, a: np.ndarray) -> None:
        power = a * (np.maximum(s.n, 1.0) / N) ** p * (s.running if p > 0.3 else 1.0)
        s.warm("oil", oil * power)
        s.warm("wall", (1 - oil) * wall * power)
        s.warm(place, (1 - oil) * (1 - wall) * power)

    form = {"p": p, "oil_share": oil, "wall_share": wall, "place": place}
    return _physics("heat.external_source", 400.0, "W", act, **form)


# ------------------------------------------------------------------------------------- cooling, heat capacities


def _path(cause: str, path: str, high: float, signs: tuple[int, ...], how: str, span: tuple[float, float]) -> Family:
    """A heat path scaled by exp(amount), times something to a drawn power or tilted by a temperature."""

    def draw(d: Draw) -> Fault:
        p = d.uniform(*span)
        own_signs = (-1,) if path == "rad" and d.own else signs

        def act(s: Scene, a: np.ndarray) -> None:
            shape = {
                "rise": lambda: (s.rise / 35.0) ** p,
                "speed": lambda: (np.maximum(s.n, 20.0) / N) ** p,
                "surface": lambda: 1 + p * (s.T["surface"] - 50.0) / 40.0,
                "humidity": lambda: np.clip((h := (s.humidity - 50.0) / 20.0) + p * h * h, -3.0, 3.0),
            }[how]()
            s.scale(path, np.exp(np.clip(a * shape, -4.0, 2.0)))

        return _physics(cause, high, "ln", act, own_signs, p=p)

    return draw


def mass(d: Draw) -> Fault:
    """Heat capacities all larger or smaller, or those of the housing alone."""
    names = d.pick(("cap_out", "cap_in"), ("cap_out", "cap_in"), ("cap_out",))

    def act(s: Scene, a: np.ndarray) -> None:
        for name in names:
            s.scale(name, np.exp(a))

    return _physics("thermal.mass", 1.0, "ln", act, BOTH, names=names)


def split(d: Draw) -> Fault:
    """Heat capacity that belongs to the housing instead of to gears and shafts, or the other way round; same sum."""

    def act(s: Scene, a: np.ndarray) -> None:
        inner = np.clip(d.inner * np.exp(a), 0.02, 0.95)
        s.scale("cap_in", inner / d.inner)
        s.scale("cap_out", (1 - inner) / (1 - d.inner))

    return _physics("thermal.split", 1.2, "ln", act, BOTH)


# ------------------------------------------------------------------------------------ instruments and procedure

#: Columns of a kind of instrument with their scale, largest error, unit.
KINDS: Mapping[str, tuple[tuple[tuple[str, float], ...], float, str]] = {
    "torque": ((("T_carrier_Nm", 1.0), ("T_sun_Nm", 1.0 / RATIO)), 22.0, "N.m at the carrier"),
    "oil_temp": ((("T_oil_C", 1.0),), 9.0, "K"),
    "wall_temp": ((("T_wall_C", 1.0),), 9.0, "K"),
    "ambient": ((("T_amb_C", 1.0),), 9.0, "K"),
}


def _read(cause: str, high: float, unit: str, read: Callable[..., None], signs: Any = BOTH, **form: Any) -> Fault:
    return Fault(cause, high, unit, {"read": read}, form, signs)


def _added(
    kind: str, name: str, weigh: Callable[[Draw], tuple[Callable[[Plan], Any], dict[str, Any]]]
) -> tuple[str, Family]:
    """An error of a kind of instrument that is an amount times a drawn weight over tests (2, columns)."""
    cause = f"sensor.{kind}.{name}"

    def draw(d: Draw) -> Fault:
        columns, high, unit = KINDS[kind]
        (column, scale), (weight, form) = d.pick(*columns), weigh(d)

        def read(shown: np.ndarray, plan: Plan, a: np.ndarray) -> None:
            shown[ROW[column]] += scale * a * weight(plan)

        return _read(cause, high, unit, read, column=column, **form)

    return cause, draw


def _constant(d: Draw) -> tuple[Callable[[Plan], Any], dict[str, Any]]:
    return lambda plan: 1.0, {}


def _since(d: Draw) -> tuple[Callable[[Plan], Any], dict[str, Any]]:
    at, creep = d.uniform(0.25, 0.75), d.pick(0.0, 0.0, d.uniform(0.0, 0.5))
    return lambda p: np.where(p.progress > at, np.exp(-creep * np.maximum(p.progress - at, 0.0)), 0.0), {
        "at": at,
        "creep": creep,
    }


def _direction(d: Draw) -> tuple[Callable[[Plan], Any], dict[str, Any]]:
    weights = d.pick((1.0, 0.0), (0.0, 1.0), (1.0, -1.0))
    return lambda p: np.array(weights)[:, None], {"weights": weights}


def _walk(d: Draw) -> tuple[Callable[[Plan], Any], dict[str, Any]]:
    path = np.cumsum(d.per_test()) / np.sqrt(d.tests / 2.0)
    return lambda p: _at(path, p.order), {}


def _creep(d: Draw) -> tuple[Callable[[Plan], Any], dict[str, Any]]:
    p = d.pick(0.5, 0.7, 1.0)
    return lambda plan: plan.progress**p, {"p": p}


def _gain(cause: str, high: float, columns: Sequence[str], about: Sequence[float]) -> tuple[str, Family]:
    """A wrong slope of one of some columns, about a value at which it was adjusted."""

    def draw(d: Draw) -> Fault:
        column, zero = d.pick(*columns), d.pick(*about)

        def read(shown: np.ndarray, plan: Plan, a: np.ndarray) -> None:
            shown[ROW[column]] += a * (shown[ROW[column]] - zero)

        return _read(cause, high, "1", read, column=column, about=zero)

    return cause, draw


def position(d: Draw) -> Fault:
    """The oil sensor stands where the wall or the room draw on it."""
    other, high = d.pick(("T_wall_C", 0.95), ("T_amb_C", 0.3))

    def read(shown: np.ndarray, plan: Plan, a: np.ndarray) -> None:
        shown[ROW["T_oil_C"]] += a * (shown[ROW[other]] - shown[ROW["T_oil_C"]])

    return _read("sensor.oil_temp.position", high, "1", read, (1,), other=other)


def heated(d: Draw) -> Fault:
    """The room's sensor hangs in the warm air of the gearbox."""
    p = d.uniform(0.8, 1.4)

    def read(shown: np.ndarray, plan: Plan, a: np.ndarray) -> None:
        rise = np.maximum(shown[ROW["T_wall_C"]] - shown[ROW["T_amb_C"]], 0.0)
        shown[ROW["T_amb_C"]] += a * 35.0 * (rise / 35.0) ** p

    return _read("sensor.ambient.heated", 0.35, "1", read, (1,), p=p)


def not_stationary(d: Draw) -> Fault:
    """Readings taken before the stated time: in both halves or one, evenly or by chance."""
    halves = d.pick((1.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0))
    ragged = d.pick(np.ones(d.tests), np.ones(d.tests), np.abs(d.per_test()))

    def pace(dwell: np.ndarray, plan: Plan, a: np.ndarray) -> None:
        dwell *= np.exp(-np.minimum(a * np.array(halves)[:, None] * _at(ragged, plan.order), 3.5))

    return Fault("procedure.not_stationary", 2.6, "ln", {"pace": pace}, {"halves": halves}, (1,))


def order(d: Draw) -> Fault:
    """Losses or cooling that change over the running order: evenly, or fast at first."""
    names, tau = d.pick(("mesh",), ("mesh", "bearing", "seal"), ("conv", "rad")), d.pick(None, d.uniform(0.15, 0.5))

    def act(s: Scene, a: np.ndarray) -> None:
        factor = np.exp(a * (s.progress if tau is None else np.exp(-s.progress / tau)))
        for name in names:
            s.scale(name, factor)

    return _physics("procedure.order", 0.6, "ln", act, BOTH, names=names, tau=tau)


def day_scatter(d: Draw) -> Fault:
    """Cooling that differs from day to day more than stated."""
    days = d.per_test()

    def act(s: Scene, a: np.ndarray) -> None:
        for name in ("conv", "rad"):
            s.scale(name, np.exp(a * _at(days, s.order)))

    return _physics("procedure.day_scatter", 0.25, "ln", act)


# ---------------------------------------------------------------------------------------------- without a name


def thermostat_fan(d: Draw) -> Fault:
    """A fan that starts when the wall is warm, on some days only."""
    T_on, works = float(np.quantile(d.oil, d.uniform(0.3, 0.6))) - 3.0, d.rng.random(d.tests) < d.uniform(0.4, 0.7)

    def act(s: Scene, a: np.ndarray) -> None:
        s.scale("conv", np.exp(a * _at(works, s.order) * step(s.T["wall"], T_on, 1.5)))

    return _physics("outside.thermostat_fan", 1.3, "ln", act, T_on=T_on)


def swinging_seal(d: Draw) -> Fault:
    """A seal that rubs more and less from day to day, in waves."""
    periods, phase = d.uniform(1.5, 5.0), d.uniform(0.0, 6.28)

    def act(s: Scene, a: np.ndarray) -> None:
        torque = a * (1 + np.sin(phase + 2 * np.pi * periods * s.progress))
        s.brake(torque * s.w, {"oil": 0.3, "body": 0.4, "wall": 0.3})

    return _physics("outside.swinging_seal", 14.0, "N.m", act, periods=periods, phase=phase)


def resonance(d: Draw) -> Fault:
    """A vibration that eats power around one speed."""
    n_0, width = float(d.rng.choice(np.unique(np.round(d.n, -1)))) + d.uniform(-5.0, 5.0), d.uniform(8.0, 20.0)

    def act(s: Scene, a: np.ndarray) -> None:
        power = a * np.exp(-(((s.n - n_0) / width) ** 2)) * s.load / LOAD
        s.brake(power * s.running, {"wall": 0.7, "body": 0.3})

    return _physics("outside.resonance", 500.0, "W", act, n_0=n_0, width=width)


def misalignment(d: Draw) -> Fault:
    """Shafts that line up at one load and speed and rub away from it."""
    load_0, n_0 = (float(np.quantile(x, d.uniform(0.3, 0.7))) for x in (d.load, d.n))

    def act(s: Scene, a: np.ndarray) -> None:
        off = np.abs((s.load - load_0) / 600.0) + np.abs((s.n - n_0) / 80.0)
        s.brake(a * off * s.w, {"body": 0.6, "wall": 0.4})

    return _physics("outside.misalignment", 15.0, "N.m", act, load_0=load_0, n_0=n_0)


def hysteresis(d: Draw) -> Fault:
    """A transducer that remembers where its load came from: rising loads read low, falling ones high."""
    came, (column, scale) = np.sign(d.per_test()), d.pick(*KINDS["torque"][0])

    def read(shown: np.ndarray, plan: Plan, a: np.ndarray) -> None:
        x = np.clip(plan.load / 3000.0, 0.0, 1.0)
        shown[ROW[column]] += scale * a * _at(came, plan.order) * np.array([[1.0], [-0.6]]) * 4 * x * (1 - x)

    return _read("outside.hysteresis", 25.0, "N.m at the carrier", read, column=column)


def crosstalk(d: Draw) -> Fault:
    """The drive disturbs the oil sensor: more with speed times torque, and the other way in the other direction."""
    back = d.uniform(-1.0, -0.3)

    def read(shown: np.ndarray, plan: Plan, a: np.ndarray) -> None:
        power = plan.n * plan.load / (N * LOAD)
        shown[ROW["T_oil_C"]] += a * power**2 * np.array([[1.0], [back]])

    return _read("outside.crosstalk", 8.0, "K", read, back=back)


# ------------------------------------------------------------------------------------------------------- tables

CAUSES: Mapping[str, Family] = {
    "losses.churning": churning,
    "losses.oil_viscosity": oil_viscosity,
    "losses.oil_level": oil_level,
    "losses.bearing_preload": _rubbing("losses.bearing_preload", (0.0, 0.35), (-0.65, 0.45)),
    "losses.seal_drag": _rubbing("losses.seal_drag", (-0.3, 0.5), (-0.7, 0.0)),
    "losses.mesh_friction": mesh_friction,
    "losses.mesh_direction": mesh_direction,
    "losses.film_starvation": film_starvation,
    "losses.windage": windage,
    "heat.external_source": external_source,
    "cooling.air": _path("cooling.air", "conv", 1.2, BOTH, "rise", (-0.5, 0.5)),
    "cooling.emissivity": _path("cooling.emissivity", "rad", 2.0, BOTH, "surface", (-0.2, 0.2)),
    "cooling.foundation": _path("cooling.foundation", "foot", 1.8, BOTH, "rise", (-0.3, 0.3)),
    "cooling.contact": _path("cooling.contact", "contact", 4.0, (-1,), "surface", (-0.3, 0.3)),
    "cooling.oil_wall": _path("cooling.oil_wall", "oil_wall", 2.2, BOTH, "speed", (-0.5, 0.6)),
    "cooling.humidity": _path("cooling.humidity", "conv", 0.35, BOTH, "humidity", (-0.4, 0.4)),
    "thermal.mass": mass,
    "thermal.split": split,
    **dict(
        _added(kind, name, weigh)
        for kind, name, weigh in (
            ("torque", "offset", _constant),
            ("torque", "drift", _creep),
            ("torque", "step", _since),
            ("torque", "by_direction", _direction),
            ("torque", "random_walk", _walk),
            ("oil_temp", "offset", _constant),
            ("oil_temp", "since", _since),
            ("oil_temp", "by_direction", _direction),
            ("wall_temp", "offset", _constant),
            ("wall_temp", "since", _since),
            ("ambient", "bias", _constant),
            ("ambient", "since", _since),
        )
    ),
    **dict(
        (
            _gain("sensor.torque.gain", 0.015, ("T_carrier_Nm", "T_sun_Nm"), (0.0,)),
            _gain("sensor.oil_temp.gain", 0.15, ("T_oil_C",), (0.0, 20.0, 25.0)),
            _gain("sensor.speed.gain", 0.12, ("n_carrier_rpm",), (0.0,)),
        )
    ),
    "sensor.oil_temp.position": position,
    "sensor.ambient.heated": heated,
    "procedure.not_stationary": not_stationary,
    "procedure.order": order,
    "procedure.day_scatter": day_scatter,
}

OUTSIDE: Mapping[str, Family] = {
    f"outside.{f.__name__}": f for f in (thermostat_fan, swinging_seal, resonance, misalignment, hysteresis, crosstalk)
}

#: Causes that may act in a part of the conditions only -> what may limit them.
REGIMES: Mapping[str, tuple[str, ...]] = {
    "losses.churning": ("speed", "temperature"),
    "losses.windage": ("speed",),
    "losses.mesh_friction": ("speed", "load", "temperature"),
    "losses.seal_drag": ("speed", "temperature", "direction"),
    "losses.bearing_preload": ("load", "temperature", "direction"),
    "heat.external_source": ("speed", "load", "direction"),
    "cooling.air": ("temperature", "direction"),
}


def names(kind: str) -> Sequence[str]:
    """Causes that a kind of case may hide."""
    return list({"regime": REGIMES, "outside": OUTSIDE}.get(kind, CAUSES))


def draw(
    plan: Plan, inner: float, own: bool, cause: str, kind: str, oil: np.ndarray, rng: np.random.Generator
) -> Fault:
    """A fault of a cause in a form for a kind of case; oil: healthy oil temperatures."""
    d = Draw(rng, plan.n.ravel(), plan.load.ravel(), oil.ravel(), plan.tests, inner, own)
    fault = {**CAUSES, **OUTSIDE}[cause](d)
    return limited(fault, d) if kind == "regime" else fault


def limited(fault: Fault, d: Draw) -> Fault:
    """The same on one side of a threshold inside the campaign's range, or in one direction."""
    kind, side = d.pick(*REGIMES[fault.cause]), d.pick(*BOTH)
    spans = {"speed": (d.n, 2.0, 14.0), "load": (d.load, 20.0, 130.0), "temperature": (d.oil, 1.0, 4.0)}
    span, *widths = spans.get(kind, (np.array([1.0, 2.0]), 0.05, 0.06))
    at = 1.5 if kind == "direction" else float(np.quantile(span, d.uniform(0.28, 0.72)))
    width, stage = d.uniform(*widths), fault.stages["act"]

    def act(s: Scene, a: np.ndarray) -> None:
        x = {"speed": s.n, "load": s.load, "temperature": s.T["oil"], "direction": s.direction}[kind]
        stage(s, a * step(side * x, side * at, width))

    regime = {kind: "above" if side > 0 else "below", "threshold": at, "width": width}
    return replace(fault, stages={"act": act}, regime=regime)
