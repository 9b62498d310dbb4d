"""Heat that comes from beside the gearbox."""

from dataclasses import replace

from .cause import Cause, Shape, Size
from .forms import DIRECTION, LOAD, SPEED, Regimes, extra_part, extra_values

(HEATER,), NETS = extra_part("extra_source", "surface", "ExtraHeat")
PARTS = (replace(HEATER, values={**HEATER.values, "wall_share": 0.0, "inside_share": 0.0}),)
NETS += (("extra_source.wall", "wall.heat"), ("extra_source.inside", "gears.heat"))
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
        Shape("wall_share", "1", "share that the wall has of the rest", 0.0, 1.0, 0.35, 0.35),
        Shape(
            "inside_share",
            "1",
            "share of what is left that enters by the shaft, not at the surface",
            0.0,
            1.0,
            0.0,
            0.4,
        ),
        *REGIMES.shapes,
    ),
    exposes="temperatures with the gearbox at rest and its neighbours running",
    parts=PARTS,
    connections=NETS,
    acts=REGIMES.of,
    values=lambda base, theta, rows: extra_values("extra_source", theta, REGIMES.of(theta)),
)
