"""Load variables of angular contact, spherical roller and thrust bearings, numbers for mm and N as in `rolling`."""

from __future__ import annotations

from ..sources import law
from .smooth import F_WIDTH, Num, smooth_abs, smooth_cap, smooth_magnitude, smooth_power, to_rpm

#: How sharply the smaller of two variables counts: 3 % less than it where they are equal.
SHARPNESS = 24.0


def _centrifugal(w: Num, d_mm: Num, factor: Num) -> Num:
    """Load of the balls on the outer ring [N]."""
    return factor * d_mm**4 * to_rpm(w) ** 2


@law(source="SKF2018", where="friction, Table 1a, angular contact ball bearings", verified=False)
def acb_rolling_variable(F_r: Num, F_a: Num, w: Num, d_m: Num, R_1: Num, R_2: Num, R_3: Num) -> Num:
    r"""Rolling variable of an angular contact ball bearing, in the catalogue's units.

    .. math:: G_{rr} = R_1 d_m^{1.97} (F_r + F_g + R_2 F_a)^{0.54},\quad F_g = R_3 d_m^4 n^2

    Args:
        F_r: radial load [N]
        F_a: axial load, either direction [N]
        w: speed of the inner ring, either direction [rad/s]
        d_m: mean diameter, (d + D)/2 [m]
        R_1: first rolling constant of the catalogue [1]
        R_2: second rolling constant of the catalogue [1]
        R_3: third rolling constant of the catalogue, of the balls' own load [1]
    """
    d_mm = 1e3 * d_m
    load = smooth_magnitude(F_r, F_WIDTH) + _centrifugal(w, d_mm, R_3) + R_2 * smooth_magnitude(F_a, F_WIDTH)
    return R_1 * d_mm**1.97 * smooth_power(load, 0.54, F_WIDTH)


@law(source="SKF2018", where="friction, Table 1a, angular contact ball bearings", verified=False)
def acb_sliding_variable(F_r: Num, F_a: Num, w: Num, d_m: Num, S_1: Num, S_2: Num, S_3: Num) -> Num:
    r"""Sliding variable of an angular contact ball bearing, in the catalogue's units.

    .. math:: G_{sl} = S_1 d_m^{0.26} \left((F_r + F_g)^{4/3} + S_2 F_a^{4/3}\right),\quad F_g = S_3 d_m^4 n^2

    Args:
        F_r: radial load [N]
        F_a: axial load, either direction [N]
        w: speed of the inner ring, either direction [rad/s]
        d_m: mean diameter, (d + D)/2 [m]
        S_1: first sliding constant of the catalogue [1]
        S_2: second sliding constant of the catalogue [1]
        S_3: third sliding constant of the catalogue, of the balls' own load [1]
    """
    d_mm = 1e3 * d_m
    radial = smooth_magnitude(F_r, F_WIDTH) + _centrifugal(w, d_mm, S_3)
    return S_1 * d_mm**0.26 * (smooth_power(radial, 4 / 3, F_WIDTH) + S_2 * smooth_power(F_a, 4 / 3, F_WIDTH))


@law(source="SKF2018", where="friction, Table 1a, spherical roller bearings", verified=False)
def srb_rolling_variable(F_r: Num, F_a: Num, d_m: Num, R_1: Num, R_2: Num, R_3: Num, R_4: Num) -> Num:
    r"""Rolling variable of a spherical roller bearing, in the catalogue's units.

    .. math:: G_{rr} = \min\left(R_1 d_m^{1.85} (F_r + R_2 F_a)^{0.54}, R_3 d_m^{2.3} (F_r + R_4 F_a)^{0.31}\right)

    Args:
        F_r: radial load [N]
        F_a: axial load, either direction [N]
        d_m: mean diameter, (d + D)/2 [m]
        R_1: rolling constant of the catalogue, elliptic contact [1]
        R_2: its factor of the axial load [1]
        R_3: rolling constant of the catalogue, line contact [1]
        R_4: its factor of the axial load [1]
    """
    d_mm, F, F_axial = 1e3 * d_m, smooth_magnitude(F_r, F_WIDTH), smooth_magnitude(F_a, F_WIDTH)
    elliptic, line = F + R_2 * F_axial, F + R_4 * F_axial
    ratio = R_1 / R_3 * d_mm**-0.45 * smooth_abs(elliptic, F_WIDTH) ** 0.54 / smooth_abs(line, F_WIDTH) ** 0.31
    return R_1 * d_mm**1.85 * smooth_power(elliptic, 0.54, F_WIDTH) * smooth_cap(ratio, 1.0, SHARPNESS) / ratio


