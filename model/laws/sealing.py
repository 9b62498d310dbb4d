"""Friction of contact seals."""

from __future__ import annotations

import math

from ..sources import law
from .smooth import Num

#: 7.69e-6 W per rpm and square millimetre of the shaft, as torque per square of its diameter [N.m/m2].
LIP_SEAL = 7.69e-6 * 1e6 * 30 / math.pi


@law(source="Dias2014", where="seal losses", valid="radial lip seal")
def lip_seal_torque(d_sh: Num, c_sh: Num = LIP_SEAL) -> Num:
    r"""Friction torque of a radial lip seal [N.m], the same at any speed.

    .. math:: P = 7.69 \cdot 10^{-6} d_{sh}^2 n \;[\mathrm{W, mm, rpm}],\quad \tau = P / \omega = c_{sh} d_{sh}^2

    Args:
        d_sh: diameter of the shaft under the lip [m]
        c_sh: torque per square of the diameter [N.m/m2]
    """
    return c_sh * d_sh**2
