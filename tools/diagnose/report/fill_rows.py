"""The readings of a search, as findings: channels, rows for pictures, a picture a cause, mean effects."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Literal

import numpy as np

from ..campaign.table import Campaign, Sensor
from ..infer.fit import Fit
from ..infer.problem import Acting, Problem
from ..model.observe import Observed
from .evidence import Picture, Rows
from .fill_causes import HALF, posterior
from .findings import Channel, Impact
from .numbers import array
from .shown import WHAT, Scale, key_of, of_sensor

#: What a cause may act on -> the kind of the first given sensor, or of any, that reads it.
ACTS_ON = {"w": "speed", "tau": "torque", "T": "oil_temp", "film": "speed"}


def channels(campaign: Campaign) -> tuple[Channel, ...]:
    """The sensors."""
    return tuple(_channel(s, of_sensor(s)) for s in campaign.sensors)


def _channel(s: Sensor, scale: Scale) -> Channel:
    repeat, offset = scale.factor * s.repeat_sd, scale.factor * s.offset_sd
    role: Literal["given", "read"] = "given" if s.role == "given" else "read"
    return Channel(
        name=s.name, column=s.column, kind=s.kind, role=role, unit=scale.unit, repeat_sd=repeat, offset_sd=offset
    )


def by_row(o: Observed, values: np.ndarray, sensor: int) -> np.ndarray:
    """Values of the m entries of one compared sensor, by row (n,), NaN where there is none."""
    found = np.full(o.campaign.n, np.nan)
    mine = o.kind == sensor
    found[o.row[mine]] = values[mine]
    return found


def rows(problem: Problem, null: Fit, best: Fit) -> Rows:
    """Measured, calibrated without a cause, and with those of the best hypothesis.

    Args:
        problem: data and model
        null: without a cause
        best: the most probable hypothesis
    """
    o, c, own = problem.data, problem.data.campaign, problem.own
    total = np.sqrt(np.diag(best.noise.covariance)[own])
    values = {}
    for i, sensor in enumerate(o.read):
        scale = of_sensor(sensor)
        measured, nominal, extended = (
            array(scale(by_row(o, v, i))) for v in (o.measured, null.look.shown[own], best.look.shown[own])
        )
        sd = scale.factor * float(np.median(total[o.kind == i])) if (o.kind == i).any() else None
        shown = extended if best.look.acting else ()
        values[sensor.name] = Rows.Values(measured=measured, nominal=nominal, extended=shown, sd=sd)
    return Rows(
        row=tuple(range(1, c.n + 1)),
        test=tuple(int(k) + 1 for k in c.test),
        direction=tuple(int(d) for d in c.direction),
        channels=values,
        quantities=quantities(c),
    )


def quantities(c: Campaign) -> dict[str, Rows.Quantity]:
    """What readings may be drawn against: given sensors, the rise over the room, order, direction."""
    found = {}
    for s in c.given:
        scale = of_sensor(s)
        found[s.name] = Rows.Quantity(
            label=f"{WHAT[s.kind]} {s.name}", unit=scale.unit, values=array(scale(c.values[s.name]))
        )
    oil, room = (next((s for s in c.sensors if s.kind == kind), None) for kind in ("oil_temp", "ambient"))
    if oil is not None:
        found[oil.name] = Rows.Quantity(
            label=f"{WHAT[oil.kind]} {oil.name}", unit="degC", values=array(of_sensor(oil)(c.values[oil.name]))
        )
        if room is not None:
            rise = array(c.values[oil.name] - c.values[room.name])
            found["rise"] = Rows.Quantity(label="oil over room", unit="K", values=rise)
    found["order"] = Rows.Quantity(label="running order", values=array(c.order[c.test]))
    if len(set(c.direction)) > 1:
        found["direction"] = Rows.Quantity(label="direction", values=array(c.direction))
    return found


def quantity_of(acts_on: str, c: Campaign) -> str:
    """Key of the quantity that a cause acts on; the running order where it is not measured."""
    known = quantities(c)
    if acts_on in known:
        return acts_on
    kind = ACTS_ON.get(acts_on, "")
    ranked = sorted((s for s in c.sensors if s.kind == kind), key=lambda s: s.role != "given")
    return next((s.name for s in ranked if s.name in known), "order")


def pictures(problem: Problem, fit: Fit) -> tuple[Picture, ...]:
    """For each cause of a hypothesis what is left without and with it, in the channel that shows it best."""
    o, own = problem.data, problem.own
    sd = np.sqrt(np.diag(fit.noise.covariance)[own])
    made = []
    for acting, effect in effects(problem, fit):
        shares = {i: float(np.sqrt(np.mean((effect / sd)[o.kind == i] ** 2))) for i in set(o.kind.tolist())}
        i = max(shares, key=lambda k: shares[k])
        scale = of_sensor(o.read[i]).difference
        after = o.measured - fit.look.shown[own]
        before, left = (array(scale(by_row(o, v, i))) for v in (after + effect, after))
        quantity = quantity_of(acting.formula.cause.acts_on, o.campaign)
        made.append(Picture(cause=acting.id, channel=o.read[i].name, quantity=quantity, before=before, after=left))
    return tuple(made)


def effects(problem: Problem, fit: Fit) -> list[tuple[Acting, np.ndarray]]:
    """Each cause of a hypothesis, and what it adds to the readings beside the others (m,)."""
    acting = fit.look.acting
    shown = [problem.shown(fit.look.z, [b for b in acting if b is not a])[problem.own] for a in acting]
    return [(a, fit.look.shown[problem.own] - s) for a, s in zip(acting, shown, strict=True)]


def impact(problem: Problem, fit: Fit, only: Sequence[Acting] = ()) -> dict[str, Impact]:
    """Mean change of each channel that a hypothesis, or some of its causes, make; intervals by those of the sizes.

    Args:
        problem: data and model
        fit: the hypothesis
        only: some of its causes; all if empty
    """
    o, chosen = problem.data, list(only) or list(fit.look.acting)
    if not chosen:
        return {}
    without = problem.shown(fit.look.z, [a for a in fit.look.acting if a not in chosen])[problem.own]
    effect = fit.look.shown[problem.own] - without
    places = _places(problem, fit, chosen)
    mean = np.array([(o.kind == i) / max((o.kind == i).sum(), 1) for i in range(len(o.read))])
    slopes = mean @ fit.look.jacobian[problem.own][:, places]
    sd = np.sqrt(np.einsum("ij,jk,ik->i", slopes, posterior(problem, fit)[np.ix_(places, places)], slopes))
    found = {}
    for i, sensor in enumerate(o.read):
        scale = of_sensor(sensor).difference
        value, half = scale.factor * float(mean[i] @ effect), scale.factor * HALF * float(sd[i])
        ci95 = (value - half, value + half)
        found[key_of(sensor)] = Impact(
            value=value, ci95=ci95, unit=scale.unit, what=f"{WHAT[sensor.kind]} {sensor.name}"
        )
    return found


def _places(problem: Problem, fit: Fit, chosen: Iterable[Acting]) -> list[int]:
    """Places of the parameters of some causes in the vector."""
    ids, begin = {a.id for a in chosen}, problem.nz
    found: list[int] = []
    for a in fit.look.acting:
        if a.id in ids:
            found += range(begin, begin + a.formula.size)
        begin += a.formula.size
    return found
