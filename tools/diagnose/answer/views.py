"""What each channel says on its own: its readings given those of all the others, without a cause and with each.

The others carry the nuisances and tolerances they share with the channel: a torque is compared with what the measured
temperatures leave open, a thermometer with what torque and the other thermometers do.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.special import logsumexp
from scipy.stats import chi2

from ....model.core.faults import listed
from ....scenarios.measured.table import Sensor
from ..infer.evidence import White, log_bayes_factors
from ..infer.found import Found
from ..infer.screen import limits
from . import channels
from .evidence import View
from .numbers import array

#: Causes that a channel names at least this probable.
NAMED = 0.02


def views(found: Found) -> tuple[View, ...]:
    """Every compared channel with readings; none where there is but one."""
    problem, o, first = found.problem, found.problem.data, found.first
    whole, e = found.null.linear(problem)
    V, r = whole.L @ whole.L.T, whole.L @ e
    kinds = [i for i in range(len(o.read)) if (o.kind == i).any()]
    share = found.prior.share
    weights = first.weights + [share[c.id] for c in first.candidates]
    low, high = limits(first.candidates)
    ids = np.array([c.id for c in first.candidates])
    told = []
    for i in kinds if len(kinds) > 1 else ():
        mine = np.zeros(problem.m, dtype=bool)
        mine[problem.own] = o.kind == i
        given = White.of(V[np.ix_(~mine, ~mine)])
        tie = given(V[np.ix_(~mine, mine)])
        white = White.of(V[np.ix_(mine, mine)] - tie.T @ tie)
        deviation = r[mine] - tie.T @ given(r[~mine])
        effects = white(first.effects[mine] - tie.T @ given(first.effects[~mine]))
        left = white(deviation)
        logs = weights + log_bayes_factors(effects.T @ left, (effects**2).sum(axis=0), low, high)
        total = logsumexp([logsumexp(logs), found.critical])
        chances = {c: float(np.exp(logsumexp(logs[ids == c]) - total)) for c in dict.fromkeys(ids.tolist())}
        ranked = sorted((item for item in chances.items() if item[1] > NAMED), key=lambda item: -item[1])
        s, rows = o.read[i], o.row[o.kind == i]
        told.append(
            View(
                channel=s.name,
                asks=_asks(s, o.read),
                p=float(chi2.sf(left @ left, len(left))),
                nothing=float(np.exp(found.critical - total)),
                causes=tuple(View.Alone(id=id, probability=p) for id, p in ranked),
                unit=channels.unit_of_difference(s),
                order=array(o.campaign.order[o.campaign.test[rows]]),
                direction=array(o.campaign.direction[rows]),
                deviation=array(channels.difference(s, 1.0) * deviation),
            )
        )
    return tuple(told)


def _asks(sensor: Sensor, read: Sequence[Sensor]) -> str:
    """A channel and what it is compared with, in words."""
    others = [s for s in read if s is not sensor]
    warm = [s for s in others if s.kind.endswith("_temp")]
    if sensor.kind.endswith("_temp") and warm:
        rest = listed([channels.words(s) for s in others if s not in warm])
        return f"{channels.words(sensor)} against the other thermometers{f' and {rest}' if rest else ''}"
    return f"{channels.words(sensor)}, given {listed([channels.words(s) for s in others])}"
