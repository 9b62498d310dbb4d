"""From weighed hypotheses to answers: classes as one, marginal probabilities, one verdict that agrees with them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain, compress

import numpy as np
from scipy.special import chdtrc

from ..infer.evidence import White
from ..infer.found import Found, Hypothesis, Member
from ..infer.prior import OUTSIDE
from ..infer.problem import priors
from .findings import UNEXPLAINED, Verdict

#: Probability from which one answer explains the data, and that several together reach.
SURE = 0.9
#: Probability of a member of a class that is named, as a share of its class.
MEMBER = 0.02
#: Exponent of the likelihood ratio of answers against each other where much is to be explained: a power posterior.
#: Evidence of models that are only nearly true is too sure (Miller and Dunson, 2019).
POWER = 0.6
#: The exponent falls to it from one with this root of the probability of nothing: models leave a share of an effect.
FALLING = 20
#: Standard deviations below which a cause shows nothing, at the largest size that it can have.
INVISIBLE = 1.0
#: A nuisance or tolerance whose prior is wider than this many standard deviations of the readings counts as fitted.
FREE = 0.5

#: The classes of causes that act together, in order; none: nothing is wrong.
Key = tuple[str, ...]


@dataclass(frozen=True)
class Chance:
    """A probability and its Monte-Carlo error."""

    probability: float
    mc_error: float


@dataclass(frozen=True)
class Joint:
    """Hypotheses with the same causes but for members of a class, with and without a remainder.

    Args:
        key: their classes
        causes: ids of the most probable member; none: nothing is wrong, or `UNEXPLAINED` alone
        classes: for each of them the members of its class that fit, the most probable first
        chance: of all of them together
        best: the most probable one
    """

    key: Key
    causes: tuple[str, ...]
    classes: tuple[tuple[str, ...], ...]
    chance: Chance
    best: Hypothesis


@dataclass(frozen=True)
class Decision:
    """What the probabilities say.

    Args:
        verdict: in one word
        joints: most probable first
        answers: those that the verdict names
        marginal: cause -> its probability over all hypotheses; `UNEXPLAINED` alone or beside causes
        members: cause -> hypotheses that hold it, with their probabilities, most probable first
        leader: the hypothesis that stands for the answer: without a cause where the verdict is "consistent"
        p_any: share of campaigns without a fault whose odds against nothing are as large
        p_adequacy: of what the leader leaves; None where nothing is left free
    """

    verdict: Verdict
    joints: tuple[Joint, ...]
    answers: tuple[Joint, ...]
    marginal: Mapping[str, Chance]
    members: Mapping[str, tuple[Member, ...]]
    leader: Hypothesis
    p_any: float
    p_adequacy: float | None


def decide(found: Found) -> Decision:
    """The decision that a search leads to."""
    chances = _Chances(found)
    joints = _join(found, chances)
    wrong = [j for j in joints if j.causes]
    verdict: Verdict = "consistent"
    answers: list[Joint] = []
    if chances.nothing < 0.5 and wrong:
        acts = np.array([{*wrong[0].key} <= {*key} for key in answer_keys(found)])
        first = replace(wrong[0], chance=chances.of(acts))  # whether or not others act as well
        sure = first.chance.probability > SURE
        verdict = "unexplained" if first.causes == (UNEXPLAINED,) else "explained" if sure else "ambiguous"
        total = np.cumsum([j.chance.probability for j in wrong])
        answers = [first] if sure else wrong[: 1 + int(np.searchsorted(total, SURE * (1 - chances.nothing)))]
    leader = answers[0].best if answers else next(h for h in found.hypotheses if not h.causes and not h.extras)
    weighed = list(zip(found.hypotheses, found.probabilities.tolist(), strict=True))
    held = [(*h.causes, UNEXPLAINED) if beyond(h) else h.causes for h in found.hypotheses]
    holds = {cause: np.array([cause in own for own in held]) for cause in dict.fromkeys(chain(*held))}
    marginal = {cause: chances.of(mine) for cause, mine in holds.items()}
    members = {cause: tuple(compress(weighed, mine)) for cause, mine in holds.items()}
    adequacy = p_adequacy(found, leader)
    return Decision(verdict, tuple(joints), tuple(answers), marginal, members, leader, chances.p_any, adequacy)


def temper(found: Found) -> Found:
    """The search with the likelihood ratios of its answers to a power, the lower the more there is to be explained.

    What the prior says of answers, the probability that nothing is wrong, and the odds of hypotheses within one answer
    stay. Causes that these data cannot show whatever their size take no part.
    """
    hidden = invisible(found)
    found = replace(found, hypotheses=tuple(h for h in found.hypotheses if not hidden.intersection(h.causes)))
    logs = np.array([h.log_joint for h in found.hypotheses])
    logs -= np.logaddexp.reduce(logs)
    keys, tempered = answer_keys(found), logs.copy()
    wrong = np.array([bool(key) for key in keys])
    if not wrong.any():
        return found.weighed(logs)
    power = POWER + (1 - POWER) * np.exp(logs[~wrong]).sum() ** (1 / FALLING)
    for key in filter(None, dict.fromkeys(keys)):
        own = [k for k, other in enumerate(keys) if other == key]
        priors = {frozenset(h.causes): found.prior(h.causes) for h in (found.hypotheses[k] for k in own)}
        prior = np.logaddexp.reduce(list(priors.values())) + (np.log(OUTSIDE) if UNEXPLAINED in key else 0.0)
        tempered[own] += (1 - power) * (prior - np.logaddexp.reduce(logs[own]))
    tempered[wrong] += np.logaddexp.reduce(logs[wrong]) - np.logaddexp.reduce(tempered[wrong])
    return found.weighed(tempered)


def invisible(found: Found) -> set[str]:
    """Causes of which no form shows in these data at the largest size that it can have."""
    candidates = found.first.candidates
    low, high, _ = priors(candidates)
    far = np.maximum(-low, high) * np.linalg.norm(found.first.white, axis=0) >= INVISIBLE
    return {c.id for c in candidates} - {c.id for c, shows in zip(candidates, far, strict=True) if shows}


def answer_keys(found: Found) -> list[Key]:
    """The answer that each hypothesis is part of."""
    family = {f.cause.id: f.cause.family for f in found.formulas} | {UNEXPLAINED: UNEXPLAINED}
    return [tuple(sorted(family[c] for c in _named(h))) for h in found.hypotheses]


def _named(h: Hypothesis) -> tuple[str, ...]:
    """The causes that a hypothesis is named by; a remainder alone has the name of what the library lacks."""
    return h.causes or ((UNEXPLAINED,) if beyond(h) else ())


def beyond(h: Hypothesis) -> bool:
    """Whether a hypothesis holds a remainder that the library lacks."""
    return any(e.cause is None for e in h.extras)


class _Chances:
    """Probabilities with their Monte-Carlo errors, which come of the prior of nothing.

    The alarm's critical value is a quantile of draws, and with it the prior of nothing; the odds against nothing are
    compared with the same draws, so that they are an alarm if, and only if, nothing has less than one half.
    """

    def __init__(self, found: Found) -> None:
        self.p = np.asarray(found.probabilities)
        self.nothing = float(self.p[[not _named(h) for h in found.hypotheses]].sum())
        odds = np.log(max(1 - self.nothing, 1e-300)) - np.log(max(self.nothing, 1e-300)) + found.critical
        n = len(found.drawn)
        self.p_any, least = ((1 + int((found.drawn >= x).sum())) / (1 + n) for x in (odds, found.critical))
        if self.nothing >= 0.5:  # odds lack causes that promise nothing, which are not fitted: p of the first look
            self.p_any = max(min(self.p_any, found.p_any), least)
        else:  # the critical value lies between two draws
            self.p_any = min(self.p_any, least - 1 / (1 + n))
        share = float((found.drawn > found.critical).mean())
        spread = np.sqrt(max(share * (1 - share), 1 / n) / n)
        low, high = np.quantile(found.drawn, np.clip([1 - share - spread, 1 - share + spread], 0, 1))
        #: Standard error of the log odds of nothing.
        self.error = 0.5 * float(high - low)
        self.none = np.array([not h.causes for h in found.hypotheses])

    def of(self, mine: np.ndarray) -> Chance:
        """The probability of some hypotheses, a mask (n,)."""
        value = float(self.p[mine].sum())
        slope = (self.p * (mine - value))[self.none].sum()
        return Chance(min(value, 1.0), float(abs(slope) * self.error))


def _join(found: Found, chances: _Chances) -> list[Joint]:
    """Hypotheses added up, most probable first."""
    keys, joints = answer_keys(found), []
    for key in dict.fromkeys(keys):
        mine = np.array([k == key for k in keys])
        members = [(found.hypotheses[i], float(found.probabilities[i])) for i in np.flatnonzero(mine)]
        best = max(members, key=lambda m: m[1])[0]
        classes = tuple(_class(c, best, members, found) for c in _named(best))
        joints.append(Joint(key, _named(best), classes, chances.of(mine), best))
    return sorted(joints, key=lambda j: -j.chance.probability)


def _class(cause: str, best: Hypothesis, members: Sequence[Member], found: Found) -> tuple[str, ...]:
    """The members of a cause's class among some hypotheses, the cause first; none that acts beside it in the best."""
    family = {f.cause.id: f.cause.family for f in found.formulas}
    shares: dict[str, float] = {}
    for h, p in members:
        for c in h.causes:
            if family[c] == family.get(cause):
                shares[c] = shares.get(c, 0.0) + p
    least = MEMBER * sum(shares.values())
    others = sorted((c for c in shares if c not in best.causes and shares[c] > least), key=lambda c: -shares[c])
    return (cause, *others)


def p_adequacy(found: Found, h: Hypothesis, entries: np.ndarray | None = None) -> float | None:
    """Chi-square p of what a hypothesis leaves in some readings (k,), all if None; None where nothing is left free.

    Whatever its scatter leaves free takes a degree of freedom.
    """
    problem, fit, noise = found.problem, h.fit, h.fit.noise
    kept = np.setdiff1d(np.arange(problem.m) if entries is None else entries, problem.entries_aside)
    fixed = [t.columns for t in noise.terms if t.loose == 0 and t.columns is not None]
    V = noise.scaled([t for t in noise.terms if t.loose > 0 or t.columns is None])
    known = np.concatenate([fit.look.by_sd, *fixed], axis=1)
    r = problem.measured - fit.look.shown + fit.look.jacobian @ fit.look.x
    white = White.of(V[np.ix_(kept, kept)])
    Q, d, _ = np.linalg.svd(white(known[kept]), full_matrices=False)
    fitted = d > FREE
    e = white(r[kept])
    e = e - Q[:, fitted] @ (Q[:, fitted].T @ e)
    free = len(e) - int(fitted.sum())
    return float(chdtrc(free, e @ e)) if free > 0 else None
