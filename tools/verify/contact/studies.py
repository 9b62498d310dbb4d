"""Studies of the solver itself: order of convergence, cost per unknown, and a dent that moves through the contact.

The dent travels with its surface, the film that it disturbs with the oil.
"""

from __future__ import annotations

import time
from dataclasses import replace
from functools import partial
from itertools import pairwise
from math import log2

import numpy as np

from ....model.contact import hertz, solve, solve_transient
from . import cases
from .rows import Found, Job, bound, row

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
#: Depth of the dent over the central film [1].
DEPTH = 0.3
#: Width of the dent over a [1].
WIDTH = 0.25
#: Where the dent starts, over a [1].
START = -2.5
#: Part of the contact, over a, in which the disturbance is followed [1].
FOLLOWED = (-0.6, 0.6)
#: How far ahead of a slower dent it is followed, over a [1].
AHEAD = 0.4
#: Speed of the dented surface over the mean speed -> accepted distance of the disturbance's speed from the mean speed.
SPEEDS = {1.0: 0.03, 0.5: 0.05}


def jobs(quick: bool) -> list[Job]:
    """The pieces of work, the quick ones on fewer and coarser grids."""
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


def dent_jobs(quick: bool) -> list[Job]:
    """The pieces of work, the quick ones with few steps."""
    n, steps = (65, 48) if quick else (65, 96)
    return [
        Job("Moving dent", f"dented surface at {share:g} u_m", partial(_dent, share, n, steps), share == 1.0)
        for share in SPEEDS
    ]


def _dent(share: float, n: int, steps: int) -> Found:
    """Film along the middle over time, and the speed of what the dent brings into it."""
    contact, _ = cases.circular(M_STUDY, L_STUDY)
    a, u_m = hertz(contact).a, contact.u_m
    contact = replace(contact, u_1=(2 - share) * u_m, u_2=share * u_m)
    smooth = solve(contact, n=n, domain=DOMAIN)
    depth, width = DEPTH * smooth.h_c, WIDTH * a

    def height(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return np.asarray(-depth * np.exp(-((x - START * a) ** 2 + y**2) / width**2))

    times = np.linspace(0, (1.2 - START) * a / (share * u_m), steps + 1)
    films = solve_transient(
        times.tolist(), [contact] * len(times), n=n, domain=DOMAIN, roughness_2=height, tolerance=1e-5
    )
    middle = len(smooth.y) // 2
    x = smooth.x / a
    dents = np.array([height(smooth.x - share * u_m * t, np.zeros(1)) for t in times])
    change = np.array([f.h[:, middle] - smooth.h[:, middle] for f in films])
    if share != 1.0:  # the film alone, without the dent itself
        change += dents
    moments = times * u_m / a
    dent = START + share * moments
    places = [
        _place(x, line, at - AHEAD if share == 1.0 else at + AHEAD) for line, at in zip(change, dent, strict=True)
    ]
    inside = _find_moments(places, dent)
    slope = float(np.polyfit(moments[inside], np.array(places, dtype=float)[inside], 1)[0])
    name = f"M {M_STUDY:g} L {L_STUDY:g}, dented surface at {share:g} u_m"
    worst = max((f.load_error for f in films), key=abs)
    shown = [int(i) for i in np.linspace(0.45, 0.95, 6) * steps]
    return {
        "rows": [row(name, "speed of the disturbance over u_m", 1.0, slope, SPEEDS[share], worst)],
        "x": x,
        "moments": moments,
        "places": [None if at is None else float(at) for at in places],
        "dent": dent,
        "shown": [float(moments[i]) for i in shown],
        "films": [films[i].h[:, middle] / smooth.h_c for i in shown],
        "smooth": smooth.h[:, middle] / smooth.h_c,
    }


def _find_moments(places: list[float | None], dent: np.ndarray) -> list[int]:
    """Moments from when the disturbance first is in the middle of the contact until it leaves it."""
    found: list[int] = []
    for i, at in enumerate(places):
        if at is None or not FOLLOWED[0] < at < FOLLOWED[1] or dent[i] < -1.5:
            if found:
                break
            continue
        found.append(i)
    return found


def _place(x: np.ndarray, change: np.ndarray, from_: float) -> float | None:
    """Where a disturbance is largest within the contact, of the parabola through three nodes; None at the ends.

    Args:
        x: places over a
        change: film with the dent less the film without it
        from_: least place that counts, over a
    """
    inside = np.flatnonzero((np.abs(x) < 0.85) & (x > min(from_, FOLLOWED[1])))
    i = int(inside[np.argmax(np.abs(change[inside]))])
    if i in (inside[0], inside[-1]):
        return None
    low, mid, high = np.abs(change[i - 1 : i + 2])
    bend = low - 2 * mid + high
    return float(x[i] + (x[1] - x[0]) * (low - high) / (2 * bend)) if bend < 0 else None
