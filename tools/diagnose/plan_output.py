"""A plan as a JSON object, as one screen of text, and as a picture."""

from __future__ import annotations

import io
from collections.abc import Iterable
from typing import Any

import matplotlib as mpl

from .. import plots
from ..console import table
from ..effects.taxonomy import CAUSES
from .candidates import Candidate
from .design import Pair
from .family import prior_size
from .plan import APART, Outlook, Plan

SCHEMA = "gearheat.plan/1"
#: Experiments on the screen and in the picture; what they have to add to count.
SHOWN, LEAST = 10, 0.05
#: More pairs than these are drawn by their smallest distance alone; the axis ends here [standard deviations].
PAIRS, END = 3, 12.0


def as_object(plan: Plan) -> dict[str, Any]:
    """The JSON object of a plan; the same plan gives the same object."""
    campaign = plan.inputs.campaign
    return {
        "schema": SCHEMA,
        "rig": plan.inputs.scenario.name,
        "campaign": {
            "name": campaign.name,
            "tests": len(campaign.tests()),
            "readings": len(campaign.readings),
            "reference": plan.inputs.reference,
        },
        "apart": APART,
        "verdict": plan.verdict,
        "says": sentence(plan),
        "causes": [_cause(plan, name) for name in plan.inputs.causes],
        "pairs": [
            {"causes": list(p), "distance": _sigma(d), "one_answer": plan.one_answer.get(p)}
            for p, d in plan.distances.items()
        ],
        "experiments": [{**_experiment(o.experiments[0]), **_outlook(plan, o)} for o in plan.outlooks],
        "together": [{"experiments": [e.id for e in o.experiments], **_outlook(plan, o)} for o in plan.together],
        "warnings": list(plan.inputs.warnings),
    }


def _cause(plan: Plan, name: str) -> dict[str, Any]:
    cause = CAUSES[name]
    size = {"name": cause.size.name, "value": prior_size(cause), "unit": cause.size.unit}
    return {"id": name, "size": size, "visible": _sigma(plan.visible[name]), "exposes": cause.exposes}


def _experiment(experiment: Candidate) -> dict[str, Any]:
    keys = ("n_carrier_rpm", "T_carrier_Nm", "T_amb_C")
    return {
        "id": experiment.id,
        "what": experiment.what,
        "tests": [dict(zip(keys, point, strict=True)) for point in experiment.points],
        "channels": list(experiment.channels),
        "checks": [{"instrument": c.instrument, "readings": c.n, "sd": c.sd} for c in experiment.checks],
    }


def _outlook(plan: Plan, outlook: Outlook) -> dict[str, Any]:
    return {
        "smallest": _sigma(outlook.smallest),
        "nearest": list(outlook.nearest),
        "gain": _sigma(outlook.gain),
        "separates": outlook.separates,
        "pairs": [
            {"causes": list(p), "before": _sigma(plan.distances[p]), "after": _sigma(after)}
            for p, after in outlook.after.items()
        ],
    }


def _sigma(value: float) -> float:
    """A distance to a thousandth of a standard deviation, never minus zero."""
    return round(float(value), 3) + 0.0


def sentence(plan: Plan) -> str:
    """The answer in one sentence."""
    if plan.now is None:
        return f"No experiment here tells {_listed(plan.inputs.causes)} apart: they are one answer."
    now, best, last = plan.now, plan.outlooks[0], plan.together[-1]
    alone = len(last.experiments) == 1
    what = last.experiments[0].what if alone else f"{_listed(e.id for e in last.experiments)} together"
    reach = f"from {now.smallest:.1f} to {last.smallest:.1f} sigma"
    found = {
        "apart": f"The campaign tells them apart as it is: {now.smallest:.1f} sigma at least.",
        "one": f"Do {best.experiments[0].id}, {best.experiments[0].what}: {reach}.",
        "several": f"No single experiment here tells them apart, but {what} do: {reach}.",
        "none": f"No experiment here tells them apart at {APART:g} sigma. The best is {what}: {reach}.",
    }
    return " ".join(
        [found[plan.verdict], *(f"Nothing here tells {_listed(c)} apart." for c in _classes(plan).values())]
    )


