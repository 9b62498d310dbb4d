"""The tests of a campaign as runs of the rig: dwells, and stops between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ....scenarios.measured.table import PLACES, Campaign

#: Shares of a dwell, of a stop and of the time to a steady state [s] where steps end.
DWELL = (np.arange(1, 8) / 7) ** 1.2
#: The same where it was logged, with short steps for what warms first, and the steps after which it is read.
LOGGED = np.sort([0.015, 0.04, 0.15, 0.4, 0.8, *PLACES, 1.0])
READ = tuple(np.flatnonzero(np.isin(LOGGED, [*PLACES, 1.0])).tolist())
STOP = np.array([1.0])
STEADY = 60.0 * 4.0 ** np.arange(14)
#: A kind of sensor that reads zero where the machine stands.
RESTS = ("torque", "speed", "power")


@dataclass(frozen=True)
class Phases:
    """What N runs go through, all with the same number of phases; a phase of no length changes nothing.

    Args:
        length: of each phase [s] (N, F)
        u0, u1: inputs at begin and end, a line between (N, F, nu)
        row: which row of its test a phase belongs to (F,), in 0..H-1
        steps: shares of the length where steps end, for each phase
        read: for each phase the steps (indices) after which is read
        start: by how much the start temperatures follow the given readings of the first row (N, given)
        local0, local1: weight of the reading of each given sensor in each row of the test in the inputs at begin and
            end of each phase (N, F, given, H)
        steady: whether what is read are steady states
    """

    length: np.ndarray
    u0: np.ndarray
    u1: np.ndarray
    row: tuple[int, ...]
    steps: tuple[np.ndarray, ...]
    read: tuple[tuple[int, ...], ...]
    local0: np.ndarray
    local1: np.ndarray
    start: np.ndarray
    steady: bool


def duty(c: Campaign, rows: np.ndarray, starts: np.ndarray) -> Phases:
    """All tests as runs: a dwell for each row, a stop before each but the first. A logged dwell is read along it, too.

    Args:
        c: the campaign
        rows: which of its rows each is (tests, H); the last of the test where it has fewer
        starts: by how much the start temperature of a test follows the given readings of its first row (tests, given)

    Returns:
        phases without inputs
    """
    height = rows.shape[1]
    n, n_given = c.n_tests, len(c.given)
    absent = np.arange(height) >= np.bincount(c.test)[:, None]
    dwell = np.where(absent, 0.0, np.where(np.isinf(c.dwell), STEADY.sum(), c.dwell)[rows])
    stop = np.where(absent, 0.0, c.stop[rows])
    lengths, row, steps = [], [], []
    read: list[tuple[int, ...]] = []
    local = []
    one = np.eye(height)
    room = np.array([s.kind == "ambient" for s in c.given], dtype=bool)
    moving = np.array([s.kind in RESTS for s in c.given], dtype=bool)
    shares = np.cumsum(STEADY) / STEADY.sum() if c.steady else LOGGED if c.series else DWELL
    reached = np.tile(one[0], (n, 1))  # weights of the rows in the room's temperature so far
    for h in range(height):
        if h:
            share = (stop[:, h] / np.maximum(stop[:, h] + dwell[:, h], 1e-9))[:, None]
            after = reached + share * (one[h] - reached)
            lengths.append(stop[:, h])
            weights = np.zeros((2, n, n_given, height))
            weights[0][:, room], weights[1][:, room] = reached[:, None], after[:, None]
            weights[:, :, ~room & ~moving] = one[h]
            local.append(weights)
            row.append(h)
            steps.append(STOP)
            read.append(())
            reached = after
        weights = np.tile(one[h], (2, n, n_given, 1))
        if not c.steady:
            weights[0][:, room] = reached[:, None]
        reached = np.tile(one[h], (n, 1))
        lengths.append(dwell[:, h])
        local.append(weights)
        row.append(h)
        steps.append(shares)
        read.append(READ if c.series else (len(shares) - 1,))
    whole = np.array(local)
    empty = np.empty((n, len(row), 0))
    return Phases(
        np.array(lengths).T,
        empty,
        empty,
        tuple(row),
        tuple(steps),
        tuple(read),
        whole[:, 0].swapaxes(0, 1),
        whole[:, 1].swapaxes(0, 1),
        starts,
        c.steady,
    )
