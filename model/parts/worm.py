"""Worm gears: a screw that turns a wheel, and may or may not be turned by it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import ClassVar

import casadi as ca

from ..core.component import Component, Equation, equation
from ..core.declare import Choice, Output, Parameter
from ..laws.smooth import Num, friction_sign, smooth_abs, smooth_magnitude, smooth_sign
from ..laws.worm import (
    lead_angle,
    worm_base_friction,
    worm_efficiency,
    worm_film_parameter,
    worm_friction,
    worm_geometry_factor,
    worm_locking,
    worm_loss_torque,
    worm_mean_friction,
    worm_normal_force,
    worm_radial_force,
    worm_roughness_factor,
    worm_size_factor,
    worm_tangential_force,
)
from .ports import Flange, HeatPort, Lubricant, ToothForce


class WormPair(Component):
    """A cylindrical worm of steel and a bronze wheel on crossed shafts at a right angle.

    `friction` is that of AGMA for mineral oils times the lubricant factor of the oil, which is this project's own
    reading for other oils, or that of DIN 3996 by oil, size, geometry, wheel and roughness. The torque at the wheel
    decides the force: a wheel that drives has to overcome the friction, and where `locking` is above 1 it cannot; the
    worm then takes torque in either direction of the load.
    """

    role: ClassVar[str] = "teeth"
    scale: ClassVar[tuple[str, ...]] = ("k_mu",)
    axes: ClassVar[str] = "crossed"

    gears = HeatPort()
    lubricant = Lubricant()
    worm = Flange()
    wheel = Flange()
    worm_force = ToothForce()
    wheel_force = ToothForce()

    z_1 = Parameter("1", "number of starts of the worm", above=0.0, whole=True)
    z_2 = Parameter("1", "number of teeth of the wheel", above=0.0, whole=True)
    m_x = Parameter("m", "axial module of the worm", nominal=1e-3, above=0.0)
    d_1 = Parameter("m", "mean diameter of the worm", nominal=0.05, above=0.0)
    alpha_n = Parameter("rad", "normal pressure angle", nominal=0.3, above=0.0, below=1.0)
    friction = Choice(
        ("AGMA6034", "DIN3996"), "friction number: by sliding speed, or also by oil and size", default="AGMA6034"
    )
    b = Parameter("m", "face width of the wheel, for DIN3996", above=0.0, derived=lambda p: 0.75 * (p.d_1 + 2 * p.m_x))
    Ra = Parameter("m", "mean roughness of the worm's flanks, for DIN3996", nominal=1e-6, above=0.0, default=0.5e-6)
    Y_W = Parameter("1", "material factor of the wheel, for DIN3996: 1 for bronze CuSn12", above=0.0, default=1.0)
    k_mu = Parameter("1", "factor on the tooth friction", at_least=0.0)
    tau_width = Parameter("N.m", "torque below which the direction of load is blurred", default=0.1, above=0.0)
    tau_loss = Output("N.m", "friction torque of the mesh, on the worm", nominal=1.0, at_least=0.0, guess=0.0)
    P_loss = Output("W", "mesh loss", nominal=100.0, at_least=0.0)
    mu = Output("1", "tooth friction coefficient", nominal=0.1)
    v_slide = Output("m/s", "sliding speed of the flanks")
    F_t = Output("N", "tangential force on the wheel, the axial one on the worm", nominal=1000.0)
    gamma = Output("rad", "lead angle at the mean diameter of the worm", nominal=0.1)
    locking = Output("1", "friction over that from which on the wheel cannot drive")
    eta_mesh = Output("1", "efficiency of the mesh, below zero where it locks")

    def sizes(self) -> Mapping[str, Num]:
        """Mean radius of the worm, pitch radius of the wheel."""
        return {"r_1": self.d_1 / 2, "r_2": self.m_x * self.z_2 / 2}

    def equations(self) -> Iterator[Equation]:
        """What enters at one shaft leaves at the other, less the friction of the sliding flanks."""
        w, ratio, gamma = self.worm.w, self.z_2 / self.z_1, lead_angle(self.z_1, self.m_x, self.d_1)
        sign, width = friction_sign(w), self.tau_width * ratio
        drive = sign * smooth_sign(self.wheel.tau, width)
        F_n = worm_normal_force(self.F_t, self.alpha_n, gamma, self.mu, drive)
        yield equation("the wheel follows the worm", self.wheel.w, -w / ratio)
        yield equation("torque less loss", self.wheel.tau / ratio, self.worm.tau - sign * self.tau_loss)
        yield equation("mesh loss", self.tau_loss, worm_loss_torque(F_n, self.mu, self.d_1, gamma))
        yield equation("mesh power", self.P_loss, self.tau_loss * sign * w)
        yield equation("sliding speed", self.v_slide, smooth_magnitude(w) * self.d_1 / (2 * ca.cos(gamma)))
        yield equation("tooth friction", self.mu, self.k_mu * self.friction_number())
        yield equation("lead angle", self.gamma, gamma)
        yield equation("locking", self.locking, worm_locking(self.mu, self.alpha_n, gamma))
        driven = ca.sign(w) * ca.sign(self.wheel.tau)
        yield equation("mesh efficiency", self.eta_mesh, worm_efficiency(self.locking, gamma, driven))
        yield equation("force on the wheel", self.F_t, 2 * smooth_abs(self.wheel.tau, width) / (self.m_x * self.z_2))
        yield from self._exchange_forces(F_n, gamma, drive)
        yield equation("loss heats the gears", self.gears.Q_flow, -self.P_loss)

    def friction_number(self) -> Num:
        """Of the normal force [1]."""
        if self.friction == "AGMA6034":
            return self.lubricant.X_L * worm_friction(self.v_slide)
        h_star = worm_film_parameter(self.z_1, self.z_2, self.m_x, self.d_1, self.b)
        Y = worm_size_factor((self.d_1 + self.m_x * self.z_2) / 2) * worm_geometry_factor(h_star)
        Y *= self.Y_W * worm_roughness_factor(self.Ra)
        return worm_mean_friction(worm_base_friction(self.v_slide, self.lubricant.X_L), Y, self.alpha_n)

    def _exchange_forces(self, F_n: Num, gamma: Num, drive: Num) -> Iterator[Equation]:
        """What is tangential on one gear is axial on the other."""
        F_t1 = worm_tangential_force(F_n, self.alpha_n, gamma, self.mu, drive)
        for name, force, F_t, F_a in (
            ("worm", self.worm_force, F_t1, self.F_t),
            ("wheel", self.wheel_force, self.F_t, F_t1),
        ):
            yield equation(f"tangential force on the {name}", force.F_t, F_t)
            yield equation(f"radial force on the {name}", force.F_r, worm_radial_force(F_n, self.alpha_n))
            yield equation(f"axial force on the {name}", force.F_a, F_a)
