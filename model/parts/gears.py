"""Pairs of gears with involute teeth. What a mesh passes on is what it got less what it lost."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import ClassVar

import casadi as ca

from ..core.component import Equation, Related, equation
from ..core.declare import Choice, Output, Parameter
from ..laws.film_map import FilmMap
from ..laws.gears import (
    addendum_contact_ratio,
    base_diameter,
    base_helix_angle,
    overlap_ratio,
    tip_diameter,
    tip_thickness,
    transverse_base_pitch,
    undercut_shift,
)
from ..laws.mesh import line_loss_factor, line_sharing, mesh_loss, tooth_loss_factor
from ..laws.smooth import Num, friction_sign, smooth_abs
from .contacts import FilmContact, fits_map
from .ports import Flange, ToothForce
from .relations import require
from .teeth import ToothedPart

#: Profile shift left between what a_w asks for and x_1 + x_2: tolerances and backlash, 5 % of a module.
SHIFT_LEFT = 0.05
#: Profile shift by which teeth may be undercut: beyond it no tooth is left to carry.
UNDERCUT_LEFT = 0.5
#: The relation of centre distance and teeth.
FITS = "a_w fits z_1, z_2, m_n, beta, x_1, x_2"
#: Centre distances among which one fits, over that without profile shift [1].
NEAR = (0.97, 1.15)
#: How often the range of centre distances is halved.
HALVINGS = 20
#: Teeth that a ring has more than its pinion, at least: below, standard tips interfere.
LEAST_DIFFERENCE = 8.0
#: How far the tips of a ring may reach; a little beyond the pinion's involute they are shortened in practice.
BEYOND = 1.1


class GearPair(ToothedPart):
    """Base of pinion and wheel: their contact is that of the cylindrical gears which `teeth` tells."""

    #: Sense of rotation of the wheel, seen with that of the pinion.
    turn: ClassVar[float] = -1.0
    axes: ClassVar[str] = "parallel"

    pinion = Flange()
    wheel = Flange()

    film = Choice(("grubin",), 'film: Grubin\'s formula, or a map, "map:FILE"', default="grubin", also=FilmMap)
    load_sharing = Choice(
        ("pairs", "lines"),
        "load of the tooth loss factor: the same on every pair in contact, or along the lines of contact",
        default="pairs",
    )
    x_1 = Parameter("1", "profile shift of the pinion")
    x_2 = Parameter("1", "profile shift of the wheel")
    eps_alpha = Parameter("1", "transverse contact ratio", above=0.0, derived=lambda p: sum(p.addendum_ratios()))
    H_v = Parameter("1", "tooth loss factor", at_least=0.0, derived=lambda p: p.loss_factor())
    tau_loss = Output("N.m", "friction torque of the mesh, on the pinion", nominal=1.0, at_least=0.0, guess=0.0)
    P_loss = Output("W", "mesh loss", nominal=100.0, at_least=0.0)
    mu = Output("1", "tooth friction coefficient", nominal=0.1)
    Lambda = Output("1", "specific film thickness")
    F_t = Output("N", "tangential force", nominal=1000.0)
    u_m = Output("m/s", "mean speed of the flanks at the pitch point, across the teeth")

    def circles(self, z: Num, x: Num) -> tuple[Num, Num]:
        """Tip and base diameter of a cylindrical gear [m].

        Args:
            z: number of teeth, negative for an internal gear [1]
            x: profile shift [1]
        """
        alpha_t, _ = self.working_angle()
        d = 2 * self.radius(z)
        return tip_diameter(d, self.m_n, x), base_diameter(d, alpha_t)

    def addendum_ratios(self) -> list[Num]:
        """Addendum contact ratios of pinion and wheel [1]."""
        alpha_t, alpha_wt = self.working_angle()
        p_et = transverse_base_pitch(self.m_n, self.beta, alpha_t)
        gears = zip(self.teeth(), (self.x_1, self.x_2), strict=True)
        return [addendum_contact_ratio(*self.circles(z, x), alpha_wt, p_et) for z, x in gears]

    def relations(self) -> Iterator[Related]:
        """What makes two gears mesh at their centre distance, and teeth that can be cut."""
        yield from super().relations()
        shift = self.shift_sum() - self.x_1 - self.x_2
        yield require(self, FITS, shift, -SHIFT_LEFT, SHIFT_LEFT)
        yield require(self, "the teeth overlap", self.eps_alpha, 1.0)
        z_a, z_b = self.teeth()
        yield from self.cut("1", z_a, self.x_1)
        yield from self.cut("2", z_b, self.x_2)
        if isinstance(self.film, FilmMap):
            yield fits_map(self, self.film, self.E / (1 - self.poisson**2))

    def way_out(self, relation: str) -> str:
        """The centre distance that fits the teeth and their profile shifts."""
        if relation != FITS:
            return ""
        excess = self.shift_sum() - self.x_1 - self.x_2
        low, high = (k * self.number_at(ca.fabs(self.radius(sum(self.teeth()))), self.values) for k in NEAR)
        for _ in range(HALVINGS):
            a_w = (low + high) / 2
            far = self.number_at(excess, {**self.values, "a_w": a_w}) * self.number_at(sum(self.teeth()), self.values)
            low, high = (low, a_w) if far > 0 else (a_w, high)
        return f" a_w = {1000 * low:.5g} mm fits these teeth."

    def cut(self, key: str, z: Num, x: Num) -> Iterator[Related]:
        """Teeth that can be cut.

        Args:
            key: of the gear in the names of its parameters
            z: number of teeth of the cylindrical gear [1]
            x: profile shift [1]
        """
        alpha_t, _ = self.working_angle()
        beyond = x - undercut_shift(z, alpha_t, self.beta)
        yield require(self, "x_{key} is above undercut", beyond, -UNDERCUT_LEFT, key=key)
        yield self.pointed(key, z, x)

    def pointed(self, key: str, z: Num, x: Num) -> Related:
        """Teeth with a tip.

        Args:
            key: of the gear in the names of its parameters
            z: number of teeth of the cylindrical gear, negative for an internal gear [1]
            x: profile shift [1]
        """
        alpha_t, _ = self.working_angle()
        thickness = tip_thickness(z, x, self.alpha_n, alpha_t, *self.circles(z, x))
        return require(self, "the teeth of gear {key} are not pointed", thickness / self.m_n, 0.0, key=key)

    def loss_factor(self) -> Num:
        """Tooth loss factor from the geometry [1]."""
        beta_b = base_helix_angle(self.alpha_n, self.beta)
        z_a, z_b = self.teeth()
        teeth = z_a, z_b / z_a, beta_b, *self.addendum_ratios()
        by_pairs = tooth_loss_factor(*teeth)
        if self.load_sharing == "pairs":
            return by_pairs
        return by_pairs + line_sharing(overlap_ratio(self.b, self.m_n, self.beta)) * (
            line_loss_factor(*teeth) - by_pairs
        )

    def film_contact(self, values: Mapping[str, float]) -> FilmContact:
        """The contact at the pitch point, by values at an operating point in SI."""
        c = self.contact(self.eps_alpha, *self.teeth())
        R, length, normal = (self.number_at(x, values) for x in (c.R, c.l, c.normal))
        E_eff, sigma = values["E"] / (1 - values["poisson"] ** 2), 2**0.5 * values["Ra"]
        return FilmContact(values["F_t"] * normal, R, length, values["u_m"], values["u_m"], E_eff, sigma)

    def equations(self) -> Iterator[Equation]:
        """The gear that drives brings the loss; what is left arrives at the other."""
        w, ratio, r = self.pinion.w, self.z_2 / self.z_1, self.radius(self.z_1)
        sign = friction_sign(w)
        tau_mean = smooth_abs(self.pinion.tau - sign * self.tau_loss / 2, self.tau_width)
        z_a, z_b = self.teeth()
        contact, w_a = self.contact(self.eps_alpha, z_a, z_b), w * self.z_1 / z_a
        mu, Lambda = self.friction(contact, self.F_t, w_a, self.film if isinstance(self.film, FilmMap) else None)
        yield equation("gears roll on each other", self.wheel.w, self.turn * w / ratio)
        yield equation("torque less loss", -self.turn * self.wheel.tau / ratio, self.pinion.tau - sign * self.tau_loss)
        yield equation("mesh loss", self.tau_loss, mesh_loss(tau_mean + self.tau_loss / 2, self.mu, self.H_v))
        yield equation("mesh power", self.P_loss, self.tau_loss * sign * w)
        yield equation("tooth friction", self.mu, mu)
        yield equation("film", self.Lambda, Lambda)
        yield equation("tangential force", self.F_t, tau_mean / r)
        yield equation("speed of the flanks", self.u_m, smooth_abs(w_a) * contact.rho)
        yield equation("loss heats the gears", self.gears.Q_flow, -self.P_loss)


class HelicalGearPair(GearPair):
    """Two external gears on parallel shafts: helical, or spur with beta = 0."""

    force = ToothForce()

    def equations(self) -> Iterator[Equation]:
        """One force between the two along the line of action, for the shafts of both, at their working circles."""
        yield from super().equations()
        alpha_t, alpha_wt = self.working_angle()
        F_bt = self.F_t / ca.cos(alpha_t)
        yield equation("tangential force told", self.force.F_t, F_bt * ca.cos(alpha_wt))
        yield equation("radial force", self.force.F_r, F_bt * ca.sin(alpha_wt))
        yield equation("axial force", self.force.F_a, self.F_t * ca.tan(self.beta))


class InternalGearPair(HelicalGearPair):
    """A pinion inside a ring gear on parallel shafts, helical or spur; both turn the same way."""

    turn = 1.0

    z_2 = Parameter("1", "number of teeth of the ring, positive", above=0.0, whole=True)
    x_2 = Parameter("1", "profile shift of the ring, positive inwards: a smaller tip circle")

    def teeth(self) -> tuple[Num, Num]:
        """The ring counts negative."""
        return self.z_1, -self.z_2

    def cut(self, key: str, z: Num, x: Num) -> Iterator[Related]:
        """A ring has no undercut, but its tips must find an involute on the pinion.

        Args:
            key: of the gear in the names of its parameters
            z: number of teeth, negative for the ring [1]
            x: profile shift [1]
        """
        if key == "1":
            yield from super().cut(key, z, x)
            return
        alpha_t, alpha_wt = self.working_angle()
        reach = transverse_base_pitch(self.m_n, self.beta, alpha_t) * self.addendum_ratios()[1]
        end = self.radius(self.z_1) * ca.cos(alpha_t) * ca.tan(alpha_wt)
        yield require(self, "the tips of the ring meet the pinion's involute", reach / end, 0.0, BEYOND)
        yield require(self, "the ring is larger than the pinion", self.z_2 - self.z_1, LEAST_DIFFERENCE)
        yield self.pointed(key, z, x)
