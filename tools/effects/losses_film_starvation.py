"""Teeth whose film breaks down where it is hot or fast."""

from .cause import Cause, Shape, Size, Theta
from .forms import OIL_SHARE_TEETH, extra_part, extra_values, regime_of

PARTS, NETS = extra_part("extra_starvation", "gears")


def onset(theta: Theta) -> Theta:
    """The form with its regime as one of the two that thin films know."""
    return {**theta, "regime": 0.6 if theta["regime"] < 0.725 else 0.85}


CAUSE = Cause(
    id="losses.film_starvation",
    doc="A loss under load that sets in with thin films: above a temperature or a speed.",
    size=Size("P_ref", "W", "loss at 200 rpm, 75 cSt and 2000 N.m, where it acts", 60.0, 0.0, 600.0),
    shapes=(
        Shape("a", "1", "exponent of the speed", 0.6, 1.6, 1.0, 0.2),
        Shape("b", "1", "exponent of the viscosity", -1.2, -0.2, -0.6, 0.25),
        Shape("c", "1", "exponent of the torque", 0.7, 1.5, 1.1, 0.2),
        OIL_SHARE_TEETH,
        Shape("regime", "1", "above a speed (0.6), or above a temperature (0.85)", 0.56, 0.89),
        Shape("threshold", "1", "place of the threshold in its range", 0.0, 1.0),
    ),
    exposes="points at high load and low viscosity, with and without fresh oil",
    parts=PARTS,
    connections=NETS,
    acts=lambda theta: regime_of(onset(theta)),
    values=lambda base, theta, rows: extra_values("extra_starvation", onset(theta)),
)
