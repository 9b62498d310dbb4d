"""Bodies that store more or less heat than assumed."""

import math

from .cause import Cause, Size
from .forms import scaled

CAUSE = Cause(
    id="thermal.mass",
    doc="Other heat capacities: warm-ups last longer or shorter.",
    size=Size("ln_factor", "1", "logarithm of the factor on all heat capacities", 0.3, -1.0, 1.2),
    exposes="a logged warm-up",
    values=lambda base, theta, rows: scaled(
        base, math.exp(theta["ln_factor"]), "gears.C", "carrier_body.C", "wall.C", "surface.C"
    ),
)
