"""An oil probe that stands where the oil is not well mixed."""

from __future__ import annotations

from .cause import Cause, Readings, Rows, Shape, Size, Theta
from .instruments import changed

#: Upper ends of the shares of the prior: the room draws on the probe, or the wall; a wall does so this much more.
ENDS, WALL = (0.6, 1.0), 3.0


def readings(theta: Theta, rows: Rows, r: Readings) -> Readings:
    """The probe loses a share of its excess over the other place."""
    to_room = theta["place"] <= ENDS[0]
    share = theta["share"] * (1.0 if to_room else WALL) * (rows.w / 20.0) ** theta["a"]
    return changed(r, T_oil=r["T_oil"] - share * (r["T_oil"] - (rows.T_room if to_room else r["T_wall"])))


CAUSE = Cause(
    id="sensor.oil_temp.position",
    doc="The oil probe sees oil between the sump's and the wall's or the room's temperature, or a jet from the gears.",
    size=Size(
        "share",
        "1",
        "share of the excess over the room that the probe loses; of that over the wall a third",
        0.08,
        -0.05,
        0.35,
    ),
    shapes=(
        Shape("place", "1", "which other place: the room, or the wall", 0.0, 1.0, ends=ENDS),
        Shape("a", "1", "exponent of the speed", -1.0, 1.0, 0.0, 0.2),
    ),
    exposes="a second probe in the oil; the probe moved",
    readings=readings,
)
