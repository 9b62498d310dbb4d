"""Faults of instruments and procedures of the textbook rig, and some without a name. FROZEN, see the package."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ..plan import Plan
from .rig import N0, Around, Family, Fault, Now, viscosity

CHANNEL: Mapping[str, int] = {"speed": 0, "carrier": 1, "sun": 2, "oil_temp": 3, "wall_temp": 4, "ambient": 5}
HIGH: Mapping[str, tuple[float, str]] = {
    "torque": (30.0, "N.m"),
    "oil_temp": (8.0, "K"),
    "wall_temp": (8.0, "K"),
    "ambient": (6.0, "K"),
}


def shift(name: str, kind: str, weight: Callable[[np.ndarray, Plan], Any], form: Mapping[str, Any]) -> Family:
    """An instrument whose error is an amount times a weight over readings (2, columns); torque: of one transducer."""

    def draw(rng: np.random.Generator, around: Around) -> Fault:
        which = str(rng.choice(["carrier", "sun"])) if kind == "torque" else kind
        row, scale = CHANNEL[which], 0.25 if which == "sun" else 1.0

        def read(shown: np.ndarray, plan: Plan, a: np.ndarray) -> None:
            shown[row] += scale * a * weight(shown, plan)

        high, unit = HIGH[kind]
        told = {**form, **({"transducer": which} if kind == "torque" else {})}
        return Fault(name, high, unit, {"read": read}, told, (1, -1))

    return draw


def since(name: str, kind: str) -> Family:
    """An error from a test on."""

    def draw(rng: np.random.Generator, around: Around) -> Fault:
        at = int(rng.integers(5, around.tests - 3))
        return shift(name, kind, lambda shown, plan: plan.order >= at, {"from": at})(rng, around)

    return draw


def by_direction(name: str, kind: str) -> Family:
    """An error in one direction only."""

    def draw(rng: np.random.Generator, around: Around) -> Fault:
        side = int(rng.integers(0, 2))
        only = np.array([[side == 0], [side == 1]]) * 1.0
        return shift(name, kind, lambda shown, plan: only, {"direction": side + 1})(rng, around)

    return draw


def walk(name: str, kind: str) -> Family:
    """A zero that walks from test to test."""

    def draw(rng: np.random.Generator, around: Around) -> Fault:
        path = np.cumsum(rng.normal(0.0, 1.0, around.tests)) / np.sqrt(around.tests / 2.0)
        path = path - path[0]
        told = {"path": [round(float(v), 3) for v in path]}
        return shift(name, kind, lambda shown, plan: path[plan.order.astype(int) - 1], told)(rng, around)

    return draw


def gain(name: str, row: str, about: float, high: float) -> Family:
    """A wrong gain of a channel about a value."""

    def draw(rng: np.random.Generator, around: Around) -> Fault:
        which = str(rng.choice(["carrier", "sun"])) if row == "torque" else row

        def read(shown: np.ndarray, plan: Plan, a: np.ndarray) -> None:
            shown[CHANNEL[which]] += a * (shown[CHANNEL[which]] - about)

        return Fault(name, high, "1", {"read": read}, {"channel": which}, (1, -1))

    return draw


def drift(rng: np.random.Generator, around: Around) -> Fault:
    """A zero that creeps over the campaign, straight or slower and slower."""
    p = float(rng.choice([1.0, 0.6, 1.5]))
    return shift("sensor.torque.drift", "torque", lambda shown, plan: plan.progress**p, {"p": p})(rng, around)


def position(rng: np.random.Generator, around: Around) -> Fault:
    """The oil's probe sits where stirring reaches less, the less the slower: it reads towards the wall."""
    c = rng.uniform(0.0, 0.8)

    def read(shown: np.ndarray, plan: Plan, a: np.ndarray) -> None:
        still = 1.0 - c * shown[0] / 300.0
        shown[3] += a * still * (0.6 * shown[4] + 0.4 * shown[5] - shown[3])

    return Fault("sensor.oil_temp.position", 0.7, "1", {"read": read}, {"c": c})


def heated(rng: np.random.Generator, around: Around) -> Fault:
    """The room's probe hangs in the warm air of the rig."""

    def read(shown: np.ndarray, plan: Plan, a: np.ndarray) -> None:
        shown[5] += a * (shown[4] - shown[5])

    return Fault("sensor.ambient.heated", 0.35, "1", {"read": read})


# --------------------------------------------------------------------------------------------------- procedure


