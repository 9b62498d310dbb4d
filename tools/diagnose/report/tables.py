"""The tables of a diagnosis, as the screen and the page show them: a title, columns, and rows of text."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from ...show.columns import cell_text
from ..answer.channels import KINDS
from ..answer.findings import APART, Cause, Findings, Isolability
from .phrases import (
    SCHEMES,
    estimate,
    meaning,
    name_of,
    names_of,
    number,
    p_value,
    percent,
    sigma,
    size,
    where,
    with_unit,
)
from .words import RULED_OUT

#: Causes and hypotheses in a table have at least this probability, the first of them any.
LEAST = 0.05
#: What the tables of residuals hold.
MEANS = (
    "Mean of measured less calibrated readings, before any cause, and how many; ! more than four standard errors off."
)
#: Experiments and rows at most this many.
MOST = 10
#: Causes that a channel names on its own, at most.
NAMED = 3


@dataclass(frozen=True)
class Table:
    """Rows of text under columns; `note` says what they mean."""

    title: str
    columns: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]
    note: str = ""


def tables(findings: Findings) -> list[Table]:
    """All tables that have rows, in the order of the page."""
    return [t for group in SECTIONS.values() for t in group(findings) if t.rows]


def residuals(findings: Findings) -> list[Table]:
    """Means of what the calibrated rig leaves, in the tables and channels in which some stand out."""
    found = []
    for channel, by in dict.fromkeys((r.channel, r.by) for r in findings.residuals):
        means = [r for r in findings.residuals if (r.channel, r.by) == (channel, by)]
        if not any(r.stands_out for r in means):
            continue
        cells = {r.cell: f"{r.mean:+.2g}{' !' if r.stands_out else ''} ({r.n})" for r in means}
        columns = tuple(dict.fromkeys(cell[1:] for cell in cells))
        rows = [
            (first, *(cells.get((first, *rest), "") for rest in columns))
            for first in dict.fromkeys(cell[0] for cell in cells)
        ]
        head = (by[0], *(f"{by[1]} {rest[0]}" if rest else "mean" for rest in columns))
        found.append(Table(f"{channel} [{means[0].unit}] over {' and '.join(by)}", head, rows, MEANS))
    return found


def quality(findings: Findings) -> list[Table]:
    """Scatter against the card, repeated points, values off."""
    q = findings.data_quality
    off = [(n.name, number(n.z, 2), with_unit(n.factor), ", ".join(n.paths)) for n in q.nuisances]
    scatter = [
        (v.name, v.channel, with_unit(v.card, v.unit), with_unit(v.found, v.unit), number(v.ratio, 2))
        for v in q.variance
    ]
    repeats = [
        (p.condition, p.channel, str(r.test), number(r.order), *(with_unit(v, p.unit) for v in (r.sum, r.difference)))
        for p in q.repeated
        for r in p.repeats
    ]
    return [
        Table("Where the rig differs from its file", ("value", "prior sd off", "factor", "parameters"), off),
        Table("Scatter", ("of", "channel", "card", "found", "ratio"), scatter),
        Table(
            "Repeated points in running order",
            ("point", "channel", "test", "order", "mean of the directions", "half their difference"),
            repeats,
            "Measured less calibrated, less its mean at the point. A mean that moves is the rig, the room or a probe; a"
            " difference that moves is a torque transducer or the direction.",
        ),
    ]


def causes(findings: Findings) -> list[Table]:
    """Causes with their sizes, hypotheses, and what each channel says on its own."""
    listed = list_causes(findings)
    ranked = [
        (percent(c.probability, c.mc_error), name_of(c.id), size(c), where(c, findings.channels), c.id) for c in listed
    ]
    sizes = [(name_of(c.id), p.name, estimate(p), meaning(p)) for c in listed for p in c.parameters]
    joint = findings.hypotheses
    together = [
        (percent(h.probability, h.mc_error), names_of(h.causes) or "nothing wrong")
        for k, h in enumerate(joint)
        if k == 0 or h.probability >= LEAST
    ]
    rest = joint[len(together) :]
    if further := sum(h.probability for h in rest):
        together.append((percent(further), f"{len(rest)} further one{'s together' * (len(rest) > 1)}"))
    by_channel = []
    for v in findings.views:
        leading = ", ".join(f"{name_of(s.id)} {percent(s.probability)}" for s in v.causes[:NAMED])
        by_channel.append((v.channel, v.asks, p_value(v.p), percent(v.nothing), leading))
    return [
        Table("Causes", ("probability", "cause", "size (95 %)", "where", "id"), ranked),
        Table("Sizes and shapes", ("cause", "parameter", "value (95 %)", "meaning"), sizes),
        Table("Hypotheses", ("probability", "causes"), together),
        Table("What each channel says on its own", ("channel", "asks", "p", "nothing wrong", "causes"), by_channel),
    ]


def list_causes(findings: Findings) -> list[Cause]:
    """The causes that a page lists one by one."""
    return [c for c in findings.causes if c.probability >= LEAST or c.id in findings.named]


def gain(findings: Findings) -> list[Table]:
    """Errors on readings left out by every scheme, and of the rig played over the data."""
    found = [g for g in (findings.gain, *findings.gain_grouped) if g is not None]
    rivals = list(dict.fromkeys(name for g in found for name in g.rivals))
    rows = []
    for g in found:
        both = [v.with_ if v else None for v in (g.before, g.after)]
        values = (g.rmse_before, g.rmse_after, *both, *(g.rivals.get(name) for name in rivals), g.noise_floor)
        rows.append((SCHEMES.get(g.scheme, g.scheme), f"{g.channel} [{g.unit}]", str(g.n), *map(with_unit, values)))
    head = ("left out", "channel", "readings", "before", "after", "before, interpolated", "after, interpolated")
    played = [
        (channel, with_unit(p.rms_calibrated, p.unit), with_unit(p.rms_extended, p.unit))
        for channel, p in findings.played.items()
    ]
    note = "Rig files hold neither what days and tests differ by, nor what a reference tells of their own errors."
    return [
        Table(
            "Errors on readings left out",
            (*head, *rivals, "scatter of one reading"),
            rows,
            "Root mean square. The whole inference is repeated without the readings left out. Before and after: by"
            " what lasts, and by the mean of errors that do not. Interpolated: with what is another in each test or"
            " mounting as well, fillings, zeros that wander, which says nothing of a new campaign.",
        ),
        Table("The rig played over these data, root mean square", ("channel", "calibrated", "extended"), played, note),
    ]


def tell_design(found: Iterable[Isolability]) -> Table:
    """What a design tells of each cause."""
    rows = []
    for i in found:
        seen, apart = ("yes" if d is not None and min(d, i.visible) >= APART else "no" for d in (i.visible, i.distance))
        rows.append((i.cause, sigma(i.visible), seen, name_of(i.nearest), sigma(i.distance), apart))
    head = ("cause", "from none", "seen", "nearest cause", "from it", "told apart")
    note = f"Distances in standard deviations at the usual size of each cause; seen and told apart from {APART:g} on."
    return Table("What this design can tell", head, rows, note)


def experiments(findings: Findings) -> list[Table]:
    """What to measure next, and what would show each probable cause."""
    rows = [
        (e.what or e.id, names_of(e.separates), sigma(e.separation_before), sigma(e.separation_after))
        for e in findings.next_experiment[:MOST]
    ]
    exposing = [(name_of(c.id), c.exposes) for c in list_causes(findings) if c.exposes]
    note = f"Distances in standard deviations; below {APART:g} two causes look alike."
    return [
        Table("What to measure next", ("experiment", "separates", "now", "then"), rows, note),
        Table("What shows a cause directly", ("cause", "experiment"), exposing),
    ]


def sets(findings: Findings) -> list[Table]:
    """Look-alikes, what these data show of each cause, and what they cannot show."""
    # a rival that the data rule out can be told apart, whatever the design says of usual sizes
    unsettled = {c.id for c in findings.causes if c.probability >= RULED_OUT} | findings.named
    kept = [(s, [c for c in s.causes if c in unsettled]) for s in findings.sets]
    pairs = [(f"{name_of(one)} from {names_of(others, 'or')}", s) for s, (one, *others) in kept if others]
    alike = [(said, sigma(s.distance), s.reason) for said, s in pairs]
    smallest = [
        (name_of(c.id), *(with_unit(v, c.unit) or "not visible" for v in (c.detectable, c.usual)), c.meaning)
        for c in filter(None, (findings.cause(i.cause) for i in findings.isolability))  # not of scatters
    ]
    blind = [(name_of(i.cause), i.reason) for i in findings.invisible]
    note = "Distance from the nearest in standard deviations."
    values = [(v.path, *(with_unit(x, v.unit) for x in (v.file, v.nominal, v.extended))) for v in findings.calibrated]
    return [
        Table("Cannot be told apart by these data", ("causes", "distance", "why"), alike, note),
        tell_design(findings.isolability),
        Table("Smallest size found in 80 of 100 such campaigns", ("cause", "smallest", "usual", "meaning"), smallest),
        Table("Causes that these data cannot show", ("cause", "why"), blind),
        Table("Calibrated values", ("value", "file", "calibrated", "with the causes"), values),
    ]


#: Name in the template of the page -> its tables, in the order of the page.
SECTIONS = dict(residuals=residuals, quality=quality, causes=causes, gains=gain, experiments=experiments, sets=sets)


def predictions_text(findings: Findings) -> str:
    """CSV text, a row a point: what each channel will show, calibrated without a cause and with the causes."""
    names = dict.fromkeys(name for p in findings.predictions for name in p.nominal)
    ends = {c.name: KINDS[c.kind][3] for c in findings.channels if c.kind in KINDS}
    columns = [f"{name}_{model}{ends.get(name, '')}" for name in names for model in ("nominal", "extended")]
    lines = [",".join(map(cell_text, ["point", *columns]))]
    for p in findings.predictions:
        pairs = [values.get(name) for name in names for values in (p.nominal, p.extended)]
        lines.append(",".join([cell_text(str(p.point)), *("" if v is None else f"{v:.3f}" for v in pairs)]))
    return "\n".join(lines) + "\n"
