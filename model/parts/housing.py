"""The housing of a round reducer: flat walls and a cylinder side by side, from the lubricant to the air.

The housing knows its sizes and tells them to what carries heat to it and away from it, so that a thicker wall changes
conduction, inner area and inner heat transfer together.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import ClassVar

from ..core.component import SOUND, Component, Equation, Faults, Related, equation
from ..core.declare import Output, Parameter
from ..laws.conduction import cylinder_wall, plane_wall
from ..laws.convection import (
    flat_wall_coefficient,
    forced_cylinder,
    forced_plate,
    mixed,
    natural_horizontal_cylinder,
    natural_vertical_plate,
    nusselt_hilpert,
)
from ..laws.radiation import radiated, radiation_coefficient
from ..laws.smooth import V_WIDTH, Num, smooth_abs
from .ports import AirPort, HeatPort, WallSize
from .relations import require


class RoundHousing(Component):
    """Flat end walls and a cylindrical wall of one thickness and material; heat flows outwards through both.

    The outer dimensions are given and stay what they are when the thickness changes: a thicker wall leaves less room
    inside, R_i = R_o - d. So a change of thickness shows the wall and not a larger outer surface, and the cylinder is
    treated as the flat walls, whose outer area is given as well. `circumference` is the share of the circumference
    that takes part in the heat transfer at either side; conduction takes all of it.
    """

    role: ClassVar[str] = "conductor"
    scale: ClassVar[tuple[str, ...]] = ("k",)
    faults: ClassVar[Faults] = SOUND

    flat_inner = HeatPort()
    flat_outer = HeatPort()
    cylinder_inner = HeatPort()
    cylinder_outer = HeatPort()
    flat_inside = WallSize()
    flat_outside = WallSize()
    cylinder_inside = WallSize()
    cylinder_outside = WallSize()

    d = Parameter("m", "wall thickness", nominal=0.01, above=0.0)
    k = Parameter("W/(m.K)", "thermal conductivity of the wall", nominal=10.0, above=0.0)
    A_flat_inner = Parameter("m2", "inner area of the flat walls", nominal=0.1, above=0.0)
    A_flat_outer = Parameter("m2", "outer area of the flat walls", nominal=0.1, above=0.0)
    height = Parameter("m", "height of the flat walls", nominal=0.1, above=0.0)
    R_o = Parameter("m", "outer radius of the cylinder", nominal=0.1, above=0.0)
    L = Parameter("m", "length of the cylinder", nominal=0.1, above=0.0)
    circumference = Parameter("1", "share of the circumference that takes part", above=0.0, at_most=1.0)
    A_cylinder_inner = Output("m2", "inner area of the cylinder that takes part", nominal=0.1)
    A_cylinder_outer = Output("m2", "outer area of the cylinder that takes part", nominal=0.1)
    Q_flow_flat = Output("W", "heat flow rate through the flat walls", nominal=100.0)
    Q_flow_cylinder = Output("W", "heat flow rate through the cylinder", nominal=100.0)

    def relations(self) -> Iterator[Related]:
        """A thick wall leaves a hollow cylinder."""
        yield require(self, "d leaves room inside", self.d / self.R_o, high=0.95)

    def conductances(self) -> tuple[Num, Num]:
        """Of the flat walls and of the cylinder [W/K]."""
        flat = plane_wall(self.k, (self.A_flat_inner + self.A_flat_outer) / 2, self.d)
        return flat, cylinder_wall(self.k, self.L, self.R_o - self.d, self.R_o)

    def conductance(self) -> Num:
        """Of both side by side [W/K]."""
        return sum(self.conductances())

    def conduction(self) -> Iterator[Equation]:
        """Both walls side by side."""
        flat, shell = self.conductances()
        for key, flow, G, inner, outer in (
            ("flat walls", self.Q_flow_flat, flat, self.flat_inner, self.flat_outer),
            ("cylinder", self.Q_flow_cylinder, shell, self.cylinder_inner, self.cylinder_outer),
        ):
            yield equation(f"conduction of the {key}", flow, G * (inner.T - outer.T))
            yield equation(f"enters the {key}", inner.Q_flow, flow)
            yield equation(f"leaves the {key}", outer.Q_flow, -flow)

    def equations(self) -> Iterator[Equation]:
        """Conduction, and the sizes of all sides."""
        yield from self.conduction()
        length = 2 * math.pi * self.circumference * self.L
        yield equation("inner area", self.A_cylinder_inner, length * (self.R_o - self.d))
        yield equation("outer area", self.A_cylinder_outer, length * self.R_o)
        for key, side, A, L in (
            ("flat inside", self.flat_inside, self.A_flat_inner, self.height),
            ("flat outside", self.flat_outside, self.A_flat_outer, self.height),
            ("cylinder inside", self.cylinder_inside, self.A_cylinder_inner, 2 * (self.R_o - self.d)),
            ("cylinder outside", self.cylinder_outside, self.A_cylinder_outer, 2 * self.R_o),
        ):
            yield equation(f"area told, {key}", side.A, A)
            yield equation(f"length told, {key}", side.L, L)


class OilToHousing(Component):
    """Heat transfer from the lubricant to the walls of a round housing, by one coefficient."""

    role: ClassVar[str] = "conductor"
    scale: ClassVar[tuple[str, ...]] = ("h",)
    faults: ClassVar[Faults] = {"cooling.oil_wall": {}}

    oil = HeatPort()
    flat = HeatPort()
    cylinder = HeatPort()
    flat_inside = WallSize()
    cylinder_inside = WallSize()

    h = Parameter("W/(m2.K)", "heat transfer coefficient from the lubricant to the walls", nominal=100.0, above=0.0)
    Q_flow = Output("W", "heat flow rate into the walls", nominal=100.0)

    def equations(self) -> Iterator[Equation]:
        """Each wall takes its share."""
        yield equation(
            "into the flat walls", self.flat.Q_flow, -self.h * self.flat_inside.A * (self.oil.T - self.flat.T)
        )
        shell = self.h * self.cylinder_inside.A * (self.oil.T - self.cylinder.T)
        yield equation("into the cylinder", self.cylinder.Q_flow, -shell)
        yield equation("into both", self.Q_flow, -self.flat.Q_flow - self.cylinder.Q_flow)
        yield equation("out of the lubricant", self.oil.Q_flow, self.Q_flow)


class WallCooling(Component):
    """Base of a housing wall in a room: convection and radiation over the area that the housing tells."""

    role: ClassVar[str] = "surface"
    scale: ClassVar[tuple[str, ...]] = ("k_conv",)

    surface = HeatPort()
    air = AirPort()
    size = WallSize()

    emissivity = Parameter("1", "emissivity of the surface", at_least=0.0, at_most=1.0)
    k_conv = Parameter("1", "factor on the convection, 1 for the law as it is", default=1.0, at_least=0.0)
    h = Output("W/(m2.K)", "convective heat transfer coefficient", nominal=10.0)
    Q_flow_convection = Output("W", "heat flow rate by convection", nominal=100.0)
    Q_flow_radiation = Output("W", "heat flow rate by radiation", nominal=100.0)

    def coefficient(self) -> Num:
        """Convective heat transfer coefficient [W/(m2.K)]."""
        raise AttributeError(f"{type(self).__name__} has no shape")

    def radiation(self) -> Num:
        """Heat flow rate by radiation [W]."""
        return radiated(self.surface.T, self.air.T_radiant, self.size.A, self.emissivity)

    def equations(self) -> Iterator[Equation]:
        """Convection and radiation side by side."""
        yield equation("heat transfer coefficient", self.h, self.k_conv * self.coefficient())
        convection = self.h * self.size.A * (self.surface.T - self.air.T)
        yield equation("convection", self.Q_flow_convection, convection)
        yield equation("radiation", self.Q_flow_radiation, self.radiation())
        yield equation("leaves the surface", self.surface.Q_flow, self.Q_flow_convection + self.Q_flow_radiation)
        yield equation("enters the room", self.air.Q_flow, -self.surface.Q_flow)


class FlatWallCooling(WallCooling):
    """Vertical flat walls: free and forced convection at the film temperature of the moment."""

    def coefficient(self) -> Num:
        """Plate along the air."""
        T, T_air, L, p = self.surface.T, self.air.T, self.size.L, self.air.p
        return mixed(natural_vertical_plate(T, T_air, L, p=p), forced_plate(self.air.v, (T + T_air) / 2, L, p=p))


class ShellCooling(WallCooling):
    """The shell of a lying cylinder: free and forced convection at the film temperature of the moment."""

    def coefficient(self) -> Num:
        """Cylinder across the air."""
        T, T_air, D, p = self.surface.T, self.air.T, self.size.L, self.air.p
        return mixed(
            natural_horizontal_cylinder(T, T_air, D, p=p), forced_cylinder(self.air.v, (T + T_air) / 2, D, p=p)
        )


class LinearWallCooling(WallCooling):
    """Base of cooling that is proportional to the temperature difference: radiation linearised at two temperatures."""

    T_1 = Parameter("K", "temperature of the surface at which radiation is linearised", nominal=100.0, above=0.0)
    T_2 = Parameter("K", "temperature of the room at which radiation is linearised", nominal=100.0, above=0.0)
    h_radiation = Output("W/(m2.K)", "radiated heat over area and temperature difference", nominal=10.0)

    def radiation(self) -> Num:
        """Linear in the temperature difference."""
        return self.h_radiation * self.size.A * (self.surface.T - self.air.T_radiant)

    def equations(self) -> Iterator[Equation]:
        """Both coefficients do without the temperatures of the moment."""
        yield from super().equations()
        yield equation(
            "radiation coefficient", self.h_radiation, radiation_coefficient(self.T_1, self.T_2, self.emissivity)
        )


class LinearFlatWallCooling(LinearWallCooling):
    """Flat walls with a coefficient of the air speed alone."""

    def coefficient(self) -> Num:
        """By the square root of the speed."""
        return flat_wall_coefficient(self.air.v)


class LinearShellCooling(LinearWallCooling):
    """The shell of a cylinder across air of given properties."""

    k_air = Parameter("W/(m.K)", "thermal conductivity of the air", nominal=0.01, above=0.0)
    nu_air = Parameter("m2/s", "kinematic viscosity of the air", nominal=1e-5, above=0.0)
    Pr_air = Parameter("1", "Prandtl number of the air", above=0.0)

    def coefficient(self) -> Num:
        """By Hilpert's table."""
        D = self.size.L
        Re = smooth_abs(self.air.v, V_WIDTH) * D / self.nu_air
        return nusselt_hilpert(Re, self.Pr_air) * self.k_air / D
