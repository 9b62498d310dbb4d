"""What every run gives back: named columns over time or over steady points, with its energy audit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ..errors import ScenarioError, suggestion

#: A gearbox that is all but at rest is compared with this [J, W] instead of its throughput.
SMALLEST_THROUGHPUT = 1e-3


@dataclass(frozen=True)
class Outside:
    """A law used outside its range: where, which argument, the range and the values met (SI), and what reigns there."""

    component: str
    law: str
    argument: str
    low: float
    high: float
    lowest: float
    highest: float
    regime: str = ""


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

    def at(self, moment: float) -> dict[str, float]:
        """All columns at one time, linear between rows."""
        return {name: float(np.interp(moment, self.index, column)) for name, column in self.columns.items()}
