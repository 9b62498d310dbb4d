"""One self-contained HTML page about a diagnosis: what is wrong and why, how big, how sure, what to measure next."""

from __future__ import annotations

import math
import re
from typing import Any

from markupsafe import Markup

from ...model.units import from_si, shown
from ..effects.taxonomy import CAUSES
from ..pages import page
from ..report import html_table
from ..settings import parameter_of
from . import pictures, words
from .card import DEFAULTS, PRIOR
from .findings import Findings, Named
from .habit import HABIT, POWER
from .inputs import Inputs

#: Causes drawn as bars have at least this probability; hypotheses in the table, too.
LEAST, HYPOTHESES = 0.01, 8
#: What the card's priors are about.
PRIORS = {
    "mu": "friction of the teeth",
    "brg": "bearing loss",
    "seal": "seal loss",
    "hconv": "convection outside",
    "rad": "radiation",
    "gow": "oil to gears and wall",
    "gwh": "wall to housing",
    "cap": "heat capacities",
}


def render(inputs: Inputs, findings: Findings) -> str:
    """The page as HTML text, the same bytes for the same findings."""
    hypothesis = words.applied(findings)
    return page(
        "diagnosis.html",
        inputs=inputs,
        findings=findings,
        words=words,
        tests=len(inputs.data.tests()),
        applied=hypothesis,
        residuals=Markup(pictures.residuals(findings, inputs.data, inputs.card, extended=hypothesis is not None)),
        in_sample=_in_sample(findings, inputs, extended=hypothesis is not None),
        bars=_bars(findings),
        hypotheses=_hypotheses(findings),
        groups=_groups(findings),
        sizes=_sizes(findings),
        impact=_impact(findings) if hypothesis else [],
        played=words.played(findings) if hypothesis else "",
        not_played=words.not_played(findings) if hypothesis else "",
        gain=_gain(findings),
        grouped=_grouped(findings),
        experiments=_experiments(findings),
        exposes=_exposes(findings),
        detectable=_detectable(findings),
        accuracies=_accuracies(inputs),
        priors=_priors(inputs),
        calibrated=_calibrated(inputs, findings),
    )


def _bars(findings: Findings) -> list[dict[str, Any]]:
    """Rows of the chart of probabilities: causes, then what else may be."""
    listed = [c for c in findings.causes if c.probability >= LEAST]
    rows: list[dict[str, Any]] = [
        {"name": words.name_of(c.id), "id": c.id, "probability": c.probability, **_told(c)} for c in listed
    ]
    total = sum(h.probability for h in findings.hypotheses)
    clean = sum(h.probability for h in findings.hypotheses if not h.causes)
    other = [("nothing wrong", clean), ("less probable than those listed", 1.0 - total)]
    rows += [
        {"name": n, "id": "", "probability": p, "size": "", "where": "", "certificate": ""}
        for n, p in other
        if p >= LEAST
    ]
    for row in rows:
        row["percent"] = words.percent(row["probability"])
        row["width"] = f"{100 * min(max(row['probability'], 0.0), 1.0):.1f}"
    return rows


def _told(cause: Named) -> dict[str, str]:
    size = words.estimate(cause.parameters[0]) if cause.parameters else ""
    return {"size": size, "where": words.regime(cause), "certificate": words.certificate(cause)}


def _hypotheses(findings: Findings) -> Markup:
    ranked = sorted(findings.hypotheses, key=lambda h: -h.probability)[:HYPOTHESES]
    needed = {h.causes for h in words.needed(findings)}
    body = [
        (words.names_of(h.causes) if h.causes else "nothing wrong", ", ".join(h.causes), words.percent(h.probability),
         "in the 90 % set" if h.causes in needed else "")
        for h in ranked
    ]  # fmt: skip
    return html_table(("hypothesis", "causes", "probability", ""), body, text=(1, 3))


def _groups(findings: Findings) -> list[dict[str, str]]:
    """Sets that cannot be told apart, with the reason where it is declared."""
    found = []
    for group in (g for g in findings.confusable if len(g) > 1):
        reasons = dict.fromkeys(CAUSES[c].like for c in group if c in CAUSES and CAUSES[c].like)
        shared = [r for r in reasons if sum(CAUSES[c].like == r for c in group if c in CAUSES) > 1]
        first, *others = (words.name_of(c) for c in group)
        found.append({"cause": first, "others": ", ".join(others), "reason": "; ".join(shared)})
    return found


def _sizes(findings: Findings) -> Markup:
    """All parameters of the probable causes."""
    body = []
    for cause in (c for c in findings.causes if c.probability >= LEAST and c.parameters):
        for k, p in enumerate(cause.parameters):
            unit = "" if p.unit == "1" else p.unit
            name = words.name_of(cause.id) if k == 0 else ""
            about = words.meaning(cause.id, p.name) + (f"; {words.regime(cause)}" if k == 0 and cause.regime else "")
            body.append((name, p.name, words.number(p.value), words.interval(p), unit, about))
    if not body:
        return Markup("")
    return html_table(("cause", "parameter", "value", "95 % interval", "unit", "meaning"), body, text=(1, 4, 5))


def _impact(findings: Findings) -> list[str]:
    return [text for key in findings.impact if (text := words.impact(findings, key))]


