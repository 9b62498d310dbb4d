"""From what a search found to the result as data: a picture a cause."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from ..campaign.table import Campaign
from ..infer.search import Found, Hypothesis
from . import channels
from .evidence import Picture
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
