"""Dwells of many tests side by side, with exact sensitivities: a singly diagonally implicit method of second order.

The discrete solution is differentiated, so its sensitivities are exact at any step. A steady state is the end of a very
long dwell: the last steps are Newton's.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...model.run.algebra import algebra
from .many import Many
from .plant import Plant

#: The method: L-stable, stiffly accurate.
GAMMA = 1.0 - 0.5**0.5
#: Newton's corrections at most, and size over the nominals at which they end.
MOST, SETTLED = 14, 1e-9
#: A temperature above this is a runaway [K]; a correction of Newton's is no longer than so many nominals.
RUNAWAY, LONGEST = 700.0, 10.0


@dataclass(frozen=True)
class Phases:
    """What N runs go through, all with the same number of phases; a phase of no length changes nothing.

    Args:
        length: of each phase [s] (N, F)
        u0, u1: inputs at begin and end, a line between (N, F, nu)
        row: which row of its test a phase belongs to (F,), in 0..H-1
        steps: shares of the length where steps end, for each phase
        read: for each phase the steps (indices) after which is read
        local0, local1: weight of the reading of each given sensor in each row of the test in the inputs at begin and
            end of each phase (N, F, given, H)
    """

    length: np.ndarray
    u0: np.ndarray
    u1: np.ndarray
    row: tuple[int, ...]
    steps: tuple[np.ndarray, ...]
    read: tuple[tuple[int, ...], ...]
    local0: np.ndarray
    local1: np.ndarray


@dataclass(frozen=True)
class Turned:
    """By what parameters and pace change: K knobs, d directions.

    Args:
        p: parameters of each row of each run by the directions (N, H, K, d)
        knobs: places of the K knobs among the plant's
        pace: of each row (N, H, d)
        start: of the start temperatures by the given readings of the first row (N, given)
        apart: directions (c,) that are taken at parameters of their own
        apart_p: those parameters (N, H, c, np)
        apart_way: by what all knobs change along them (N, H, c, knobs)
    """

    p: np.ndarray
    knobs: np.ndarray
    pace: np.ndarray
    start: np.ndarray
    apart: np.ndarray
    apart_p: np.ndarray
    apart_way: np.ndarray


@dataclass(frozen=True)
class Marched:
    """What is shown: readings (N, reads, shown), by the directions (..., d), by given readings (..., given, H).

    A run that has no solution, or runs away, holds NaN.
    """

    y: np.ndarray
    by: np.ndarray | None
    local: np.ndarray | None


def march(
    plant: Plant, phases: Phases, x0: np.ndarray, p: np.ndarray, pace: np.ndarray, turned: Turned | None = None
) -> Marched:
    """Run all phases.

    Args:
        plant: the model
        phases: N runs
        x0: temperatures and speeds at the start (N, nx)
        p: parameters of each row (N, H, np)
        pace: share of each row's length that took place (N, H)
        turned: directions of the sensitivities; none are computed without
    """
    return _March(plant, phases, p, pace, turned).run(x0)


class _March:
    def __init__(self, plant: Plant, phases: Phases, p: np.ndarray, pace: np.ndarray, turned: Turned | None) -> None:
        self.plant, self.phases, self.p, self.pace, self.turned = plant, phases, p, pace, turned
        self.n, self.nx = len(phases.length), plant.nx
        self.n_w = plant.nx + plant.nz
        given, rows = phases.local0.shape[2:]
        self.n_local = given * rows
        self.width = 0 if turned is None else turned.p.shape[3] + self.n_local
        self.bad = np.zeros(self.n, dtype=bool)
        self.thermal = np.array([q.unit == "K" for q in (*plant.flat.states, *plant.flat.algebraic)])

    def run(self, x0: np.ndarray) -> Marched:
        """Everything."""
        plant, phases = self.plant, self.phases
        w = np.concatenate([x0, np.tile(plant.flat.starts("algebraic"), (self.n, 1))], axis=1)
        dx = self._begun()
        y, dy = [], []
        for f, row in enumerate(phases.row):
            before, p = 0.0, self.p[:, row]
            w = self._consistent(w, phases.u0[:, f], p)
            for k, share in enumerate(phases.steps[f]):
                h = (share - before) * phases.length[:, f]
                w, dx, dw = self._step(w, dx, h, before, share, f)
                before = share
                if k in phases.read[f]:
                    value, slopes = self._read(w, dw, f, share)
                    y.append(value)
                    dy.append(slopes)
        return self._joined(y, dy)

    def _begun(self) -> np.ndarray | None:
        if self.turned is None:
            return None
        dx = np.zeros((self.n, self.nx, self.width))
        first = np.zeros((self.n, *self.phases.local0.shape[2:]))
        first[:, :, 0] = self.turned.start
        dx[:, :, self.width - self.n_local :] = self.thermal[: self.nx, None] * first.reshape(self.n, 1, -1)
        return dx

    def _consistent(self, w: np.ndarray, u: np.ndarray, p: np.ndarray) -> np.ndarray:
        """The algebraic variables after a jump of the inputs."""
        if not self.plant.nz:
            return w
        x, z = w[:, : self.nx], w[:, self.nx :]
        for _ in range(MOST):
            r, J = self.plant.rates(np.concatenate([x, z], axis=1), u, p)
            change = self._solved(J[:, self.nx :, self.nx :], r[:, self.nx :, None])[:, :, 0]
            z = z - change
            left = np.abs(change / self.plant.scale[self.nx :]).max(axis=1)
            if np.nanmax(np.where(self.bad, 0.0, left)) < SETTLED:
                break
        lost = ~(left < 1e-6) & ~self.bad
        for i in np.flatnonzero(lost):
            try:
                z[i] = algebra(self.plant.flat).solve(x[i], u[i], p[i])
            except Exception:  # noqa: BLE001
                self.bad[i] = True
        return np.concatenate([x, z], axis=1)

    def _solved(self, A: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Solutions (N, k, m) of N systems; those that have none are given up."""
        wrong = ~(np.isfinite(A).all(axis=(1, 2)) & np.isfinite(b).all(axis=(1, 2)))
        if wrong.any():
            self.bad |= wrong
            A, b = A.copy(), b.copy()
            A[wrong], b[wrong] = np.eye(A.shape[1]), 0.0
        try:
            return np.linalg.solve(A, b)
        except np.linalg.LinAlgError:
            singular = np.abs(np.linalg.det(A)) == 0
            self.bad |= singular
            A = A.copy()
            A[singular] = np.eye(A.shape[1])
            return np.linalg.solve(A, b)

    def _inputs(self, f: int, share: float) -> np.ndarray:
        u0, u1 = self.phases.u0[:, f], self.phases.u1[:, f]
        return np.asarray(u0 + share * (u1 - u0))

    def _step(
        self, w: np.ndarray, dx: np.ndarray | None, h: np.ndarray, begin: float, end: float, f: int
    ) -> tuple[np.ndarray, np.ndarray | None, np.ndarray | None]:
        """One step of length h (N,): unknowns, and slopes of states and of all unknowns."""
        x, middle = w[:, : self.nx], begin + GAMMA * (end - begin)
        w1, A1, r1 = self._stage(w, x, h, middle, f)
        rate = (w1[:, : self.nx] - x) / np.where(h > 0, h * GAMMA, 1.0)[:, None]
        ahead = x + (h * (1 - GAMMA))[:, None] * rate
        w2, A2, r2 = self._stage(w1, ahead, h, end, f)
        with np.errstate(invalid="ignore"):
            far = ~(w2[:, self.thermal].max(axis=1) < RUNAWAY)
        if (far & ~self.bad).any() or self.bad.any():
            self.bad |= far
            w2 = np.where(self.bad[:, None], w, w2)
        if dx is None:
            return w2, None, None
        d1 = self._turn(w1, A1, r1, dx, h, middle, f)[:, : self.nx]
        rates = (d1 - dx) / np.where(h > 0, h * GAMMA, 1.0)[:, None, None]
        dw = self._turn(w2, A2, r2, dx + (h * (1 - GAMMA))[:, None, None] * rates, h, end, f)
        return w2, dw[:, : self.nx], dw

    def _stage(
        self, w: np.ndarray, x: np.ndarray, h: np.ndarray, share: float, f: int
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Solve x_new = x + h gamma pace rate(w_new): unknowns, the system's matrix and the rates there."""
        row, u = self.phases.row[f], self._inputs(f, share)
        p, lengths = self.p[:, row], h * GAMMA * self.pace[:, row]
        w = w.copy()
        for _ in range(MOST):
            r, A = self.plant.rates(w, u, p)
            A[:, : self.nx] *= -lengths[:, None, None]
            A[:, np.arange(self.nx), np.arange(self.nx)] += 1.0
            left = r.copy()
            left[:, : self.nx] = w[:, : self.nx] - x - lengths[:, None] * r[:, : self.nx]
            change = self._solved(A, left[:, :, None])[:, :, 0]
            size = np.abs(change / self.plant.scale).max(axis=1)
            change *= np.minimum(1.0, LONGEST / np.maximum(size, 1e-300))[:, None]
            w = np.where(self.bad[:, None], w, w - change)
            if np.max(np.where(self.bad, 0.0, size), initial=0.0) < SETTLED:
                break
        self.bad |= ~(size < 1e-5)
        r, A = self.plant.rates(w, u, p)
        A[:, : self.nx] *= -lengths[:, None, None]
        A[:, np.arange(self.nx), np.arange(self.nx)] += 1.0
        return w, A, r

    def _turn(
        self, w: np.ndarray, A: np.ndarray, r: np.ndarray, dx: np.ndarray, h: np.ndarray, share: float, f: int
    ) -> np.ndarray:
        """Slopes of the unknowns of a solved stage (N, n_w, width)."""
        assert self.turned is not None
        row, lengths = self.phases.row[f], h * GAMMA * self.pace[:, self.phases.row[f]]
        u = self._inputs(f, share)
        (by,) = self.plant.slopes(w, u, self.p[:, row])
        own = self._directed(by, row, f, share)
        self._apart(self.plant.push, own, w, u, row)
        b = np.empty((self.n, self.n_w, self.width))
        d = self.width - self.n_local
        own[:, : self.nx] *= lengths[:, None, None]
        b[:, : self.nx] = dx + own[:, : self.nx]
        b[:, : self.nx, :d] += (h * GAMMA)[:, None, None] * r[:, : self.nx, None] * self.turned.pace[:, row][:, None]
        b[:, self.nx :] = -own[:, self.nx :]
        return self._solved(A, b)

    def _directed(self, by: np.ndarray, row: int, f: int, share: float) -> np.ndarray:
        """Slopes by knobs and given inputs (N, rows, knobs + given) along all directions (N, rows, width)."""
        assert self.turned is not None
        k = len(self.plant.knobs)
        own = by[:, :, self.turned.knobs] @ self.turned.p[:, row]
        local = (1 - share) * self.phases.local0[:, f] + share * self.phases.local1[:, f]
        weights = by[:, :, k:, None] * local[:, None]
        return np.concatenate([own, weights.reshape(self.n, by.shape[1], self.n_local)], axis=2)

    def _apart(self, push: Many, own: np.ndarray, w: np.ndarray, u: np.ndarray, row: int) -> None:
        """Add slopes (N, rows, width) along the directions that are taken at parameters of their own."""
        assert self.turned is not None
        c = len(self.turned.apart)
        if not c:
            return
        p, way = (a[:, row].reshape(self.n * c, a.shape[3]) for a in (self.turned.apart_p, self.turned.apart_way))
        (found,) = push(np.repeat(w, c, axis=0), np.repeat(u, c, axis=0), p, way)
        own[:, :, self.turned.apart] += found.reshape(self.n, c, own.shape[1]).swapaxes(1, 2)

    def _read(self, w: np.ndarray, dw: np.ndarray | None, f: int, share: float) -> tuple[np.ndarray, np.ndarray | None]:
        row, u = self.phases.row[f], self._inputs(f, share)
        p = self.p[:, row]
        if dw is None:
            return self.plant.readings(w, u, p)[0], None
        y, by_w, by = self.plant.reading_slopes(w, u, p)
        own = self._directed(by, row, f, share)
        self._apart(self.plant.reading_push, own, w, u, row)
        return y, by_w @ dw + own

    def _joined(self, y: list[np.ndarray], dy: list[np.ndarray | None]) -> Marched:
        values = np.stack(y, axis=1)
        values[self.bad] = np.nan
        if self.turned is None:
            return Marched(values, None, None)
        slopes = np.stack([d for d in dy if d is not None], axis=1)
        d = self.width - self.n_local
        local = slopes[..., d:].reshape(*slopes.shape[:3], *self.phases.local0.shape[2:])
        return Marched(values, slopes[..., :d], local)
