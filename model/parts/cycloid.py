"""Cycloidal reducers: pins in the housing, discs on an eccentric, output rollers in holes of the discs.

The discs turn against the input, and the output with them: w_in / w_out = -z_1 in one sense of rotation. The output
flange counts positive against the input, so that w_in / w_out = z_1 and a reducer has tau_in > 0 and tau_out < 0 at
positive speeds. The torque of the discs is that of the output shaft; each disc carries the same.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

import casadi as ca

from ..core.component import Component, Equation, Related, equation
from ..core.declare import Output, Parameter
from ..laws.cycloid import (
    bearing_loss_torque,
    eccentric_force,
    largest_roller_force,
    malhotra_efficiency,
    output_roller_power,
    pin_force_sum,
    ring_roller_power,
    roller_force_sum,
    roller_loss_torque,
)
from ..laws.cycloid_pin import greatest_curvature, pin_load, width_coefficient
from ..laws.film import film_from_reference, film_of_share, mixed_friction
from ..laws.smooth import Num, friction_sign, smooth_magnitude, smooth_sign
from .ports import Flange, HeatPort, Lubricant
from .relations import require

#: Torque at the output below which the loads of the discs are rounded [N.m]; they vanish with it.
TORQUE_WIDTH = 1e-4


class CycloidDrive(Component):
    """Base of cycloidal reducers: geometry, the forces of a disc, and the balance of power.

    The forces are means over a turn, each that of one disc.
    """

    role: ClassVar[str] = "teeth"
    scale: ClassVar[tuple[str, ...]] = ("mu_r1", "mu_r2", "mu_r3")

    input = Flange()
    output = Flange()
    heat = HeatPort()

    z_1 = Parameter("1", "number of lobes of a disc", nominal=10.0, at_least=2.0, whole=True)
    z_2 = Parameter("1", "number of pins in the housing", nominal=10.0, at_least=3.0, whole=True)
    n = Parameter("1", "number of discs, which share the torque", above=0.0, whole=True)
    e = Parameter("m", "eccentricity", nominal=1e-3, above=0.0)
    r = Parameter("m", "radius of the circle of pins", nominal=0.1, above=0.0)
    D_0 = Parameter("m", "outer diameter of the rollers on the pins", nominal=0.01, above=0.0)
    d_0 = Parameter("m", "diameter of the pins", nominal=0.01, above=0.0)
    u = Parameter("1", "number of output rollers", nominal=10.0, at_least=3.0, whole=True)
    R_0 = Parameter("m", "radius of the circle of output rollers", nominal=0.1, above=0.0)
    D_VK = Parameter("m", "outer diameter of the output rollers", nominal=0.01, above=0.0)
    d_VK = Parameter("m", "diameter of the pins of the output rollers", nominal=0.01, above=0.0)
    d_CZ = Parameter("m", "inner diameter of the rollers' path in a disc's bearing", nominal=0.01, above=0.0)
    D_CZ = Parameter("m", "outer diameter of the rollers' path in a disc's bearing", nominal=0.01, above=0.0)
    mu_r1 = Parameter(
        "1", "coefficient of rolling friction of the eccentric bearing", nominal=1e-3, at_least=0.0, at_most=1.0
    )
    mu_r2 = Parameter(
        "1", "coefficient of rolling friction of the output rollers", nominal=1e-3, at_least=0.0, at_most=1.0
    )
    mu_r3 = Parameter(
        "1", "coefficient of rolling friction of the rollers on the pins", nominal=1e-3, at_least=0.0, at_most=1.0
    )
    P_loss = Output("W", "friction power", nominal=100.0, at_least=0.0)
    tau_loss = Output("N.m", "friction torque, on the output", nominal=10.0, at_least=0.0, guess=0.0)
    F_N = Output("N", "sum of the forces between a disc and its pins", nominal=1000.0)
    F_K = Output("N", "sum of the forces between a disc and its output rollers", nominal=1000.0)
    F_E = Output("N", "force on the eccentric bearing of a disc", nominal=1000.0)
    F_N_max = Output("N", "largest force of a pin", nominal=1000.0)
    F_K_max = Output("N", "largest force of an output roller", nominal=1000.0)

    def relations(self) -> Iterator[Related]:
        """The disc can be cut, and everything finds its place."""
        yield require(self, "z_2 is z_1 + 1", self.z_2 - self.z_1, 1.0, 1.0)
        K = width_coefficient(self.e, self.z_2, self.r)
        yield require(self, "e leaves the disc without cusps", K, high=0.99)
        curvature = greatest_curvature(ca.fmin(K, 0.99), self.z_2, self.r)
        yield require(self, "the pins do not undercut the disc", self.D_0 / 2 * curvature, high=1.0)
        gap = 2 * self.r * ca.sin(ca.pi / ca.fmax(self.z_2, 2))
        yield require(self, "neighbouring pins do not touch", self.D_0 / gap, high=1)
        hole, root = self.D_VK / 2 + self.e, self.r - self.e - self.D_0 / 2
        share = (self.R_0 + hole) / root
        yield require(self, "the holes lie within the disc", share, high=1)
        share = (self.D_CZ / 2 + hole) / self.R_0
        yield require(self, "the holes lie outside the bearing", share, high=1)
        for inner, outer in (("d_0", "D_0"), ("d_VK", "D_VK"), ("d_CZ", "D_CZ")):
            ratio = self.symbols[inner] / self.symbols[outer]
            yield require(self, "{inner} is below {outer}", ratio, high=1 - 1e-6, inner=inner, outer=outer)

    def load(self) -> Num:
        """Torque of one disc, its magnitude [N.m]."""
        return smooth_magnitude(self.output.tau, TORQUE_WIDTH) / self.n

    def forces(self, T_disc: Num) -> tuple[Num, Num, Num]:
        """Sums of pin and output roller forces, and the bearing's force, of one disc of a torque [N]."""
        K = width_coefficient(self.e, self.z_2, self.r)
        F_E = eccentric_force(T_disc, K, self.e, self.z_1, self.R_0)
        return pin_force_sum(T_disc, self.e, self.z_1), roller_force_sum(T_disc, self.R_0), F_E

    def loss_torque(self, sign: Num) -> Num:
        """Friction torque on the output shaft [N.m], not negative; the sign is that of the speeds."""
        raise AttributeError(f"{type(self).__name__} has no friction")

    def equations(self) -> Iterator[Equation]:
        """What enters at one flange and does not leave at the other is heat."""
        sign = friction_sign(self.input.w)
        yield equation("a turn of the input moves on by a lobe", self.input.w, self.z_1 * self.output.w)
        yield equation("friction torque", self.tau_loss, self.loss_torque(sign))
        yield equation("torque less loss", self.input.tau * self.z_1, sign * self.tau_loss - self.output.tau)
        yield equation("friction power", self.P_loss, self.tau_loss * sign * self.output.w)
        yield equation("all friction becomes heat", self.heat.Q_flow, -self.P_loss)
        T_disc = self.load()
        K = width_coefficient(self.e, self.z_2, self.r)
        for key, F, value in zip(
            ("pins", "output rollers", "bearing"), (self.F_N, self.F_K, self.F_E), self.forces(T_disc), strict=True
        ):
            yield equation(f"force on the {key}", F, value)
        yield equation("largest pin force", self.F_N_max, pin_load(T_disc, K, self.z_1, self.r, ca.acos(K)))
        yield equation("largest output roller force", self.F_K_max, largest_roller_force(T_disc, self.u, self.R_0))


