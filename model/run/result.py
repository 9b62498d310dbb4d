"""What every run gives back: named columns over time or over steady points, with its energy audit.

It is judged by outputs in their ranges, implicit equations that hold, and energy that is conserved.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from ..core.flat import FlatModel
from ..errors import ScenarioError, suggestion
from ..units import text

#: A gearbox that is all but at rest is compared with this [J, W] instead of its throughput.
SMALLEST_THROUGHPUT = 1e-3
#: Round-off allowed at the ends of a range, relative to value and nominal.
SLACK = 1e-9

#: Violation of the energy balance that is an error, over the throughput.
ENERGY = 1e-6
#: The same over the tolerance of an integration, where that is more: errors of its steps add up.
ENERGY_BY_TOLERANCE = 100.0

#: What an implicit equation may leave, in units of its variable's nominal.
LEFT = 1e-6


#: How far beyond the end of its range a law is only noted, over that end, or over the range where that is less.
NOTED = 0.2


@dataclass(frozen=True)
class Outside:
    """A law used outside its range: where, which argument, the range and the values met (SI), and what reigns there.

    `last` is the last row at which it is.
    """

    component: str
    law: str
    argument: str
    low: float
    high: float
    lowest: float
    highest: float
    regime: str = ""
    last: int = 0

    @property
    def far(self) -> bool:
        """Whether values lie far from the range."""
        beyond = ((self.low, self.low - self.lowest), (self.high, self.highest - self.high))
        width = self.high - self.low
        return any(over > NOTED * (min(abs(end), width) or width) for end, over in beyond)


@dataclass(frozen=True)
class Audit:
    """Energy over a run [J]: what came in, what the states gained, and the throughput to compare with.

    For steady points the same in watts: the power balance at the solution, where nothing is gained. `held` is the
    largest energy the states held; a thousandth of it stands in for the throughput of a model that is all but closed.
    """

    supplied: float
    gained: float
    throughput: float
    held: float = 0.0

    @property
    def residual(self) -> float:
        """Violation of the energy balance relative to the throughput."""
        return abs(self.supplied - self.gained) / max(self.throughput, 1e-3 * self.held, SMALLEST_THROUGHPUT)


@dataclass(frozen=True)
class Result:
    """A transient, a table of steady points, or an FMU's run: one row per time or point, SI.

    `index` is the time [s] of a transient, where a time given twice is a jump, or the number of a point; `units` holds
    the SI unit of each column. `laws` names the laws at work with source and place. `implicit` holds the largest
    residual that each implicit equation left, relative to its typical size.
    """

    model: str
    kind: str
    index: np.ndarray
    columns: Mapping[str, np.ndarray]
    units: Mapping[str, str]
    audit: Audit
    outside: tuple[Outside, ...] = ()
    laws: tuple[str, ...] = ()
    implicit: Mapping[str, float] = field(default_factory=dict)

    def __getitem__(self, name: str) -> np.ndarray:
        """A column by path. Raises ScenarioError with suggestions for an unknown one."""
        if name not in self.columns:
            raise ScenarioError(f'{self.model}: the result has no "{name}".{suggestion(name, self.columns)}')
        return self.columns[name]

    def __iter__(self) -> Iterator[str]:
        """Paths of its columns."""
        return iter(self.columns)

    def at(self, moment: float) -> dict[str, float]:
        """All columns at one time, linear between rows."""
        return {name: float(np.interp(moment, self.index, column)) for name, column in self.columns.items()}


def out_of_range(flat: FlatModel, columns: Mapping[str, np.ndarray]) -> Iterator[str]:
    """What is wrong with the outputs that leave their declared range, the worst row of each, in words.

    Args:
        flat: the model
        columns: path of an output -> its values over the rows, SI
    """
    for q in flat.outputs:
        values = columns[q.name]
        slack = SLACK * (q.nominal + np.abs(values))
        excess = np.maximum(q.low - values, values - q.high)
        row = int(np.argmax(np.where(np.isnan(excess), np.inf, excess)))
        if excess[row] <= slack[row]:
            continue
        part = q.name.rpartition(".")[0]
        if q.refusal:
            at_worst = np.array([columns[o.name][row] for o in flat.outputs])
            yield f"{part}: {q.refusal.format(**words(flat, part, at_worst))}"
        else:
            yield str(q.problem(float(values[row])))


def words(flat: FlatModel, part: str, y: np.ndarray, digits: int = 6) -> dict[str, str]:
    """The outputs of a part as a person reads them, by key.

    Args:
        flat: the model
        part: path of the part
        y: all outputs of the model at one point, SI
        digits: significant digits to write
    """
    of_part = [(q, value) for q, value in zip(flat.outputs, y, strict=True) if q.name.rpartition(".")[0] == part]
    return {q.name.rpartition(".")[2]: text(float(value), q.unit, digits) for q, value in of_part}


def outside(flat: FlatModel, evaluated: Mapping[str, np.ndarray]) -> tuple[Outside, ...]:
    """The arguments of laws that left their range over the rows, uses of one law in one part taken together.

    Args:
        flat: the model
        evaluated: what `evaluate` found
    """
    found: dict[tuple[str, str, str], Outside] = {}
    for check, values in zip(flat.checks, evaluated["checked"], strict=True):
        lowest, highest = float(np.min(values)), float(np.max(values))
        slack = SLACK * max(abs(lowest), abs(highest))
        if lowest >= check.low - slack and highest <= check.high + slack:
            continue
        key = (check.component, check.law.name, check.argument)
        if (other := found.get(key)) is not None:
            lowest, highest = min(lowest, other.lowest), max(highest, other.highest)
        beyond = np.maximum(check.low - values, values - check.high)
        last = max(int(np.nonzero(beyond > slack)[-1].max()), other.last if other else 0)
        regime = check.law.regimes.get(check.argument, "")
        if regime:
            worst = int(np.argmax(beyond))
            regime = regime.format(**words(flat, check.component, evaluated["y"][:, worst], digits=3))
        found[key] = Outside(*key, check.low, check.high, lowest, highest, regime, last)
    return tuple(found.values())


def list_unsolved(implicit: Mapping[str, float]) -> Iterator[str]:
    """The implicit equations that do not hold, in words, by the largest scaled residual of each."""
    for name, residual in implicit.items():
        if not residual <= LEFT:
            yield f'the equation "{name}" leaves {residual:.2g} of its typical size. Check the values of that part.'


def imbalance(
    flat: FlatModel, evaluated: Mapping[str, np.ndarray], audit: Audit, tolerance: float = 0.0
) -> Iterator[str]:
    """What is wrong with the energy of a run, in words: the part that makes or loses most of it.

    Args:
        flat: the model
        evaluated: what `rows.evaluate` found
        audit: energy of the whole run
        tolerance: of the integration
    """
    if audit.residual <= max(ENERGY, ENERGY_BY_TOLERANCE * tolerance):
        return
    who = "no part makes or loses power, so the integration does: use a tighter tolerance"
    power = evaluated["imbalance"]
    if power.size:
        worst, row = np.unravel_index(int(np.nanargmax(np.abs(power))), power.shape)
        made = float(power[worst, row])
        if abs(made) > ENERGY * max(float(evaluated["throughput"][0, row]), 1e-3):
            does = "takes in" if made > 0 else "gives off"
            who = f"{flat.balanced[worst]} {does} {abs(made):.4g} W more than it accounts for"
    yield f"energy is not conserved: {audit.residual:.2g} of the throughput is missing; {who}."
