"""Plain statistical rivals of the simulation, fitted to the measured readings by least squares.

A simulation is worth its trouble only if it does better than these, and better means: on tests it was not fitted to.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .errors import Channel, Rows, channels_of, distinct, numbers, rms

Design = Callable[[Rows, Channel, Sequence[str]], np.ndarray]


@dataclass(frozen=True)
class Rival:
    """A linear model: `design` gives its columns (n x coefficients) for rows, a channel and the columns that drive."""

    name: str
    doc: str
    design: Design


@dataclass(frozen=True)
class Score:
    """Root-mean-square errors per channel on the fitted readings, and on each test when it was left out of the fit."""

    name: str
    doc: str
    coefficients: dict[str, list[float]]
    in_sample: dict[str, float]
    leave_one_test_out: dict[str, float]


def _one_number(rows: Rows, channel: Channel, drives: Sequence[str]) -> np.ndarray:
    """Rise = computed loss power / alpha*A; loss torque = constant share of the given torque."""
    torques = [name for name in drives if name.endswith("_Nm")]
    source = "P_loss_W" if channel.relative_to is not None or not torques else torques[0]
    return np.asarray(np.abs(numbers(rows, source))[:, None])


def _linear(rows: Rows, channel: Channel, drives: Sequence[str]) -> np.ndarray:
    """Constant, speeds, torques."""
    return np.column_stack([np.ones(len(rows)), *(np.abs(numbers(rows, name)) for name in drives)])


def _linear_groups(rows: Rows, channel: Channel, drives: Sequence[str]) -> np.ndarray:
    """Constant, speed, torque, and an offset for each further direction and oil."""
    offsets = [
        [float(row.get(by) == value) for row in rows]
        for by in ("direction", "oil")
        for value in distinct(row.get(by) for row in rows)[1:]
    ]
    return np.column_stack([_linear(rows, channel, drives), *offsets])


RIVALS = (
    Rival(
        "constant_alphaA",
        "T - T_amb = computed P_loss / alphaA; loss torque a constant share of the given torque",
        _one_number,
    ),
    Rival("linear", "T - T_amb and loss torque linear in speed and torque", _linear),
    Rival("linear_groups", "linear in speed and torque, with an offset for each direction and oil", _linear_groups),
)


def rivals(rows: Rows, drives: Sequence[str]) -> tuple[Score, ...]:
    """Fit every rival to the measured readings.

    Args:
        rows: with `T_amb_C`, computed `P_loss_W`, `test`, and the measured columns; a rival is left out for a channel
            whose columns are missing
        drives: columns of the given speeds and torques
    """
    return tuple(_score(rival, rows, drives) for rival in RIVALS)


def _score(rival: Rival, rows: Rows, drives: Sequence[str]) -> Score:
    coefficients: dict[str, list[float]] = {}
    in_sample: dict[str, float] = {}
    left_out: dict[str, float] = {}
    for channel in channels_of(rows):
        design, target = rival.design(rows, channel, drives), _target(rows, channel)
        if not (np.isfinite(target).all() and np.isfinite(design).all()):
            continue
        fit = least_squares(design, target)
        coefficients[channel.key] = [float(c) for c in fit]
        in_sample[channel.key] = rms(design @ fit - target)
        left_out[channel.key] = rms(_cross_validate(design, target, [row.get("test") for row in rows]))
    return Score(rival.name, rival.doc, coefficients, in_sample, left_out)


def _target(rows: Rows, channel: Channel) -> np.ndarray:
    """Measured value of the channel, temperatures as rise over the room."""
    values = numbers(rows, channel.measured)
    return values if channel.relative_to is None else values - numbers(rows, channel.relative_to)


def least_squares(design: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Least-squares coefficients, of smallest norm where the readings do not determine them."""
    scale = np.maximum(np.abs(design).max(axis=0), 1e-300)
    return np.asarray(np.linalg.lstsq(design / scale, target, rcond=None)[0] / scale)


def _cross_validate(design: np.ndarray, target: np.ndarray, tests: Sequence[Any]) -> np.ndarray:
    """Error of each reading under the fit to all other tests (both directions of a test share a day and an oil)."""
    error = np.full(len(target), np.nan)
    for test in dict.fromkeys(tests):
        out = np.array([t == test for t in tests])
        if not out.all():
            error[out] = design[out] @ least_squares(design[~out], target[~out]) - target[out]
    return error
