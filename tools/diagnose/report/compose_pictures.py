"""From what a search found to the result as data: a picture a cause, and each channel on its own."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from ....scenarios.measured.table import Campaign, Sensor
from ..answer import views as answer
from ..infer.found import Found, Hypothesis
from . import channels
from .evidence import Picture, View
from .names import listed
from .numbers import array

#: What a cause may act on, where it is no column -> the kind of sensor that reads it.
ACTS_ON = {"w": "speed", "tau": "torque", "T": "oil_temp", "film": "speed"}


def pictures(found: Found, h: Hypothesis, quantities: Collection[str]) -> tuple[Picture, ...]:
    """For each cause of a hypothesis what is left without and with it, in the channel that shows it best.

    Args:
        found: the search
        h: the hypothesis
        quantities: what readings can be drawn against
    """
    problem, fit, o = found.problem, h.fit, found.problem.data
    sd = np.sqrt(np.diag(fit.noise.covariance))[problem.own]
    left = (problem.measured - fit.look.shown)[problem.own]
    made = []
    for acting in fit.look.acting:
        others = [a for a in fit.look.acting if a is not acting]
        effect = (fit.look.shown - problem.shown(fit.look.z, others))[problem.own]
        ends = np.unique(o.kind[o.kind < len(o.read)])
        shares = {int(i): float(np.sqrt(np.mean((effect / sd)[o.kind == i] ** 2))) for i in ends}
        best = max(shares, key=lambda i: shares[i])
        mine, sensor = o.kind == best, o.read[best]
        table = np.full((2, o.campaign.n), np.nan)
        table[:, o.row[mine]] = left[mine] + effect[mine], left[mine]
        before, after = (array(channels.difference(sensor, 1.0) * line) for line in table)
        drawn = quantity(acting.formula.cause.acts_on, o.campaign, quantities)
        made.append(Picture(cause=acting.id, channel=sensor.name, quantity=drawn, before=before, after=after))
    return tuple(made)


def quantity(acts_on: str, campaign: Campaign, known: Collection[str]) -> str:
    """Key of the quantity that a cause acts on; the running order where it is not measured.

    Args:
        acts_on: as the cause has it
        campaign: the data
        known: what readings can be drawn against
    """
    if acts_on in known:
        return acts_on
    kind = ACTS_ON.get(acts_on, "")
    ranked = sorted((s for s in campaign.sensors if s.kind == kind), key=lambda s: s.role != "given")
    return next((s.name for s in ranked if s.name in known), "order")


def views(found: Found) -> tuple[View, ...]:
    """What each channel says on its own."""
    campaign = found.problem.data.campaign
    return tuple(
        View(
            channel=v.sensor.name,
            asks=_asks(v.sensor, campaign.read),
            p=v.p,
            nothing=v.nothing,
            causes=tuple(View.Alone(id=id, probability=p) for id, p in v.causes.items()),
            unit=channels.unit_of_difference(v.sensor),
            order=array(campaign.order[campaign.test[v.rows]]),
            direction=array(campaign.direction[v.rows]),
            deviation=array(channels.difference(v.sensor, 1.0) * v.deviation),
        )
        for v in answer.views(found)
    )


def _asks(sensor: Sensor, read: Sequence[Sensor]) -> str:
    """A channel and what it is compared with, in words."""
    others = [s for s in read if s is not sensor]
    warm = [s for s in others if s.kind.endswith("_temp")]
    if sensor.kind.endswith("_temp") and warm:
        rest = listed(channels.words(s) for s in others if s not in warm)
        return f"{channels.words(sensor)} against the other thermometers{f' and {rest}' if rest else ''}"
    return f"{channels.words(sensor)}, given {listed(channels.words(s) for s in others)}"
