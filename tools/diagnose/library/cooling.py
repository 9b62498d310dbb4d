"""Cooling that differs from the model's: at surfaces, through feet, between oil and bodies, by coolers and fans."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..campaign.table import Sensor
from .cause import Cause, Ranges, Shape, Size
from .forms import Extras, regimes
from .roles import Roles

AIR = "moving air: more air and a better coefficient are one answer"


def causes(roles: Roles, ranges: Ranges, sensors: Sequence[Sensor]) -> Iterator[Cause]:
    """All causes of the family that the machine's parts allow.

    Args:
        roles: of the machine
        ranges: of the data
        sensors: of the campaign
    """
    both = any(s.signs[0] != s.signs[1] for s in sensors) or ranges.varies("direction")
    if roles.surfaces:
        yield air(roles, ranges, both)


def conductance(ranges: Ranges, doc: str, sd: float, low: float, high: float) -> Size:
    """A conductance [W/K] at the typical temperature difference.

    Args:
        ranges: of the data
        doc: in words
        sd, low, high: in shares of the typical conductance from oil to room
    """
    G = ranges.conductance
    return Size("G_ref", "W/K", doc, sd * G, low * G, high * G)


def air(roles: Roles, ranges: Ranges, both: bool) -> Cause:
    """More or less convection."""
    shapes = (
        Shape("e", "1", "exponent of the temperature difference", -0.5, 0.5, 0.05, 0.2),
        Shape("c", "1", "exponent of the speed: a fan on the shaft", -0.2, 1.0, 0.0, 0.2),
    )
    ports = [f"{name}.surface" for name in roles.surfaces]
    return Cause(
        id="cooling.air",
        doc="More or less convection: draught, a cover, a fan.",
        size=conductance(ranges, "conductance to the air more than assumed", 0.14, -0.45, 1.15),
        forms=Extras("air", roles, ranges).conductors(ports, shapes, regimes(("T", "direction"), ranges, both)),
        exposes="a fan switched on and off at one point; a cold room",
        like=AIR,
        acts_on="rise",
    )
