"""Knobs that scatter on three levels: machines of a type, seasons of a machine, windows of a season.

What the samples of a window say of its knobs is a quadratic, exp(eta z - z H z / 2). Deviations of windows from their
season, of seasons from their machine and of machines from their type are independent and normal; their variances are
estimated. Healthy machines differ from season to season, and only what differs by more is a change.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..model.logs import Quadratics
from ..model.windows import at_duty

#: Standard deviation of seasons that is expected before any data, as a share of that of machines.
SEASON = 0.15
#: Of slopes by the duty, a matter of the type: share by which machines differ.
OWN = 0.3
#: How many deviations this expectation counts for.
COUNTS = 2.0
#: Least share of the covariance of seasons by which a season differs from itself at another time.
SAME = 1e-6
#: Rounds of the estimate of the variances.
ROUNDS = 40


@dataclass(frozen=True, eq=False)
class Levels:
    """Covariances of the knobs and of their slopes by the duty on each level, and what is known of each machine.

    Args:
        root: prior covariance of the type about the rig file
        machine, season, window: covariances of the deviations, the last of the knobs alone
        freedom: degrees of freedom of the season's
        mean, covariance: of each machine's knobs and slopes (machines, k), (machines, k, k)
        season_mean, season_covariance: of them in each season of a machine (n, k), (n, k, k)
    """

    root: np.ndarray
    machine: np.ndarray
    season: np.ndarray
    window: np.ndarray
    freedom: float
    mean: np.ndarray
    covariance: np.ndarray
    season_mean: np.ndarray
    season_covariance: np.ndarray

    def within(self, season: int, share: float) -> Levels:
        """The same where a season of the first machine goes on: it deviates by a share of what another one does."""
        mean, covariance = self.mean.copy(), self.covariance.copy()
        mean[0], covariance[0] = self.season_mean[season], self.season_covariance[season]
        return replace(self, mean=mean, covariance=covariance, season=max(share, SAME) * self.season)


def first_levels(sd: np.ndarray, seasons: np.ndarray, slopes: np.ndarray, machines: int, window: float) -> Levels:
    """Levels before any data.

    Args:
        sd, seasons: standard deviations of the knobs between machines, and between seasons of one (k,)
        slopes: of slopes, of a type (k d,)
        machines: how many
        window: of the knobs between windows, as a share of that between machines
    """
    season = np.diag(np.r_[seasons, SEASON * OWN * slopes] ** 2)
    machine, mean = np.diag(np.r_[sd, OWN * slopes] ** 2), np.zeros((machines, len(sd) + len(slopes)))
    root = 1.5**2 * np.diag(np.r_[sd, slopes] ** 2)
    C = np.tile(root + machine, (machines, 1, 1))
    return Levels(root, machine, season, np.diag((window * sd) ** 2), COUNTS, mean, C, mean[:0], C[:0])


def evidence_of(found: Quadratics, duty: np.ndarray, machine: np.ndarray, levels: Levels) -> float:
    """Log evidence of levels by what windows say of the knobs of their machines."""
    machines = found.spread(levels.window).by_duty(duty).summed(machine, len(levels.mean))
    return _log_evidence(found, levels.window) + _log_evidence(machines, levels.root + levels.machine)


def _log_evidence(found: Quadratics, covariance: np.ndarray) -> float:
    """Of what groups say of their knobs, which are normal about the rig file with a covariance (k, k)."""
    A = np.eye(len(covariance)) + found.H @ covariance
    likely = covariance @ np.linalg.solve(A, found.eta[:, :, None])
    return float((found.eta[:, None, :] @ likely).sum() - np.linalg.slogdet(A)[1].sum()) / 2


def open_at(duty: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Covariances of knobs (n, k, k) at duties, from those of their values and slopes."""
    n, f = duty.shape
    k = covariance.shape[1] // f
    return np.asarray(np.einsum("na,naibj,nb->nij", duty, covariance.reshape(n, f, k, f, k), duty, optimize=True))


def estimate(found: Quadratics, duty: np.ndarray, season: np.ndarray, machine_of: np.ndarray, begun: Levels) -> Levels:
    """Covariances of seasons and windows, and the knobs of machines, from healthy logs.

    Seasons of all machines share one covariance: knobs that move together in some of them may do so in any other.

    Args:
        found: of the windows (n)
        duty: of them (n, 1 + d)
        season: number of each window's season of a machine (n,)
        machine_of: machine of each season of a machine
        begun: levels to begin with; its expectations count as data
    """
    levels, machines, k = begun, len(begun.mean), len(begun.root)
    type_of = np.zeros(machines, dtype=int)
    for _ in range(ROUNDS):
        windows = found.spread(levels.window).by_duty(duty).summed(season, len(machine_of))
        seasons = windows.spread(levels.season).summed(machine_of, machines)
        types = seasons.spread(levels.machine).summed(type_of, 1)
        m, C, _ = _down(types, levels.root, np.zeros((1, k)), np.zeros((1, k, k)))
        z, Cz, _ = _down(seasons, levels.machine, m[type_of], C[type_of])
        zy, Cy, moved = _down(windows, levels.season, z[machine_of], Cz[machine_of])
        _, _, wandered = _down(found, levels.window, at_duty(duty, zy[season]), open_at(duty, Cy[season]))
        n = len(machine_of)
        levels = replace(
            levels,
            season=_shrunk(moved + COUNTS * begun.season, n + COUNTS, n / (n + k)),
            window=_shrunk(wandered + COUNTS * begun.window, len(found.eta) + COUNTS, 0.0),
            freedom=max(n - len(np.unique(machine_of)), 0) + COUNTS,
            mean=z,
            covariance=Cz,
            season_mean=zy,
            season_covariance=Cy,
        )
    return levels


def _down(
    own: Quadratics, spread: np.ndarray, m: np.ndarray, C: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Values (n, k) with covariance given the parents', and the summed squares (k, k) of what deviates from these."""
    inverse = np.linalg.inv(own.H + np.linalg.inv(spread))
    mean = (inverse @ (own.eta - (own.H @ m[:, :, None])[:, :, 0])[:, :, None])[:, :, 0]
    share = inverse @ own.H
    cov = inverse + share @ C @ share.transpose(0, 2, 1)
    keep = np.eye(len(spread)) - share
    return m + mean, inverse + keep @ C @ keep.transpose(0, 2, 1), mean.T @ mean + cov.sum(axis=0)


def _shrunk(squares: np.ndarray, n: float, kept: float) -> np.ndarray:
    """A covariance from summed squares of n, of which a share of what ties the knobs is kept."""
    whole = (squares + squares.T) / (2 * n)
    return np.asarray(kept * whole + (1 - kept) * np.diag(np.diag(whole)))
