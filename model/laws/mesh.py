"""Load-dependent loss of a gear mesh: friction coefficient, tooth loss factor, power."""

from __future__ import annotations

import math

import casadi as ca

from ..sources import law
from .smooth import LINE_WIDTH, V_WIDTH, Num, smooth_abs, smooth_cap, smooth_max

#: Viscosity [mPa.s] beyond which thicker oil lowers the friction of the teeth no more: they are on a full film then.
FULL_FILM_VISCOSITY = 1000.0


@law(source="Schlenk1994", where="line load of the mean friction coefficient, as in ISO/TR 14179-2", verified=False)
def load_per_face_width(F_bt: Num, b: Num) -> Num:
    r"""Line load of the printed friction formula [N/m].

    .. math:: F_{bt} / b

    Args:
        F_bt: tangential force at the base cylinder, either sign [N]
        b: face width [m]
    """
    return F_bt / b


@law(source="Dias2014", where="equation 5.4.13, line load")
def load_per_contact_length(F_bn: Num, length: Num) -> Num:
    r"""Load per length of all contact lines [N/m]: eps_alpha times less than that per face width.

    .. math:: F_{bn} / l

    Args:
        F_bn: normal force of the mesh, either sign [N]
        length: mean length of all contact lines [m]
    """
    return F_bn / length


@law(
    source="Schlenk1994",
    where="mean friction coefficient of the mesh",
    valid="boundary and mixed friction, pitch line up to 50 m/s, oils up to 1 Pa.s, with X_L also others than mineral",
    ranges={"v_sum": (-34.0, 34.0), "eta_oil": (0.0, 1.0)},
)
def friction_schlenk(line_load: Num, v_sum: Num, R: Num, eta_oil: Num, Ra: Num, X_L: Num) -> Num:
    r"""Mean friction coefficient of a gear mesh [1].

    .. math:: \mu = 0.048 \left(\frac{F/l}{v_\Sigma R}\right)^{0.2} \eta^{-0.05} R_a^{0.25} X_L

    Args:
        line_load: the source's F_bt/b (`load_per_face_width`), or what a factor on the friction was fitted with; a
            load per contact length gives eps_alpha^0.2, about 1.1, times less friction; either sign [N/m]
        v_sum: sum of the rolling speeds at the pitch point, either sign [m/s]
        R: reduced radius of curvature at the pitch point [m]
        eta_oil: dynamic viscosity at the oil's temperature [Pa.s]
        Ra: mean roughness of the two flanks [m]
        X_L: lubricant factor [1]
    """
    F, v = smooth_abs(line_load, LINE_WIDTH), smooth_abs(v_sum, V_WIDTH)
    F_N_mm, R_mm, eta_mPas, Ra_um = 1e-3 * F, 1e3 * R, 1e3 * eta_oil, 1e6 * Ra
    eta_eff = smooth_cap(eta_mPas, FULL_FILM_VISCOSITY)
    return 0.048 * (F_N_mm / (v * R_mm)) ** 0.2 * eta_eff**-0.05 * Ra_um**0.25 * X_L


