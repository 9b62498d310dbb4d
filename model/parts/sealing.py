"""Radial lip seals."""

from __future__ import annotations

from typing import ClassVar

from ..core.declare import Parameter
from ..laws.sealing import lip_seal_torque, oil_seal_torque
from ..laws.smooth import Num
from .friction import Friction
from .ports import Lubricant


class LipSeal(Friction):
    """Radial lip seal: a torque that depends on the shaft's diameter alone."""

    role: ClassVar[str] = "seal"

    d_sh = Parameter("m", "diameter of the shaft under the lip", nominal=0.1, above=0.0)
    c_sh = Parameter("N/m", "friction torque per square of the diameter", nominal=50.0, at_least=0.0)

    def torque(self) -> Num:
        """Friction torque of one seal [N.m]."""
        return lip_seal_torque(self.d_sh, self.c_sh)


class OilLipSeal(Friction):
    """Radial lip seal whose torque falls as its oil warms, and is higher in thicker oil."""

    role: ClassVar[str] = "seal"

    lubricant = Lubricant()

    d_sh = Parameter("m", "diameter of the shaft under the lip", nominal=0.1, above=0.0)
    nu_40 = Parameter("m2/s", "kinematic viscosity of the oil at 40 degC", nominal=1e-4, above=1e-6)

    def torque(self) -> Num:
        """Friction torque of one seal [N.m]."""
        return oil_seal_torque(self.lubricant.T, self.nu_40, self.d_sh)
