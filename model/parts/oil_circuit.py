"""The oil circuit: sumps, pump, filter, nozzles and cooler, joined by what flows and the enthalpy it carries.

Enthalpy is c_p times the temperature above 0 degC. The whole power of the pump warms the oil in the pump; in truth a
share of it, 0.06 K per bar, does so where the pressure falls. All flows of one circuit are of one oil.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import ClassVar

import casadi as ca

from ..core.component import Component, Equation, Faults, equation
from ..core.declare import Choice, Output, Parameter
from ..laws.dry_sump import fling_off, jet_torque
from ..laws.oil_circuit import (
    M_WIDTH,
    carried_enthalpy,
    laminar_pressure,
    orifice_flow,
    pump_loss_torque,
    pump_slip,
    stream_conductance,
)
from ..laws.smooth import Num, friction_sign, smooth_positive, smooth_sign
from .lubrication import OilBath
from .ports import Flange, HeatPort, Lubricant, OilPort, Opening

#: Temperature [K] at which the enthalpy is zero.
T_ZERO = 273.15
#: Power [W] of a pump below which its efficiency fades.
P_REST = 1.0
#: Mass flow rate [kg/s] that counts as round-off of a circuit.
ROUND_OFF = 1e-9


class OilSump(OilBath):
    """The oil of a housing in a circuit: a bath of constant mass, with which the oil that comes in mixes.

    One sump of a circuit, the tank, is open at inlet and outlet. Every other one runs over: what comes in drives out
    as much, into a return line or to a scavenge pump that could take more.
    """

    heat = HeatPort(must_meet=False)
    inlet = OilPort("where oil comes back: returns, jets, other sumps")
    outlet = OilPort("where oil leaves: to the pumps, or what runs over to another sump")

    runs_over = Choice((False, True), "whether the oil that comes in drives out as much", default=False)
    m_flow_gain = Output(
        "kg/s",
        "oil that comes in less what leaves",
        nominal=0.1,
        at_least=-ROUND_OFF,
        at_most=ROUND_OFF,
        refusal="its oil would change by {m_flow_gain}. Lead all oil back to where it is from: let the other sumps run "
        "over (runs_over = true), and connect their outlets.",
    )

    def equations(self) -> Iterator[Equation]:
        """Oil comes in without pressure, and leaves with the temperature of the bath."""
        inlet, outlet = self.inlet, self.outlet
        yield equation("inlet in the air", inlet.p, 0.0)
        if self.runs_over:
            yield equation("runs over", outlet.m_flow, -inlet.m_flow)
        else:
            yield equation("outlet in the air", outlet.p, 0.0)
        yield equation("gain", self.m_flow_gain, inlet.m_flow + outlet.m_flow)
        h = self.c_p * (self.T - T_ZERO)
        yield equation("carried in", inlet.H_flow, carried_enthalpy(inlet.m_flow, inlet.h, h))
        yield equation("carried out", outlet.H_flow, carried_enthalpy(outlet.m_flow, outlet.h, h))
        yield from super().equations()

    def heating(self) -> Num:
        """What the circuit brings as well."""
        return super().heating() + self.inlet.H_flow + self.outlet.H_flow


class OilLine(Component):
    """Base of what oil flows through, from a to b or back."""

    a = OilPort("where oil enters at a positive flow")
    b = OilPort("where it leaves")

    m_flow = Output("kg/s", "mass flow rate from a to b", nominal=0.1)

    def resistance(self) -> Equation:
        """What flow and pressures have to do with each other."""
        return equation("no pressure lost", self.a.p, self.b.p)

    def heating(self) -> Num:
        """What the oil takes up on its way [W]."""
        return 0.0

    def entering(self, c_p: Num) -> Num:
        """Temperature of the oil as it enters, from either side [K]."""
        a, b = self.a, self.b
        return T_ZERO + (a.h + b.h + smooth_sign(self.m_flow, M_WIDTH) * (a.h - b.h)) / (2 * c_p)

    def equations(self) -> Iterator[Equation]:
        """What enters at a leaves at b, with what it took up."""
        a, b = self.a, self.b
        yield equation("enters at a", a.m_flow, self.m_flow)
        yield equation("leaves at b", b.m_flow, -self.m_flow)
        yield self.resistance()
        yield equation("carried in", a.H_flow, carried_enthalpy(self.m_flow, a.h, b.h))
        yield equation("carried out", b.H_flow, -a.H_flow - self.heating())


class OilPump(OilLine):
    """A positive-displacement pump on a shaft; all its power goes into the oil.

    It turns backwards as well, and moves its oil against any pressure: the bypass of a filter keeps it low in the cold.
    What leaks back through its gaps stays in the pump with its heat: it takes from the efficiency, not from the heat.
    """

    role: ClassVar[str] = "pump"
    faults: ClassVar[Faults] = {
        "cooling.oil_flow": {"eta_v": 1.0},
        "losses.pump_power": {"eta_m": -1.0},
        "losses.pump_leak": {"C_s": 1.0},
    }

    shaft = Flange(must_meet=True)
    lubricant = Lubricant()

    V_disp = Parameter("m3", "displacement per revolution", nominal=1e-5, above=0.0)
    eta_v = Parameter("1", "volumetric efficiency", above=0.0, at_most=1.0)
    eta_m = Parameter("1", "mechanical efficiency", above=0.0, at_most=1.0)
    C_s = Parameter("1", "slip coefficient: oil that leaks back inside", default=0.0, at_least=0.0)
    dp = Output("Pa", "pressure that it adds", nominal=1e5)
    P = Output("W", "power from the shaft into the oil", nominal=100.0)
    eta = Output(
        "1",
        "efficiency: hydraulic power, less what leaks back, over power; 0 at rest, or driven by the oil",
    )

    def resistance(self) -> Equation:
        """The flow follows the speed."""
        volume = self.eta_v * self.V_disp * self.shaft.w / (2 * math.pi)
        return equation("oil moved", self.m_flow, self.lubricant.rho * volume)

    def heating(self) -> Num:
        """The power of the shaft."""
        return self.P

    def equations(self) -> Iterator[Equation]:
        """The torque of pressure and friction, then the flow."""
        D, w = self.V_disp / (2 * math.pi), self.shaft.w
        friction = pump_loss_torque(self.dp, D, self.eta_m) * friction_sign(w)
        yield equation("pressure", self.dp, self.b.p - self.a.p)
        yield equation("torque", self.shaft.tau, D * self.dp + friction)
        yield equation("power", self.P, self.shaft.tau * w)
        oil = self.lubricant
        used = self.m_flow / oil.rho - pump_slip(self.dp, D, oil.nu * oil.rho, self.C_s)
        yield equation("efficiency", self.eta, ca.fmax(self.dp * used, 0.0) * self.P / (self.P**2 + P_REST**2))
        yield from super().equations()


class OilFilter(OilLine):
    """A filter, or a pipe: a pressure loss in proportion to flow and viscosity, up to that of its bypass valve."""

    faults: ClassVar[Faults] = {"cooling.oil_flow": {"dp_ref": -1.0}}

    lubricant = Lubricant()

    dp_ref = Parameter("Pa", "pressure lost at the reference flow and viscosity", nominal=1e5, above=0.0)
    m_flow_ref = Parameter("kg/s", "reference mass flow rate", nominal=0.1, above=0.0)
    nu_ref = Parameter("m2/s", "reference viscosity", nominal=1e-4, above=0.0)
    p_bypass = Parameter("Pa", "largest pressure difference, at which the bypass is open", nominal=3e5, above=0.0)

    def resistance(self) -> Equation:
        """Thick oil takes the bypass."""
        R = self.dp_ref / (self.nu_ref * self.m_flow_ref)
        dp = laminar_pressure(self.m_flow, self.lubricant.nu, R, self.p_bypass)
        return equation("pressure lost", self.a.p - self.b.p, dp)


class OilNozzle(OilLine):
    """A nozzle or an orifice: nozzles at one line share its flow by their areas.

    The oil falls into a sump: connect `b` with its inlet. Where the jet cools a gear, an OilExchanger lies between.
    """

    faults: ClassVar[Faults] = {"cooling.oil_flow": {"d": 0.5}}

    lubricant = Lubricant()

    d = Parameter("m", "diameter of the orifice", nominal=2e-3, above=0.0)
    C_d = Parameter("1", "discharge coefficient, 0.6 with a sharp edge", above=0.0, at_most=1.0)

    def resistance(self) -> Equation:
        """The pressure drives the jet."""
        return equation("jet", self.m_flow, orifice_flow(self.a.p - self.b.p, self.lubricant.rho, self.d, self.C_d))


class GearJet(OilNozzle):
    """A nozzle whose jet plays on the teeth of a gear: it cools them, and the shaft brings its oil to speed.

    The jet leaves the line as through an orifice and falls off the gear into the sump: connect `b` with its inlet. Oil
    that returns from the sump does neither.
    """

    shaft = Flange(must_meet=True)
    wall = HeatPort()

    r = Parameter("m", "pitch radius of the gear", nominal=0.1, above=0.0)
    height = Parameter("m", "height of its teeth, over which a film is flung off", nominal=5e-3, above=0.0)
    A = Parameter("m2", "area of the flanks on which the jet plays", nominal=0.02, at_least=0.0)
    along = Parameter(
        "1", "cosine of the angle between jet and pitch line; 1: along a positive rotation", at_least=-1.0
    )
    c_p = Parameter("J/(kg.K)", "specific heat of the oil, that of its sump", nominal=2000.0, above=0.0)
    P = Output("W", "power from the shaft into the oil; negative: the jet drives the gear", nominal=100.0)
    Q_flow = Output("W", "heat flow rate from the oil to the gear", nominal=1000.0)

    def heating(self) -> Num:
        """What shaft and teeth give."""
        return self.P - self.Q_flow

    def equations(self) -> Iterator[Equation]:
        """Momentum and heat, then what every nozzle does."""
        oil, w, m_flow = self.lubricant, self.shaft.w, smooth_positive(self.m_flow, M_WIDTH)
        v_jet = m_flow / (oil.rho * self.C_d * math.pi / 4 * self.d**2)
        Pr = oil.nu * oil.rho * self.c_p / oil.k
        G = self.A * fling_off(w, oil.rho, self.c_p, oil.k, Pr, self.height, self.r)
        dT = self.entering(self.c_p) - self.wall.T
        yield equation("momentum", self.shaft.tau, jet_torque(m_flow, w * self.r - self.along * v_jet, self.r))
        yield equation("power", self.P, self.shaft.tau * w)
        yield equation("heat to the gear", self.Q_flow, stream_conductance(m_flow, self.c_p, G) * dT)
        yield equation("enters the gear", self.wall.Q_flow, -self.Q_flow)
        yield from super().equations()


class OilExchanger(OilLine):
    """Oil along a wall of one temperature: the water or air of a cooler, a heater, a gear or bearing under a jet.

    A thermostat lets only a share of the oil pass the wall; the rest goes round it and mixes behind it.
    """

    role: ClassVar[str] = "conductor"
    scale: ClassVar[tuple[str, ...]] = ("G",)
    faults: ClassVar[Faults] = {"cooling.cooler": {"G": 1.0}}

    wall = HeatPort()
    opening = Opening()

    thermostat = Choice((False, True), "whether a Thermostat opens it", default=False)
    G = Parameter("W/K", "conductance between oil and wall, heat transfer coefficient times area", 100.0, at_least=0.0)
    c_p = Parameter("J/(kg.K)", "specific heat of the oil, that of its sump", nominal=2000.0, above=0.0)
    Q_flow = Output("W", "heat flow rate from the oil to the wall", nominal=1000.0)
    T_b = Output("K", "temperature of the oil at b", nominal=350.0)

    def has(self, name: str) -> bool:
        """It is open unless a thermostat opens it."""
        return name != "opening" or bool(self.choices["thermostat"])

    def heating(self) -> Num:
        """What the wall gives."""
        return -self.Q_flow

    def equations(self) -> Iterator[Equation]:
        """The oil comes to the wall as it enters, from either side."""
        share = self.opening.share if self.thermostat else 1.0
        dT = self.entering(self.c_p) - self.wall.T
        yield equation("heat to the wall", self.Q_flow, stream_conductance(share * self.m_flow, self.c_p, self.G) * dT)
        yield equation("temperature at b", self.T_b, T_ZERO + self.b.h / self.c_p)
        yield equation("enters the wall", self.wall.Q_flow, -self.Q_flow)
        yield from super().equations()