@law(
    source="Dias2014",
    where="Table 5.3, last column",
    valid="load shared equally by the tooth pairs in contact",
    ranges={"eps_1": (1e-9, 5.0), "eps_2": (1e-9, 5.0)},
)
def tooth_loss_factor(z_1: Num, u: Num, beta_b: Num, eps_1: Num, eps_2: Num, *, printed_a2: bool = False) -> Num:
    r"""Tooth loss factor for any contact ratio above 1 [1], equal load on all pairs in contact.

    .. math:: H_V = \frac{\pi (u + 1)}{z_1 u \cos\beta_b}
        \left(a_0 + a_1 \varepsilon_1 + a_2 \varepsilon_2 + a_3 \varepsilon_1^2 + a_4 \varepsilon_2^2\right)

    with l, m, n the next whole numbers above eps_1, eps_2 and their sum, and with N = n(n - 1)

    .. math:: a_0 = \frac{N(2n-1) - l(l-1)(2l-1) - m(m-1)(2m-1)}{3N},\quad a_1 = \frac{2l(l-1)}{N} - 1,\quad
        a_2 = \frac{2m(m-1)}{N} - 1,\quad a_3 = \frac{2(n-l)}{N},\quad a_4 = \frac{2(n-m)}{N}

    Args:
        z_1: number of teeth of the first gear [1]
        u: teeth ratio z_2/z_1, negative for an internal second gear [1]
        beta_b: helix angle at the base cylinder [rad]
        eps_1: addendum contact ratio of the first gear; it decides the number of pairs [1]
        eps_2: addendum contact ratio of the second gear [1]
        printed_a2: whether to reproduce the misprint of a_2 in the source, which has m in the place of l
    """
    l, m, n = ca.ceil(eps_1), ca.ceil(eps_2), ca.ceil(eps_1 + eps_2)  # noqa: E741 the source's letters
    N = n * (n - 1)
    a_0 = (N * (2 * n - 1) - l * (l - 1) * (2 * l - 1) - m * (m - 1) * (2 * m - 1)) / (3 * N)
    a_1, a_2 = 2 * l * (l - 1) / N - 1, 2 * m * (m - 1) / N - 1
    a_3, a_4 = 2 * (n - l) / N, 2 * (n - m) / N
    if printed_a2:  # misprint: "- 2(m - 1)n" for "- 2(l - 1)n" in the numerator
        a_2 += 2 * (l - m) / (n - 1)
    polynomial = a_0 + a_1 * eps_1 + a_2 * eps_2 + a_3 * eps_1**2 + a_4 * eps_2**2
    return math.pi * (u + 1) / (z_1 * u * ca.cos(beta_b)) * polynomial


@law(
    source="Wimmer2006",
    where="local tooth loss factor, for the same load on every length of the contact lines",
    valid="overlap ratio of 1 or more, unmodified flanks without deflection",
    ranges={"eps_1": (1e-9, 5.0), "eps_2": (1e-9, 5.0)},
    verified=False,
)
def line_loss_factor(z_1: Num, u: Num, beta_b: Num, eps_1: Num, eps_2: Num) -> Num:
    r"""Tooth loss factor of helical gears [1], whose load is spread evenly along their lines of contact.

    .. math:: H_V = \frac{\pi (u + 1)}{z_1 u \cos\beta_b} \frac{\varepsilon_1^2 + \varepsilon_2^2}{\varepsilon_\alpha}

    The source has an integral of load and sliding over the field of contact; from an overlap ratio of 1 on the lines
    are all but as long in every position, and it is this. Equal pairs (`tooth_loss_factor`) carry their load
    nearer to the pitch point, and are 11 to 17 % below it at usual contact ratios.

    Args:
        z_1: number of teeth of the first gear [1]
        u: teeth ratio z_2/z_1, negative for an internal second gear [1]
        beta_b: helix angle at the base cylinder [rad]
        eps_1: addendum contact ratio of the first gear [1]
        eps_2: addendum contact ratio of the second gear [1]
    """
    return math.pi * (u + 1) / (z_1 * u * ca.cos(beta_b)) * (eps_1**2 + eps_2**2) / (eps_1 + eps_2)


@law(
    source="Wimmer2006",
    where="a fit of this project to the integral of the local tooth loss factor, within 0.04",
    valid="compared at overlap ratios of 0.3 to 1 and transverse contact ratios of 1.5",
    verified=False,
)
def line_sharing(eps_beta: Num, *, width: float = 1e-3) -> Num:
    r"""How far teeth share their load along lines of contact and not by pairs [1]: 0 for spur gears, 1 from 1 on.

    .. math:: s = 1 - \max(1 - \varepsilon_\beta, 0)^{3/2}

    Args:
        eps_beta: overlap ratio [1]
        width: rounding where the overlap ratio is 1 [1]
    """
    return 1 - smooth_max(1 - eps_beta, 0.0, width) ** 1.5


@law(source="Ohlendorf1958", where="mesh loss power")
def mesh_loss(P_a: Num, mu: Num, H_v: Num) -> Num:
    r"""Friction power of a mesh [W]; of a torque on one shaft its part that is lost there [N.m].

    .. math:: P_{VZP} = P_a \mu H_V

    Args:
        P_a: magnitude of the power [W], or of the torque [N.m], through the mesh in the frame of the axles
        mu: mean friction coefficient [1]
        H_v: tooth loss factor [1]
    """
    return mu * H_v * P_a
