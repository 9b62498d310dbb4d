"""Rigs as functions take them: a name, a file, a scenario, or anything that holds one; and what is set of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

from ..model.core.flat import Quantity
from ..model.errors import ScenarioError
from .load import load
from .scenario import Scenario


@runtime_checkable
class HoldsScenario(Protocol):
    """What stands for a rig in Python."""

    @property
    def scenario(self) -> Scenario:
        """The rig with its values."""


#: A name of a shipped rig, a rig file, or a rig in Python.
RigLike = str | Path | Scenario | HoldsScenario
#: What a user sets: name -> text with a unit, quantity of pint, or number in SI; or texts "NAME=VALUE".
Settings = Mapping[str, Any] | str | Sequence[str]


def scenario_of(rig: RigLike) -> Scenario:
    """The scenario of a rig.

    Args:
        rig: its name, its file, or the rig itself

    Raises:
        ScenarioError: everything wrong with the file at once
    """
    if isinstance(rig, Scenario):
        return rig
    if isinstance(rig, str | Path):
        return load(rig)
    if not hasattr(rig, "scenario"):
        raise ScenarioError(f"{rig!r} is no rig. Give its name, its file, or what gearheat.load returns.")
    return rig.scenario


def spell(value: Any, quantity: Quantity | None = None) -> str:
    """A value as the command line has it.

    Args:
        value: text, number in SI, or quantity of pint
        quantity: what it is of, None for a choice or an entry of a catalogue
    """
    if isinstance(value, str | bool):
        return str(value)
    if (number := getattr(value, "magnitude", None)) is not None:
        return f"{float(number)!r} {value.units:~C}"
    unit = "1" if quantity is None else quantity.unit
    return repr(float(value)) if unit == "1" else f"{float(value)!r} {unit}"


def listed(names: str | Iterable[str]) -> list[str]:
    """Texts as a list; one text is a list of one."""
    return [names] if isinstance(names, str) else list(names)


def assignments_of(given: Settings, known: Callable[[], Mapping[str, Quantity]]) -> list[str]:
    """What is set as texts "NAME=VALUE".

    Args:
        given: by name, or such texts
        known: tells the quantity of each name that may be set; asked where values have names
    """
    if not isinstance(given, Mapping):
        return listed(given)
    quantities = known()
    return [f"{name}={spell(value, quantities.get(name))}" for name, value in given.items()]
