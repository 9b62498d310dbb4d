"""A scenario as a rig file that every command reads: what an extension changed, written down part by part."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any

from ..model.core.component import Component
from ..model.core.declare import Choice, list_declared
from ..model.core.flat import Quantity
from ..model.errors import ScenarioError
from ..model.laws.film_map import FilmMap
from ..model.machines.spec import PartSpec
from .entries import Entry, entry
from .references import look_up
from .scenario import DRIVES, Instrument, Scenario
from .values import UNCERTAINTIES, entry_values, settable

#: Choices that follow from [drive].
_DRIVEN = ("given", "dynamic", "drives")

#: Source of the values that the user sets; they hold for every test, whatever oil it ran with.
SET = "set on the command line"
#: Beginning of the source of a value that a diagnosis changed; it holds for every test, whatever oil it ran with.
DIAGNOSED = "inferred: diagnosis of"
#: Source of a value that an extension set without saying more.
_EXTENSION = "assumed: set by an extension of the rig"


def rig_text(scenario: Scenario) -> str:
    """The text of a rig file of kind "network" that loads as the same machine; measured data are left out."""
    return "\n".join(_lines(scenario)) + "\n"


def _lines(scenario: Scenario) -> Iterator[str]:
    yield 'kind = "network"'
    yield f"doc = {_toml(scenario.doc)}"
    yield from _table("drive", scenario.given) or ["", "[drive]"]  # a rig file has these two, even empty
    known = scenario.settable()
    point = {path: _value(value, known[path].unit) for path, value in scenario.operating_point.items()}
    sources = {path: _source(scenario, path) for path in point}
    drives = {DRIVES: scenario.drives} if scenario.drives else {}
    yield from _table("operating_point", point | drives, sources=sources) or ["", "[operating_point]"]
    for part in scenario.spec.parts:
        cls = scenario.spec.types[part.type]
        entries = _entries(scenario, part, cls)
        values = {k: v for k, v in _part_values(scenario, part, cls).items() if k not in _told(scenario, part, entries)}
        sources = {key: _source(scenario, f"{part.name}.{key}") for key in values}
        uncertainties = _uncertainties(scenario, part, cls)
        whole = {"type": part.type} | {kind: found.name for kind, found in entries.items()} | values
        yield from _table(f"part.{_key(part.name)}", whole, sources=sources, more=uncertainties)
    yield from _table("connect", {f"net_{i}": ports for i, ports in enumerate(_nets(scenario.spec.connections), 1)})
    for instrument in scenario.instruments:
        yield from _table(f"sensors.{_key(instrument.name)}", _sensor(instrument, scenario.readable()))
    yield from _table("losses", scenario.losses)
    for reason, changes in scenario.joint_uncertainties.items():
        values = {path: _value(change, known[path].unit) for path, change in changes.items()}
        yield from _table(f"{UNCERTAINTIES}.{_key(reason)}", values)
    if (protocol := scenario.protocol) is not None:
        about: dict[str, Any] = {"stop": f"{protocol.stop!r} s", "room": protocol.room, "oil": protocol.oil}
        about |= {"notes": list(protocol.notes)} if protocol.notes else {}
        yield from _table("campaign", about | {"source": f"assumed: as in the rig {scenario.name}"})
        for path, driven in protocol.inputs.items():
            yield from _table(f"campaign.inputs.{_toml(path)}", vars(driven))
    for erratum in scenario.errata:
        yield from _table("[errata]", vars(erratum))


def _nets(connections: Sequence[tuple[str, ...]]) -> list[tuple[str, ...]]:
    """Groups of ports that meet; what was added at a port joins its group, as a rig file names a port once."""
    nets: list[tuple[str, ...]] = []
    for ports in connections:
        at = next((k for k, net in enumerate(nets) if not {*net}.isdisjoint(ports)), len(nets))
        nets[at : at + 1] = [tuple(dict.fromkeys((*sum(nets[at : at + 1], ()), *ports)))]
    return nets


def _sensor(instrument: Instrument, units: Mapping[str, Quantity]) -> dict[str, Any]:
    """What the rig file states of an instrument; the rest follows again when it is read."""
    stated = {"column": instrument.column, "reads": instrument.reads, "kind": instrument.kind, "role": instrument.role}
    stated |= {"unit": instrument.unit}
    found: dict[str, Any] = {key: text for key, text in stated.items() if text}
    found |= {} if instrument.signs is None else {"signs": list(instrument.signs)}
    found |= {"magnitude": True} if instrument.magnitude and instrument.signs is None else {}
    spreads = {key: getattr(instrument, key) for key in ("repeat_sd", "offset_sd")}
    unit = units[instrument.reads].unit
    return found | {key: str(_value(sd, unit)) for key, sd in spreads.items() if sd is not None}


def _entries(scenario: Scenario, part: PartSpec, cls: type[Component]) -> dict[str, Entry]:
    """Entries that a part is filled from, by kind, of those that give it nothing it does not have."""
    found = {kind: entry(kind, name) for kind, name in scenario.entries.get(part.name, {}).items()}
    return {kind: e for kind, e in found.items() if e.values.keys() & settable(cls).keys() <= part.values.keys()}


def _told(scenario: Scenario, part: PartSpec, entries: Mapping[str, Entry]) -> set[str]:
    """The values of a part that its entries tell, value and source."""
    cls = scenario.types[part.name]
    told = {
        k: (v, e.told(k, e.sources[k])) for e in entries.values() for k, v in entry_values(e, settable(cls)).items()
    }
    return {k for k, known in told.items() if known == (part.values[k], _source(scenario, f"{part.name}.{k}"))}


def _reference(scenario: Scenario, path: str, value: Any, unit: str) -> str | None:
    """What a value follows from, where it still does."""
    ref = scenario.references.get(path)
    if ref is None or (name := ref.partition(".")[0]) not in scenario.types:
        return None
    with suppress(ScenarioError):
        if look_up(path, ref, unit, scenario.types, scenario.spec.part(name).values) == value:
            return ref
    return None


def _part_values(scenario: Scenario, part: PartSpec, cls: type[Component]) -> dict[str, Any]:
    """Values with units, what they follow from, and choices of a part."""
    declarations, choices = settable(cls), list_declared(cls, Choice)
    values = {
        k: _reference(scenario, f"{part.name}.{k}", v, declarations[k].unit) or _value(v, declarations[k].unit)
        for k, v in part.values.items()
        if k in declarations
    }
    chosen = {k: v for k, v in part.values.items() if k in choices and k not in _DRIVEN}
    return values | {k: str(v) if isinstance(v, FilmMap) else v for k, v in chosen.items()}


def _uncertainties(scenario: Scenario, part: PartSpec, cls: type[Component]) -> dict[str, Any]:
    """Standard uncertainties of a part with units, as an inline table of the rig file."""
    declarations = settable(cls)
    known = {key: scenario.uncertainties.get(f"{part.name}.{key}") for key in part.values if key in declarations}
    found = {key: _value(u, declarations[key].unit) for key, u in known.items() if u is not None}
    return {UNCERTAINTIES: found} if found else {}


def _value(value: float, unit: str) -> Any:
    return value if unit == "1" else f"{float(value)!r} {unit.removesuffix(' (difference)')}"


def _source(scenario: Scenario, path: str) -> str:
    return scenario.value_sources.get(path, _EXTENSION)


def _table(
    name: str,
    entries: Mapping[str, Any],
    *,
    sources: Mapping[str, str] | None = None,
    more: Mapping[str, Mapping[str, Any]] | None = None,
) -> list[str]:
    """A table, with the sources of its values and whatever else is known of them as inline tables; none if empty."""
    if not entries:
        return []
    lines = ["", f"[{name}]", *(f"{_key(key)} = {_toml(value)}" for key, value in entries.items())]
    inline = {"sources": sources or {}, **(more or {})}
    said = {n: ", ".join(f"{_key(key)} = {_toml(value)}" for key, value in t.items()) for n, t in inline.items()}
    return [*lines, *(f"{n} = {{ {text} }}" for n, text in said.items() if text)]


def _key(key: str) -> str:
    return key if key.isascii() and key.isidentifier() else _toml(key)


def _toml(value: Any) -> str:
    """A value as TOML: what JSON writes for text, lists, numbers and truth is TOML as well."""
    return json.dumps(value, ensure_ascii=False)
