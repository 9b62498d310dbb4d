"""Forms that several causes share: an extra power with exponents and a regime, and the shapes of both."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ...model.machines.spec import PartSpec
from .cause import Shape, Theta

#: Reference point of all extra powers: 200 rpm, 75 cSt, 2000 N.m.
W_REF, NU_REF, TAU_REF = 20.944, 75e-6, 2000.0
#: How gradually a form usually sets in at a threshold [rad/s, N.m, K].
USUAL = {"w": 0.5, "tau": 60.0, "T": 2.0}
#: No threshold: so far below everything that the side does not matter.
ANY_WARMTH = {"T_on": 0.0, "T_side": 1.0, "T_width": USUAL["T"]}
OPEN = {"w_on": -1e4, "w_side": 1.0, "w_width": USUAL["w"], "tau_on": -1e6, "tau_side": 1.0, "tau_width": USUAL["tau"]}
OPEN |= {"film_on": 1e6} | ANY_WARMTH
#: Ranges in which thresholds are looked for: speed [rad/s], torque [N.m], temperature [K], speed x viscosity [m2/s2].
THRESHOLDS = {"w": (10.0, 26.5), "tau": (1500.0, 2750.0), "T": (315.0, 362.0), "d": (0.0, 0.0), "film": (4e-4, 3e-3)}
#: Share of the prior in which a form acts everywhere.
EVERYWHERE = 0.56


@dataclass(frozen=True)
class Regimes:
    """Where a cause may be limited to: sides of a speed ("w+", "w-"), torque, temperature, or one direction.

    "d+" acts as multiplier only, "d-" as reducer only.
    """

    names: tuple[str, ...]

    @property
    def ends(self) -> tuple[float, ...]:
        """Upper ends of the shares of the prior: everywhere first, then each regime the same."""
        n = len(self.names)
        return (EVERYWHERE, *(EVERYWHERE + (1 - EVERYWHERE) * (k + 1) / n for k in range(n - 1)), 1.0)

    @property
    def shapes(self) -> tuple[Shape, ...]:
        """The shapes that say which regime, where its threshold lies in its range, and how gradually it sets in."""
        both = (
            Shape("regime", "1", "where it acts: everywhere, or above or below a threshold", 0.0, 1.0, ends=self.ends),
            Shape("threshold", "1", "place of the threshold in its range", 0.0, 1.0),
        )
        width = Shape("width", "1", "how gradually it sets in at the threshold, over the usual", 0.4, 3.0, 1.0, 0.75)
        return both if set(self.names) <= set(DIRECTION) else (*both, width)

    def of(self, theta: Theta) -> tuple[str, float] | None:
        """The regime of a form: its name and threshold in SI; None where it acts everywhere."""
        name = next(name for end, name in zip(self.ends, ("", *self.names), strict=True) if theta["regime"] <= end)
        if not name:
            return None
        low, high = THRESHOLDS[name[:-1]]
        return name, low + theta["threshold"] * (high - low)


SPEED, LOAD, WARMTH, DIRECTION = ("w+", "w-"), ("tau+", "tau-"), ("T+", "T-"), ("d+", "d-")
#: Capacities of what turns, and of the housing.
INSIDE, OUTSIDE = ("gears.C", "carrier_body.C"), ("wall.C", "surface.C")
OIL_SHARE_TEETH = Shape("oil_share", "1", "share of the heat that goes into the oil", 0.0, 1.0, 0.8, 0.15)
OIL_SHARE_BEARING = Shape("oil_share", "1", "share of the heat that goes into the oil", 0.0, 1.0, 0.6, 0.25)


def extra_part(
    name: str, body: str, part: str = "ExtraLoss"
) -> tuple[tuple[PartSpec, ...], tuple[tuple[str, ...], ...]]:
    """An extra loss on the carrier's shaft, or another part that follows its speed, that heats the oil and a body."""
    values = {"P_ref": 0.0, "w_ref": W_REF, "nu_ref": NU_REF, "tau_ref": TAU_REF}
    values |= {"a": 1.0, "b": 0.0, "c": 0.0, "forward": 1.0, "backward": 1.0, "oil_share": 0.5} | OPEN
    nets = (
        (f"{name}.shaft", "carrier.flange"),
        (f"{name}.reading", "carrier.reading"),
        (f"{name}.body", f"{body}.heat"),
        (f"{name}.oil", "oil.heat"),
        (f"{name}.lubricant", "oil.lubricant"),
    )
    return (PartSpec(name, part, values),), nets


def extra_values(name: str, theta: Theta, regime: tuple[str, float] | None = None) -> Mapping[str, float]:
    """Values of an extra part from the parameters of a form and the regime in which it acts."""
    keys = ("P_ref", "a", "b", "c", "forward", "backward", "oil_share", "wall_share", "inside_share")
    values = {k: v for k, v in theta.items() if k in keys} | OPEN | limits(theta, regime)
    return {f"{name}.{k}": v for k, v in values.items()}


def limits(theta: Theta, regime: tuple[str, float] | None) -> dict[str, float]:
    """Values of an extra part, by key, that limit it to a regime; none where it acts everywhere."""
    if regime is None:
        return {}
    quantity, threshold = regime
    if quantity in DIRECTION:
        return {"backward" if quantity == "d+" else "forward": 0.0}
    what = quantity[:-1]
    if what not in USUAL:  # thin films have one side and one width
        return {f"{what}_on": threshold}
    width = USUAL[what] * theta.get("width", 1.0)
    return {f"{what}_on": threshold, f"{what}_side": 1.0 if quantity[-1] == "+" else -1.0, f"{what}_width": width}


def extra_conductor(name: str, a: str, b: str) -> tuple[tuple[PartSpec, ...], tuple[tuple[str, ...], ...]]:
    """A conductance of general form between two heat ports."""
    values = {"G_ref": 0.0, "dT_ref": 35.0, "e": 0.0, "w_ref": W_REF, "c": 0.0}
    values |= {"forward": 1.0, "backward": 1.0} | ANY_WARMTH
    nets = ((f"{name}.a", a), (f"{name}.b", b), (f"{name}.reading", "carrier.reading"))
    return (PartSpec(name, "ExtraConductor", values),), nets


def scaled(base: Mapping[str, float], factor: float, *paths: str) -> Mapping[str, float]:
    """The given values times a factor."""
    return {path: base[path] * factor for path in paths}
