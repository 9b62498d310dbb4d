"""What makes a drum of a gearbox: partly filled with oil, turning in the air, a belt round it; motors and fans."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import ClassVar

import casadi as ca

from ..core.component import SOUND, Component, Equation, Faults, equation
from ..core.declare import Choice, Output, Parameter
from ..laws.convection import mixed
from ..laws.drum import cooling_area, forced_rotating_cylinder, gear_churning_loss, motor_loss, source_coefficient
from ..laws.pad import fill_arc, fill_volume_share
from ..laws.smooth import SPEED_WIDTH, V_WIDTH, Num, smooth_abs
from .friction import Friction
from .lubrication import MOTION, OilBath
from .motors import SuppliedMotor
from .ports import AirPort, BearingLoad, Flange, Lubricant, OilLevel, ShaftReading
from .thermal import Conductor, CylinderCooling

#: Torque of the drum [N.m] below which the pull of its belt is rounded.
TAU_WIDTH = 0.1


class DrumOil(OilBath):
    """The oil of a partly filled drum on its side; its volume follows from how much of the drum it wets."""

    scale: ClassVar[tuple[str, ...]] = ("L",)

    level = OilLevel()

    in_motion = Choice((False,), "its level does not move", default=False)
    beta = Parameter("1", "wetted over dry area of the drum's inside; 1 is half full", above=0.0, at_most=1.0)
    r = Parameter("m", "inner radius of the drum", nominal=0.1, above=0.0)
    L = Parameter("m", "length of the drum that holds oil, less what motor and gear displace", above=0.0)
    V = Parameter(
        "m3",
        "volume of oil at 15 degC",
        nominal=1e-3,
        above=0.0,
        derived=lambda p: math.pi * p.r**2 * p.L * fill_volume_share(p.beta),
    )

    def has(self, name: str) -> bool:
        """What a drum wets takes the place of a height."""
        return name not in ("sump", *MOTION)

    def equations(self) -> Iterator[Equation]:
        """An oil bath that tells its level."""
        yield from super().equations()
        yield equation("wetted share", self.level.share, fill_arc(self.beta) / (2 * math.pi))


class DrumChurning(Friction):
    """Churning of what turns in the oil of a drum, whatever the load. Its `inner` body is the oil."""

    role: ClassVar[str] = "churning"

    lubricant = Lubricant()
    level = OilLevel()

    r = Parameter("m", "pitch radius of what turns in the oil", nominal=0.05, above=0.0)
    b = Parameter("m", "width that dips", nominal=0.02, at_least=0.0)
    z = Parameter("1", "number of teeth of both gears together", nominal=100.0, above=0.0, whole=True)
    share_dip = Parameter("1", "wetted share of the drum at which it dips as the law means", above=0.0, at_most=1.0)

    def torque(self) -> Num:
        """Churning torque [N.m]: the law's power over the speed, in proportion to what the oil wets."""
        w = self.shaft.w
        power = gear_churning_loss(w * self.r, self.b, self.lubricant.nu, self.z, v_width=SPEED_WIDTH * self.r)
        return power / smooth_abs(w) * self.level.share / self.share_dip


class WettedWall(Conductor):
    """Heat transfer between the oil of a drum and the part of a wall that it wets."""

    scale: ClassVar[tuple[str, ...]] = ("h",)

    level = OilLevel()

    h = Parameter("W/(m2.K)", "heat transfer coefficient between oil and wall", nominal=100.0, at_least=0.0)
    A = Parameter("m2", "area of the whole wall", above=0.0)

    def conductance(self) -> Num:
        """Of the wetted part."""
        return self.h * self.A * self.level.share


class BeltContact(Conductor):
    """Conduction from a drum (a) to the belt that runs over it, which leaves at the temperature of b or warmer."""

    scale: ClassVar[tuple[str, ...]] = ("h",)

    h = Parameter("W/(m2.K)", "heat transfer coefficient to the belt, 0 without one", nominal=10.0, at_least=0.0)
    A = Parameter("m2", "area that the heat transfer coefficient counts for", above=0.0)
    dT_belt = Parameter("K (difference)", "belt warmer than b", nominal=10.0)

    def conductance(self) -> Num:
        """Of the contact."""
        return self.h * self.A

    def difference(self) -> Num:
        """To the belt."""
        return super().difference() - self.dT_belt


class BeltPull(Component):
    """What a belt does to the bearings of the drum it runs over: the pull of both its ends, shared by two bearings."""

    faults: ClassVar[Faults] = SOUND

    reading = ShaftReading(must_meet=True)
    load = BearingLoad()

    D = Parameter("m", "diameter of the drum", above=0.0)
    k_pull = Parameter("1", "pull of both ends of the belt over the difference of their pulls", at_least=1.0)

    def equations(self) -> Iterator[Equation]:
        """The difference of the pulls is what turns the belt."""
        pull = 2 * smooth_abs(self.reading.tau, TAU_WIDTH) / self.D
        yield equation("radially", self.load.F_r, self.k_pull * pull / 2)
        yield equation("axially", self.load.F_a, 0.0)


