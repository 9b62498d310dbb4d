"""Heat: where it is stored, how it flows between bodies, and how the room takes it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ..core.component import Component, Equation, equation
from ..core.declare import Input, Output, Parameter, State
from ..laws.conduction import fin_efficiency
from ..laws.convection import (
    forced_plate,
    mixed,
    natural_horizontal_cylinder,
    natural_horizontal_down,
    natural_horizontal_up,
    natural_vertical_plate,
)
from ..laws.radiation import radiated
from ..laws.smooth import Num
from .ports import AirPort, HeatPort


class HeatCapacity(Component):
    """A body of one temperature."""

    heat = HeatPort()

    T = State("K", "temperature", nominal=10.0, above=0.0, start=298.15)
    C = Parameter("J/K", "heat capacity", above=0.0)
    Q_flow_external = Input("W", "heat flow rate from outside the model, e.g. a cooler (negative)", nominal=100.0)

    def equations(self) -> Iterator[Equation]:
        """The port has the temperature of the body; heat that enters warms it."""
        yield equation("one temperature", self.heat.T, self.T)
        yield equation("storage", self.C * self.der("T"), self.heat.Q_flow + self.Q_flow_external)

    def stored_energy(self) -> Num:
        """Energy above 0 degC [J]."""
        return self.C * (self.T - 273.15)

    def supplied_power(self) -> Iterable[Num]:
        """The external heat flow."""
        return (self.Q_flow_external,)


class ThermalConductor(Component):
    """Heat flow proportional to a temperature difference."""

    a = HeatPort()
    b = HeatPort()

    G = Parameter("W/K", "thermal conductance", at_least=0.0)
    Q_flow = Output("W", "heat flow rate from a to b", nominal=100.0)

    def equations(self) -> Iterator[Equation]:
        """What enters at a leaves at b."""
        yield equation("conduction", self.Q_flow, self.G * (self.a.T - self.b.T))
        yield equation("enters at a", self.a.Q_flow, self.Q_flow)
        yield equation("leaves at b", self.b.Q_flow, -self.Q_flow)


class Room(Component):
    """The surroundings: air of a given temperature and speed, and a floor of the same temperature."""

    air = AirPort()
    floor = HeatPort()

    T = Input("K", "temperature of the room", nominal=10.0, above=0.0, start=298.15)
    air_speed = Input("m/s", "speed of the air along the housing", at_least=0.0)
    Q_flow = Output("W", "heat flow rate into the room", nominal=100.0)

    def equations(self) -> Iterator[Equation]:
        """The room keeps its temperature whatever it takes."""
        yield equation("air temperature", self.air.T, self.T)
        yield equation("air speed", self.air.v, self.air_speed)
        yield equation("floor temperature", self.floor.T, self.T)
        yield equation("heat to the room", self.Q_flow, self.air.Q_flow + self.floor.Q_flow)

    def supplied_power(self) -> Iterable[Num]:
        """What the room takes, counted as supply."""
        return (-self.Q_flow,)


class SurfaceCooling(Component):
    """A warm surface in a room: free and forced convection and radiation, over one effective area."""

    surface = HeatPort()
    air = AirPort()

    A = Parameter("m2", "effective outer area", above=0.0)
    height = Parameter("m", "height of the vertical faces", above=0.0)
    length = Parameter("m", "length of the surface along the flow of the air", above=0.0)
    emissivity = Parameter("1", "emissivity of the surface", at_least=0.0, at_most=1.0)
    h = Output("W/(m2.K)", "convective heat transfer coefficient", nominal=10.0)
    Q_flow_convection = Output("W", "heat flow rate by convection", nominal=100.0)
    Q_flow_radiation = Output("W", "heat flow rate by radiation", nominal=100.0)

    def natural(self) -> Num:
        """Heat transfer coefficient of free convection, mean over the faces [W/(m2.K)]."""
        return natural_vertical_plate(self.surface.T, self.air.T, self.height)

    def convecting_area(self) -> Num:
        """Area that convects [m2]; what radiates is `A`."""
        return self.A

    def equations(self) -> Iterator[Equation]:
        """Convection and radiation side by side."""
        T_film = (self.surface.T + self.air.T) / 2
        forced = forced_plate(self.air.v, T_film, self.length)
        dT = self.surface.T - self.air.T
        yield equation("heat transfer coefficient", self.h, mixed(self.natural(), forced))
        yield equation("convection", self.Q_flow_convection, self.h * self.convecting_area() * dT)
        radiation = radiated(self.surface.T, self.air.T, self.A, self.emissivity)
        yield equation("radiation", self.Q_flow_radiation, radiation)
        yield equation("leaves the surface", self.surface.Q_flow, self.Q_flow_convection + self.Q_flow_radiation)
        yield equation("enters the room", self.air.Q_flow, -self.surface.Q_flow)


class BoxCooling(SurfaceCooling):
    """A box: vertical faces, a top and a bottom."""

    share_top = Parameter("1", "share of the area that faces upwards", at_least=0.0, at_most=1.0)
    share_bottom = Parameter("1", "share of the area that faces downwards", at_least=0.0, at_most=1.0)

    def natural(self) -> Num:
        """Mean of vertical, upward and downward faces by area."""
        T, T_air, L = self.surface.T, self.air.T, self.length
        upward = self.share_top * natural_horizontal_up(T, T_air, L)
        downward = self.share_bottom * natural_horizontal_down(T, T_air, L)
        vertical = (1 - self.share_top - self.share_bottom) * natural_vertical_plate(T, T_air, self.height)
        return vertical + upward + downward


class CylinderCooling(SurfaceCooling):
    """A lying cylinder with two vertical end faces; `height` is its diameter."""

    share_ends = Parameter("1", "share of the area that belongs to the end faces", at_least=0.0, at_most=1.0)

    def natural(self) -> Num:
        """Mean of shell and end faces by area."""
        T, T_air = self.surface.T, self.air.T
        shell = natural_horizontal_cylinder(T, T_air, self.height)
        return (1 - self.share_ends) * shell + self.share_ends * natural_vertical_plate(T, T_air, self.height)


class FinnedBoxCooling(BoxCooling):
    """A box with straight fins: they add convecting area, not radiating area."""

    A_fins = Parameter("m2", "surface of the fins, both sides", at_least=0.0)
    fin_height = Parameter("m", "height of a fin", above=0.0)
    fin_thickness = Parameter("m", "thickness of a fin", above=0.0)
    k_fin = Parameter("W/(m.K)", "thermal conductivity of the fins", above=0.0)

    def convecting_area(self) -> Num:
        """Bare area and fins, the fins by their efficiency."""
        return self.A + self.A_fins * fin_efficiency(self.h, self.k_fin, self.fin_thickness, self.fin_height)
