"""The extended model as a rig file: the rig as the data calibrate it, with what the causes change and add.

Faults of instruments and of the procedure, and what differs from test to test, are no matter of the machine: they stand
in comments above it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...model.core.component import Component
from ...model.core.declare import Output, Parameter, declared
from ...model.machines.spec import PartSpec
from ...scenarios.scenario import Scenario
from ...scenarios.write import DIAGNOSED, rig_text
from ..library.cause import Cause, Form, Row, Theta
from . import phrases
from .names import name_of

#: Names of the parts that causes add, here and in the extended rig: a found part can stand beside that of a new search.
ADDED, FOUND = "extra_", "found_"


@dataclass(frozen=True)
class Applied:
    """A cause in the form and with the size and shapes that were found."""

    cause: Cause
    form: Form
    theta: Theta

    @property
    def told(self) -> str:
        """Cause, form and parameters."""
        form = f" ({self.form.name})" if self.form.name else ""
        values = ", ".join(f"{name} = {phrases.number(float(v), 4)}" for name, v in self.theta.items())
        return f"{self.cause.id}{form}, {values}"


class _Readings(dict[str, float]):
    """Readings of any sensor."""

    def __init__(self, value: float) -> None:
        super().__init__()
        self.value = value

    def __missing__(self, sensor: str) -> float:
        return self.value


def extended_rig(
    scenario: Scenario,
    calibrated: Mapping[str, float],
    applied: Sequence[Applied],
    data: str,
    types: Mapping[str, type[Component]],
    oils: int = 1,
    also: Sequence[Applied] = (),
) -> str:
    """The text of a rig file that every command reads.

    Args:
        scenario: the rig
        calibrated: path -> value as the data calibrate it, with the causes [SI]
        applied: the causes
        data: name of the data
        types: types of parts that causes add, by name
        oils: how many oils the tests ran with
        also: what calibration adds to the rig
    """
    known = scenario.settable()
    values, notes = {}, []
    for path, value in calibrated.items():
        if path in known:
            values[path] = float(np.clip(value, known[path].low, known[path].high))
            if values[path] != float(value):
                notes.append(f"{path} would be {phrases.number(float(value), 4)}; no more than this is possible.")
    rig = scenario.with_values(values, f"calibrated: diagnosis of {data}")
    for one in (*also, *applied):
        rig, left = _added(rig, one, data, types, oils)
        notes += left
    causes = " and ".join(f"{name_of(a.cause.id)} ({a.cause.id})" for a in applied) or "calibrated, no cause added"
    doc = f"{rig.doc.rstrip('.')}; as diagnosed from {data}: {causes}."
    head = [f"Written by `gearheat diagnose` from {data}: {causes}.", *notes]
    clean = replace(rig, doc=doc, spec=replace(rig.spec, doc=doc), overrides=(), entries={})
    return "\n".join(f"# {line}" for line in head) + "\n" + rig_text(clean)


def _added(
    scenario: Scenario, one: Applied, data: str, types: Mapping[str, type[Component]], oils: int
) -> tuple[Scenario, list[str]]:
    """The scenario with a cause, and what of it the machine cannot hold."""
    form, outside = one.form, f"Not a matter of the machine, hence not below: {one.told}."
    with_parts = scenario.spec.with_parts(form.parts, form.connections, types)
    declarations = {p.name: declared(with_parts.types[p.type], Parameter) for p in with_parts.parts}
    base = {f"{name}.{key}": d.default for name, own in declarations.items() for key, d in own.items()}
    base |= {f"{p.name}.{key}": value for p in with_parts.parts for key, value in p.values.items()}
    changed = None if form.spread else _changed(form, one.theta, base)
    if not changed:
        differs = (
            f"{outside} It differs from test to test." if form.values is not None else f"{outside} {one.cause.doc}"
        )
        return scenario, [differs]
    names = _names(form.parts, {p.name for p in scenario.spec.parts})
    parts = [replace(p, name=names[p.name]) for p in form.parts]
    nets = [tuple(_renamed(port, names) for port in net) for net in form.connections]
    neutral = {f"{p.name}.{key}": value for p in form.parts for key, value in p.values.items()}
    values = {_renamed(path, names): value for path, value in (neutral | changed).items()}
    lossy = [p.name for p in parts if "P" in declared(types[p.type], Output) and hasattr(types[p.type], "shaft")]
    losses = {**scenario.losses, **{f"P_{name}_W": (f"{name}.P",) for name in lossy}}
    oil = {path.rpartition(".")[0] for path in changed} & {n for n, kinds in scenario.entries.items() if "oil" in kinds}
    notes = [f"{one.told}: the values below are of the rig's own oil; others change alike."] if oil and oils > 1 else []
    source = f"inferred: for the rig's own oil, diagnosis of {data}" if notes else f"{DIAGNOSED} {data}, {one.cause.id}"
    if form.shown is not None or form.truth is not None or form.pace is not None:
        notes.append(f"{outside} Its part in the machine is below.")
    spec = scenario.spec.with_parts(parts, nets, types)
    return replace(scenario, spec=spec, losses=losses).with_values(values, source), notes


def _changed(form: Form, theta: Theta, base: Mapping[str, float]) -> dict[str, float] | None:
    """Values that a form changes in every test alike; None where it depends on the test or changes none."""
    if form.values is None:
        return None
    rows = (Row(base, _Readings(300.0)), Row(base, _Readings(320.0), 1.0, -1.0, 55.0, 0.7, 1.0))
    first, second = ({path: float(v) for path, v in form.values(theta, row).items()} for row in rows)
    return first if first == second else None


def _names(parts: Sequence[PartSpec], taken: set[str]) -> dict[str, str]:
    """Names for found parts that no part of the rig has."""
    names: dict[str, str] = {}
    for part in parts:
        wanted, held = FOUND + part.name.removeprefix(ADDED), taken | set(names.values())
        numbered = (wanted, *(f"{wanted}_{n}" for n in range(2, len(held) + 3)))
        names[part.name] = next(name for name in numbered if name not in held)
    return names


def _renamed(path: str, names: Mapping[str, str]) -> str:
    """A port or a value of a part under the part's new name."""
    part, _, rest = path.partition(".")
    return f"{names.get(part, part)}.{rest}"
