"""Bevel gears at mid face: pitch cones, the cylindrical gears that mesh alike, and the forces on the shafts."""

from __future__ import annotations

import casadi as ca

from ..sources import law
from .smooth import Num


@law(source="ISO23509", where="pitch angle of the pinion", valid="axes that intersect")
def pitch_angle(u: Num, shaft_angle: Num) -> Num:
    r"""Angle between the pinion's axis and its pitch cone [rad]; the wheel has the rest of the shaft angle.

    .. math:: \tan\delta_1 = \frac{\sin\Sigma}{\cos\Sigma + u}

    Args:
        u: teeth of the wheel over those of the pinion [1]
        shaft_angle: angle between the axes [rad]
    """
    return ca.atan2(ca.sin(shaft_angle), ca.cos(shaft_angle) + u)


@law(source="ISO23509", where="mean pitch diameter")
def mean_diameter(d_e: Num, b: Num, delta: Num) -> Num:
    r"""Pitch diameter at mid face [m].

    .. math:: d_m = d_e - b \sin\delta

    Args:
        d_e: pitch diameter at the outer end [m]
        b: face width [m]
        delta: pitch angle of the gear [rad]
    """
    return d_e - b * ca.sin(delta)


@law(source="ISO10300", where="part 1, virtual cylindrical gears, number of teeth", verified=False)
def virtual_teeth(z: Num, delta: Num) -> Num:
    r"""Teeth of the cylindrical gear that meshes as the bevel gear does at mid face [1], no whole number.

    .. math:: z_v = z / \cos\delta

    Args:
        z: number of teeth [1]
        delta: pitch angle of the gear [rad]
    """
    return z / ca.cos(delta)


@law(source="NiemannWinter1983", where="bevel gears, axial tooth force", verified=False)
def bevel_axial_force(F_t: Num, alpha_n: Num, beta: Num, delta: Num, away: Num) -> Num:
    r"""Axial force on a bevel gear [N], positive away from the apex.

    .. math:: F_a = \frac{F_t}{\cos\beta_m} (\tan\alpha_n \sin\delta + k \sin\beta_m \cos\delta)

    Args:
        F_t: tangential force at mid face [N]
        alpha_n: normal pressure angle [rad]
        beta: spiral angle at mid face [rad]
        delta: pitch angle of the gear [rad]
        away: k, 1 where the spiral pushes the gear away from the apex, -1 where towards it [1]
    """
    return F_t / ca.cos(beta) * (ca.tan(alpha_n) * ca.sin(delta) + away * ca.sin(beta) * ca.cos(delta))


@law(source="NiemannWinter1983", where="bevel gears, radial tooth force", verified=False)
def bevel_radial_force(F_t: Num, alpha_n: Num, beta: Num, delta: Num, away: Num) -> Num:
    r"""Radial force on a bevel gear [N], positive towards its axis.

    .. math:: F_r = \frac{F_t}{\cos\beta_m} (\tan\alpha_n \cos\delta - k \sin\beta_m \sin\delta)

    Args:
        F_t: tangential force at mid face [N]
        alpha_n: normal pressure angle [rad]
        beta: spiral angle at mid face [rad]
        delta: pitch angle of the gear [rad]
        away: k, 1 where the spiral pushes the gear away from the apex, -1 where towards it [1]
    """
    return F_t / ca.cos(beta) * (ca.tan(alpha_n) * ca.cos(delta) - away * ca.sin(beta) * ca.sin(delta))
