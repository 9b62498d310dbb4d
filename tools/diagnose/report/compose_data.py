"""From what a search found to the result as data: quality of the data, readings for pictures."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ....scenarios.measured.table import Campaign
from ..answer import quality as answer
from ..infer.found import Found, Hypothesis
from ..setting import Setting
from . import channels, quality
from .compose_points import repeated
from .evidence import Rows
from .numbers import array


def data_quality(setting: Setting, found: Found, h: Hypothesis) -> quality.DataQuality:
    """Gross readings, values far off, scatter against the card, by a hypothesis."""
    return quality.DataQuality(
        gross=tuple(_gross(found, g) for g in answer.gross_readings(found, h)),
        nuisances=tuple(_off(setting, o) for o in answer.values_off(found, h)),
        variance=tuple(_scatter(setting, s) for s in answer.scatters(found, h)),
        repeated=repeated(found.problem.data.campaign),
        adequacy=answer.adequacy(found, h),
    )


def _gross(found: Found, g: answer.Gross) -> quality.GrossReading:
    campaign = found.problem.campaigns[g.campaign].campaign
    s = campaign.sensor(g.sensor)
    shown, expected = (None if v is None else float(channels.in_unit(s, np.array(v))) for v in (g.shown, g.expected))
    where = "" if g.campaign == 0 else f" of {campaign.name}"
    return quality.GrossReading(
        row=int(campaign.lines[g.row]) - 1,
        line=int(campaign.lines[g.row]),
        point=f"{int(campaign.points[g.row])}{where}",
        channel=g.sensor,
        size_sd=g.size_sd,
        shown=shown,
        expected=expected,
        unit=channels.unit(s),
    )


def _off(setting: Setting, off: answer.Off) -> quality.NuisanceOff:
    plant = setting.plant
    values = [(path, factor) for path, factor in off.factors.items() if path in plant.place]
    if len(values) != 1:
        factor = values[0][1] if values else None
        return quality.NuisanceOff(name=off.name, z=off.z, factor=factor, paths=tuple(off.factors))
    path, factor = values[0]
    file = float(plant.p[plant.place[path]])
    unit = plant.flat.parameters[plant.place[path]].unit
    return quality.NuisanceOff(
        name=off.name, z=off.z, factor=factor, file=file, found=file * factor, unit=unit, paths=(path,)
    )


def _scatter(setting: Setting, s: answer.Scatter) -> quality.VarianceComponent:
    sensors = {f"readings of {x.name}": x for x in setting.problem.data.campaign.sensors}
    card, unit, name = setting.card.day_cooling_sd, "1", ""
    if s.name in sensors:
        x = sensors[s.name]
        card, unit, name = channels.difference(x, x.repeat_sd), channels.unit_of_difference(x), x.name
    low, high = (card * v for v in s.ci95)
    return quality.VarianceComponent(
        name=s.name, channel=name, unit=unit, card=card, found=card * s.ratio, ratio=s.ratio, ci95=(low, high)
    )


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
        quantities=quantities(c, {s.name: o.sensors[s.name] for s in c.sensors}),
    )


def quantities(campaign: Campaign, sensors: Mapping[str, np.ndarray]) -> dict[str, Rows.Quantity]:
    """What readings are drawn against: the given sensors, the rise of the oil over the room, the running order."""
    told = {}
    for s in campaign.given:
        values = channels.in_unit(s, sensors[s.name])
        told[s.name] = Rows.Quantity(label=channels.words(s), unit=channels.unit(s), values=array(values))
    oil = next((s for s in campaign.sensors if s.kind == "oil_temp"), None)
    room = next((s for s in campaign.sensors if s.kind == "ambient"), None)
    if oil:
        warm = array(channels.in_unit(oil, sensors[oil.name]))
        told[oil.name] = Rows.Quantity(label=channels.words(oil), unit=channels.unit(oil), values=warm)
    if oil and room:
        rise = sensors[oil.name] - sensors[room.name]
        told["rise"] = Rows.Quantity(label="oil over room", unit="K", values=array(rise))
    told["order"] = Rows.Quantity(label="running order", values=array(campaign.order[campaign.test]))
    if len(set(campaign.direction)) > 1:
        told["direction"] = Rows.Quantity(label="direction", values=array(campaign.direction))
    return told
