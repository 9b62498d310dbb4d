"""A rig taken apart into FMUs that exchange heat, as one system in an .ssp file."""

from __future__ import annotations

import hashlib
import tempfile
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from ...fmu.compiling import platforms, store
from ...fmu.description import EXPERIMENT
from ...fmu.equations import effective
from ...fmu.related import PARAMETERS
from ...fmu.ssp import Element, End, System, ssp
from ...model.core.flat import FlatModel, Quantity
from ...model.errors import ScenarioError
from ...model.machines.apart import Pieces, cut_machine
from ...model.run.rows import evaluate_at
from ...scenarios.scenario import Scenario
from ..show.console import lasting, progress_bar, writable
from ..show.endings import fitting
from ..solve.settings import flat_of
from ..solve.steady import first_of
from .fmu import Asked, Exported, write_fmu


def export_system(groups: Sequence[str], asked: Asked) -> Exported:
    """Write a rig as a system of coupled FMUs.

    Args:
        groups: parts of each FMU, "NAME=PART,PART"
        asked: the options of an export
    """
    writable(asked.out)
    lasting(asked.out)
    fitting(asked.out, "a system of FMUs")
    given_up = {"--extras": asked.extras is not None, "--fmi 3": asked.fmi == 3, "--uncertainty": asked.uncertainty}
    given_up |= {"--constant": bool(asked.constants), "--real-time": asked.real_time is not None}
    if refused := [option for option, is_asked in given_up.items() if is_asked]:
        raise ScenarioError([f"{option} does not go with --ssp. Leave it out." for option in refused])
    platforms(asked.platform)
    _, setting, _, start = asked.prepared()
    taken = split_rig(setting, groups_of(groups), start)
    coupled = {piece for joint in taken.pieces.joints for piece in (joint.giver, joint.taker)}
    if alone := [_refuse(setting, name, parts) for name, parts in groups_of(groups).items() if name not in coupled]:
        raise ScenarioError(alone)
    options = asked.options
    with progress_bar() as options["progress"]:
        found = write_system(setting, taken, asked.out, **options)
    rows = [(name, len(fmu["inputs"]), len(fmu["outputs"])) for name, fmu in found["fmus"].items()]
    return Exported(found, heading=f"{asked.out}: {setting.name}", shown=(("FMU", "inputs", "outputs"), rows))


def _refuse(setting: Scenario, name: str, parts: Sequence[str]) -> str:
    """Why parts that pass nothing on are no FMU."""
    inputs = setting.inputs()
    if given := [part for part in parts if f"{part}.T" in inputs]:
        return (
            f"--ssp {name}: would exchange nothing, since the temperature of {', '.join(given)} is given from outside."
            " Leave it in the gearbox, or make it a ClosedRoom, which heat warms."
        )
    return f"--ssp {name}: would exchange nothing with the others. Leave its parts in the gearbox."


@dataclass(frozen=True)
class Taken:
    """A rig taken apart: its pieces, the flat model of each, and the start values of each."""

    pieces: Pieces
    flats: Mapping[str, FlatModel]
    starts: Mapping[str, Mapping[str, float]]


def groups_of(texts: Sequence[str]) -> dict[str, list[str]]:
    """The parts of every FMU, from texts "NAME=PART,PART" or "PART", which is an FMU of that one part and its name.

    Raises:
        ScenarioError: a name appears twice
    """
    found: dict[str, list[str]] = {}
    for text in texts:
        name, _, parts = text.partition("=")
        if name.strip() in found:
            raise ScenarioError(
                f'--ssp: "{name.strip()}" is named twice. Name all its parts at once: {name}=PART,PART.'
            )
        found[name.strip()] = [part.strip() for part in (parts or name).split(",")]
    return found


