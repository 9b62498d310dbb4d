"""What the diagnosis answers to a campaign with something hidden in it, and whether that is right."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from diagnose.hidden.maker import Case
from gearheat.tools.diagnose.answer.decide import calmed, decided
from gearheat.tools.diagnose.answer.quality import gross_readings
from gearheat.tools.diagnose.infer.search import searched
from gearheat.tools.diagnose.report.compose import hypotheses
from gearheat.tools.diagnose.request import Request, read
from gearheat.tools.diagnose.setting import setting

#: Share of the probability that a set of answers holds.
SET = 0.9
#: Causes that count as one answer.
CLASSES = (
    {"losses.bearing_preload", "losses.seal_drag"},
    {"losses.churning", "losses.windage", "losses.oil_level"},
    {"procedure.day_scatter", "cooling.humidity"},
    {"cooling.air", "cooling.fan"},
)


@dataclass(frozen=True)
class Score:
    """One answer.

    Args:
        first: causes of the most probable hypothesis
        probability, error: of it, and its Monte-Carlo error
        found: whether it is the hidden cause alone
        held: whether the hidden cause is in the set of answers that hold 90 %
        size: number of hypotheses in that set
        alarm: whether the verdict says that something is wrong
        gross: readings that are called wrong: row (from 1), sensor
        seconds: of processor time
    """

    first: tuple[str, ...]
    probability: float
    error: float
    found: bool
    held: bool
    size: int
    alarm: bool
    verdict: str
    p: float
    gross: tuple[tuple[int, str], ...]
    seconds: float

    @property
    def line(self) -> str:
        """In one line."""
        answer = " + ".join(self.first) or "nothing"
        right = "first" if self.found else "in set" if self.held else "MISSED"
        wrong = "".join(f", row {row} {sensor}" for row, sensor in self.gross)
        return (
            f"{right:7} {answer} {self.probability:.2f} +- {self.error:.2f} ({self.size} in set), {self.verdict}, "
            f"p {self.p:.2g}{wrong}, {self.seconds:.1f} s"
        )


def score(case: Case, seed: int = 0) -> Score:
    """Diagnose a campaign and compare with what is hidden in it.

    It is what `gearheat.tools.diagnose.diagnose` does, without gain and pictures, which cost more than the search.

    Args:
        case: the campaign
        seed: of the diagnosis
    """
    begin = time.process_time()
    inputs = read(Request(case.bench.rig, case.data, card=case.card, seed=seed))
    assert inputs.data is not None
    made = setting(inputs.scenario, inputs.card, inputs.data)
    found = calmed(searched(made.problem, made.formulas, seed=seed))
    decision = decided(found)
    seconds = time.process_time() - begin
    truth = case.truth["causes"]
    assert isinstance(truth, list)
    held = shortest(hypotheses(decision))
    first = held[0]
    alarm = decision.verdict != "consistent"
    return Score(
        tuple(first.causes),
        first.probability,
        first.mc_error,
        alarm == bool(truth) and alike(first.causes, truth),
        alarm == bool(truth) and any(alike(h.causes, truth) for h in held),
        len(held),
        alarm,
        decision.verdict,
        decision.p_any,
        tuple((g.row + 1, g.sensor) for g in gross_readings(found, decision.leader)),
        seconds,
    )


def shortest(hypotheses: Sequence[Any]) -> list[Any]:
    """The most probable hypotheses that hold `SET` together."""
    ranked = sorted(hypotheses, key=lambda h: -h.probability)
    held, total = [], 0.0
    for hypothesis in ranked:
        held.append(hypothesis)
        total += hypothesis.probability
        if total >= SET:
            break
    return held


def alike(causes: Sequence[str], truth: Sequence[str]) -> bool:
    """Whether an answer is the truth, members of a class counted as one; a probe's step is a form of its offset."""
    return sorted(map(_class, causes)) == sorted(map(_class, truth))


def _class(cause: str) -> str:
    for number, members in enumerate(CLASSES):
        if cause in members:
            return f"class {number}"
    kind, _, what = cause.rpartition(".")
    return f"{kind}.offset" if kind.startswith("sensor.") and what in ("since", "step", "bias") else cause
