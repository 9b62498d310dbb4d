"""From weighed hypotheses to answers: classes as one, intervals, adequacy, detectable sizes, look-alikes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.stats import chi2, norm

from ..effects.cause import Cause, Theta
from ..effects.taxonomy import CAUSES
from .evidence import White
from .family import Family
from .findings import UNEXPLAINED, Estimate, Joint, Named
from .hypothesis import Hypothesis
from .scatter import SCATTER
from .search import Search
from .together import by_form, only

#: Power of the detectable size; distance below which two causes are the same to a design; probability that is shown.
POWER, NEAR, SHOWN = 0.8, 2.5, 0.005
#: Bayes factor above which a second cause counts.
ASKED = 3.0
#: A nuisance whose prior is wider than this many standard deviations of the readings counts as fitted.
FREE = 0.5


def joints(search: Search) -> tuple[list[Joint], list[Hypothesis]]:
    """Hypotheses added up under their best member, most probable first.

    Those that differ within a class are one, and a cause that the data do not ask for beside the others does not count.
    """
    known = {frozenset(h.causes): h for h in search.hypotheses}
    groups: dict[tuple[str, ...], list[tuple[Hypothesis, float]]] = {}
    for h, p in zip(search.hypotheses, search.probabilities(), strict=True):
        shown = asked_for(search, h, known)
        groups.setdefault(tuple(sorted(family_of(c) for c in shown)), []).append((h, float(p)))
    merged = []
    for key, members in groups.items():
        named_so = [m for m in members if tuple(sorted(family_of(c) for c in m[0].causes)) == key]
        best = max(named_so, key=lambda member: member[1])[0]
        merged.append((Joint(best.causes, sum(p for _, p in members), best.theta), best))
    merged.sort(key=lambda item: -item[0].probability)
    return [j for j, _ in merged], [h for _, h in merged]


def with_outside(found: Sequence[Joint]) -> list[Joint]:
    """Hypotheses with what is missing to 1, that the library lacks the cause, where that is worth showing."""
    missing = outside(found)
    listed = [*found, Joint((UNEXPLAINED,), missing)] if missing > SHOWN else [*found]
    return sorted(listed, key=lambda joint: -joint.probability)


def outside(found: Sequence[Joint]) -> float:
    """Probability that no hypothesis of the library holds."""
    return max(1.0 - sum(joint.probability for joint in found), 0.0)


def asked_for(search: Search, h: Hypothesis, known: Mapping[frozenset[str], Hypothesis]) -> tuple[str, ...]:
    """The causes of a hypothesis without those whose Bayes factor beside the others is below `ASKED`."""
    fewer = [known[s] for c in h.causes if (s := frozenset(h.causes) - {c}) in known and s]
    if not fewer:
        return h.causes
    best, n = max(fewer, key=lambda other: other.log_posterior), len(h.causes)
    gained = (h.log_posterior - search.prior(n)) - (best.log_posterior - search.prior(n - 1))
    return h.causes if gained > np.log(ASKED) else asked_for(search, best, known)


def family_of(cause: str) -> str:
    """The class a cause belongs to, itself where it has none."""
    return CAUSES[cause].like or cause


def p_adequacy(search: Search, h: Hypothesis) -> float:
    """Omnibus p of what a hypothesis leaves when all nuisances are fitted freely: each takes a degree of freedom."""
    linear, problem = h.linear or search.null, search.problem
    days = problem.card.day_cooling_sd**2 + (h.theta[SCATTER]["sd"] ** 2 if SCATTER in h.theta else 0.0)
    noise = linear.noise - problem.instrument + problem.scatter
    noise = noise + (days - problem.card.day_cooling_sd**2) * linear.days @ linear.days.T
    white = White.of(linear.residual - h.effect, noise)
    Q, d, _ = np.linalg.svd(white.columns(np.concatenate([linear.jacobian, problem.tied], axis=1)), full_matrices=False)
    fitted = d > FREE
    e = white.e - Q[:, fitted] @ (Q[:, fitted].T @ white.e)
    used = int(fitted.sum()) + sum(1 + len(CAUSES[c].shapes) // 2 for c in h.causes)
    return float(chi2.sf(e @ e, max(len(e) - used, 1)))


def named(search: Search, found: Sequence[Joint], leading: Sequence[Hypothesis]) -> list[Named]:
    """Marginal probabilities of all causes, with estimates for those of the leading hypotheses."""
    total = {c.id: 0.0 for c in search.causes}
    for joint in found:
        for c in joint.causes:
            total[c] += joint.probability
    estimated: dict[str, tuple[tuple[Estimate, ...], Mapping[str, tuple[float | None, float | None]]]] = {}
    for h in leading:
        parts = h.parts(search.null)
        at_mode = [only(f, h.theta[f.cause.id]) for f in parts]
        for i, f in enumerate(parts):
            if f.cause.id not in estimated and total[f.cause.id] > SHOWN:
                last = [*at_mode[:i], *at_mode[i + 1 :], f]
                estimated[f.cause.id] = estimates(last, h.theta, alone=len(h.causes) == 1)
    named_causes = []
    for cause in search.causes:
        parameters, regime = estimated.get(cause.id, ((), {}))
        needed = (np.sqrt(search.critical) + norm.ppf(POWER)) ** 2
        family = search.found.get(cause.id)
        detectable = detectable_size(family, needed) if family else search.days.detectable(needed)
        named_causes.append(Named(cause.id, total[cause.id], detectable, parameters, regime))
    return sorted(named_causes, key=lambda n: (-n.probability, n.id))


def estimates(
    parts: Sequence[Family], theta: Mapping[str, Theta], *, alone: bool
) -> tuple[tuple[Estimate, ...], Mapping[str, tuple[float | None, float | None]]]:
    """Size and shapes of the last of some families with 95 % intervals, and its regime in the columns of the data.

    They are from the posterior over its forms, beside what else was found.
    """
    f, found_sizes = parts[-1], [theta[g.cause.id][g.cause.size.name] for g in parts]
    if alone:
        w, (mean, sd) = f.weights(), f.sizes()
    else:
        w, sd = by_form(parts, found_sizes)
        mean = np.full(len(w), found_sizes[-1])
    centre = float(w @ mean)
    spread = float(np.sqrt(w @ (sd**2 + (mean - centre) ** 2)))
    size = f.cause.size
    low, high = (float(np.clip(centre + s * 1.96 * spread, size.low, size.high)) for s in (-1, 1))
    found = [Estimate(size.name, centre, low, high, size.unit)]
    for shape in f.cause.shapes:
        if shape.ends or shape.name == "threshold":
            continue
        values = np.array([form[shape.name] for form in f.forms])
        order = np.argsort(values)
        share = np.cumsum(w[order])
        low, high = (float(values[order][min(int(np.searchsorted(share, s)), len(w) - 1)]) for s in (0.025, 0.975))
        found.append(Estimate(shape.name, float(w @ values), low, high, shape.unit))
    return tuple(found), regime_in_columns(f.cause, theta[f.cause.id])


def regime_in_columns(cause: Cause, theta: Theta) -> Mapping[str, tuple[float | None, float | None]]:
    """Where a form acts, as ranges of the data's columns; empty where it acts everywhere."""
    regime = cause.acts(theta)
    if regime is None:
        return {}
    name, value = regime
    if name in ("d+", "d-"):
        direction = 1.0 if name == "d+" else 2.0
        return {"direction": (direction, direction)}
    column, shown = {
        "w": ("n_carrier_rpm", value * 30 / np.pi),
        "tau": ("T_carrier_Nm", value),
        "T": ("T_oil_C", value - 273.15),
        "film": ("film_mm2_s2", 1e6 * value),
    }[name[:-1]]
    return {column: (float(shown), None) if name.endswith("+") else (None, float(shown))}


