"""Electric motors whose rotor is a shaft end: what they lose comes from the supply."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, ClassVar

from ..core.component import Component, Equation, Faults, equation
from ..core.declare import Output, Parameter
from ..laws.motor import winding_resistance
from ..laws.smooth import Num, friction_sign, smooth_abs
from .ports import HeatPort, ShaftReading


class SuppliedMotor(Component):
    """Base of motors: losses that heat stator and windings come from the supply, beside the shaft's power."""

    role: ClassVar[str] = "motor"

    shaft = ShaftReading(must_meet=True)
    windings = HeatPort()
    stator = HeatPort()

    # Outputs of each motor, with what they mean and how large they are there.
    P_electric: Any
    P_loss: Any
    P_loss_stator: Any
    P_loss_windings: Any

    def equations(self) -> Iterator[Equation]:
        """The supply gives what the shaft takes and what is lost."""
        yield equation("loss", self.P_loss, self.P_loss_stator + self.P_loss_windings)
        yield equation("power from the supply", self.P_electric, self.shaft.w * self.shaft.tau + self.P_loss)
        yield equation("loss of the stator heats it", self.stator.Q_flow, -self.P_loss_stator)
        yield equation("loss of the windings heats them", self.windings.Q_flow, -self.P_loss_windings)

    def supplied_power(self) -> Iterable[Num]:
        """What the supply gives beside the power of the shaft."""
        return (self.P_loss,)


class ServoMotor(SuppliedMotor):
    """Permanent-magnet or brushed motor whose rotor is a shaft end: a torque for each ampere, less its own drag.

    Speed and torque are read at the shaft end, whichever of them is given there; the drag (bearings, hysteresis and
    eddy currents of the iron) is overcome beside that torque and heats the stator. The current follows from both, and
    heats the windings. A motor that is driven feeds back what is left.
    """

    faults: ClassVar[Faults] = {
        "losses.motor_drag": {"tau_c": 1.0, "d": 1.0},
        "losses.motor_constant": {"k_T": 1.0},
        "losses.motor_windings": {"R_20": 1.0},
        "heat.external_source": {},
    }

    k_T = Parameter("N.m/A", "torque constant: torque of the rotor over the current", nominal=0.1, above=0.0)
    R_20 = Parameter("ohm", "loss of the windings over the square of that current, at 20 degC", nominal=1.0, above=0.0)
    tau_c = Parameter("N.m", "drag at any speed: hysteresis, bearings", nominal=0.01, at_least=0.0)
    d = Parameter("N.m.s", "drag by speed: eddy currents, grease", nominal=1e-4, at_least=0.0)
    i_q = Output("A", "current: q-axis, or that of the armature; negative: it brakes", nominal=1.0)
    tau_loss = Output("N.m", "drag torque", nominal=0.01, at_least=0.0)
    R = Output("ohm", "loss of the windings over the square of the current", nominal=1.0)
    P_electric = Output("W", "power from the supply; negative: fed back", nominal=100.0)
    P_loss = Output("W", "loss of the motor", nominal=10.0, at_least=0.0)
    P_loss_stator = Output("W", "power of the drag", nominal=10.0, at_least=0.0)
    P_loss_windings = Output("W", "loss of the windings", nominal=10.0, at_least=0.0)

    def equations(self) -> Iterator[Equation]:
        """Drag and torque of the rotor by the current, which heats the windings."""
        w, tau = self.shaft.w, self.shaft.tau
        yield equation("drag", self.tau_loss, self.tau_c + self.d * smooth_abs(w))
        drag = self.tau_loss * friction_sign(w)
        yield equation("current", self.i_q, (tau + drag) / self.k_T)
        yield equation("resistance", self.R, winding_resistance(self.R_20, self.windings.T))
        yield equation("power of the drag", self.P_loss_stator, drag * w)
        yield equation("loss of the windings", self.P_loss_windings, self.R * self.i_q**2)
        yield from super().equations()
