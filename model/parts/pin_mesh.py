"""A cycloid disc's contact with a pin at an angle of the mesh cycle, symbolic or in numbers, and the table of all."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from math import inf, pi, radians

import casadi as ca
import numpy as np

from ..files import tables
from ..laws.cycloid_pin import (
    contact_speed,
    curvature,
    entrainment_speed,
    hertz_line_pressure,
    pin_lever,
    pin_load,
    pole_distance,
    reduced_radius,
    sliding_speed,
    width_coefficient,
)
from ..laws.film import asperity_share, mixed_friction, specific_film_thickness
from ..laws.film_line import line_film_central, line_film_minimum
from ..laws.film_map import FilmMap
from ..laws.smooth import Num
from .contacts import ContactCase, ContactTable

#: Angles of the fixed quadrature in each of the three parts of the loaded half of the mesh cycle.
ANGLES = 12
#: Cosine next to which angles are cut off, so that their slopes stay finite.
INSIDE = 1 - 1e-9
#: What the columns of the table hold.
COLUMNS: dict[str, str] = tables("model.parts", "pin_table.toml")
#: Positions of the ring of pins against the crank at which the torque is recovered.
POSITIONS = 40


@dataclass(frozen=True)
class Film:
    """What acts in a mesh at one moment: torque of a disc [N.m], speed of the crank's line against the pins [rad/s],
    dynamic viscosity [Pa.s] and pressure-viscosity coefficient [1/Pa] of the lubricant."""

    T_disc: Num
    w_crank: Num
    eta: Num
    alpha_p: Num


@dataclass(frozen=True)
class PinContact:
    """A contact of disc and pin.

    `theta` angle of the pin from the crank's line [rad], `F` force [N], `lever` about the disc's centre [m], `w` load
    per length [N/m], `R` reduced radius [m], `v_rub` speed at which the disc moves over the place of the pin [m/s],
    `u_disc` and `u_pin` speeds of both surfaces through the contact [m/s], `h_c` central film [m], `Lambda`
    specific film thickness [1], `mu` friction coefficient [1]. Speeds have the sign of the crank's speed.
    """

    theta: Num
    F: Num
    lever: Num
    w: Num
    R: Num
    v_rub: Num
    u_disc: Num
    u_pin: Num
    h_c: Num
    Lambda: Num
    mu: Num

    @property
    def U(self) -> Num:
        """Mean entrainment speed [m/s], signed."""
        return (self.u_disc + self.u_pin) / 2

    @property
    def v_slide(self) -> Num:
        """Speed at which the surfaces of disc and pin slide over each other [m/s]."""
        return self.u_disc - self.u_pin


@dataclass(frozen=True)
class PinMesh:
    """Geometry, material and friction of a mesh: what does not change over its cycle. See `CycloidPinStage`."""

    Zp: Num
    Rp: Num
    e: Num
    r_rp: Num
    b: Num
    E_eff: Num
    sigma: Num
    mu_fluid: Num
    mu_boundary: Num
    rolling: bool
    law: FilmMap | None = None

    @property
    def K(self) -> Num:
        """Short-width coefficient [1]."""
        return width_coefficient(self.e, self.Zp, self.Rp)

    def turning_angles(self) -> tuple[Num, Num]:
        """Angles at which the entrainment changes its direction [rad]; where it does not, where it comes nearest to it.

        With g = 1/2 (held) or 1 (rolling) the entrainment g v_s - v_c is zero where
        S^3 - p S^2 + q = 0, p = r_rp (2 g + Zc)/(2 g Rp), q = Zc r_rp (1 - K^2)/(2 g Rp).
        """
        K, Zc, g = self.K, self.Zp - 1, 1.0 if self.rolling else 0.5
        p = self.r_rp * (2 * g + Zc) / (2 * g * self.Rp)
        q = Zc * self.r_rp * (1 - K**2) / (2 * g * self.Rp)
        phi = ca.acos(ca.fmin(ca.fmax(1 - 13.5 * q / p**3, -INSIDE), INSIDE))
        angles = []
        for turn in (-2 * ca.pi, 0.0):
            S = p / 3 * (1 + 2 * ca.cos((phi + turn) / 3))
            c = (1 + K**2 - S**2) / (2 * K)
            angles.append(ca.acos(ca.fmin(ca.fmax(c, -INSIDE), INSIDE)))
        return angles[0], angles[1]

    def quadrature(self) -> list[tuple[Num, Num]]:
        """Angles and weights [rad] of a sum over the loaded half: Gauss's rule between the turns of the entrainment.

        The film closes at the turns, so that friction has a cusp there: the angles crowd towards them.
        """
        x, weights = np.polynomial.legendre.leggauss(ANGLES)
        ends = (0.0, *self.turning_angles(), float(np.pi))
        found = []
        for low, high in itertools.pairwise(ends):
            for t, weight in zip((1 + x) / 2, weights / 2, strict=True):
                at, slope = float(t**2 * (3 - 2 * t)), float(6 * t * (1 - t))
                found.append((low + (high - low) * at, (high - low) * slope * float(weight)))
        return found

    def contact(self, theta: Num, film: Film) -> PinContact:
        """The contact of a pin at an angle of the loaded half.

        Args:
            theta: angle of the pin from the crank's line, 0 to pi [rad]
            film: what acts in the mesh
        """
        K, Zc = self.K, self.Zp - 1
        F = pin_load(film.T_disc, K, Zc, self.Rp, theta)
        R = reduced_radius(curvature(K, self.Zp, self.Rp, theta), self.r_rp)
        v_rub = sliding_speed(film.w_crank, K, Zc, self.Rp, self.r_rp, theta)
        v_contact = contact_speed(film.w_crank, K, self.r_rp, theta)
        roll = 1.0 if self.rolling else 0.0
        u_sum = 2 * entrainment_speed(v_rub, v_contact, roll)
        u_disc = v_rub - v_contact
        w = F / self.b
        if self.law is not None:
            h_c, _ = self.law.films(film.eta, u_sum, w, R)
        else:
            h_c = line_film_central(film.eta, u_sum, film.alpha_p, w, R, self.E_eff)
        Lambda = specific_film_thickness(h_c, self.sigma)
        mu = mixed_friction(Lambda, self.mu_fluid, self.mu_boundary)
        lever = pin_lever(K, self.Zp, self.Rp, theta)
        return PinContact(theta, F, lever, w, R, v_rub, u_disc, u_sum - u_disc, h_c, Lambda, mu)

    def groove_friction(self, contact: PinContact, clearance: Num, sigma: Num, film: Film) -> Num:
        """Friction coefficient of a rolling pin in its groove [1]: a film between two surfaces that all but conform.

        Args:
            contact: of the pin with the disc
            clearance: radius of the groove less that of the pin [m]
            sigma: composite roughness of pin and groove [m]
            film: what acts in the mesh
        """
        R = self.r_rp * (self.r_rp + clearance) / clearance
        h = line_film_central(film.eta, contact.v_rub, film.alpha_p, contact.w, R, self.E_eff)
        return mixed_friction(specific_film_thickness(h, sigma), self.mu_fluid, self.mu_boundary)

    def rubbing_lever(self, contact: PinContact) -> Num:
        """Speed at which the disc moves over the place of the pin, over that of carrier against housing [m]."""
        return self.Rp * pole_distance(self.K, contact.theta) - self.r_rp

    def minimum_film(self, contact: PinContact, film: Film) -> Num:
        """Minimum film between disc and pin [m].

        Args:
            contact: of the pin with the disc
            film: what acts in the mesh
        """
        if self.law is not None:
            return self.law.films(film.eta, 2 * contact.U, contact.w, contact.R)[1]
        return line_film_minimum(film.eta, 2 * contact.U, film.alpha_p, contact.w, contact.R, self.E_eff)

    def pressure(self, contact: PinContact) -> Num:
        """Greatest pressure of the dry contact [Pa]."""
        return hertz_line_pressure(contact.w, contact.R, self.E_eff)

    def towards_pole(self, contact: PinContact) -> tuple[Num, Num]:
        """Direction of the pin's force on the disc, along the crank's line and across it [1]."""
        S = pole_distance(self.K, contact.theta)
        return (self.K - ca.cos(contact.theta)) / S, -ca.sin(contact.theta) / S


def pin_table(mesh: PinMesh, film: Film) -> ContactTable:
    """Every degree of the loaded half, and how much of the torque the loads recover.

    Args:
        mesh: geometry, material and friction, in numbers
        film: torque, speed and lubricant, in numbers
    """
    rows = [_row(mesh, film, degree) for degree in range(181)]
    sums = list(_recover(mesh, film))
    worst, at = max(sums, key=lambda found: abs(found[0] - 1))
    totals = {
        "torque_recovery": sum(found for found, _ in sums) / len(sums),
        "torque_recovery_worst": worst,
        "torque_recovery_worst_theta_deg": at,
    }
    return ContactTable(rows, COLUMNS, totals)


def _row(mesh: PinMesh, film: Film, degree: int) -> dict[str, float]:
    contact = mesh.contact(radians(degree), film)
    w = max(float(contact.w), 0.0) if 0 < degree < 180 else 0.0
    found = {
        **{"theta_deg": degree, "R_m": contact.R, "w_N_m": w},
        **{"U_m_s": abs(contact.U), "v_slide_m_s": abs(contact.v_slide)},
        **{"p_H_Pa": mesh.pressure(contact) if w > 0 else 0.0},
        **{"h_min_m": mesh.minimum_film(contact, film), "h_c_m": contact.h_c, "Lambda": contact.Lambda},
        **{"asperity_share": asperity_share(contact.Lambda), "mu": contact.mu},
    }
    return {key: float(value) for key, value in found.items()}


def _recover(mesh: PinMesh, film: Film) -> Iterator[tuple[float, float]]:
    """Sum of force times lever over the torque of a disc, and the angle of the first pin [deg], over a pin's pitch."""
    pitch = 2 * pi / mesh.Zp
    for k in range(POSITIONS):
        first = pitch * k / POSITIONS
        angles = [first + pitch * i for i in range(int(mesh.Zp)) if first + pitch * i < pi]
        contacts = [mesh.contact(theta, film) for theta in angles]
        yield sum(float(c.F * c.lever) for c in contacts) / film.T_disc, first * 180 / pi


def pin_case(mesh: PinMesh, film: Film, theta: float) -> ContactCase:
    """One contact for a contact solver; its time is that of the crank's way from where the load begins.

    Args:
        mesh: geometry, material and friction, in numbers
        film: torque, speed and lubricant, in numbers
        theta: angle of the pin from the crank's line [rad]
    """
    c = mesh.contact(theta, film)
    time = theta / abs(film.w_crank) if film.w_crank else inf
    there = (c.F, c.R, mesh.b, c.u_disc, c.u_pin, mesh.E_eff, mesh.sigma, mesh.mu_boundary)
    oil = {"eta_0": float(film.eta), "alpha_p": float(film.alpha_p)}
    return ContactCase(*map(float, there), time=float(time), theta=theta, **oil)
