"""Loss of gears and carriers that move oil, without load."""

from __future__ import annotations

from typing import ClassVar

from ..core.declare import Parameter
from ..laws.churning import churning_torque
from ..laws.smooth import Num
from .friction import Friction
from .ports import Lubricant


class Churning(Friction):
    """No-load loss of what turns in the oil: a power of speed, density and viscosity. Its `inner` body is the oil."""

    role: ClassVar[str] = "churning"

    lubricant = Lubricant()

    c = Parameter("W", "loss at 200 rpm, 835 kg/m3 and 75 cSt", nominal=10.0, at_least=0.0)
    a = Parameter("1", "exponent of the speed", at_least=1.0)
    b = Parameter("1", "exponent of the viscosity")

    def torque(self) -> Num:
        """Churning torque [N.m]."""
        return churning_torque(self.shaft.w, self.lubricant.rho, self.lubricant.nu, self.c, self.a, self.b)
