"""Churning of a gear that dips into oil, and windage of one in air, from their geometry.

Heights and depths are those of the pitch circle: a gear of radius r dips by h = level - (height of its axis - r).
The authors' tests were not at hand, so the ranges are those over which tests compare the churning with other published
methods: r 40 to 200 mm, Fr up to 2500, Re up to 1e5, down to where the friction of a smooth disc takes over.
"""

from __future__ import annotations

import math

import casadi as ca

from ..sources import law
from .smooth import SPEED_WIDTH, Num, smooth_abs, smooth_cap, smooth_max, smooth_power

#: Acceleration of gravity [m/s2].
GRAVITY = 9.81

#: Working depth of a tooth with its clearance, in modules: standard gears.
TOOTH_HEIGHT = 2.25
#: Pressure angle [rad]: standard gears.
PRESSURE_ANGLE = math.radians(20)


def immersion(level: Num, height: Num, r: Num, *, rounding: float = 0.01) -> Num:
    """Depth by which a gear dips [m]: above zero, and below its diameter, both smoothly.

    Args:
        level: height of the oil's surface above a datum [m]
        height: height of the axis above the same datum [m]
        r: pitch radius [m]
        rounding: depth over radius at which a gear leaves the oil [1]
    """
    return smooth_cap(smooth_max(level - height + r, 0.0, rounding * r), 1.99 * r)


def dipping_share(h: Num, r: Num) -> Num:
    """Share of the faces that dips [1].

    Args:
        h: depth by which the gear dips [m]
        r: radius [m]
    """
    theta = ca.acos(1 - h / r)
    return (2 * theta - ca.sin(2 * theta)) / (2 * math.pi)


@law(source="Changenet2007", where="submerged surface area", valid="standard teeth", verified=False)
def submerged_area(h: Num, r: Num, b: Num) -> Num:
    r"""Area of a gear in the oil [m2]: faces, cylinder and flanks of the teeth.

    .. math:: S_m = r^2 (2 \theta - \sin 2 \theta) + 2 r b \theta + \frac{2 z \theta h_z b}{\pi \cos\alpha \cos\beta},
        \quad \cos\theta = 1 - h/r

    With z = 2 r cos(beta) / m_n and teeth 2.25 modules high at 20 deg, module and helix angle cancel.

    Args:
        h: depth by which the gear dips [m]
        r: pitch radius [m]
        b: face width [m]
    """
    theta = ca.acos(1 - h / r)
    flanks = 4 * TOOTH_HEIGHT / (math.pi * math.cos(PRESSURE_ANGLE))
    return r**2 * (2 * theta - ca.sin(2 * theta)) + (2 + flanks) * r * b * theta


@law(
    source="Changenet2007",
    where="dimensionless torque at low speed",
    valid="gear away from walls",
    ranges={"Re": (0.0, 1e5)},
    verified=False,
)
def slow_churning(depth: Num, volume: Num, Fr: Num, Re: Num) -> Num:
    r"""Dimensionless churning torque where the oil follows the gear [1].

    .. math:: C_m = 1.366 \left(\frac{h}{D}\right)^{0.45} \left(\frac{V}{D^3}\right)^{0.1} Fr^{-0.6} Re^{-0.21}

    Args:
        depth: depth by which the gear dips over its pitch diameter [1]
        volume: volume of oil over the cube of the pitch diameter [1]
        Fr: Froude number w^2 r / g [1]
        Re: Reynolds number w r^2 / nu [1]
    """
    return 1.366 * depth**0.45 * volume**0.1 * Fr**-0.6 * Re**-0.21


@law(
    source="Changenet2007",
    where="dimensionless torque at high speed",
    valid="gear away from walls",
    ranges={"Fr": (0.0, 2500.0)},
    verified=False,
)
def fast_churning(depth: Num, volume: Num, Fr: Num, width: Num) -> Num:
    r"""Dimensionless churning torque where the oil is thrown off; viscosity does not count [1].

    .. math:: C_m = 3.644 \left(\frac{h}{D}\right)^{0.1} \left(\frac{V}{D^3}\right)^{-0.35} Fr^{-0.88}
        \left(\frac{b}{D}\right)^{0.85}

    Args:
        depth: depth by which the gear dips over its pitch diameter [1]
        volume: volume of oil over the cube of the pitch diameter [1]
        Fr: Froude number w^2 r / g [1]
        width: face width over pitch diameter [1]
    """
    return 3.644 * depth**0.1 * volume**-0.35 * Fr**-0.88 * width**0.85


