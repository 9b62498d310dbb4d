"""A dent that moves through the contact: it travels with its surface, the film that it disturbs with the oil."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from ....model.contact import hertz, solve, solve_transient
from . import cases
from .rows import Found, Job, row
from .studies import DOMAIN, L_STUDY, M_STUDY

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
    """The pieces of work.

    Args:
        quick: with few steps
    """
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
