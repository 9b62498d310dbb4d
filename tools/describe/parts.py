"""What rigs are built of: all about a part type, and the schema of rig files that editors read."""

from __future__ import annotations

import inspect
import math
from collections.abc import Mapping
from functools import cache
from typing import Any

from ...model.core.component import Component
from ...model.core.declare import Choice, Declaration, Input, Output, Parameter, Port, State, list_declared
from ...model.core.flat import Quantity
from ...model.errors import ScenarioError, suggestion
from ...model.files import tables
from ...model.parts import PARTS
from ...model.sources import LawInfo, recording, sources
from ...model.units import example, from_si, show_unit, text, to_si
from ...scenarios.entries import DESCRIPTIVE, Entry, catalogue
from ...scenarios.load import load
from ...scenarios.scenario import Scenario
from ...scenarios.shipped import FILES, list_rigs
from ...scenarios.tables import PartTable, RigTable
from ...scenarios.values import settable
from ..show.display import Answer

#: Parameters that a catalogue entry of a kind brings.
ENTRIES: Mapping[str, str] = {kind: f"name of an entry, see `gearheat list`: values of {kind}s" for kind in FILES}


class PartTypes(Answer):
    """All part types with their roles, or everything about one of them; the table is then of its parameters."""


def parts(kind: str | None = None) -> PartTypes:
    """All part types, or everything about one of them.

    Args:
        kind: name of a type; all types if None

    Raises:
        ScenarioError: there is no such type

    Example:
        >>> import gearheat as gh
        >>> gh.parts("HeatCapacity").found["parameters"][0]["name"]
        'C'
    """
    if kind is None:
        types = [{"type": name, "role": cls.role, "doc": first_line(cls)} for name, cls in PARTS.items()]
        rows = [tuple(t.values()) for t in types]
        every = {"schema": "gearheat.parts/1", "types": types}
        return PartTypes(every, heading="Part types", shown=(("type", "role", "what it is"), rows))
    if kind not in PARTS:
        raise ScenarioError(f'there is no part type "{kind}".{suggestion(kind, PARTS)} See `gearheat parts`.')
    found: dict[str, Any] = {"schema": "gearheat.part/1", **describe_part(kind)}
    head = ("name", "unit", "range", "default", "doc")
    shown = head, [[line[key] for key in head] for line in found["parameters"]]
    return PartTypes(found, heading=f"{kind}: {found['doc']}", shown=shown)


def describe_part(kind: str) -> dict[str, Any]:
    """Ports, parameters, choices, inputs, states, outputs, equations, laws, their spread, an example of a part type."""
    cls = PARTS[kind]
    where, values, entries = _example(kind)
    equations, laws = _inside(cls, values)
    return {
        "type": kind,
        "role": cls.role,
        "doc": inspect.cleandoc(cls.__doc__ or ""),
        "ports": [_port(name, port) for name, port in list_declared(cls, Port).items()],
        "parameters": [_parameter(name, d) for name, d in list_declared(cls, Parameter).items()],
        "choices": [
            {"name": name, "options": [str(o) for o in c.options], "default": _format_value(c.default), "doc": c.doc}
            for name, c in list_declared(cls, Choice).items()
        ],
        **{
            title: [_line(name, d) for name, d in list_declared(cls, of).items()]
            for title, of in (("inputs", Input), ("states", State), ("outputs", Output))
        },
        "entries": [k for k in FILES if any(_fits(e, cls) for e in catalogue(k).values())],
        "equations": equations,
        "laws": laws,
        "spread": [dict(line) for line in cls.spread()],
        "example": _snippet(kind, values, entries),
        "example_from": where,
    }


def _port(name: str, port: Port) -> dict[str, Any]:
    kind = type(port)
    carried = ", ".join(f"{n} [{show_unit(d.unit)}]" for n, d in {**kind.potentials(), **kind.flows()}.items())
    return {"name": name, "type": kind.__name__, "carries": carried, "must_meet": port.needed, "doc": _meaning(port)}


def _meaning(port: Port) -> str:
    return port.doc or first_line(type(port))


def _line(name: str, d: Declaration) -> dict[str, Any]:
    return {"name": name, "unit": show_unit(d.unit), "range": range_of(d.quantity(name)), "doc": d.doc}


def _parameter(name: str, d: Parameter) -> dict[str, Any]:
    left_out = "follows from others" if d.derived else "may be left out" if d.optional else ""
    default = left_out if d.default is None else text(d.default, d.unit)
    return {**_line(name, d), "default": default}


def range_of(q: Quantity) -> str:
    """The values that a quantity may have, in the unit shown."""
    low, high = (f"{from_si(bound, q.unit):.6g}" for bound in (q.low, q.high))
    words = [f"{'above' if q.low_open else 'from'} {low}"] if math.isfinite(q.low) else []
    words += [f"{'below' if q.high_open else 'to'} {high}"] if math.isfinite(q.high) else []
    return " ".join(words)


def _fits(entry: Entry, cls: type[Component]) -> bool:
    """Whether a part takes all that an entry of a catalogue gives, but for what describes it to a reader."""
    return set(entry.values) - set(DESCRIPTIVE.get(entry.kind, {})) <= set(settable(cls))


@cache
def _load_shipped() -> tuple[Scenario, ...]:
    return tuple(load(rig) for rig in list_rigs())


