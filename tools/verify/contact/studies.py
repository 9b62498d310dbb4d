"""Studies of the solver itself: order of convergence, cost per unknown."""

from __future__ import annotations

import time
from itertools import pairwise
from math import log2

import numpy as np

from ....model.contact import hertz, solve
from . import cases
from .rows import Found, Job, bound

#: Load number of Moes of the contact of the studies [1].
M_STUDY = 20.0
#: Material number of Moes of the contact of the studies [1].
L_STUDY = 10.0
DOMAIN = (-4.5, 1.5, 3.0)
#: Nodes along a side of the grids of the study.
GRIDS = (65, 129, 257, 513)
#: The same of the quick subset.
QUICK_GRIDS = (33, 65, 129)
#: What is of second order; the pressure has a spike that grows with every grid, and the moment contains it.
FILMS = ("h_c", "h_min", "h, rms")
#: Least order that counts as the second.
SECOND = 1.7
#: Largest processor time of a contact on 257 x 257 nodes [s].
MOST_SECONDS = 10.0
#: Largest growth of the cost of an unknown from grid to grid [1].
MOST_GROWTH = 2.0


def jobs(quick: bool) -> list[Job]:
    """The pieces of work.

    Args:
        quick: on fewer and coarser grids
    """
    grids = QUICK_GRIDS if quick else GRIDS
    return [
        Job("Convergence", "circular contact", lambda: _order(grids), quick=True),
        Job("Cost", "circular contact", lambda: _cost(grids)),
        Job("Shape", "circular contact", _shape),
    ]


def _order(grids: tuple[int, ...]) -> Found:
    """Differences between grids of halved distances, and the order they fall with."""
    contact, _ = cases.circular(M_STUDY, L_STUDY)
    films = [solve(contact, n=n, domain=DOMAIN, tolerance=1e-9) for n in grids]
    pairs = list(pairwise(films))
    apart = {
        "h_c": [abs(a.h_c - b.h_c) / b.h_c for a, b in pairs],
        "h_min": [abs(a.h_min - b.h_min) / b.h_min for a, b in pairs],
        "h, rms": [_rms(a.h, b.h) for a, b in pairs],
        "p, rms": [_rms(a.p, b.p) for a, b in pairs],
        "rolling moment": [abs(a.rolling_moment / b.rolling_moment - 1) for a, b in pairs],
    }
    name = f"M {M_STUDY:g} L {L_STUDY:g}, {grids[-3]}, {grids[-2]}, {grids[-1]} nodes a side"
    orders = {what: log2(d[-2] / d[-1]) for what, d in apart.items()}
    rows = [
        bound(name, f"order of {what}", order, least=SECOND, judged=what in FILMS) for what, order in orders.items()
    ]
    a = hertz(contact).a
    spacing = [(f.x[1] - f.x[0]) / a for f in films]
    return {"rows": rows, "spacing": spacing, "apart": apart, "residuals": films[-1].residuals}


def _rms(coarse: np.ndarray, fine: np.ndarray) -> float:
    """Difference of two fields at the nodes they share, over the field; only where the surfaces are near."""
    near = fine[::2, ::2]
    inner = (slice(near.shape[0] // 2, -1), slice(near.shape[1] // 4, -near.shape[1] // 4))
    return float(np.sqrt(np.mean((coarse - near)[inner] ** 2) / np.mean(near[inner] ** 2)))


def _cost(grids: tuple[int, ...]) -> Found:
    """Processor time of a contact, from no guess to the solution, on one core."""
    contact, _ = cases.circular(M_STUDY, L_STUDY)
    seconds, work = [], []
    for n in grids:
        begun = time.process_time()
        film = solve(contact, n=n)
        seconds.append(time.process_time() - begun)
        work.append(film.work)
    each = [1e6 * s / n**2 for s, n in zip(seconds, grids, strict=True)]
    name = f"M {M_STUDY:g} L {L_STUDY:g}"
    growth = f"{grids[-1]}^2 over {grids[0]}^2 nodes, cost per unknown"
    rows = [bound(name, growth, each[-1] / each[0], most=MOST_GROWTH)]
    if 257 in grids:
        rows.append(bound(name, "257 x 257 nodes, processor time [s]", seconds[grids.index(257)], most=MOST_SECONDS))
    return {"rows": rows, "nodes": grids, "us_per_unknown": each, "products": work}


def _shape() -> Found:
    """Film and pressure over the plane, for the figure."""
    contact, _ = cases.circular(M_STUDY, L_STUDY)
    film, dry = solve(contact, n=129, domain=DOMAIN), hertz(contact)
    return {"x": film.x / dry.a, "y": film.y / dry.a, "p": film.p / dry.p_max, "h": film.h / film.h_c}
