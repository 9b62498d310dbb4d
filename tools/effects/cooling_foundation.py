"""Feet and shafts that conduct more or less than assumed."""

from .cause import Cause, Shape, Size
from .forms import extra_conductor

PARTS, NETS = extra_conductor("extra_foot", "surface.heat", "room.floor")
CAUSE = Cause(
    id="cooling.foundation",
    doc="Another conductance of feet and shafts to the foundation.",
    size=Size("G_ref", "W/K", "conductance more than assumed, at 35 K", 2.5, -12.0, 20.0),
    shapes=(Shape("e", "1", "exponent of the temperature difference", -0.35, 0.35, 0.0, 0.15),),
    exposes="transients in a cold room; the temperature of the foundation",
    parts=PARTS,
    connections=NETS,
    values=lambda base, theta, rows: {f"extra_foot.{key}": theta[key] for key in ("G_ref", "e")},
)
