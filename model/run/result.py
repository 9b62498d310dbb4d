"""What every run gives back: named columns over time or over steady points, with its energy audit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ..errors import ScenarioError, suggestion


@dataclass(frozen=True)
class Outside:
    """A law used outside its range: where, which argument, the range and the values met (SI)."""

    component: str
    law: str
    argument: str
    low: float
    high: float
    lowest: float
    highest: float


@dataclass(frozen=True)
class Audit:
    """Energy over a run [J]: what came in, what the states gained, and the throughput to compare with.

    `residual` is |supplied - gained| / throughput; for steady points it is the power balance at the solution.
    """

    supplied: float
    gained: float
    throughput: float

    @property
    def residual(self) -> float:
        """Relative violation of the energy balance."""
        return abs(self.supplied - self.gained) / max(self.throughput, 1e-9)


@dataclass(frozen=True)
class Result:
    """A transient, a table of steady points, or an FMU's run: one row per time or point, SI.

    `index` is the time [s] of a transient or the number of a point; `units` holds the SI unit of each column.
    """

    model: str
    kind: str
    index: np.ndarray
    columns: Mapping[str, np.ndarray]
    units: Mapping[str, str]
    audit: Audit
    outside: tuple[Outside, ...] = ()
    laws: tuple[str, ...] = field(default=())

    def __getitem__(self, name: str) -> np.ndarray:
        """A column by path. Raises ScenarioError with suggestions for an unknown one."""
        if name not in self.columns:
            raise ScenarioError(f'{self.model}: the result has no "{name}".{suggestion(name, self.columns)}')
        return self.columns[name]

    def at(self, moment: float) -> dict[str, float]:
        """All columns at one time, linear between rows."""
        return {name: float(np.interp(moment, self.index, column)) for name, column in self.columns.items()}
