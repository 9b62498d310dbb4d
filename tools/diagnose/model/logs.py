"""A rig run over logs, with exact sensitivities, many windows side by side.

A Kalman filter finds the states at the begin of a window: there they drift by a random walk of their own (state noise).
Then the rig runs freely. Inputs are means over a sample and hold during it; readings are means over it as well, and
their errors count as means over about half an hour.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ....fmu.batch_library import share_rows
from ....scenarios.measured.table import Sensor
from ..library.knobs import Knob
from .plant import Plant, library, record
from .windows import Windows, by_piece

#: Degrees of freedom of the prediction errors: switching and standing pumps make their tails heavy.
TAILS = 4.0
#: Standard deviation at the start of a state that no sensor reads [K].
UNREAD = 6.0
#: Scatter of a reading about the model before it is estimated, in repeatabilities.
SCATTER = 3.0
#: The least it is.
LEAST = 1.0
#: State noise of one sample over it: the filter follows what is read over some hours, so that it is the slow course of
#: a temperature that the knobs explain.
FOLLOWS = 0.04
#: Windows that a thread takes at a time, those that go side by side; and those between two words on progress.
SIDE = 8
BLOCK = 64


@dataclass(frozen=True, eq=False)
class Quadratics:
    """What n groups say of k knobs: eta (n, k), H (n, k, k)."""

    eta: np.ndarray
    H: np.ndarray

    def spread(self, covariance: np.ndarray) -> Quadratics:
        """The same of what the groups scatter about, with a covariance (k, k)."""
        A = np.eye(self.H.shape[1]) + self.H @ covariance
        both = np.linalg.solve(A, np.concatenate([self.H, self.eta[:, :, None]], axis=2))
        H = both[:, :, :-1]
        return Quadratics(both[:, :, -1], (H + H.transpose(0, 2, 1)) / 2)

    def by_duty(self, duty: np.ndarray) -> Quadratics:
        """The same of what the knobs follow: their values, and slopes by each feature of a duty (n, 1 + d)."""
        n, m = duty.shape[0], duty.shape[1] * self.eta.shape[1]
        H = np.einsum("na,nb,nij->naibj", duty, duty, self.H)
        return Quadratics((duty[:, :, None] * self.eta[:, None, :]).reshape(n, m), H.reshape(n, m, m))

    def times(self, share: float) -> Quadratics:
        """The same from a share of the samples."""
        return Quadratics(share * self.eta, share * self.H)

    def summed(self, group: np.ndarray, n: int) -> Quadratics:
        """Summed over the members of each of n groups."""
        eta, H = np.zeros((n, self.eta.shape[1])), np.zeros((n, *self.H.shape[1:]))
        np.add.at(eta, group, self.eta)
        np.add.at(H, group, self.H)
        return Quadratics(eta, H)


@dataclass(frozen=True, eq=False)
class Passed:
    """One pass over windows.

    Args:
        slope, curvature: of the log likelihood, by the knobs (N, k), (N, k, k), the latter positive
        error: prediction errors, means over pieces of windows (N, pieces, reads), NaN where nothing is read or counts
        variance: of them (reads,)
        shown: what the model shows (N, L, reads)
    """

    slope: np.ndarray
    curvature: np.ndarray
    error: np.ndarray
    variance: np.ndarray
    shown: np.ndarray

    def told(self, at: np.ndarray, slopes: np.ndarray | float = 1.0) -> Quadratics:
        """What each window says of its knobs, or of as many numbers that follow them.

        Args:
            at: these numbers there (N, k)
            slopes: of them by the knobs (N, k)
        """
        by = np.broadcast_to(1 / np.asarray(slopes), at.shape)
        H = self.curvature * by[:, :, None] * by[:, None, :]
        return Quadratics(self.slope * by + (H @ at[:, :, None])[:, :, 0], H)


class Filter:
    """A rig with its knobs, compiled, and the noise of its states.

    Args:
        plant: the rig; its knobs are the paths of the knobs here, `given` and `shown` those of the sensors
        knobs: what may differ
        given, read: the sensors, as in the windows
        drift: standard deviation that the random walk of a state that no sensor reads gains in one sample [K] (nx,)
    """

    def __init__(
        self, plant: Plant, knobs: Sequence[Knob], given: Sequence[Sensor], read: Sequence[Sensor], drift: np.ndarray
    ) -> None:
        self.plant, self.knobs = plant, tuple(knobs)
        self.given, self.read = tuple(s.name for s in given), tuple(s.name for s in read)
        #: Repeatability of the inputs (given,) and of the readings (reads,).
        self.given_sd, self.read_sd = (np.array([s.repeat_sd for s in sensors]) for sensors in (given, read))
        #: Scatter of each reading while the filter settles, and about the model, of means over pieces (reads,).
        self.settling = self.scatter = SCATTER * self.read_sd
        #: The least it may be (reads,).
        self.least = LEAST * self.read_sd
        #: Whether what logs hold was read at moments, and is no mean over a sample.
        self.moments = False
        #: Steps of a sample.
        self.parts = 1
        #: State that each sensor reads, -1 where it reads something else.
        names = [q.name for q in plant.flat.states]
        self.state_of = np.array([names.index(path) if path in names else -1 for path in plant.shown])
        #: Standard deviation that the random walk of each state gains in one sample [K] (nx,).
        self.noise, own = drift.copy(), self.state_of >= 0
        self.noise[self.state_of[own]] = FOLLOWS * self.settling[own]

    def settings(self, z: np.ndarray) -> dict[str, np.ndarray]:
        """What knobs z (N, k), those of each window, set.

        Returns:
            p, dp: parameters (N, np), their slopes (N, paths, k)
            factor, shift: of the inputs (N, given) with true = factor * shown - shift
            scaled, offset: of the readings (N, reads) with shown = scaled * true + offset
            by: 1 where a knob moves a reading (reads, k)
        """
        n, k = z.shape
        p = np.tile(self.plant.p, (n, 1))
        dp = np.zeros((n, len(self.plant.knobs), k))
        sensors, g = (*self.given, *self.read), len(self.given)
        by, gain, moved = np.zeros((len(sensors), k)), np.ones((n, len(sensors))), np.zeros((n, len(sensors)))
        for j, knob in enumerate(self.knobs):
            for path, exponent in knob.scaled.items():
                p[:, self.plant.place[path]] *= np.exp(exponent * z[:, j])
            for path in knob.shifted:
                p[:, self.plant.place[path]] += z[:, j]
                dp[:, self.plant.knobs.index(path), j] = 1.0
            if knob.sensor:
                i = sensors.index(knob.sensor)
                by[i, j] = 1.0
                if knob.gain:
                    gain[:, i] *= np.exp(-z[:, j] if i < g else z[:, j])
                else:
                    moved[:, i] += z[:, j]
        for j, knob in enumerate(self.knobs):
            for path, exponent in knob.scaled.items():
                dp[:, self.plant.knobs.index(path), j] = exponent * p[:, self.plant.place[path]]
        (factor, scaled), (shift, offset) = (np.split(both, [g], axis=1) for both in (gain, moved))
        return {"p": p, "dp": dp, "factor": factor, "shift": shift, "scaled": scaled, "offset": offset, "by": by[g:]}

    def start(self, data: Windows, offset: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """States at the start (N, nx), weights of the readings in them (N, nx, reads), standard deviations (nx,)."""
        known, states = np.isfinite(data.read), self.plant.flat.states
        first = np.take_along_axis(data.read, known.argmax(axis=1)[:, None], axis=1)[:, 0] - offset
        there = np.isfinite(first) & (self.state_of >= 0)
        weights = np.zeros((len(first), len(states), len(self.read)))
        bodies = [q.name in self.plant.flat.bodies for q in states]
        weights[:, bodies] = (there / np.maximum(there.sum(axis=1, keepdims=True), 1))[:, None]
        sd = np.array([UNREAD if q.unit == "K" else 0.0 for q in states])
        for j, state in enumerate(self.state_of):
            if state >= 0:
                weights[there[:, j], state] = np.arange(len(self.read)) == j
                sd[state] = self.settling[j]
        x = (weights @ np.nan_to_num(first)[:, :, None])[:, :, 0]
        return np.where(weights.any(axis=2), x, self.plant.flat.starts("state")), weights, sd

    def run(
        self,
        data: Windows,
        z: np.ndarray,
        *,
        slopes: bool = True,
        progress: Callable[[float], None] | None = None,
    ) -> Passed:
        """One pass.

        Args:
            data, z: windows, and the knobs of each (N, k)
            slopes: whether slope and curvature are wanted
            progress: called with the share done
        """
        order = np.argsort(-data.there.sum(axis=1), kind="stable")  # windows of about one length go side by side
        data = data.some(order).paired() if self.moments else data.some(order)
        (n, length, _), k = data.read.shape, z.shape[1] if slopes else 0
        known = self.settings(z[order])
        known |= {"dp": known["dp"][:, :, :k], "by": known["by"][:, :k]}
        x, weights, sd = self.start(data, known["offset"])
        gain = np.array([o.gain for o in self.knobs], dtype=np.int64)
        lengths, piece = data.there.sum(axis=1), data.piece
        logs = record(
            n=n,
            L=length,
            k=k,
            parts=self.parts,
            length=lengths,
            counts=data.counts,
            ends=data.counts & (np.diff(piece, axis=1, append=-1) != 0),
            given=data.given,
            read=data.read,
            **known,
            u=self.plant.u,
            noise=self.given_sd,
            input_of=np.array([self.given.index(o.sensor) if o.sensor in self.given else -1 for o in self.knobs]),
            gain=gain,
            u_at=np.array([self.plant.u_place[path] for path in self.plant.given]),
            state_of=self.state_of,
            x0=x,
            z0=self.plant.flat.starts("algebraic"),
            P0=sd**2,
            S0=-np.einsum("nsr,rk->nks", weights, known["by"] * (1 - gain[:k])),
            Q=self.noise**2,
            scatter=self.settling,
            spread=self.scatter,
            step=np.array([data.step]),
            tails=np.array([TAILS]),
        )
        found = {"slope": np.zeros((n, k)), "curvature": np.zeros((n, k, k)), "shown": np.full(data.read.shape, np.nan)}
        places, run = [ctypes.byref(r) for r in (self.plant.record, logs, record(**found))], library().follow
        for first in range(0, n, BLOCK):
            last = min(first + BLOCK, n)

            def followed(begin: int, end: int, at: int = first) -> int:
                return int(run(*places, at + begin, at + end))

            share_rows(followed, last - first, SIDE, 0)
            if progress:
                progress(float(lengths[:last].sum() / lengths.sum()))
        found["error"] = by_piece(piece, data.read - found["shown"])
        return Passed(variance=self.scatter**2, **{name: values[np.argsort(order)] for name, values in found.items()})


def log_likelihood(passed: Passed) -> float:
    """Of the prediction errors, with heavy tails."""
    far = passed.error**2 / (TAILS * passed.variance)
    return float(-np.nansum((TAILS + 1) / 2 * np.log1p(far) + np.log(passed.variance) / 2))
