"""What a search found of causes, as findings: sizes with intervals, regimes, marginal probabilities, remainder."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Literal

import numpy as np

from ..infer.evidence import WIDTHS
from ..infer.fit import Fit, bounds
from ..infer.problem import Acting, Problem
from ..infer.search import Found
from ..infer.search import Hypothesis as Fitted
from ..library.cause import Cause as Entry
from ..library.cause import Form, Shape, Size
from .estimate import Estimate
from .findings import UNEXPLAINED, Cause, FormShare, Hypothesis, Remainder, RemainderChannel
from .shown import of_parameter, of_sensor

#: Half an interval in standard deviations; how near to a bound, in prior half widths, a size sits on it.
HALF, NEAR = 1.96, 0.02


def posterior(problem: Problem, fit: Fit) -> np.ndarray:
    """Covariance of the vector of a fit, nuisances first, then the parameters of each cause (d, d)."""
    sizes = [np.r_[WIDTHS[-1] ** 2, np.ones(a.formula.size - 1)] for a in fit.look.acting]
    prior = np.concatenate([np.ones(problem.nz), *sizes])
    white, _ = fit.linear(problem)
    told = white(fit.look.jacobian * prior)
    return np.asarray(np.diag(prior) - told.T @ told)


def estimates(acting: Acting, covariance: np.ndarray) -> tuple[Estimate, ...]:
    """Size and shapes of a fitted cause with 95 % intervals, the size first.

    Args:
        acting: the cause as fitted
        covariance: of its parameters (k, k)
    """
    formula, t = acting.formula, acting.t
    sd, (low, high) = np.sqrt(np.maximum(np.diag(covariance), 0.0)), bounds(acting)
    size, shapes = formula.cause.size, formula.form.shapes
    found = []
    quantities: tuple[Size | Shape, ...] = (size, *shapes)
    for k, (name, unit, doc) in enumerate((q.name, q.unit, q.doc) for q in quantities):
        ends = (np.clip(t[k] + s * HALF * sd[k], low[k], high[k]) for s in (-1, 1))
        values = [formula.theta(np.r_[t[:k], v, t[k + 1 :]])[name] for v in (t[k], *ends)]
        scale = of_parameter(unit, shapes[k - 1].high if k else 0.0)
        value, one, other = scale(np.array(values)).tolist()
        bound: Literal["", "low", "high"] = "low" if low[k] < 0 and t[k] - low[k] < NEAR else ""
        bound = "high" if high[k] - t[k] < NEAR else bound
        ci95 = (min(one, other), max(one, other))
        found.append(Estimate(name=name, value=value, ci95=ci95, unit=scale.unit, doc=doc, at_bound=bound))
    return tuple(found)


def regime(form: Form, found: Iterable[Estimate]) -> dict[str, tuple[float | None, float | None]]:
    """Where a form acts: quantity with unit -> above, below.

    Args:
        form: the form
        found: its parameters
    """
    threshold = next((e for e in found if e.name == form.regime.get("shape")), None)
    if threshold is None:
        return {}
    quantity, _, side = form.regime["quantity"].rpartition(" ")
    key = f"{quantity} [{threshold.unit.replace('degC', '°C')}]"
    return {key: (threshold.value, None) if side == "above" else (None, threshold.value)}


def hypotheses(found: Found) -> tuple[Hypothesis, ...]:
    """All that were weighed, those of the same causes together; a remainder is a cause of its own."""
    total: dict[tuple[str, ...], float] = {}
    for h, p in zip(found.hypotheses, found.probabilities, strict=True):
        key = (*h.causes, UNEXPLAINED) if _outside(h) else h.causes
        total[key] = total.get(key, 0.0) + float(p)
    ranked = sorted(total.items(), key=lambda item: -item[1])
    return tuple(Hypothesis(causes=causes, probability=p) for causes, p in ranked)


def causes(found: Found, detectable: Mapping[str, float]) -> tuple[Cause, ...]:
    """All causes by their marginal probability.

    Args:
        found: the search
        detectable: cause -> smallest size that would be found, in its SI unit; left out where none is
    """
    entries: dict[str, Entry] = {f.cause.id: f.cause for f in found.formulas}
    weighed = list(zip(found.hypotheses, found.probabilities, strict=True))
    made = []
    for id, entry in entries.items():
        own = [(h, float(p)) for h, p in weighed if id in h.causes]
        best = next((h for h, _ in own if id in h.fit.causes), None)
        fitted = {} if best is None else _fitted(found.problem, best, id)
        scale = of_parameter(entry.size.unit, 0.0)
        smallest = detectable.get(id)
        made.append(
            Cause(
                id=id,
                probability=sum(p for _, p in own),
                detectable=None if smallest is None else scale.factor * smallest,
                usual=scale.factor * entry.size.sd,
                unit=scale.unit,
                meaning=entry.size.doc,
                doc=entry.doc,
                exposes=entry.exposes,
                like=entry.like,
            ).model_copy(update=fitted)
        )
    return tuple(sorted(made, key=lambda c: -c.probability))


def _fitted(problem: Problem, hypothesis: Fitted, id: str) -> dict[str, Any]:
    """Parameters, regime and forms of a cause in the most probable hypothesis that has it."""
    covariance, begin = posterior(problem, hypothesis.fit), problem.nz
    for acting in hypothesis.fit.look.acting:
        block = slice(begin, begin + acting.formula.size)
        begin = block.stop
        if acting.id == id:
            parameters = estimates(acting, covariance[block, block])
            logs = hypothesis.forms.get(id, {acting.formula.form.name: 0.0})
            ranked = sorted(logs.items(), key=lambda item: -item[1])
            shares = tuple(FormShare(name=name, share=float(np.exp(log))) for name, log in ranked)
            where = regime(acting.formula.form, parameters)
            return {"parameters": parameters, "regime": where, "forms": tuple(s for s in shares if s.share > 0.005)}
    return {}


def remainder(found: Found) -> Remainder | None:
    """That something acts which the library lacks, and in which channels; None where nothing speaks for it."""
    own = [(h, float(p)) for h, p in zip(found.hypotheses, found.probabilities, strict=True) if _outside(h)]
    if not own:
        return None
    extra, data = own[0][0].extra, found.problem.data
    assert extra is not None
    variance = np.diag(extra.covariance)[found.problem.own]
    channels = []
    for i, sensor in enumerate(data.read):
        if sensor.name in extra.channels and (data.kind == i).any():
            scale = of_sensor(sensor).difference
            rms = scale.factor * float(np.sqrt(variance[data.kind == i].mean()))
            channels.append(RemainderChannel(channel=sensor.name, rms=rms, unit=scale.unit))
    return Remainder(probability=sum(p for _, p in own), channels=tuple(channels))


def _outside(hypothesis: Fitted) -> bool:
    """Whether it has a remainder."""
    return hypothesis.extra is not None and hypothesis.extra.cause is None
