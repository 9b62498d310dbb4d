"""Pictures of what logs say: what is left in each window, by time, without and with what has moved."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ....scenarios.measured.table import Sensor
from ..infer.logs import Fleet, Moved, Question
from ..model.windows import Windows
from . import channels
from .evidence import Picture, Rows
from .numbers import array

DAY = 86400.0


def pictures(
    known: Fleet, asked: Question, moved: Sequence[Moved], read: Sequence[Sensor]
) -> tuple[Rows, tuple[Picture, ...]]:
    """The windows as rows, the machine's healthy past before those in question, and a picture a cause.

    Args:
        known: what the healthy logs say
        asked: the logs in question
        moved: causes, each in its leading form, the likeliest first
        read: the sensors that are compared
    """
    own, level = known.filter, known.levels.mean[0]
    past, now = known.past.some(known.machine_of[known.season] == 0), asked.windows
    by_time = np.argsort(np.r_[past.time, now.time], kind="stable")

    def left(data: Windows, z: np.ndarray) -> np.ndarray:
        """Measured less simulated, free-running: means of the windows (n, reads)."""
        return np.asarray(np.nanmean(own.run(data, z, free=True, slopes=False).error, axis=1))

    def whole(part: np.ndarray) -> np.ndarray:
        """Past and present in the order of time; the past is as it is."""
        return np.asarray(np.concatenate([healthy, part])[by_time].T)

    healthy, at = left(past, np.tile(level, (len(past.time), 1))), np.tile(level, (len(now.time), 1))
    before, after = left(now, at), []
    for m in moved:
        z = at.copy()
        z[:, known.knobs.index(m.knob)] += m.share * m.size
        after.append(left(now, z))
    counted = [np.where(d.counts[:, :, None], d.read, np.nan) for d in (past, now)]
    measured = np.concatenate([np.nanmean(c, axis=1) for c in counted if len(c)])[by_time].T
    shown = {}
    for j, s in enumerate(read):
        lines = [measured[j], *(measured[j] - whole(e)[j] for e in (before, *after[:1]))]
        values = [array(channels.in_unit(s, line)) for line in lines]
        shown[s.name] = Rows.Values(measured=values[0], nominal=values[1], extended=values[2] if after else ())
    days = (np.sort(np.r_[past.time, now.time]) - now.time.min()) / DAY
    time = Rows.Quantity(label="time since the first log in question", unit="d", values=array(days))
    found = []
    for m, e in zip(moved, after, strict=True):
        best = int(np.argmax(np.nanmean(before**2 - e**2, axis=0)))  # where most is taken away
        lines = [array(channels.difference(read[best], 1.0) * whole(part)[best]) for part in (before, e)]
        found.append(
            Picture(cause=m.knob.cause, channel=read[best].name, quantity="time", before=lines[0], after=lines[1])
        )
    n = len(days)
    return Rows(row=tuple(range(1, n + 1)), channels=shown, quantities={"time": time}), tuple(found)
