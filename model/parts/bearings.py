"""Rolling bearings: load, speed and lubricant make a friction torque."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from ..core.component import Equation, Related, equation
from ..core.declare import Choice, Output, Parameter
from ..laws.cylindrical import crb_rolling_variable, crb_sliding_variable
from ..laws.gear_churning import immersion
from ..laws.load_variables import (
    acb_rolling_variable,
    acb_sliding_variable,
    at_least,
    minimum_ball_load,
    srb_rolling_variable,
    srb_sliding_variable,
    thrust_ball_rolling_variable,
    thrust_ball_sliding_variable,
    thrust_roller_rolling_variable,
    thrust_roller_sliding_variable,
)
from ..laws.preload import axial_load_set_against, own_thrust
from ..laws.rolling import (
    boundary_share,
    dgb_rolling_variable,
    dgb_sliding_variable,
    drag_loss_factor,
    drag_torque_ball,
    drag_torque_roller,
    needle_torque_load,
    needle_torque_viscous,
    rolling_torque,
    shear_heating,
    sliding_friction,
    sliding_torque,
    starvation,
    starvation_exponent,
    trb_rolling_variable,
    trb_sliding_variable,
)
from ..laws.smooth import Num, smooth_abs
from .friction import Friction
from .ports import BearingLoad, Lubricant, OwnThrust, Sump
from .relations import require


class RollingBearing(Friction):
    """Base of the bearings: carries what the port `load` says, on top of loads of its own."""

    role: ClassVar[str] = "bearing"

    load = BearingLoad()
    lubricant = Lubricant()

    d_m = Parameter("m", "mean diameter, (d + D)/2", nominal=0.1, above=0.0)
    F_r_0 = Parameter("N", "radial load of its own, e.g. a coupling", nominal=1000.0, at_least=0.0)
    F_a_0 = Parameter("N", "axial load of its own, e.g. a preload", nominal=1000.0, at_least=0.0)

    def loads(self) -> tuple[Num, Num]:
        """Radial and axial load [N]."""
        return self.F_r_0 + self.load.F_r, self.F_a_0 + self.load.F_a

    def holds(self) -> int:
        """In how many directions along its axis the bearing holds a shaft: 0, 1 or 2."""
        return 2


class SkfBearing(RollingBearing):
    """Rolling and sliding moment with shear heating, starvation and mixed friction, and a drag moment."""

    sump = Sump()
    thrust = OwnThrust("how the bearing pushes the shaft along")

    d = Parameter("m", "bore diameter", nominal=0.1, above=0.0)
    D = Parameter("m", "outside diameter", nominal=0.1, above=0.0)
    d_m = Parameter("m", "mean diameter, (d + D)/2", nominal=0.1, above=0.0, derived=lambda p: 0.5 * (p.d + p.D))
    R_1 = Parameter("1", "first rolling constant of the catalogue", nominal=1e-6, above=0.0)
    R_2 = Parameter("1", "second rolling constant of the catalogue", above=0.0)
    S_1 = Parameter("1", "first sliding constant of the catalogue", nominal=1e-2, above=0.0)
    S_2 = Parameter("1", "second sliding constant of the catalogue", above=0.0)
    K_Z = Parameter("1", "geometry constant of the bearing type", above=0.0)
    K_rs = Parameter("1", "starvation constant of the lubrication, 0 without starvation", nominal=1e-8, at_least=0.0)
    mu_bl = Parameter("1", "sliding friction of the boundary film", nominal=0.1, at_least=0.0, at_most=1.0)
    mu_EHL = Parameter("1", "sliding friction of the full film", nominal=0.1, at_least=0.0, at_most=1.0)
    H = Parameter("m", "oil level above the lowest point of the outer raceway", nominal=0.01, at_least=0.0)
    height = Parameter(
        "m",
        "height of the axis above the datum of the housing, whose oil level takes the place of H",
        0.1,
        optional=True,
    )
    mixed_friction = Choice((True, False), "whether thin films raise the sliding friction", default=True)
    oil_bath = Choice((True, False), "whether the bearing stands in oil, and so drags", default=True)
    idle = Choice(
        ("load", "M_0"),
        "what moves a bearing under little load: the load alone, or at least Palmgren's moment M_0",
        default="load",
    )
    f_0 = Parameter("1", "factor of the moment M_0", above=0.0)
    tau_rr = Output("N.m", "rolling moment of one bearing")
    tau_sl = Output("N.m", "sliding moment of one bearing")
    mu_sl = Output("1", "sliding friction coefficient", nominal=0.1)

    def own_thrust(self) -> Num:
        """What the bearing pushes the shaft along with under its radial load [N]."""
        return 0.0

    def geometric_variables(self) -> tuple[Num, Num]:
        """Rolling and sliding variable of the catalogue, from the loads."""
        raise AttributeError(f"{type(self).__name__} has no geometric variables")

    def has(self, name: str) -> bool:
        """The oil level counts in an oil bath, H or that of the housing; boundary friction where films may be thin."""
        own, of_housing = self.oil_bath and not self.dips(), self.oil_bath and self.dips()
        counts = {"H": own, "V_M": own, "height": of_housing, "sump": of_housing, "mu_bl": self.mixed_friction}
        counts |= {"f_0": self.idle == "M_0"}
        return bool(counts.get(name, True))

    def dips(self) -> bool:
        """Whether the oil level of the housing says how deep the bearing dips."""
        return "height" in self.told

    def level(self) -> Num:
        """Oil level above the lowest point of the outer raceway [m]; rolling elements are 0.3 (D - d) thick."""
        if not self.dips():
            return self.H
        return immersion(self.sump.level, self.height, self.d_m / 2 + 0.15 * (self.D - self.d))

    def relations(self) -> Iterator[Related]:
        """The rings lie inside each other, the rolling elements between them, and the oil not above the bearing."""
        yield require(self, "D is larger than d", self.D / self.d, 1.02)
        middle = (self.d_m - self.d) / (self.D - self.d)
        yield require(self, "d_m lies between d and D", middle, 0.45, 0.55)
        if self.has("H"):
            yield require(self, "H is below D", self.H / self.D, 0.0, 1.0)

    def torque(self) -> Num:
        """Sum of the moments of one bearing [N.m]."""
        return self.tau_rr + self.tau_sl + (self.drag() if self.oil_bath else 0.0)

    def drag(self) -> Num:
        """Drag moment in an oil bath [N.m]."""
        raise AttributeError(f"{type(self).__name__} has no drag moment")

    def equations(self) -> Iterator[Equation]:
        """The moments, then what every friction does."""
        w, nu = self.shaft.w, self.lubricant.nu
        G_rr, G_sl = self.geometric_variables()
        phi_ish = shear_heating(w, nu, self.d_m)
        phi_rs = starvation(starvation_exponent(w, nu, self.d, self.D, self.K_rs, self.K_Z), phi_ish)
        mu_sl = self.mu_EHL
        if self.mixed_friction:
            mu_sl = sliding_friction(boundary_share(w, nu, self.d_m), self.mu_bl, self.mu_EHL)
        rolling = rolling_torque(G_rr, w, nu, phi_ish * phi_rs)
        if self.idle == "M_0":
            rolling = at_least(rolling, needle_torque_viscous(w, nu, self.d_m, self.f_0))
        if "thrust" in self.ports:
            yield equation("own thrust", self.thrust.F, self.own_thrust())
        yield equation("rolling moment", self.tau_rr, rolling)
        yield equation("sliding friction", self.mu_sl, mu_sl)
        yield equation("sliding moment", self.tau_sl, sliding_torque(G_sl, self.mu_sl))
        if self.has("sump"):
            yield equation("it throws no oil", self.sump.Q_oil, 0.0)
        yield from super().equations()


class InclinedBearing(SkfBearing):
    """Base of the bearings with inclined contacts: a radial load pushes the shaft along, against another bearing."""

    radial_thrust = Choice(("carried", "left out"), "whether a radial load makes thrust", default="carried")
    Y = Parameter("1", "axial load factor of the catalogue", above=0.0, below=10.0)

    def own_thrust(self) -> Num:
        """Thrust of the radial load [N]."""
        return own_thrust(super().loads()[0], self.Y) if self.radial_thrust == "carried" else 0.0

    def loads(self) -> tuple[Num, Num]:
        """Radial and axial load [N], the latter not below the bearing's own thrust."""
        F_r, F_a = super().loads()
        return F_r, axial_load_set_against(self.own_thrust(), F_a)

    def holds(self) -> int:
        """One by itself holds a shaft one way."""
        return 1 if self.values["count"] < 2 else 2


