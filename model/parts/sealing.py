"""Radial lip seals, and labyrinths that do not touch their shaft."""

from __future__ import annotations

from typing import ClassVar

from ..core.declare import Parameter
from ..laws.convection import R_AIR, SEA_LEVEL, air_properties
from ..laws.gap_seal import gap_torque
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


class LabyrinthSeal(Friction):
    """Seal that does not touch its shaft: air shears in its gaps, and oil where they stand full.

    Nothing leaks and no air flows through: neither oil nor heat leaves by the gaps.
    """

    role: ClassVar[str] = "seal"

    lubricant = Lubricant()

    d = Parameter("m", "diameter of the shaft in the gaps", nominal=0.1, above=0.0)
    gap = Parameter("m", "radial clearance of the gaps", nominal=3e-4, above=0.0)
    L = Parameter("m", "length of all gaps along the shaft", nominal=0.03, above=0.0)
    oil_share = Parameter("1", "share of this length that stands full of oil", default=0.0, at_least=0.0, at_most=1.0)

    def torque(self) -> Num:
        """Drag of the gaps of one seal [N.m]; the air is as warm as the outer body."""
        w, oil, r, gap = self.shaft.w, self.lubricant, self.d / 2, self.gap
        T = self.outer.T
        _, nu_air, _, _ = air_properties(T)
        air = gap_torque(w, SEA_LEVEL / (R_AIR * T), nu_air, r, gap, (1 - self.oil_share) * self.L)
        return air + gap_torque(w, oil.rho, oil.nu, r, gap, self.oil_share * self.L)
