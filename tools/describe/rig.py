"""A rig in Python: its parameters are read and changed by name, and parts of one's own join it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from ...model.core.component import Component
from ...model.core.declare import Choice, list_declared
from ...model.core.flat import FlatModel
from ...model.errors import Problems
from ...model.machines.spec import PartSpec, Spec
from ...scenarios.given import Settings, assignments_of
from ...scenarios.load import load as read_rig
from ...scenarios.scenario import Scenario, parse_assignments
from ...scenarios.shipped import list_rigs
from ...scenarios.write import rig_text
from ..show.console import write
from ..show.display import Quantities
from ..solve.settings import adjust, choice_paths, flat_of
from .description import Description, show
from .parts import first_line

#: Source of the values of parts that a user adds in Python.
ADDED = "set in Python"


@dataclass(frozen=True, eq=False, repr=False)
class Rig(Quantities):
    """A gearbox with all its values. Nothing changes it: `with_` and `join` give new rigs.

    Attributes:
        scenario: what its file says
    """

    scenario: Scenario

    @cached_property
    def flat(self) -> FlatModel:
        """Its equations, sorted."""
        return flat_of(self.scenario)

    @property
    def name(self) -> str:
        """Its name."""
        return self.scenario.name

    @property
    def parts(self) -> dict[str, str]:
        """Its parts, name -> type."""
        return {part.name: part.type for part in self.scenario.spec.parts}

    def __getitem__(self, name: str) -> Any:
        """Value of a parameter, an input or the start of a state in SI, or what is chosen for a choice.

        Raises ScenarioError with suggestions for an unknown name.
        """
        if name in choice_paths(self.scenario.spec):
            part, _, key = name.rpartition(".")
            choice = list_declared(self.scenario.spec.types[self.parts[part]], Choice)[key]
            return self.scenario.spec.part(part).values.get(key, choice.default)
        return self.flat.quantity(name).start

    def __iter__(self) -> Iterator[str]:
        """Names of its values."""
        kinds, derived = self.flat.index.items(), self.flat.derived
        yield from choice_paths(self.scenario.spec)
        yield from (name for name, (kind, _) in kinds if kind != "output" or name in derived)

    def with_(self, set: Settings, *, source: str = "") -> Rig:
        """The rig with other values.

        Args:
            set: values by name: texts with units, quantities of pint, or numbers in SI
            source: where they are from, as the rig file tells it

        Raises:
            ScenarioError: all that is wrong with them
        """
        changed = adjust(self.scenario, set)
        if source:
            names = [text.partition("=")[0].strip() for text in assignments_of(set, self.scenario.settable)]
            changed = replace(changed, value_sources={**changed.value_sources, **dict.fromkeys(names, source)})
        return Rig(changed)

    def join(self, *parts: Component, nets: Iterable[Sequence[str]]) -> Rig:
        """The rig with parts added, of types of one's own, too.

        Args:
            parts: with their names and values in SI, such as `Fan("fan", A=0.1)`
            nets: ports that meet, such as ("fan.shaft", "input_seal.shaft")

        Raises:
            ScenarioError: names that are there already, and values that a part does not use
            StructureError: ports that do not fit
        """
        spec = self.scenario.spec
        problems = Problems(
            f'{self.name}: there is a part "{part.name}" already. Give it another name.'
            for part in parts
            if part.name in self.parts
        )
        problems += [
            f'{part.name}: {type(part).__name__} does not use "{key}" with its other values. Leave it out.'
            for part in parts
            for key in sorted(part.told - part.values.keys())
        ]
        problems.check()
        added = [PartSpec(part.name, type(part).__name__, _collect_values(part)) for part in parts]
        types = {type(part).__name__: type(part) for part in parts}
        sources = {f"{part.name}.{key}": ADDED for part in added for key in part.values}
        joined = spec.with_parts(added, [tuple(net) for net in nets], types)
        return Rig(replace(self.scenario, spec=joined, value_sources={**self.scenario.value_sources, **sources}))

    def show(self) -> Description:
        """What it is made of."""
        return show(self.scenario)

    @property
    def title(self) -> str:
        """Name and description."""
        return f"{self.name}: {self.scenario.doc}"

    def table(self) -> tuple[Sequence[str], Sequence[Sequence[Any]]]:
        """Its parts."""
        docs = {kind: first_line(cls) for kind, cls in self.scenario.spec.types.items()}
        return ("part", "type", "what it is"), [(name, kind, docs[kind]) for name, kind in self.parts.items()]

    def as_dict(self) -> dict[str, Any]:
        """Everything about it, as `gearheat show --json` has it."""
        return self.show().as_dict()

    def save(self, path: str | Path) -> Path:
        """Write a rig file that every command reads.

        Args:
            path: TOML file to write

        Raises:
            DataError: it cannot be written
        """
        write(Path(path), rig_text(self.scenario))
        return Path(path)


def _collect_values(part: Component) -> dict[str, Any]:
    """Values and choices that a part was made with."""
    usual = list_declared(type(part), Choice)
    chosen = {key: value for key, value in part.choices.items() if value != usual[key].default}
    return {key: part.values[key] for key in sorted(part.told)} | chosen


def assemble(
    name: str,
    parts: Sequence[Component],
    nets: Iterable[Sequence[str]],
    drive: Mapping[str, Sequence[str]],
    point: Settings = (),
) -> Rig:
    """A rig of parts, without a file.

    Args:
        name: of the rig
        parts: with their names and values in SI
        nets: ports that meet
        drive: shaft end -> what is given there, "w" and "tau"
        point: inputs at the operating point, by name

    Raises:
        ScenarioError: values that do not fit
        StructureError: ports that do not fit
    """
    scenario = Scenario(name, name, "network", Path(f"{name}.toml"), Spec(name, name, (), ()), {}, {})
    joined = Rig(scenario).join(*parts, nets=nets).scenario.driven(drive)
    values = parse_assignments(joined, assignments_of(point, joined.settable))
    return Rig(joined.with_values(values, ADDED))


def load(rig: str | Path) -> Rig:
    """A shipped rig, or that of a rig file.

    Args:
        rig: a name of `rigs`, a TOML file, or a folder with a `rig.toml`

    Raises:
        ScenarioError: everything wrong with the file at once

    Example:
        >>> import gearheat as gh
        >>> gh.load("planetary").to("cooling.A", "m2") > 0
        True
    """
    return Rig(read_rig(rig))


def rigs() -> dict[str, str]:
    """The shipped rigs, name -> what they are."""
    return list_rigs()
