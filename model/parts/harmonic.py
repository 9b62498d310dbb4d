"""Harmonic drive: the film between the teeth of flexspline and circular spline, and the mesh of both."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import ClassVar

import casadi as ca
import numpy as np

from ..core.component import Component, Equation, Related, equation
from ..core.declare import Choice, Output, Parameter
from ..laws.film import mixed_friction, specific_film_thickness
from ..laws.film_line import RIGID, line_film_central
from ..laws.film_map import FilmMap
from ..laws.harmonic import conforming_radius, flank_speed_radius, half_width, pad_shear, printed_film
from ..laws.pad import combined_film, side_leakage, squeeze_factor, wedge_coefficient
from ..laws.regimes import elasticity_parameter, inside_elastohydrodynamic, viscosity_parameter
from ..laws.smooth import Num, friction_sign, smooth_abs, smooth_cap, smooth_sign
from .contacts import FilmContact, fits_map
from .ports import BearingLoad, Flange, HeatPort, Lubricant
from .relations import require

#: Film over the sum of the roughnesses Rz from which the source admits a contact.
ADMISSIBLE = 1.1
#: Composite Rq over composite Rz of a machined flank: Rq is 1.25 Ra, and Rz about 6 Ra.
RQ_OVER_RZ = 0.2
#: Force of a tooth pair below which it is blurred [N].
FORCE_WIDTH = 0.1
#: Sliding speed of the flanks below which their film is blurred [m/s]: that of a wave generator at 0.02 rpm.
U_WIDTH = 1e-6


class FlankFilm(Component):
    """Base of what has flanks that slide in oil: the film of one pair of teeth, and its friction.

    The flank of the flexspline slides along that of the circular spline, which stands still, so that the mean speed
    of both is half of what they slide at. The film is a wedge with squeezed oil ("pad"), that of a line contact after
    Moes, which knows rigid flanks ("moes"), or the formula that the source prints ("dowson_higginson_printed").
    """

    role: ClassVar[str] = "teeth"
    scale: ClassVar[tuple[str, ...]] = ("mu_fluid", "mu_boundary")

    film = Choice(
        ("pad", "moes", "dowson_higginson_printed"),
        'which film the flanks have; or a map of line contacts, "map:FILE"',
        default="pad",
        also=FilmMap,
    )
    w_0 = Parameter("m", "radial deflection of the flexspline", nominal=1e-3, above=0.0)
    phi = Parameter("rad", "angle of the meshing tooth from the long axis", nominal=0.2, at_least=0.0, below=0.7853)
    r_u = Parameter(
        "m",
        "sliding speed of the flanks over the speed of the wave generator",
        nominal=1e-3,
        above=0.0,
        derived=lambda p: flank_speed_radius(p.w_0, p.phi),
    )
    speed_factor = Parameter(
        "1", "factor on the mean speed of the flanks, 1 for their kinematics", default=1.0, above=0.0
    )
    L = Parameter("m", "face width", nominal=0.01, above=0.0)
    r_convex = Parameter("m", "radius of curvature of the convex flank", nominal=0.02, above=0.0)
    r_concave = Parameter("m", "radius of curvature of the concave flank", nominal=0.02, above=0.0)
    R = Parameter(
        "m",
        "reduced radius of the flanks",
        above=0.0,
        derived=lambda p: conforming_radius(p.r_convex, p.r_concave),
    )
    E_eff = Parameter("Pa", "effective modulus, E/(1 - nu^2) of two equal steels", nominal=2e11, above=0.0)
    B_tooth = Parameter("m", "length of the flanks along the motion", nominal=1e-3, above=0.0)
    a = Parameter("1", "film at the inlet of the flank over that at its outlet", at_least=1.01, at_most=10.0)
    approach = Parameter("m", "how far the flanks approach per radian of the wave generator", 1e-6, at_least=0.0)
    Rz_1 = Parameter("m", "roughness Rz of the flexspline's flanks", nominal=1e-6, above=0.0)
    Rz_2 = Parameter("m", "roughness Rz of the circular spline's flanks", nominal=1e-6, above=0.0)
    mu_fluid = Parameter(
        "1", "friction of the full film but for its viscous drag", nominal=0.1, at_least=0.0, at_most=1.0
    )
    mu_boundary = Parameter("1", "friction of touching flanks", nominal=0.1, at_least=0.0, at_most=1.0)
    h_adm = Parameter(
        "m",
        "least film that the source admits",
        nominal=1e-6,
        above=0.0,
        derived=lambda p: ADMISSIBLE * (p.Rz_1 + p.Rz_2),
    )
    tau_loss = Output("N.m", "friction torque of the flanks, on the wave generator", at_least=0.0, guess=0.0)
    P_loss = Output("W", "friction power of the flanks", nominal=10.0, at_least=0.0)
    mu = Output("1", "friction of the flanks, viscous drag included", nominal=0.1)
    v_slide = Output("m/s", "sliding speed of the flanks", nominal=0.1)
    h_min = Output("m", "least film between the flanks", nominal=1e-6)
    Lambda = Output("1", "specific film thickness, over the root of the squared roughnesses Rq")
    Lambda_Rz = Output("1", "film over the sum of the roughnesses Rz, as the source has it")
    h_rigid = Output("m", "film if the flanks were rigid, their parabola complete and the oil isoviscous", nominal=1e-6)
    b_H = Output("m", "half width of the contact after Hertz, if the parabola were complete", nominal=1e-3)
    p_H = Output("Pa", "largest pressure of the contact after Hertz", nominal=1e7)
    g_V = Output("1", "viscosity parameter of the contact")
    g_E = Output("1", "elasticity parameter of the contact")

    def relations(self) -> Iterator[Related]:
        """A convex flank fits into a concave one."""
        yield require(self, "r_concave is larger than r_convex", self.r_concave / self.r_convex, 1 + 1e-9)
        if isinstance(self.film, FilmMap):
            yield fits_map(self, self.film, self.E_eff)

    def pad_terms(self, eta: Num, w: Num, B: Num) -> tuple[Num, Num]:
        """Wedge [N.m2] and squeeze [N.m3] of a pad: load times film squared, load times film cubed.

        The slope of the flank enters the wedge alone; in the speed of approach it would count twice.

        Args:
            eta: dynamic viscosity [Pa.s]
            w: speed of the wave generator against the circular spline, above 0 [rad/s]
            B: length along the motion [m]
        """
        xi, v = B / self.L, self.speed_factor * self.r_u * w
        wedge = eta * v * self.L * wedge_coefficient(self.a) * side_leakage(xi, self.a) * B**2
        return wedge, squeeze_factor(xi) * eta * self.L * B**3 * self.approach * w

    def film_of(self, eta: Num, alpha_p: Num, w: Num, F: Num, B: Num) -> Num:
        """Film of a pair of teeth by the chosen law [m].

        Args:
            eta: dynamic viscosity [Pa.s]
            alpha_p: pressure-viscosity coefficient [1/Pa]
            w: speed of the wave generator against the circular spline, above 0 [rad/s]
            F: load of the pair, above 0 [N]
            B: length of the pad [m]
        """
        u_sum = self.speed_factor * self.r_u * w
        if isinstance(self.film, FilmMap):
            return self.film.films(eta, u_sum, F / self.L, self.R)[0]
        if self.film == "moes":
            return line_film_central(eta, u_sum, alpha_p, F / self.L, self.R, self.E_eff, u_width=U_WIDTH)
        if self.film == "dowson_higginson_printed":
            inside_elastohydrodynamic(self.g_V, self.g_E)
            return printed_film(alpha_p, eta, u_sum / 2, self.E_eff, self.R, F / self.L)
        return combined_film(F, *self.pad_terms(eta, w, B))

    def contact(self, eta: Num, alpha_p: Num, w: Num, F_0: Num, pairs: Num) -> Iterator[Equation]:
        """Film, regime and friction of the pairs of teeth.

        Args:
            eta: dynamic viscosity [Pa.s]
            alpha_p: pressure-viscosity coefficient [1/Pa]
            w: speed of the wave generator against the circular spline [rad/s]
            F_0: load of each pair, not negative [N]
            pairs: number of them
        """
        F, speed = smooth_abs(F_0, FORCE_WIDTH), smooth_abs(w)
        B, film = self._pad_length(), self.film_of(eta, alpha_p, speed, F, self._pad_length())
        yield from self._regime(eta, alpha_p, self.speed_factor * self.r_u * speed / 2, F / self.L)
        yield equation("film", self.h_min, film * smooth_sign(w) ** 2)
        sigma = RQ_OVER_RZ * ca.sqrt(self.Rz_1**2 + self.Rz_2**2)
        yield equation("specific film", self.Lambda, specific_film_thickness(self.h_min, sigma))
        yield equation("film over Rz", self.Lambda_Rz, self.h_min / (self.Rz_1 + self.Rz_2))
        yield equation("sliding", self.v_slide, self.r_u * w)
        friction = mixed_friction(self.Lambda, self.mu_fluid, self.mu_boundary) * F_0
        friction += pad_shear(eta, self.r_u * speed, B, self.L, film, self.a)
        yield equation("friction", self.mu, friction / F)
        yield equation("friction torque", self.tau_loss, pairs * friction * self.r_u)
        yield equation("friction power", self.P_loss, self.tau_loss * friction_sign(w) * w)

    def _pad_length(self) -> Num:
        """Length of flank that carries: the tooth's, or what a small load flattens [m]."""
        return smooth_cap(2 * self.b_H, self.B_tooth)

    def _regime(self, eta: Num, alpha_p: Num, u_0: Num, F_n_l: Num) -> Iterator[Equation]:
        """Where the contact lies between the regimes of line contacts, whatever film is chosen."""
        yield equation("half width", self.b_H, half_width(F_n_l, self.R, self.E_eff))
        yield equation("pressure", self.p_H, 2 * F_n_l / (ca.pi * self.b_H))
        yield equation("viscosity parameter", self.g_V, viscosity_parameter(alpha_p, eta, u_0, F_n_l, self.R))
        yield equation("elasticity parameter", self.g_E, elasticity_parameter(eta, u_0, F_n_l, self.R, self.E_eff))
        yield equation("rigid film", self.h_rigid, 2 * RIGID * eta * u_0 * self.R / F_n_l)