#: Centrifugal acceleration [m/s2] in the middle of the change from one regime of flow to the other: Changenet2011.
CHANGE = 1000.0
#: How sharply the two speeds are held at that of the change: 3e-4 off at 750 m/s2.
HOLD = 32.0
#: Rounding where the torques of high and low speed are equal at the change, of that of low speed [1].
EQUAL_TORQUES = 1e-3


def changing_speed(r: Num, b: Num, m_n: Num) -> Num:
    """Speed [rad/s] at which the flow about a gear changes from one regime to the other.

    Args:
        r: pitch radius [m]
        b: face width [m]
        m_n: normal module [m]
    """
    return ca.sqrt(CHANGE * (r * b * m_n) ** (-1 / 3))


@law(source="Changenet2011", where="flow regimes by the centrifugal acceleration", verified=False)
def fast_share(w: Num, r: Num, b: Num, m_n: Num, *, sharpness: int = 16) -> Num:
    r"""Share of the regime of high speed [1], all but 0 below 750 m/s2 and 1 above 1250 m/s2.

    .. math:: s = \frac{x^{16}}{1 + x^{16}},\quad x = \frac{\omega^2 (r b m_n)^{1/3}}{1000\,\mathrm{m/s^2}}

    The source goes from one to the other in a straight line, with two corners.

    Args:
        w: speed of the gear, either direction [rad/s]
        r: pitch radius [m]
        b: face width [m]
        m_n: normal module [m]
        sharpness: of the change, even [1]
    """
    x = (w / changing_speed(r, b, m_n)) ** (2 * sharpness)
    return x / (1 + x)


@law(
    source="Bird2002",
    where="friction factor of a rotating disc, laminar",
    valid="smooth disc, Re > 1e3",
    verified=False,
)
def disc_friction(h: Num, r: Num, Re: Num) -> Num:
    r"""Drag area of a smooth disc that dips into oil [m2]: its torque is this times rho w^2 r^3 / 2.

    .. math:: C_d S_d = 0.616 Re^{-1/2} r^2 (2 \theta - \sin 2 \theta), \quad \cos\theta = 1 - h/r

    The source has the whole disc, T = 0.616 pi rho r^4 (nu w^3)^(1/2); what dips counts by its area.

    Args:
        h: depth by which the disc dips [m]
        r: radius [m]
        Re: Reynolds number w r^2 / nu [1]
    """
    return 0.616 * Re**-0.5 * 2 * math.pi * dipping_share(h, r) * r**2


@law(
    source="Daily1960",
    where="torque coefficients of the four regimes",
    valid="smooth disc in a chamber of little tip clearance",
    ranges={"Re": (0.0, 1e7), "gap_share": (0.0127, 0.217)},
    verified=False,
)
def enclosed_disc(Re: Num, gap_share: Num, *, sharpness: int = 16) -> Num:
    r"""Torque coefficient of both faces of a disc between walls [1]: torque over 1/2 rho w^2 r^5.

    .. math:: C = \max\left(\frac{2\pi}{G\,Re},\; 3.7\, G^{0.1} Re^{-1/2},\; 0.08\, G^{-1/6} Re^{-1/4},\;
        0.102\, G^{0.1} Re^{-1/5}\right),\quad G = s/r

    Thin and wide gaps, laminar and turbulent: the largest reigns. Below Re = 1000 the flow of a thin gap is exact.

    Args:
        Re: Reynolds number w r^2 / nu, above 0 [1]
        gap_share: clearance of a face over the radius, s / r [1]
        sharpness: of the mean that joins the regimes [1]
    """
    thin = 2 * math.pi / (gap_share * Re), 0.08 * gap_share ** (-1 / 6) * Re**-0.25
    wide = 3.7 * gap_share**0.1 * Re**-0.5, 0.102 * gap_share**0.1 * Re**-0.2
    return sum(C**sharpness for C in (*thin, *wide)) ** (1 / sharpness)


@law(
    source="Bird2002",
    where="friction of a rotating disc, beside churning",
    valid="oil so thin that a smooth disc would lose less than the gear does",
    ranges={"friction / churning": (0.0, 1.0)},
    regimes={"friction / churning": "thick oil: the friction of a smooth disc stands in for churning"},
    verified=False,
)
def churning_in_thick_oil(churning: Num, friction: Num, *, sharpness: int = 16) -> Num:
    r"""Drag area of a gear in oil of any viscosity [m2]: the larger of churning and the friction of a smooth disc.

    .. math:: (x^{16} + y^{16})^{1/16}

    Args:
        churning: drag area after the formulas of churning [m2]
        friction: drag area of a smooth disc that dips as deep, as far as the oil follows the gear [m2]
        sharpness: of the change; where churning is twice the friction it adds less than 1e-6 [1]
    """
    return (churning**sharpness + friction**sharpness) ** (1 / sharpness)


