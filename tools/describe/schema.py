"""The schema of rig files that editors read, from the tables of `scenarios.tables` and the part types."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...model.core.declare import Choice, list_declared
from ...model.parts import PARTS
from ...model.units import example, show_unit
from ...scenarios.entries import catalogue
from ...scenarios.shipped import FILES
from ...scenarios.tables import PartTable, RigTable
from ...scenarios.values import settable
from .parts import first_line, range_of

#: Parameters that a catalogue entry of a kind brings.
ENTRIES: Mapping[str, str] = {kind: f"name of an entry, see `gearheat list`: values of {kind}s" for kind in FILES}


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
