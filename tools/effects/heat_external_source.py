"""Heat that comes from beside the gearbox."""

from .cause import Cause, Shape, Size
from .forms import DIRECTION, LOAD, SPEED, Regimes, extra_part, extra_values

PARTS, NETS = extra_part("extra_source", "surface", braking=False)
REGIMES = Regimes(
    (
        *SPEED,
        *LOAD,
        *DIRECTION,
    )
)
CAUSE = Cause(
    id="heat.external_source",
    doc="Heat from a motor, a neighbour or the sun: it warms, and no torque shows it.",
    size=Size("P_ref", "W", "heat flow rate at 200 rpm", 60.0, -150.0, 500.0),
    shapes=(
        Shape("a", "1", "exponent of the speed", 0.0, 1.8),
        Shape("oil_share", "1", "share of the heat that goes into the oil", 0.0, 0.5, 0.1, 0.1),
        *REGIMES.shapes,
    ),
    exposes="temperatures with the gearbox at rest and its neighbours running",
    parts=PARTS,
    connections=NETS,
    acts=REGIMES.of,
    values=lambda base, theta, rows: extra_values("extra_source", theta, REGIMES.of(theta)),
)
