"""Sets of terms that act together, weighed to first order.

A residual is r ~ N(G t, V + sum of w^2 C C'): t are the sizes of causes and gross readings, C the columns of what
scatters. The scatter, its scales and what scatters beside it, whitens everything; in each whitening the likeliest sets
of sizes grow, shrink and exchange members, and the likeliest set says which scatter is worth a look next.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cached_property
from itertools import count

import numpy as np

from .evidence import White, averaged, by_width, prior_mass
from .prior import SAME, kind
from .terms import Linear, Scatter, TermSet

#: Sizes that may act together, gross readings among them.
MOST = 12
#: Sets beside which all sizes are weighed, in the first scatters and in further ones.
LOOKS = (40, 15)
#: Neighbours kept of each.
KEPT = 30
#: Of one family.
ALIKE = 3
#: Nats behind the likeliest at which a set or a scatter is no longer looked at.
WINDOW = 7.0
#: Scatters looked at after the one with the likeliest set.
SCATTERS = 4
#: Rounds of choosing the widths of a set's members in turn.
ROUNDS = 2

#: Minus a log joint density, members and widths of a set that is worth a look.
_Offer = tuple[float, tuple[int, ...], tuple[float, ...]]


class Table:
    """What all terms have in common, whatever the scatter: their columns, priors and bounds as arrays."""

    def __init__(self, linear: Linear) -> None:
        own = [t for t in linear.terms if not t.scatters]
        self.linear, self.n = linear, len(own)
        self.columns = np.concatenate([t.columns for t in own], axis=1)
        self.low, self.high = np.array([t.low for t in own]), np.array([t.high for t in own])
        self.shares = np.array([t.log_prior for t in linear.terms])
        self.families = np.array([t.family for t in linear.terms])
        names = [t.name if t.formula else "" for t in linear.terms]
        self.names, self.kinds = np.array(names), np.array([kind(name) for name in names])
        self.causes = self.names != ""
        #: Numbers that stand for the words of each term: its name, its kind of instrument, its family (3, k).
        self.codes = np.array(
            [np.unique(words, return_inverse=True)[1] for words in (names, self.kinds, self.families)]
        )
        #: Scatters with as many columns and the same widths: their numbers, widths (w,), columns one after the other.
        self.scatters = []
        #: Sizes of the same widths: their numbers, the widths, the prior's log mass inside the bounds, and the most
        #: that bounds can add to a log Bayes factor.
        self.groups = []
        alike: dict[tuple[bool, int, tuple[float, ...]], list[int]] = {}
        for number, t in enumerate(linear.terms):
            alike.setdefault((t.scatters, t.columns.shape[1], tuple(t.widths)), []).append(number)
        for (scatters, _, widths), numbers in alike.items():
            tried = np.array(widths)
            if scatters:
                columns = np.concatenate([linear.terms[k].columns for k in numbers], axis=1)
                self.scatters.append((numbers, tried, columns))
            else:
                k = np.array(numbers)
                prior = prior_mass(self.low[k], self.high[k], tried)
                self.groups.append((k, tried, prior, -prior.min(axis=0)))

    def named(self, members: Sequence[int]) -> list[str]:
        """The causes of a set, each once."""
        return list(dict.fromkeys(str(self.names[k]) for k in members if self.causes[k]))

    def log_prior(self, members: Sequence[int]) -> float:
        """Of a set, over that of one cause."""
        causes = self.named(members)
        number = self.linear.prior.number(causes) if causes else self.linear.critical
        return float(self.shares[list(members)].sum() + number - self._again(members))

    def _again(self, members: Sequence[int]) -> float:
        """Log shares of causes that act by two terms: a size beside what it is anew with each mounting."""
        names, share = self.names[list(members)].tolist(), self.linear.prior.share
        return float(sum(share[c] * (names.count(c) - 1) for c in self.named(members)))

    def log_priors(self, members: Sequence[int]) -> np.ndarray:
        """Of a set with each of the terms (k,); -inf where they do not go together."""
        causes, prior, (name, same, family) = self.named(members), self.linear.prior, self.codes
        like, own = _any(same, [k for k in members if self.kinds[k]]), prior.number(causes)
        number = own + prior.further(len(causes)) + like * np.log(SAME)
        for k in (k for k in members if self.causes[k]):  # by another term
            number[name == name[k]] = own - prior.share[str(self.names[k])]
        number = np.where(self.causes, number, own if causes else self.linear.critical)
        logs = self.shares + number - self._again(members)
        taken = _any(family, members) | self.causes & (len(causes) >= self.linear.most)
        return np.where(taken, -np.inf, logs + self.shares[list(members)].sum())


def _any(codes: np.ndarray, members: Sequence[int]) -> np.ndarray:
    """Which of some codes are those of any of the members (k,)."""
    return np.asarray((codes == codes[list(members), None]).any(axis=0))


class Whitened:
    """All terms in the units of one scatter."""

    def __init__(self, table: Table, scatter: Scatter) -> None:
        self.table, self.scatter, linear = table, scatter, table.linear
        self.white = White.of(linear.covariance(scatter.scales, scatter.beside))
        self.e = self.white(linear.residual)
        #: Log density of the residual without any size.
        self.log = self.white.log_density(self.e) + linear.at(scatter.scales).log_prior

    @cached_property
    def sizes(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Columns of all sizes (M, n), their squared lengths and products with the residual (n,)."""
        W = self.white(self.table.columns)
        return W, (W**2).sum(axis=0), W.T @ self.e

    def beside(self, widths: Iterable[tuple[int, float]]) -> tuple[np.ndarray, np.ndarray, float]:
        """Beside terms of some widths: what ties other columns to them (M, j), what they explain (j,), log density."""
        U = self.white(self.table.linear.sized(widths))
        root = np.linalg.cholesky(U.T @ U + np.eye(U.shape[1]))
        turned = np.linalg.solve(root, U.T).T
        b = turned.T @ self.e
        return turned, b, float(0.5 * b @ b - np.log(np.diag(root)).sum())

    def gains(self, turned: np.ndarray, b: np.ndarray, least: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Log Bayes factor of every size beside a set (n,), and its likeliest width (n,).

        Args:
            turned, b: of `beside`
            least: what a size's must come to (n,); those that cannot have -inf
        """
        W, length, along = self.sizes
        tie = turned.T @ W
        s, q = along - b @ tie, np.maximum(length - (tie**2).sum(axis=0), 1e-12)
        logs, at = np.full(len(s), -np.inf), np.zeros(len(s))
        for own, tried, prior, most in self.table.groups:
            able = 0.5 * s[own] ** 2 / q[own] + most > least[own]
            if len(k := own[able]):
                each, inside = by_width(s[k], q[k], self.table.low[k], self.table.high[k], tried)
                logs[k], at[k] = averaged(each + inside, prior[:, able]), tried[np.argmax(each, axis=0)]
        return logs, at

    def scored(self, members: Sequence[int], widths: Sequence[float]) -> TermSet:
        """A set with the widths of its members chosen in turn, and its log joint density."""
        n, own, more = len(members), np.array(widths), np.zeros(len(widths))
        table = self.table
        W = self.white(table.columns[:, list(members)])
        A, c = W.T @ W, W.T @ self.e
        for _ in range(ROUNDS):
            for i, k in enumerate(members):
                rest = np.arange(n) != i
                tie = np.linalg.solve(A[np.ix_(rest, rest)] + np.diag(own[rest] ** -2), A[rest, i])
                s, q = float(c[i] - c[rest] @ tie), float(max(A[i, i] - A[i, rest] @ tie, 1e-12))
                tried, low, high = table.linear.terms[k].widths, table.low[k], table.high[k]
                free, inside = by_width(s, q, low, high, tried)
                logs = free + inside - prior_mass(low, high, tried)[:, 0]
                best = int(np.argmax(logs))
                own[i], more[i] = tried[best], np.logaddexp.reduce(logs) - np.log(len(logs)) - free[best]
        _, _, log = self.beside(zip(members, own.tolist(), strict=True))
        beside = [k for k, _ in self.scatter.beside]
        whole = self.log + log + float(more.sum()) + table.log_prior([*members, *beside])
        return TermSet(tuple(members), tuple(own.tolist()), self.scatter, whole)

    def search(self, starts: Sequence[TermSet], looks: int) -> list[TermSet]:
        """The likeliest sets in this scatter, best first.

        Args:
            starts: sets to begin from beside the empty one
            looks: sets at most beside which all sizes are weighed
        """
        known: dict[frozenset[int], TermSet] = {}
        seen = set[frozenset[int]]()
        queue: list[_Offer] = [(-np.inf, (), ()), *((-np.inf, s.members, s.widths) for s in starts)]
        best = -np.inf
        while queue and len(seen) < looks:
            log, members, widths = heapq.heappop(queue)
            if frozenset(members) in known or -log < best - WINDOW:
                continue
            own = known[frozenset(members)] = self.scored(members, widths)
            best = max(best, own.log)
            if members and own.log < best - WINDOW:
                continue
            fewer = [
                (members[:i] + members[i + 1 :], own.widths[:i] + own.widths[i + 1 :]) for i in range(len(members))
            ]
            for base in [(own.members, own.widths), *fewer]:
                if frozenset(base[0]) not in seen and len(base[0]) < MOST:
                    seen.add(frozenset(base[0]))
                    for offer in self._offers(*base, best):
                        if frozenset(offer[1]) not in known and -offer[0] > best - WINDOW:
                            heapq.heappush(queue, offer)
        return sorted(known.values(), key=lambda s: (-s.log, s.members))

    def _offers(self, members: tuple[int, ...], widths: tuple[float, ...], best: float) -> Iterator[_Offer]:
        """A set, and it with each of the likeliest further members, near enough to the best known log joint density."""
        turned, b, log = self.beside(zip(members, widths, strict=True))
        whole, kept = self.log + log, [*members, *(k for k, _ in self.scatter.beside)]
        yield -(whole + self.table.log_prior(kept)), members, widths
        prior = self.table.log_priors(kept)[: self.table.n]
        gains, at = self.gains(turned, b, best - WINDOW - whole - prior)
        logs = whole + gains + prior
        taken: dict[str, int] = {}
        able = np.flatnonzero(logs > best - WINDOW)
        for k in able[np.argsort(-logs[able], kind="stable")][: 2 * KEPT].tolist():
            family = str(self.table.families[k])
            if taken.get(family, 0) < ALIKE:
                taken[family] = taken.get(family, 0) + 1
                yield -float(logs[k]), (*members, k), (*widths, float(at[k]))

    def scatters(self, own: TermSet, least: float) -> Iterator[tuple[float, Scatter, TermSet]]:
        """Scatters nearby, and the log joint density there of what is left of a set: less, more, others, other scales.

        Left of the set are all members, none, or all but those of one family or instrument that a scatter may replace.
        What is one more and comes to less than the least is left out.
        """
        sides, table = self.scatter.beside, self.table
        groups = [table.kinds[k] or table.families[k] for k in own.members]
        left = [tuple(k for k, group in enumerate(groups) if group != gone) for gone in ("", *groups)]
        for beside in (sides, *(tuple(b for b in sides if b is not a) for a in sides)):
            near = self if beside == sides else Whitened(table, Scatter(self.scatter.scales, beside))
            for kept in dict.fromkeys([*(left if near is self else left[:1]), ()]):
                base = near.scored([own.members[k] for k in kept], [own.widths[k] for k in kept])
                yield base.log, near.scatter, base
                yield from near._further(base, least)
        yield own.log, table.linear.rescaled(self.scatter, own.sized), own

    @cached_property
    def scattering(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Of scatters that the table has together: products of whitened columns (k, c, c), with the residual (k, c)."""
        found = []
        for numbers, _, columns in self.table.scatters:
            C = np.ascontiguousarray(self.white(columns).reshape(len(self.e), len(numbers), -1).swapaxes(0, 1))
            found.append((C.swapaxes(1, 2) @ C, self.e @ C))
        return found

    def _further(self, own: TermSet, least: float) -> Iterator[tuple[float, Scatter, TermSet]]:
        """One more scatter beside a set in this one, at its likeliest width: log joint density, scatter, the set."""
        turned, b, _ = self.beside(own.sized)
        back, left = self.white.turned(turned).T, self.e @ self.e - b @ b
        logs = own.log + self.table.log_priors(own.terms) - self.table.log_prior(own.terms)
        for (numbers, widths, columns), (products, along) in zip(self.table.scatters, self.scattering, strict=True):
            if not np.isfinite(logs[numbers]).any():
                continue
            tie = (back @ columns).reshape(len(back), *along.shape).swapaxes(0, 1)
            k, c = along.shape
            inner = np.full((k, c + 1, c + 1), left)  # of columns and residual
            inner[:, :c, :c], inner[:, c, :c] = products - tie.swapaxes(1, 2) @ tie, along - b @ tie
            v = np.append(np.repeat(widths[:, None], c, axis=1), np.ones((len(widths), 1)), axis=1)[:, None]
            root = np.linalg.cholesky(inner * v[..., None] * v[..., None, :] + np.diag([1.0] * c + [0.0]))
            diagonal = np.diagonal(root, axis1=2, axis2=3)
            gains = 0.5 * (left - diagonal[..., c] ** 2) - np.log(diagonal[..., :c]).sum(axis=2)
            found, best = logs[numbers] + gains.max(axis=0), widths[gains.argmax(axis=0)]
            for i in np.flatnonzero(found > least):
                beside = tuple(sorted((*own.scatter.beside, (numbers[i], float(best[i])))))
                yield float(found[i]), Scatter(own.scatter.scales, beside), own


def search(
    linear: Linear, begun: Sequence[Scatter], progress: Callable[[float], None], scatters: int = SCATTERS
) -> list[TermSet]:
    """The likeliest sets of terms in all scatters looked at, from some on, best first; one of each set of terms.

    Args:
        progress: told the share done
        scatters: looked at after the one with the likeliest set
    """
    table, found = Table(linear), dict[tuple[int, ...], TermSet]()
    seen, best, number, later = set[Scatter](), -np.inf, count(), 0
    queue: list[tuple[float, int, Scatter, tuple[TermSet, ...]]]
    queue = [(-np.inf, next(number), own, ()) for own in begun]

    while queue and later < scatters:
        promise, _, scatter, starts = heapq.heappop(queue)
        if -promise < best - WINDOW or scatter.alike in seen:
            continue
        seen.add(scatter.alike)
        if starts and (other := linear.rescaled(scatter, starts[0].sized)) != scatter:
            if other.alike in seen:
                continue
            seen.add(other.alike)
            scatter = other
        white = Whitened(table, scatter)
        sets = white.search(starts, LOOKS[bool(starts)])
        for s in sets:
            if s.terms not in found or found[s.terms].log < s.log:
                found[s.terms] = s
        later = 0 if sets[0].log > best else later + 1
        best = max(best, sets[0].log)
        progress(len(seen) / (len(seen) + scatters - later))
        for log, other, base in white.scatters(sets[0], best - WINDOW):
            if log > best - WINDOW:
                heapq.heappush(queue, (-log, next(number), other, (base, *sets[:2])))
    return sorted(found.values(), key=lambda s: (-s.log, s.terms))