class HarmonicContact(FlankFilm):
    """One tooth contact of a harmonic drive by itself: load and viscosity are given, the wave generator turns."""

    shaft = Flange(must_meet=True)
    teeth = HeatPort()

    eta_0 = Parameter("Pa.s", "dynamic viscosity of the oil", nominal=0.1, above=0.0)
    alpha_p = Parameter("1/Pa", "pressure-viscosity coefficient of the oil", nominal=1e-8, at_least=0.0)
    F_0 = Parameter("N", "load of the pair of teeth", nominal=100.0, above=0.0)

    def equations(self) -> Iterator[Equation]:
        """Friction brakes the shaft and heats the teeth."""
        w = self.shaft.w
        yield from self.contact(self.eta_0, self.alpha_p, w, self.F_0, 1.0)
        yield equation("friction opposes rotation", self.shaft.tau, self.tau_loss * friction_sign(w))
        yield equation("loss heats the teeth", self.teeth.Q_flow, -self.P_loss)


class HarmonicMesh(FlankFilm):
    """Wave generator, flexspline and circular spline; each of them may be driven, loaded or held.

    The flange `wave` is the rotation of the wave generator against the flexspline: the bearing between them brakes
    there. The losses are those of the teeth on the way between the shafts.
    """

    wave_generator = Flange()
    flexspline = Flange()
    circular_spline = Flange()
    wave = Flange()
    wave_load = BearingLoad()
    shaft_load = BearingLoad()
    flexspline_teeth = HeatPort()
    circular_spline_teeth = HeatPort()
    lubricant = Lubricant()

    z_1 = Parameter("1", "number of teeth of the flexspline", above=0.0, whole=True)
    z_2 = Parameter("1", "number of teeth of the circular spline", above=0.0, whole=True)
    m_n = Parameter("m", "module", nominal=1e-3, above=0.0)
    alpha = Parameter("rad", "pressure angle of the flanks", above=0.0, below=1.2)
    pairs = Parameter("1", "pairs of teeth that share the load on average", nominal=10.0, above=0.0)
    tau_width = Parameter("N.m", "torque below which the direction of load is blurred", default=0.1, above=0.0)
    eta_0 = Output("Pa.s", "dynamic viscosity of the oil", nominal=0.1)
    F_0 = Output("N", "load of a pair of teeth", nominal=100.0)

    def relations(self) -> Iterator[Related]:
        """Two waves, and teeth that carry."""
        yield from super().relations()
        yield require(self, "z_2 is two more than z_1", (self.z_2 - self.z_1) / 2, 1.0, 10.0)
        yield require(self, "the pairs are teeth", self.pairs / self.z_1, 0.0, 1.0)

    def film_contact(self, values: Mapping[str, float]) -> FilmContact:
        """The contact of a pair of teeth, one flank at rest, by values at an operating point in SI."""
        sigma = RQ_OVER_RZ * float(np.hypot(values["Rz_1"], values["Rz_2"]))
        R = self.number_at(self.R, values)
        speed = abs(values["speed_factor"] * values["v_slide"])
        return FilmContact(values["F_0"], R, values["L"], speed, 0.0, values["E_eff"], sigma, values["mu_boundary"])

    def equations(self) -> Iterator[Equation]:
        """Kinematics, torques, load and friction of the teeth."""
        wave, flex, circular = self.wave_generator, self.flexspline, self.circular_spline
        i_0, w = self.z_1 / (self.z_2 - self.z_1), wave.w - circular.w
        yield equation("Willis", flex.w - circular.w, -w / i_0)
        yield equation("wave against flexspline", self.wave.w, w * (1 + 1 / i_0))
        yield equation("torques balance", wave.tau + flex.tau + circular.tau, 0)
        passed = flex.tau / i_0 - self.wave.tau * (1 + 1 / i_0)
        yield equation("power against the circular spline", wave.tau, passed + self.tau_loss * friction_sign(w))
        eta, r_2 = self.lubricant.nu * self.lubricant.rho, self.z_2 * self.m_n / 2
        F_t = smooth_abs(circular.tau, self.tau_width) / r_2
        yield equation("viscosity", self.eta_0, eta)
        yield equation("load of a pair", self.F_0, F_t / (self.pairs * ca.cos(self.alpha)))
        yield from self.contact(self.eta_0, self.lubricant.alpha_p, w, self.F_0, self.pairs)
        yield equation("bearing radially", self.wave_load.F_r, F_t * ca.tan(self.alpha))
        yield equation("bearing axially", self.wave_load.F_a, 0)
        yield equation("shafts radially, the two meshes cancel", self.shaft_load.F_r, 0)
        yield equation("shafts axially", self.shaft_load.F_a, 0)
        yield equation("half heats the flexspline", self.flexspline_teeth.Q_flow, -self.P_loss / 2)
        yield equation("half heats the circular spline", self.circular_spline_teeth.Q_flow, -self.P_loss / 2)
