"""The tables of a diagnosis, as the screen and the page show them: a title, columns, and rows of text."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from ..answer.evidence import View
from ..answer.findings import Findings, Hypothesis
from . import phrases
from .names import name_of, names_of

#: Causes and hypotheses in a table have at least this probability.
LEAST = 0.01
#: Experiments and rows at most this many.
MOST = 10


@dataclass(frozen=True)
class Table:
    """Rows of text under columns; `note` says what they mean."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str = ""


def tables(findings: Findings) -> list[Table]:
    """All tables that have rows, in the order of the page."""
    made = (quality(findings), causes(findings), gain(findings), experiments(findings), sets(findings))
    return [t for group in made for t in group if t.rows]


def quality(findings: Findings) -> list[Table]:
    """Scatter against the card, repeated points, values off."""
    q, unit = findings.data_quality, phrases.with_unit
    off = ((n.name, phrases.number(n.z, 2), _value(n.factor), ", ".join(n.paths)) for n in q.nuisances)
    scatter = (
        (v.name, v.channel, unit(v.card, v.unit), unit(v.found, v.unit), phrases.number(v.ratio, 2)) for v in q.variance
    )
    repeats = (
        (p.condition, p.channel, str(r.test), _value(r.order), *(_value(v, p.unit) for v in (r.sum, r.difference)))
        for p, r in ((p, r) for p in q.repeated for r in p.repeats)
    )
    return [
        _table("Where the rig differs from its file", ("value", "prior sd off", "factor", "parameters"), off),
        _table("Scatter", ("of", "channel", "card", "found", "ratio"), scatter),
        _table(
            "Repeated points in running order",
            ("point", "channel", "test", "order", "mean of the directions", "half their difference"),
            repeats,
            "Deviations from the mean of the point, temperatures over the room. A mean that moves is the rig, the room"
            " or a probe; a difference that moves is a torque transducer or the direction.",
        ),
    ]


def causes(findings: Findings) -> list[Table]:
    """Causes with their sizes, hypotheses, and what each channel says on its own."""
    listed = [c for c in findings.causes if c.probability >= LEAST]
    ranked = (
        (
            phrases.percent(c.probability, c.mc_error),
            name_of(c.id),
            phrases.estimate(c.parameters[0]) if c.parameters else "",
            phrases.where(c),
            "" if c.q is None else phrases.p_value(c.q).replace("p", "q", 1),
            c.id,
        )
        for c in listed
    )
    sizes = (
        (name_of(c.id), p.name, phrases.estimate(p), phrases.meaning(p)) for c in listed for p in c.parameters
    )  # fmt: skip
    joint = sorted(findings.hypotheses, key=lambda h: -h.probability)[:MOST]
    together = ((phrases.percent(h.probability, h.mc_error), _joint(h)) for h in joint)
    by_channel = (
        (v.channel, v.asks, "" if v.p is None else phrases.p_value(v.p), _said(v.nothing), _leading(v.causes))
        for v in findings.views
    )
    return [
        _table("Causes", ("probability", "cause", "size (95 %)", "where", "other half", "id"), ranked),
        _table("Sizes and shapes", ("cause", "parameter", "value (95 %)", "meaning"), sizes),
        _table("Hypotheses", ("probability", "causes"), together),
        _table("What each channel says on its own", ("channel", "asks", "p", "nothing wrong", "causes"), by_channel),
    ]


def gain(findings: Findings) -> list[Table]:
    """Errors on readings left out by every scheme, and of the rig played over the data."""
    found = [g for g in (findings.gain, *findings.gain_grouped) if g is not None]
    rivals = list(dict.fromkeys(name for g in found for name in g.rivals))
    rows = (
        (
            phrases.scheme(g),
            f"{g.channel} [{g.unit}]",
            str(g.n),
            *(phrases.number(v) for v in (g.rmse_before, g.rmse_after)),
            *(_value(v.with_ if v else None) for v in (g.before, g.after)),
            *(_value(g.rivals.get(name)) for name in rivals),
            _value(g.noise_floor),
        )
        for g in found
    )  # fmt: skip
    head = ("left out", "channel", "readings", "before", "after", "before, with discrepancy", "after, with discrepancy")
    played = (
        (channel, phrases.with_unit(p.rms_calibrated, p.unit), phrases.with_unit(p.rms_extended, p.unit))
        for channel, p in findings.played.items()
    )
    return [
        _table(
            "Errors on readings left out",
            (*head, *rivals, "scatter of one reading"),
            rows,
            "Root mean square. Calibration and choice of the causes are repeated without the readings left out. The"
            " discrepancy is a smooth function of the conditions that both get.",
        ),
        _table("The rig played over these data, root mean square", ("channel", "calibrated", "extended"), played),
    ]


def experiments(findings: Findings) -> list[Table]:
    """What to measure next, and what would show each probable cause."""
    rows = (
        (e.what or e.id, names_of(e.separates), *map(phrases.sigma, (e.separation_before, e.separation_after)))
        for e in findings.next_experiment[:MOST]
    )  # fmt: skip
    exposing = ((name_of(c.id), c.exposes) for c in findings.causes if c.probability >= LEAST and c.exposes)
    note = "Distances in standard deviations; below 3 two causes look alike."
    return [
        _table("What to measure next", ("experiment", "separates", "now", "then"), rows, note),
        _table("What shows a cause directly", ("cause", "experiment"), exposing),
    ]


def sets(findings: Findings) -> list[Table]:
    """Look-alikes, what these data show of each cause, and what they cannot show."""
    alike = ((names_of(s.causes), phrases.sigma(s.distance), s.reason) for s in findings.sets)
    seen = (
        (
            name_of(i.cause),
            phrases.sigma(i.visible),
            name_of(i.nearest) if i.nearest else "",
            phrases.sigma(i.distance),
        )
        for i in findings.isolability
    )
    smallest = (
        (name_of(c.id), *(_value(v, c.unit) or "not visible" for v in (c.detectable, c.usual)), c.meaning)
        for c in findings.causes
        if c.usual is not None and any(other.detectable is not None for other in findings.causes)
    )
    blind = ((name_of(i.cause), i.reason) for i in findings.invisible)
    values = ((v.path, *(_value(x, v.unit) for x in (v.file, v.nominal, v.extended))) for v in findings.calibrated)
    return [
        _table("Cannot be told apart", ("causes", "distance", "why"), alike, "Distance in standard deviations."),
        _table(
            "What this design can tell",
            ("cause", "from none", "nearest cause", "from it"),
            seen,
            "Distances in standard deviations at the usual size of each cause; below 3 it is not seen, or not told.",
        ),
        _table("Smallest size found in 80 of 100 such campaigns", ("cause", "smallest", "usual", "meaning"), smallest),
        _table("Causes that these data cannot show", ("cause", "why"), blind),
        _table("Calibrated values", ("value", "file", "calibrated", "with the causes"), values),
    ]


def _table(title: str, columns: tuple[str, ...], rows: Iterable[tuple[str, ...]], note: str = "") -> Table:
    return Table(title, columns, tuple(rows), note)


def _value(value: float | None, unit: str = "") -> str:
    return "" if value is None else phrases.with_unit(value, unit)


def _joint(found: Hypothesis) -> str:
    return names_of(found.causes) or "nothing wrong"


def _said(probability: float | None) -> str:
    return "" if probability is None else phrases.percent(probability)


def _leading(said: Iterable[View.Alone]) -> str:
    return ", ".join(f"{name_of(s.id)} {phrases.percent(s.probability, s.mc_error)}" for s in list(said)[:3])
