"""From weighed hypotheses to answers: classes as one, marginal probabilities, one verdict that agrees with them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import logsumexp
from scipy.stats import chi2

from ..infer.evidence import White
from ..infer.found import Found, Hypothesis
from ..infer.prior import OUTSIDE
from .findings import UNEXPLAINED, Verdict

#: Probability from which one answer explains the data, and that several together reach.
SURE = 0.9
#: Bayes factor above which a further cause counts.
ASKED = 3.0
#: Probability of a member of a class that is named, as a share of its class.
MEMBER = 0.02
#: Exponent of the evidence of answers against each other. Evidence of models that are only nearly true is too sure
#: (Miller and Dunson, 2019); with this one 90 % sets hold the cause in nine of ten campaigns of known cause.
CALM = 0.6
#: A hypothesis and its probability; with the causes of it that count.
Member = tuple[Hypothesis, float]
_Seen = tuple[Hypothesis, tuple[str, ...], float]
#: A nuisance or tolerance whose prior is wider than this many standard deviations of the readings counts as fitted.
FREE = 0.5


@dataclass(frozen=True)
class Chance:
    """A probability and its Monte-Carlo error."""

    probability: float
    mc_error: float


@dataclass(frozen=True)
class Joint:
    """Hypotheses with the same causes but for members of a class, with and without a remainder.

    Args:
        causes: ids of the most probable member; none: nothing is wrong, or `UNEXPLAINED` alone
        classes: for each of them the members of its class that fit, the most probable first
        chance: of all of them together
        best: the most probable one
    """

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
        p_adequacy: of what the leader leaves
    """

    verdict: Verdict
    joints: tuple[Joint, ...]
    answers: tuple[Joint, ...]
    marginal: Mapping[str, Chance]
    members: Mapping[str, tuple[Member, ...]]
    leader: Hypothesis
    p_any: float
    p_adequacy: float


def decided(found: Found) -> Decision:
    """The decision that a search leads to."""
    chances = _Chances(found)
    asked = _asked(found)
    joints = _joints(found, asked, chances)
    wrong = [j for j in joints if j.causes]
    verdict: Verdict = "consistent"
    answers: list[Joint] = []
    if chances.nothing < 0.5 and wrong:
        sure = wrong[0].chance.probability > SURE
        verdict, answers = (
            ("explained", wrong[:1]) if sure else ("ambiguous", _needed(wrong, SURE * (1 - chances.nothing)))
        )
        verdict = "unexplained" if wrong[0].causes == (UNEXPLAINED,) else verdict
    leader = answers[0].best if answers else next(h for h in found.hypotheses if not h.causes and not h.extras)
    members: dict[str, list[Member]] = {}
    for h, p, causes in zip(found.hypotheses, found.probabilities, asked, strict=True):
        for cause in (*causes, UNEXPLAINED) if beyond(h) else causes:
            members.setdefault(cause, []).append((h, float(p)))
    holds = {c: np.array([any(h is m for m, _ in own) for h in found.hypotheses]) for c, own in members.items()}
    marginal = {c: chances.of(mine) for c, mine in holds.items()}
    whole = {c: tuple(own) for c, own in members.items()}
    adequacy = p_adequacy(found, leader)
    return Decision(verdict, tuple(joints), tuple(answers), marginal, whole, leader, chances.p_any, adequacy)


def calmed(found: Found) -> Found:
    """The search with the evidence of different answers drawn together; their priors and nothing's probability stay."""
    logs = np.array([h.log_joint for h in found.hypotheses])
    keys, levelled = _keys(found, _asked(found)), np.exp(logs - logsumexp(logs) + _lifts(found))
    whole: dict[tuple[str, ...], float] = {}
    for key, p in zip(keys, levelled, strict=True):
        whole[key] = whole.get(key, 0.0) + float(p)
    nothing, priors = whole.pop((), 0.0), _priors(found, keys)
    drawn = {key: priors[key] * (p / priors[key]) ** CALM for key, p in whole.items()}
    total = sum(drawn.values())
    share = {key: (1 - nothing) * drawn[key] / (total * p) for key, p in whole.items() if p > 0} | {(): 1.0}
    return replace(found, probabilities=np.array([share.get(k, 0.0) * p for k, p in zip(keys, levelled, strict=True)]))


