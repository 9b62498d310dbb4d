"""An oil probe that stands where the oil is not well mixed."""

from .cause import Cause, Shape, Size
from .instruments import changed

CAUSE = Cause(
    id="sensor.oil_temp.position",
    doc="The oil probe sees oil between the sump's and the wall's or the room's temperature, or a jet from the gears.",
    size=Size("share", "1", "share of the excess over the other place that the probe loses", 0.08, -0.6, 0.6),
    shapes=(
        Shape("to_room", "1", "whether the other place is the room (1) or the wall (0)", 0.0, 1.0),
        Shape("a", "1", "exponent of the speed", -1.0, 1.0, 0.0, 0.4),
    ),
    exposes="a second probe in the oil; the probe moved",
    readings=lambda theta, rows, r: changed(
        r,
        T_oil=r["T_oil"]
        - theta["share"]
        * (rows.w / 20.0) ** theta["a"]
        * (r["T_oil"] - (rows.T_room if theta["to_room"] > 0.5 else r["T_wall"])),
    ),
)
