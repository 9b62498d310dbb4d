"""Rig files: one TOML file says everything about a rig, with a source for every value.

    kind = "planetary"                    # a machine: a name in `LAYOUTS`, or "network"
    doc = "..."

    [drive]
    carrier = ["w", "tau"]

    [operating_point]
    source = "Dias2014, section 3.2"
    carrier.w = "250 rpm"

    [part.oil]
    oil = "PAOR"                          # a catalogue entry; a value beside it overrides it
    V = "1 l"
    source = "Dias2014, section 4.2"
    sources = { V = "assumed: one litre" }

Every table and key stands in `tables`: those of the file in `RigTable`, those that each part has in `PartTable`.
A part's values are those of its type; a type of your own is "my_module:MyClass", see `use_parts`. A value may be that
of another part, r = "stage_1.r_2", see `references`. A name "x_{a,b}" stands for two parts, see `repeats`; what
use = NAME stands for, in `repeats` and `assemblies`.
A source is a citation ("Dias2014, table 5.7") or one of "assumed: ...", "inferred: ...", "calibrated: ...".
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

from ..model.core.component import Component
from ..model.core.connect import nets
from ..model.core.declare import Port, State, list_declared
from ..model.core.flat import Quantity
from ..model.errors import GearheatError, Problems, ScenarioError, suggestion, visible
from ..model.machines.spec import LAYOUTS, PartSpec, Spec, layout
from ..model.parts import PARTS
from ..model.parts.free_form import EXTRA_PARTS
from .assemblies import expand_assemblies
from .csv_table import scale, split_unit
from .document import ABOUT, FROM_DATA, paths, read_toml, sources_of
from .film_map import find_map, names_map
from .housing import oil_problems
from .own_types import load_installed_types, load_type
from .references import in_order, look_up, refers
from .repeats import expand
from .scenario import DRIVES, Instrument, Protocol, Scenario, check_drives
from .shipped import RIGS, list_rigs
from .table_checks import campaign_problems, losses_problems, point_problems
from .tables import RigTable, validate
from .values import (
    PartValues,
    deviation,
    in_range,
    not_too_wide,
    part_values,
    quantities,
    readable,
    settable,
    standard_deviation,
)

#: Time between the halves of a test.
STOP = Quantity("stop", "s", "time between the halves of a test", low=0.0, high=6e7)


def load(name_or_path: str | Path, types: Mapping[str, type[Component]] | None = None) -> Scenario:
    """The scenario of a shipped rig, or of a rig file.

    Args:
        name_or_path: a name of `list_rigs`, a TOML file, with its ending or without, or a folder with a `rig.toml`
        types: name -> class of every type a part of the rig may have; those of the project and of installed packages if
            None

    Raises:
        ScenarioError: everything wrong with the file at once
    """
    path = _find(name_or_path)
    known = load_installed_types() | PARTS | EXTRA_PARTS if types is None else types
    return (_shipped if RIGS in path.parents else _loaded)(path, tuple(known.items()))


def _loaded(path: Path, known: tuple[tuple[str, type[Component]], ...]) -> Scenario:
    return _Loader(path, read_toml(path), dict(known)).scenario()


#: Shipped rigs stay as they are while a program runs.
_shipped = cache(_loaded)


def _find(name_or_path: str | Path) -> Path:
    path = Path(name_or_path)
    shipped = RIGS / path / "rig.toml"
    with suppress(OSError):  # no name of a file at all
        if len(path.parts) == 1 and shipped.is_file():
            return shipped
        for file in (path / "rig.toml", path, Path(f"{path}.toml")):
            if file.is_file():
                return file
        if path.is_dir():
            raise ScenarioError(f"{path}: is a folder without a rig.toml. Give a rig file.")
    names = list_rigs()
    beside = [str(file) for file in sorted(path.parent.glob("*.toml"))]
    close = suggestion(str(name_or_path), [*names, *beside]) or suggestion(f"{name_or_path}.toml", beside)
    if path.suffix == ".toml" and not close:
        return path
    raise ScenarioError(f'there is no rig "{name_or_path}" and no such file.{close} Shipped rigs: {", ".join(names)}.')


class _Loader:
    """Reads one file, collecting problems all the way; nothing of it outlives the reading."""

    def __init__(self, path: Path, raw: Mapping[str, Any], known: Mapping[str, type[Component]]) -> None:
        self.path = path
        self.known = known
        self.file = visible(path.name)
        self.name = visible(path.resolve().parent.name if path.name == "rig.toml" else path.stem)
        self.table: RigTable
        plain, folded = expand_assemblies(self.file, raw)
        whole, repeated = expand(self.file, plain)
        self.table, wrong = validate(self.file, whole)
        self.problems = Problems(wrong + folded + repeated)
        if self.table.kind not in LAYOUTS and (self.table.kind or not self.problems):
            close = suggestion(self.table.kind, LAYOUTS) or f" Kinds: {', '.join(LAYOUTS)}."
            self.problems.append(f'{self.file}: unknown kind "{self.table.kind}".{close}')
        if not (self.table.part or self.problems):
            self.problems.append(f"{self.file} [part]: is empty. Give a table [part.NAME] for each part.")
        if self.table.kind not in LAYOUTS or not self.table.part:  # without them nothing else can be judged
            raise ScenarioError(self.problems)
        self.layout, self.connections = layout(self.table.kind)
        self.known = {**known, **self._own_types()}
        self.types = self._types()
        self.settable = quantities(self.types, settable)
        self.value_sources: dict[str, str] = {}
        self.parts: dict[str, PartValues] = {}
        self.references: dict[str, str] = {}

    def _types(self) -> dict[str, type[Component]]:
        """Part -> its class, for the parts whose type is known."""
        types = {name: self.known[kind] for name, kind in self.layout.items()}
        for name, table in self.table.part.items():
            where = f"{self.file} [part.{name}]"
            kind = str(table.get("type", self.layout.get(name, "")))
            if not kind and self.layout:
                close = suggestion(name, self.layout)
                self.problems.append(
                    f'{where}: the machine has no part "{name}".{close} A part of your own needs a type.'
                )
            elif not kind:
                self.problems.append(f'{where}: "type" is missing. Give one of: {", ".join(self.known)}.')
            elif kind not in self.known and ":" not in kind:  # a wrong class of one's own is said already
                close = suggestion(kind, self.known) or f" Types: {', '.join(self.known)}."
                self.problems.append(f'{where}: there is no part type "{kind}".{close}')
            elif not name.isidentifier():
                self.problems.append(f"{where}: the name of a part is one word of letters, digits and _. Rename it.")
            elif kind in self.known:
                types[name] = self.known[kind]
        return types

    def _own_types(self) -> dict[str, type[Component]]:
        """The classes of one's own that the parts name, by what they are called there and by their names."""
        found: dict[str, type[Component]] = {}
        for kind in dict.fromkeys(str(table.get("type", "")) for table in self.table.part.values()):
            if ":" in kind:
                try:
                    cls = load_type(kind, {**self.known, **found})
                except ScenarioError as error:
                    self.problems += [f"{self.file}: {problem}" for problem in error.problems]
                else:
                    found |= {kind: cls, cls.__name__: cls}
        return found

    def scenario(self) -> Scenario:
        """All of the file, or all of its problems."""
        parts = self._parts()
        point = self._operating_point()
        given, drives = self._drive()
        spec = self._spec(parts)
        sensors = self._sensors()
        protocol, data, joint = self._protocol(), self._data(), self._joint_uncertainties()
        self.problems.check()
        Problems(f"{self.file}: {problem}" for problem in oil_problems(spec)).check()
        spec = spec.with_values(point).driven(given, drives)
        nets(spec.assembly())  # ports of different kinds that meet
        return Scenario(
            name=self.name,
            doc=self.table.doc,
            kind=self.table.kind,
            path=self.path,
            spec=spec,
            given=given,
            drives=drives,
            operating_point=point,
            instruments=sensors,
            losses={column: tuple(summed) for column, summed in self.table.losses.items()},
            value_sources=self.value_sources,
            uncertainties={f"{name}.{key}": u for name, part in parts.items() for key, u in part.uncertainties.items()},
            joint_uncertainties=joint,
            units={f"{name}.{key}": unit for name, part in parts.items() for key, unit in part.units.items()},
            references=self.references,
            entries={name: part.entries for name, part in parts.items() if part.entries},
            errata=tuple(self.table.errata),
            protocol=protocol,
            data=data,
            reproduces=self.table.reproduces,
        )

    def _parts(self) -> dict[str, PartValues]:
        parts = self.parts
        referring = {name: self._references(name) for name in self.types}
        order, circle = in_order(referring)
        if circle:
            self.problems.append(f"{self.file}: values of {', '.join(circle)} refer to each other. Write a number.")
            parts |= {name: PartValues() for name in circle}
        for name, cls in ((name, self.types[name]) for name in order):
            table = {k: v for k, v in self.table.part.get(name, {}).items() if k != "type"}
            try:
                table |= {key: find_map(raw, self.path.parent) for key, raw in table.items() if names_map(raw)}
            except GearheatError as error:
                self.problems += [f"{self.file} [part.{name}]: {problem}" for problem in error.problems]
                table = {k: v for k, v in table.items() if not names_map(v)}
            whole = self._refer(name, table, referring[name])
            parts[name] = PartValues() if whole is None else part_values(f"{self.file} [part.{name}]", name, cls, whole)
            self.problems += parts[name].problems
            self.value_sources |= {f"{name}.{key}": source for key, source in parts[name].sources.items()}
        return parts

    def _references(self, name: str) -> dict[str, str]:
        """Values of a part that stand for those of other parts: key -> path."""
        table, known = self.table.part.get(name, {}), settable(self.types[name])
        return {key: raw for key, raw in table.items() if key in known and refers(raw, self.types)}

    def _refer(self, name: str, table: Mapping[str, Any], references: Mapping[str, str]) -> dict[str, Any] | None:
        """The table of a part with numbers in the place of references, None where one names what is wrong itself."""
        found, declared = dict(table), settable(self.types[name])
        for key, ref in references.items():
            source, unit = self.parts.get(ref.partition(".")[0]), declared[key].unit
            if source is None or source.problems or not source.values:
                return None
            with self.problems:
                value = look_up(f"{self.file} [part.{name}]: {key}", ref, unit, self.types, source.values)
                found[key] = value if unit == "1" else f"{value!r} {unit}"
        self.references |= {f"{name}.{key}": ref for key, ref in references.items()}
        return None if any(found[key] == table[key] for key in references) else found

    def _operating_point(self) -> dict[str, float]:
        where = f"{self.file} [operating_point]"
        told = {key: value for key, value in self.table.operating_point.items() if key != DRIVES}
        sources, problems = sources_of(where, told)
        self.problems += problems
        self.value_sources |= sources
        written = dict(paths({k: v for k, v in told.items() if k not in ABOUT}))
        self.problems += point_problems(where, {k: v for k, v in told.items() if k not in ABOUT})
        point = self._taken(where, "input", written, in_range)
        given = [f"{end}.{quantity}" for end, quantities in self.table.drive.items() for quantity in quantities]
        self.problems += [
            f"{where}: {path} is missing, which [drive] says is given. Give its usual value."
            for path in given
            if path in self.settable and path not in written
        ]
        ends = tuple(f"{name}." for name, cls in self.types.items() if cls.__name__ == "ShaftEnd")
        self.problems += [
            f"{where}: {path} follows from what [drive] says is given. Take it out."
            for path in written
            if given and path in self.settable and path.startswith(ends) and {*given} <= {*written} - {path}
        ]
        return point

    def _taken(
        self, where: str, what: str, table: Mapping[str, Any], read: Callable[[str, Any, Quantity], float]
    ) -> dict[str, float]:
        """Values of a table by path, as they are read for a quantity that may be set."""
        found: dict[str, float] = {}
        for path, raw in paths(table):
            if path not in self.settable:
                self.problems.append(f'{where}: there is no {what} "{path}".{suggestion(path, self.settable)}')
                continue
            with self.problems:
                found[path] = read(f"{where}: ", raw, self.settable[path])
        return found

    def _drive(self) -> tuple[dict[str, tuple[str, ...]], str]:
        """What is given at the shaft ends, and the end where power enters, "" if none is named."""
        ends = [name for name, cls in self.types.items() if cls.__name__ == "ShaftEnd"]
        for end in self.table.drive:
            if end not in ends:
                close = suggestion(end, ends) or f" Shaft ends: {', '.join(ends) or 'none'}."
                self.problems.append(f'{self.file} [drive]: "{end}" is no shaft end.{close}')
        drives = self.table.operating_point.get(DRIVES, "")
        with self.problems:
            check_drives(f"{self.file} [operating_point]: {DRIVES}", drives, ends)
        return {end: tuple(quantities) for end, quantities in self.table.drive.items()}, drives

    def _spec(self, parts: Mapping[str, PartValues]) -> Spec:
        ports = {f"{name}.{key}": name for name, cls in self.types.items() for key in list_declared(cls, Port)}
        for net, members in self.table.connect.items():
            where = f"{self.file} [connect] {net}"
            self.problems += [
                f'{where}: there is no port "{p}".{suggestion(p, ports)}' for p in members if p not in ports
            ]
            if len(members) < 2:
                self.problems.append(f"{where}: names {len(members)} port. Name at least two that meet.")
        self.problems += self._one_body_of_two()
        specs = tuple(PartSpec(name, cls.__name__, parts[name].values) for name, cls in self.types.items())
        own = tuple(tuple(members) for members in self.table.connect.values())
        return Spec(self.name, self.table.doc, specs, (*self.connections, *own), self.known)

    def _one_body_of_two(self) -> list[str]:
        """Nets of the file that share a port, which makes one of them, and that hold different storages."""
        stores = {name for name, cls in self.types.items() if list_declared(cls, State)}
        held = {net: {port.partition(".")[0] for port in ports} & stores for net, ports in self.table.connect.items()}
        first: dict[str, str] = {}
        problems = []
        for net, ports in self.table.connect.items():
            for port in ports:
                other = first.setdefault(port, net)
                if held[other] != held[net] and len(bodies := held[other] | held[net]) > 1:
                    problems.append(
                        f"{self.file} [connect] {other} and {net} both name {port}: they would be one net, and "
                        f"{' and '.join(sorted(bodies))} one body. Name {port} in one of them, or write one net."
                    )
        return problems

    def _sensors(self) -> tuple[Instrument, ...]:
        """The instruments; losses and they name what the model shows."""
        known = quantities(self.types, readable)
        found: list[Instrument] = []
        for key, table in self.table.sensors.items():
            place = f"{self.file} [sensors] {key}"
            if not key.strip():
                self.problems.append(f"{place}: a sensor has no name. Give it that of its column.")
            if table.reads not in known:
                self.problems.append(f'{place}: there is no "{table.reads}".{suggestion(table.reads, known)}')
                continue
            if unit := table.unit or split_unit(table.column or key)[1]:
                with self.problems:
                    scale(unit, known[table.reads].unit, name=f"{place}: {table.reads} in {unit}")
            accuracy: dict[str, float] = {}
            for name, raw in (("repeat_sd", table.repeat_sd), ("offset_sd", table.offset_sd)):
                if raw is not None:
                    with self.problems:
                        accuracy[name] = standard_deviation(f"{place}: {name}", raw, known[table.reads].unit)
            found.append(
                Instrument(
                    name=split_unit(key)[0],
                    column=table.column or key,
                    reads=table.reads,
                    kind=table.kind or "",
                    role=table.role or "",
                    unit=table.unit or "",
                    magnitude=table.magnitude or table.signs is not None,
                    signs=None if table.signs is None else (table.signs[0], table.signs[1]),
                    **accuracy,
                )
            )
        self.problems += losses_problems(self.file, self.table.losses, known)
        return tuple(found)

    def _joint_uncertainties(self) -> dict[str, dict[str, float]]:
        """Reason -> path -> what a value changes by at one standard deviation."""
        found = {}
        for name, table in self.table.uncertainties.items():
            where = f"{self.file} [uncertainties.{name}]"
            found[name] = self._taken(where, "value", table, self._change)
        return found

    def _change(self, where: str, raw: Any, quantity: Quantity) -> float:
        """What a value changes by at one standard deviation; what data gave may be as uncertain as they leave it."""
        name = f"{where}{quantity.name}"
        part, _, key = quantity.name.rpartition(".")
        from_data = self.value_sources.get(quantity.name, "").startswith(FROM_DATA)
        value = None if from_data or part not in self.parts else self.parts[part].values.get(key)
        return not_too_wide(name, raw, deviation(name, raw, quantity.unit), value)

    def _protocol(self) -> Protocol | None:
        table = self.table.campaign
        if table is None:
            return None
        where = f"{self.file} [campaign]"
        self.problems += campaign_problems(where, table, self.settable, self.types, self.table.sensors)
        with self.problems:
            stop = in_range(f"{where}: ", table.stop, STOP)
            return Protocol(table.inputs, table.room, table.oil, stop, tuple(table.notes))
        return None

    def _data(self) -> Path | None:
        """The rig's own measured table."""
        table = self.table.campaign
        if table is None or not table.data:
            return None
        path = self.path.parent / table.data
        if not path.is_file():
            self.problems.append(f"{path}: there is no such file. Check the path.")
        return path
