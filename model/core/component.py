"""Components: declarations followed by named equations."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import casadi as ca

from ..errors import ScenarioError, suggestion
from .declare import Choice, Declaration, Given, Input, Output, Parameter, Port, State, Variable, declared


@dataclass(frozen=True)
class Equation:
    """Two sides that are equal; which of their symbols it determines is found by flattening."""

    name: str
    lhs: Any
    rhs: Any


def equation(name: str, lhs: Any, rhs: Any) -> Equation:
    """A named, unordered equation."""
    return Equation(name, ca.SX(lhs), ca.SX(rhs))


class Component:
    """Base of all parts. Constructed with its path name and the SI values of what it declares; frozen from then on.

    Args:
        name: path of the component in the model, for example "oil"
        values: parameters and choices, and start values of states and inputs, by name

    Raises:
        ScenarioError: all missing, unknown and out-of-range values at once
    """

    def __init__(self, name: str, **values: Any) -> None:
        self.name = name
        cls = type(self)
        self.choices = {k: values.pop(k, d.default) for k, d in declared(cls, Choice).items()}
        self.ports = {k: d.bound(f"{name}.{k}") for k, d in declared(cls, Port).items()}
        self.parameters: dict[str, Parameter] = {k: d for k, d in declared(cls, Parameter).items() if self.has(k)}
        self.states: dict[str, State] = {k: d for k, d in declared(cls, State).items() if self.has(k)}
        self.variables: dict[str, Variable] = declared(cls, Variable)
        self.inputs: dict[str, Input] = declared(cls, Input)
        names = (*self.parameters, *self.states, *self.variables, *self.inputs)
        self.symbols = {k: ca.SX.sym(f"{name}.{k}") for k in names}
        self.derivatives = {k: ca.SX.sym(f"der({name}.{k})") for k in self.states}
        self.values: dict[str, float] = {k: d.default for k, d in self.parameters.items() if d.default is not None}
        self.values |= {k: d.start for k, d in self.states.items()} | {k: d.start for k, d in self.inputs.items()}
        self.values |= {k: v for k, v in values.items() if k in self.values or k in self.parameters}
        self._derive()
        if problems := self._problems(values):
            raise ScenarioError(problems)

    def _problems(self, values: dict[str, Any]) -> list[str]:
        cls = type(self)
        settable: dict[str, Declaration] = {**declared(cls, Parameter), **declared(cls, State), **self.inputs}
        where = f"{type(self).__name__} {self.name}"
        found = []
        for key in values.keys() - settable.keys():
            found.append(f'{where}: unknown key "{key}".{suggestion(key, (*settable, *self.choices))}')
        for key, d in self.parameters.items():
            if key not in self.values:
                found.append(f"{where}: {key} is missing ({d.doc}). Give it in {d.unit}.")
        for key, value in self.values.items():
            if (problem := settable[key].quantity(f"{self.name}.{key}").problem(value)) is not None:
                found.append(f"{where}: {problem}")
        for key, c in declared(type(self), Choice).items():
            if c.options and self.choices[key] not in c.options:
                options = ", ".join(str(o) for o in c.options)
                wrong = (
                    f"is missing ({c.doc})" if self.choices[key] is None else f"= {self.choices[key]!r} is not known"
                )
                found.append(f"{where}: {key} {wrong}. Choose one of: {options}.")
        return sorted(found)

    def _derive(self) -> None:
        """Values of parameters that follow from the others and are not given."""
        for key, d in self.parameters.items():
            if d.derived is not None and key not in self.values:
                with suppress(KeyError):  # a missing value it needs is reported under its own name
                    self.values[key] = float(d.derived(self.values))

    def has(self, name: str) -> bool:
        """Whether a declared state or parameter exists under the component's choices."""
        return True

    def der(self, state: str) -> Any:
        """Symbol of the time derivative of one of the component's states."""
        return self.derivatives[state]

    def is_input(self, name: str) -> bool:
        """Whether a declared `Input` is given from outside under the component's choices."""
        return not isinstance(self.inputs[name], Given) or name in self.choices["given"]

    def outputs(self) -> dict[str, Output | Given]:
        """What results and FMUs show of this component."""
        shown: dict[str, Any] = {k: d for k, d in self.inputs.items() if not self.is_input(k)}
        return shown | {k: d for k, d in self.variables.items() if isinstance(d, Output)}

    def equations(self) -> Iterator[Equation]:
        """The equations of the component."""
        raise AttributeError(f"{type(self).__name__} has no equations")

    def stored_energy(self) -> Any:
        """Energy held by the states [J]."""
        return 0.0

    def supplied_power(self) -> Iterable[Any]:
        """Powers that enter the model through this component from outside [W]."""
        return ()
