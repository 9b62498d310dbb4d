"""Values that follow from another part: "stage_1.r_2" in the place of a number with its unit."""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Container, Iterable, Mapping
from contextlib import suppress
from typing import Any

from ..model.core.component import Component, make
from ..model.core.flat import Quantity
from ..model.errors import ScenarioError, suggestion
from ..model.machines.spec import Spec

#: A part and one of its values, or of its `sizes`.
_PATH = re.compile(r"[A-Za-z_]\w*\.[A-Za-z_]\w*")
#: Parts that were asked for last: who varies a value of one asks for the others again as they are.
_RECENT = deque[Component](maxlen=200)


def refers(raw: object, parts: Container[str]) -> bool:
    """Whether a value as it is written stands for that of a part.

    Args:
        raw: text or number
        parts: names of all parts
    """
    return isinstance(raw, str) and _PATH.fullmatch(raw) is not None and raw.partition(".")[0] in parts


def in_order(referring: Mapping[str, Mapping[str, str]]) -> tuple[list[str], list[str]]:
    """Names of parts, each behind those that it refers to, and those that refer to each other in a circle.

    Args:
        referring: part -> key of a value -> path that it refers to
    """
    needs = {name: {ref.partition(".")[0] for ref in references.values()} for name, references in referring.items()}
    found = dict[str, None]()
    while ready := [name for name in needs if name not in found and needs[name] <= found.keys()]:
        found |= dict.fromkeys(ready)
    return list(found), [name for name in needs if name not in found]


def look_up(where: str, path: str, unit: str, types: Mapping[str, type[Component]], values: Mapping[str, Any]) -> float:
    """What a reference stands for, in SI.

    Args:
        where: place of the reference, for messages
        path: part and value, "stage_1.r_2"
        unit: that it must have
        types: part -> its type
        values: of the part that is named, by key

    Raises:
        ScenarioError: the part has no such value, or one of another unit; all that is wrong with the part
    """
    name, _, key = path.partition(".")
    part = make(types[name], name, values)
    _RECENT.append(part)
    sizes, declared = part.sizes(), {**part.parameters, **part.derived}
    if key not in sizes and not (key in declared and key in part.values):
        known = [*sizes, *declared]
        close = suggestion(key, known) or f" Values: {', '.join(known)}."
        raise ScenarioError(f'{where} = "{path}": {name} has no value "{key}".{close}')
    if (own := "m" if key in sizes else declared[key].unit) != unit:
        raise ScenarioError(f'{where} = "{path}" is in {own}, expected {unit}. Name another value, or write a number.')
    return part.number_at(sizes[key], part.values) if key in sizes else float(part.values[key])


def followed(spec: Spec, references: Mapping[str, str], changed: Iterable[str], known: Mapping[str, Quantity]) -> Spec:
    """The spec with the values that follow from those that have changed.

    Args:
        spec: the machine
        references: path -> what it refers to
        changed: paths of values
        known: path -> its quantity
    """
    parts = {path.rpartition(".")[0] for path in changed}
    types = {part.name: spec.types[part.type] for part in spec.parts}
    for _ in references:  # one may follow from another
        moved = {path: ref for path, ref in references.items() if ref.partition(".")[0] in parts}
        found = dict[str, float]()
        for path, ref in moved.items():
            with suppress(ScenarioError):  # said when the machine is made
                values = spec.part(ref.partition(".")[0]).values
                found[path] = look_up(path, ref, known[path].unit, types, values)
        if not found:
            break
        spec, parts = spec.with_values(found), {path.rpartition(".")[0] for path in found}
    return spec