def detectable_size(f: Family, needed: float) -> float:
    """The smallest size that these data would reveal with 80 % power, in the middle form of a family."""
    return float(np.sqrt(needed / max(f.q[0], 1e-300)))


def distance(a: Family, k: int, size: float, b: Family) -> float:
    """Standard deviations between a form of given size and the best rescaled form of another family."""
    g = a.white[:, k]
    cosine = (g @ b.white) / np.sqrt(np.maximum(a.q[k] * b.q, 1e-300))
    low, high = b.bounds
    legal = np.where(
        (low < 0) & (high > 0), np.abs(cosine), np.maximum(np.sign(size) * np.sign(high + low) * cosine, 0)
    )
    return float(abs(size) * np.sqrt(a.q[k]) * np.sqrt(max(1 - float(legal.max()) ** 2, 0.0)))


def confusable(search: Search, leading: Sequence[Named]) -> list[tuple[str, ...]]:
    """For each leading cause the set that the design cannot tell from it, declared classes included.

    It is judged at its prior size, or at the size found where that is larger.
    """
    sets = []
    for name in leading:
        if name.id not in search.found:
            continue
        c, f = name.id, search.found[name.id]
        size = max([CAUSES[c].size.sd, *(abs(e.value) for e in name.parameters[:1])])
        near = [
            other
            for other, g in search.found.items()
            if other != c and (family_of(other) == family_of(c) or distance(f, f.best(), size, g) < NEAR)
        ]
        if near:
            sets.append((c, *sorted(near)))
    return sets