class DrumCooling(CylinderCooling):
    """A drum that turns in the air: free convection, its own rotation, the air of the room, and radiation.

    With `coefficient` "source" it is the printed formula for a drum with its belt, over the printed area, and nothing
    else: for comparison with the source, not for use. The drag of the air on the drum is left out.
    """

    shaft = Flange(must_meet=True)

    coefficient = Choice(
        ("rotating cylinder", "source"),
        "rotating cylinder: convection and radiation of a bare drum; source: the printed K, belt included",
        default="rotating cylinder",
    )
    P_N = Parameter("W", "rated power of the motor, as the printed K counts it", nominal=1000.0, above=0.0)
    psi_1 = Parameter("1", "share of its heat that the covered shell passes on to the belt", at_least=0.0, at_most=1.0)
    psi_2 = Parameter("1", "share of the shell that the oil inside keeps warm", at_least=0.0, at_most=1.0)
    A_belt = Parameter("m2", "area of the shell under the belt", at_least=0.0)

    def has(self, name: str) -> bool:
        """What the printed formula needs counts with it only."""
        printed = self.choices["coefficient"] == "source"
        return printed or name not in ("P_N", "psi_1", "psi_2", "A_belt")

    def forced(self, T_film: Num) -> Num:
        """Rotation and moving air side by side; ends like the shell."""
        return mixed(super().forced(T_film), forced_rotating_cylinder(self.shaft.w, T_film, self.D, p=self.air.p))

    def equations(self) -> Iterator[Equation]:
        """Those of a cylinder, or the printed formula."""
        yield equation("air takes no torque", self.shaft.tau, 0.0)
        if self.coefficient == "source":
            yield from self._printed()
        else:
            yield from super().equations()

    def _printed(self) -> Iterator[Equation]:
        """One coefficient over one area."""
        T, T_air, end = self.surface.T, self.air.T, self.A * self.share_ends / 2
        S = cooling_area(end, end, self.A - 2 * end, self.A_belt, self.psi_1, self.psi_2)
        h = self.k_conv * source_coefficient(self.P_N, self.D, self.shaft.w * self.D / 2)
        yield equation("heat transfer coefficient", self.h, h)
        yield equation("convection", self.Q_flow_convection, self.h * S * (T - T_air))
        yield equation("radiation", self.Q_flow_radiation, 0.0)
        yield equation("leaves the surface", self.surface.Q_flow, self.Q_flow_convection)
        yield equation("enters the room", self.air.Q_flow, -self.surface.Q_flow)


class Motor(SuppliedMotor):
    """Losses of an electric motor whose rotor is a shaft end: they come from the supply, beside the shaft's power.

    Speed and torque are read at the shaft end, whichever of them is given there. At the rated point the efficiency is
    `eta`; elsewhere it follows from a loss of the speed, which heats the stator, and one of the torque, which heats
    the windings. A motor that is driven (a loaded belt that runs down) feeds back what is left.
    """

    P_N = Parameter("W", "rated power of the shaft", nominal=1000.0, above=0.0)
    w_N = Parameter("rad/s", "rated speed", nominal=100.0, above=0.0)
    eta = Parameter("1", "efficiency at the rated point", above=0.0, below=1.0)
    speed_share = Parameter("1", "share of the rated loss that depends on the speed alone", at_least=0.0, at_most=1.0)
    speed_exponent = Parameter("1", "exponent of the speed in that loss", above=0.0, at_most=3.0)
    P_electric = Output("W", "power from the supply; negative: fed back", nominal=1000.0)
    P_loss = Output("W", "loss of the motor", nominal=100.0, at_least=0.0)
    P_loss_stator = Output("W", "loss of the speed: iron, fan, friction", nominal=100.0, at_least=0.0)
    P_loss_windings = Output("W", "loss of the load: copper", nominal=100.0, at_least=0.0)

    def equations(self) -> Iterator[Equation]:
        """The supply gives what the shaft takes and what is lost."""
        w, tau = self.shaft.w, self.shaft.tau
        rated = (self.P_N, self.w_N, self.eta, self.speed_share, self.speed_exponent)
        stator, windings = motor_loss(w, tau, *rated)
        yield equation("loss of the speed", self.P_loss_stator, stator)
        yield equation("loss of the load", self.P_loss_windings, windings)
        yield from super().equations()


class ShaftFan(Component):
    """A fan on a shaft: it moves the air that cools a surface, in proportion to its speed, and heats the room.

    It stands between the room and the surface's cooling. By the affinity laws of fans the speed of the air grows with
    that of the shaft, the torque with its square; a draught of the room adds as at right angles.
    """

    role: ClassVar[str] = "fan"

    shaft = Flange(must_meet=True)
    room = AirPort("the air of the room, from which it draws")
    air = AirPort("the air over the surface that it cools")

    k_v = Parameter("m", "speed of the air over the surface at 1 rad/s, in m/s", nominal=0.02, at_least=0.0)
    k = Parameter("N.m.s2", "torque at 1 rad/s", nominal=1e-5, at_least=0.0)
    v = Output("m/s", "speed of the air over the surface", nominal=1.0)
    P_loss = Output("W", "power of the fan", nominal=10.0, at_least=0.0)

    def equations(self) -> Iterator[Equation]:
        """The air is moved, its heat passed on with the fan's own."""
        w = self.shaft.w
        yield equation("torque", self.shaft.tau, self.k * w * smooth_abs(w))
        yield equation("power", self.P_loss, self.shaft.tau * w)
        moved = ca.sqrt(self.room.v**2 + (self.k_v * w) ** 2 + V_WIDTH**2)
        yield equation("speed of the air", self.v, moved)
        yield equation("speed told", self.air.v, self.v)
        yield equation("temperature told", self.air.T, self.room.T)
        yield equation("pressure told", self.air.p, self.room.p)
        yield equation("radiant temperature told", self.air.T_radiant, self.room.T_radiant)
        yield equation("heat passes on", self.room.Q_flow, -self.air.Q_flow - self.P_loss)
