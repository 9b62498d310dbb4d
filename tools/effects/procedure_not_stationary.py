"""Readings taken before the end of the dwell."""

from .cause import Cause, Size
from .instruments import changed

CAUSE = Cause(
    id="procedure.not_stationary",
    doc="Readings taken earlier than the protocol says, or while the gearbox still warms.",
    size=Size("missing", "1", "share of the dwell that is missing", 0.15, 0.0, 0.7),
    exposes="a logged warm-up; a longer dwell",
    readings=lambda theta, rows, r: changed(
        r, **{k: r[k] - theta["missing"] * r[f"{k}_rate"] for k in ("T_oil", "T_wall", "loss")}
    ),
)
