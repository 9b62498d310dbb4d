"""Hidden effects, written without the library of causes: changed parameters, own laws of loss, wrong probes."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

#: Columns of a result by path (n,), and of the rows: "order" 0 ... 1, "direction" 1 or 2.
Columns = Mapping[str, np.ndarray]


@dataclass(frozen=True)
class Effect:
    """One thing that is wrong.

    Args:
        cause: its identifier in the taxonomy
        what: what is done, in words
        factors: parameter (path pattern) -> factor on it
        added: parameter (path pattern) -> what is added to it
        brake: power that a loss takes from the shafts [W], by what the model shows (n,)
        heat: node -> heat flow rate into it [W] (n,), those of the loss among them
        shown: sensor -> what it shows instead of the truth [SI] (n,), by the true readings and the columns
        pace: share of each stated dwell that takes place
    """

    cause: str
    what: str
    factors: Mapping[str, float] = field(default_factory=dict)
    added: Mapping[str, float] = field(default_factory=dict)
    brake: Callable[[Columns], np.ndarray] | None = None
    heat: Callable[[Columns], Mapping[str, np.ndarray]] | None = None
    shown: Callable[[Columns, Columns], Mapping[str, np.ndarray]] | None = None
    pace: tuple[float, ...] = ()


def factors(cause: str, what: str, **by: float) -> Effect:
    """Parameters multiplied; "__" stands for a dot, a leading "_" for "any part that ends so"."""
    return Effect(cause, what, {_pattern(key): value for key, value in by.items()})


def _pattern(key: str) -> str:
    return ("*" if key.startswith("_") else "") + key.replace("__", ".")


def churned(w: str, watts: float, w_ref: float, n: float, heat: Mapping[str, float]) -> Effect:
    """Oil that is churned: by a power of the speed and a weak one of the viscosity."""

    def power(c: Columns) -> np.ndarray:
        return np.asarray(watts * (np.abs(c[w]) / w_ref) ** n * (c["oil.nu"] / 1e-4) ** 0.15)

    return _lossy("losses.churning", f"{watts:g} W more at {w_ref:.4g} rad/s, speed to {n:g}", power, heat)


def dragged(w: str, torque: float, heat: Mapping[str, float]) -> Effect:
    """Seal lips that rub more, less so when warm."""

    def power(c: Columns) -> np.ndarray:
        return np.asarray(torque * np.exp(-(c["oil.T"] - 320.0) / 80.0) * np.abs(c[w]))

    return _lossy("losses.seal_drag", f"{torque:g} N.m more at {w}, less when warm", power, heat)


def _lossy(cause: str, what: str, power: Callable[[Columns], np.ndarray], heat: Mapping[str, float]) -> Effect:
    return Effect(cause, what, brake=power, heat=lambda c: {node: share * power(c) for node, share in heat.items()})


def heated(watts: float, heat: Mapping[str, float]) -> Effect:
    """A neighbour that radiates onto the housing."""
    name = f"{watts:g} W from a neighbour"
    return Effect(
        "heat.external_source",
        name,
        heat=lambda c: {node: np.full(len(c["oil.T"]), share * watts) for node, share in heat.items()},
    )


def cooled(cause: str, what: str, node: str, G: float, n: float) -> Effect:
    """Heat that leaves a node to the room by a power of the difference: G [W/K] at 20 K; negative for less cooling."""

    def heat(c: Columns) -> Mapping[str, np.ndarray]:
        dT = c[f"{node}.T"] - c["room.T"]
        return {node: -G * dT * (np.maximum(np.abs(dT), 0.1) / 20.0) ** n}

    return Effect(cause, what, heat=heat)


def offset(cause: str, sensor: str, by: float) -> Effect:
    """A probe or transducer that is off by a constant [SI]."""
    return Effect(cause, f"{sensor} {by:+g}", shown=lambda r, c: {sensor: r[sensor] + by})


def gain(cause: str, sensor: str, by: float) -> Effect:
    """A transducer that shows a share more."""
    return Effect(cause, f"{sensor} x {1 + by:g}", shown=lambda r, c: {sensor: r[sensor] * (1 + by)})


def stepped(cause: str, sensor: str, by: float, since: float) -> Effect:
    """A probe that is off from a test on."""
    return Effect(
        cause,
        f"{sensor} {by:+g} since {since:g} of the campaign",
        shown=lambda r, c: {sensor: r[sensor] + by * (c["order"] >= since)},
    )


def warmed(room: str, oil: str, share: float) -> Effect:
    """A probe of the room that the machine heats."""
    return Effect(
        "sensor.ambient.heated",
        f"{room} {100 * share:g} % of the way to the oil",
        shown=lambda r, c: {room: r[room] + share * (r[oil] - r[room])},
    )
