"""What a healthy machine shows in a window: a free run at the machine's own knobs, with its spread."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..diagnose.infer.levels import open_at
from ..diagnose.infer.logs import Fleet
from ..diagnose.model.windows import Windows, means


@dataclass(frozen=True, eq=False)
class Expected:
    """Means over one window, by reading [K] (reads,): measured, predicted, and standard deviation of the difference."""

    measured: np.ndarray
    predicted: np.ndarray
    sd: np.ndarray


def expect(known: Fleet, window: Windows) -> Expected:
    """What a machine shows in a window if it is as its healthy past and its type.

    Knobs scatter between healthy seasons and windows as the healthy logs tell; the readings about the model as the
    filter's do, independent as often as its errors are.

    Args:
        known: what the healthy logs say; the machine is the first
        window: one of its logs
    """
    own, levels = known.filter, known.levels
    sd = np.array([k.sd for k in own.knobs])
    duty = known.duty.at(window)
    z = known.curves.back(known.does(window) + np.vstack([np.zeros(len(sd)), np.diag(sd)]))
    passed = own.run(window.some(np.zeros(len(z), dtype=int)), z, slopes=False)
    read = np.where(window.counts[0, :, None], window.read[0], np.nan)
    mean = means(np.where(np.isfinite(read), passed.shown, np.nan))
    by = ((mean[1:] - mean[0]) / sd[:, None]).T
    spread = by @ (open_at(duty, (levels.covariance[0] + levels.season)[None])[0] + levels.window) @ by.T
    alone = np.maximum(known.share * np.isfinite(passed.error[0]).sum(axis=0), 1.0)
    return Expected(means(read[None])[0], mean[0], np.sqrt(np.diag(spread) + own.scatter**2 / alone))
