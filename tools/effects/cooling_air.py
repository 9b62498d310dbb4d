"""Convection that is stronger or weaker than assumed."""

from ...model.machines.spec import PartSpec
from .cause import Cause, Shape, Size

CAUSE = Cause(
    id="cooling.air",
    doc="More or less convection: draught, a cover, a fan.",
    size=Size("G_ref", "W/K", "conductance to the air more than assumed, at 35 K", 2.5, -8.0, 20.0),
    shapes=(Shape("e", "1", "exponent of the temperature difference", -0.3, 0.4, 0.05, 0.2),),
    exposes="a fan switched on and off at one point; a cold room",
    parts=(PartSpec("extra_air", "ExtraConductor", {"G_ref": 0.0, "dT_ref": 35.0, "e": 0.0}),),
    connections=(("extra_air.a", "surface.heat"), ("extra_air.b", "room.floor")),
    values=lambda base, theta, rows: {"extra_air.G_ref": theta["G_ref"], "extra_air.e": theta["e"]},
)
