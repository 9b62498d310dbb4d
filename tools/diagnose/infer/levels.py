"""Knobs that scatter on three levels: machines of a type, seasons of a machine, windows of a season.

What the samples of a window say of its knobs is a quadratic, exp(eta z - z H z / 2). Deviations of windows from their
season, of seasons from their machine and of machines from their type are independent and normal; their variances are
estimated. Healthy machines differ from season to season, and only what differs by more is a change.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

#: Standard deviations of seasons and windows that are expected before any data.
SEASON = 0.25
#: As shares of that of machines.
WINDOW = 0.25
#: How many deviations this expectation counts for.
COUNTS = 2.0
#: Rounds of the estimate of the variances.
ROUNDS = 40


@dataclass(frozen=True, eq=False)
class Quadratics:
    """What n groups say of k knobs: eta (n, k), H (n, k, k)."""

    eta: np.ndarray
    H: np.ndarray

    def spread(self, variance: np.ndarray) -> Quadratics:
        """The same of what the groups scatter about, with a variance (k,)."""
        A = np.eye(self.H.shape[1]) + self.H * variance
        return Quadratics(np.linalg.solve(A, self.eta[:, :, None])[:, :, 0], _even(np.linalg.solve(A, self.H)))

    def summed(self, group: np.ndarray, n: int) -> Quadratics:
        """Summed over the members of each of n groups."""
        eta, H = np.zeros((n, self.eta.shape[1])), np.zeros((n, *self.H.shape[1:]))
        np.add.at(eta, group, self.eta)
        np.add.at(H, group, self.H)
        return Quadratics(eta, H)

    def some(self, keep: np.ndarray) -> Quadratics:
        """Some of the groups."""
        return Quadratics(self.eta[keep], self.H[keep])


def _even(H: np.ndarray) -> np.ndarray:
    return np.asarray((H + H.transpose(0, 2, 1)) / 2)


@dataclass(frozen=True, eq=False)
class Levels:
    """Variances of the knobs (k,) on each level, and what is known of each machine.

    Args:
        root: prior variance of the type about the rig file
        machine, season, window: variances of the deviations
        freedom: degrees of freedom of the season's variances
        mean, covariance: of each machine's knobs (machines, k), (machines, k, k)
        seasons: mean deviation of each season (seasons, k) and its standard deviation
    """

    root: np.ndarray
    machine: np.ndarray
    season: np.ndarray
    window: np.ndarray
    freedom: float
    mean: np.ndarray
    covariance: np.ndarray
    seasons: np.ndarray
    seasons_sd: np.ndarray


def first_levels(sd: np.ndarray, machines: int) -> Levels:
    """Levels before any data.

    Args:
        sd: of the knobs between machines (k,)
        machines: their number
    """
    k = len(sd)
    root, machine = (1.5 * sd) ** 2, sd**2
    C = np.tile(np.diag(root + machine), (machines, 1, 1))
    mean, none = np.zeros((machines, k)), np.zeros((0, k))
    return Levels(root, machine, (SEASON * sd) ** 2, (WINDOW * sd) ** 2, COUNTS, mean, C, none, none)


def estimate(found: Quadratics, season: np.ndarray, machine_of: np.ndarray, begun: Levels) -> Levels:
    """Variances of seasons and windows, and the knobs of machines, from healthy logs.

    Args:
        found: of the windows (n)
        season: number of each window's season of a machine (n,)
        machine_of: machine of each season of a machine
        begun: levels to begin with; its expectations count as data
    """
    levels = begun
    machines = len(begun.mean)
    for _ in range(ROUNDS):
        windows = found.spread(levels.window).summed(season, len(machine_of))
        seasons = windows.spread(levels.season).summed(machine_of, machines)
        top = seasons.spread(levels.machine).summed(np.zeros(machines, dtype=int), 1)
        C = np.linalg.inv(top.H + np.diag(1 / levels.root))
        m = (C @ top.eta[:, :, None])[:, :, 0]
        parents = np.zeros(machines, dtype=int)
        z, Cz, _, _ = _down(seasons, levels.machine, m[parents], C[parents])
        zy, Cy, dy, vy = _down(windows, levels.season, z[machine_of], Cz[machine_of])
        _, _, dw, vw = _down(found, levels.window, zy[season], Cy[season])
        levels = replace(
            levels,
            season=_variance(dy, vy, begun.season),
            window=_variance(dw, vw, begun.window),
            freedom=max(len(machine_of) - len(np.unique(machine_of)), 0) + COUNTS,
            mean=z,
            covariance=Cz,
            seasons=dy,
            seasons_sd=np.sqrt(vy),
        )
    return levels


def _down(
    own: Quadratics, variance: np.ndarray, m: np.ndarray, C: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Values (n, k) with covariance, and deviations from the parents (n, k) with variances, given the parents'."""
    inverse = np.linalg.inv(own.H + np.diag(1 / variance))
    mean = (inverse @ (own.eta - (own.H @ m[:, :, None])[:, :, 0])[:, :, None])[:, :, 0]
    share = inverse @ own.H
    cov = inverse + share @ C @ share.transpose(0, 2, 1)
    keep = np.eye(len(variance)) - share
    return m + mean, inverse + keep @ C @ keep.transpose(0, 2, 1), mean, np.einsum("nii->ni", cov)


def _variance(mean: np.ndarray, variance: np.ndarray, expected: np.ndarray) -> np.ndarray:
    return np.asarray(((mean**2 + variance).sum(axis=0) + COUNTS * expected) / (len(mean) + COUNTS))