@law(source="SKF2018", where="friction, Table 1a, spherical roller bearings", verified=False)
def srb_sliding_variable(F_r: Num, F_a: Num, d_m: Num, S_1: Num, S_2: Num, S_3: Num, S_4: Num) -> Num:
    r"""Sliding variable of a spherical roller bearing, in the catalogue's units.

    .. math:: G_{sl} = \min\left(S_1 d_m^{0.25} (F_r^4 + S_2 F_a^4)^{1/3},
        S_3 d_m^{0.94} (F_r^3 + S_4 F_a^3)^{1/3}\right)

    Args:
        F_r: radial load [N]
        F_a: axial load, either direction [N]
        d_m: mean diameter, (d + D)/2 [m]
        S_1: sliding constant of the catalogue, elliptic contact [1]
        S_2: its factor of the axial load [1]
        S_3: sliding constant of the catalogue, line contact [1]
        S_4: its factor of the axial load [1]
    """
    d_mm, F, F_axial = 1e3 * d_m, smooth_magnitude(F_r, F_WIDTH), smooth_magnitude(F_a, F_WIDTH)
    elliptic = S_1 * d_mm**0.25 * (F**4 + S_2 * F_axial**4 + F_WIDTH**4) ** (1 / 3)
    line = S_3 * d_mm**0.94 * (F**3 + S_4 * F_axial**3 + F_WIDTH**3) ** (1 / 3)
    loaded = (F + F_axial) ** 2 / ((F + F_axial) ** 2 + F_WIDTH**2)  # 0 without load
    return loaded * smooth_cap(elliptic / line, 1.0, SHARPNESS) * line


@law(source="SKF2018", where="friction, Table 1b, thrust ball bearings", verified=False)
def thrust_ball_rolling_variable(F_a: Num, d_m: Num, R_1: Num) -> Num:
    r"""Rolling variable of a thrust ball bearing, in the catalogue's units.

    .. math:: G_{rr} = R_1 d_m^{1.83} F_a^{0.54}

    Args:
        F_a: axial load [N]
        d_m: mean diameter, (d + D)/2 [m]
        R_1: rolling constant of the catalogue [1]
    """
    d_mm = 1e3 * d_m
    return R_1 * d_mm**1.83 * smooth_power(F_a, 0.54, F_WIDTH)


@law(source="SKF2018", where="friction, Table 1b, thrust ball bearings", verified=False)
def thrust_ball_sliding_variable(F_a: Num, d_m: Num, S_1: Num) -> Num:
    r"""Sliding variable of a thrust ball bearing, in the catalogue's units.

    .. math:: G_{sl} = S_1 d_m^{0.05} F_a^{4/3}

    Args:
        F_a: axial load [N]
        d_m: mean diameter, (d + D)/2 [m]
        S_1: sliding constant of the catalogue [1]
    """
    d_mm = 1e3 * d_m
    return S_1 * d_mm**0.05 * smooth_power(F_a, 4 / 3, F_WIDTH)


@law(source="SKF2018", where="friction, Table 1b, cylindrical roller thrust bearings", verified=False)
def thrust_roller_rolling_variable(F_a: Num, d_m: Num, R_1: Num) -> Num:
    r"""Rolling variable of a cylindrical roller thrust bearing, in the catalogue's units.

    .. math:: G_{rr} = R_1 d_m^{2.38} F_a^{0.31}

    Args:
        F_a: axial load [N]
        d_m: mean diameter, (d + D)/2 [m]
        R_1: rolling constant of the catalogue [1]
    """
    d_mm = 1e3 * d_m
    return R_1 * d_mm**2.38 * smooth_power(F_a, 0.31, F_WIDTH)


@law(source="SKF2018", where="friction, Table 1b, cylindrical roller thrust bearings", verified=False)
def thrust_roller_sliding_variable(F_a: Num, d_m: Num, S_1: Num) -> Num:
    r"""Sliding variable of a cylindrical roller thrust bearing, in the catalogue's units.

    .. math:: G_{sl} = S_1 d_m^{0.62} F_a

    Args:
        F_a: axial load [N]
        d_m: mean diameter, (d + D)/2 [m]
        S_1: sliding constant of the catalogue [1]
    """
    d_mm = 1e3 * d_m
    return S_1 * d_mm**0.62 * smooth_magnitude(F_a, F_WIDTH)


@law(
    source="SKF2018",
    where="deep groove and angular contact ball bearings, requisite minimum load",
    valid="written down from memory of the catalogue, not compared with it",
    verified=False,
)
def minimum_ball_load(w: Num, nu: Num, d_m: Num, k_r: Num) -> Num:
    r"""Radial load below which the maker lets no ball bearing run, as its balls would slide [N].

    .. math:: F_{rm} = k_r \left(\frac{\nu n}{1000}\right)^{2/3} \left(\frac{d_m}{100}\right)^2\;[\mathrm{kN}]

    Args:
        w: speed of one ring against the other, either direction [rad/s]
        nu: kinematic viscosity at the lubricant's temperature [m2/s]
        d_m: mean diameter, (d + D)/2 [m]
        k_r: minimum load factor of the catalogue, 0.02 to 0.03 [1]
    """
    n, nu_cSt, d_mm = to_rpm(smooth_abs(w)), 1e6 * nu, 1e3 * d_m
    return 1e3 * k_r * (nu_cSt * n / 1000) ** (2 / 3) * (d_mm / 100) ** 2


def at_least(value: Num, least: Num, *, sharpness: float = 8.0) -> Num:
    r""":math:`(x^s + y^s)^{1/s}`, in the unit of both: the larger one, 9 % above it where they are equal.

    Args:
        value: a magnitude, not negative
        least: what it does not fall below, above 0
        sharpness: exponent s
    """
    return least * (1 + (value / least) ** sharpness) ** (1 / sharpness)
