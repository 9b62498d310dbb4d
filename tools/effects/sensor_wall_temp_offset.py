"""A wall probe that reads too high or too low."""

from .cause import Cause, Size
from .instruments import changed

CAUSE = Cause(
    id="sensor.wall_temp.offset",
    doc="Offset of the wall probe.",
    size=Size("offset", "K", "reading less truth", 1.2, -15, 15),
    exposes="all probes in one bath; readings at rest in a room of constant temperature",
    readings=lambda theta, rows, r: changed(r, T_wall=r["T_wall"] + theta["offset"]),
)
