"""What a plan found, on the screen and as a picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ....model.core.faults import name_all
from ...show.drawing import COLOURS, empty, legend
from ..answer.plan import Outlook, Plan
from . import phrases
from .phrases import name_of, names_of
from .screen import drawn, paragraph
from .tables import Table, tell_design

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Experiments on the screen and in the picture.
SHOWN = 10
#: What they have to add to count.
LEAST = 0.05
#: More pairs than these are drawn by their smallest distance alone.
PAIRS = 3
#: The axis ends here [standard deviations].
END = 12.0


def sentence(plan: Plan) -> str:
    """The answer in one sentence; empty where no causes were named."""
    if plan.verdict is None:
        return ""
    if plan.now is None or plan.verdict == "same" or not plan.outlooks:
        return f"No experiment here tells {names_of(plan.ids)} apart: they are one answer."
    best, last = plan.outlooks[0].experiments[0], (plan.together or plan.outlooks)[-1]
    several = len(last.experiments) > 1
    what = f"{name_all(last.experiments)} together" if several else plan.what(last.experiments[0])
    reach = f"from {plan.now.smallest:.1f} to {last.smallest:.1f} standard deviations"
    limit = f"{plan.apart:g} standard deviations"
    found = {
        "apart": f"The campaign tells them apart as it is: {plan.now.smallest:.1f} standard deviations at least.",
        "one": f"Do {best}, {plan.what(best)}: {reach}.",
        "several": f"No single experiment here tells them apart, but {what} do: {reach}.",
        "none": f"No experiment here tells them apart at {limit}. The best is {what}: {reach}.",
    }
    rest = [f"Nothing here tells {names_of(ids)} apart." for ids in _classes(plan).values()]
    return " ".join([found[plan.verdict], *rest])


def _classes(plan: Plan) -> dict[str, list[str]]:
    """Why causes are one answer -> which."""
    found: dict[str, list[str]] = {}
    for pair in plan.pairs:
        if pair.one_answer is not None:
            found[pair.one_answer] = list(dict.fromkeys([*found.get(pair.one_answer, []), *pair.causes]))
    return found


def text(plan: Plan, *, everything: bool = False, width: int | None = None) -> str:
    """The plan as text of some width; everything: all experiments, and all causes in the table of the design."""
    found = [paragraph("answer", sentence(plan), width)] if plan.verdict else []
    if plan.now is not None:
        found.append(drawn(_experiments(plan, everything), width))
    for why, ids in _classes(plan).items():
        exposes = "; ".join(f"{name_of(c.id)}: {c.exposes}" for c in plan.causes if c.id in ids and c.exposes)
        found.append(paragraph("one answer", f"{names_of(ids)} ({why}). What would tell: {exposes}.", width))
    for c in (c for c in plan.causes if c.visible < plan.apart):
        size = phrases.with_unit(c.usual, c.unit)
        seen = phrases.number(c.visible, 2)
        line = f"{name_of(c.id)} of usual size ({c.size} {size}) would show at only {seen} standard deviations."
        found.append(paragraph("faint", line, width))
    if plan.isolability and (everything or plan.verdict is None):
        found.append(drawn(tell_design(plan.isolability), width))
    found += [paragraph("warning", w, width) for w in plan.warnings]
    return "\n".join(found) + "\n"


def _experiments(plan: Plan, everything: bool) -> Table:
    several = len(plan.causes) > 2
    head = ("experiment", "distance", "tells apart", *(["nearest"] if several else []), "what")
    rows = []
    for name, what, o in _listed(plan, everything):
        nearest = [" / ".join(o.nearest)] if several else []
        rows.append((name, f"{o.smallest:.2f}", "yes" if o.separates else "no", *nearest, what))
    return Table("", head, rows, "Smallest distance of two causes, in standard deviations.")


def _listed(plan: Plan, everything: bool = False) -> list[tuple[str, str, Outlook]]:
    """The campaign as it is, experiments that add something, several together: name, words, outlook."""
    now = [("", "the campaign as it is", plan.now)] if plan.now is not None else []
    kept = plan.outlooks if everything else [o for o in plan.outlooks if o.gain >= LEAST][:SHOWN]
    single = [(o.experiments[0], plan.what(o.experiments[0]), o) for o in kept]
    several = [(" + ".join(o.experiments), "together", o) for o in plan.together if len(o.experiments) > 1]
    return [*now, *single, *several]


def picture(plan: Plan) -> Figure:
    """Bars of the distances now and behind each experiment."""
    rows = _listed(plan)
    pairs: list[tuple[str, str] | None] = [p.causes for p in plan.pairs if p.one_answer is None]
    if len(pairs) > PAIRS:
        pairs = [None]
    figure, (panel,) = empty(9.0, 1.4 + 0.34 * len(rows) * max(len(pairs), 1) ** 0.5, 1, 1)
    height = 0.8 / max(len(pairs), 1)
    for k, pair in enumerate(pairs):
        values = [next((p.after for p in o.pairs if p.causes == pair), o.smallest) for _, _, o in rows]
        places = [i + (k - (len(pairs) - 1) / 2) * height for i in range(len(rows))]
        label = "nearest pair" if pair is None else " / ".join(pair)
        bars = panel.barh(places, [min(v, END) for v in values], height, color=COLOURS[k], label=label)
        panel.bar_label(bars, [f"{v:.1f}" for v in values], padding=3, fontsize=8)
    panel.set_yticks(range(len(rows)), [name or "as it is" for name, _, _ in rows])
    panel.invert_yaxis()
    panel.axvline(plan.apart, color="#888888", linewidth=1, linestyle="--")
    panel.set(xlim=(0, END), xlabel="distance [standard deviations]")
    panel.grid(False, axis="y")
    legend(figure, panel)
    return figure
