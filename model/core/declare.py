"""What a component is made of: typed declarations that carry unit, meaning, size and range once, for everything.

A declaration is a descriptor. On a component instance it reads as the CasADi symbol of that quantity (a `Choice`
reads as its Python value).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from .flat import Quantity


@dataclass(eq=False)
class Declaration:
    """Common part: unit, meaning, typical size and range of one scalar.

    `refusal` says what a value outside the range means and what to do; "{name}" in it stands for the value of that
    output of the same part.
    """

    unit: str
    doc: str
    nominal: float = 1.0
    above: float | None = None
    at_least: float | None = None
    below: float | None = None
    at_most: float | None = None
    refusal: str = ""
    name: str = field(default="", init=False)

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, instance: Any, owner: type) -> Any:
        return self if instance is None else instance.symbols[self.name]

    def quantity(self, path: str, start: float = 0.0) -> Quantity:
        """This declaration as the quantity of a path.

        Args:
            path: of the quantity ("oil.T")
            start: its value to begin with, in SI
        """
        low = self.at_least if self.above is None else self.above
        high = self.at_most if self.below is None else self.below
        return Quantity(
            path,
            self.unit,
            self.doc,
            self.nominal,
            start,
            -np.inf if low is None else low,
            np.inf if high is None else high,
            self.above is not None,
            self.below is not None,
            self.refusal,
            getattr(self, "whole", False),
        )


class Potential(Declaration):
    """The quantity of a port that is equal for all ports of a net."""


class Flow(Declaration):
    """The quantity of a port that sums to zero over a net. Positive into the component that owns the port."""


@dataclass(eq=False)
class Parameter(Declaration):
    """A number that stays a symbol until a model is run.

    `default` is only for numerics, never for physics. `derived` makes of the component an expression in its other
    parameters (a contact ratio from the geometry), which holds wherever no value is given. `whole` asks for a whole
    number. What is `optional` is no part of the model where no value is given.
    """

    default: float | None = None
    derived: Callable[[Any], Any] | None = None
    whole: bool = False
    optional: bool = False


@dataclass(eq=False)
class Variable(Declaration):
    """An unknown. With a `guess` it may be the starting point of the Newton steps of an implicit block."""

    guess: float | None = None


class Output(Variable):
    """An unknown that results and FMUs show."""


@dataclass(eq=False)
class State(Declaration):
    """A quantity with a derivative, `component.der(name)`."""

    start: float = 0.0


@dataclass(eq=False)
class Input(Declaration):
    """A quantity given from outside at every moment."""

    start: float = 0.0


class Given(Input):
    """An input where the component's choice `given` holds its name, an output elsewhere."""


@dataclass(eq=False)
class Choice:
    """A structural Python value, fixed before flattening: one of the options, or any value of the type `also`."""

    options: tuple[Any, ...]
    doc: str
    default: Any = None
    also: type | None = None
    name: str = field(default="", init=False)

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, instance: Any, owner: type) -> Any:
        return self if instance is None else instance.choices[self.name]

    def takes(self, value: Any) -> bool:
        """Whether a value may be chosen."""
        if not self.options or (self.also is not None and isinstance(value, self.also)):
            return True
        return any(value == option and isinstance(value, bool) == isinstance(option, bool) for option in self.options)


class Port:
    """A place where a component meets others: one or more potentials, with or without a flow.

    A port type without a flow carries information only. `power` says which product of its quantities is the power
    that enters the component, for the energy audit. The other attributes are words for what may be wrong with it.

    Attributes:
        must_meet: whether a port that meets no other is a fault; a part may say otherwise of its own
        missing: what is wrong then, or where the part needs what the port should bring
        absent: what to do where the port is not there under the values of its part
        source: what to connect it to
        instead: what else to do where two things prescribe the same potential
        divides: what to put in where two ways between the same places leave open what flows on either
        levels: potentials that only differ by what connects them, with what gives them their level
    """

    doc: str = ""
    must_meet: ClassVar[bool] = False
    missing: ClassVar[str] = "nothing says what it should read"
    absent: ClassVar[str] = ""
    source: ClassVar[str] = "a port of its kind"
    instead: ClassVar[str] = ""
    divides: ClassVar[str] = ""
    levels: ClassVar[Mapping[str, str]] = {}

    def __init__(self, doc: str = "", must_meet: bool | None = None) -> None:
        self.doc = doc
        self.needed = self.must_meet if must_meet is None else must_meet
        self.name = ""
        self.symbols: dict[str, Any] = {}

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, instance: Any, owner: type) -> Any:
        return self if instance is None else instance.ports[self.name]

    def bound(self, path: str) -> Port:
        """This port as one of a component: the same declarations with symbols of their own."""
        port = type(self)(self.doc, self.needed)
        port.name = path
        port.symbols = {name: ca.SX.sym(f"{path}.{name}") for name in (*self.potentials(), *self.flows())}
        return port

    @classmethod
    def potentials(cls) -> dict[str, Potential]:
        """The potentials of this type of port."""
        return list_declared(cls, Potential)

    @classmethod
    def flows(cls) -> dict[str, Flow]:
        """The flows of this type of port."""
        return list_declared(cls, Flow)

    def power(self) -> Any:
        """Power that enters the owner through this port [W]; none for ports that carry information."""
        return 0.0


def list_declared(owner: type, kind: type) -> dict[str, Any]:
    """All declarations of a kind on a class, base classes first, in the order written; a class may redeclare a name.

    Args:
        owner: class of a component or port
        kind: class of the declarations
    """
    return dict(_declared(owner, kind))


@cache
def _declared(owner: type, kind: type) -> dict[str, Any]:
    """The same, looked for once a class: rigs make thousands of parts of the same few classes."""
    found: dict[str, Any] = {}
    for base in reversed(owner.__mro__):
        found.update(vars(base))
    return {name: d for name, d in found.items() if isinstance(d, kind)}
