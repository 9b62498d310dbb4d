"""Which experiments tell causes apart, before anything is measured: as plain data (JSON schema `gearheat.plan/2`)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Any, Literal

from pydantic import Field

from ..library.cause import Cause
from .design import WORTH, Design, Effects, Pair, gain
from .estimate import convert
from .findings import APART, Isolability
from .numbers import Model, Number

#: Experiments that are done together, at most.
TOGETHER = 3
#: The campaign tells the causes apart, one experiment does, several together do, none does; or they are one answer.
Verdict = Literal["apart", "one", "several", "none", "same"]


class PlannedCause(Model):
    """A cause to tell from others; `visible` is its distance from none at its usual size."""

    id: str
    size: str = Field(default="", description="name of its size")
    usual: Number
    unit: str = "1"
    visible: Number
    exposes: str = ""


class PlannedPair(Model):
    """Two causes, their distance, and why no experiment here tells them apart where none does."""

    causes: tuple[str, str]
    distance: Number
    one_answer: str | None = None


class Outlook(Model):
    """Experiments that are done, and the distances behind them."""

    class Pair(Model):
        """A pair of causes."""

        causes: tuple[str, str]
        before: Number
        after: Number

    experiments: tuple[str, ...] = Field(description="ids; none: the campaign as it is")
    smallest: Number
    nearest: tuple[str, str]
    gain: Number = 0.0
    separates: bool
    pairs: tuple[Pair, ...] = ()


class Planned(Model):
    """An experiment that was considered; `checks` are the instruments it checks."""

    id: str
    what: str
    checks: tuple[str, ...] = ()


class Plan(Model):
    """Result of `gearheat plan`; distances in standard deviations of what is read."""

    schema_: Literal["gearheat.plan/2"] = Field(default="gearheat.plan/2", alias="schema")
    rig: str
    campaign: str = ""
    readings: int = 0
    reference: bool = False
    apart: Number = APART
    verdict: Verdict | None = Field(default=None, description="absent where no causes were named")
    causes: tuple[PlannedCause, ...] = ()
    pairs: tuple[PlannedPair, ...] = ()
    now: Outlook | None = None
    catalogue: tuple[Planned, ...] = Field(default=(), description="the experiments")
    outlooks: tuple[Outlook, ...] = Field(default=(), description="single experiments, the best first")
    together: tuple[Outlook, ...] = Field(default=(), description="the best with a second and a third")
    isolability: tuple[Isolability, ...] = Field(default=(), description="all causes of the library with this design")
    warnings: tuple[str, ...] = ()

    def what(self, id: str) -> str:
        """An experiment in words."""
        return next((e.what for e in self.catalogue if e.id == id), id)

    @property
    def ids(self) -> list[str]:
        """The causes."""
        return [c.id for c in self.causes]


def rank_experiments(
    design: Design, names: Sequence[str], library: Mapping[str, Cause], common: Mapping[str, Any], visible: Effects
) -> Plan:
    """The plan with the experiments of a design, the best first.

    Args:
        design: of the campaign and all experiments
        names: causes to tell apart
        library: all causes by their ids; those of a class are one answer
        common: what a plan says without experiments
        visible: all causes in the campaign as it is
    """
    before = design.distances()
    pairs = [p if p in before else p[::-1] for p in combinations(names, 2)]
    same = {(a, b): library[a].like for a, b in pairs if library[a].like and library[a].like == library[b].like}
    reasons = {p: like.partition(":")[2].strip() or like for p, like in same.items()}
    apart = {p: before[p] for p in pairs if p not in same}  # else causes are one answer
    now = _look_ahead(design, apart) if apart else None
    single = _sort([_look_ahead(design, apart, e.id) for e in design.experiments]) if apart else []
    together = list(single[:1])
    while together and not together[-1].separates and len(together) < TOGETHER:
        last = together[-1]
        others = [e.id for e in design.experiments if e.id not in last.experiments]
        best = _sort([_look_ahead(design, apart, *last.experiments, other) for other in others])[0]
        if best.smallest < last.smallest + WORTH and best.gain < last.gain + WORTH:
            break
        together.append(best)
    sizes = {c.id: library[c.id].size for c in design.candidates}
    causes = []
    for n, s in sizes.items():
        unit, (usual,) = convert(s, [s.sd])
        seen, exposes = visible.visible(n), library[n].exposes
        causes.append(PlannedCause(id=n, size=s.name, usual=usual, unit=unit, visible=seen, exposes=exposes))
    return Plan(
        **common,
        verdict=decide(now, single, together),
        causes=tuple(causes),
        pairs=tuple(PlannedPair(causes=p, distance=apart.get(p, 0.0), one_answer=reasons.get(p)) for p in pairs),
        now=now,
        catalogue=tuple(
            Planned(id=e.id, what=e.what, checks=tuple(dict.fromkeys(c.sensor for c in e.checks)))
            for e in design.experiments
        ),
        outlooks=tuple(single),
        together=tuple(together),
    )


def _look_ahead(design: Design, apart: Mapping[Pair, float], *done: str) -> Outlook:
    """The distances behind some experiments, by their ids, and by those `apart` that there are now."""
    after = design.distances(*done) if done else apart
    nearest = min(apart, key=lambda p: after[p])
    return Outlook(
        experiments=done,
        smallest=after[nearest],
        nearest=nearest,
        gain=sum(gain(distance, after[p]) for p, distance in apart.items()),
        separates=after[nearest] >= APART,
        pairs=tuple(Outlook.Pair(causes=p, before=distance, after=after[p]) for p, distance in apart.items()),
    )


def _sort(outlooks: Sequence[Outlook]) -> list[Outlook]:
    """The best first: by the smallest distance, to a tenth; by the gain; as they are listed."""
    return sorted(outlooks, key=lambda o: (-round(o.smallest, 1), -round(o.gain, 3)))


def decide(now: Outlook | None, single: Sequence[Outlook], together: Sequence[Outlook]) -> Verdict:
    """One word: apart, one, several, none, or same for causes that are one answer."""
    if now is None:
        return "same"
    if now.separates:
        return "apart"
    if single and single[0].separates:
        return "one"
    return "several" if together and together[-1].separates else "none"