@law(
    source="Changenet2007",
    where="churning torque at high speed, beside that at low speed",
    valid="the torque of high speed is the larger one, where the flow changes and above",
    ranges={"slow / fast": (0.0, 1.0)},
    regimes={"slow / fast": "narrow gear in thick oil: churning stays at its torque where the flow changes"},
    verified=False,
)
def churning_past_change(slow: Num, fast: Num, thrown: Num) -> Num:
    r"""Churning torque of a gear at any speed [N.m], which never falls as the speed rises.

    .. math:: \tau = \tau_{slow} + s \max(\tau_{fast} - \tau_{slow}, 0)

    The source goes to the torque of high speed also where that is the smaller one, so that a narrow gear in thick oil
    would lose less the faster it turns, by up to two thirds. Its two regressions were fitted one by one.

    Args:
        slow: torque at low speed, of no more speed than where the flow changes, over what both share [N.m]
        fast: torque at high speed, of no less speed than that, over the same [N.m]
        thrown: share of the regime of high speed, see `fast_share` [1]
    """
    return slow + thrown * (smooth_max(fast, slow, EQUAL_TORQUES * slow) - slow)


@law(
    source="Changenet2007",
    where="churning torque from submerged area and dimensionless torque",
    valid="one gear of automotive size away from walls, dipping by no more than its radius",
    ranges={"h / r": (0.0, 1.0), "b / r": (0.1, 1.0), "r": (0.04, 0.2)},
    verified=False,
)
def gear_churning_torque(
    w: Num, rho: Num, nu: Num, h: Num, V: Num, r: Num, b: Num, m_n: Num, *, gap: Num | None = None
) -> Num:
    r"""Torque with which oil brakes a gear that dips into it [N.m], a magnitude, zero at standstill.

    .. math:: \tau = \tfrac{1}{2} \rho \omega^2 S_m r^3 C_m

    Near the surface, below a twentieth of the radius, it fades to that of a gear in air. In thick oil the friction of a
    smooth disc takes over, see `churning_in_thick_oil`; between walls that of `enclosed_disc`. Clearances at the
    circumference count less (Changenet2008) and are not seen. Past the change of flow the drag at low speed stays at
    what it was there, see `churning_past_change`, so that the torque rises with speed everywhere.

    Args:
        w: speed of the gear, either direction [rad/s]
        rho: density of the oil [kg/m3]
        nu: kinematic viscosity of the oil [m2/s]
        h: depth by which the gear dips, see `immersion` [m]
        V: volume of oil in the housing [m3]
        r: pitch radius [m]
        b: face width [m]
        m_n: normal module [m]
        gap: clearance between a face and the wall or gear beside it, where one is near [m]
    """
    speed, change, D = smooth_abs(w), changing_speed(r, b, m_n), 2 * r
    below = smooth_cap(speed, change, HOLD)
    above = speed * change / below
    Re, area = below * r**2 / nu, submerged_area(h, r, b)
    slow = area * slow_churning(h / D, V / D**3, below**2 * r / GRAVITY, Re)
    near = 0.0 if gap is None else enclosed_disc(Re, gap / r) * r**2 * dipping_share(h, r)
    slow = churning_in_thick_oil(slow, disc_friction(h, r, Re) if gap is None else near) * below**2
    fast = area * fast_churning(h / D, V / D**3, above**2 * r / GRAVITY, b / D) * above**2
    wetted = h**2 / (h**2 + (0.01 * r) ** 2)  # a gear above the oil has none of it
    turning = 0.5 * rho * (w / speed) ** 2 * wetted * r**3
    return turning * churning_past_change(slow, fast, fast_share(w, r, b, m_n))


@law(source="Maurer1994", where="windage torque of a gear in air", valid="air at sea level", verified=False)
def windage_torque(w: Num, r: Num, b: Num, m_n: Num) -> Num:
    r"""Torque with which air brakes a gear that runs free of oil [N.m], a magnitude, zero at standstill.

    .. math:: \tau = 1.37 \cdot 10^{-9} v_t^{1.9} d^{1.6} b^{0.52} m_n^{0.69} \;[\mathrm{m/s, mm}]

    Args:
        w: speed of the gear, either direction [rad/s]
        r: pitch radius [m]
        b: face width [m]
        m_n: normal module [m]
    """
    d_mm, b_mm, m_mm = 2e3 * r, 1e3 * b, 1e3 * m_n
    return 1.37e-9 * smooth_power(w * r, 1.9, SPEED_WIDTH * r) * d_mm**1.6 * b_mm**0.52 * m_mm**0.69