class CycloidalReducer(CycloidDrive):
    """Cycloidal reducer whose losses follow from the speeds and forces of all its contacts.

    Rollers slide on their pins in mixed friction: the film by what it is at a reference state, where the sliding
    friction `mu_ref` is known. So warm oil and slow turning bring friction up to that of the boundary layer.
    """

    scale: ClassVar[tuple[str, ...]] = ("mu_r1", "mu_r2", "mu_r3", "mu_ref", "mu_fluid", "mu_bl")

    lubricant = Lubricant()

    mu_ref = Parameter("1", "sliding friction of rollers on pins at the reference", nominal=0.1, above=0.0, at_most=1.0)
    mu_fluid = Parameter("1", "sliding friction of a full film", nominal=0.1, at_least=0.0, at_most=1.0)
    mu_bl = Parameter("1", "sliding friction without a film", nominal=0.1, above=0.0, at_most=0.3)
    eta_ref = Parameter("Pa.s", "dynamic viscosity at the reference", nominal=0.1, above=0.0)
    w_ref = Parameter("rad/s", "speed of the input at the reference", nominal=100.0, above=0.0)
    tau_ref = Parameter("N.m", "torque of the output at the reference", nominal=100.0, above=0.0)
    Lambda_ref = Parameter(
        "1",
        "specific film thickness at the reference",
        at_least=0.0,
        derived=lambda p: film_of_share((p.mu_bl - p.mu_ref) / (p.mu_bl - p.mu_fluid)),
    )
    mu_s = Output("1", "sliding friction of rollers on pins", nominal=0.1)
    Lambda = Output("1", "specific film thickness of rollers on pins")
    P_loss_bearing = Output("W", "friction power of the eccentric bearings", nominal=100.0, at_least=0.0)
    P_loss_output = Output("W", "friction power of the output rollers", nominal=100.0, at_least=0.0)
    P_loss_ring = Output("W", "friction power of the rollers on the pins", nominal=100.0, at_least=0.0)

    def relations(self) -> Iterator[Related]:
        """Friction lies between that of a film and that without, and locks nothing."""
        yield from super().relations()
        place = (self.mu_ref - self.mu_fluid) / (self.mu_bl - self.mu_fluid)
        yield require(self, "mu_ref is mixed friction", place, 0.1, 1.0)
        yield require(self, "no self-locking", sum(self.torques(1.0, self.mu_bl)), high=0.95)

    def torques(self, tau: Num, mu_s: Num) -> tuple[Num, Num, Num]:
        """Friction torques of bearings, output rollers and rollers on pins of all discs, on the output shaft [N.m].

        Each is the power at 1 rad/s of the output: the crank turns against a disc by z_1 + 1 of it.

        Args:
            tau: torque of the output shaft, not negative [N.m]
            mu_s: sliding friction of rollers on pins [1]
        """
        F_N, F_K, F_E = self.forces(tau)
        crank = self.z_1 + 1
        bearing = crank * bearing_loss_torque(self.mu_r1, (self.d_CZ + self.D_CZ) / 2, F_E)
        output = output_roller_power(F_K, self.e, crank, self.D_VK, self.d_VK, self.mu_r2, mu_s)
        return bearing, output, ring_roller_power(F_N, self.r, 1.0, self.D_0, self.d_0, self.mu_r3, mu_s)

    def loss_torque(self, sign: Num) -> Num:
        """Sum over all contacts."""
        return sum(self.torques(self.n * self.load(), self.mu_s))

    def equations(self) -> Iterator[Equation]:
        """The film decides the sliding friction."""
        yield from super().equations()
        stir = self.lubricant.nu * self.lubricant.rho * self.input.w / (self.eta_ref * self.w_ref)
        load = self.output.tau / self.tau_ref
        yield equation("film", self.Lambda, film_from_reference(self.Lambda_ref, stir, load))
        yield equation("sliding friction", self.mu_s, mixed_friction(self.Lambda, self.mu_fluid, self.mu_bl))
        w = friction_sign(self.input.w) * self.output.w
        for key, P, torque in zip(
            ("bearings", "output rollers", "rollers on pins"),
            (self.P_loss_bearing, self.P_loss_output, self.P_loss_ring),
            self.torques(self.n * self.load(), self.mu_s),
            strict=True,
        ):
            yield equation(f"friction power of the {key}", P, torque * w)


