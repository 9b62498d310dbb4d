"""The flat model: an explicit ordinary differential equation with named quantities, and nothing of gears in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
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


@dataclass(frozen=True)
class FlatModel:
    """dx/dt = ode(x, u, p), y = y(x, u, p); all vectors are CasADi SX columns in the order of their quantities.

    `residual` holds what the implicit blocks leave after their Newton steps (scaled by nominals), named in
    `residual_names`. `supply` [W] is the power that crosses the model's boundary inwards, `throughput` [W] the sum of
    its magnitudes, `stored` [J] the energy of the states: `supply` is the time derivative of `stored`, always. `joined`
    says which quantities are outputs because rigid couplings tie them to states ("rotor_2.w follows rotor_1.w").
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

    @cached_property
    def ode_function(self) -> Any:
        """CasADi function (x, u, p) -> (ode,)."""
        return ca.Function("ode", [self.x, self.u, self.p], [self.ode], ["x", "u", "p"], ["ode"], {"cse": True})

    @cached_property
    def output_function(self) -> Any:
        """CasADi function (x, u, p) -> (y, residual, supply, throughput, stored, checked)."""
        return ca.Function(
            "outputs",
            [self.x, self.u, self.p],
            [self.y, self.residual, self.supply, self.throughput, self.stored, self.checked],
            ["x", "u", "p"],
            ["y", "residual", "supply", "throughput", "stored", "checked"],
            {"cse": True},
        )

    @cached_property
    def prepared(self) -> dict[str, Any]:
        """What runs have compiled of this model, by name, so that it is compiled once."""
        return {}

    def starts(self, kind: str) -> np.ndarray:
        """Default values of all states, inputs or parameters, in order."""
        group = {"state": self.states, "input": self.inputs, "parameter": self.parameters}[kind]
        return np.array([q.start for q in group])
