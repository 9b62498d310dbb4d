"""What a campaign, and any experiments behind it, tell apart: causes as signatures over all readings at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from scipy.linalg import block_diag

from .candidates import Candidate
from .checks import Check
from .enlarged import Enlarged
from .evidence import White
from .family import Family, Sample, prior_size
from .problem import Linear, Problem
from .scatter import Days
from .weigh import distance

Pair = tuple[str, str]

#: The cause that is a scatter of the days as long as nobody knows what it follows, and the channel that tells.
FOLLOWED, FOLLOWS = "cooling.humidity", "humidity"


@dataclass(frozen=True)
class Scatter:
    """A cause that makes days differ, and its prior size."""

    days: Days
    sd: float


@dataclass(frozen=True)
class Design:
    """Signatures and scatter of m entries: all readings of a campaign and its experiments, then those of checks.

    Args:
        experiments: those that the machine can run
        families: cause -> its forms and their signatures (m, forms)
        covariance: of all entries without a cause (m, m)
        days: effects of each test's cooling (m, tests)
        tied: fixed tolerance -> its effect (m), one standard deviation
        present: mask (m) of what there is without any experiment
        added: experiment -> mask (m) of what it adds
        settled: experiment -> fixed tolerances that it takes away
        followed: experiments that tell what the days follow
        blind: whether the campaign does not
    """

    experiments: tuple[Candidate, ...]
    families: Mapping[str, Family]
    covariance: np.ndarray
    days: np.ndarray
    tied: Mapping[str, np.ndarray]
    present: np.ndarray
    added: Mapping[str, np.ndarray]
    settled: Mapping[str, frozenset[str]]
    followed: frozenset[str]
    blind: bool

    @staticmethod
    def of(problem: Problem, z: np.ndarray, experiments: Sequence[Candidate], samples: Sequence[Sample]) -> Design:
        """Simulate everything.

        Args:
            problem: the campaign and its model, with a reference or without
            z: nuisances at which to look
            experiments: what may follow
            samples: forms of the causes
        """
        enlarged = Enlarged.of(problem, experiments)
        whole, experiments = enlarged.problem, enlarged.experiments
        checks = [check for e in experiments for check in e.checks]
        linear = whole.linearised(z)
        owner = np.array([e.id for e in experiments for check in e.checks for _ in range(check.n)], dtype=object)
        none, shared = np.zeros(len(owner), dtype=bool), np.concatenate([linear.days, whole.tied], axis=1)
        shared = np.concatenate([shared, np.zeros((len(owner), shared.shape[1]))])
        n_days = linear.days.shape[1]
        return Design(
            experiments=experiments,
            families=_families(whole, linear, samples, checks),
            covariance=block_diag(linear.covariance, *(check.covariance() for check in checks)),
            days=shared[:, :n_days],
            tied=dict(zip(whole.tied_names, shared[:, n_days:].T, strict=True)),
            present=np.concatenate([enlarged.present, none]),
            added={e.id: np.concatenate([enlarged.added[e.id], owner == e.id]) for e in experiments},
            settled={e.id: frozenset(name for check in e.checks for name in check.settles) for e in experiments},
            followed=frozenset(e.id for e in experiments if FOLLOWS in e.channels),
            blind=problem.data.model.rows.humidity is None,
        )

    def distances(self, *done: str) -> dict[Pair, float]:
        """Distance of each pair of causes with some experiments done."""
        seen = self.seen(*done)
        pairs = combinations(self.families, 2)
        return {(a, b): min(apart(seen[a], seen[b]), apart(seen[b], seen[a])) for a, b in pairs}

    def seen(self, *done: str) -> dict[str, Family | Scatter]:
        """The causes in units of what the campaign scatters, with some experiments done."""
        rows = np.logical_or.reduce([self.present, *(self.added[name] for name in done)])
        covariance = self.covariance[np.ix_(rows, rows)]
        for name in sorted(set().union(*(self.settled[e] for e in done)) & self.tied.keys()):
            covariance = covariance - np.outer(self.tied[name][rows], self.tied[name][rows])
        white = White.of(np.zeros(len(covariance)), covariance)
        found: dict[str, Family | Scatter] = {}
        for name, f in self.families.items():
            own = replace(f, signatures=f.signatures[rows])
            blind = name == FOLLOWED and self.blind and not self.followed & set(done)
            scatters = f.cause.scatter or blind
            found[name] = self._scatter(own, rows, white) if scatters else own.seen(white)
        return found

    def _scatter(self, f: Family, rows: np.ndarray, white: White) -> Scatter:
        days, sd = self.days[rows], f.cause.size.sd
        if not f.cause.scatter:  # as much as the cooling of the days has to scatter to have the same effect
            sd *= float(np.linalg.norm(f.signatures[:, 0]) / np.linalg.norm(days.sum(axis=1)))
        return Scatter(Days.of(days, white), sd)


def apart(true: Family | Scatter, rival: Family | Scatter) -> float:
    """Standard deviations between a cause at its prior size, in its middle form, and the best form of a rival.

    Where days scatter it is the root of twice the expected difference of the log likelihoods.
    """
    if isinstance(true, Scatter):
        return 0.0 if isinstance(rival, Scatter) else _scattered(true)
    size = prior_size(true.cause)
    if isinstance(rival, Family):
        return distance(true, 0, size, rival)
    g = size * true.white[:, 0]
    gain = float(rival.days.gain((g[None] @ rival.days.directions) ** 2 + 1)[0])
    return float(np.sqrt(max(float(g @ g) - gain, 0.0)))


def visible(cause: Family | Scatter) -> float:
    """Standard deviations between a cause at its prior size and none."""
    if isinstance(cause, Scatter):
        return _scattered(cause)
    return float(abs(prior_size(cause.cause)) * np.sqrt(cause.q[0]))


def _scattered(cause: Scatter) -> float:
    return float(np.sqrt(cause.days.expected(np.array([cause.sd]))[0]))


def _families(
    problem: Problem, linear: Linear, samples: Sequence[Sample], checks: Sequence[Check]
) -> dict[str, Family]:
    """All forms of all causes, nothing seen yet."""
    looked_at = [(s, s.wanted()) for s in samples]
    simulated = problem.signatures(linear, [one for _, wanted in looked_at for one in wanted])
    found, begin = {}, 0
    for s, wanted in looked_at:
        own = [{**form, s.cause.size.name: size} for _, form, size in wanted]
        parts = [check.signatures(s.cause, own, problem.rig.base) for check in checks]
        G = np.concatenate([simulated[:, begin : begin + len(own)], *parts])
        begin += len(own)
        none = np.zeros(len(own))
        found[s.cause.id] = Family(s.cause, own, G, np.zeros_like(G), none, none, s.shares, s.log_w)
    return found