@dataclass(frozen=True)
class Effect:
    """A knob that has moved: its number, the share of its move in each window (n,), and what this share is in words."""

    knob: int
    share: np.ndarray
    when: str


class Target:
    """Logs in which causes act: windows of some seasons of one machine.

    Args:
        found: quadratics of the windows (n)
        season: number of each window's season (n,)
        mean, covariance: of the machine's knobs by its healthy logs
        levels: variances
    """

    def __init__(
        self, found: Quadratics, season: np.ndarray, mean: np.ndarray, covariance: np.ndarray, levels: Levels
    ) -> None:
        self.found, self.season, self.levels = found.spread(levels.window), season, levels
        self.k, self.seasons = len(mean), int(season.max()) + 1
        self.precision = np.linalg.inv(covariance)
        self.pull = self.precision @ mean

    def columns(self, share: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Cross terms with the unknowns (d, k), own terms (k, k) and pull (k,) of all knobs moved by a share."""
        by_season = Quadratics(self.found.eta * share[:, None], self.found.H * share[:, None, None])
        summed = by_season.summed(self.season, self.seasons)
        cross = np.concatenate([summed.H.sum(axis=0), *summed.H])
        own = (self.found.H * (share**2)[:, None, None]).sum(axis=0)
        return cross, own, summed.eta.sum(axis=0)

    def base(self, season_variance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Precision (d, d) and pull (d,) of the unknowns: the machine's knobs, then each season's deviations."""
        summed, k = self.found.summed(self.season, self.seasons), self.k
        d = k * (1 + self.seasons)
        A, b = np.zeros((d, d)), np.zeros(d)
        A[:k, :k], b[:k] = self.precision + summed.H.sum(axis=0), self.pull + summed.eta.sum(axis=0)
        for y in range(self.seasons):
            own = slice(k * (y + 1), k * (y + 2))
            A[own, own] = summed.H[y] + np.diag(1 / season_variance)
            A[own, :k] = A[:k, own] = summed.H[y]
            b[own] = summed.eta[y]
        return A, b

    def with_effects(
        self, effects: Sequence[Effect], sd: Sequence[float], season_variance: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Precision and pull with the sizes of effects as further unknowns, each with its prior."""
        A, b = self.base(season_variance)
        d, e = len(b), len(effects)
        whole, pull = np.zeros((d + e, d + e)), np.concatenate([b, np.zeros(e)])
        whole[:d, :d] = A
        for i, effect in enumerate(effects):
            cross, own, eta = self.columns(effect.share)
            whole[:d, d + i] = whole[d + i, :d] = cross[:, effect.knob]
            whole[d + i, d + i] = own[effect.knob, effect.knob] + 1 / sd[i] ** 2
            pull[d + i] = eta[effect.knob]
            for j, other in enumerate(effects[:i]):
                common = (self.found.H[:, effect.knob, other.knob] * effect.share * other.share).sum()
                whole[d + i, d + j] = whole[d + j, d + i] = common
        return whole, pull

    def evidence(self, effects: Sequence[Effect], sd: Sequence[float]) -> tuple[float, np.ndarray, np.ndarray]:
        """Logarithm of the evidence less that of no effect, sizes (e,) and their covariance.

        What a knob moves by within the logs is judged against moves as large as those of healthy seasons.
        The seasons' variances of the knobs in question have few degrees of freedom, and are averaged over.
        """
        scales, weights = scale_grid(self.levels.freedom)
        knobs = np.unique([e.knob for e in effects])
        logs, nulls, sizes, covariances = [], [], [], []
        for scale in scales:
            variance = self.levels.season.copy()
            variance[knobs] *= scale
            usual = [e for e in effects if np.ptp(e.share) > 0]
            own = [float(np.sqrt(variance[e.knob])) for e in usual]
            wide = [
                float(np.hypot(s, np.sqrt(variance[e.knob]) * (np.ptp(e.share) > 0)))
                for e, s in zip(effects, sd, strict=True)
            ]
            A, b = self.with_effects(effects, wide, variance)
            d = len(b) - len(effects)
            prior = -0.5 * self.seasons * np.log(variance).sum()
            logs.append(prior + _log_integral(A, b) - np.log(wide).sum())
            nulls.append(prior + _log_integral(*self.with_effects(usual, own, variance)) - np.log(own).sum())
            C = np.linalg.inv(A)
            sizes.append((C @ b)[d:])
            covariances.append(C[d:, d:])
        top = max(logs)
        share = np.exp(np.array(logs) - top) * weights
        null_top = max(nulls)
        null = null_top + np.log((np.exp(np.array(nulls) - null_top) * weights).sum())
        value = top + np.log(share.sum()) - null
        share /= share.sum()
        mean = np.einsum("s,se->e", share, np.array(sizes))
        off = np.array(sizes) - mean
        cov = np.einsum("s,sef->ef", share, np.array(covariances)) + np.einsum("s,se,sf->ef", share, off, off)
        return float(value), mean, cov


def scale_grid(freedom: float) -> tuple[np.ndarray, np.ndarray]:
    """Factors on an estimated variance and their weights: an inverse gamma distribution."""
    scales = 2.0 ** np.arange(-2.0, 5.0)
    density = -(freedom / 2) * np.log(scales) - freedom / (2 * scales)
    weights = np.exp(density - density.max())
    return scales, weights / weights.sum()


def _log_integral(A: np.ndarray, b: np.ndarray) -> float:
    """Logarithm of the integral of exp(b x - x A x / 2), up to a constant of the number of unknowns that cancels."""
    L = np.linalg.cholesky(A)
    y = np.linalg.solve(L, b)
    return float(0.5 * y @ y - np.log(np.diag(L)).sum())
