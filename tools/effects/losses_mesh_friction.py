"""Teeth that rub more or less than assumed."""

from .cause import Cause, Shape, Size
from .forms import OIL_SHARE_TEETH, REGIME, STRATA, extra_part, extra_values, regime_of

PARTS, NETS = extra_part("extra_mesh", "gears")
CAUSE = Cause(
    id="losses.mesh_friction",
    doc="A loss that grows with load: friction of the teeth, roughness, additives.",
    size=Size("P_ref", "W", "loss at 200 rpm and 2000 N.m", 50.0, -150.0, 400.0),
    shapes=(
        Shape("a", "1", "exponent of the speed", 0.6, 1.2, 0.85, 0.12),
        Shape("b", "1", "exponent of the viscosity", -0.4, 0.1, -0.05, 0.1),
        Shape("c", "1", "exponent of the torque", 0.7, 1.8, 1.2, 0.25),
        OIL_SHARE_TEETH,
        *REGIME,
    ),
    exposes="points at small and at large load, at one speed",
    parts=PARTS,
    connections=NETS,
    acts=regime_of,
    strata=STRATA,
    values=lambda base, theta, rows: extra_values("extra_mesh", theta),
)
