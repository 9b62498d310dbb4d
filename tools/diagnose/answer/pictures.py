"""What pictures are drawn from: readings with what the model says of them, a picture a cause, each channel alone."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np
from scipy.special import chdtrc

from ....model.core.faults import name_all
from ....scenarios.measured.table import Campaign, Sensor
from ..infer.evidence import White, log_bayes_factors
from ..infer.found import Found, Hypothesis
from ..infer.problem import priors
from . import channels
from .estimate import loose_variance
from .evidence import Picture, Rows, View
from .numbers import array

#: Causes that a channel names at least this probable.
NAMED = 0.02


def rows(found: Found, h: Hypothesis) -> Rows:
    """The readings of the data: measured, calibrated without a cause, and with a hypothesis."""
    o, own = found.problem.data, found.problem.own
    c = o.campaign
    null, leader = (fit.look.shown[own] for fit in (found.null, h.fit))
    spread = np.sqrt(loose_variance(h.fit))[own]
    told = {}
    for i, s, mine in channels.compared(o):
        lines = o.over_rows(i, o.measured, null, leader)
        measured, nominal, extended = (array(channels.in_unit(s, line)) for line in lines)
        sd = channels.difference(s, float(np.median(spread[mine])))
        told[s.name] = Rows.Values(
            measured=measured, nominal=nominal, extended=extended if h.fit.look.acting else (), sd=sd
        )
    return Rows(
        row=tuple(int(line) - 1 for line in c.lines),
        test=tuple(c.numbers[t] for t in c.test),
        direction=tuple(int(d) for d in c.direction),
        channels=told,
        quantities=quantities(c, o.sensors),
    )


def quantities(campaign: Campaign, sensors: Mapping[str, np.ndarray]) -> dict[str, Rows.Quantity]:
    """What readings are drawn against: the given sensors, the rise of the oil over the room, the running order."""
    oil, room = (next((s for s in campaign.sensors if s.kind == kind), None) for kind in ("oil_temp", "ambient"))
    told = {}
    for s in (*campaign.given, *([oil] if oil else ())):
        values = array(channels.in_unit(s, sensors[s.name]))
        told[s.name] = Rows.Quantity(label=channels.words(s), unit=channels.unit(s), values=values)
    if oil and room:
        rise = sensors[oil.name] - sensors[room.name]
        told["rise"] = Rows.Quantity(label="oil over room", unit="K", values=array(rise))
    told["order"] = Rows.Quantity(label="running order", values=array(campaign.order[campaign.test]))
    if len(set(campaign.direction)) > 1:
        told["direction"] = Rows.Quantity(label="direction", values=array(campaign.direction))
    return told


def pictures(found: Found, h: Hypothesis, quantities: Collection[str]) -> tuple[Picture, ...]:
    """For each cause of a hypothesis what is left without and with it, in the channel that shows it best.

    It is drawn against what the cause acts on; against the running order where this is none of the quantities.
    """
    problem, fit, o = found.problem, h.fit, found.problem.data
    own = np.arange(problem.m) < o.m  # a reference tells what the rig errs by in both
    V, left = _given_others(fit.noise.covariance, problem.measured - fit.look.shown, own)
    sd, made = np.sqrt(np.diag(V)), []
    for acting in fit.look.acting:
        others = [a for a in fit.look.acting if a is not acting]
        effect = (fit.look.shown - problem.shown(fit.look, others))[own]
        shares = (effect / sd) ** 2
        best, sensor, _ = max(channels.compared(o), key=lambda one: float(np.mean(shares[one[2]])))
        lines = o.over_rows(best, left + effect, left)
        before, after = (array(channels.difference(sensor, 1.0) * line) for line in lines)
        acts_on = acting.formula.cause.acts_on
        against = acts_on if acts_on in quantities else "order"
        made.append(Picture(cause=acting.id, channel=sensor.name, quantity=against, before=before, after=after))
    return tuple(made)


def views(found: Found) -> tuple[View, ...]:
    """What each channel says on its own: its readings given those of all the others, without a cause and with each.

    The others carry the nuisances and tolerances they share with the channel: a torque is compared with what the
    measured temperatures leave open, a thermometer with what torque and the other thermometers do. Empty where only
    one channel has readings.
    """
    problem, o, first = found.problem, found.problem.data, found.first
    whole, e = found.null.linear(problem)
    V, all_of_them = whole.L @ whole.L.T, np.column_stack([whole.L @ e, first.effects])
    compared = channels.compared(o)
    weights, prior = first.weights(found.prior), priors(first.candidates)
    ids = np.array([c.id for c in first.candidates])
    told = []
    for _, s, ends in compared if len(compared) > 1 else ():
        mine = np.append(ends, np.zeros(problem.m - o.m, dtype=bool))
        own, deviations = _given_others(V, all_of_them, mine)
        deviation, white = deviations[:, 0], White.of(own)(deviations)
        left, effects = white[:, 0], white[:, 1:]
        logs = weights + log_bayes_factors(effects.T @ left, (effects**2).sum(axis=0), *prior)
        total = np.logaddexp.reduce([np.logaddexp.reduce(logs), found.critical])
        chances = {c: float(np.exp(np.logaddexp.reduce(logs[ids == c]) - total)) for c in dict.fromkeys(ids.tolist())}
        ranked = sorted((item for item in chances.items() if item[1] > NAMED), key=lambda item: -item[1])
        rows = o.row[ends]
        told.append(
            View(
                channel=s.name,
                asks=_asks(s, o.read),
                p=float(chdtrc(len(left), left @ left)),
                nothing=float(np.exp(found.critical - total)),
                causes=tuple(View.Alone(id=id, probability=p) for id, p in ranked),
                unit=channels.unit_of_difference(s),
                order=array(o.campaign.order[o.campaign.test[rows]]),
                direction=array(o.campaign.direction[rows]),
                deviation=array(channels.difference(s, 1.0) * deviation),
            )
        )
    return tuple(told)


def _given_others(V: np.ndarray, e: np.ndarray, mine: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of some readings (M,) given all others: their covariance, and errors (M,) or (M, k) less what the others tell."""
    told = np.linalg.solve(V[np.ix_(~mine, ~mine)], V[np.ix_(~mine, mine)]).T
    return V[np.ix_(mine, mine)] - told @ V[np.ix_(~mine, mine)], e[mine] - told @ e[~mine]


def _asks(sensor: Sensor, read: Sequence[Sensor]) -> str:
    """A channel and what it is compared with, in words."""
    others = [s for s in read if s is not sensor]
    warm = [s for s in others if s.kind.endswith("_temp")]
    if sensor.kind.endswith("_temp") and warm:
        rest = name_all([channels.words(s) for s in others if s not in warm])
        return f"{channels.words(sensor)} against the other thermometers{f' and {rest}' if rest else ''}"
    return f"{channels.words(sensor)}, given {name_all([channels.words(s) for s in others])}"
