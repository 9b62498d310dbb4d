"""An oil probe that reads too high or too low."""

from .cause import Cause, Size
from .instruments import changed

CAUSE = Cause(
    id="sensor.oil_temp.offset",
    doc="Offset of the oil probe.",
    size=Size("offset", "K", "reading less truth", 1.2, -15, 15),
    exposes="all probes in one bath; readings at rest in a room of constant temperature",
    readings=lambda theta, rows, r: changed(r, T_oil=r["T_oil"] + theta["offset"]),
)
