"""Heat: where it is stored, how it flows between bodies, and how the room takes it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import ClassVar

from ..core.component import SOUND, Component, Equation, Faults, Related, equation
from ..core.declare import Input, Output, Parameter, State
from ..laws.conduction import cylinder_wall, fin_efficiency, plane_wall
from ..laws.convection import (
    SEA_LEVEL,
    air_pressure,
    forced_cylinder,
    forced_plate,
    mixed,
    natural_horizontal,
    natural_horizontal_cylinder,
    natural_vertical_plate,
)
from ..laws.radiation import absorbed_sun, radiated
from ..laws.smooth import Num
from .ports import COLDEST, HOTTEST, AirPort, HeatPort
from .relations import require


class HeatCapacity(Component):
    """A body of one temperature."""

    role: ClassVar[str] = "body"
    scale: ClassVar[tuple[str, ...]] = ("C",)

    heat = HeatPort()

    T = State("K", "temperature", nominal=10.0, at_least=COLDEST, at_most=HOTTEST, start=298.15)
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


class HeatPath(Component):
    """Base of all between two bodies that stores no heat."""

    a = HeatPort()
    b = HeatPort()

    Q_flow = Output("W", "heat flow rate from a to b", nominal=100.0)

    def equations(self) -> Iterator[Equation]:
        """What enters at a leaves at b."""
        yield equation("enters at a", self.a.Q_flow, self.Q_flow)
        yield equation("leaves at b", self.b.Q_flow, -self.Q_flow)


class Conductor(HeatPath):
    """Base of all that conducts: a heat flow proportional to a temperature difference."""

    role: ClassVar[str] = "conductor"

    def conductance(self) -> Num:
        """Thermal conductance [W/K]."""
        raise AttributeError(f"{type(self).__name__} has no conductance")

    def difference(self) -> Num:
        """Temperature difference that drives the heat [K]."""
        return self.a.T - self.b.T

    def equations(self) -> Iterator[Equation]:
        """What enters at a leaves at b."""
        yield equation("conduction", self.Q_flow, self.conductance() * self.difference())
        yield from super().equations()


class ThermalConductor(Conductor):
    """A conductance that is known as a whole."""

    scale: ClassVar[tuple[str, ...]] = ("G",)

    G = Parameter("W/K", "thermal conductance", at_least=0.0)

    def conductance(self) -> Num:
        """The given one."""
        return self.G


class PlaneWall(Conductor):
    """A plane wall."""

    scale: ClassVar[tuple[str, ...]] = ("k",)
    faults: ClassVar[Faults] = SOUND

    k = Parameter("W/(m.K)", "thermal conductivity", above=0.0)
    A = Parameter("m2", "area", above=0.0)
    d = Parameter("m", "thickness", nominal=0.01, above=0.0)

    def conductance(self) -> Num:
        """Of a plane wall."""
        return plane_wall(self.k, self.A, self.d)


class CylinderWall(Conductor):
    """A cylindrical wall, from inside (a) to outside (b)."""

    scale: ClassVar[tuple[str, ...]] = ("k",)
    faults: ClassVar[Faults] = SOUND

    k = Parameter("W/(m.K)", "thermal conductivity", above=0.0)
    L = Parameter("m", "length of the cylinder", above=0.0)
    r_i = Parameter("m", "inner radius", nominal=0.1, above=0.0)
    r_o = Parameter("m", "outer radius", nominal=0.1, above=0.0)

    def relations(self) -> Iterator[Related]:
        """The wall has a thickness."""
        yield require(self, "r_o is larger than r_i", self.r_o / self.r_i, 1 + 1e-6)

    def conductance(self) -> Num:
        """Of a cylindrical wall."""
        return cylinder_wall(self.k, self.L, self.r_i, self.r_o)


#: Room in which a gearbox still has oil [K]: that of the warmest oil of the laws, 150 degC.
HOTTEST_ROOM = 423.15


class Room(Component):
    """The surroundings: air of a given temperature and speed, and a floor of the same temperature.

    Walls and sky may be warmer or colder than the air, by `dT_radiant`: the sun and a furnace are, and a clear night.
    """

    role: ClassVar[str] = "room"

    air = AirPort(must_meet=False)
    floor = HeatPort(must_meet=False)

    T = Input("K", "temperature of the room", nominal=10.0, at_least=COLDEST, at_most=HOTTEST_ROOM, start=298.15)
    air_speed = Input("m/s", "speed of the air along the housing", at_least=0.0)
    k_air = Parameter("1", "factor on the speed of the air, 1 for the speed as given", default=1.0, at_least=0.0)
    altitude = Parameter("m", "height above sea level, where the air is thinner", 500.0, optional=True)
    dT_radiant = Parameter("K (difference)", "how much warmer than the air it radiates", 10.0, optional=True)
    Q_flow = Output("W", "heat flow rate into the room", nominal=100.0)

    def equations(self) -> Iterator[Equation]:
        """The room keeps its temperature whatever it takes."""
        yield equation("air temperature", self.air.T, self.T)
        yield equation("air speed", self.air.v, self.k_air * self.air_speed)
        p = air_pressure(self.altitude) if "altitude" in self.parameters else SEA_LEVEL
        yield equation("air pressure", self.air.p, p)
        T_radiant = self.T + self.dT_radiant if "dT_radiant" in self.parameters else self.T
        yield equation("radiant temperature", self.air.T_radiant, T_radiant)
        yield equation("floor temperature", self.floor.T, self.T)
        yield equation("heat to the room", self.Q_flow, self.air.Q_flow + self.floor.Q_flow)

    def supplied_power(self) -> Iterable[Num]:
        """What the room takes, counted as supply."""
        return (-self.Q_flow,)


class ClosedRoom(Room):
    """A room that warms: of a heat capacity, and cooled by what its floor is connected to."""

    scale: ClassVar[tuple[str, ...]] = ("C",)

    T = State("K", "temperature of the room", nominal=10.0, at_least=COLDEST, at_most=HOTTEST, start=298.15)
    C = Parameter("J/K", "heat capacity of its air, walls and what stands in it", nominal=1e5, above=0.0)

    def equations(self) -> Iterator[Equation]:
        """What the room takes warms it."""
        yield from super().equations()
        yield equation("storage", self.C * self.der("T"), self.Q_flow)

    def stored_energy(self) -> Num:
        """Energy above 0 degC [J]."""
        return self.C * (self.T - 273.15)

    def supplied_power(self) -> Iterable[Num]:
        """None: what it takes stays in the model."""
        return ()


class PrescribedTemperature(Component):
    """Something that keeps its temperature whatever heat it takes or gives, e.g. a thermostat or cooling water."""

    role: ClassVar[str] = "thermostat"

    heat = HeatPort()

    T = Input("K", "temperature", nominal=10.0, above=0.0, start=298.15)
    dT = Parameter("K (difference)", "how much warmer than given it keeps itself", nominal=1.0, default=0.0)
    Q_flow = Output("W", "heat flow rate it takes", nominal=100.0)

    def equations(self) -> Iterator[Equation]:
        """The temperature is given, the heat follows."""
        yield equation("temperature kept", self.heat.T, self.T + self.dT)
        yield equation("heat taken", self.Q_flow, self.heat.Q_flow)

    def supplied_power(self) -> Iterable[Num]:
        """What it takes, counted as supply."""
        return (-self.Q_flow,)


class PrescribedHeatFlow(Component):
    """Heat of a given rate, whatever the temperature: a heater, or what a model beside this one gives."""

    role: ClassVar[str] = "heater"

    heat = HeatPort()

    Q_flow = Input("W", "heat flow rate it gives", nominal=100.0)

    def equations(self) -> Iterator[Equation]:
        """The heat is given, the temperature follows."""
        yield equation("heat given", self.heat.Q_flow, -self.Q_flow)

    def supplied_power(self) -> Iterable[Num]:
        """What it gives."""
        return (self.Q_flow,)


class Sun(Component):
    """The sun on a housing: heat into a surface, whatever its temperature; what the surface radiates is its cooling's.

    The irradiance is an input, for a day's course. The sky that is colder than the air is the room's `dT_radiant`.
    """

    role: ClassVar[str] = "heater"

    surface = HeatPort()

    G = Input("W/m2", "irradiance by sun and sky on a plane across the rays", nominal=500.0, at_least=0.0)
    A = Parameter("m2", "area of the shadow of the surface on a plane across the rays", nominal=0.1, at_least=0.0)
    absorptivity = Parameter("1", "absorptivity of the surface for sunlight", at_least=0.0, at_most=1.0)
    Q_flow = Output("W", "heat flow rate that the surface takes", nominal=100.0)

    def equations(self) -> Iterator[Equation]:
        """What is absorbed enters the surface."""
        yield equation("heat absorbed", self.Q_flow, absorbed_sun(self.G, self.A, self.absorptivity))
        yield equation("heat given", self.surface.Q_flow, -self.Q_flow)

    def supplied_power(self) -> Iterable[Num]:
        """What it gives."""
        return (self.Q_flow,)


class SurfaceCooling(Component):
    """Base of warm surfaces in a room: free and forced convection and radiation, over one effective area."""

    role: ClassVar[str] = "surface"
    scale: ClassVar[tuple[str, ...]] = ("A",)

    surface = HeatPort()
    air = AirPort()

    A = Parameter("m2", "effective outer area", above=0.0)
    emissivity = Parameter("1", "emissivity of the surface", at_least=0.0, at_most=1.0)
    k_conv = Parameter("1", "factor on the convection, 1 for the law as it is", default=1.0, at_least=0.0)
    h = Output("W/(m2.K)", "convective heat transfer coefficient", nominal=10.0)
    Q_flow_convection = Output("W", "heat flow rate by convection", nominal=100.0)
    Q_flow_radiation = Output("W", "heat flow rate by radiation", nominal=100.0)

    def natural(self) -> Num:
        """Heat transfer coefficient of free convection, mean over the faces [W/(m2.K)]."""
        raise AttributeError(f"{type(self).__name__} has no faces")

    def forced(self, T_film: Num) -> Num:
        """Heat transfer coefficient of forced convection, mean over the faces [W/(m2.K)]."""
        raise AttributeError(f"{type(self).__name__} has no faces")

    def convecting_area(self) -> Num:
        """Area that convects [m2]; what radiates is `A`."""
        return self.A

    def equations(self) -> Iterator[Equation]:
        """Convection and radiation side by side."""
        T, T_air = self.surface.T, self.air.T
        h = self.k_conv * mixed(self.natural(), self.forced((T + T_air) / 2))
        yield equation("heat transfer coefficient", self.h, h)
        yield equation("convection", self.Q_flow_convection, self.h * self.convecting_area() * (T - T_air))
        yield equation("radiation", self.Q_flow_radiation, radiated(T, self.air.T_radiant, self.A, self.emissivity))
        yield equation("leaves the surface", self.surface.Q_flow, self.Q_flow_convection + self.Q_flow_radiation)
        yield equation("enters the room", self.air.Q_flow, -self.surface.Q_flow)


class BoxCooling(SurfaceCooling):
    """A box: vertical faces, a top and a bottom; the air flows along its length."""

    height = Parameter("m", "height of the box", above=0.0)
    length = Parameter("m", "length of the box", above=0.0)
    width = Parameter("m", "width of the box", above=0.0)
    share_top = Parameter("1", "share of the area that faces upwards", at_least=0.0, at_most=1.0)
    share_bottom = Parameter("1", "share of the area that faces downwards", at_least=0.0, at_most=1.0)

    def relations(self) -> Iterator[Related]:
        """Faces have no more than the whole area; the rest is vertical."""
        yield require(self, "the shares fit into one area", self.share_top + self.share_bottom, 0.0, 1.0)

    def natural(self) -> Num:
        """Mean of vertical, upward and downward faces by area."""
        T, T_air = self.surface.T, self.air.T
        L = self.length * self.width / (2 * (self.length + self.width))  # area over perimeter
        upward = self.share_top * natural_horizontal(T, T_air, L, up=True, p=self.air.p)
        downward = self.share_bottom * natural_horizontal(T, T_air, L, up=False, p=self.air.p)
        vertical = natural_vertical_plate(T, T_air, self.height, p=self.air.p)
        return (1 - self.share_top - self.share_bottom) * vertical + upward + downward

    def forced(self, T_film: Num) -> Num:
        """Plates along the air."""
        return forced_plate(self.air.v, T_film, self.length, p=self.air.p)


class CylinderCooling(SurfaceCooling):
    """A lying cylinder with two vertical end faces; the air flows across it."""

    D = Parameter("m", "diameter", above=0.0)
    share_ends = Parameter("1", "share of the area that belongs to the end faces", at_least=0.0, at_most=1.0)

    def natural(self) -> Num:
        """Mean of shell and end faces by area."""
        T, T_air = self.surface.T, self.air.T
        shell = natural_horizontal_cylinder(T, T_air, self.D, p=self.air.p)
        ends = natural_vertical_plate(T, T_air, self.D, p=self.air.p)
        return (1 - self.share_ends) * shell + self.share_ends * ends

    def forced(self, T_film: Num) -> Num:
        """Cylinder across the air, end faces along it."""
        shell = forced_cylinder(self.air.v, T_film, self.D, p=self.air.p)
        ends = forced_plate(self.air.v, T_film, self.D, p=self.air.p)
        return (1 - self.share_ends) * shell + self.share_ends * ends


class FinnedBoxCooling(BoxCooling):
    """A box with straight fins: they add convecting area, not radiating area."""

    scale: ClassVar[tuple[str, ...]] = ("A", "A_fins")

    A_fins = Parameter("m2", "surface of the fins, both sides", at_least=0.0)
    fin_height = Parameter("m", "height of a fin", nominal=0.01, above=0.0)
    fin_thickness = Parameter("m", "thickness of a fin", nominal=0.01, above=0.0)
    k_fin = Parameter("W/(m.K)", "thermal conductivity of the fins", above=0.0)

    def convecting_area(self) -> Num:
        """Bare area and fins, the fins by their efficiency."""
        return self.A + self.A_fins * fin_efficiency(self.h, self.k_fin, self.fin_thickness, self.fin_height)
