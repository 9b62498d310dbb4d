"""A rig run over logs: a Kalman filter over its equations, with exact sensitivities, many windows side by side.

The states of the machine drift by a random walk of their own (state noise), so that what the model misses in one sample
does not count again in the next: the one-step prediction errors are what is left to explain. Without correction the
same steps run the model freely. Inputs are means over a sample and hold during it; readings are means over it as well.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ..library.knobs import Knob
from .plant import Plant
from .windows import Windows

#: The method: two implicit stages of second order, L-stable and stiffly accurate.
GAMMA = 1.0 - 0.5**0.5
#: Newton's corrections at most.
MOST = 30
#: Size over the nominals at which they end.
SETTLED = 1e-5
#: A correction is no longer than so many nominals.
LONG = 2.0
#: At first.
SHORT = 0.3
#: From the given one on: a relay may throw it about.
SHORTER = 6
#: Degrees of freedom of the prediction errors: switching and standing pumps make their tails heavy.
TAILS = 4.0
#: Standard deviation at the start of a state that no sensor reads [K].
UNREAD = 6.0
#: Scatter of a reading about the model before it is estimated [K].
SCATTER = 1.0
#: State noise of one sample over it: the filter follows what is read over some hours, so that it is the slow course of
#: a temperature that the knobs explain.
FOLLOWS = 0.04
#: A reading that is missing scatters so much [K].
MISSING = 1e4


@dataclass(frozen=True, eq=False)
class Passed:
    """One pass over windows.

    Args:
        log_likelihood: of each window (N,)
        slope, curvature: of it, by the knobs (N, k), (N, k, k), the latter positive
        error: prediction errors (N, L, reads), NaN where nothing counts
        variance: of them (N, L, reads)
        shown: what the model shows (N, L, reads)
    """

    log_likelihood: np.ndarray
    slope: np.ndarray
    curvature: np.ndarray
    error: np.ndarray
    variance: np.ndarray
    shown: np.ndarray


class Filter:
    """A rig with its knobs, compiled, and the noise of its states.

    Args:
        plant: the rig; its knobs are the paths of the knobs here, `given` and `shown` those of the sensors
        knobs: what may differ
        given, read: names of the sensors, as in the windows
        drift: standard deviation that the random walk of a state that no sensor reads gains in one sample [K] (nx,)
    """

    def __init__(
        self, plant: Plant, knobs: Sequence[Knob], given: Sequence[str], read: Sequence[str], drift: np.ndarray
    ) -> None:
        self.plant, self.knobs, self.given, self.read, self.drift = (
            plant,
            tuple(knobs),
            tuple(given),
            tuple(read),
            drift,
        )
        #: Scatter of each reading about the model [K] (reads,).
        self.scatter = np.full(len(read), SCATTER)
        self.nx, self.n_w = plant.nx, plant.nx + plant.nz
        self.u_at = [plant.u_place[path] for path in plant.given]
        self.p_at = [plant.place[path] for path in plant.knobs]
        #: State that each sensor reads, -1 where it reads something else.
        names = [q.name for q in plant.flat.states]
        self.state_of = np.array([names.index(path) if path in names else -1 for path in plant.shown])

    def settings(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """What the knobs set.

        Args:
            z: of each window (N, k)

        Returns:
            parameters (N, np), their slopes (N, paths, k); factor and shift of the inputs (N, given) with
            true = factor * shown - shift; shift of the readings (N, reads), and its slopes (reads, k)
        """
        n, k = z.shape
        p = np.tile(self.plant.p, (n, 1))
        dp = np.zeros((n, len(self.plant.knobs), k))
        factor, shift = np.ones((n, len(self.given))), np.zeros((n, len(self.given)))
        offset, by = np.zeros((n, len(self.read))), np.zeros((len(self.read), k))
        for j, knob in enumerate(self.knobs):
            for path, exponent in knob.scaled.items():
                p[:, self.plant.place[path]] *= np.exp(exponent * z[:, j])
            for path, weight in knob.shifted.items():
                p[:, self.plant.place[path]] += weight * z[:, j]
            if knob.sensor in self.given:
                i = self.given.index(knob.sensor)
                factor[:, i] *= np.exp(-z[:, j]) if knob.gain else 1.0
                shift[:, i] += 0.0 if knob.gain else z[:, j]
            elif knob.sensor:
                i = self.read.index(knob.sensor)
                offset[:, i] += z[:, j]
                by[i, j] = 1.0
        for j, knob in enumerate(self.knobs):
            for path, exponent in knob.scaled.items():
                dp[:, self.plant.knobs.index(path), j] = exponent * p[:, self.plant.place[path]]
            for path, weight in knob.shifted.items():
                dp[:, self.plant.knobs.index(path), j] = weight
        return p, dp, factor, shift, offset, by

    @property
    def noise(self) -> np.ndarray:
        """Standard deviation that each state's random walk gains in one sample [K] (nx,)."""
        found = self.drift.copy()
        for j, state in enumerate(self.state_of):
            if state >= 0:
                found[state] = FOLLOWS * self.scatter[j]
        return found

    def start(self, data: Windows, offset: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """States at the start (N, nx), and their covariance (nx, nx)."""
        x = np.tile(self.plant.flat.starts("state"), (len(data.read), 1))
        thermal = np.array([q.unit == "K" for q in self.plant.flat.states])
        own = [q.name.rpartition(".")[2] == "T" for q in self.plant.flat.states]
        first = _first(data.read) - offset
        x[:, thermal & np.array(own)] = np.nanmean(first, axis=1)[:, None]
        sd = np.where(thermal, UNREAD, 0.0)
        for j, state in enumerate(self.state_of):
            if state >= 0:
                x[:, state] = np.where(np.isfinite(first[:, j]), first[:, j], x[:, state])
                sd[state] = self.scatter[j]
        return x, np.diag(sd**2)

    def run(
        self,
        data: Windows,
        z: np.ndarray,
        *,
        free: bool = False,
        slopes: bool = True,
        progress: Callable[[float], None] | None = None,
    ) -> Passed:
        """One pass.

        Args:
            data: windows
            z: knobs of each window (N, k)
            free: whether samples that count do not correct the states; no slopes then
            slopes: whether slope and curvature are wanted
            progress: called with the share done
        """
        order = np.argsort(-data.there.sum(axis=1), kind="stable")
        found = _Pass(self, data.some(order), z[order], free, slopes and not free).through(progress)
        back = np.argsort(order)
        return Passed(*(a[back] for a in found))


def _first(read: np.ndarray) -> np.ndarray:
    """First reading of each sensor in each window (N, reads)."""
    there = np.isfinite(read)
    at = there.argmax(axis=1)
    return np.asarray(np.take_along_axis(read, at[:, None], axis=1)[:, 0])


class _Pass:
    """Windows by falling length, step by step; those that have ended are left out."""

    def __init__(self, own: Filter, data: Windows, z: np.ndarray, free: bool, slopes: bool) -> None:
        self.own, self.data, self.free, self.slopes = own, data, free, slopes
        self.plant, self.nx, self.k = own.plant, own.nx, z.shape[1]
        self.p, self.dp, self.factor, self.shift, self.offset, self.by = own.settings(z)
        self.lengths = data.there.sum(axis=1)
        self.Q = np.diag(own.noise**2)

    def through(self, progress: Callable[[float], None] | None) -> tuple[np.ndarray, ...]:
        n, length, reads = self.data.read.shape
        x, P = self.own.start(self.data, self.offset)
        P = np.tile(P, (n, 1, 1))
        w = np.concatenate([x, np.tile(self.plant.flat.starts("algebraic"), (n, 1))], axis=1)
        S = np.zeros((n, self.nx, self.k))
        self.likelihood, self.g, self.H = np.zeros(n), np.zeros((n, self.k)), np.zeros((n, self.k, self.k))
        error, variance, shown = (np.full((n, length, reads), np.nan) for _ in range(3))
        for t in range(int(self.lengths.max(initial=0))):
            m = int((self.lengths > t).sum())
            step = _Step(self, w[:m], t)
            y = step.mean + self.offset[:m]
            e, R = self._left(y, t)
            shown[:m, t] = y
            free = self.free & self.data.counts[:m, t]
            if free.all():
                error[:m, t], w[:m] = e, step.w
                continue
            H_x, A = step.mean_by[:, :, self.k :], step.end_by[:, :, self.k :]
            V, gain, P[:m] = self._updated(P[:m], H_x, A, R)
            gain[free] = 0.0
            by_z = step.mean_by[:, :, : self.k] + H_x @ S[:m]
            S[:m] = step.end_by[:, :, : self.k] + A @ S[:m]
            by_z = by_z + self.by
            S[:m] -= gain @ by_z
            w[:m] = step.w
            w[:m, : self.nx] += (gain @ e[:, :, None])[:, :, 0]
            error[:m, t], variance[:m, t] = e, np.einsum("nii->ni", V)
            self._count(t, e, V, by_z)
            if progress is not None and t % 50 == 0:
                progress(float(np.minimum(self.lengths, t).sum() / self.lengths.sum()))
        error[~self.data.counts | ~np.isfinite(self.data.read).any(axis=2)] = np.nan
        return self.likelihood, self.g, self.H, error, variance, shown

    def _left(self, y: np.ndarray, t: int) -> tuple[np.ndarray, np.ndarray]:
        """Errors (m, reads) and variances of the readings."""
        e = self.data.read[: len(y), t] - y
        missing = ~np.isfinite(e)
        return np.where(missing, 0.0, e), np.where(missing, MISSING, self.own.scatter) ** 2

    def _updated(
        self, P: np.ndarray, C: np.ndarray, A: np.ndarray, R: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Covariance of the errors, gain, and covariance of the states after a sample.

        A walk that gains Q in a sample has Q/3 in the mean over it, and Q/2 in common with its end.
        """
        direct = np.zeros((C.shape[1], self.nx))
        seen = self.own.state_of >= 0
        direct[np.flatnonzero(seen), self.own.state_of[seen]] = 1.0
        V = C @ P @ C.transpose(0, 2, 1) + direct @ self.Q @ direct.T / 3
        V[:, np.arange(C.shape[1]), np.arange(C.shape[1])] += R
        cross = A @ P @ C.transpose(0, 2, 1) + self.Q @ direct.T / 2
        gain = np.linalg.solve(V, cross.transpose(0, 2, 1)).transpose(0, 2, 1)
        after = A @ P @ A.transpose(0, 2, 1) + self.Q - gain @ cross.transpose(0, 2, 1)
        return V, gain, (after + after.transpose(0, 2, 1)) / 2

    def _count(self, t: int, e: np.ndarray, V: np.ndarray, by_z: np.ndarray) -> None:
        """Add the samples that count: a multivariate t, as least squares that are weighted anew at every pass."""
        m, reads = e.shape
        counts = self.data.counts[:m, t]
        inverse = np.linalg.inv(V)
        z = (inverse @ e[:, :, None])[:, :, 0]
        distance = (z * e).sum(axis=1)
        weight = (TAILS + reads) / (TAILS + distance) * counts
        self.likelihood[:m] -= counts * (
            0.5 * np.linalg.slogdet(V)[1] + 0.5 * (TAILS + reads) * np.log1p(distance / TAILS)
        )
        if self.slopes:
            self.g[:m] += weight[:, None] * (by_z.transpose(0, 2, 1) @ z[:, :, None])[:, :, 0]
            self.H[:m] += weight[:, None, None] * (by_z.transpose(0, 2, 1) @ inverse @ by_z)


class _Step:
    """One sample of m windows: unknowns at its end, mean readings, and slopes of both by knobs and start."""

    def __init__(self, run: _Pass, w: np.ndarray, t: int) -> None:
        self.run, self.plant, self.nx, self.m = run, run.plant, run.nx, len(w)
        given = run.data.given[: self.m, t]
        self.u = np.tile(self.plant.u, (self.m, 1))
        self.u[:, run.own.u_at] = run.factor[: self.m] * given - run.shift[: self.m]
        self.p, self.given = run.p[: self.m], given
        self.h = run.data.step * GAMMA
        x = w[:, : self.nx]
        w1, A1 = self._stage(w, x)
        rate = (w1[:, : self.nx] - x) / self.h
        w2, A2 = self._stage(w1, x + run.data.step * (1 - GAMMA) * rate)
        self.w = w2
        if run.free and run.data.counts[: self.m, t].all():
            y1, y2 = (self.plant.readings(w, self.u, self.p)[0] for w in (w1, w2))
            self.mean = (1 - GAMMA) * y1 + GAMMA * y2
            return
        dx = np.zeros((self.m, self.nx, run.k + self.nx))
        dx[:, :, run.k :] = np.eye(self.nx)
        d1 = self._turn(w1, A1, dx)
        ahead = dx + run.data.step * (1 - GAMMA) * (d1[:, : self.nx] - dx) / self.h
        d2 = self._turn(w2, A2, ahead)
        (y1, by1), (y2, by2) = self._read(w1, d1), self._read(w2, d2)
        self.mean = (1 - GAMMA) * y1 + GAMMA * y2
        self.mean_by = (1 - GAMMA) * by1 + GAMMA * by2
        self.end_by = d2[:, : self.nx]

    def _matrix(self, J: np.ndarray) -> np.ndarray:
        A = J.copy()
        A[:, : self.nx] *= -self.h
        A[:, np.arange(self.nx), np.arange(self.nx)] += 1.0
        return A

    def _stage(self, w: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Solve x_new = x + h gamma rate(w_new): unknowns, and the system's matrix there."""
        w = w.copy()
        for n in range(MOST):
            r, J = self.plant.rates(w, self.u, self.p)
            A = self._matrix(J)
            left = r.copy()
            left[:, : self.nx] = w[:, : self.nx] - x - self.h * r[:, : self.nx]
            change = np.linalg.solve(A, left[:, :, None])[:, :, 0] / self.plant.scale
            size = np.abs(change).max(axis=1)
            longest = LONG if n < SHORTER else SHORT
            w -= change * np.minimum(1.0, longest / np.maximum(size, 1e-300))[:, None] * self.plant.scale
            if size.max() < SETTLED:
                break
        return w, A

    def _own(self, by: np.ndarray) -> np.ndarray:
        """Slopes by the plant's knobs and inputs (m, rows, ...) along the knobs here (m, rows, k)."""
        run, paths = self.run, len(self.plant.knobs)
        found = by[:, :, :paths] @ run.dp[: self.m]
        for j, knob in enumerate(run.own.knobs):
            if knob.sensor in run.own.given:
                i = run.own.given.index(knob.sensor)
                turn = -run.factor[: self.m, i] * self.given[:, i] if knob.gain else -np.ones(self.m)
                found[:, :, j] += by[:, :, paths + i] * turn[:, None]
        return np.asarray(found)

    def _turn(self, w: np.ndarray, A: np.ndarray, dx: np.ndarray) -> np.ndarray:
        """Slopes of the unknowns of a solved stage (m, n_w, k + nx)."""
        (by,) = self.plant.slopes(w, self.u, self.p)
        own = self._own(by)
        b = np.zeros((self.m, A.shape[1], dx.shape[2]))
        b[:, : self.nx] = dx
        b[:, : self.nx, : self.run.k] += self.h * own[:, : self.nx]
        b[:, self.nx :, : self.run.k] = -own[:, self.nx :]
        return np.asarray(np.linalg.solve(A, b))

    def _read(self, w: np.ndarray, dw: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        y, by_w, by = self.plant.reading_slopes(w, self.u, self.p)
        slopes = by_w @ dw
        slopes[:, :, : self.run.k] += self._own(by)
        return y, slopes
