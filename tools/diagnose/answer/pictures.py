"""What pictures are drawn from: the readings with what the model says of them, and a picture a cause."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from ....scenarios.measured.table import Campaign
from ..infer.found import Found, Hypothesis
from . import channels
from .evidence import Picture, Rows
from .numbers import array

#: What a cause may act on, where it is no column -> the kind of sensor that reads it.
ACTS_ON = {"w": "speed", "tau": "torque", "T": "oil_temp", "film": "speed"}


def rows(found: Found, h: Hypothesis) -> Rows:
    """The readings of the data: measured, calibrated without a cause, and with a hypothesis."""
    o, own = found.problem.data, found.problem.own
    c = o.campaign
    null, leader = (fit.look.shown[own] for fit in (found.null, h.fit))
    noise = h.fit.noise
    loose = zip(noise.scales, noise.loose, strict=True)  # scatter of readings and days, without tolerances
    spread = np.sqrt(np.sum([np.exp(2 * s) * np.diag(t.matrix) for s, t in loose], axis=0))[own]
    told = {}
    for i, s in enumerate(o.read):
        mine = o.kind == i
        if not mine.any():
            continue
        table = np.full((3, c.n), np.nan)
        table[:, o.row[mine]] = o.measured[mine], null[mine], leader[mine]
        measured, nominal, extended = (array(channels.in_unit(s, line)) for line in table)
        sd = channels.difference(s, float(np.median(spread[mine])))
        told[s.name] = Rows.Values(
            measured=measured, nominal=nominal, extended=extended if h.fit.look.acting else (), sd=sd
        )
    return Rows(
        row=tuple(range(1, c.n + 1)),
        test=tuple(int(t) + 1 for t in c.test),
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
        best = max((int(i) for i in ends), key=lambda i: float(np.mean((effect / sd)[o.kind == i] ** 2)))
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
