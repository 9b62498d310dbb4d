"""The contacts of a cycloid disc with its pins in numbers: table, single contact, mesh cycle, torque recovery."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf, pi, radians

from ..laws.film import asperity_share
from .contacts import ContactCase, ContactTable
from .pin_mesh import Film, PinMesh

#: What the columns of the table hold. Speeds are magnitudes.
COLUMNS = {
    "theta_deg": "angle of the pin from the crank's line [deg]; the loaded half",
    "R_m": "reduced radius of disc and pin [m]",
    "w_N_m": "load per width of a disc [N/m]",
    "U_m_s": "mean entrainment speed of disc and pin [m/s]",
    "v_slide_m_s": "sliding speed between disc and pin [m/s]; 0 where the pin rolls and slides in its groove instead",
    "p_H_Pa": "greatest Hertzian pressure of disc and pin [Pa]",
    "h_min_m": "minimum film between disc and pin, Dowson and Higginson or the film map [m]",
    "h_c_m": "central film between disc and pin, Moes or the film map [m]",
    "Lambda": "central film over composite roughness [1]",
    "asperity_share": "share of the load that asperities carry [1]",
    "mu": "friction coefficient between disc and pin [1]",
}
#: Positions of the ring of pins against the crank at which the torque is recovered.
POSITIONS = 40


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
