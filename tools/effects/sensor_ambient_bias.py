"""A room probe that reads too high or too low."""

from .cause import Cause, Size

CAUSE = Cause(
    id="sensor.ambient.bias",
    doc="Offset of the room probe: the gearbox stands in a room warmer or colder than read.",
    size=Size("bias", "K", "reading less truth", 1.5, -15, 15),
    exposes="transients from cold; the room probe beside another; points at higher speed",
    values=lambda base, theta, rows: {"read.room_bias": theta["bias"]},
)
