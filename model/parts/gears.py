"""Gears: a helical pair and a planetary set. What a mesh passes on is what it got less what it lost."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import ClassVar

import casadi as ca

from ..core.component import Component, Equation, Related, equation
from ..core.declare import Choice, Output, Parameter
from ..laws.film import film_thickness, specific_film_thickness, thermal_film_reduction
from ..laws.film_map import FilmMap
from ..laws.gears import (
    addendum_contact_ratio,
    base_diameter,
    base_helix_angle,
    contact_length,
    curvature_radius,
    profile_shift_sum,
    reduced_radius,
    reference_diameter,
    tip_diameter,
    tip_thickness,
    transverse_base_pitch,
    transverse_pressure_angle,
    undercut_shift,
    working_pressure_angle,
)
from ..laws.mesh import (
    friction_schlenk,
    load_per_contact_length,
    load_per_face_width,
    mesh_loss,
    tooth_loss_factor,
)
from ..laws.smooth import Num, friction_sign, smooth_abs
from .contacts import FilmContact, fits_map
from .ports import BearingLoad, Flange, HeatPort, Lubricant, ShaftReading, ToothForce
from .tooth_contact import ToothContact

#: Share of a_w that the base circles may take; at 1 the flanks would have no line of action.
ANGLE_LEFT = 0.9999
#: Profile shift left between what a_w asks for and x_1 + x_2: tolerances and backlash, 5 % of a module.
SHIFT_LEFT = 0.05
#: Profile shift by which teeth may be undercut: beyond it no tooth is left to carry.
UNDERCUT_LEFT = 0.5
#: How far a load may exceed that of all planets, relative: such numbers are inferred from measured losses.
LOAD_LEFT = 0.05


class ToothedPart(Component):
    """Base of everything with teeth: geometry, roughness and material of its gears, and the friction of a contact.

    The friction formula is printed with the base tangential force per face width, F_bt/b; some authors use it with
    the normal force per length of the contact lines, F_bn/l, which is eps_alpha times less. `line_load` says which,
    and `k_mu` belongs to it: a factor that was fitted with one is wrong with the other by eps_alpha^0.2.
    """

    role: ClassVar[str] = "teeth"
    scale: ClassVar[tuple[str, ...]] = ("k_mu",)

    gears = HeatPort()
    lubricant = Lubricant()

    z_1 = Parameter("1", "number of teeth of the first gear (pinion, sun)", above=0.0, whole=True)
    z_2 = Parameter("1", "number of teeth of the second gear (wheel, planet)", above=0.0, whole=True)
    m_n = Parameter("m", "normal module", nominal=1e-3, above=0.0)
    alpha_n = Parameter("rad", "normal pressure angle", above=0.0, below=1.0)
    beta = Parameter("rad", "helix angle at the reference diameter", at_least=0.0, below=1.2)
    b = Parameter("m", "face width", nominal=0.05, above=0.0)
    a_w = Parameter("m", "working centre distance", nominal=0.1, above=0.0)
    Ra = Parameter("m", "roughness Ra of each flank", nominal=1e-6, above=0.0)
    k_mu = Parameter("1", "factor on the tooth friction", at_least=0.0)
    line_load = Choice(("F_bt/b", "F_bn/l"), "line load of the friction formula: per face width, or per contact length")
    E = Parameter("Pa", "modulus of elasticity of the gears", nominal=1e11, above=0.0)
    poisson = Parameter("1", "Poisson's ratio of the gears", at_least=0.0, below=0.5)
    tau_width = Parameter("N.m", "torque below which the direction of load is blurred", default=0.1, above=0.0)

    def radius(self, z: Num) -> Num:
        """Reference radius of a gear of z teeth [m]."""
        return reference_diameter(self.m_n, z, self.beta) / 2

    def working_angle(self) -> tuple[Num, Num]:
        """Transverse pressure angle of the first two gears, at the reference and the working centre distance [rad]."""
        alpha_t = transverse_pressure_angle(self.alpha_n, self.beta)
        return alpha_t, working_pressure_angle(alpha_t, self.radius(self.z_1 + self.z_2), self.a_w)

    def shift_sum(self) -> Num:
        """Sum of the profile shifts of the first two gears that the working centre distance asks for [1]."""
        alpha_t, alpha_wt = self.working_angle()
        return profile_shift_sum(alpha_wt, alpha_t, self.alpha_n, self.z_1 + self.z_2)

    def relations(self) -> Iterator[Related]:
        """The base circles of the first two gears leave room for a line of action."""
        alpha_t, _ = self.working_angle()
        least = self.radius(self.z_1 + self.z_2) * ca.cos(alpha_t)
        yield self.relation(
            "a_w is more than the base circles need",
            "sum of the base radii over a_w",
            least / self.a_w,
            high=ANGLE_LEFT,
            remedy="Give a larger a_w, fewer teeth, or a smaller m_n or beta.",
        )

    def contact(self, eps_alpha: Num, z_a: Num, z_b: Num) -> ToothContact:
        """The contact of two gears.

        Args:
            eps_alpha: transverse contact ratio [1]
            z_a: teeth of the first gear [1]
            z_b: teeth of the second gear, negative for an internal gear [1]
        """
        alpha_t, alpha_wt = self.working_angle()
        beta_b = base_helix_angle(self.alpha_n, self.beta)
        rho_a, rho_b = (curvature_radius(base_diameter(2 * self.radius(z), alpha_t), alpha_wt) for z in (z_a, z_b))
        R, length = reduced_radius(rho_a, rho_b, beta_b), contact_length(self.b, eps_alpha, beta_b)
        base = 1 / ca.cos(alpha_t)
        return ToothContact(rho_a, R, length, base, base / ca.cos(beta_b))

    def friction(self, contact: ToothContact, F_t: Num, w: Num, film: FilmMap | None = None) -> tuple[Num, Num]:
        """Friction coefficient and specific film thickness of a contact.

        Args:
            contact: the contact
            F_t: tangential force [N]
            w: speed of the first gear against the line of centres [rad/s]
            film: map of the film; Grubin's formula without one
        """
        oil = self.lubricant
        F_n_l = load_per_contact_length(F_t * contact.normal, contact.l)
        load = F_n_l if self.line_load == "F_bn/l" else load_per_face_width(F_t * contact.base, self.b)
        u_sum = 2 * smooth_abs(w) * contact.rho
        eta = oil.nu * oil.rho
        mu = self.k_mu * friction_schlenk(load, u_sum, contact.R, eta, self.Ra, oil.X_L)
        E_eff = self.E / (2 * (1 - self.poisson**2))
        if film is None:
            h = film_thickness(eta, u_sum, oil.alpha_p, F_n_l, contact.R, E_eff)
        else:
            h, _ = film.films(eta, u_sum, F_n_l, contact.R)
        reduction = thermal_film_reduction(oil.beta_T, eta, u_sum, oil.k, 0.0)
        return mu, specific_film_thickness(reduction * h, ca.sqrt(2.0) * self.Ra)


class HelicalGearPair(ToothedPart):
    """Two external helical gears on parallel shafts."""

    pinion = Flange()
    wheel = Flange()
    force = ToothForce()

    film = Choice(("grubin",), 'film: Grubin\'s formula, or a map, "map:FILE"', default="grubin", also=FilmMap)
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

    def addendum_ratios(self) -> list[Num]:
        """Addendum contact ratios of pinion and wheel [1]."""
        alpha_t, alpha_wt = self.working_angle()
        p_et = transverse_base_pitch(self.m_n, self.beta, alpha_t)
        ratios = []
        for z, x in ((self.z_1, self.x_1), (self.z_2, self.x_2)):
            d = 2 * self.radius(z)
            tip, base = tip_diameter(d, self.m_n, x), base_diameter(d, alpha_t)
            ratios.append(addendum_contact_ratio(tip, base, alpha_wt, p_et))
        return ratios

    def relations(self) -> Iterator[Related]:
        """What makes two gears mesh at their centre distance, and teeth that can be cut."""
        yield from super().relations()
        yield self.relation(
            "a_w fits z_1, z_2, m_n, beta, x_1, x_2",
            "profile shift that a_w asks for beyond x_1 + x_2",
            self.shift_sum() - self.x_1 - self.x_2,
            -SHIFT_LEFT,
            SHIFT_LEFT,
            remedy="Give the a_w, beta or profile shifts that belong to these teeth.",
        )
        yield self.relation(
            "the teeth overlap",
            "transverse contact ratio",
            self.eps_alpha,
            1.0,
            remedy="Give more teeth, less profile shift, or a smaller alpha_n.",
        )
        alpha_t, _ = self.working_angle()
        for z, x, key in ((self.z_1, self.x_1, "1"), (self.z_2, self.x_2, "2")):
            d = 2 * self.radius(z)
            tip, base = tip_diameter(d, self.m_n, x), base_diameter(d, alpha_t)
            yield self.relation(
                f"x_{key} is above undercut",
                f"x_{key} over the limit of undercut",
                x - undercut_shift(z, alpha_t, self.beta),
                -UNDERCUT_LEFT,
                remedy=f"Give a larger x_{key} or more teeth.",
            )
            yield self.relation(
                f"the teeth of gear {key} are not pointed",
                "tooth thickness at the tip",
                tip_thickness(z, x, self.alpha_n, alpha_t, tip, base) / self.m_n,
                0.0,
                remedy=f"Give a smaller x_{key}.",
            )

        if isinstance(self.film, FilmMap):
            yield fits_map(self, self.film, self.E / (1 - self.poisson**2))

    def loss_factor(self) -> Num:
        """Tooth loss factor from the geometry [1]."""
        beta_b = base_helix_angle(self.alpha_n, self.beta)
        return tooth_loss_factor(self.z_1, self.z_2 / self.z_1, beta_b, *self.addendum_ratios())

    def film_contact(self, values: Mapping[str, float]) -> FilmContact:
        """The contact at the pitch point.

        Args:
            values: parameters and outputs at an operating point, by key, in SI
        """
        c = self.contact(self.eps_alpha, self.z_1, self.z_2)
        R, length, normal = (self.number_at(x, values) for x in (c.R, c.l, c.normal))
        E_eff, sigma = values["E"] / (1 - values["poisson"] ** 2), 2**0.5 * values["Ra"]
        return FilmContact(values["F_t"] * normal, R, length, values["u_m"], values["u_m"], E_eff, sigma)

    def equations(self) -> Iterator[Equation]:
        """The gear that drives brings the loss; what is left arrives at the other."""
        w, ratio, r = self.pinion.w, self.z_2 / self.z_1, self.radius(self.z_1)
        sign = friction_sign(w)
        tau_mean = smooth_abs(self.pinion.tau - sign * self.tau_loss / 2, self.tau_width)
        contact = self.contact(self.eps_alpha, self.z_1, self.z_2)
        mu, Lambda = self.friction(contact, self.force.F_t, w, self.film if isinstance(self.film, FilmMap) else None)
        alpha_t = transverse_pressure_angle(self.alpha_n, self.beta)
        yield equation("gears roll on each other", self.wheel.w, -w / ratio)
        yield equation("torque less loss", self.wheel.tau / ratio, self.pinion.tau - sign * self.tau_loss)
        yield equation("mesh loss", self.tau_loss, mesh_loss(tau_mean + self.tau_loss / 2, self.mu, self.H_v))
        yield equation("mesh power", self.P_loss, self.tau_loss * sign * w)
        yield equation("tooth friction", self.mu, mu)
        yield equation("film", self.Lambda, Lambda)
        yield equation("tangential force", self.force.F_t, tau_mean / r)
        yield equation("tangential force told", self.F_t, self.force.F_t)
        yield equation("speed of the flanks", self.u_m, smooth_abs(w) * contact.rho)
        yield equation("radial force", self.force.F_r, self.force.F_t * ca.tan(alpha_t))
        yield equation("axial force", self.force.F_a, self.force.F_t * ca.tan(self.beta))
        yield equation("loss heats the gears", self.gears.Q_flow, -self.P_loss)


class PlanetarySet(ToothedPart):
    """Sun, planets, ring and carrier. All tooth speeds are those against the carrier.

    The flange `planet` is the rotation of all planets against the carrier: planet bearings brake there. With
    `power_flow` "ideal" all forces follow from the torque at the carrier's shaft end, as if nothing were lost on the
    way; with "successive" each contact carries what arrives at it.
    """

    carrier = Flange()
    sun = Flange()
    ring = Flange()
    planet = Flange()
    carrier_load = BearingLoad()
    sun_load = BearingLoad()
    planet_load = BearingLoad()
    reading = ShaftReading()

    power_flow = Choice(
        ("successive", "ideal"),
        "ideal: mesh forces from the input torque; successive: each stage sees upstream losses",
        default="successive",
    )
    N = Parameter("1", "number of planets", above=0.0, whole=True)
    z_3 = Parameter("1", "number of teeth of the ring", above=0.0, whole=True)
    eps_alpha_sp = Parameter("1", "transverse contact ratio sun-planet", above=0.0)
    eps_alpha_pr = Parameter("1", "transverse contact ratio planet-ring", above=0.0)
    H_v_sp = Parameter("1", "tooth loss factor sun-planet", nominal=0.1, at_least=0.0)
    H_v_pr = Parameter("1", "tooth loss factor planet-ring", nominal=0.1, at_least=0.0)
    n_axial_carrier = Parameter("1", "planets whose axial force loads each carrier bearing", at_least=0.0)
    n_axial_sun = Parameter("1", "planets whose axial force loads the sun's bearing", at_least=0.0)
    s_planet = Parameter("m", "distance of the two bearings of a planet", nominal=0.02, above=0.0)
    tau_loss_sp = Output("N.m", "friction torque sun-planet, on the sun", nominal=1.0, at_least=0.0, guess=0.0)
    tau_loss_pr = Output("N.m", "friction torque planet-ring, on the sun", nominal=1.0, at_least=0.0, guess=0.0)
    P_loss_sp = Output("W", "loss of the sun-planet meshes", nominal=100.0, at_least=0.0)
    P_loss_pr = Output("W", "loss of the planet-ring meshes", nominal=100.0, at_least=0.0)
    F_t_sp = Output("N", "tangential force of a sun-planet mesh", nominal=1000.0)
    F_t_pr = Output("N", "tangential force of a planet-ring mesh", nominal=1000.0)
    mu_sp = Output("1", "tooth friction coefficient sun-planet", nominal=0.1)
    mu_pr = Output("1", "tooth friction coefficient planet-ring", nominal=0.1)
    Lambda_sp = Output("1", "specific film thickness sun-planet")
    Lambda_pr = Output("1", "specific film thickness planet-ring")

    def relations(self) -> Iterator[Related]:
        """Sun, planets and ring fit into each other, and the planets beside each other."""
        yield from super().relations()
        yield self.relation(
            "a_w lies near the reference distance",
            "sum of profile shifts of sun and planet that a_w asks for",
            self.shift_sum(),
            -1.5,
            2.5,
            remedy="Give the a_w that belongs to z_1, z_2, m_n and beta.",
        )
        yield self.relation(
            "z_3 fits z_1 + 2 z_2",
            "z_3 - z_1 - 2 z_2",
            self.z_3 - self.z_1 - 2 * self.z_2,
            -4.0,
            4.0,
            remedy="Give the number of teeth of the ring that encloses sun and planets.",
        )
        places = (self.z_1 + self.z_3) / self.N
        yield self.relation(
            "the planets stand at equal angles",
            "(z_1 + z_3) / N less the next whole number",
            places - ca.floor(places + 0.5),
            -1e-6,
            1e-6,
            remedy="Choose z_1 + z_3 as a multiple of the number of planets.",
        )
        tip = tip_diameter(2 * self.radius(self.z_2), self.m_n, 0.0)
        yield self.relation(
            "neighbouring planets do not touch",
            "clearance of the tips of two planets",
            2 * self.a_w * ca.sin(ca.pi / ca.fmax(self.N, 2)) - tip,
            0.0,
            unit="m",
            remedy="Give fewer planets, or planets with fewer teeth.",
        )
        for key in ("n_axial_carrier", "n_axial_sun"):
            remedy, most = "Give at most the number of planets.", 1 + LOAD_LEFT
            yield self.relation(f"{key} fits N", f"{key} / N", getattr(self, key) / self.N, 0.0, most, remedy=remedy)

    def equations(self) -> Iterator[Equation]:
        """Kinematics, torques, and the two kinds of meshes."""
        w = self.sun.w - self.carrier.w
        i_0, sign = self.z_3 / self.z_1, friction_sign(w)
        losses = sign * (self.tau_loss_sp + self.tau_loss_pr)
        yield equation("Willis", self.sun.w + i_0 * self.ring.w, (1 + i_0) * self.carrier.w)
        yield equation("planets roll on the sun", self.planet.w, -w * self.z_1 / self.z_2)
        yield equation("torques balance", self.sun.tau + self.ring.tau + self.carrier.tau, 0)
        passed = self.ring.tau / i_0 + self.planet.tau * self.z_1 / self.z_2
        yield equation("power against the carrier", self.sun.tau, passed + losses)
        yield from self._meshes(w, sign)
        yield from self._loads()
        yield equation("loss heats the gears", self.gears.Q_flow, -(self.P_loss_sp + self.P_loss_pr))

    def _meshes(self, w: Num, sign: Num) -> Iterator[Equation]:
        """Forces, friction and loss of both kinds of meshes; torques are those of all planets, on the sun."""
        r = self.radius(self.z_1)
        sp, pr = self._transmitted(sign)
        contact_sp = self.contact(self.eps_alpha_sp, self.z_1, self.z_2)
        contact_pr = self.contact(self.eps_alpha_pr, self.z_2, -self.z_3)
        mu_sp, Lambda_sp = self.friction(contact_sp, self.F_t_sp, w)
        mu_pr, Lambda_pr = self.friction(contact_pr, self.F_t_pr, self.planet.w)
        yield equation("force sun-planet", self.F_t_sp, sp / (self.N * r))
        yield equation("force planet-ring", self.F_t_pr, pr / (self.N * r))
        yield equation("friction sun-planet", self.mu_sp, mu_sp)
        yield equation("friction planet-ring", self.mu_pr, mu_pr)
        yield equation("film sun-planet", self.Lambda_sp, Lambda_sp)
        yield equation("film planet-ring", self.Lambda_pr, Lambda_pr)
        half = 0.5 if self.power_flow == "successive" else 0.0
        loss_sp = mesh_loss(sp + half * self.tau_loss_sp, self.mu_sp, self.H_v_sp)
        loss_pr = mesh_loss(pr + half * self.tau_loss_pr, self.mu_pr, self.H_v_pr)
        yield equation("loss sun-planet", self.tau_loss_sp, loss_sp)
        yield equation("loss planet-ring", self.tau_loss_pr, loss_pr)
        yield equation("power sun-planet", self.P_loss_sp, self.tau_loss_sp * sign * w)
        yield equation("power planet-ring", self.P_loss_pr, self.tau_loss_pr * sign * w)

    def _transmitted(self, sign: Num) -> tuple[Num, Num]:
        """Mean of the torques before and behind each kind of mesh, magnitude, on the sun."""
        if self.power_flow == "ideal":
            ideal = smooth_abs(self.reading.tau, self.tau_width) * self.z_1 / (self.z_1 + self.z_3)
            return ideal, ideal
        from_ring = self.ring.tau * self.z_1 / self.z_3
        return (
            smooth_abs(self.sun.tau - sign * self.tau_loss_sp / 2, self.tau_width),
            smooth_abs(from_ring + sign * self.tau_loss_pr / 2, self.tau_width),
        )

    def _loads(self) -> Iterator[Equation]:
        """What the bearings carry."""
        F_t, r = (self.F_t_sp + self.F_t_pr) / 2, self.radius(self.z_1)
        tilt = 2 * F_t * ca.tan(self.beta) * r / self.s_planet
        yield equation("carrier radially", self.carrier_load.F_r, 0)
        yield equation("carrier axially", self.carrier_load.F_a, self.n_axial_carrier * F_t * ca.tan(self.beta))
        yield equation("sun radially", self.sun_load.F_r, 0)
        yield equation("sun axially", self.sun_load.F_a, self.n_axial_sun * self.F_t_sp * ca.tan(self.beta))
        yield equation("planet radially", self.planet_load.F_r, ca.sqrt(F_t**2 + tilt**2))
        yield equation("planet axially", self.planet_load.F_a, 0)
