"""The scatter of logged courses, each part of it one function."""

from __future__ import annotations

import numpy as np

from .entries import DWELL
from .observe import Observed

#: Variance of a smoothed course over that of independent samples, which those of a probe are not quite.
ALLOWED = 1.5
#: What the model leaves of a course [K].
LEFT = 0.25
#: Over how long a share of the dwell.
LENGTH = 0.3
#: Decay, per dwell, of what a start at another temperature than that of the room as read leaves in a course.
BEGUN = 3.0
#: Powers of the share of the dwell to come by which a remainder fades along a course: the highest are the first
#: minutes, when every rig's gears, oil and wall warm in their own way, and the oil is as thick as the room is cold.
FADING = (1, 2, 4, 8, 16)


def along(o: Observed) -> np.ndarray:
    """Which entries lie along logged courses (m,)."""
    return np.asarray((o.kind >= len(o.read)) & (o.entries.sensor >= 0))


def shares(o: Observed) -> np.ndarray:
    """Share of its dwell at which each entry was read (m,)."""
    return np.asarray(o.entries.share[o.entries.at])


def smoothed(o: Observed) -> np.ndarray:
    """Scatter of the smooth curves through all samples (m, m)."""
    found = np.zeros((o.m, o.m))
    place: dict[tuple[str, int], list[int]] = {}
    for i in np.flatnonzero(along(o)):
        place.setdefault((o.read[o.entries.sensor[i]].name, int(o.row[i])), []).append(int(i))
    for course in o.campaign.series.courses if o.campaign.series else ():
        own, known = place.get((course.sensor, course.row), []), np.isfinite(course.values)
        sd = o.campaign.sensor(course.sensor).repeat_sd
        found[np.ix_(own, own)] = ALLOWED * sd**2 * course.scatter[np.ix_(known, known)]
    return found


def model_error(o: Observed) -> np.ndarray:
    """What the model leaves of each course, smooth along it (m, m)."""
    mine, share = along(o), shares(o)
    same = (o.kind[:, None] == o.kind) & (o.row[:, None] == o.row) & np.outer(mine, mine)
    return np.asarray(same * LEFT**2 * np.exp(-0.5 * ((share[:, None] - share) / LENGTH) ** 2))


def start_error(o: Observed) -> np.ndarray:
    """Effects (m, rows) of dwells that begin at another temperature than the room's reading tells."""
    room = [s.repeat_sd for s in o.given if s.kind == "ambient"]
    fades = along(o) * np.exp(-BEGUN * shares(o)) * (room[0] if room else 0.0)
    return np.asarray(fades[:, None] * (o.row[:, None] == np.unique(o.row[along(o)])))


def dwells(o: Observed) -> np.ndarray:
    """Variance (m,) of dwells as logged."""
    return np.where(o.entries.sensor < 0, DWELL**2, 0.0)


def fading(o: Observed, linear: np.ndarray) -> np.ndarray:
    """Features (m, k) of a remainder that fades along courses, first dwells and later ones apart.

    Args:
        linear: features of the conditions (n, c)
    """
    later = o.half[o.row] > 0
    left = [(1 - shares(o)) ** power * side for power in FADING for side in (later, ~later)]
    return np.concatenate([(along(o) * fades)[:, None] * linear[o.row] for fades in left], axis=1)