class RollerBearing(SkfBearing):
    """Base of the roller bearings: their drag in an oil bath."""

    B = Parameter("m", "width, over both rings", nominal=0.03, above=0.0)
    K_L = Parameter("1", "geometry constant of the roller bearing type", above=0.0)
    V_M = Parameter(
        "1",
        "drag loss factor of the oil level",
        nominal=1e-4,
        at_least=0.0,
        derived=lambda p: drag_loss_factor(p.H / p.d_m, roller=True),
    )

    def has(self, name: str) -> bool:
        """Width and roller constant count in an oil bath only."""
        return super().has(name) and (self.oil_bath or name not in ("B", "K_L"))

    def drag(self) -> Num:
        """Drag of rollers."""
        w, nu = self.shaft.w, self.lubricant.nu
        H = self.level()
        V_M = drag_loss_factor(H / self.d_m, roller=True) if self.dips() else self.V_M
        return drag_torque_roller(w, nu, self.d, self.D, self.B, H, V_M, self.K_Z, self.K_L)


class TaperedRollerBearing(InclinedBearing, RollerBearing):
    """Tapered roller bearing, single row."""

    def geometric_variables(self) -> tuple[Num, Num]:
        """Tapered roller bearing."""
        F_r, F_a = self.loads()
        rolling = trb_rolling_variable(F_r, F_a, self.d_m, self.R_1, self.R_2, self.Y)
        return rolling, trb_sliding_variable(F_r, F_a, self.d_m, self.S_1, self.S_2, self.Y)


