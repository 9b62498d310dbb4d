"""Air and oil mist moved by what turns."""

from .cause import Cause, Shape, Size
from .forms import SPEED, Regimes, extra_part, extra_values

PARTS, NETS = extra_part("extra_windage", "gears")
REGIMES = Regimes((*SPEED,))
CAUSE = Cause(
    id="losses.windage",
    doc="A loss without load, steep in speed and without viscosity: air and mist are moved.",
    size=Size("P_ref", "W", "loss at 200 rpm", 40.0, 0.0, 400.0),
    shapes=(
        Shape("a", "1", "exponent of the speed", 2.6, 3.4, 3.0, 0.2),
        Shape("oil_share", "1", "share of the heat that goes into the oil", 0.0, 1.0, 0.4, 0.25),
        *REGIMES.shapes,
    ),
    exposes="points at higher speed and little load, at two oil levels",
    like="no-load oil loss: churning, windage and oil level differ only in how the oil is reached",
    parts=PARTS,
    connections=NETS,
    acts=REGIMES.of,
    values=lambda base, theta, rows: extra_values("extra_windage", theta, REGIMES.of(theta)),
)
