"""Hypotheses of more than two causes: grown one cause at a time from the leading ones."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace

import numpy as np
from scipy.special import logsumexp

from ...model.errors import SolveError
from .evidence import White, log_gauss
from .family import FORMS, Sample, families
from .hypothesis import Hypothesis
from .refine import Refiner
from .scatter import SCATTER, SIZES
from .search import Search
from .together import evidence_of, joint, joint_logs, only

#: Hypotheses that are grown, and candidates that are fitted, of each number of causes.
BEAM, FITTED = 2, 6


def grown(search: Search, most: int) -> list[Hypothesis]:
    """Hypotheses of three causes and more, up to `most`, while each is likelier than the best with one cause fewer."""
    found: list[Hypothesis] = []
    beam = [h for h in search.hypotheses if h.families][:BEAM]
    while beam and len(beam[0].causes) < most:
        best = max(h.log_posterior for h in beam)
        candidates = sorted((c for h in beam for c in beside(search, h)), key=lambda h: -h.log_posterior)
        new: dict[frozenset[str], Hypothesis] = {}
        for h in candidates:
            if frozenset(h.causes) in new or len(new) == FITTED:
                continue
            search.progress(f"looking at {', '.join(h.causes)}", 0.75)
            with suppress(SolveError):
                new[frozenset(h.causes)] = fitted_with_days(search, h)
        beam = sorted(new.values(), key=lambda h: -h.log_posterior)[:BEAM]
        if not beam or beam[0].log_posterior <= best:
            break
        found += new.values()
    return found


def beside(search: Search, h: Hypothesis) -> list[Hypothesis]:
    """A hypothesis with each other cause, looked at where it acts; the forms found are kept."""
    own = [f.cause for f in h.families]
    classes = {c.like or c.id for c in own}
    others = [c for c in search.causes if not c.scatter and (c.like or c.id) not in classes]
    linear = h.scattered()
    acting = search.problem.moved(linear, linear.z, h.theta, own)
    white = White.of(linear.residual, linear.covariance)
    at_mode = [only(f, h.theta[f.cause.id]).seen(white) for f in h.families]
    alone, found = joint(at_mode)[0], []
    for f in families(search.problem, acting, white, (Sample.of_prior(c, FORMS // 2) for c in others)).values():
        value, sizes = joint([*at_mode, f])
        k = int(np.argmax(joint_logs([*at_mode, f])))
        theta = {**h.theta, f.cause.id: f.theta(k, float(np.clip(sizes[-1], f.cause.size.low, f.cause.size.high)))}
        more = search.prior(len(h.causes) + 1) - search.prior(len(h.causes))
        causes = tuple(c for c in (*h.causes, f.cause.id) if c != SCATTER)
        days = (SCATTER,) if SCATTER in h.causes else ()
        parts = (*h.families, f)
        log = h.log_posterior + value - alone + more
        found.append(Hypothesis((*causes, *days), log, theta, parts, h.linear))
    return found


def fitted_with_days(search: Search, h: Hypothesis) -> Hypothesis:
    """A hypothesis fitted, with the scatter of its days as likely afterwards, none among them."""
    causes = tuple(c for c in h.causes if c != SCATTER)
    theta = {c: h.theta[c] for c in causes}
    size = h.theta[SCATTER]["sd"] if SCATTER in h.theta else 0.0
    null = search.null.with_days(size)
    there = Refiner(replace(search.problem, scattered=size), null, search.seed, search.prior)
    linear = h.scattered() if size else h.linear
    fit = there.refined(replace(h, causes=causes, theta=theta, linear=linear))
    assert fit.linear is not None
    bare = replace(fit, theta={**fit.theta, SCATTER: {"sd": size}}).scattered(sign=-1.0) if size else fit.linear

    def value(sd: float) -> float:
        white = White.of(bare.residual, bare.with_days(sd).covariance)
        return log_gauss(white) + evidence_of([f.seen(white) for f in fit.families])

    now, more = fit.log_posterior - value(size), search.prior(len(causes) + 1) - search.prior(len(causes))
    without, logs = now + value(0.0), [now + value(float(sd)) + more for sd in SIZES]
    if without > (together := float(logsumexp(logs) - np.log(len(SIZES)))):
        return replace(fit, log_posterior=without, linear=bare)
    theta = {**fit.theta, SCATTER: {"sd": float(SIZES[int(np.argmax(logs))])}}
    return replace(fit, causes=(*causes, SCATTER), log_posterior=together, theta=theta, linear=bare)
