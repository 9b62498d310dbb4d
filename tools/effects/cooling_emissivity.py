"""A surface that radiates differently than assumed."""

from .cause import Cause, Size

CAUSE = Cause(
    id="cooling.emissivity",
    doc="Another emissivity: bare metal instead of paint, dust, a shiny cover.",
    size=Size("factor", "1", "relative change of the emissivity", 0.35, -0.95, 0.11),
    exposes="a cold room; a painted patch",
    values=lambda base, theta, rows: {"cooling.emissivity": base["cooling.emissivity"] * (1 + theta["factor"])},
)
