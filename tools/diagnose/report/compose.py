"""From what was found to the result as data: units that people read, causes, data quality, readings for pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..answer import estimate, quality
from ..answer.decide import UNEXPLAINED, Chance, Decision, Joint
from ..campaign.table import Campaign, Sensor
from ..infer.search import Found, Hypothesis
from ..setting import Setting
from . import findings as data

#: SI unit -> the unit of a result, and by how much its numbers are larger.
UNITS = {"K": ("degC", 1.0), "rad/s": ("rpm", 30 / np.pi), "N.m": ("N.m", 1.0), "W": ("W", 1.0)}
#: Kind of a sensor -> SI unit, and what it measures in words.
KINDS = {
    "oil_temp": ("K", "oil temperature"),
    "wall_temp": ("K", "body temperature"),
    "ambient": ("K", "room temperature"),
    "torque": ("N.m", "torque"),
    "speed": ("rad/s", "speed"),
    "power": ("W", "power"),
}
#: Endings of names that only say the unit, and of impacts.
ENDINGS = {"degC": ("_C", "_K"), "N.m": ("_Nm", "_Nm"), "W": ("_W", "_W"), "rpm": ("_rpm", "_rpm")}
#: Hypotheses that are listed, and the least probability of one.
MOST, LISTED = 12, 0.005


def si(sensor: Sensor) -> str:
    """SI unit of what a sensor reads."""
    return KINDS[sensor.kind][0]


def in_unit(sensor: Sensor, values: np.ndarray) -> np.ndarray:
    """Readings [SI] in the unit of the result."""
    return np.asarray(values - 273.15 if si(sensor) == "K" else values * UNITS[si(sensor)][1])


def difference(sensor: Sensor, value: float) -> float:
    """A difference of readings [SI] in the unit of the result."""
    return value * UNITS[si(sensor)][1]


def channel(sensor: Sensor) -> data.Channel:
    """A sensor with its accuracies."""
    repeat, offset = difference(sensor, sensor.repeat_sd), difference(sensor, sensor.offset_sd)
    role = "given" if sensor.role == "given" else "read"
    return data.Channel(
        name=sensor.name,
        column=sensor.column,
        kind=sensor.kind,
        role=role,
        unit=UNITS[si(sensor)][0],
        repeat_sd=repeat,
        offset_sd=offset,
    )


def about(setting: Setting, reference: Campaign | None, seed: int) -> data.About:
    """What was diagnosed."""
    own = setting.problem.data.campaign
    return data.About(
        data=own.name,
        rig=setting.scenario.name,
        readings=own.n,
        tests=own.n_tests,
        reference=reference.name if reference else "",
        reference_readings=reference.n if reference else 0,
        seed=seed,
    )


def test(found: Found, decision: Decision, alpha: float) -> data.Alarm:
    """The alarm and what is left."""
    return data.Alarm(
        alpha=alpha,
        p_any=decision.p_any,
        p_omnibus=found.p_omnibus,
        p_adequacy=decision.p_adequacy,
        draws=len(found.drawn),
    )


def hypotheses(decision: Decision) -> tuple[data.Hypothesis, ...]:
    """The most probable ones, nothing always among them."""
    listed = [j for k, j in enumerate(decision.joints) if not j.causes or (k < MOST and j.chance.probability > LISTED)]
    return tuple(
        data.Hypothesis(causes=j.causes, probability=j.chance.probability, mc_error=j.chance.mc_error) for j in listed
    )


def answers(joints: Sequence[Joint]) -> tuple[data.Answer, ...]:
    """What the verdict names."""
    return tuple(
        data.Answer(causes=j.classes, probability=j.chance.probability, mc_error=j.chance.mc_error) for j in joints
    )


def causes(setting: Setting, found: Found, decision: Decision) -> tuple[data.Cause, ...]:
    """All causes, most probable first."""
    smallest = estimate.detectable(found)
    none = Chance(0.0, 0.0)
    told = []
    for cause in setting.causes:
        chance = decision.marginal.get(cause.id, none)
        one = data.Cause(
            id=cause.id,
            probability=chance.probability,
            mc_error=chance.mc_error,
            detectable=smallest.get(cause.id),
            doc=cause.doc,
            exposes=cause.exposes,
            like=cause.like,
            usual=cause.size.sd,
            unit=cause.size.unit,
            meaning=cause.size.doc,
        )
        told.append(_sized(one, found, decision) if chance.probability > LISTED else one)
    if (beyond_all := decision.marginal.get(UNEXPLAINED)) is not None:
        told.append(data.Cause(id=UNEXPLAINED, probability=beyond_all.probability, mc_error=beyond_all.mc_error))
    return tuple(sorted(told, key=lambda c: (-c.probability, c.id)))


def _sized(cause: data.Cause, found: Found, decision: Decision) -> data.Cause:
    """A cause with its size, shapes and forms, and what it alone changes."""
    members = decision.members[cause.id]
    shares = estimate.form_shares(cause.id, members)
    update = {
        "parameters": tuple(
            data.Estimate.model_validate(e, from_attributes=True) for e in estimate.estimates(found, cause.id, members)
        ),
        "forms": tuple(data.FormShare(name=n, share=s) for n, s in shares.items() if s > LISTED),
    }
    acting = next(((h, a) for h, _ in members for a in h.fit.look.acting if a.id == cause.id), None)
    if acting is not None:
        h, one = acting
        update["regime"] = estimate.regime(one.formula.form, one.formula.theta(one.t))
        update["impact"] = impacts(found, h, cause.id)
    return data.Cause.model_validate(cause.model_dump() | {k: _dumped(v) for k, v in update.items()})


def _dumped(value: object) -> object:
    if isinstance(value, tuple):
        return [v.model_dump() for v in value]
    return (
        {k: v.model_dump() if isinstance(v, data.Impact) else v for k, v in value.items()}
        if isinstance(value, dict)
        else value
    )


def impacts(found: Found, h: Hypothesis, only: str | None = None) -> dict[str, data.Impact]:
    """Mean change of each compared sensor by a hypothesis: its name with the unit of the change -> the change."""
    known = {s.name: s for s in found.problem.data.read}
    told = {}
    for name, change in estimate.impact(found.problem, h, only).items():
        s = known[name]
        unit = UNITS[si(s)][0]
        cut, ending = ENDINGS[unit]
        low, high = (difference(s, v) for v in change.ci95)
        what = f"{KINDS[s.kind][1]} {name}"
        told[name.removesuffix(cut) + ending] = data.Impact(
            value=difference(s, change.value), ci95=(low, high), unit="K" if unit == "degC" else unit, what=what
        )
    return told


def remainder(found: Found, decision: Decision) -> data.Remainder | None:
    """What the library lacks, by channel: beside the most probable hypothesis that holds it."""
    chance = decision.marginal.get(UNEXPLAINED)
    own = [h for h, _ in decision.members.get(UNEXPLAINED, ())]
    if chance is None or chance.probability < LISTED or not own:
        return None
    extra, o = own[0].extra, found.problem.data
    assert extra is not None
    told = []
    for i, s in enumerate(o.read):
        rows = np.flatnonzero(o.kind == i)
        if s.name in extra.channels and len(rows):
            rms = float(np.sqrt(np.mean(np.diag(extra.covariance)[rows])))
            unit = UNITS[si(s)][0]
            told.append(
                (
                    rms / s.repeat_sd,
                    data.RemainderChannel(channel=s.name, rms=difference(s, rms), unit="K" if unit == "degC" else unit),
                )
            )
    told.sort(key=lambda item: -item[0])
    return data.Remainder(probability=chance.probability, mc_error=chance.mc_error, channels=tuple(c for _, c in told))


def data_quality(setting: Setting, found: Found, decision: Decision) -> data.DataQuality:
    """Gross readings, values far off, scatter against the card."""
    leader = decision.leader
    return data.DataQuality(
        gross=tuple(_gross(found, g) for g in quality.gross_readings(found, leader)),
        nuisances=tuple(_off(setting, o) for o in quality.values_off(found, leader)),
        variance=tuple(_scatter(setting, s) for s in quality.scatters(found, leader)),
        adequacy=quality.adequacy(found, leader),
    )


def _gross(found: Found, g: quality.Gross) -> data.GrossReading:
    campaign = found.problem.campaigns[g.campaign].campaign
    s = campaign.sensor(g.sensor)
    shown, expected = (None if v is None else float(in_unit(s, np.array(v))) for v in (g.shown, g.expected))
    where = "" if g.campaign == 0 else f" of {campaign.name}"
    return data.GrossReading(
        row=g.row + 1,
        line=int(campaign.lines[g.row]),
        point=f"{int(campaign.points[g.row])}{where}",
        channel=g.sensor,
        size_sd=g.size_sd,
        shown=shown,
        expected=expected,
        unit=UNITS[si(s)][0],
    )


def _off(setting: Setting, off: quality.Off) -> data.NuisanceOff:
    values = [(path, f) for path, f in off.factors.items() if path in setting.plant.place]
    one = values[0] if len(values) == 1 else None
    file = float(setting.plant.p[setting.plant.place[one[0]]]) if one else None
    units = {q.name: q.unit for q in setting.plant.flat.parameters}
    return data.NuisanceOff(
        name=off.name,
        z=off.z,
        factor=values[0][1] if values else None,
        file=file,
        found=file * one[1] if one and file is not None else None,
        unit=units.get(one[0], "") if one else "",
        paths=tuple(off.factors),
    )


def _scatter(setting: Setting, s: quality.Scatter) -> data.VarianceComponent:
    sensors = {f"readings of {x.name}": x for x in setting.problem.data.campaign.sensors}
    if s.name in sensors:
        x = sensors[s.name]
        card, unit, name = difference(x, x.repeat_sd), UNITS[si(x)][0], x.name
    else:
        card, unit, name = setting.card.day_cooling_sd, "1", ""
    low, high = (card * v for v in s.ci95)
    return data.VarianceComponent(
        name=s.name,
        channel=name,
        unit="K" if unit == "degC" else unit,
        card=card,
        found=card * s.ratio,
        ratio=s.ratio,
        ci95=(low, high),
    )


def rows(found: Found, decision: Decision) -> data.Rows:
    """The readings of the data, measured, calibrated and with the leading hypothesis."""
    o, own = found.problem.data, found.problem.own
    c = o.campaign
    null, leader = (fit.look.shown[own] for fit in (found.null, decision.leader.fit))
    spread = np.sqrt(np.diag(decision.leader.fit.noise.covariance))[own]
    channels = {}
    for i, s in enumerate(o.read):
        mine = o.kind == i
        table = np.full((3, c.n), np.nan)
        table[:, o.row[mine]] = o.measured[mine], null[mine], leader[mine]
        measured, nominal, extended = (in_unit(s, line) for line in table)
        sd = difference(s, float(np.median(spread[mine]))) if mine.any() else None
        shown = extended if decision.leader.causes else ()
        channels[s.name] = data.Rows.Values(measured=measured, nominal=nominal, extended=shown, sd=sd)
    return data.Rows(
        row=tuple(range(1, c.n + 1)),
        test=tuple(int(t) + 1 for t in c.test),
        direction=tuple(int(d) for d in c.direction),
        channels=channels,
        quantities=quantities(o.campaign, {s.name: o.sensors[s.name] for s in c.sensors}),
    )


def quantities(campaign: Campaign, sensors: Mapping[str, np.ndarray]) -> dict[str, data.Rows.Quantity]:
    """What readings are drawn against: the given sensors, the rise of the oil over the room, the running order."""
    told = {}
    for s in campaign.given:
        told[s.name] = data.Rows.Quantity(label=s.column, unit=UNITS[si(s)][0], values=in_unit(s, sensors[s.name]))
    oil = next((s for s in campaign.sensors if s.kind == "oil_temp"), None)
    room = next((s for s in campaign.sensors if s.kind == "ambient"), None)
    if oil and room:
        rise = sensors[oil.name] - sensors[room.name]
        told["rise"] = data.Rows.Quantity(label="oil over room", unit="K", values=rise)
    told["order"] = data.Rows.Quantity(label="running order", values=campaign.order[campaign.test])
    return told
