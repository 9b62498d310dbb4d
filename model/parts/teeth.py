"""What all gears with teeth have: geometry, roughness and material, and the friction of their contacts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar

import casadi as ca

from ..core.component import Component, Related
from ..core.declare import Choice, Parameter
from ..laws.film import film_thickness, specific_film_thickness, thermal_film_reduction
from ..laws.film_map import FilmMap
from ..laws.gears import (
    base_diameter,
    base_helix_angle,
    contact_length,
    curvature_radius,
    profile_shift_sum,
    reduced_radius,
    reference_diameter,
    transverse_pressure_angle,
    working_pressure_angle,
)
from ..laws.mesh import friction_schlenk, load_per_contact_length, load_per_face_width
from ..laws.smooth import Num, smooth_abs
from .ports import HeatPort, Lubricant
from .relations import require

#: Share of a_w that the base circles may take; at 1 the flanks would have no line of action.
ANGLE_LEFT = 0.9999


@dataclass(frozen=True)
class ToothContact:
    """One tooth contact at its pitch point: what does not depend on speed and load.

    `rho` radius of curvature of the first gear [m], `R` reduced radius normal to the teeth [m], `l` length of the
    lines of contact [m], `base` and `normal` base tangential and normal force over tangential force [1].
    """

    rho: Num
    R: Num
    l: Num  # noqa: E741
    base: Num
    normal: Num


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
    beta = Parameter("rad", "helix angle at the reference diameter, 0 for straight teeth", at_least=0.0, below=1.2)
    b = Parameter("m", "face width", nominal=0.05, above=0.0)
    a_w = Parameter("m", "working centre distance", nominal=0.1, above=0.0)
    Ra = Parameter("m", "roughness Ra of each flank", nominal=1e-6, above=0.0)
    k_mu = Parameter("1", "factor on the tooth friction", at_least=0.0)
    line_load = Choice(("F_bt/b", "F_bn/l"), "line load of the friction formula: per face width, or per contact length")
    E = Parameter("Pa", "modulus of elasticity of the gears", nominal=1e11, at_least=5e8)
    poisson = Parameter("1", "Poisson's ratio of the gears", at_least=0.0, below=0.5)
    tau_width = Parameter("N.m", "torque below which the direction of load is blurred", default=0.1, above=0.0)

    def teeth(self) -> tuple[Num, Num]:
        """Teeth of the two cylindrical gears that mesh alike, negative for an internal gear [1]."""
        return self.z_1, self.z_2

    def radius(self, z: Num) -> Num:
        """Reference radius of a gear of z teeth [m]."""
        return reference_diameter(self.m_n, z, self.beta) / 2

    def sizes(self) -> Mapping[str, Num]:
        """Reference radii of the first two gears."""
        return {"r_1": self.radius(self.z_1), "r_2": self.radius(self.z_2)}

    def working_angle(self) -> tuple[Num, Num]:
        """Transverse pressure angle of the first two gears, at the reference and the working centre distance [rad]."""
        alpha_t = transverse_pressure_angle(self.alpha_n, self.beta)
        return alpha_t, working_pressure_angle(alpha_t, ca.fabs(self.radius(sum(self.teeth()))), self.a_w)

    def shift_sum(self) -> Num:
        """Sum of the profile shifts of the first two gears that the working centre distance asks for [1]."""
        alpha_t, alpha_wt = self.working_angle()
        return profile_shift_sum(alpha_wt, alpha_t, self.alpha_n, sum(self.teeth()))

    def relations(self) -> Iterator[Related]:
        """The base circles of the first two gears leave room for a line of action."""
        alpha_t, _ = self.working_angle()
        least = ca.fabs(self.radius(sum(self.teeth()))) * ca.cos(alpha_t)
        yield require(self, "a_w is more than the base circles need", least / self.a_w, high=ANGLE_LEFT)

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