def not_stationary(rng: np.random.Generator, around: Around) -> Fault:
    """Read too early: in both halves in proportion, or in the first only."""
    second = float(rng.choice([0.0, 0.375]))

    def pace(dwell: np.ndarray, a: np.ndarray) -> None:
        dwell[0] -= a
        dwell[1] -= second * a

    return Fault("procedure.not_stationary", 180.0, "min", {"pace": pace}, {"second": second})


def order(rng: np.random.Generator, around: Around) -> Fault:
    """Something ages over the campaign: flanks run in or wear, or dust settles."""
    if rng.random() < 0.5:

        def wear(now: Now, a: np.ndarray) -> None:
            now.P["mesh"] *= np.exp(a * now.progress)

        return Fault("procedure.order", 0.5, "ln", {"loss": wear}, {"what": "friction"}, (1, -1))

    def dust(now: Now, a: np.ndarray) -> None:
        now.G["air"] *= np.exp(-a * now.progress)

    return Fault("procedure.order", 0.8, "ln", {"cool": dust}, {"what": "cooling"}, (1, -1))


def day_scatter(rng: np.random.Generator, around: Around) -> Fault:
    """Doors and draughts: cooling differs from test to test."""
    z = rng.normal(0.0, 1.0, around.tests)

    def cool(now: Now, a: np.ndarray) -> None:
        here = z[np.rint(now.progress * (around.tests - 1)).astype(int)]
        for path in ("air", "radiation"):
            now.G[path] *= np.exp(a * here)

    return Fault("procedure.day_scatter", 0.35, "ln", {"cool": cool}, {"z": [round(float(v), 3) for v in z]})


def crosstalk(rng: np.random.Generator, around: Around) -> Fault:
    """The sun's transducer feels the square of the speed."""

    def read(shown: np.ndarray, plan: Plan, a: np.ndarray) -> None:
        shown[2] += a * (shown[0] / N0) ** 2

    return Fault("outside.crosstalk", 8.0, "N.m", {"read": read}, {}, (1, -1))


def thermal_zero(rng: np.random.Generator, around: Around) -> Fault:
    """The carrier transducer's zero moves with its temperature."""

    def read(shown: np.ndarray, plan: Plan, a: np.ndarray) -> None:
        shown[1] += a * (shown[4] - 45.0) / 20.0

    return Fault("outside.thermal_zero", 20.0, "N.m", {"read": read}, {}, (1, -1))


def leak(rng: np.random.Generator, around: Around) -> Fault:
    """Oil runs out over the campaign: less splash, worse contact of oil and bodies, drier teeth."""

    def loss(now: Now, a: np.ndarray) -> None:
        now.P["splash"] *= 1.0 - a * now.progress
        now.P["mesh"] *= 1.0 + 0.3 * a * now.progress**2

    def cool(now: Now, a: np.ndarray) -> None:
        for path in ("oil_wall", "oil_gears", "oil_carrier"):
            now.G[path] *= 1.0 - 0.7 * a * now.progress

    return Fault("outside.leak", 0.95, "1", {"loss": loss, "cool": cool})


def rub(rng: np.random.Generator, around: Around) -> Fault:
    """A part resonates and rubs in a narrow band of speed."""
    at = float(np.quantile(around.n, rng.uniform(0.3, 0.7)))

    def loss(now: Now, a: np.ndarray) -> None:
        now.lose(a * np.exp(-(((now.n - at) / 18.0) ** 2)), "carrier", "skin", 0.5)

    return Fault("outside.rub", 600.0, "W", {"loss": loss}, {"at": at})


def weather(rng: np.random.Generator, around: Around) -> Fault:
    """Sun through a window on some days."""
    phase, days = rng.uniform(0.0, 2 * np.pi), rng.uniform(0.25, 0.6)

    def loss(now: Now, a: np.ndarray) -> None:
        now.heat(a * np.maximum(np.sin(2 * np.pi * now.progress / days + phase), 0.0), "skin")

    return Fault("outside.weather", 500.0, "W", {"loss": loss}, {"phase": phase, "days": days})


def gelling(rng: np.random.Generator, around: Around) -> Fault:
    """Oil so stiff when cold that it hardly reaches wall and bearings: transfer falls as viscosity rises."""

    def cool(now: Now, a: np.ndarray) -> None:
        thick = now.nu / viscosity(np.asarray(50.0))
        now.G["oil_wall"] /= 1.0 + a * thick
        now.G["oil_carrier"] /= 1.0 + a * thick

    return Fault("outside.gelling", 3.0, "1", {"cool": cool})