class CylindricalRollerBearing(RollerBearing):
    """Cylindrical roller bearing with a cage, single row."""

    flanges = Choice(("both rings", "one ring"), "where: on both (NJ, NUP) they hold the shaft", default="both rings")

    def has(self, name: str) -> bool:
        """It has one rolling constant, and carries axial loads by its flanges."""
        return super().has(name) and name != "R_2" and (self.holds() > 0 or name not in ("F_a_0", "S_1"))

    def holds(self) -> int:
        """None without flanges on both rings."""
        return 2 if self.flanges == "both rings" else 0

    def geometric_variables(self) -> tuple[Num, Num]:
        """Cylindrical roller bearing."""
        F_r = self.F_r_0 + self.load.F_r
        F_a, S_1 = (self.F_a_0 + self.load.F_a, self.S_1) if self.holds() else (0.0, 0.0)
        rolling = crb_rolling_variable(F_r, self.d_m, self.R_1)
        return rolling, crb_sliding_variable(F_r, F_a, self.d_m, S_1, self.S_2)


class BallBearing(SkfBearing):
    """Base of the ball bearings: their drag in an oil bath."""

    V_M = Parameter(
        "1",
        "drag loss factor of the oil level",
        nominal=1e-4,
        at_least=0.0,
        derived=lambda p: drag_loss_factor(p.H / p.d_m),
    )

    def rows(self) -> Num:
        """Number of rows of balls [1]."""
        return 1.0

    def drag(self) -> Num:
        """Drag of balls."""
        H = self.level()
        V_M = drag_loss_factor(H / self.d_m) if self.dips() else self.V_M
        return drag_torque_ball(self.shaft.w, self.lubricant.nu, self.d, self.D, H, V_M, self.K_Z, self.rows())


class RadialBallBearing(BallBearing):
    """Base of the ball bearings that carry a radial load: the least that their maker asks for."""

    idle = Choice(
        ("load", "minimum load", "M_0"),
        "what brakes a bearing under little load: that load, at least its minimum load, or at least Palmgren's M_0",
        default="load",
    )
    k_r = Parameter("1", "minimum load factor of the catalogue", nominal=0.02, above=0.0, below=1.0)

    def has(self, name: str) -> bool:
        """The factor counts where the minimum load does."""
        return super().has(name) and (name != "k_r" or self.idle == "minimum load")

    def loads(self) -> tuple[Num, Num]:
        """Radial and axial load [N]."""
        F_r, F_a = super().loads()
        if self.idle == "minimum load":
            least = minimum_ball_load(self.shaft.w, self.lubricant.nu, self.d_m, self.k_r)
            F_r = at_least(smooth_abs(F_r, 1e-3), least)
        return F_r, F_a


class DeepGrooveBallBearing(RadialBallBearing):
    """Deep groove ball bearing, single row."""

    C_0 = Parameter("N", "basic static load rating", nominal=1e4, above=0.0)

    def geometric_variables(self) -> tuple[Num, Num]:
        """Deep groove ball bearing."""
        F_r, F_a = self.loads()
        rolling = dgb_rolling_variable(F_r, F_a, self.d_m, self.R_1, self.R_2, self.C_0)
        return rolling, dgb_sliding_variable(F_r, F_a, self.d_m, self.S_1, self.S_2, self.C_0)