def _priors(found: Found, keys: Sequence[tuple[str, ...]]) -> dict[tuple[str, ...], float]:
    """Prior odds of answers: of all sets of causes that each stands for."""
    sets: dict[tuple[str, ...], dict[tuple[str, ...], None]] = {}
    for key, h in zip(keys, found.hypotheses, strict=True):
        sets.setdefault(key, {})[tuple(sorted(h.causes))] = None
    odds = {}
    for key, own in sets.items():
        fewest = min(map(len, own))
        odds[key] = sum(float(np.exp(found.prior(causes))) for causes in own if len(causes) == fewest)
        odds[key] *= OUTSIDE if UNEXPLAINED in key else 1.0
    return odds


def _lifts(found: Found) -> np.ndarray:
    """What raises the log evidence of hypotheses that predict nearly what the likeliest does (n,).

    Where predictions are d standard deviations apart, readings speak for the true one by d**2 / 2 with a standard
    deviation of d. Evidence beyond that is due to widths of priors, which nobody knows so well.
    """
    top, lifts = found.hypotheses[0], np.zeros(len(found.hypotheses))
    if not top.causes or top.extras:
        return lifts
    white, evidence = White.of(top.fit.noise.covariance), top.log_joint - found.prior(top.causes)
    for k, h in enumerate(found.hypotheses):
        if not h.extras and len(h.causes) == len(top.causes):
            apart = float(np.linalg.norm(white(h.fit.look.shown - top.fit.look.shown)))
            behind = evidence - (h.log_joint - found.prior(h.causes))
            lifts[k] = max(behind - 0.5 * apart**2 - apart, 0.0)
    return lifts


def _keys(found: Found, asked: Sequence[tuple[str, ...]]) -> list[tuple[str, ...]]:
    """The answer that each hypothesis is part of: the classes of its causes that count."""
    family = {f.cause.id: f.cause.family for f in found.formulas} | {UNEXPLAINED: UNEXPLAINED}
    return [tuple(sorted(family[c] for c in _shown(h, own))) for h, own in zip(found.hypotheses, asked, strict=True)]


def _shown(h: Hypothesis, asked: tuple[str, ...]) -> tuple[str, ...]:
    """The causes that a hypothesis is shown with."""
    return asked or ((UNEXPLAINED,) if beyond(h) else ())


def beyond(h: Hypothesis) -> bool:
    """Whether a hypothesis holds a remainder that the library lacks."""
    return any(e.cause is None for e in h.extras)


class _Chances:
    """Probabilities with their Monte-Carlo errors: of the evidence of each fit, and of the prior of nothing.

    The alarm's critical value is a quantile of draws, and with it the prior of nothing; the odds against nothing are
    compared with the same draws, so that they are an alarm if, and only if, nothing has less than one half.
    """

    def __init__(self, found: Found) -> None:
        self.p = np.asarray(found.probabilities)
        self.pure = np.array([not h.causes and not beyond(h) for h in found.hypotheses])
        self.nothing = float(self.p[self.pure].sum())
        odds = np.log(max(1 - self.nothing, 1e-300)) - np.log(max(self.nothing, 1e-300)) + found.critical
        n = len(found.drawn)
        self.p_any = float((1 + (found.drawn >= odds).sum()) / (1 + n))
        share = float((found.drawn > found.critical).mean())
        spread = np.sqrt(max(share * (1 - share), 1 / n) / n)
        low, high = np.quantile(found.drawn, np.clip([1 - share - spread, 1 - share + spread], 0, 1))
        #: Sources of error: which hypotheses share one, and the standard error of their log evidence.
        self.sources = [(np.array([not h.causes for h in found.hypotheses]), 0.5 * float(high - low))]
        for look in {id(h.fit.look): h.fit.look for h in found.hypotheses}.values():
            own = np.array([h.fit.look is look for h in found.hypotheses])
            self.sources.append((own, found.hypotheses[int(np.argmax(own))].error))

    def of(self, mine: np.ndarray) -> Chance:
        """The probability of some hypotheses, a mask (n,)."""
        value = float(self.p[mine].sum())
        slope = self.p * (mine - value)
        error = np.sqrt(sum((slope[own].sum() * error) ** 2 for own, error in self.sources))
        return Chance(min(value, 1.0), float(error))


