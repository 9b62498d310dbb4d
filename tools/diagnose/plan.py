"""Which experiments would tell causes apart on a rig: the question of a design, before anything is measured."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ..effects.taxonomy import CAUSES
from .campaign_model import CampaignModel, Rig
from .candidates import Candidate, candidates
from .design import FOLLOWED, Design, Pair, visible
from .enlarged import answered
from .experiments import gain
from .family import FORMS, Sample
from .nuisance import Parameters
from .plan_inputs import PlanInputs
from .problem import Campaigned, Problem

#: Standard deviations from which two causes are told apart.
APART = 3.0
#: Experiments that are done together, at most; what another one has to add to the smallest distance or to all.
TOGETHER, WORTH = 3, 0.1


@dataclass(frozen=True)
class Outlook:
    """Some experiments and the distance of each pair of causes behind them, the smallest of those that count."""

    experiments: tuple[Candidate, ...]
    after: Mapping[Pair, float]
    nearest: Pair
    smallest: float
    gain: float

    @property
    def separates(self) -> bool:
        """Whether all pairs that count are told apart."""
        return self.smallest >= APART


@dataclass(frozen=True)
class Plan:
    """What tells some causes apart.

    Args:
        inputs: what it is about
        visible: cause -> its distance from none as the campaign is
        now: the campaign as it is; None where no pair of causes can be told apart by these experiments
        one_answer: pairs that no experiment here tells apart -> why
        outlooks: single experiments, the best first
        together: the best one, with a second and a third one as long as they are needed and help
    """

    inputs: PlanInputs
    visible: Mapping[str, float]
    distances: Mapping[Pair, float]
    one_answer: Mapping[Pair, str]
    now: Outlook | None
    outlooks: tuple[Outlook, ...]
    together: tuple[Outlook, ...]

    @property
    def verdict(self) -> str:
        """One word: apart, one, several, none, or same for causes that are one answer."""
        if self.now is None:
            return "same"
        if self.now.separates:
            return "apart"
        if self.outlooks[0].separates:
            return "one"
        return "several" if self.together[-1].separates else "none"


def planned(inputs: PlanInputs, progress: Callable[[str], None] = lambda stage: None) -> Plan:
    """Simulate the campaign and all experiments, and rank them.

    Raises:
        SolveError: the model cannot be run at the points
    """
    progress("compiling the rig")
    problem = nominal(inputs)
    progress("simulating the campaign, its experiments and the causes in both")
    samples = [Sample.of_prior(CAUSES[c], FORMS) for c in inputs.causes]
    z = np.zeros(len(problem.parameters.names))
    design = Design.of(problem, z, candidates(problem.data.model), samples)
    return plan_from(inputs, design)


def nominal(inputs: PlanInputs) -> Problem:
    """The rig as the model says, at the points, with a healthy reference of the same points if there is one."""
    rig = Rig(inputs.scenario.spec)
    campaign = answered(rig, inputs.campaign, inputs.oils, {})
    model = CampaignModel(rig, campaign, inputs.oils)
    campaigns = [Campaigned.of(model, acting=True)]
    if inputs.reference:
        campaigns.append(Campaigned.of(model, acting=False))
    return Problem(rig, campaigns, inputs.card, Parameters.of(rig.base, inputs.card, wide=inputs.reference))


def plan_from(inputs: PlanInputs, design: Design) -> Plan:
    """The plan for the causes of the inputs, from a design that holds them."""
    return _Planner(inputs, design).plan()


class _Planner:
    """Ranks the experiments of one design; nothing of it outlives the ranking."""

    def __init__(self, inputs: PlanInputs, design: Design) -> None:
        self.inputs, self.design = inputs, design
        self.pairs = list(combinations(inputs.causes, 2))
        self.same = {p: CAUSES[p[0]].like for p in self.pairs if self._never(p)}
        self.open = [p for p in self.pairs if p not in self.same]

    def plan(self) -> Plan:
        """Everything."""
        before = self.design.distances()
        seen = {name: visible(cause) for name, cause in self.design.seen().items()}
        if not self.open:
            return Plan(self.inputs, seen, self._counted(before, ()), self.same, None, (), ())
        now = self._outlook((), before)
        outlooks = self._ranked([self._outlook((e,), now.after) for e in self.design.experiments])
        return Plan(self.inputs, seen, now.after, self.same, now, tuple(outlooks), tuple(self._together(outlooks, now)))

    def _together(self, outlooks: Sequence[Outlook], now: Outlook) -> list[Outlook]:
        """The best experiment, with another one as long as that is needed and helps."""
        found = [outlooks[0]]
        while not found[-1].separates and len(found) < TOGETHER:
            done = found[-1].experiments
            others = [e for e in self.design.experiments if e not in done]
            best = self._ranked([self._outlook((*done, e), now.after) for e in others])[0]
            if best.smallest < found[-1].smallest + WORTH and best.gain < found[-1].gain + WORTH:
                break
            found.append(best)
        return found

    def _outlook(self, experiments: tuple[Candidate, ...], before: Mapping[Pair, float]) -> Outlook:
        names = tuple(e.id for e in experiments)
        after = self._counted(self.design.distances(*names), names)
        nearest = min(self.open, key=lambda p: after[p])
        gained = sum(gain(before[p], after[p]) for p in self.open) if experiments else 0.0
        return Outlook(experiments, after, nearest, after[nearest], gained)

    def _ranked(self, outlooks: Sequence[Outlook]) -> list[Outlook]:
        """The best first: by the smallest distance, to a tenth; by the gain; as they are listed."""
        return sorted(outlooks, key=lambda o: (-round(o.smallest, 1), -round(o.gain, 3)))

    def _counted(self, distances: Mapping[Pair, float], done: tuple[str, ...]) -> dict[Pair, float]:
        """Distances, zero between causes that are one answer whatever their forms may show."""
        return {p: 0.0 if self._alike(p, done) else d for p, d in distances.items()}

    def _alike(self, pair: Pair, done: tuple[str, ...]) -> bool:
        """Whether two causes are of one class that the experiments done do not take apart."""
        like = CAUSES[pair[0]].like
        taken = FOLLOWED in pair and (not self.design.blind or bool(self.design.followed & set(done)))
        return bool(like) and like == CAUSES[pair[1]].like and not taken

    def _never(self, pair: Pair) -> bool:
        return all(self._alike(pair, (e.id,)) for e in self.design.experiments)
