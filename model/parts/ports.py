"""The ports of the parts: three that carry power, the others carry information only."""

from __future__ import annotations

from typing import Any

from ..core.declare import Flow, Port, Potential

#: Lowest temperature of bodies, oils and rooms, -60 degC [K]: colder, oils are solid and their viscosity laws explode.
COLDEST = 213.15
#: Highest temperature of bodies, oils and rooms, 500 degC [K]: hotter, no lubricant, seal or heat treatment lasts, so
#: that a machine that overheats ends here and not at thousands of kelvins.
HOTTEST = 773.15


class HeatPort(Port):
    """Where heat crosses a boundary. Positive Q_flow enters the component that owns the port."""

    must_meet = True
    missing = "its heat has no way out"
    source = "the heat port of a body, a conductor or a room"
    instead = "put a ThermalConductor between them"
    levels = {"T": "a storage of heat (HeatCapacity, OilBath) or a Room"}

    T = Potential("K", "temperature", nominal=350.0)
    Q_flow = Flow("W", "heat flow rate", nominal=100.0)

    def power(self) -> Any:
        """Heat flow rate into the owner [W]."""
        return self.Q_flow


class AirPort(HeatPort):
    """A heat port to moving air: its temperature and speed are those far from the surface.

    What a surface radiates to has a temperature of its own: walls and sky are not always as warm as the air.
    """

    source = "the air of a Room"

    v = Potential("m/s", "speed of the air", nominal=1.0)
    p = Potential("Pa", "pressure of the air", nominal=1e5)
    T_radiant = Potential("K", "temperature of what the surface radiates to", nominal=300.0)


class Flange(Port):
    """End of a shaft. Positive tau acts on the component that owns the flange, in the direction of positive w."""

    missing = "no shaft is there"
    source = "the flange of a shaft end, a gear or an inertia"
    instead = "give a torque in place of a speed"
    divides = "put a LoadingClutch or a TorqueSplit into one way"

    w = Potential("rad/s", "angular velocity", nominal=10.0)
    tau = Flow("N.m", "torque", nominal=100.0)

    def power(self) -> Any:
        """Mechanical power into the owner [W]."""
        return self.w * self.tau


class OilPort(Port):
    """Where oil crosses a boundary and takes its enthalpy along. Positive flows enter the component that owns the port.

    All oil that leaves a net has the enthalpy `h` of the mixture that enters it, whatever the directions.
    """

    must_meet = True
    missing = "its oil comes from nowhere"
    source = "the inlet or outlet of an OilSump, or a part of its circuit"
    divides = "let one of two sumps run over (runs_over = true)"
    levels = {"p": "an OilSump", "h": "an OilSump"}

    p = Potential("Pa", "pressure above that of the air", nominal=1e5)
    h = Potential("J/kg", "specific enthalpy of the mixture, above 0 degC", nominal=1e5)
    m_flow = Flow("kg/s", "mass flow rate", nominal=0.1)
    H_flow = Flow("W", "enthalpy flow rate", nominal=1e4)

    def power(self) -> Any:
        """Enthalpy flow rate into the owner [W]."""
        return self.H_flow


class BearingLoad(Port):
    """What a bearing has to carry: information, not power."""

    missing = "nothing says which load it carries"
    source = "the load of a gear set or of a shaft support"

    F_r = Potential("N", "radial load", nominal=1000.0)
    F_a = Potential("N", "axial load", nominal=1000.0)


class OwnThrust(Port):
    """How a bearing with inclined contacts pushes the shaft along under a radial load: information, not power."""

    missing = "nothing says how the bearing pushes the shaft along"
    source = "the thrust of the bearing that is set against the other one"
    absent = "Choose how the bearings are set against each other, face-to-face or back-to-back."

    F = Potential("N", "thrust, towards the bearing set against it", nominal=1000.0)


class ToothForce(Port):
    """The force on a gear at the pitch point: information, not power.

    Of bevel gears, whose forces may point either way, F_r is positive towards the axis, F_a away from the apex.
    """

    missing = "nothing says which tooth force acts"
    source = "the force of a gear pair"

    F_t = Potential("N", "tangential force", nominal=1000.0)
    F_r = Potential("N", "radial force", nominal=1000.0)
    F_a = Potential("N", "axial force", nominal=1000.0)


class WallSize(Port):
    """Size of one side of a housing wall: information, not power."""

    missing = "nothing says how large the wall is"
    source = "the side of a RoundHousing"

    A = Potential("m2", "area that takes part in the heat transfer", nominal=0.1)
    L = Potential("m", "characteristic length: height of a flat wall, diameter of a round one", nominal=0.2)


class Lubricant(Port):
    """State of a lubricant where it is used: information, not power."""

    missing = "there is no lubricant"
    source = "the lubricant of an OilBath or a Grease"

    T = Potential("K", "temperature", nominal=350.0)
    nu = Potential("m2/s", "kinematic viscosity", nominal=1e-4)
    rho = Potential("kg/m3", "density", nominal=900.0)
    alpha_p = Potential("1/Pa", "pressure-viscosity coefficient", nominal=1e-8)
    beta_T = Potential("1/K", "temperature coefficient of the viscosity", nominal=0.03)
    k = Potential("W/(m.K)", "thermal conductivity", nominal=0.13)
    X_L = Potential("1", "lubricant factor of the tooth friction", nominal=0.8)


class OilLevel(Port):
    """How much of a turning drum the oil inside wets: information, not power."""

    missing = "nothing says how far the drum is filled"
    source = "the level of a DrumOil"

    share = Potential("1", "share of the drum's inside that the oil wets", nominal=0.4)


class Sump(Port):
    """How high the oil of a housing stands, how much of it there is, and what gears throw: no power.

    Positive Q_oil enters the component that owns the port.
    """

    missing = "nothing says how high the oil stands"
    source = "the sump of an OilBath with a level"
    absent = "Give the OilBath a level: the height of its surface above the datum of the housing."

    level = Potential("m", "height of the oil's surface above the datum of the housing", nominal=0.1)
    V = Potential("m3", "volume of oil", nominal=1e-3)
    share_air = Potential("1", "share of air in it", nominal=0.1)
    Q_oil = Flow("m3/s", "oil that is thrown", nominal=1e-3)


class Opening(Port):
    """How far a thermostat opens a cooler: information, not power."""

    missing = "nothing says how far it is open"
    source = "the opening of a Thermostat"

    share = Potential("1", "0 closed, 1 open", nominal=0.5)


class ShaftReading(Port):
    """Speed and torque read at a shaft end: information, not power."""

    missing = "nothing is read"
    source = "the reading of a shaft end"

    w = Potential("rad/s", "angular velocity", nominal=10.0)
    tau = Potential("N.m", "torque into the gearbox", nominal=100.0)