class MalhotraReducer(CycloidDrive):
    """Cycloidal reducer of one efficiency at any load and speed, by loss torques at rated load after Malhotra.

    Where the output drives, the same share of the power that enters is lost. How the loss torques are counted is data:
    the discs whose loss is counted, and the turns of the rollers on the pins per turn of the input.
    """

    scale: ClassVar[tuple[str, ...]] = ("mu_r1", "mu_r2", "mu_r3", "mu_s1", "mu_s2")

    mu_s1 = Parameter("1", "sliding friction of output rollers on pins", nominal=0.1, at_least=0.0, at_most=1.0)
    mu_s2 = Parameter("1", "sliding friction of ring rollers on pins", nominal=0.1, at_least=0.0, at_most=1.0)
    n_counted = Parameter("1", "number of discs whose loss torques are counted", above=0.0, whole=True)
    turns_ring = Parameter("1", "turns counted for the ring rollers per turn of the input", above=0.0)
    P_rated = Parameter("W", "rated power at the input", nominal=1000.0, above=0.0)
    w_rated = Parameter("rad/s", "rated speed of the input", nominal=100.0, above=0.0)
    tau_rated = Parameter("N.m", "rated torque of the output", nominal=100.0, above=0.0)
    eta = Parameter(
        "1",
        "efficiency of a reducer",
        above=0.0,
        at_most=1.0,
        derived=lambda p: malhotra_efficiency(sum(p.torques(p.tau_rated / p.n)), p.P_rated, p.w_rated),
    )
    tau_loss_1 = Output("N.m", "loss torque of the bearings, on the input", at_least=0.0)
    tau_loss_2 = Output("N.m", "loss torque of the output rollers, on the input", at_least=0.0)
    tau_loss_3 = Output("N.m", "loss torque of the rollers on the pins, on the input", at_least=0.0)

    def relations(self) -> Iterator[Related]:
        """No more discs are counted than there are."""
        yield from super().relations()
        yield require(self, "n_counted fits n", self.n_counted / self.n, high=1.0)

    def torques(self, T_disc: Num) -> tuple[Num, Num, Num]:
        """Loss torques of bearings, output rollers and rollers on pins, referred to the input [N.m]."""
        F_N, F_K, F_E = self.forces(T_disc)
        bearing = bearing_loss_torque(self.mu_r1, (self.d_CZ + self.D_CZ) / 2, F_E)
        output = roller_loss_torque(self.mu_r2, self.D_VK, self.mu_s1, self.d_VK, F_K)
        ring = self.turns_ring * roller_loss_torque(self.mu_r3, self.D_0, self.mu_s2, self.d_0, F_N)
        return self.n_counted * bearing, self.n_counted * output, self.n_counted * ring

    def loss_torque(self, sign: Num) -> Num:
        """(1 - eta) / eta of the output torque where the input drives, 1 - eta where the output does."""
        tau, driven, driving = self.output.tau, (1 - self.eta) / self.eta, 1 - self.eta
        reduces = -sign * smooth_sign(tau, TORQUE_WIDTH)
        share = (driven + driving) / 2 + reduces * (driven - driving) / 2
        return share * smooth_magnitude(tau, TORQUE_WIDTH)

    def equations(self) -> Iterator[Equation]:
        """The efficiency as given; the loss torques are shown."""
        yield from super().equations()
        shown = (self.tau_loss_1, self.tau_loss_2, self.tau_loss_3)
        for key, torque, value in zip("123", shown, self.torques(self.load()), strict=True):
            yield equation(f"loss torque {key}", torque, value)
