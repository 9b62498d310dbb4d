"""Joints between bodies: what bolted faces, feet and rolling bearings conduct, from their geometry.

A conductance that is known as a whole is given as `G`, and the geometry is left out or does not count.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import ClassVar

from ..core.component import SOUND, Equation, Faults, Related, equation
from ..core.declare import Output, Parameter
from ..laws.conduction import (
    ball_bearing_conductance,
    contact_coefficient,
    fin_efficiency,
    half_space,
    plane_wall,
)
from ..laws.smooth import Num
from .ports import Flange
from .relations import require
from .thermal import Conductor

#: Preload of a bolt of class 8.8 tightened to nine tenths of its yield, over the square of its diameter [Pa].
PRELOAD = 296e6
#: Area that a bolt presses in the joint over the square of its diameter: out to 3 diameters, less its hole of 1.1 [1].
PRESSED = math.pi / 4 * (3.0**2 - 1.1**2)
#: Diameter of a ball of a deep groove ball bearing over D - d [1].
BALL = 0.3
#: Share of the pitch circle that the balls of a deep groove ball bearing fill: assembly by displacing the rings [1].
FILLED = 0.59
#: What joints of metal faces need to know of their surfaces.
METAL = ("k", "sigma", "m", "H")


def in_series(*conductances: Num) -> Num:
    """Conductance of several behind each other [W/K].

    Args:
        conductances: of each, above zero [W/K]
    """
    return 1 / sum(1 / G for G in conductances)


class JointConductor(Conductor):
    """Two faces that bolts press together, such as the flange of a motor: metal under the bolts, a gap beside them."""

    scale: ClassVar[tuple[str, ...]] = ("k_G",)
    #: Parameters that do not count where `G` is given.
    geometry: ClassVar[tuple[str, ...]] = (*METAL, "A", "count", "d", "p", "gap", "k_gap")

    A = Parameter("m2", "area of the faces that meet", nominal=0.01, above=0.0)
    count = Parameter("1", "number of bolts", at_least=0.0, whole=True)
    d = Parameter("m", "nominal diameter of a bolt", nominal=0.01, above=0.0)
    p = Parameter(
        "Pa",
        "pressure under the bolts, of class 8.8 where none is given",
        nominal=1e7,
        above=0.0,
        derived=lambda p: PRELOAD / PRESSED,
    )
    k = Parameter("W/(m.K)", "harmonic mean of the thermal conductivities of both faces", nominal=50.0, above=0.0)
    sigma = Parameter("m", "root mean square roughness of both faces together", nominal=1e-6, above=0.0)
    m = Parameter("1", "mean slope of both roughnesses", nominal=0.1, above=0.0)
    H = Parameter("Pa", "hardness of the softer face", nominal=1e9, above=0.0)
    gap = Parameter("m", "what keeps the faces apart beside the bolts: unevenness, paint, gasket", 1e-4, above=0.0)
    k_gap = Parameter("W/(m.K)", "thermal conductivity of what fills it", nominal=0.1, above=0.0)
    G = Parameter(
        "W/K", "thermal conductance, from the geometry where none is given", at_least=0.0, derived=lambda p: p.built()
    )
    k_G = Parameter("1", "factor on the conductance, 1 for G as it is", default=1.0, at_least=0.0)

    def has(self, name: str) -> bool:
        """The geometry counts where no conductance is given."""
        return not ("G" in self.told and name in self.geometry)

    def relations(self) -> Iterator[Related]:
        """The bolts press no more than the joint."""
        if self.has("A"):
            yield require(self, "the bolts fit the joint", self.pressed() / self.A, high=1.0)

    def pressed(self) -> Num:
        """Area under the bolts [m2]."""
        return self.count * PRESSED * self.d**2

    def built(self) -> Num:
        """Conductance from the geometry [W/K]."""
        metal = self.pressed() * contact_coefficient(self.p, self.k, self.sigma, self.m, self.H)
        return metal + plane_wall(self.k_gap, self.A - self.pressed(), self.gap)

    def conductance(self) -> Num:
        """The given one, or from the geometry."""
        return self.k_G * self.G


class FootConductor(JointConductor):
    """Foot of a machine on a concrete floor: its joint, and heat that spreads below its outline as below a disc.

    Far away the ground has the temperature of the room.
    """

    geometry: ClassVar[tuple[str, ...]] = (*JointConductor.geometry, "k_base", "A_base")

    k_base = Parameter("W/(m.K)", "thermal conductivity of the floor", nominal=1.0, above=0.0)
    A_base = Parameter("m2", "area of the outline of the foot", nominal=0.1, above=0.0)

    def built(self) -> Num:
        """The joint and the floor behind each other."""
        return in_series(super().built(), half_space(self.k_base, self.A_base))


class FrameConductor(JointConductor):
    """Foot of a machine on a plate or frame of steel, which gives the heat to the air of the room as a fin."""

    geometry: ClassVar[tuple[str, ...]] = (
        *JointConductor.geometry,
        "k_frame",
        "A_frame",
        "t_frame",
        "L_frame",
        "h_frame",
    )

    k_frame = Parameter("W/(m.K)", "thermal conductivity of the frame", nominal=50.0, above=0.0)
    A_frame = Parameter("m2", "area that gives heat to the air, both sides", nominal=0.1, above=0.0)
    t_frame = Parameter("m", "thickness of the frame", nominal=0.01, above=0.0)
    L_frame = Parameter("m", "how far the frame reaches beyond the foot", nominal=0.1, above=0.0)
    h_frame = Parameter("W/(m2.K)", "heat transfer coefficient of the frame, with radiation", nominal=10.0, above=0.0)

    def built(self) -> Num:
        """The joint and the frame behind each other."""
        share = fin_efficiency(self.h_frame, self.k_frame, self.t_frame, self.L_frame)
        return in_series(super().built(), self.h_frame * self.A_frame * share)


class BearingConductor(Conductor):
    """From a shaft (a) through a rolling bearing to the housing (b): press fit, balls, gap of the outer ring.

    Balls carry heat by their rolling; the shaft is read, not braked. Number and size of the balls follow from the rings
    of a deep groove ball bearing where none are given.
    """

    scale: ClassVar[tuple[str, ...]] = ("k_G",)
    faults: ClassVar[Faults] = SOUND

    shaft = Flange(must_meet=True)

    d = Parameter("m", "bore", nominal=0.05, above=0.0)
    D = Parameter("m", "outside diameter", nominal=0.1, above=0.0)
    d_m = Parameter("m", "mean diameter, (d + D)/2", nominal=0.1, above=0.0, derived=lambda p: 0.5 * (p.d + p.D))
    B = Parameter("m", "width of the rings", nominal=0.03, above=0.0)
    D_w = Parameter("m", "diameter of a ball", nominal=0.01, above=0.0, derived=lambda p: BALL * (p.D - p.d))
    Z = Parameter("1", "number of balls", 10.0, above=0.0, derived=lambda p: FILLED * math.pi * p.d_m / p.D_w)
    G_balls = Parameter("W/K", "from ring to ring; by the speed where none is given", 1.0, above=0.0, optional=True)
    p_fit = Parameter("Pa", "pressure of the press fit on the shaft", nominal=1e7, above=0.0)
    k = Parameter("W/(m.K)", "harmonic mean of the thermal conductivities of shaft and ring", nominal=50.0, above=0.0)
    sigma = Parameter("m", "root mean square roughness of shaft and bore together", nominal=1e-6, above=0.0)
    m = Parameter("1", "mean slope of both roughnesses", nominal=0.1, above=0.0)
    H = Parameter("Pa", "hardness of the shaft", nominal=1e9, above=0.0)
    gap = Parameter("m", "radial gap of the outer ring in the housing", nominal=1e-5, above=0.0)
    k_gap = Parameter("W/(m.K)", "thermal conductivity of what fills it", nominal=0.1, above=0.0)
    k_G = Parameter("1", "factor on the conductance, 1 for the law as it is", default=1.0, at_least=0.0)
    G = Output("W/K", "thermal conductance", nominal=1.0)

    def relations(self) -> Iterator[Related]:
        """Rings with balls between them."""
        yield require(self, "D is larger than d", self.D / self.d, 1.01)
        yield require(self, "a ball fits between the rings", 2 * self.D_w / (self.D - self.d), high=1.0)

    def built(self) -> Num:
        """Fit, rolling elements and gap behind each other [W/K]."""
        fit = math.pi * self.d * self.B * contact_coefficient(self.p_fit, *(getattr(self, key) for key in METAL))
        given = "G_balls" in self.told
        balls = self.G_balls if given else ball_bearing_conductance(self.shaft.w, self.Z, self.D_w, self.d_m)
        return in_series(fit, balls, plane_wall(self.k_gap, math.pi * self.D * self.B, self.gap))

    def conductance(self) -> Num:
        """That of the moment."""
        return self.G

    def equations(self) -> Iterator[Equation]:
        """The shaft is read, then what every conductor does."""
        yield equation("the shaft is read, not braked", self.shaft.tau, 0.0)
        yield equation("conductance", self.G, self.k_G * self.built())
        yield from super().equations()
