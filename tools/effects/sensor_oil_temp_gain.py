"""An oil probe whose gain is off."""

from .cause import Cause, Shape, Size
from .instruments import changed

CAUSE = Cause(
    id="sensor.oil_temp.gain",
    doc="Gain of the oil probe.",
    size=Size("gain", "1", "relative error of the reading against its fixed point", 0.03, -0.3, 0.3),
    shapes=(Shape("fixed", "K", "temperature at which it reads right", 273.15, 303.15),),
    exposes="all probes in one bath at two temperatures",
    readings=lambda theta, rows, r: changed(r, T_oil=r["T_oil"] + theta["gain"] * (r["T_oil"] - theta["fixed"])),
)
