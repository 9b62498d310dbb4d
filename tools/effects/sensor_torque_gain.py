"""A torque transducer whose gain is off."""

from .cause import Cause, Size
from .instruments import changed

CAUSE = Cause(
    id="sensor.torque.gain",
    doc="Gain of one torque transducer against the other.",
    size=Size("gain", "1", "relative error of the carrier's torque", 0.003, -0.03, 0.03),
    exposes="a calibration with a lever arm; points at small load",
    readings=lambda theta, rows, r: changed(r, loss=r["loss"] + theta["gain"] * rows.tau * rows.direction),
)
