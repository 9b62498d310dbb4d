"""Which experiments tell causes apart, before anything is measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

from .design import Design, Pair, gain
from .experiments import Experiment
from .sets import APART

#: Experiments that are done together, at most.
TOGETHER = 3
#: What another one has to add to the smallest distance or to all.
WORTH = 0.1


@dataclass(frozen=True)
class Outlook:
    """Some experiments, the distance of each pair of causes behind them, and the smallest of those that count."""

    experiments: tuple[Experiment, ...]
    after: Mapping[Pair, float]
    nearest: Pair
    smallest: float
    gain: float

    @property
    def separates(self) -> bool:
        """Whether all pairs that count are told apart."""
        return self.smallest >= APART


class Planner:
    """Ranks the experiments of a design.

    Args:
        design: of the campaign and all experiments
        causes: to tell apart
        like: cause -> its class and why; causes of a class are one answer
    """

    def __init__(self, design: Design, causes: Sequence[str], like: Mapping[str, str]) -> None:
        self.design, self.before = design, design.distances()
        self.pairs = [p if p in self.before else p[::-1] for p in combinations(causes, 2)]
        self.same = {p: like[p[0]] for p in self.pairs if like[p[0]] and like[p[0]] == like[p[1]]}
        self.open = [p for p in self.pairs if p not in self.same]

    @property
    def now(self) -> Outlook | None:
        """The campaign as it is; None where all causes are one answer."""
        return self._outlook(()) if self.open else None

    def single(self) -> list[Outlook]:
        """Single experiments, the best first."""
        return self._ranked([self._outlook((e,)) for e in self.design.experiments]) if self.open else []

    def together(self, single: Sequence[Outlook]) -> list[Outlook]:
        """The best experiment, with another one as long as that is needed and helps."""
        found = list(single[:1])
        while found and not found[-1].separates and len(found) < TOGETHER:
            done = found[-1].experiments
            others = [e for e in self.design.experiments if e not in done]
            best = self._ranked([self._outlook((*done, e)) for e in others])[0]
            if best.smallest < found[-1].smallest + WORTH and best.gain < found[-1].gain + WORTH:
                break
            found.append(best)
        return found

    def _outlook(self, experiments: tuple[Experiment, ...]) -> Outlook:
        after = self.design.distances(*(e.id for e in experiments)) if experiments else self.before
        nearest = min(self.open, key=lambda p: after[p])
        gained = sum(gain(self.before[p], after[p]) for p in self.open)
        return Outlook(experiments, after, nearest, after[nearest], gained)

    def _ranked(self, outlooks: Sequence[Outlook]) -> list[Outlook]:
        """The best first: by the smallest distance, to a tenth; by the gain; as they are listed."""
        return sorted(outlooks, key=lambda o: (-round(o.smallest, 1), -round(o.gain, 3)))


def verdict(now: Outlook | None, single: Sequence[Outlook], together: Sequence[Outlook]) -> str:
    """One word: apart, one, several, none, or same for causes that are one answer."""
    if now is None:
        return "same"
    if now.separates:
        return "apart"
    if single and single[0].separates:
        return "one"
    return "several" if together and together[-1].separates else "none"
