"""Causes that no data of this kind can separate: they count as one answer."""

from __future__ import annotations

from collections.abc import Iterable

#: The first name of a class stands for it.
CLASSES: tuple[tuple[str, ...], ...] = (
    ("losses.bearing_preload", "losses.seal_drag", "losses.bearing_friction", "losses.pair_preload"),
    ("losses.churning", "losses.windage", "losses.oil_level"),
    ("cooling.humidity", "procedure.day_scatter"),
    ("sensor.torque.step", "sensor.torque.since"),
    ("sensor.ambient.bias", "sensor.ambient.offset"),
    ("cooling.air", "cooling.fan"),
)
_NAME = {name: names[0] for names in CLASSES for name in names}


def class_of(cause: str) -> str:
    """The name that stands for the class of a cause."""
    return _NAME.get(cause, cause)


def classes_of(causes: Iterable[str]) -> frozenset[str]:
    """The names that stand for the classes of causes."""
    return frozenset(class_of(c) for c in causes)
