"""Forms that several causes share: an extra power with exponents and a regime, and the shapes of both."""

from __future__ import annotations

from collections.abc import Mapping

from ...model.machines.spec import PartSpec
from .cause import Shape, Theta

#: Reference point of all extra powers: 200 rpm, 75 cSt, 2000 N.m.
W_REF, NU_REF, TAU_REF = 20.944, 75e-6, 2000.0
#: No threshold: so far below everything that the side does not matter.
OPEN = {"w_on": -1e4, "w_side": 1.0, "tau_on": -1e6, "tau_side": 1.0, "T_on": 0.0, "T_side": 1.0}
#: Ranges in which thresholds are looked for: speed [rad/s], torque [N.m], temperature [K].
THRESHOLDS = {"w": (10.0, 26.5), "tau": (1500.0, 2750.0), "T": (315.0, 362.0), "d": (0.0, 0.0)}
#: Upper ends of the share of each regime in the prior; "d+" acts as multiplier only, "d-" as reducer only.
REGIMES = (
    *((0.56, ""), (0.66, "w+"), (0.71, "w-"), (0.77, "tau+"), (0.81, "tau-")),
    *((0.89, "T+"), (0.93, "T-"), (0.965, "d+"), (1.0, "d-")),
)

STRATA = tuple(end for end, _ in REGIMES)
REGIME = (
    Shape("regime", "1", "where it acts: everywhere, or above or below a threshold", 0.0, 1.0),
    Shape("threshold", "1", "place of the threshold in its range", 0.0, 1.0),
)
OIL_SHARE_TEETH = Shape("oil_share", "1", "share of the heat that goes into the oil", 0.0, 1.0, 0.8, 0.15)
OIL_SHARE_BEARING = Shape("oil_share", "1", "share of the heat that goes into the oil", 0.0, 1.0, 0.6, 0.25)


def regime_of(theta: Theta) -> tuple[str, float] | None:
    """The regime of a form: quantity with its side ("w+", "d-") and threshold in SI; None where it acts everywhere."""
    name = next(name for end, name in REGIMES if theta.get("regime", 0.0) <= end)
    if not name:
        return None
    low, high = THRESHOLDS[name[:-1]]
    return name, low + theta["threshold"] * (high - low)


def extra_part(
    name: str, body: str, *, braking: bool = True
) -> tuple[tuple[PartSpec, ...], tuple[tuple[str, ...], ...]]:
    """An extra loss on the carrier's shaft, or a heater that follows its speed, that heats the oil and a body."""
    values = {"braking": braking, "P_ref": 0.0, "w_ref": W_REF, "nu_ref": NU_REF, "tau_ref": TAU_REF}
    values |= {"a": 1.0, "b": 0.0, "c": 0.0, "forward": 1.0, "backward": 1.0, "oil_share": 0.5} | OPEN
    part = PartSpec(name, "ExtraLoss", values)
    nets = (
        (f"{name}.shaft", "carrier.flange"),
        (f"{name}.reading", "carrier.reading"),
        (f"{name}.body", f"{body}.heat"),
        (f"{name}.oil", "oil.heat"),
        (f"{name}.lubricant", "oil.lubricant"),
    )
    return (part,), nets


def extra_values(name: str, theta: Theta, **fixed: float) -> Mapping[str, float]:
    """Values of an extra part from the parameters of a form; `fixed` holds exponents that the form leaves alone."""
    keys = ("P_ref", "a", "b", "c", "forward", "backward", "oil_share")
    values = {k: v for k, v in {**fixed, **theta}.items() if k in keys} | OPEN
    if (regime := regime_of(theta)) is not None:
        quantity, threshold = regime
        if quantity in ("d+", "d-"):
            values["backward" if quantity == "d+" else "forward"] = 0.0
        else:
            values |= {
                f"{quantity[:-1]}_on": threshold,
                f"{quantity[:-1]}_side": 1.0 if quantity.endswith("+") else -1.0,
            }
    return {f"{name}.{k}": v for k, v in values.items()}


def extra_conductor(name: str, a: str, b: str) -> tuple[tuple[PartSpec, ...], tuple[tuple[str, ...], ...]]:
    """A conductance of general form between two heat ports."""
    values = {"G_ref": 0.0, "dT_ref": 35.0, "e": 0.0, "w_ref": W_REF, "c": 0.0, "T_on": 0.0, "T_side": 1.0}
    nets = ((f"{name}.a", a), (f"{name}.b", b), (f"{name}.reading", "carrier.reading"))
    return (PartSpec(name, "ExtraConductor", values),), nets


def scaled(base: Mapping[str, float], factor: float, *paths: str) -> Mapping[str, float]:
    """The given values times a factor."""
    return {path: base[path] * factor for path in paths}