def _in_sample(findings: Findings, inputs: Inputs, *, extended: bool) -> Markup:
    """Root mean square of what is left per channel, beside the scatter of one reading."""
    body = []
    for channel, (before, after) in pictures.root_mean_squares(findings).items():
        name, unit = pictures.CHANNELS.get(channel, (channel, ""))
        line = [name, unit, words.number(before), words.number(pictures.scatter(channel, inputs.card), 2)]
        body.append([*line[:3], words.number(after), line[3]] if extended else line)
    middle = ("before", "after") if extended else ("calibrated model",)
    return (
        html_table(("root mean square", "unit", *middle, "repeatability of one reading"), body, text=(1,))
        if body
        else Markup("")
    )


def _gain(findings: Findings) -> dict[str, Any]:
    """Bars of the errors on readings left out."""
    g = findings.gain
    bars = [
        ("calibrated, nothing added", g.rmse_before, "before"),
        ("with the cause found without them", g.rmse_after, "after"),
    ]
    if g.noise_floor is not None:
        bars.append(("scatter of one point, days included", g.noise_floor, "floor"))
    bars += [(f"plain statistics: {name}", value, "floor") for name, value in g.rivals.items()]
    most = max((value for _, value, _ in bars if math.isfinite(value)), default=1.0) or 1.0
    rows = [
        {"name": n, "value": f"{words.number(v, 3)} K", "width": f"{100 * v / most:.1f}", "kind": k} for n, v, k in bars
    ]
    ratio = g.rmse_after / g.rmse_before if g.rmse_before else math.nan
    low, high = (words.number(v, 2) for v in g.ratio_ci90)
    scheme = words.SCHEMES.get(g.scheme, g.scheme)
    return {"rows": rows, "ratio": words.number(ratio, 2), "low": low, "high": high, "scheme": scheme, "n": g.n}


def _grouped(findings: Findings) -> Markup:
    """Errors where whole groups of tests were left out, with those of plain statistics."""
    if not findings.grouped:
        return Markup("")
    rivals = list(findings.grouped[0].rivals)
    body = [
        (
            words.SCHEMES.get(g.scheme, g.scheme),
            str(g.n),
            words.number(g.rmse_before, 2),
            words.number(g.rmse_after, 2),
            *(words.number(g.rivals[name], 2) for name in rivals),
        )
        for g in findings.grouped
    ]
    head = ("left out", "readings", "before [K]", "after [K]", *(f"{name} [K]" for name in rivals))
    return html_table(head, body, text=(0,))


def _experiments(findings: Findings) -> Markup:
    if not findings.next_experiment:
        return Markup("")
    body = [
        (
            e.what,
            " from ".join(words.name_of(c) for c in e.separates),
            words.number(e.before, 2),
            words.number(e.after, 2),
        )
        for e in findings.next_experiment
    ]
    return html_table(("experiment", "separates", "now [sigma]", "then [sigma]"), body, text=(1,))


def _exposes(findings: Findings) -> list[tuple[str, str]]:
    """What would show each probable cause directly."""
    ids = [c.id for c in findings.causes if c.probability >= LEAST and c.id in CAUSES]
    return [(words.name_of(c), CAUSES[c].exposes) for c in ids if CAUSES[c].exposes]


def _detectable(findings: Findings) -> Markup:
    """Smallest sizes that would have been seen, in the order of the taxonomy."""
    body = []
    known = {c.id: c for c in findings.causes}
    for cause in (CAUSES[c] for c in CAUSES if c in known):
        usual = f"{words.number(cause.size.sd, 2)}{'' if cause.size.unit == '1' else f' {cause.size.unit}'}"
        seen = words.visible(known[cause.id]) or "not visible"
        body.append((words.name_of(cause.id), seen, usual, cause.size.doc))
    return html_table(("cause", "smallest visible", "usual size", "meaning"), body, text=(3,)) if body else Markup("")


def _accuracies(inputs: Inputs) -> Markup:
    body = []
    for column in DEFAULTS:
        channel, stated = inputs.card.channel(column), column in inputs.card.channels
        body.append((column, channel.repeat_sd, channel.offset_sd, "card" if stated else "default"))
    return html_table(("column", "reading to reading", "fixed tolerance", "from"), body, text=(3,))


def _priors(inputs: Inputs) -> Markup:
    body = [
        (
            PRIORS.get(name, name),
            f"{100 * inputs.card.prior(name):.3g} %",
            "card" if name in inputs.card.prior_sd else "default",
        )
        for name in PRIOR
    ]
    body.append(("cooling from day to day", f"{100 * inputs.card.day_cooling_sd:.3g} %", "card"))
    return html_table(("parameter", "standard deviation", "from"), body, text=(2,))


def _calibrated(inputs: Inputs, findings: Findings) -> Markup:
    """Values that the data moved: of the rig, calibrated without and with the top hypothesis."""
    quantities = inputs.scenario.settable()
    body = []
    for path, value in findings.nominal.items():
        part, _, key = path.rpartition(".")
        parameter = parameter_of(inputs.spec, path)
        if parameter is None or (own := inputs.spec.part(part).values.get(key, parameter.default)) is None:
            continue
        unit = quantities[path].unit
        extended = findings.extended.get(path, value)
        body.append((path, *(words.number(from_si(float(v), unit), 4) for v in (own, value, extended)), _unit(unit)))
    if POWER in findings.nominal:
        power = (0.0, findings.nominal[POWER], findings.extended.get(POWER, findings.nominal[POWER]))
        body.append((HABIT.doc, *(words.number(p, 4) for p in power), "W"))
    return html_table(("value", "rig", "calibrated", "with the cause", "unit"), body, text=(4,)) if body else Markup("")


def _unit(unit: str) -> str:
    return "" if unit == "1" else re.sub(r"^degC$", "°C", shown(unit))
