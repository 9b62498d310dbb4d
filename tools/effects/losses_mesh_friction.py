"""Teeth that rub more or less than assumed."""

from .cause import Cause, Shape, Size
from .forms import LOAD, OIL_SHARE_TEETH, SPEED, WARMTH, Regimes, extra_part, extra_values

PARTS, NETS = extra_part("extra_mesh", "gears")
REGIMES = Regimes(
    (
        *SPEED,
        *LOAD,
        *WARMTH,
    )
)
CAUSE = Cause(
    id="losses.mesh_friction",
    doc="A loss that grows with load: friction of the teeth, roughness, additives.",
    size=Size("P_ref", "W", "loss at 200 rpm and 2000 N.m", 50.0, -150.0, 400.0),
    shapes=(
        Shape("a", "1", "exponent of the speed", 0.35, 1.25, 0.82, 0.18),
        Shape("b", "1", "exponent of the viscosity", -0.4, 0.1, -0.05, 0.1),
        Shape("c", "1", "exponent of the torque", 0.7, 2.1, 1.3, 0.35),
        OIL_SHARE_TEETH,
        *REGIMES.shapes,
    ),
    exposes="points at small and at large load, at one speed",
    parts=PARTS,
    connections=NETS,
    acts=REGIMES.of,
    values=lambda base, theta, rows: extra_values("extra_mesh", theta, REGIMES.of(theta)),
)
