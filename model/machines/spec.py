"""What a machine is before it becomes equations: parts with SI values, and who is connected to whom."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache, lru_cache
from typing import Any

from ..core.component import Component, make
from ..core.connect import Assembly
from ..core.declare import list_declared
from ..core.flat import FlatModel
from ..core.flatten import flatten
from ..errors import Problems, ScenarioError, suggestion
from ..files import tables
from ..parts import PARTS
from ..parts.ports import Flange

#: Kinds of machines, a file in `layouts` each. The parts of the last are named by the rig file alone.
LAYOUTS = ("planetary", "harmonic", "cycloidal", "cycloidal_printed", "rv_stage", "drum_motor", "network")
#: Flat models kept: to flatten takes as long as all that is then asked of a rig.
KEPT = 16


@cache
def layout(kind: str) -> tuple[Mapping[str, str], tuple[tuple[str, ...], ...]]:
    """The fixed parts of one of `LAYOUTS`, name -> type in the order to show them, and the ports that meet."""
    found = tables("model.machines", "layouts", f"{kind}.toml")
    return found["parts"], tuple(map(tuple, found["connections"]))


@dataclass(frozen=True)
class PartSpec:
    """One part: its name, its type (a name in the `types` of its `Spec`), its SI values and choices by key."""

    name: str
    type: str
    values: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Spec:
    """One machine: its parts in the order to show them, and the groups of ports that meet.

    `types` says which class a part's type names: a floor above may add classes of its own.
    """

    name: str
    doc: str
    parts: tuple[PartSpec, ...]
    connections: tuple[tuple[str, ...], ...]
    types: Mapping[str, type[Component]] = field(default_factory=lambda: PARTS, repr=False)

    def flat(self) -> FlatModel:
        """The flat model; made once of equal specs. Raises GearheatError where there is none."""
        return _flat(self._whole)

    def assembly(self) -> Assembly:
        """The parts, as `assemble` makes them; made once of equal specs."""
        return _assembly(self._whole)

    @property
    def _whole(self) -> _Whole:
        classes = tuple(self.types.get(part.type) for part in self.parts)
        return _Whole(self, repr((self.name, self.doc, self.parts, self.connections)), classes)

    def part(self, name: str) -> PartSpec:
        """The part of a name. Raises ScenarioError with suggestions for an unknown one."""
        for part in self.parts:
            if part.name == name:
                return part
        names = [part.name for part in self.parts]
        raise ScenarioError(f'{self.name}: there is no part "{name}".{suggestion(name, names)}')

    def of_type(self, *types: str) -> tuple[str, ...]:
        """Names of the parts of the given types."""
        return tuple(part.name for part in self.parts if part.type in types)

    def with_values(self, values: Mapping[str, Any]) -> Spec:
        """The spec with values replaced, by path ("oil.nu_40").

        Raises:
            ScenarioError: values for parts that the spec does not have, all at once
        """
        by_part: dict[str, dict[str, Any]] = {}
        for path, value in values.items():
            name, _, key = path.rpartition(".")
            by_part.setdefault(name, {})[key] = value
        names = [part.name for part in self.parts]
        if unknown := [name for name in by_part if name not in names]:
            raise ScenarioError([f'{self.name}: there is no part "{n}".{suggestion(n, names)}' for n in unknown])
        return replace(
            self, parts=tuple(replace(p, values={**p.values, **by_part.get(p.name, {})}) for p in self.parts)
        )

    def with_parts(
        self,
        parts: Iterable[PartSpec],
        connections: Iterable[tuple[str, ...]],
        types: Mapping[str, type[Component]] | None = None,
    ) -> Spec:
        """The spec with parts and connections added.

        Args:
            parts: the parts
            connections: groups of ports that meet, each a path ("cooler.a")
            types: classes of the added parts that the spec does not know yet, by the name of the type
        """
        return replace(
            self,
            parts=(*self.parts, *parts),
            connections=(*self.connections, *connections),
            types={**self.types, **(types or {})},
        )

    def driven(self, given: Mapping[str, Iterable[str]], drives: str = "") -> Spec:
        """The spec driven at its shaft ends.

        Shafts whose speed is given nowhere keep their inertia as a state; otherwise inertias are left out.

        Args:
            given: shaft end -> "w", "tau" and "load" that are given there; nothing at those not named
            drives: the end where power enters, if a load is given there, too; it leaves at all others

        Raises:
            ScenarioError: names that are no shaft end
        """
        choices: dict[str, Any] = {f"{end}.given": tuple(given.get(end, ())) for end in self.of_type("ShaftEnd")}
        unknown = [end for end in given if f"{end}.given" not in choices]
        if unknown:
            raise ScenarioError(
                [f'{self.name}: "{e}" is no shaft end.{suggestion(e, self.of_type("ShaftEnd"))}' for e in unknown]
            )
        choices |= {f"{end}.drives": end == drives for end in self.of_type("ShaftEnd")}
        turned = self.turning_with(end for end, quantities in given.items() if "w" in quantities)
        return self.with_values(choices | {f"{n}.dynamic": n not in turned for n in self.of_type("Inertia")})

    def turning_with(self, parts: Iterable[str]) -> set[str]:
        """All parts that shafts tie to some of them, these among them; what stands still ties nothing."""
        shafts = {f"{p.name}.{key}" for p in self.parts for key in list_declared(self.types[p.type], Flange)}
        still = {f"{name}.flange" for name in self.of_type("FixedFlange")}
        met = [{port.rpartition(".")[0] for port in shafts & {*net}} for net in self.connections if not still & {*net}]
        found, grown = set(parts), True
        while grown:
            joined = set[str]().union(*(net for net in met if net & found))
            found, grown = found | joined, not joined <= found
        return found


def assemble(spec: Spec) -> Assembly:
    """Make the parts of a spec.

    Raises:
        ScenarioError: all unknown types and all wrong, missing and unknown values of all parts at once
    """
    parts: list[Component] = []
    problems = Problems()
    for part in spec.parts:
        if part.type not in spec.types:
            problems.append(f'{part.name}: there is no part type "{part.type}".{suggestion(part.type, spec.types)}')
            continue
        with problems:
            parts.append(make(spec.types[part.type], part.name, part.values))
    problems.check()
    return Assembly(spec.name, spec.doc, tuple(parts), spec.connections)


@dataclass(frozen=True)
class _Whole:
    """A spec by all that its flat model follows from."""

    spec: Spec = field(compare=False)
    text: str
    classes: tuple[type[Component] | None, ...]


@lru_cache(KEPT)
def _assembly(whole: _Whole) -> Assembly:
    return assemble(whole.spec)


@lru_cache(KEPT)
def _flat(whole: _Whole) -> FlatModel:
    return flatten(_assembly(whole))
