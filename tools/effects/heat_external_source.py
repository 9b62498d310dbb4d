"""Heat that comes from beside the gearbox."""

from .cause import Cause, Shape, Size
from .forms import REGIME, STRATA, extra_part, extra_values, regime_of

PARTS, NETS = extra_part("extra_source", "surface", braking=False)
CAUSE = Cause(
    id="heat.external_source",
    doc="Heat from a motor, a neighbour or the sun: it warms, and no torque shows it.",
    size=Size("P_ref", "W", "heat flow rate at 200 rpm", 60.0, -150.0, 500.0),
    shapes=(
        Shape("a", "1", "exponent of the speed", 0.0, 1.8),
        Shape("oil_share", "1", "share of the heat that goes into the oil", 0.0, 0.5, 0.1, 0.1),
        *REGIME,
    ),
    exposes="temperatures with the gearbox at rest and its neighbours running",
    parts=PARTS,
    connections=NETS,
    acts=regime_of,
    strata=STRATA,
    values=lambda base, theta, rows: extra_values("extra_source", theta),
)
