"""Plain bearings: oil film and mixed friction of a journal."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from ..core.component import Equation, equation
from ..core.declare import Output, Parameter
from ..laws.journal import film_torque, petrov_torque, solid_share
from ..laws.smooth import Num, smooth_magnitude
from .friction import Friction
from .ports import BearingLoad, Lubricant


class PlainBearing(Friction):
    """Plain journal bearing full of oil: a film under load, mixed friction below its transition speed.

    The film has the temperature of the lubricant: in a fast bearing it is warmer, and its friction less.
    """

    role: ClassVar[str] = "bearing"

    load = BearingLoad()
    lubricant = Lubricant()

    r = Parameter("m", "radius of the journal", nominal=0.03, above=0.0)
    b = Parameter("m", "width of the bearing", nominal=0.05, above=0.0)
    psi = Parameter(
        "1", "relative clearance: of the diameters, over that of the journal", nominal=1e-3, above=0.0, below=0.1
    )
    F_r_0 = Parameter("N", "radial load of its own, e.g. a coupling", nominal=1000.0, at_least=0.0)
    mu_bl = Parameter("1", "friction of the solids in contact", nominal=0.1, at_least=0.0, at_most=1.0)
    C_trans = Parameter("1", "transition constant: 1 for a good surface, more for a better one", above=0.0)
    solid = Output("1", "share of the load that solids carry", nominal=0.1)

    def torque(self) -> Num:
        """Friction of film and solids of one bearing [N.m]."""
        w, F_r = self.shaft.w, self.F_r_0 + self.load.F_r
        eta_oil = self.lubricant.nu * self.lubricant.rho
        size = self.r, self.b, self.psi
        film = film_torque(petrov_torque(w, eta_oil, *size), F_r, w, eta_oil, *size)
        return film + self.solid * self.mu_bl * smooth_magnitude(F_r, 1.0) * self.r

    def equations(self) -> Iterator[Equation]:
        """The share of solids, then what every friction does."""
        oil, F_r = self.lubricant, self.F_r_0 + self.load.F_r
        share = solid_share(self.shaft.w, F_r, oil.nu * oil.rho, self.r, self.b, self.C_trans)
        yield equation("solids in contact", self.solid, share)
        yield from super().equations()
