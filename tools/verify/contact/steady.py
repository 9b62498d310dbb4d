"""Steady contacts beside published films, Hertz, another solver's line contacts and measurements."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from math import pi
from typing import NamedTuple

import numpy as np

from ....model.contact import Contact, Lubricant, hertz, solve
from ....model.laws import film_point
from ....model.units import to_si
from . import cases
from .rows import Found, Job, row

#: Nodes along a side of the finer of two grids, for the films.
NODES = 129
#: The same of the quick subset.
QUICK = 65
#: The same of heavy contacts.
FINEST = 257
#: Load number of Moes from which a contact is heavy and needs the finest grid [1].
HEAVY = 200
#: Part of the plane in half widths in which the rolling moment is taken: first x, last x, largest y.
MOMENT_DOMAIN = (-4.5, 1.5, 3.0)


def jobs(quick: bool) -> list[Job]:
    """The pieces of work in the order of the table, the quick ones on a coarse grid."""
    n = QUICK if quick else NODES
    return [*_hamrock_dowson(n), *_nijenbanning(n), *_dry(n), *_rolling(n), *_ball_on_disc(n)]


class Extrapolated(NamedTuple):
    """Films of two grids extrapolated to nodes without distance, and the larger error of their loads."""

    h_c: float
    h_min: float
    load_error: float


def _extrapolate(contact: Contact, n: int) -> Extrapolated:
    """Films of second order on n and (n + 1)/2 nodes a side, extrapolated."""
    coarse, fine = solve(contact, n=(n + 1) // 2), solve(contact, n=n)
    return Extrapolated(
        (4 * fine.h_c - coarse.h_c) / 3,
        (4 * fine.h_min - coarse.h_min) / 3,
        max(abs(coarse.load_error), abs(fine.load_error)),
    )


def _other_reading(M: float, L: float) -> float:
    """The formula with its isoviscous terms blended as public code has them, D = 1."""
    H_RI, H_EI, stiff, s = map(float, film_point.nijenbanning_asymptotes(M, L, 1.0))
    isoviscous = (H_RI ** (1.5 * s) + H_EI ** (1.5 * s)) ** (2 / (3 * s))
    return float((isoviscous + stiff**s) ** (1 / s))


def _hamrock_dowson(n: int) -> list[Job]:
    data = cases.reference("hamrock_dowson")

    def work(U: float, W: float, G: float, k: float, varied: str) -> Found:
        contact = cases.elliptical(U, W, G, k)
        film = _extrapolate(contact, FINEST if n > QUICK else n)
        numbers = (U, G, W, k)
        name = f"U {U:g} W {W:g} G {G:g} k {k:g}"
        low, middle = film_point.hamrock_dowson_minimum(*numbers), film_point.hamrock_dowson_central(*numbers)
        where, rel = (", corners of the range", 0.0) if varied == "corner" else ("", data.rel)
        return {
            "rows": [
                row(name, f"h_min/R_x{where}", float(low), film.h_min / contact.R_x, rel, film.load_error),
                row(name, f"h_c/R_x{where}", float(middle), film.h_c / contact.R_x, 0.0, film.load_error),
            ]
        }

    found = []
    for i, r in enumerate(data.rows):
        of = partial(work, r["U"], r["W"], r["G"], r["k"], r["varied"])
        found.append(Job("Hamrock and Dowson", f"{i + 1:02d} {r['varied']}", of, quick=i in (0, 7)))
    return found


def _nijenbanning(n: int) -> list[Job]:
    """M and L alone describe a contact whose oil is incompressible and follows Barus, so it is and does here."""
    data = cases.reference("nvm")

    def work(M: float, L: float, H: float) -> Found:
        contact, U = cases.circular(M, L)
        contact = replace(contact, lubricant=cases.SIMPLE_OIL)
        film = _extrapolate(contact, FINEST if M >= HEAVY and n > QUICK else n)
        ours = film.h_c / contact.R_x / U**0.5
        name, other = f"M {M:g} L {L:g}", _other_reading(M, L)
        return {
            "rows": [
                row(name, "h_c/R_x U^(-1/2)", H, ours, data.rel, film.load_error),
                row(name, "h_c/R_x U^(-1/2), the other reading", other, ours, 0.0, film.load_error),
            ]
        }

    return [
        Job(
            "Nijenbanning, Venner and Moes",
            f"M {r['M']} L {r['L']}",
            partial(work, r["M"], r["L"], r["H_c"]),
            quick=(r["M"], r["L"]) == (20, 10),
        )
        for r in data.rows
    ]


def _dry(n: int) -> list[Job]:
    """Contacts at rest: pressure and approach of Hertz."""
    oil = Lubricant(0.04, 2.2e-8)
    resting = partial(Contact, F=100.0, R_x=0.01, E_eff=cases.E_STEEL, u_1=0.0, u_2=0.0, lubricant=oil)

    def work(name: str, contact: Contact) -> Found:
        film, dry = solve(contact, n=n), hertz(contact)
        cell = (film.x[1] - film.x[0]) * (film.y[1] - film.y[0])
        area = float(np.count_nonzero(film.p_asperity > 0) * cell)
        rows = [
            row(name, "largest pressure [GPa]", dry.p_max / 1e9, float(film.p.max()) / 1e9, 0.01, film.load_error),
            row(name, "approach [um]", 1e6 * dry.approach, 1e6 * film.approach, 0.01, film.load_error),
            row(
                name, "area where the surfaces touch [mm2]", 1e6 * pi * dry.a * dry.b, 1e6 * area, 0.0, film.load_error
            ),
        ]
        return {"rows": rows}

    shapes = {
        "circular, 100 N": resting(R_y=0.01),
        "elliptical, R_y = 4 R_x, 100 N": resting(R_y=0.04),
    }
    return [Job("Hertz", name, partial(work, name, c), quick=i == 0) for i, (name, c) in enumerate(shapes.items())]


def _rolling(n: int) -> list[Job]:
    data = cases.reference("rolling_moment")

    def work(M: float, L: float) -> Found:
        contact, U = cases.circular(M, L)
        film = solve(contact, n=n, domain=MOMENT_DOMAIN)
        ours = film.rolling_moment / (contact.E_eff * contact.R_x**3)
        wide = 2 * hertz(contact).a / contact.R_x
        name, what = f"M {M:g} L {L:g}", "M_r/(E_eff R_x^3), U with R ="
        readings = {"R_x R_y/(R_x + R_y)": (2 * U, data.rel), "R_x": (U, 0.0)}
        return {
            "rows": [
                row(name, f"{what} {radius}", wide * 1.8 * speed**0.75, ours, rel, film.load_error)
                for radius, (speed, rel) in readings.items()
            ]
        }

    return [
        Job("Rolling moment", f"M {r['M']} L {r['L']}", partial(work, r["M"], r["L"]), quick=False) for r in data.rows
    ]


def _ball_on_disc(n: int) -> list[Job]:
    data = cases.reference("ball_on_disc")
    more = data.more
    oil = Lubricant(to_si(more["eta_0"], "Pa.s"), to_si(more["alpha_p"], "1/Pa"))
    compliance = sum((1 - nu**2) / to_si(E, "Pa") for E, nu in zip(more["E"], more["nu"], strict=True))
    R, F = to_si(more["R"], "m"), to_si(more["F"], "N")

    def work(u: float, h: float) -> Found:
        contact = Contact(F=F, R_x=R, R_y=R, u_1=u, u_2=u, E_eff=2 / compliance, lubricant=oil)
        film = _extrapolate(contact, n)
        return {"rows": [row(f"{u:g} m/s", "h_c [nm]", h, 1e9 * film.h_c, 0.0, film.load_error)]}

    return [
        Job("Measured, ball on disc", f"{r['u_m [m/s]']:g}", partial(work, r["u_m [m/s]"], r["h_c [nm]"]))
        for r in data.rows
    ]
