"""Oil and grease: their temperature, and what it makes of their properties."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from math import inf, nextafter
from typing import ClassVar

from ..core.component import Component, Equation, Related, equation
from ..core.declare import Choice, Input, Output, Parameter, State
from ..laws.oil import (
    conductivity,
    density,
    kinematic_viscosity,
    pressure_viscosity,
    thermoviscosity,
    walther_constants,
)
from ..laws.oil_in_motion import held_volume
from ..laws.smooth import Num
from .ports import COLDEST, HOTTEST, HeatPort, Lubricant, Sump
from .relations import require

#: Parameters that say how a level moves.
MOTION = ("A_oil", "width", "height", "share_air")
#: Sides of a box.
SIDES = ("length", "width", "height")


class LubricantProperties(Component):
    """Properties of a lubricant at the temperature of its heat port."""

    heat = HeatPort()
    lubricant = Lubricant()

    nu_40 = Parameter("m2/s", "kinematic viscosity at 40 degC", nominal=1e-4, above=0.0)
    nu_100 = Parameter("m2/s", "kinematic viscosity at 100 degC", nominal=1e-5, above=0.0)
    rho_15 = Parameter("kg/m3", "density at 15 degC", nominal=900.0, above=0.0)
    alpha_T = Parameter("1/K", "relative change of density with temperature", nominal=1e-3, at_most=0.0)
    s_p = Parameter("1", "pressure-viscosity coefficient at 1 cSt, in 1/GPa", above=0.0)
    t_p = Parameter("1", "exponent of viscosity in the pressure-viscosity coefficient")
    X_L = Parameter("1", "lubricant factor of the tooth friction", above=0.0)
    nu = Output("m2/s", "kinematic viscosity", nominal=1e-4)

    def relations(self) -> Iterator[Related]:
        """A lubricant thins as it warms."""
        yield require(self, "nu_40 is above nu_100", self.nu_40 / self.nu_100, 1.01)

    def viscosity(self, T: Num) -> Num:
        """Kinematic viscosity [m2/s] at a temperature [K]."""
        return kinematic_viscosity(T, self.nu_40, self.nu_100)

    def properties(self) -> Iterator[Equation]:
        """What the users of the lubricant read."""
        T, out = self.heat.T, self.lubricant
        yield equation("viscosity", self.nu, self.viscosity(T))
        yield equation("temperature read", out.T, T)
        yield equation("viscosity read", out.nu, self.nu)
        yield equation("density", out.rho, density(T, self.rho_15, self.alpha_T))
        yield equation("pressure-viscosity", out.alpha_p, pressure_viscosity(self.nu, self.s_p, self.t_p))
        _, n = walther_constants(self.nu_40, self.nu_100)
        yield equation("thermoviscosity", out.beta_T, thermoviscosity(T, self.nu, n))
        yield equation("conductivity", out.k, conductivity(T, self.rho_15))
        yield equation("lubricant factor", out.X_L, self.X_L)


class OilBath(LubricantProperties):
    """The oil of a gearbox: a body of one temperature that lubricates.

    With a `level` it has a port `sump` that says how high the oil stands. Heights of a housing count from one datum,
    its bottom or an axis, for the oil and for all that dips. Oil `in_motion` stands lower by what the gears throw,
    until it has run down the walls again, and higher by the air in it.
    """

    role: ClassVar[str] = "bath"
    scale: ClassVar[tuple[str, ...]] = ("V",)

    sump = Sump()

    T = State("K", "temperature of the oil", nominal=10.0, at_least=COLDEST, at_most=HOTTEST, start=298.15)
    V = Parameter("m3", "volume of oil at 15 degC", nominal=1e-3, above=0.0)
    c_p = Parameter("J/(kg.K)", "specific heat", nominal=2000.0, above=0.0)
    T_pour = Parameter("K", "pour point, below it the oil does not flow; 0 K: not known", default=0.0, at_least=0.0)
    level = Parameter("m", "height of the oil's surface at rest above the datum of the housing", 0.1, optional=True)
    in_motion = Choice((False, True), "whether the level falls by what gears throw", default=False)
    A_oil = Parameter("m2", "surface of the oil", nominal=0.1, above=0.0)
    width = Parameter("m", "width of the walls along which thrown oil runs down", nominal=0.5, above=0.0)
    height = Parameter("m", "height of these walls above the oil", nominal=0.2, above=0.0)
    share_air = Parameter("1", "share of air in the oil that the gears stir", default=0.0, at_least=0.0, at_most=0.5)
    Q_flow_external = Input("W", "heat flow rate from outside the model, e.g. a cooler (negative)", nominal=100.0)

    def has(self, name: str) -> bool:
        """The level is told where it is given, and what moves it where it moves."""
        if name in MOTION:
            return bool(self.choices["in_motion"])
        return name != "sump" or "level" in self.told

    def viscosity(self, T: Num) -> Num:
        """Of an oil that flows."""
        return kinematic_viscosity(T, self.nu_40, self.nu_100, self.T_pour)

    def heating(self) -> Num:
        """Heat that enters [W]."""
        return self.heat.Q_flow + self.Q_flow_external

    def equations(self) -> Iterator[Equation]:
        """Heat that enters warms the oil."""
        yield equation("one temperature", self.heat.T, self.T)
        C = self.V * self.rho_15 * self.c_p
        yield equation("storage", C * self.der("T"), self.heating())
        if self.has("sump"):
            yield from self.standing()
        yield from self.properties()

    def clashes(self, met: Mapping[str, Sequence[Component]]) -> Iterator[str]:
        """A level that moves is given."""
        if self.in_motion and not self.has("sump"):
            yield f"{self.name} is in_motion and has no level. Give it: the height of its surface at rest."

    def relations_with(self, parts: Sequence[Component]) -> Iterator[Related]:
        """The oil stands below the top of the box that holds it; which one that is of several, nobody knows."""
        boxes = [part for part in parts if part.role == "surface" and {*SIDES} <= part.parameters.keys()]
        if "level" in self.told and len(boxes) == 1 and [part.role for part in parts].count(self.role) == 1:
            height = boxes[0].symbols["height"]
            relation, left = require(self, "level is below the top", height - self.level, nextafter(0.0, inf))
            yield replace(relation, parameters=(*relation.parameters, *boxes[0].follows_from(height))), left

    def standing(self) -> Iterator[Equation]:
        """How high it stands."""
        level, air, sump = self.level, 0.0, self.sump
        if self.in_motion:
            held = held_volume(-sump.Q_oil, self.nu, self.width, self.height)
            level += (self.V * self.share_air / (1 - self.share_air) - held) / self.A_oil
            air = self.share_air
        yield equation("level read", sump.level, level)
        yield equation("volume read", sump.V, self.V)
        yield equation("air read", sump.share_air, air)

    def stored_energy(self) -> Num:
        """Energy above 0 degC [J]."""
        return self.V * self.rho_15 * self.c_p * (self.T - 273.15)

    def supplied_power(self) -> Iterable[Num]:
        """The external heat flow."""
        return (self.Q_flow_external,)


class Grease(LubricantProperties):
    """Grease that takes the temperature of the body it is in; its own heat capacity is neglected.

    It has no pour point: the thickener holds it in place at any temperature, and its cold limit is a torque.
    """

    role: ClassVar[str] = "grease"

    def equations(self) -> Iterator[Equation]:
        """The body is sensed, not heated."""
        yield equation("body is sensed, not heated", self.heat.Q_flow, 0.0)
        yield from self.properties()
