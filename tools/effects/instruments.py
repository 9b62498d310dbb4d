"""What the instrument causes share."""

from __future__ import annotations

import numpy as np

from .cause import Readings, Rows


def changed(readings: Readings, **channels: np.ndarray) -> Readings:
    """The readings with some channels replaced."""
    return {**readings, **channels}


def after(rows: Rows, place: float) -> np.ndarray:
    """0 before and 1 after a place in the running order."""
    return (rows.order > place).astype(float)
