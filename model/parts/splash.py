"""Heat between the oil of a housing and what it wets: coefficients that follow speed, viscosity and temperature.

The properties are those of the oil at its own temperature. Free convection is what is left at rest.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from ..core.component import Equation, equation
from ..core.declare import Output, Parameter
from ..laws.convection import mixed
from ..laws.oil_convection import forced_disc_in_oil, forced_wall_in_oil, natural_wall_in_oil, speed_along_wall
from ..laws.smooth import Num
from .ports import Flange, Lubricant
from .thermal import Conductor


class OilSideConductor(Conductor):
    """Base of conductors from oil (a) to a body (b) whose coefficient follows the speed of a shaft, which it reads."""

    scale: ClassVar[tuple[str, ...]] = ("A",)

    shaft = Flange(must_meet=True)
    lubricant = Lubricant()

    A = Parameter("m2", "area that the oil wets", nominal=0.1, above=0.0)
    r = Parameter("m", "pitch radius of the gear on the shaft", nominal=0.1, above=0.0)
    c_p = Parameter("J/(kg.K)", "specific heat of the oil, that of its bath", nominal=2000.0, above=0.0)
    alpha_T = Parameter("1/K", "relative change of the oil's density with temperature", nominal=1e-3, at_most=0.0)
    h = Output("W/(m2.K)", "heat transfer coefficient", nominal=100.0)

    def height(self) -> Num:
        """Height of what free convection flows along [m]."""
        return 2 * self.r

    def forced(self, Pr: Num) -> Num:
        """Heat transfer coefficient that the speed brings [W/(m2.K)]."""
        raise AttributeError(f"{type(self).__name__} has no flow")

    def coefficient(self) -> Num:
        """Of free and forced convection together [W/(m2.K)]."""
        oil = self.lubricant
        Pr = oil.nu * oil.rho * self.c_p / oil.k
        free = natural_wall_in_oil(self.b.T, self.a.T, oil.nu, Pr, oil.k, -self.alpha_T, self.height())
        return mixed(free, self.forced(Pr))

    def conductance(self) -> Num:
        """The coefficient over the area."""
        return self.h * self.A

    def equations(self) -> Iterator[Equation]:
        """The shaft is read, then what every conductor does."""
        yield equation("the shaft is read, not braked", self.shaft.tau, 0.0)
        yield equation("heat transfer coefficient", self.h, self.coefficient())
        yield from super().equations()


class SplashConductor(OilSideConductor):
    """Oil that a gear throws along the walls of its housing: the coefficient follows speed and viscosity.

    The oil flows along a plate at a share of the pitch line speed, at most as fast as it would fall along the walls; at
    rest free convection is left. ISO/TR 14179-2 has 200 W/(m2.K) in its place. Connect `a` with the oil, `b` with the
    wall, `shaft` with that of the gear that throws most.
    """

    share = Parameter("1", "speed of thrown oil over that of the pitch line", at_least=0.0, at_most=1.0)
    L = Parameter("m", "height of the walls, along which the oil flows", nominal=0.3, above=0.0)

    def height(self) -> Num:
        """That of the walls."""
        return self.L

    def forced(self, Pr: Num) -> Num:
        """A plate in parallel flow."""
        oil, v = self.lubricant, speed_along_wall(self.share * self.shaft.w * self.r, self.L)
        return forced_wall_in_oil(v, oil.nu, Pr, oil.k, self.L)


class GearOilConductor(OilSideConductor):
    """Oil on a gear that dips: the coefficient follows speed and viscosity.

    The gear is a disc that turns in the oil; at rest free convection is left. The area is what comes out of the oil
    wet. Connect `a` with the oil, `b` with the gears, `shaft` with that of the gear.
    """

    def forced(self, Pr: Num) -> Num:
        """A disc that turns."""
        oil = self.lubricant
        return forced_disc_in_oil(self.shaft.w, oil.nu, Pr, oil.k, self.r)