def split_rig(setting: Scenario, groups: Mapping[str, Sequence[str]], start: Mapping[str, float]) -> Taken:
    """The models of a rig's pieces, all starting where the whole rig does.

    Args:
        setting: the rig as set and driven
        groups: name of an FMU -> its parts
        start: start values of the whole rig that are not those of its model

    Raises:
        ScenarioError: what is wrong with the groups
    """
    whole = flat_of(setting)
    known = {**{q.name: q.start for q in (*whole.states, *whole.inputs)}, **start}
    pieces = cut_machine(setting.spec, groups)
    flats = {name: spec.flat() for name, spec in pieces.specs.items()}
    starts = {
        name: {q.name: known[q.name] for q in (*flat.states, *flat.inputs) if q.name in known}
        for name, flat in flats.items()
    }
    given = {name: _outputs(flat, starts[name]) for name, flat in flats.items()}
    for joint in pieces.joints:
        starts[joint.taker].setdefault(joint.input, given[joint.giver][joint.output])
    return Taken(pieces, flats, starts)


def _outputs(flat: FlatModel, start: Mapping[str, float]) -> dict[str, float]:
    """States and outputs of a model at the start."""
    x, u = (np.array([start.get(q.name, q.start) for q in group]) for group in (flat.states, flat.inputs))
    y = evaluate_at(flat, x, u, flat.starts("parameter"))["y"]
    names = [q.name for q in (*flat.states, *flat.outputs)]
    return dict(zip(names, map(float, [*x, *y]), strict=True))


def write_system(setting: Scenario, taken: Taken, out: Path, **options: Any) -> dict[str, Any]:
    """Write the .ssp file.

    Args:
        setting: the rig as set and driven
        taken: it, taken apart
        out: file to write
        options: of `gearheat.fmu.export.export`

    Returns:
        what was written: the FMUs by name with their inputs and outputs, and the connections
    """
    elements = []
    with tempfile.TemporaryDirectory() as folder:
        for name, flat in taken.flats.items():
            spec = taken.pieces.specs[name]
            own = {part.name for part in spec.parts if part in setting.spec.parts}  # no stand-ins for bodies elsewhere
            entries = {part: kinds for part, kinds in setting.entries.items() if part in own}
            piece = replace(setting, name=name, spec=spec, entries=entries)
            fmu = write_fmu(piece, flat, Path(folder) / f"{name}.fmu", start=taken.starts[name], **options)
            elements.append(_element(piece, effective(flat, taken.starts[name]), taken.pieces, fmu))
    system = _system(setting, taken, elements)
    store(out, ssp(system))
    return {
        "schema": "gearheat.export_ssp/1",
        "rig": setting.name,
        "ssp": str(out),
        "sha256": hashlib.sha256(out.read_bytes()).hexdigest(),
        "fmus": {
            e.name: {"inputs": [q.name for q in e.inputs], "outputs": [q.name for q in e.outputs]} for e in elements
        },
        "connections": [f"{j.giver}.{j.output} -> {j.taker}.{j.input}" for j in taken.pieces.joints],
        "inputs": [q.name for q in system.inputs],
    }


def _element(piece: Scenario, flat: FlatModel, pieces: Pieces, fmu: Path) -> Element:
    """An FMU with its connectors: its inputs and parameters, what it passes, and what a first answer holds."""
    passed = {j.output for j in pieces.joints if j.giver == piece.name}
    passed |= {*first_of(piece, flat, [q.name for q in flat.outputs])}
    outputs = (*flat.states, *(q for q in flat.outputs if q.name in passed))
    with zipfile.ZipFile(fmu) as held:
        values = held.read(PARAMETERS)
    return Element(piece.name, fmu.read_bytes(), flat.inputs, outputs, flat.parameters, values, flat.doc)


def _system(setting: Scenario, taken: Taken, elements: Sequence[Element]) -> System:
    """The system: its inputs are those that no FMU gives to another."""
    pieces = taken.pieces
    connections: list[tuple[End, End]] = [((j.giver, j.output), (j.taker, j.input)) for j in pieces.joints]
    joined = {end for _, end in connections}
    inputs: dict[str, Quantity] = {}
    for element in elements:
        for q in element.inputs:
            if (element.name, q.name) not in joined:
                inputs[q.name] = q
                connections.append(((None, q.name), (element.name, q.name)))
    stop, step = (float(EXPERIMENT[key]) for key in ("stopTime", "stepSize"))
    given = tuple(inputs.values())
    return System(setting.name, setting.doc, tuple(elements), tuple(connections), given, stop, step)
