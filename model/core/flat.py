"""The flat model: a differential-algebraic system of index 1 with named quantities, and nothing of gears in it."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from ..errors import ScenarioError, suggestion
from ..sources import LawInfo
from ..units import text


@dataclass(frozen=True)
class Quantity:
    """One scalar of a model: path, SI unit, meaning, typical size, value when nothing else is given, and range.

    `refusal` says what a value outside the range means, see `Declaration`; `whole` that it is a number of things.
    """

    name: str
    unit: str
    doc: str
    nominal: float = 1.0
    start: float = 0.0
    low: float = -np.inf
    high: float = np.inf
    low_open: bool = False
    high_open: bool = False
    refusal: str = ""
    whole: bool = False

    def bound(self, value: float) -> tuple[str, float] | None:
        """The bound that a value does not keep, in words and in SI, or None."""
        if value <= self.low if self.low_open else value < self.low:
            return ("above" if self.low_open else "at least"), self.low
        if value >= self.high if self.high_open else value > self.high:
            return ("below" if self.high_open else "at most"), self.high
        return None

    def problem(self, value: float) -> str | None:
        """What is wrong with a value, or None."""
        if not np.isfinite(value):
            return f"{self.name} = {value} is not finite"
        if (broken := self.bound(value)) is None:
            return None
        words, number = broken
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{self.name} = {value:g}{unit} is out of range. It must be {words} {number:g}{unit}."


@dataclass(frozen=True)
class Check:
    """One argument of one law inside a model that has a range of validity."""

    component: str
    law: LawInfo
    argument: str
    low: float
    high: float


@dataclass(frozen=True)
class Relation:
    """What must hold between the parameters of a part: a value that follows from them, and where it must lie.

    Attributes:
        component: path of the part
        name: the relation in words, "a_w fits z_1, z_2, m_n, beta, x_1, x_2"
        value: what the value is, "clearance of neighbouring planets"
        remedy: what to do about it
        unit: of the value
        parameters: paths of the parameters it follows from
    """

    component: str
    name: str
    value: str
    low: float
    high: float
    remedy: str
    unit: str
    parameters: tuple[str, ...]

    def holds(self, value: float) -> bool:
        """Whether a value lies where it must; one that is not finite does not."""
        return bool(np.isfinite(value) and self.low <= value <= self.high)

    @property
    def bounds(self) -> str:
        """Where the value must lie, in words."""
        low, high = (text(v if abs(v) > 1e-300 else 0.0, self.unit, 4) for v in (self.low, self.high))
        if not np.isfinite(self.high):
            return f"at least {low}"
        return f"from {low} to {high}" if np.isfinite(self.low) else f"at most {high}"

    def problem(self, value: float, given: str) -> str:
        """What is wrong with a value.

        Args:
            value: of the relation's expression (SI)
            given: what the value follows from, in words
        """
        found = text(value, self.unit, 4) if np.isfinite(value) else "not defined"
        return f'"{self.name}" does not hold: {self.value} is {found}, expected {self.bounds} ({given}).\n{self.remedy}'


def find_broken(relations: Sequence[Relation], values: Sequence[float]) -> list[tuple[Relation, float]]:
    """The relations that do not hold; of a part where one has a value, not those that merely have none.

    Args:
        relations: the n relations of a model
        values: of their expressions (n), SI
    """
    found = [(r, float(v)) for r, v in zip(relations, values, strict=True) if not r.holds(float(v))]
    told = {r.component for r, v in found if np.isfinite(v)}
    return [(r, v) for r, v in found if np.isfinite(v) or r.component not in told]


@dataclass(frozen=True, eq=False)
class FlatModel:
    """dx/dt = ode(x, z, u, p), 0 = residual(x, z, u, p), y = y(x, z, u, p); all are CasADi SX columns.

    `algebraic` are the torn unknowns z of the implicit blocks, their `start` where an iteration begins. As many
    equations, named in `residual_names` and scaled to the size of z, hold at every moment. `supply` [W] is the power
    that crosses the model's boundary inwards, `throughput` [W] the sum of its magnitudes, `stored` [J] the energy of
    the states: `supply` is the time derivative of `stored`, always.

    A parameter that follows from others is none of `parameters` but an output; `derived` says what it follows from.
    `related` holds the values of the `relations` between parameters, a function of p alone. `joined` says which
    quantities are outputs because rigid couplings tie them to states ("rotor_2.w follows rotor_1.w"). `imbalance` [W]
    is the power that each of the parts `balanced` takes in and does not account for: zero in a sound part.
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
    balanced: tuple[str, ...] = ()
    imbalance: Any = field(default_factory=lambda: ca.SX(0, 1))
    derived: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    relations: tuple[Relation, ...] = ()
    related: Any = field(default_factory=lambda: ca.SX(0, 1))

    def __getstate__(self) -> dict[str, Any]:
        """The fields; expressions as one text, in which they keep their common symbols."""
        fields = {name: value for name, value in vars(self).items() if name in type(self).__dataclass_fields__}
        names = [name for name, value in fields.items() if isinstance(value, ca.SX)]
        packed = ca.StringSerializer()
        packed.pack([fields.pop(name) for name in names])
        return fields | {"names": names, "text": packed.encode()}

    def __setstate__(self, state: dict[str, Any]) -> None:
        names, packed = state.pop("names"), ca.StringDeserializer(state.pop("text"))
        vars(self).update(state, **dict(zip(names, packed.unpack(), strict=True)))

    @cached_property
    def index(self) -> Mapping[str, tuple[str, int]]:
        """Path -> (kind, position), kind one of "state", "input", "parameter", "output"."""
        return {q.name: (kind, i) for kind, group in self._groups.items() for i, q in enumerate(group)}

    @cached_property
    def bodies(self) -> tuple[str, ...]:
        """The states that are temperatures of bodies; a threshold that moves is none."""
        return tuple(q.name for q in self.states if q.unit == "K" and q.name.endswith(".T"))

    @cached_property
    def _groups(self) -> Mapping[str, tuple[Quantity, ...]]:
        """The quantities that have a path, by kind."""
        return {"state": self.states, "input": self.inputs, "parameter": self.parameters, "output": self.outputs}

    def quantity(self, name: str) -> Quantity:
        """The quantity of a path. Raises ScenarioError with suggestions for an unknown one."""
        kind, i = self.locate(name)
        return self._groups[kind][i]

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
        """CasADi function (x, z, u, p) -> (ode, y, residual, supply, throughput, stored, checked, imbalance)."""
        names = ["ode", "y", "residual", "supply", "throughput", "stored", "checked", "imbalance"]
        results = [getattr(self, name) for name in names]
        return ca.Function("model", self.point, results, ["x", "z", "u", "p"], names, {"cse": True})

    @cached_property
    def relation_function(self) -> Any:
        """CasADi function (p) -> (related,)."""
        return ca.Function(
            "relations_of", [self.p], [ca.densify(ca.SX(self.related))], ["p"], ["related"], {"cse": True}
        )

    def contradictions(self, p: np.ndarray) -> dict[Relation, str]:
        """The relations that do not hold between the values of all parameters, each with what is wrong."""
        if not self.relations:
            return {}
        values = [float(v) for v in self.relation_function(p).full().ravel()]
        return {r: f"{r.component}: {r.problem(v, self._spell(r, p))}" for r, v in find_broken(self.relations, values)}

    def _spell(self, relation: Relation, p: np.ndarray) -> str:
        places = [(name, self.index[name][1]) for name in relation.parameters if name in self.index]
        own = f"{relation.component}."
        return ", ".join(f"{n.removeprefix(own)} = {text(p[i], self.parameters[i].unit, 6)}" for n, i in places)

    def holding(self, names: Collection[str]) -> FlatModel:
        """The same with some of its inputs as parameters, which are what they start at."""
        held = [i for i, q in enumerate(self.inputs) if q.name in names]
        free = [i for i in range(len(self.inputs)) if i not in held]
        return replace(
            self,
            inputs=tuple(self.inputs[i] for i in free),
            parameters=(*self.parameters, *(self.inputs[i] for i in held)),
            u=self.u[free],
            p=ca.vertcat(self.p, self.u[held]),
        )

    def starts(self, kind: str) -> np.ndarray:
        """Default values of all states, algebraic variables, inputs or parameters, in order."""
        return np.array([q.start for q in (self.algebraic if kind == "algebraic" else self._groups[kind])])
