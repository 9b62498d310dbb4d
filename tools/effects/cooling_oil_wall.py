"""Oil that gives its heat to the wall better or worse than assumed."""

import math

from .cause import Cause, Size

CAUSE = Cause(
    id="cooling.oil_wall",
    doc="Another conductance between oil and wall: level, foam, deposits.",
    size=Size("ln_factor", "1", "logarithm of the factor on the conductance", 0.5, -2.5, 1.5),
    exposes="transients; a second probe in the wall",
    values=lambda base, theta, rows: {"oil_wall.G": base["oil_wall.G"] * math.exp(theta["ln_factor"])},
)