class AngularContactBallBearing(InclinedBearing, RadialBallBearing):
    """Angular contact ball bearing, single or double row: fast balls press on its outer ring."""

    R_3 = Parameter("1", "third rolling constant of the catalogue", nominal=1e-12, at_least=0.0)
    S_3 = Parameter("1", "third sliding constant of the catalogue", nominal=1e-12, at_least=0.0)
    i_rw = Parameter("1", "number of rows of balls", default=1.0, at_least=1.0, at_most=2.0, whole=True)

    def rows(self) -> Num:
        """One or two."""
        return self.i_rw

    def own_thrust(self) -> Num:
        """Two rows are set against each other within the bearing."""
        return super().own_thrust() * (2 - self.i_rw)

    def holds(self) -> int:
        """Two rows hold a shaft both ways."""
        return max(super().holds(), int(self.values["i_rw"]))

    def geometric_variables(self) -> tuple[Num, Num]:
        """Angular contact ball bearing."""
        (F_r, F_a), w = self.loads(), self.shaft.w
        rolling = acb_rolling_variable(F_r, F_a, w, self.d_m, self.R_1, self.R_2, self.R_3)
        return rolling, acb_sliding_variable(F_r, F_a, w, self.d_m, self.S_1, self.S_2, self.S_3)


class SphericalRollerBearing(RollerBearing):
    """Spherical roller bearing, double row."""

    R_3 = Parameter("1", "third rolling constant of the catalogue", nominal=1e-6, above=0.0)
    R_4 = Parameter("1", "fourth rolling constant of the catalogue", above=0.0)
    S_3 = Parameter("1", "third sliding constant of the catalogue", nominal=1e-2, above=0.0)
    S_4 = Parameter("1", "fourth sliding constant of the catalogue", nominal=100.0, above=0.0)

    def geometric_variables(self) -> tuple[Num, Num]:
        """Spherical roller bearing."""
        F_r, F_a = self.loads()
        rolling = srb_rolling_variable(F_r, F_a, self.d_m, self.R_1, self.R_2, self.R_3, self.R_4)
        return rolling, srb_sliding_variable(F_r, F_a, self.d_m, self.S_1, self.S_2, self.S_3, self.S_4)


class ThrustBallBearing(BallBearing):
    """Thrust ball bearing, axial load only."""

    def has(self, name: str) -> bool:
        """It has one rolling and one sliding constant, and no radial load of its own."""
        return super().has(name) and name not in ("R_2", "S_2", "F_r_0", "thrust")

    def geometric_variables(self) -> tuple[Num, Num]:
        """Thrust ball bearing."""
        F_a = self.F_a_0 + self.load.F_a
        rolling = thrust_ball_rolling_variable(F_a, self.d_m, self.R_1)
        return rolling, thrust_ball_sliding_variable(F_a, self.d_m, self.S_1)


class CylindricalRollerThrustBearing(RollerBearing):
    """Cylindrical roller thrust bearing, axial load only: its rollers slide at their ends."""

    def has(self, name: str) -> bool:
        """It has one rolling and one sliding constant, and no radial load of its own."""
        return super().has(name) and name not in ("R_2", "S_2", "F_r_0", "thrust")

    def geometric_variables(self) -> tuple[Num, Num]:
        """Cylindrical roller thrust bearing."""
        F_a = self.F_a_0 + self.load.F_a
        rolling = thrust_roller_rolling_variable(F_a, self.d_m, self.R_1)
        return rolling, thrust_roller_sliding_variable(F_a, self.d_m, self.S_1)


class NeedleBearing(RollingBearing):
    """Needle roller and cage assembly, radial load only."""

    f_0 = Parameter("1", "factor of the viscous moment", above=0.0)
    f_1 = Parameter("1", "factor of the load moment", nominal=1e-4, above=0.0)

    def holds(self) -> int:
        """It carries no axial load."""
        return 0

    def torque(self) -> Num:
        """Viscous and load moment of one bearing [N.m]."""
        F_r, _ = self.loads()
        viscous = needle_torque_viscous(self.shaft.w, self.lubricant.nu, self.d_m, self.f_0)
        return viscous + needle_torque_load(F_r, self.d_m, self.f_1)
