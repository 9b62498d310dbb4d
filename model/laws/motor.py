"""Electric motors: what their windings lose."""

from __future__ import annotations

from ..sources import law
from .smooth import Num

#: Change of the resistance of copper by temperature at 20 degC [1/K]: IEC60028, as the makers of drives print it.
ALPHA_CU = 0.00393
#: Temperature that the coefficient is for [K].
T_20 = 293.15


@law(source="IEC60028", where="temperature coefficient of copper at constant mass", ranges={"T": (233.15, 473.15)})
def winding_resistance(R_20: Num, T: Num) -> Num:
    r"""Resistance of a copper winding [ohm].

    .. math:: R = R_{20} \left(1 + 0.00393\,(T - 293.15)\right)

    Args:
        R_20: resistance at 20 degC [ohm]
        T: temperature of the winding [K]
    """
    return R_20 * (1 + ALPHA_CU * (T - T_20))
