"""Components: declarations followed by named equations."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf, nextafter
from typing import Any, ClassVar
from weakref import WeakValueDictionary

import casadi as ca
import numpy as np

from ..errors import ScenarioError, suggestion
from ..expressions import as_expression
from ..sources import LawUse, recording
from ..units import text
from .declare import Choice, Declaration, Given, Input, Output, Parameter, Port, State, Variable, list_declared
from .flat import Relation, find_broken


@dataclass(frozen=True, eq=False)
class Equation:
    """Two sides that are equal; which of their symbols it determines is found by flattening."""

    name: str
    lhs: Any
    rhs: Any

    @cached_property
    def residual(self) -> Any:
        """lhs - rhs."""
        return self.lhs - self.rhs


@dataclass(frozen=True, eq=False)
class Balance(Equation):
    """Terms whose sum is zero, which any one of them follows from.

    Args:
        terms: symbols (SX, 1 each)
    """

    terms: tuple[Any, ...]

    @classmethod
    def of(cls, name: str, terms: Iterable[Any]) -> Balance:
        """The balance of some terms.

        Args:
            name: what it says
            terms: symbols (SX, 1 each)
        """
        terms = tuple(terms)
        return cls(name, sum(terms, ca.SX(0)), ca.SX(0), terms)

    def rest(self, term: Any) -> Any:
        """What one of the terms (SX, 1), of which each occurs once, is by the others."""
        own = term.element_hash()
        return -sum((other for other in self.terms if other.element_hash() != own), ca.SX(0))


#: Identifier of a cause -> parameters of a part that carry it, with the exponent of the cause's factor in each.
Faults = Mapping[str, Mapping[str, float]]
#: Of a part that is what it is: nothing of it can fail.
SOUND: Faults = {}

#: A relation and the expression of the value that tells whether it holds.
Related = tuple[Relation, Any]


def equation(name: str, lhs: Any, rhs: Any) -> Equation:
    """A named, unordered equation.

    Args:
        name: what it says, unique within its part
        lhs: one side: a number or a CasADi expression
        rhs: the other side
    """
    return Equation(name, *map(as_expression, (lhs, rhs)))


class Component:
    """Base of all parts. Constructed with its path name and the SI values of what it declares; frozen from then on.

    Args:
        name: path of the component in the model, for example "oil"
        values: parameters and choices, and start values of states and inputs, by name

    Attributes:
        role: what the part is to whoever looks for parts by what they do ("teeth", "bearing", "surface"); "" for none
        scale: parameters of which a common factor is one on what the part does: its loss, conductance or capacity
        faults: causes by which it may fail, by their identifiers, each with the parameters that carry it and their
            exponents, {} where the cause acts beside the part; None for those of its role
        axes: how the shafts lie that it joins: "coaxial", "parallel", "intersecting" or "crossed"; "same" where
            its first and last flange are one shaft seen from two frames
        told: names of the values that it is constructed with

    Raises:
        ScenarioError: all missing, unknown and out-of-range values at once
    """

    role: ClassVar[str] = ""
    scale: ClassVar[tuple[str, ...]] = ()
    faults: ClassVar[Faults | None] = None
    axes: ClassVar[str] = "coaxial"

    def __init__(self, name: str, **values: Any) -> None:
        self.name = name
        cls = type(self)
        self.choices = {k: values.pop(k, d.default) for k, d in list_declared(cls, Choice).items()}
        self.told = frozenset(values)
        self.ports = {k: d.bound(f"{name}.{k}") for k, d in list_declared(cls, Port).items() if self.has(k)}
        possible: dict[str, Parameter] = {k: d for k, d in list_declared(cls, Parameter).items() if self.has(k)}
        parameters = {k: d for k, d in possible.items() if k in self.told or not d.optional}
        self.derived = {k: d for k, d in parameters.items() if d.derived is not None and k not in values}
        self.parameters = {k: d for k, d in parameters.items() if k not in self.derived}
        self.states: dict[str, State] = {k: d for k, d in list_declared(cls, State).items() if self.has(k)}
        self.variables: dict[str, Variable] = list_declared(cls, Variable)
        self.inputs: dict[str, Input] = {k: d for k, d in list_declared(cls, Input).items() if self.has(k)}
        names = (*parameters, *self.states, *self.variables, *self.inputs)
        self.symbols = {k: ca.SX.sym(f"{name}.{k}") for k in names}
        self.derivatives = {k: ca.SX.sym(f"der({name}.{k})") for k in self.states}
        self.values: dict[str, float] = {k: d.default for k, d in self.parameters.items() if d.default is not None}
        self.values |= {k: d.start for k, d in self.states.items()} | {k: d.start for k, d in self.inputs.items()}
        self.values |= {k: v for k, v in values.items() if k in self.values or k in self.parameters}
        self.uses = self._derive()
        if problems := self._problems(values):
            raise ScenarioError(problems)

    def _problems(self, values: dict[str, Any]) -> list[str]:
        cls = type(self)
        settable: dict[str, Declaration] = {
            **list_declared(cls, Parameter),
            **list_declared(cls, State),
            **list_declared(cls, Input),
        }
        where = f"{type(self).__name__} {self.name}"
        found = []
        for key in values.keys() - settable.keys():
            found.append(f'{where}: unknown key "{key}".{suggestion(key, (*settable, *self.choices))}')
        for key, d in self.parameters.items():
            if key not in self.values:
                remedy = "Give a number" if d.unit == "1" else f"Give it in {d.unit}"
                found.append(f"{where}: {key} is missing ({d.doc}). {remedy}.")
        for key in self.values.keys() - self.derived.keys():
            value = self.values[key]
            if (problem := settable[key].quantity(f"{self.name}.{key}").problem(value)) is not None:
                found.append(f"{where}: {problem}")
        for key, c in list_declared(type(self), Choice).items():
            if not c.takes(self.choices[key]):
                options = ", ".join(str(o) for o in c.options)
                wrong = (
                    f"is missing ({c.doc})" if self.choices[key] is None else f"= {self.choices[key]!r} is not known"
                )
                found.append(f"{where}: {key} {wrong}. Choose one of: {options}.")
        return sorted(found) or [f"{where}: {problem}" for problem in self._contradictions()]

    def _derive(self) -> list[LawUse]:
        """Put expressions in the place of the parameters that follow from others; the laws they use."""
        if not self.derived:
            return []
        own = [self.symbols[key] for key in self.derived]
        with recording() as uses:
            found = [as_expression(d.derived(self)) for d in self.derived.values() if d.derived is not None]
        for _ in own[1:]:  # one may follow from another, whatever their order
            found = ca.substitute(found, own, found)
        for key, expression in zip(tuple(self.derived), found, strict=True):
            if ca.depends_on(expression, ca.vertcat(*own)):  # they follow from each other: missing
                self.parameters[key] = self.derived.pop(key)
                continue
            self.symbols[key] = expression
        numbers = self._numbers([self.symbols[key] for key in self.derived])
        self.values |= {key: value for key, value in zip(self.derived, numbers, strict=True) if value is not None}
        return [
            LawUse(u.law, {k: ca.substitute([as_expression(x)], own, found)[0] for k, x in u.arguments.items()})
            for u in uses
        ]

    def _numbers(self, expressions: Sequence[Any]) -> list[float | None]:
        """Values of expressions of the parameters, None where the value of a parameter is missing.

        One function has them all: to make a function takes longer than to call it.
        """
        if not expressions:
            return []
        keys = {symbol.name().removeprefix(f"{self.name}."): symbol for symbol in ca.symvar(ca.vertcat(*expressions))}
        missing = ca.vertcat(*(symbol for key, symbol in keys.items() if key not in self.values))
        known = [k for k, e in enumerate(expressions) if not (missing.numel() and ca.depends_on(e, missing))]
        given = [symbol for key, symbol in keys.items() if key in self.values]
        numbers = ca.Function("numbers", given, [ca.densify(ca.vertcat(*(expressions[k] for k in known)))])
        (found,) = numbers.call([float(self.values[key]) for key in keys if key in self.values])
        values = dict(zip(known, np.array(found).ravel().tolist(), strict=True))
        return [values.get(k) for k in range(len(expressions))]

    def _contradictions(self) -> Iterator[str]:
        """The relations that do not hold between the values given."""
        related = list(self.all_relations())
        numbers = self._numbers([value for _, value in related])
        known = [(relation, n) for (relation, _), n in zip(related, numbers, strict=True) if n is not None]
        for relation, value in find_broken([r for r, _ in known], [v for _, v in known]):
            keys = [path.removeprefix(f"{self.name}.") for path in relation.parameters]
            given = ", ".join(f"{key} = {text(self.values[key], self.parameters[key].unit, 6)}" for key in keys)
            yield relation.problem(value, given) + self.way_out(relation.name)

    def sizes(self) -> Mapping[str, Any]:
        """Lengths that other parts may have from it, by key, as expressions of its parameters [m]."""
        return {}

    def way_out(self, relation: str) -> str:
        """A value with which a relation that does not hold would, as a sentence behind its remedy; "" for none.

        Args:
            relation: its name
        """
        return ""

    def number_at(self, expression: Any, values: Mapping[str, float]) -> float:
        """Value of an expression of the parameters.

        Args:
            expression: the expression
            values: parameters by key, in SI
        """
        symbols = ca.symvar(as_expression(expression))
        given = [float(values[symbol.name().removeprefix(f"{self.name}.")]) for symbol in symbols]
        return float(ca.Function("number", symbols, [expression])(*given))

    def relation(
        self, name: str, value: str, number: Any, low: float = -inf, high: float = inf, *, remedy: str, unit: str = "1"
    ) -> Related:
        """What must hold between parameters, with the expression of the value that tells it.

        Args:
            name: the relation in words
            value: what the number is
            number: expression of the component's parameters
            low, high: where it must lie [unit]
            remedy: what to do where it does not
            unit: of the number
        """
        number = as_expression(number)
        return Relation(self.name, name, value, low, high, remedy, unit, self.follows_from(number)), number

    def follows_from(self, expression: Any) -> tuple[str, ...]:
        """Paths of the parameters in an expression."""
        held = {symbol.element_hash() for symbol in ca.symvar(as_expression(expression))}
        return tuple(f"{self.name}.{k}" for k in self.parameters if self.symbols[k].element_hash() in held)

    def all_relations(self) -> Iterator[Related]:
        """Whole numbers, the declared relations, and the ranges of what follows from other parameters."""
        for key, d in self.parameters.items():
            if d.whole:
                away, remedy = self.symbols[key] - ca.floor(self.symbols[key] + 0.5), "Give a whole number."
                yield self.relation(f"{key} is whole", "its distance to a whole number", away, 0.0, 0.0, remedy=remedy)
        yield from self.relations()
        for key, d in self.derived.items():
            q = d.quantity(f"{self.name}.{key}")
            remedy = f"Change what it follows from, or give {key} a value of its own."
            low, high = (
                nextafter(q.low, inf) if q.low_open else q.low,
                nextafter(q.high, -inf) if q.high_open else q.high,
            )
            number = self.symbols[key]
            yield self.relation(f"{key} can be derived", d.doc, number, low, high, remedy=remedy, unit=d.unit)

    def relations(self) -> Iterable[Related]:
        """What must hold between the parameters, each made by `relation`."""
        return ()

    def relations_with(self, parts: Sequence[Component]) -> Iterable[Related]:
        """What must hold between its parameters and those of other parts.

        Args:
            parts: all of the model
        """
        return ()

    @classmethod
    def spread(cls) -> Iterable[Mapping[str, str]]:
        """What the laws for such a part give at the same sizes: a line of texts each, the recommended one first."""
        return ()

    def clashes(self, met: Mapping[str, Sequence[Component]]) -> Iterable[str]:
        """What cannot be between the part and those that it meets, each with what to do.

        Args:
            met: the part's ports by key -> the other parts on their nets
        """
        return ()

    def has(self, name: str) -> bool:
        """Whether a port, state, input or parameter exists under the component's choices and what it is `told`."""
        return True

    def der(self, state: str) -> Any:
        """Symbol of the time derivative of one of the component's states."""
        return self.derivatives[state]

    def is_input(self, name: str) -> bool:
        """Whether a declared `Input` is given from outside under the component's choices."""
        return not isinstance(self.inputs[name], Given) or name in self.choices["given"]

    def outputs(self) -> dict[str, Output | Given | Parameter]:
        """What results and FMUs show of this component."""
        shown: dict[str, Any] = {k: d for k, d in self.inputs.items() if not self.is_input(k)}
        shown |= {k: d for k, d in self.variables.items() if isinstance(d, Output)}
        return shown | self.derived

    def equations(self) -> Iterator[Equation]:
        """The equations of the component."""
        raise AttributeError(f"{type(self).__name__} has no equations")

    def stored_energy(self) -> Any:
        """Energy held by the states [J]."""
        return 0.0

    def supplied_power(self) -> Iterable[Any]:
        """Powers that enter the model through this component from outside [W]."""
        return ()


@dataclass(frozen=True)
class _Wanted:
    """A part by all that it follows from."""

    kind: type[Component]
    name: str
    values: str


_MADE: WeakValueDictionary[_Wanted, Component] = WeakValueDictionary()


def make(kind: type[Component], name: str, values: Mapping[str, Any]) -> Component:
    """A part; where an equal one is in use, that one: who reads, changes or assembles a rig asks for most parts again.

    Args:
        kind: its type
        name: path of the part in the model
        values: parameters, choices and start values by name, in SI

    Raises:
        ScenarioError: all missing, unknown and out-of-range values at once
    """
    wanted = _Wanted(kind, name, repr(values))
    if (part := _MADE.get(wanted)) is None:
        part = _MADE[wanted] = kind(name, **values)
    return part
