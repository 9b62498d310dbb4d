"""Pairs of bearings set against each other: what temperatures make of their preload, and a load of the loads."""

from __future__ import annotations

import casadi as ca

from ..sources import law
from .smooth import F_WIDTH, Num, smooth_magnitude, smooth_max


@law(
    source="Rusu2013",
    where="rule of the cone apexes, as a length",
    valid="rings that follow their seats; shaft and housing of one temperature each",
    ranges={"T_shaft": (233.15, 423.15), "T_housing": (233.15, 423.15)},
    verified=False,
)
def thermal_interference(
    T_shaft: Num, T_housing: Num, T_set: Num, alpha_s: Num, alpha_h: Num, d_m: Num, alpha: Num, span: Num
) -> Num:
    r"""How much closer expansion brings the raceways of a pair of bearings, along the axis [m].

    .. math:: (\alpha_s (T_{shaft} - T_{set}) - \alpha_h (T_{housing} - T_{set})) (d_m \cot\alpha + span)

    The last factor is the distance between the apexes of the two cones in which the raceways lie: a cone that grows
    about its apex stays the same cone. Where the apexes coincide, temperatures change nothing.

    Args:
        T_shaft: temperature of the shaft [K]
        T_housing: temperature of the housing [K]
        T_set: temperature of both at which the pair was set [K]
        alpha_s: thermal expansion coefficient of the shaft [1/K]
        alpha_h: thermal expansion coefficient of the housing [1/K]
        d_m: mean diameter, (d + D)/2 [m]
        alpha: contact angle [rad]
        span: distance of the bearings, positive face to face, negative back to back [m]
    """
    return (alpha_s * (T_shaft - T_set) - alpha_h * (T_housing - T_set)) * (d_m / ca.tan(alpha) + span)


@law(
    source="SKF2018",
    where="preload, as a force and as a distance",
    valid="stiffness constant about the preload as set",
    ranges={"dx": (-2e-4, 2e-4)},
    verified=False,
)
def preload_force(F_set: Num, k: Num, dx: Num) -> Num:
    r"""Preload of a pair of bearings [N], none where it has clearance.

    .. math:: \max(F_{set} + k\,\Delta x, 0)

    Args:
        F_set: preload as set; negative: the clearance as set, times k [N]
        k: axial stiffness of the pair with shaft and housing, preload over interference [N/m]
        dx: what the interference has grown by since [m]
    """
    return smooth_max(F_set + k * dx, 0.0, F_WIDTH)


@law(
    source="SKF2018",
    where="tapered roller and angular contact ball bearings, axial load of bearings set against each other",
    valid="half of the rolling elements loaded: no clearance, no preload",
)
def own_thrust(F_r: Num, Y: Num) -> Num:
    r"""Thrust with which a radial load on inclined contacts pushes the shaft along [N], never negative.

    .. math:: 0.5 F_r / Y

    Args:
        F_r: radial load, either direction [N]
        Y: axial load factor: of tapered rollers by the catalogue, of balls 0.57 at 40 deg, 0.87 at 25 deg [1]
    """
    return 0.5 * smooth_magnitude(F_r, F_WIDTH) / Y


@law(
    source="SKF2018",
    where="tapered roller and angular contact ball bearings, axial load of bearings set against each other",
    valid="no clearance, no preload; radial loads at the pressure centres",
    verified=False,
)
def axial_load_set_against(S_own: Num, F_pushed: Num) -> Num:
    r"""Axial load of one of two bearings set against each other [N].

    .. math:: F_{aA} = \max(S_A, S_B + K_a),\quad F_{aB} = \max(S_B, S_A - K_a)

    The makers' tables of six cases, in a line: a bearing carries its own thrust, or what pushes against it where that
    is more; the difference of the two is the external force.

    Args:
        S_own: thrust of the bearing itself, see `own_thrust` [N]
        F_pushed: what the shaft pushes towards it: thrust of the other one and external force [N]
    """
    return smooth_max(S_own, F_pushed, F_WIDTH)


@law(source="SKFLifting", where="lifting force of a preloaded set", valid="equal bearings, rigid shaft and housing")
def preloaded_axial_load(F_0: Num, F_own: Num, F_other: Num, n: Num) -> Num:
    r"""Axial load of a bearing of a preloaded pair [N].

    .. math:: \max(F_0 + (1 - 2^{-n}) K, F_{own})\ \text{for}\ K = F_{own} - F_{other} > 0,\quad
        \max(F_0 + 2^{-n} K, F_{own})\ \text{below}

    Contacts with F = c x^n lift off at K = 2^n F_0, when the other one is pressed twice as far: 2.83 F_0 with balls.
    Up to there loads are taken as linear, which is within 0.13 F_0 of such contacts with balls, 0.03 F_0 with rollers.

    Args:
        F_0: preload of the pair [N]
        F_own: axial force on the shaft towards this bearing [N]
        F_other: axial force on the shaft towards the other bearing [N]
        n: exponent of the contacts, 1.5 with balls, 10/9 with rollers [1]
    """
    K = F_own - F_other
    shared = F_0 + K / 2 + (0.5 - 2**-n) * smooth_magnitude(K, F_WIDTH)
    return smooth_max(shared, F_own, F_WIDTH)
