"""A mesh cycle of a rig solved as one transient, beside what an article on RV reducers states of its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import log, pi

import numpy as np

from ....model.contact import Contact, Film, Lubricant
from ....model.contact.line import solve_line
from ....model.contact.line_cycle import solve_line_cycle
from ....model.errors import ScenarioError
from ....model.laws.film import asperity_share
from ....scenarios.load import load
from ...solve.losses import contacts_part
from .rows import Found, Job, row

#: First and last angle of the cycle, as in the article [deg].
ANGLES = (30.0, 120.0)
#: Number of angles, as in the article.
POINTS = 15
#: Nodes of the line contact.
NODES = 321
#: Time steps between two angles.
STEPS = 2
#: Domain of the transient over the half width of each Hertz contact.
DOMAIN = (-4.0, 1.5)
#: What a part with contacts has to tell beside its table.
KEYS = ("eta_oil", "alpha_p", "E_eff", "b", "sigma", "w_crank")
#: Specific film thickness of the article [1].
LAMBDA_BAND = (0.65, 0.75)
#: Share of the load on asperities in the article [1].
SHARE_BAND = (0.25, 0.35)
#: Reduced radii of the article's films [mm].
RADII = (1.0, 3.0, 5.0, 8.0)
#: The article's films [nm].
FILMS = (225.0, 180.0, 155.0, 130.0)
#: The article's exponent of the largest pressure over the load [1].
EXPONENT = 0.10


@dataclass(frozen=True)
class Cycle:
    """The contacts of a mesh cycle.

    Args:
        angles: of the pin [deg]
        times: [s]
        contacts: the contact at each of them
        regression: central film by formula [m]
        sigma: composite roughness [m]
    """

    angles: Sequence[float]
    times: Sequence[float]
    contacts: Sequence[Contact]
    regression: Sequence[float]
    sigma: float


def jobs(rig: str) -> list[Job]:
    """The piece of work of a rig with a mesh of pins, by its name or path."""
    return [Job("Mesh cycle", rig, lambda: _work(rig))]


def _cycle_of(rig: str) -> Cycle:
    """The mesh cycle of a rig at its operating point."""
    scenario = load(rig)
    part, values = contacts_part(scenario)
    missing = [key for key in KEYS if key not in values]
    if missing:
        raise ScenarioError(f"{scenario.name}: {part.name} does not tell {', '.join(missing)}. Take another rig.")
    oil = Lubricant(values["eta_oil"], values["alpha_p"])
    angles, rows = np.linspace(*ANGLES, POINTS), part.contact_table(values).rows
    column = {key: np.interp(angles, *_columns(rows, key)) for key in ("R_m", "w_N_m", "U_m_s", "v_slide_m_s", "h_c_m")}
    contacts = [
        Contact(
            F=w * values["b"],
            R_x=R,
            u_1=u + v / 2,
            u_2=u - v / 2,
            E_eff=values["E_eff"],
            lubricant=oil,
            length=values["b"],
        )
        for R, w, u, v in zip(*(column[k] for k in ("R_m", "w_N_m", "U_m_s", "v_slide_m_s")), strict=True)
    ]
    times = (angles - angles[0]) * pi / 180 / abs(values["w_crank"])
    return Cycle(angles.tolist(), times.tolist(), contacts, column["h_c_m"].tolist(), values["sigma"])


def _columns(rows: Sequence[Mapping[str, float]], key: str) -> tuple[list[float], list[float]]:
    return [r["theta_deg"] for r in rows], [r[key] for r in rows]


def _work(rig: str) -> Found:
    """The transient, the steady contacts at the same angles, and the article's trends solved."""
    cycle = _cycle_of(rig)
    moving = solve_line_cycle(cycle.contacts, cycle.times, n=NODES, steps=STEPS, domain=DOMAIN)
    still = [solve_line(c, n=NODES) for c in cycle.contacts]
    h = [1e9 * f.h_c for f in moving]
    ratio = [f.h_c / cycle.sigma for f in moving]
    lowest = int(np.argmin(h))
    worst = max((abs(f.load_error) for f in (*moving, *still)), default=0.0)
    middle = cycle.contacts[POINTS // 2]
    films = [1e9 * solve_line(replace(middle, R_x=1e-3 * R), n=NODES).h_c for R in RADII]
    pressed = [float(solve_line(replace(middle, F=f * middle.F), n=NODES).p.max()) for f in (1.0, 1.25)]
    slope, printed = (float(np.polyfit(np.log(RADII), np.log(v), 1)[0]) for v in (films, FILMS))
    least, most = min(ratio), max(ratio)
    rows = [
        row("exponent of the film over R, at fixed load", "h_c ~ R^n", printed, slope, 0.0, worst),
        row(
            "exponent of the largest pressure over the load",
            "p_max ~ w^n",
            EXPONENT,
            log(pressed[1] / pressed[0]) / log(1.25),
            0.0,
        ),
        row("lowest specific film thickness", "h_c/sigma", LAMBDA_BAND[0], least, 0.0, worst),
        row("highest specific film thickness", "h_c/sigma", LAMBDA_BAND[1], most, 0.0, worst),
        row("largest asperity share, fit of gear tests", "share", SHARE_BAND[1], float(asperity_share(least)), 0.0),
        row("asperity share at h_c/sigma = 0.65, fit of gear tests", "share", 0.35, float(asperity_share(0.65)), 0.0),
        row("asperity share at h_c/sigma = 0.75, fit of gear tests", "share", 0.25, float(asperity_share(0.75)), 0.0),
        row("transient over steady film, at the thinnest", "h_c", 1e9 * still[lowest].h_c, h[lowest], 0.0, worst),
        row("maxima of the pressure at the thinnest film", "number", 3.0, float(_maxima(moving[lowest])), 0.0),
    ]
    at = [0, lowest, POINTS - 1]
    return {
        "rows": rows,
        "angles": cycle.angles,
        "load": [c.F / c.length / 1e3 for c in cycle.contacts],
        "transient": h,
        "steady": [1e9 * f.h_c for f in still],
        "regression": [1e9 * v for v in cycle.regression],
        "ratio": ratio,
        "share": [float(asperity_share(r)) for r in ratio],
        "profiles": [{"angle": cycle.angles[i], "x": 1e6 * moving[i].x, "p": np.ravel(moving[i].p) / 1e9} for i in at],
    }


def _maxima(film: Film) -> int:
    """Number of maxima of the pressure along the direction of rolling."""
    p = np.ravel(film.p)
    inner = p[1:-1]
    return int(np.count_nonzero((inner > p[:-2]) & (inner >= p[2:]) & (inner > 0.01 * p.max())))
