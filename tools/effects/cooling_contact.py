"""A resistance between the wall and the outer surface."""

from .cause import Cause, Size

CAUSE = Cause(
    id="cooling.contact",
    doc="A gap or gasket between wall and outer surface.",
    size=Size("R", "K/W", "resistance more than assumed", 0.006, -0.0004, 0.08),
    exposes="transients; a second probe on the outer surface",
    values=lambda base, theta, rows: {
        "wall_surface.G": base["wall_surface.G"] / (1 + theta["R"] * base["wall_surface.G"])
    },
)
