"""Loss of gears and carriers that move oil, without load: a power law with three constants of the machine."""

from __future__ import annotations

from ..sources import law
from .smooth import SPEED_WIDTH, Num, smooth_abs, smooth_power, to_rpm


@law(
    source="Changenet2007",
    where="churning torque as a product of powers",
    valid="c, a and b found by tests of the machine itself",
    verified=False,
)
def churning_loss(w: Num, rho: Num, nu: Num, c: Num, a: Num, b: Num) -> Num:
    r"""No-load power lost in the oil [W], zero at standstill.

    .. math:: P = c \left(\frac{n}{200}\right)^a \frac{\rho}{835} \left(\frac{\nu}{75}\right)^b

    Args:
        w: speed of the part that dips, either direction [rad/s]
        rho: density of the oil [kg/m3]
        nu: kinematic viscosity of the oil [m2/s]
        c: power at 200 rpm, 835 kg/m3 and 75 cSt [W]
        a: exponent of the speed, from 1 on [1]
        b: exponent of the viscosity [1]
    """
    n, nu_cSt, n_width = to_rpm(w), 1e6 * nu, to_rpm(SPEED_WIDTH)
    return c * smooth_power(n / 200, a, n_width / 200) * (rho / 835) * (nu_cSt / 75) ** b


@law(
    source="Changenet2007",
    where="churning torque as a product of powers",
    valid="c, a and b found by tests of the machine itself",
    verified=False,
)
def churning_torque(w: Num, rho: Num, nu: Num, c: Num, a: Num, b: Num) -> Num:
    r"""Torque of the no-load loss [N.m], a magnitude, zero at standstill.

    .. math:: \tau = P / |\omega|

    Args:
        w: speed of the part that dips, either direction [rad/s]
        rho: density of the oil [kg/m3]
        nu: kinematic viscosity of the oil [m2/s]
        c: power at 200 rpm, 835 kg/m3 and 75 cSt [W]
        a: exponent of the speed, from 1 on [1]
        b: exponent of the viscosity [1]
    """
    return churning_loss(w, rho, nu, c, a, b) / smooth_abs(w)
