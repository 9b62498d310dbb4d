"""The flat model: a differential-algebraic system of index 1 with named quantities, and nothing of gears in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from ..errors import ScenarioError, suggestion
from ..sources import LawInfo


@dataclass(frozen=True)
class Quantity:
    """One scalar of a model: path, SI unit, meaning, typical size, value when nothing else is given, and range."""

    name: str
    unit: str
    doc: str
    nominal: float = 1.0
    start: float = 0.0
    low: float = -np.inf
    high: float = np.inf
    low_open: bool = False
    high_open: bool = False

    def problem(self, value: float) -> str | None:
        """What is wrong with a value, or None."""
        if not np.isfinite(value):
            return f"{self.name} = {value} is not finite"
        if value <= self.low if self.low_open else value < self.low:
            bound = f"{'above' if self.low_open else 'at least'} {self.low:g}"
        elif value >= self.high if self.high_open else value > self.high:
            bound = f"{'below' if self.high_open else 'at most'} {self.high:g}"
        else:
            return None
        return f"{self.name} = {value:g} {self.unit} is out of range. It must be {bound} {self.unit}."


@dataclass(frozen=True)
class Check:
    """One argument of one law inside a model that has a range of validity."""

    component: str
    law: LawInfo
    argument: str
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class FlatModel:
    """dx/dt = ode(x, z, u, p), 0 = residual(x, z, u, p), y = y(x, z, u, p); all are CasADi SX columns.

    `algebraic` are the torn unknowns z of the implicit blocks, their `start` where an iteration begins. As many
    equations, named in `residual_names` and scaled to the size of z, hold at every moment. `supply` [W] is the power
    that crosses the model's boundary inwards, `throughput` [W] the sum of its magnitudes, `stored` [J] the energy of
    the states: `supply` is the time derivative of `stored`, always. `joined` says which quantities are outputs because
    rigid couplings tie them to states ("rotor_2.w follows rotor_1.w").
    """

    name: str
    doc: str
    states: tuple[Quantity, ...]
    inputs: tuple[Quantity, ...]
    parameters: tuple[Quantity, ...]
    outputs: tuple[Quantity, ...]
    x: Any
    u: Any
    p: Any
    ode: Any
    y: Any
    residual: Any
    residual_names: tuple[str, ...]
    supply: Any
    throughput: Any
    stored: Any
    checks: tuple[Check, ...]
    checked: Any
    laws: tuple[LawInfo, ...]
    algebraic: tuple[Quantity, ...] = ()
    z: Any = field(default_factory=lambda: ca.SX(0, 1))
    joined: tuple[str, ...] = ()

    @cached_property
    def index(self) -> Mapping[str, tuple[str, int]]:
        """Path -> (kind, position), kind one of "state", "input", "parameter", "output"."""
        groups = {"state": self.states, "input": self.inputs, "parameter": self.parameters, "output": self.outputs}
        return {q.name: (kind, i) for kind, group in groups.items() for i, q in enumerate(group)}

    def quantity(self, name: str) -> Quantity:
        """The quantity of a path. Raises ScenarioError with suggestions for an unknown one."""
        kind, i = self.locate(name)
        return {"state": self.states, "input": self.inputs, "parameter": self.parameters, "output": self.outputs}[kind][
            i
        ]

    def locate(self, name: str) -> tuple[str, int]:
        """Kind and position of a path. Raises ScenarioError with suggestions for an unknown one."""
        try:
            return self.index[name]
        except KeyError:
            raise ScenarioError(f'{self.name}: unknown name "{name}".{suggestion(name, self.index)}') from None

    @property
    def point(self) -> list[Any]:
        """What every expression is a function of: x, z, u, p."""
        return [self.x, self.z, self.u, self.p]

    @cached_property
    def function(self) -> Any:
        """CasADi function (x, z, u, p) -> (ode, y, residual, supply, throughput, stored, checked)."""
        names = ["ode", "y", "residual", "supply", "throughput", "stored", "checked"]
        results = [getattr(self, name) for name in names]
        return ca.Function("model", self.point, results, ["x", "z", "u", "p"], names, {"cse": True})

    def starts(self, kind: str) -> np.ndarray:
        """Default values of all states, algebraic variables, inputs or parameters, in order."""
        groups = {"state": self.states, "algebraic": self.algebraic, "input": self.inputs, "parameter": self.parameters}
        group = groups[kind]
        return np.array([q.start for q in group])