def _asked(found: Found) -> list[tuple[str, ...]]:
    """The causes of each hypothesis without those whose Bayes factor beside the others is below `ASKED`."""
    prior = found.prior
    logs: dict[frozenset[str], list[float]] = {}
    for h in found.hypotheses:
        logs.setdefault(frozenset(h.causes), []).append(h.log_joint - prior(h.causes))
    value = {key: float(logsumexp(own)) for key, own in logs.items()}

    def asked(causes: tuple[str, ...]) -> tuple[str, ...]:
        fewer = [left for c in causes if (left := tuple(o for o in causes if o != c)) and frozenset(left) in value]
        if not fewer:
            return causes
        best = max(fewer, key=lambda left: value[frozenset(left)])
        gained = value[frozenset(causes)] - value[frozenset(best)]
        return causes if gained > np.log(ASKED) else asked(best)

    return [asked(h.causes) for h in found.hypotheses]


def _joints(found: Found, asked: Sequence[tuple[str, ...]], chances: _Chances) -> list[Joint]:
    """Hypotheses added up, most probable first."""
    family = {f.cause.id: f.cause.family for f in found.formulas} | {UNEXPLAINED: UNEXPLAINED}
    shown = [_shown(h, causes) for h, causes in zip(found.hypotheses, asked, strict=True)]
    keys = _keys(found, asked)
    joints = []
    for key in dict.fromkeys(keys):
        mine = np.array([k == key for k in keys])
        members: list[_Seen] = [
            (found.hypotheses[i], shown[i], float(found.probabilities[i])) for i in np.flatnonzero(mine)
        ]
        whole = [m for m in members if set(m[0].causes) == set(m[1]) - {UNEXPLAINED}]
        best, causes, _ = max(whole or members, key=lambda m: m[2])
        classes = tuple(_class(c, members, family) for c in causes)
        joints.append(Joint(causes, classes, chances.of(mine), best))
    return sorted(joints, key=lambda j: -j.chance.probability)


def _class(cause: str, members: Sequence[_Seen], family: Mapping[str, str]) -> tuple[str, ...]:
    """The members of a cause's class among some hypotheses, the cause first."""
    shares: dict[str, float] = {}
    for _, causes, p in members:
        for c in causes:
            if family[c] == family[cause]:
                shares[c] = shares.get(c, 0.0) + p
    least = MEMBER * sum(shares.values())
    others = sorted((c for c in shares if c != cause and shares[c] > least), key=lambda c: -shares[c])
    return (cause, *others)


def _needed(joints: Sequence[Joint], wanted: float) -> list[Joint]:
    """The most probable ones that together reach a probability."""
    found, total = [], 0.0
    for joint in joints:
        found.append(joint)
        total += joint.chance.probability
        if total >= wanted:
            break
    return found


def p_adequacy(found: Found, h: Hypothesis, entries: np.ndarray | None = None) -> float:
    """Chi-square p of what a hypothesis leaves: whatever its scatter leaves free takes a degree of freedom.

    Args:
        found: the search
        h: one of its hypotheses, with its remainder
        entries: of which readings, all if None (k,)
    """
    problem, fit = found.problem, h.fit
    kept = np.ones(problem.m, dtype=bool)
    kept[[a.number for a in problem.aside if not a.sensor]] = False
    if entries is not None:
        kept &= np.isin(np.arange(problem.m), entries)
    fixed = [t for t in fit.noise.terms if t.loose == 0 and t.columns is not None]
    V = fit.noise.covariance - sum((t.matrix for t in fixed), np.zeros((problem.m, problem.m)))
    known = np.concatenate([fit.look.jacobian, *(t.columns for t in fixed if t.columns is not None)], axis=1)
    r = problem.measured - fit.look.shown + fit.look.jacobian @ fit.look.x
    white = White.of(V[np.ix_(kept, kept)])
    Q, d, _ = np.linalg.svd(white(known[kept]), full_matrices=False)
    fitted = d > FREE
    e = white(r[kept])
    e = e - Q[:, fitted] @ (Q[:, fitted].T @ e)
    return float(chi2.sf(e @ e, max(len(e) - int(fitted.sum()), 1)))