def _classes(plan: Plan) -> dict[str, list[str]]:
    """Why causes are one answer -> which."""
    found: dict[str, list[str]] = {}
    for pair, why in plan.one_answer.items():
        found[why] = list(dict.fromkeys([*found.get(why, []), *pair]))
    return found


def show(plan: Plan) -> None:
    """Print a plan on one screen."""
    print(sentence(plan))
    if plan.now is not None:
        helpful = _helpful(plan)
        several = len(plan.inputs.causes) > 2
        head = ("experiment", "sigma", "tells apart", *(("nearest",) if several else ()), "what")
        body = [
            (name, f"{o.smallest:.2f}", "yes" if o.separates else "no", *_near(o, several), what)
            for name, what, o in [("", "the campaign as it is", plan.now), *helpful]
        ]
        table("", head, body)
        if (rest := len(plan.outlooks) - len(helpful)) > 0:
            print(f"{rest} more experiments add little; --json lists all")
    for why, names in _classes(plan).items():
        print(f"{_listed(names)} are one answer here ({why}). What would tell: {_exposes(names)}")
    if plan.verdict == "none":
        print(f"What would show them: {_exposes(plan.inputs.causes)}")
    for name, sigma in plan.visible.items():
        if sigma < APART:
            cause = CAUSES[name]
            size = f"{cause.size.name} = {prior_size(cause):g} {cause.size.unit}".removesuffix(" 1")
            print(f"{name} at {size} is {sigma:.1f} sigma from no cause in this campaign: no further from any other")
    for warning in plan.inputs.warnings:
        print(f"warning: {warning}")


def _near(outlook: Outlook, several: bool) -> tuple[str, ...]:
    return (" / ".join(outlook.nearest),) if several else ()


def _helpful(plan: Plan) -> list[tuple[str, str, Outlook]]:
    """Experiments that add something: name, words, outlook; several together at the end."""
    found = [(o.experiments[0].id, o.experiments[0].what, o) for o in plan.outlooks if o.gain >= LEAST][:SHOWN]
    together = [o for o in plan.together if len(o.experiments) > 1]
    return found + [(" + ".join(e.id for e in o.experiments), "together", o) for o in together]


def _exposes(names: Iterable[str]) -> str:
    return "; ".join(f"{name}: {CAUSES[name].exposes}" for name in names)


def _listed(names: Iterable[str]) -> str:
    *most, last = names
    return f"{', '.join(most)} and {last}" if most else last


def picture(plan: Plan, form: str) -> bytes:
    """Bars of the distances now and behind each experiment, as PNG or SVG ("png", "svg")."""
    rows = [("as it is", "", plan.now), *_helpful(plan)] if plan.now else []
    pairs: list[Pair | None] = [p for p in plan.distances if p not in plan.one_answer]
    if len(pairs) > PAIRS:
        pairs = [None]
    figure, (panel,) = plots.empty(9.0, 1.4 + 0.34 * len(rows) * max(len(pairs), 1) ** 0.5, 1, 1)
    height = 0.8 / max(len(pairs), 1)
    for k, pair in enumerate(pairs):
        values = [o.smallest if pair is None else o.after[pair] for _, _, o in rows if o]
        places = [i + (k - (len(pairs) - 1) / 2) * height for i in range(len(rows))]
        label = "nearest pair" if pair is None else " / ".join(pair)
        bars = panel.barh(places, [min(v, END) for v in values], height, color=plots.COLOURS[k], label=label)
        panel.bar_label(bars, [f"{v:.1f}" for v in values], padding=3, fontsize=8)
    panel.set_yticks(range(len(rows)), [name for name, _, _ in rows])
    panel.invert_yaxis()
    panel.axvline(APART, color="#888888", linewidth=1, linestyle="--")
    panel.set(xlim=(0, END), xlabel="distance [standard deviations]")
    panel.grid(False, axis="y")
    plots.legend(figure, panel)
    if form == "svg":
        return plots.svg(figure).encode()
    data = io.BytesIO()
    with mpl.rc_context(plots.STYLE):
        figure.savefig(data, format="png", dpi=150, metadata={"Software": None})
    return data.getvalue()
