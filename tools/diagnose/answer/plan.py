"""Which experiments tell causes apart, before anything is measured: as plain data (JSON schema `gearheat.plan/2`)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import combinations
from typing import Any, Literal

from pydantic import Field

from ..library.cause import Cause
from .design import APART, WORTH, Design, Pair, gain
from .findings import Isolability
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
    """An experiment that was considered: `tests` hold its inputs, `checks` the instruments it checks."""

    id: str
    what: str
    tests: tuple[dict[str, Number], ...] = ()
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


class Planner:
    """Ranks the experiments of a design.

    Args:
        design: of the campaign and all experiments
        names: causes to tell apart
        library: all causes by their ids; those of a class are one answer
    """

    def __init__(self, design: Design, names: Sequence[str], library: Mapping[str, Cause]) -> None:
        self.design, self.before, self.library = design, design.distances(), library
        self.pairs = [p if p in self.before else p[::-1] for p in combinations(names, 2)]
        like = {name: library[name].like for name in names}
        self.same = {p: like[p[0]] for p in self.pairs if like[p[0]] and like[p[0]] == like[p[1]]}
        self.open = [p for p in self.pairs if p not in self.same]

    def plan(self, common: Mapping[str, Any], visible: Callable[[str], float]) -> Plan:
        """The plan with experiments.

        Args:
            common: what a plan says without them
            visible: distance of a cause from none
        """
        now = self._outlook() if self.open else None  # else all causes are one answer
        single = self._ranked([self._outlook(e.id) for e in self.design.experiments]) if self.open else []
        together = self._together(single)
        return Plan(
            **common,
            verdict=verdict(now, single, together),
            causes=tuple(self._cause(self.library[name], visible(name)) for name in self.design.seen().places),
            pairs=tuple(self._pair(p) for p in self.pairs),
            now=now,
            catalogue=tuple(
                Planned(id=e.id, what=e.what, checks=tuple(dict.fromkeys(c.sensor for c in e.checks)))
                for e in self.design.experiments
            ),
            outlooks=tuple(single),
            together=tuple(together),
        )

    def _cause(self, cause: Cause, visible: float) -> PlannedCause:
        size = cause.size
        return PlannedCause(
            id=cause.id, size=size.name, usual=size.sd, unit=size.unit, visible=visible, exposes=cause.exposes
        )

    def _pair(self, p: Pair) -> PlannedPair:
        if p not in self.same:
            return PlannedPair(causes=p, distance=self.before[p])
        return PlannedPair(causes=p, distance=0.0, one_answer=self.same[p].partition(":")[2].strip() or self.same[p])

    def _together(self, single: Sequence[Outlook]) -> list[Outlook]:
        """The best experiment, with another one as long as that is needed and helps."""
        found = list(single[:1])
        while found and not found[-1].separates and len(found) < TOGETHER:
            done = found[-1].experiments
            others = [e.id for e in self.design.experiments if e.id not in done]
            best = self._ranked([self._outlook(*done, other) for other in others])[0]
            if best.smallest < found[-1].smallest + WORTH and best.gain < found[-1].gain + WORTH:
                break
            found.append(best)
        return found

    def _outlook(self, *done: str) -> Outlook:
        after = self.design.distances(*done) if done else self.before
        nearest = min(self.open, key=lambda p: after[p])
        return Outlook(
            experiments=done,
            smallest=after[nearest],
            nearest=nearest,
            gain=sum(gain(self.before[p], after[p]) for p in self.open),
            separates=after[nearest] >= APART,
            pairs=tuple(Outlook.Pair(causes=p, before=self.before[p], after=after[p]) for p in self.open),
        )

    def _ranked(self, outlooks: Sequence[Outlook]) -> list[Outlook]:
        """The best first: by the smallest distance, to a tenth; by the gain; as they are listed."""
        return sorted(outlooks, key=lambda o: (-round(o.smallest, 1), -round(o.gain, 3)))


def verdict(now: Outlook | None, single: Sequence[Outlook], together: Sequence[Outlook]) -> Verdict:
    """One word: apart, one, several, none, or same for causes that are one answer."""
    if now is None:
        return "same"
    if now.separates:
        return "apart"
    if single and single[0].separates:
        return "one"
    return "several" if together and together[-1].separates else "none"
