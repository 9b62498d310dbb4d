"""Loss of gears and carriers that move oil or air, without load."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from ..core.component import Equation, Related, equation
from ..core.declare import Output, Parameter
from ..laws.churning import churning_torque
from ..laws.convection import R_AIR, SEA_LEVEL
from ..laws.dry_sump import mist_factor
from ..laws.gear_churning import gear_churning_torque, immersion, windage_torque
from ..laws.oil_in_motion import aerated_density, thrown_flow
from ..laws.smooth import Num
from ..laws.squeezing import squeezing_torque
from .friction import Friction
from .ports import Lubricant, Sump
from .relations import require


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


class GearInFluid(Friction):
    """Base of gears that oil or air brakes: what their drag takes from their geometry."""

    role: ClassVar[str] = "churning"

    r = Parameter("m", "pitch radius of the gear", nominal=0.1, above=0.0)
    b = Parameter("m", "face width of the gear", nominal=0.05, above=0.0)
    m_n = Parameter("m", "normal module of the gear", nominal=0.003, above=0.0)


class GearChurning(GearInFluid):
    """Churning of a gear that dips into the oil of its housing, from its geometry. Its `inner` body is the oil.

    How deep it dips follows from the oil's level, which falls by what all gears throw where the bath says so. Pitch
    surface and teeth churn. A wall at its faces, or the face of a gear beside it, counts where its clearance is given.
    """

    lubricant = Lubricant()
    sump = Sump()

    height = Parameter("m", "height of the gear's axis above the datum of the housing", nominal=0.1)
    gap = Parameter("m", "clearance between a face and the wall or gear beside it", 5e-3, optional=True, above=0.0)
    h = Output("m", "depth by which the pitch circle dips", nominal=0.02, at_least=0.0)

    def torque(self) -> Num:
        """Churning torque of one gear [N.m]."""
        oil, sump, wall = self.lubricant, self.sump, {"gap": self.gap} if "gap" in self.told else {}
        rho = aerated_density(oil.rho, sump.share_air)
        return gear_churning_torque(self.shaft.w, rho, oil.nu, self.h, sump.V, self.r, self.b, self.m_n, **wall)

    def equations(self) -> Iterator[Equation]:
        """The depth and what is thrown, then what every friction does."""
        thrown = thrown_flow(self.shaft.w, self.h, self.r, self.b, self.m_n)
        yield equation("depth", self.h, immersion(self.sump.level, self.height, self.r))
        yield equation("oil thrown", self.sump.Q_oil, self.count * thrown)
        yield from super().equations()


class GearWindage(GearInFluid):
    """Windage of a gear that runs in air, free of the oil: of note at high pitch line speeds.

    A mist of oil makes the air heavier; it is as warm as the inner body.
    """

    lubricant = Lubricant()

    share_oil = Parameter(
        "1", "share of oil in the air about it", nominal=1e-3, optional=True, at_least=0.0, at_most=0.1
    )

    def has(self, name: str) -> bool:
        """The oil is that of a mist."""
        return name != "lubricant" or "share_oil" in self.told

    def torque(self) -> Num:
        """Windage torque of one gear [N.m]."""
        windage = windage_torque(self.shaft.w, self.r, self.b, self.m_n)
        if "share_oil" not in self.told:
            return windage
        return windage * mist_factor(self.lubricant.rho, SEA_LEVEL / (R_AIR * self.inner.T), self.share_oil)


class MeshSqueezing(GearInFluid):
    """Oil that the teeth of a mesh squeeze out of each other's spaces, on the shaft of one of the two gears.

    Its `inner` body is the oil. How full the spaces come into the mesh is given: all where the mesh is flooded, little
    where oil is injected behind it.
    """

    lubricant = Lubricant()

    r_mate = Parameter("m", "pitch radius of the mating gear, negative for a ring", nominal=0.1)
    fill = Parameter("1", "share of the tooth spaces that is oil where they enter the mesh", at_least=0.0, at_most=1.0)
    backlash = Parameter("m", "normal backlash", nominal=1e-4, default=0.0, at_least=0.0)

    def relations(self) -> Iterator[Related]:
        """Two gears mesh: outside each other, or the mate is a larger ring."""
        yield require(self, "the mate is a gear or a larger ring", 1 + self.r / self.r_mate, 1e-3, 100.0)

    def torque(self) -> Num:
        """Torque of one mesh [N.m]."""
        oil, sizes = self.lubricant, (self.r, self.r_mate, self.b, self.m_n, self.backlash)
        return squeezing_torque(self.shaft.w, oil.rho, oil.nu, self.fill, *sizes)
