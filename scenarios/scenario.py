"""What a rig file says, checked and in SI: the machine, how it is driven, and what is known about it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import hypot
from pathlib import Path

from ..model.core.component import Component
from ..model.core.declare import Given, Input, list_declared
from ..model.core.flat import FlatModel, Quantity
from ..model.errors import Problems, ScenarioError, suggestion
from ..model.machines.spec import Spec
from .document import FROM_DATA
from .entries import Entry, catalogue, unchecked_entry
from .references import followed
from .shipped import FILES
from .tables import DrivenTable, ErratumTable
from .values import entry_values, in_range, quantities, readable, settable

#: Key of the shaft end where power enters.
DRIVES = "drives"


@dataclass(frozen=True)
class Instrument:
    """One instrument of a rig; what is empty or None follows from what it reads.

    Args:
        name: of the instrument
        column: column of a measured table
        reads: path in the model
        kind: what it is, one of `tables.Kind`
        role: "given" drives the model, "read" is compared
        unit: of the column
        magnitude: whether the column holds magnitudes
        signs: sign of the model's value in direction 1 and 2 where it does
        repeat_sd, offset_sd: scatter from reading to reading, and tolerance that is fixed over a campaign [SI]
    """

    name: str
    column: str
    reads: str
    kind: str = ""
    role: str = ""
    unit: str = ""
    magnitude: bool = False
    signs: tuple[float, float] | None = None
    repeat_sd: float | None = None
    offset_sd: float | None = None


@dataclass(frozen=True)
class Protocol:
    """How measured tables of a rig are taken: what drives the model, and what happens between readings.

    Args:
        inputs: model input -> the column that gives it while a point is held; 0 during the stop
        room: model input of the room temperature. Its reading is taken at the end of a point: constant before the
            first one, in a straight line from each reading to the next
        oil: part of the model that holds the oil of the test
        stop: time without load between the two halves of a test [s], where the table does not say
        notes: further columns of the rig's own table, which only its reader needs
    """

    inputs: Mapping[str, DrivenTable]
    room: str
    oil: str
    stop: float
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Scenario:
    """A rig: what it is (`spec`, driven as in `given`, inputs at the operating point) and what goes with it.

    Args:
        given: shaft end -> which of w and tau are given there
        operating_point: path of an input -> value in SI
        drives: the shaft end where power enters as the machine is meant, "" where the file names none
        instruments: what measured tables of the rig read
        losses: column of the losses table -> outputs that are summed
        value_sources: path -> where its value is from
        uncertainties: path -> standard uncertainty of its value in SI, where the rig states one
        joint_uncertainties: reason -> path -> what its value changes by at one standard deviation of the reason, SI
        units: path -> unit in which its value is written
        references: path of a value -> path of that of another part, which it follows
        entries: part -> kind of catalogue -> name of the entry it was filled from
        protocol: how measured tables of this rig are taken
        data: the measured table that it comes with
        reproduces: what published results the rig reproduces, in a line
    """

    name: str
    doc: str
    kind: str
    path: Path
    spec: Spec
    given: Mapping[str, tuple[str, ...]]
    operating_point: Mapping[str, float]
    drives: str = ""
    instruments: tuple[Instrument, ...] = ()
    losses: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    value_sources: Mapping[str, str] = field(default_factory=dict)
    uncertainties: Mapping[str, float] = field(default_factory=dict)
    joint_uncertainties: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    references: Mapping[str, str] = field(default_factory=dict)
    entries: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    errata: tuple[ErratumTable, ...] = ()
    protocol: Protocol | None = None
    data: Path | None = None
    reproduces: str = ""

    @property
    def sensors(self) -> dict[str, str]:
        """Column of a measured table -> path in the model."""
        return {instrument.column: instrument.reads for instrument in self.instruments}

    @property
    def room(self) -> str | None:
        """Path of the temperature of the room, of the first where there are several, None where there is none."""
        return next((f"{name}.T" for name in self.spec.of_type("Room")), None)

    @property
    def standard_uncertainties(self) -> dict[str, float]:
        """Path -> standard uncertainty of its value in SI by all reasons that the rig states."""
        found = dict(self.uncertainties)
        for path, change in (pair for changes in self.joint_uncertainties.values() for pair in changes.items()):
            found[path] = hypot(found.get(path, 0.0), change)
        return found

    @property
    def rough(self) -> frozenset[str]:
        """Paths of values that are uncertain together, as rules give them; what data gave so is known better."""
        paths = frozenset(path for changes in self.joint_uncertainties.values() for path in changes)
        return frozenset(path for path in paths if not self.value_sources.get(path, "").startswith(FROM_DATA))

    @property
    def rules(self) -> dict[str, float]:
        """Path -> standard uncertainty of its value in SI, of what rules give."""
        known = self.standard_uncertainties
        return {path: known[path] for path in sorted(self.rough)}

    @cached_property
    def types(self) -> dict[str, type[Component]]:
        """Part -> its type."""
        return {part.name: self.spec.types[part.type] for part in self.spec.parts}

    def settable(self) -> dict[str, Quantity]:
        """All that may be given a value, by path: parameters, start values of states, inputs."""
        return quantities(self.types, settable)

    def readable(self) -> dict[str, Quantity]:
        """All that a sensor may read, by path: outputs, states, inputs."""
        return quantities(self.types, readable)

    def inputs(self) -> dict[str, Quantity]:
        """All that may be given over time, by path, whatever is driven."""
        return quantities(self.types, lambda cls: list_declared(cls, Input))

    def with_values(self, values: Mapping[str, float], source: str = "given by the user") -> Scenario:
        """The scenario with values replaced.

        Args:
            values: path -> value in SI
            source: where the values are from

        Raises:
            ScenarioError: parts that do not exist
        """
        moved = {path: values[path] for path in self.inputs() if path in values}
        references = {path: ref for path, ref in self.references.items() if path not in values}
        spec = self.spec.with_values(values)
        return replace(
            self,
            spec=followed(spec, references, values, self.settable()) if references else spec,
            references=references,
            operating_point={**self.operating_point, **moved},
            value_sources={**self.value_sources, **dict.fromkeys(values, source)},
            uncertainties={path: value for path, value in self.uncertainties.items() if path not in values},
            joint_uncertainties={
                reason: {path: change for path, change in changes.items() if path not in values}
                for reason, changes in self.joint_uncertainties.items()
            },
        )

    def driven(self, given: Mapping[str, Iterable[str]]) -> Scenario:
        """The scenario with other quantities given at its shaft ends."""
        fixed = {end: tuple(quantities) for end, quantities in given.items()}
        return replace(self, spec=self.spec.driven(fixed, self.drives), given=fixed)

    def driven_by(self, names: Iterable[str]) -> Scenario:
        """The scenario driven by those of the named inputs that are shaft quantities, the rest as the rig says."""
        return self.driven(self.deduced_drive(names))

    def deduced_drive(self, names: Iterable[str]) -> dict[str, tuple[str, ...]]:
        """The same as a drive; shafts that turn apart from those named keep what the rig says."""
        shafts = self.shaft_paths()
        named = [name for name in names if name in shafts]
        tied = self.spec.turning_with(name.rpartition(".")[0] for name in named)
        own, apart = ({e: q for e, q in self.given.items() if (e in tied) is so} for so in (True, False))
        return {**apart, **deduce_drive(own, named)}

    def driven_by_torques(self) -> Scenario:
        """The scenario with signed torques given where its loads are."""
        return self.driven({end: ["tau" if q == "load" else q for q in keys] for end, keys in self.given.items()})

    def shaft_paths(self) -> set[str]:
        """Paths of the quantities that may be given at the shaft ends."""
        return {f"{name}.{key}" for name, cls in self.types.items() for key in list_declared(cls, Given)}

    def driven_paths(self) -> set[str]:
        """Paths of the inputs of the model as it is driven: rooms, loads, what is given at the shaft ends."""
        shafts, given = self.shaft_paths(), {f"{end}.{key}" for end, keys in self.given.items() for key in keys}
        return {path for path in self.inputs() if path not in shafts or path in given}

    def entry_values(self, part: str, name: str) -> dict[str, float]:
        """Values in SI by path that a catalogue entry gives a part.

        Args:
            part: name of a part ("oil")
            name: of an entry of its catalogue ("MINR")

        Raises:
            ScenarioError: unknown name, with suggestions
        """
        found = entry_values(self.entry(part, name), settable(self.types[part]))
        if lacking := sorted(self._wanted(part) - found.keys()):
            before = ", ".join(self.entries.get(part, {}).values()) or "what it holds now"
            raise ScenarioError(
                f"{part} = {name}: it lacks {', '.join(lacking)}, which {before} gives. Choose one of the same kind."
            )
        return {f"{part}.{key}": value for key, value in found.items()}

    def following(self, values: Mapping[str, float]) -> dict[str, float]:
        """Values by path in SI, and with them those of the rig that follow from them.

        Args:
            values: path -> value in SI
        """
        references = {path: ref for path, ref in self.references.items() if path not in values}
        spec = followed(self.spec.with_values(values), references, values, self.settable()) if references else self.spec
        found = dict(values)
        for path in references:
            part, _, key = path.rpartition(".")
            if (new := spec.part(part).values[key]) != self.spec.part(part).values[key]:
                found[path] = new
        return found

    def entry_sources(self, part: str, name: str, source: str) -> dict[str, str]:
        """A source for each value that an entry gives a part, with a remark where the value is unchecked.

        Args:
            part: name of a part
            name: of an entry of its catalogue
            source: of the entry, in words

        Raises:
            ScenarioError: unknown name, with suggestions
        """
        found = self.entry(part, name)
        return {path: found.told(path.rpartition(".")[2], source) for path in self.entry_values(part, name)}

    def alternatives(self, part: str) -> tuple[str, ...]:
        """Names of the catalogue entries that may take the place of what a part is filled with.

        Args:
            part: name of a part that is filled from a catalogue, or has values of its own in the place of an entry's

        Raises:
            ScenarioError: there is no such part, or no catalogue fits it
        """
        wanted = self._wanted(part)
        found = tuple(name for name, e in self._known(part).items() if e.values.keys() >= wanted)
        if not found:
            raise ScenarioError(f"{self.name}: no catalogue has values for {part}.")
        return found

    def filled_with(self, part: str) -> tuple[str, ...]:
        """The kinds of catalogue that a part is filled from, or may be filled from as it is."""
        return tuple(dict.fromkeys(entry.kind for entry in self._known(part).values()))

    def _known(self, part: str) -> dict[str, Entry]:
        """The catalogue entries for a part: of the kinds it was filled from; else those of which it takes the most."""
        taken, own = settable(self.spec.types[self.spec.part(part).type]).keys(), self.entries.get(part)
        found = {name: e for kind in own or FILES for name, e in catalogue(kind).items() if e.values.keys() & taken}
        return found if own else {n: e for n, e in found.items() if 2 * len(e.values.keys() & taken) > len(e.values)}

    def _wanted(self, part: str) -> set[str]:
        """Values that an entry must have for a part: those of its own entries; else all that it has and others give."""
        known, own = self._known(part), self.entries.get(part, {}).values()
        given = [e.values.keys() for name, e in known.items() if name in own or not own]
        return {*self.spec.part(part).values} & {key for keys in given for key in keys}

    def entry(self, part: str, name: str) -> Entry:
        """An entry of the catalogues that fit a part.

        Args:
            part: name of a part
            name: of the entry

        Raises:
            ScenarioError: unknown name, with suggestions
        """
        known = self._known(part)
        if name not in known:
            kinds = " or ".join(self.entries.get(part) or self.filled_with(part)) or "entry of a catalogue"
            close = suggestion(name, known) or f" Known: {', '.join(known) or 'none'}."
            raise ScenarioError(f'{part} = {name}: unknown {kinds} "{name}".{close}')
        return known[name]

    def unchecked(self, filled: Iterable[tuple[str, str]] = ()) -> dict[tuple[str, str], tuple[str, ...]]:
        """Catalogue entries in use, by kind and name -> paths of their values never checked against a print.

        Args:
            filled: part and name of further entries that a run fills parts with, such as the oils of a campaign
        """
        others = [self.entry_sources(part, name, "") for part, name in filled]
        found: dict[tuple[str, str], dict[str, None]] = {}
        for path, source in (pair for sources in (self.value_sources, *others) for pair in sources.items()):
            if (entry := unchecked_entry(source)) is not None:
                found.setdefault(entry, {})[path] = None
        return {entry: tuple(paths) for entry, paths in found.items()}


def deduce_drive(given: Mapping[str, tuple[str, ...]], names: Iterable[str]) -> dict[str, tuple[str, ...]]:
    """The drive that follows from the shaft quantities named ("sun.w"), each kind in place of that of `given`.

    Torque and load are one kind. As many quantities as before are given: with two torques named, the speed follows.

    Args:
        given: shaft end -> quantities given there so far
        names: paths of the shaft quantities to be given
    """
    named = [tuple(name.rsplit(".", 1)) for name in names]
    kinds = {quantity == "w" for _, quantity in named}
    before = [(end, quantity) for end, quantities in given.items() for quantity in quantities]
    spare = [(end, quantity) for end, quantity in before if (quantity == "w") not in kinds]
    kept = spare[: max(0, len(before) - len(named))]
    drive: dict[str, tuple[str, ...]] = {}
    for end, quantity in (*kept, *named):
        drive[end] = tuple(dict.fromkeys((*drive.get(end, ()), quantity)))
    return drive


def check_drives(where: str, end: object, ends: Sequence[str]) -> None:
    """Refuse what is no shaft end where power may enter; "" stands for none.

    Args:
        where: place of the name, for messages
        end: its name
        ends: those there are

    Raises:
        ScenarioError: there is no such end
    """
    if end and end not in ends:
        close = suggestion(str(end), ends) or f" Shaft ends: {', '.join(ends) or 'none'}."
        raise ScenarioError(f'{where} = "{end}" is no shaft end.{close}')


def parse_assignments(target: Scenario | FlatModel, texts: Iterable[str]) -> dict[str, float]:
    """Values in SI from texts such as "carrier.w=250 rpm", or "oil=PAOR" for all that a catalogue entry gives a part.

    Args:
        target: a scenario, for what may be set; or a flat model, for any of its quantities, outputs included
        texts: one assignment each

    Raises:
        ScenarioError: all wrong assignments at once
    """
    if isinstance(target, Scenario):
        known = target.settable()
    else:
        known = {path: target.quantity(path) for path in target.index}
    values: dict[str, float] = {}
    problems = Problems()
    for text in texts:
        with problems:
            values |= _parse_assigned(target, known, text)
    problems.check()
    return values


def _parse_assigned(target: Scenario | FlatModel, known: Mapping[str, Quantity], text: str) -> dict[str, float]:
    path, equals, raw = (part.strip() for part in text.partition("="))
    if not (path and equals and raw):
        raise ScenarioError(f'"{text}" is no assignment. Write name=value with its unit, for example "room.T=20 degC".')
    if path in known:
        return {path: in_range("", raw, known[path])}
    parts = [part.name for part in target.spec.parts] if isinstance(target, Scenario) else []
    if isinstance(target, Scenario) and path in parts:
        return target.entry_values(path, raw)
    names, (part, _, kind) = [*known, *parts], path.rpartition(".")
    filled = isinstance(target, Scenario) and part in parts and kind in target.filled_with(part)
    close = f' Write "{part}={raw}".' if filled else suggestion(path, names) or f" Names: {', '.join(names[:8])}, ..."
    raise ScenarioError(f'{target.name}: unknown name "{path}".{close}')