def _example(kind: str) -> tuple[str, dict[str, Any], Mapping[str, str]]:
    """A shipped rig with such a part, its values, and its catalogue entries; "" and typical sizes where none has it.

    The sizes of parts that need some which fit each other are those of a template, the rest nominal ones.
    """
    found: list[tuple[str, dict[str, Any], Mapping[str, str]]] = []
    for scenario in _load_shipped():
        for name in scenario.spec.of_type(kind):
            found.append((scenario.name, dict(scenario.spec.part(name).values), scenario.entries.get(name, {})))
    if found:
        return next((e for e in found if e[2]), found[0])
    known: dict[str, Parameter] = list_declared(PARTS[kind], Parameter)
    needed = {k: d for k, d in known.items() if d.default is None and d.derived is None and not d.optional}
    grown = {k: d.nominal * (1 + i / 2 if d.unit == "m" else 1) for i, (k, d) in enumerate(needed.items())}
    return "", grown | _typical().get(kind, {}), {}


@cache
def _typical() -> dict[str, dict[str, Any]]:
    """Sizes of part types that no shipped rig has, by type, in SI."""
    found: dict[str, dict[str, Any]] = tables("tools.describe", "templates", "parts.toml")
    for kind, sizes in found.items():
        known = settable(PARTS[kind])
        sizes |= {key: to_si(sizes[key], known[key].unit, name=key) for key in sizes.keys() & known.keys()}
    return found


def _inside(cls: type[Component], values: Mapping[str, Any]) -> tuple[list[str], list[dict[str, Any]]]:
    """Names of the equations of a part, and the laws in them with what they cite."""
    with recording() as uses:
        part = cls("part", **values)
        names = [e.name for e in part.equations()]
    used = {use.law.name: use.law for use in (*part.uses, *uses)}
    return names, [law_line(law) for law in used.values()]


def law_line(law: LawInfo) -> dict[str, Any]:
    """A law with what it cites."""
    return {"law": law.name, "source": sources()[law.source].cited, "where": law.where, "valid": law.valid}


def _snippet(kind: str, values: Mapping[str, Any], entries: Mapping[str, str]) -> str:
    """A table of a rig file with these values, and the ports to connect."""
    cls = PARTS[kind]
    lines = ["[part.name]", f'type = "{kind}"', *(f'{k} = "{name}"  # catalogue' for k, name in entries.items())]
    brought = {k for entry, name in entries.items() for k in catalogue(entry)[name].values}
    for key, d in {**settable(cls), **list_declared(cls, Choice)}.items():
        default = d.default if isinstance(d, Parameter | Choice) else None
        if key not in values or key in brought or values[key] == default:
            continue
        written = values[key] if isinstance(d, Choice) or d.unit == "1" else text(values[key], d.unit)
        lines.append(f"{key} = {_toml(written)}  # {d.doc}")
    if len(lines) > 2:
        lines.append('source = "assumed: where these values are from"')
    ports = [f'net_{k} = ["name.{k}", "..."]  # {_meaning(port)}' for k, port in list_declared(cls, Port).items()]
    return "\n".join([*lines, "", "[connect]", *ports]) + "\n"


def _toml(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_toml, value))}]"
    return f"{value:.6g}" if isinstance(value, int | float) else f'"{value}"'


def _format_value(value: Any) -> str:
    return "" if value is None else str(value).lower() if isinstance(value, bool) else str(value)


def first_line(cls: type) -> str:
    """What a class is, in a line."""
    return inspect.cleandoc(cls.__doc__ or "").partition("\n")[0]


def schema() -> dict[str, Any]:
    """JSON schema of a rig file, in which editors check and complete what is typed."""
    found = RigTable.model_json_schema()
    common = PartTable.model_json_schema()["properties"]
    found["$defs"] |= {f"part_{kind}": _part_schema(kind, common) for kind in PARTS}
    own = [{"$ref": f"#/$defs/part_{kind}"} for kind in PARTS]
    named = {"type": "object", "not": {"required": ["type"]}, "description": "a part of the machine named by `kind`"}
    tables = found["properties"]
    tables["part"]["additionalProperties"] = {"anyOf": [*own, named]}
    tables["sensors"]["additionalProperties"] = {
        "anyOf": [{"type": "string"}, tables["sensors"]["additionalProperties"]]
    }
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "gearheat rig file", **found}


def _part_schema(kind: str, common: Mapping[str, Any]) -> dict[str, Any]:
    """Schema of a part of a type; `common` are the keys that all parts have."""
    cls = PARTS[kind]
    properties: dict[str, Any] = {"type": {"const": kind, "description": first_line(cls)}, "use": common["use"]}
    for key, d in settable(cls).items():
        about = ", ".join(filter(None, (d.doc, range_of(d.quantity(key)), show_unit(d.unit) if d.unit != "1" else "")))
        taken = ["number", "string"] if d.unit == "1" else ["string"]
        properties[key] = {"type": taken, "description": about, "examples": [example(d.unit)]}
    for key, c in list_declared(cls, Choice).items():
        plain = [o for o in c.options if isinstance(o, str | bool | int | float)]
        options = {"enum": plain} if plain and len(plain) == len(c.options) and c.also is None else {}
        properties[key] = {"description": c.doc, **options}
    for entry, about in ENTRIES.items():
        properties[entry] = {"type": "string", "description": about, "examples": list(catalogue(entry))[:3]}
    properties |= {key: common[key] for key in ("source", "sources", "uncertainties")}
    return {"type": "object", "properties": properties, "required": ["type"], "additionalProperties": False}
