"""Evidence of several families of forms together, by Gaussian algebra at one form of each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.special import logsumexp

from ..effects.cause import Theta
from .evidence import WIDTHS
from .family import Family, best_pair, form_of, pair_evidence

#: Share of the prior's half width from a bound within which a size is at it.
NEAR = 1e-3


def evidence_of(parts: Sequence[Family]) -> float:
    """Log Bayes factor of families together, averaged over their forms: from three on over one family at a time."""
    if len(parts) == 1:
        return parts[0].evidence()
    return pair_evidence(*parts)[0] if len(parts) == 2 else joint(parts)[0]


def only(f: Family, theta: Theta) -> Family:
    """A family of one form: that of given parameters."""
    k = form_of(f, theta)
    part = slice(k, k + 1)
    return replace(
        f,
        forms=[f.forms[k]],
        signatures=f.signatures[:, part],
        white=f.white[:, part],
        s=f.s[part],
        q=f.q[part],
        shares=f.shares[part],
        log_w=np.zeros(1),
    )


def joint(parts: Sequence[Family]) -> tuple[float, np.ndarray]:
    """Log Bayes factor of several families together against none, and their sizes, all at their first forms but one.

    The forms are averaged over one family at a time; what that gains or loses is added up. The last family has its
    best form instead of its first.
    """
    best = [0] * len(parts)
    best[-1] = int(np.argmax(joint_logs(parts)))
    base, sizes = gaussian(parts, best)
    total = base
    for i, f in enumerate(parts):
        if len(f.forms) == 1:
            continue
        logs = np.array([gaussian(parts, [*best[:i], k, *best[i + 1 :]])[0] for k in range(len(f.forms))]) + f.log_w
        total += float(logsumexp(logs)) - np.log(len(logs)) - base
    return total, sizes


def best_together(parts: Sequence[Family]) -> tuple[list[int], np.ndarray]:
    """The best form of each of several families, one family at a time, and their sizes."""
    best = [0] * len(parts)
    if len(parts) == 2:
        best = list(best_pair(pair_evidence(*parts)[1]))
    else:
        for i, f in enumerate(parts):
            logs = [gaussian(parts, [*best[:i], k, *best[i + 1 :]])[0] for k in range(len(f.forms))]
            best[i] = int(np.argmax(logs))
    return best, gaussian(parts, best)[1]


def joint_logs(parts: Sequence[Family]) -> np.ndarray:
    """Log Bayes factors of several families, one value for each form of the last one."""
    first = [0] * (len(parts) - 1)
    logs = [gaussian(parts, [*first, k])[0] for k in range(len(parts[-1].forms))]
    return np.asarray(np.array(logs) + parts[-1].log_w)


def by_form(parts: Sequence[Family], sizes: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """Of each form of the last family its posterior weight, and the standard deviation of its size.

    The others have their first forms, and any size; where they were found at a bound they stay there.
    """
    *others, f = parts
    free = [g for g, size in zip(others, sizes, strict=False) if not _at_bound(g, size)]
    variances = [covariance([*free, f], [*[0] * len(free), k])[-1, -1] for k in range(len(f.forms))]
    logs = joint_logs(parts)
    return np.exp(logs - logsumexp(logs)), np.sqrt(variances)


def _at_bound(f: Family, size: float) -> bool:
    room = NEAR * f.cause.size.sd
    return not f.cause.size.low + room < size < f.cause.size.high - room


def covariance(parts: Sequence[Family], forms: Sequence[int]) -> np.ndarray:
    """Covariance of the sizes of some forms together, under wide priors."""
    Q, _, sd = _information(parts, forms)
    return np.linalg.inv(Q + np.diag(1 / (WIDTHS[-1] * sd) ** 2))


def _information(parts: Sequence[Family], forms: Sequence[int]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What the readings say of the sizes of some forms (information, score), and their prior standard deviations."""
    G = np.stack([f.white[:, k] for f, k in zip(parts, forms, strict=True)], axis=1)
    s = np.array([f.s[k] for f, k in zip(parts, forms, strict=True)])
    return G.T @ G, s, np.array([f.cause.size.sd for f in parts])


def gaussian(parts: Sequence[Family], forms: Sequence[int]) -> tuple[float, np.ndarray]:
    """Log Bayes factor of some forms together, and their most likely sizes, under priors as wide as the sizes ask."""
    Q, s, sd = _information(parts, forms)
    wide = np.diag(1 / (WIDTHS[-1] * sd) ** 2)
    sizes = np.linalg.solve(Q + wide, s)
    widths = WIDTHS[np.argmin(np.abs(np.log(WIDTHS) - np.log(np.abs(sizes / sd) + 1e-9)[:, None]), axis=1)]
    v = (widths * sd) ** 2
    A, low, high = Q + np.diag(1 / v), *np.array([(f.cause.size.low, f.cause.size.high) for f in parts]).T
    sizes = np.linalg.solve(A, s)
    wrong = (sizes < low) | (sizes > high)
    if wrong.any():  # held at the bound, the others as likely as can be beside it
        sizes, free = np.clip(sizes, low, high), ~wrong
        sizes[free] = np.linalg.solve(A[np.ix_(free, free)], s[free] - A[np.ix_(free, wrong)] @ sizes[wrong])
    log = s @ sizes - 0.5 * sizes @ A @ sizes - 0.5 * np.linalg.slogdet(np.eye(len(s)) + v[:, None] * Q)[1]
    log += np.log(2.0) * ((low >= 0) | (high <= 0)).sum() - np.log(len(WIDTHS)) * len(s)
    return float(log), sizes
