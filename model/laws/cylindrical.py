"""Load variables of cylindrical roller bearings, numbers for millimetres and newtons as in `rolling`."""

from __future__ import annotations

from ..sources import law
from .smooth import F_WIDTH, Num, smooth_magnitude, smooth_power


@law(source="SKF2018", where="friction, Table 1a, cylindrical roller bearings", verified=False)
def crb_rolling_variable(F_r: Num, d_m: Num, R_1: Num) -> Num:
    r"""Rolling variable of a cylindrical roller bearing, in the catalogue's units.

    .. math:: G_{rr} = R_1 d_m^{2.41} F_r^{0.31}

    Args:
        F_r: radial load [N]
        d_m: mean diameter, (d + D)/2 [m]
        R_1: rolling constant of the catalogue [1]
    """
    d_mm = 1e3 * d_m
    return R_1 * d_mm**2.41 * smooth_power(F_r, 0.31, F_WIDTH)


@law(source="SKF2018", where="friction, Table 1a, cylindrical roller bearings", verified=False)
def crb_sliding_variable(F_r: Num, F_a: Num, d_m: Num, S_1: Num, S_2: Num) -> Num:
    r"""Sliding variable of a cylindrical roller bearing, in the catalogue's units.

    .. math:: G_{sl} = S_1 d_m^{0.9} F_a + S_2 d_m F_r

    Args:
        F_r: radial load [N]
        F_a: axial load on the flanges, either direction [N]
        d_m: mean diameter, (d + D)/2 [m]
        S_1: first sliding constant of the catalogue [1]
        S_2: second sliding constant of the catalogue [1]
    """
    d_mm = 1e3 * d_m
    return S_1 * d_mm**0.9 * smooth_magnitude(F_a, F_WIDTH) + S_2 * d_mm * smooth_magnitude(F_r, F_WIDTH)
