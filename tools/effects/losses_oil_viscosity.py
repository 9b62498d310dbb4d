"""Another viscosity than the data sheet's: wrong oil, ageing, dilution."""

import math

from .cause import Cause, Shape, Size

CAUSE = Cause(
    id="losses.oil_viscosity",
    doc="The oil is thicker or thinner than assumed; it acts on all that the oil lubricates.",
    size=Size("ln_factor", "1", "logarithm of the factor on the viscosity", 0.4, -1.6, 1.6),
    shapes=(Shape("slope", "1", "difference of that logarithm between 100 and 40 degC", -0.9, 0.9, 0.0, 0.4),),
    exposes="a viscosity measurement of a sample; a warm-up from cold",
    values=lambda base, theta, rows: {
        "oil.nu_40": base["oil.nu_40"] * math.exp(theta["ln_factor"] * (1 - theta["slope"] / 2)),
        "oil.nu_100": base["oil.nu_100"] * math.exp(theta["ln_factor"] * (1 + theta["slope"] / 2)),
    },
)
