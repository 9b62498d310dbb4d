"""Rivals of the diagnosis of real machines, each of them some lines of statistics: none can name a cause."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from gearheat.scenarios.measured.adapter import Columns

#: Standard deviations of its own healthy error beyond which a rival raises an alarm.
LIMIT = 3.0
#: Pieces into which a healthy record is cut to see how far its mean wanders by itself.
PIECES = 8


def rivals(asked: Columns, reference: Columns, channel: str, given: Sequence[str]) -> dict[str, Any]:
    """What three rivals say of one channel: whether they raise an alarm, and how well they predict.

    Args:
        asked, reference: rows in question and healthy ones
        channel: column that is predicted
        given: columns from which; the last one is the room
    """
    healthy, now = (_complete(part, (channel, *given)) for part in (reference, asked))
    alarm = _differs(_left(healthy, healthy), _left(healthy, now))
    return {
        "one node": _one_node(healthy, now),
        "normal behaviour": _lagged(healthy, now),
        "regression": {"alarm": alarm, "rmse": _held_out(now)},
    }


def _complete(part: Columns, names: Sequence[str]) -> np.ndarray:
    """Rows without holes (n, 1 + given): the channel first."""
    table = np.array([part[name] for name in names], dtype=float).T
    return np.asarray(table[np.isfinite(table).all(axis=1)])


def _design(table: np.ndarray) -> np.ndarray:
    return np.column_stack([np.ones(len(table)), table[:, 1:]])


def _left(fitted: np.ndarray, table: np.ndarray) -> np.ndarray:
    """What a linear regression on some rows leaves of others."""
    weights = np.linalg.lstsq(_design(fitted), fitted[:, 0], rcond=None)[0]
    return np.asarray(table[:, 0] - _design(table) @ weights)


def _differs(healthy: np.ndarray, now: np.ndarray) -> bool:
    """Whether the mean has moved by more than the means of pieces of the healthy record do."""
    pieces = [piece.mean() for piece in np.array_split(healthy, PIECES)]
    return bool(abs(now.mean() - healthy.mean()) > LIMIT * max(np.std(pieces, ddof=1), 1e-9))


def _held_out(table: np.ndarray) -> float:
    """Error of a regression on every other row, in the rest."""
    return float(np.sqrt(np.mean(_left(table[::2], table[1::2]) ** 2)))


def _one_node(healthy: np.ndarray, now: np.ndarray) -> dict[str, Any]:
    """One node: its rise over the room is a linear function of load and speed over a conductance, which may change."""

    def rises(table: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return table[:, 0] - table[:, -1], np.column_stack([np.ones(len(table)), table[:, 1:-1]])

    (rise, by), (rise_now, by_now) = rises(healthy), rises(now)
    weights = np.linalg.lstsq(by, rise, rcond=None)[0]
    own, expected = by @ weights, by_now @ weights
    factor = float(expected[::2] @ rise_now[::2] / (expected[::2] @ expected[::2]))
    error = rise_now[1::2] - factor * expected[1::2]
    alarm = _differs(rise - own, rise_now - expected)
    return {"alarm": alarm, "share": 1 / factor, "rmse": float(np.sqrt(np.mean(error**2)))}


def _lagged(healthy: np.ndarray, now: np.ndarray) -> dict[str, Any]:
    """Normal behaviour: a regression on the inputs and on the channel one row before."""

    def lagged(table: np.ndarray) -> np.ndarray:
        return np.column_stack([table[1:], table[:-1, 0]])

    residuals = [_left(lagged(healthy), lagged(part)) for part in (healthy, now)]
    return {"alarm": _differs(*residuals), "rmse": float(np.sqrt(np.mean(residuals[1] ** 2)))}
