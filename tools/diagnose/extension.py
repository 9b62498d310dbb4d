"""The extended model as a rig file: the rig as the data calibrate it, with what the top hypothesis adds to it."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from typing import Any

from ...model.machines.spec import PartSpec, Spec
from ...scenarios.scenario import Scenario
from ...scenarios.write import rig_text
from ..effects.cause import Cause, Theta
from ..effects.parts import FIT_PARTS
from ..effects.taxonomy import CAUSES
from ..settings import DIAGNOSED
from . import words
from .findings import Findings
from .habit import HABIT, POWER
from .inputs import Inputs
from .superset import buildable

#: Names of the parts that causes add, here and in the extended rig: a found part can be joined by that of a new search.
ADDED, FOUND = "extra_", "found_"


@dataclass(frozen=True)
class Extension:
    """An extended rig, and what of the hypothesis is no matter of the machine."""

    scenario: Scenario
    outside: tuple[str, ...]


def extended(inputs: Inputs, findings: Findings) -> Extension:
    """The rig with the calibrated values and the causes of the top hypothesis; without an alarm, calibrated only."""
    hypothesis = words.applied(findings)
    rig = inputs.scenario
    known = rig.settable()
    own = _own_oil(inputs)
    calibrated = findings.nominal if hypothesis is None else findings.extended
    values = {path: float(value) for path, value in buildable(calibrated).items() if path in known}
    rig = rig.with_values(own, f"inferred: the oil of {inputs.data.name}")
    source = f"calibrated: diagnosis of {inputs.data.name}"
    rig = rig.with_values(values, source)
    if power := calibrated.get(POWER):
        rig, _ = _added(rig, HABIT, {HABIT.size.name: float(power)}, source, keep_oil=False)
    outside: tuple[str, ...] = ()
    for cause, theta in _causes(findings):
        rig, left = _added(
            rig, cause, theta, f"{DIAGNOSED} {inputs.data.name}, {cause.id}", keep_oil=len(inputs.oils) > 1
        )
        outside += left
    doc = f"{rig.doc}; as diagnosed from {inputs.data.name}: {_said(findings)}."
    spec = replace(rig.spec, doc=doc)
    return Extension(
        replace(rig, doc=doc, spec=spec, protocol=inputs.data.protocol, overrides=(), entries={}, campaign=None),
        outside,
    )


def extended_text(inputs: Inputs, findings: Findings) -> str:
    """The extended rig as the text of a rig file; what is no matter of the machine stands in comments above it."""
    extension = extended(inputs, findings)
    head = [f"Written by `gearheat diagnose` from {inputs.data.name}: {_said(findings)}."]
    head += [f"Verdict: {findings.verdict}; {words.chance(findings.p_any)}."]
    head += [f"Not a matter of the machine, hence not below: {text}" for text in extension.outside]
    return "\n".join(f"# {line}" for line in head) + "\n" + rig_text(extension.scenario)


def _said(findings: Findings) -> str:
    hypothesis = words.applied(findings)
    if hypothesis is None:
        return "calibrated, no cause added"
    return f"{' and '.join(hypothesis.causes)}, probability {words.percent(hypothesis.probability)}"


def _causes(findings: Findings) -> list[tuple[Cause, Theta]]:
    hypothesis = words.applied(findings)
    return [(CAUSES[c], hypothesis.theta[c]) for c in hypothesis.causes if c in CAUSES] if hypothesis else []


def _own_oil(inputs: Inputs) -> Mapping[str, float]:
    """Values of the oil of the data, if there is but one."""
    names = {reading.oil for reading in inputs.data.readings}
    return inputs.oils[next(iter(names))] if len(names) == 1 else {}


def _added(
    scenario: Scenario, cause: Cause, theta: Theta, source: str, *, keep_oil: bool
) -> tuple[Scenario, tuple[str, ...]]:
    """The scenario with a cause, and what of it the machine cannot hold.

    Args:
        scenario: the rig
        cause: what is added, with its parameters `theta`
        source: of the values that it changes
        keep_oil: whether tests run with several oils, each of which keeps its own values
    """
    with_parts = cause.added_to(scenario.spec)
    base = {f"{part.name}.{key}": value for part in with_parts.parts for key, value in part.values.items()}
    parts = {part.name for part in with_parts.parts}
    changed = of_machine(cause, base, theta, parts)
    said = f"{cause.id}, {', '.join(f'{name} = {words.number(value, 4)}' for name, value in theta.items())}."
    if not changed:
        return scenario, (f"{said} {cause.doc}",)
    oil = scenario.protocol.oil if scenario.protocol else "oil"
    several = keep_oil and any(path.startswith(f"{oil}.") for path in changed)
    source = source.replace(DIAGNOSED, "inferred: for the rig's own oil, diagnosis of") if several else source
    names = {part.name: _free(part.name, parts) for part in cause.parts}
    spec = _with_parts(scenario.spec, cause, names)
    own = {f"{part.name}.{key}": value for part in cause.parts for key, value in part.values.items()} | changed
    values = {_renamed(path, names): value for path, value in own.items()}
    lossy = [names[part.name] for part in cause.parts if part.type == "ExtraLoss"]
    losses = {**scenario.losses, **{f"P_{name}_W": (f"{name}.P",) for name in lossy}}
    extended = replace(scenario, spec=spec, losses=losses).with_values(values, source)
    return extended, (f"{said} For the other oils of the data.",) if several else ()


def of_machine(cause: Cause, base: Mapping[str, float], theta: Theta, parts: Collection[str]) -> dict[str, Any]:
    """What a cause changes in a machine with such parts: nothing that depends on the test, nothing of instruments."""
    changed = buildable(cause.values(base, theta, None))
    return {path: v for path, v in changed.items() if path.rpartition(".")[0] in parts}


def _renamed(path: str, names: Mapping[str, str]) -> str:
    """A port or a value of a part under the part's new name."""
    part, _, rest = path.partition(".")
    return f"{names.get(part, part)}.{rest}"


def _free(name: str, taken: set[str]) -> str:
    """A name for a found part that no part of the rig has."""
    wanted = FOUND + name.removeprefix(ADDED)
    number = next(n for n in range(1, len(taken) + 2) if (wanted if n == 1 else f"{wanted}_{n}") not in taken)
    return wanted if number == 1 else f"{wanted}_{number}"


def _with_parts(spec: Spec, cause: Cause, names: Mapping[str, str]) -> Spec:
    """The machine with the parts of a cause under other names."""
    parts = [PartSpec(names[part.name], part.type, part.values) for part in cause.parts]
    nets = [tuple(_renamed(port, names) for port in net) for net in cause.connections]
    return spec.with_parts(parts, nets, FIT_PARTS)
