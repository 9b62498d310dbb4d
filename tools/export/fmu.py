"""A rig as an FMU that starts at its operating point, and what goes beside it."""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import numpy as np

from ...fmu.compiling import platforms
from ...fmu.description import Owner
from ...fmu.equations import effective, fix
from ...fmu.export import export
from ...fmu.leading import Directions
from ...fmu.related import Related
from ...fmu.variables import Choice, Item, drop_idle, start_choice
from ...model.core.flat import FlatModel
from ...model.errors import ScenarioError, SolveError, suggestion
from ...model.run.point import point
from ...model.run.rows import evaluate_at
from ...model.run.steady import steady
from ...scenarios.entries import catalogue
from ...scenarios.given import RigLike, scenario_of
from ...scenarios.scenario import Scenario
from ..show.console import folder, lasting, note, progress_bar, writable
from ..show.display import Answer
from ..show.endings import fitting
from ..show.network import network_svg
from ..solve.sampling import collect_uncertain
from ..solve.settings import Drive, adjust, drive_at, find_unchecked, flat_of
from ..solve.simulate import first_temperatures
from .extras import (
    check_fmu,
    experiment,
    figures_of,
    reference_duty,
    reference_run,
    sets_of_oils,
    text_of,
    write_extras,
)
from .real_time import RealTime, measure

#: Shares of the operating point's torques at which a machine on torques alone is looked for that holds its speed.
_SHARES = (1.0, 0.75, 0.5, 0.25, 0.1, 0.0)
#: Difference of linear standard deviations from those of a mixture above which the latter are proposed.
OFF = 0.1
#: Kind of catalogue that fills parts with oil.
_OIL = "oil"
#: Source of what no file gives.
_DEFAULT = "inferred: follows from the other values, or a numerical default"


@dataclass(frozen=True)
class Asked:
    """What an export is asked for; `drive` and `given` say which shaft end's speed or torque is given."""

    rig: RigLike
    out: Path
    assignments: Sequence[str]
    drive: str | None
    given: str
    platform: str
    extras: Path | None
    owner: Owner
    with_sources: bool
    with_origins: bool
    fmi: int
    audit: bool
    uncertainty: bool
    mixture: bool
    constants: Sequence[str]
    real_time: float | None

    def prepared(self) -> tuple[Scenario, Scenario, FlatModel, dict[str, float]]:
        """The rig, the rig as set and driven, its model, and start values that are not those of the model."""
        scenario = scenario_of(self.rig)
        asked = self.drive is not None or self.given != "speed"
        drive: Drive | None = drive_at(scenario, self.drive, self.given) if asked else None
        setting = adjust(scenario, self.assignments, drive=drive)
        flat = flat_of(setting)
        start = first_temperatures(setting, flat, None) | operating_start(scenario, setting, flat, self.assignments)
        return scenario, setting, flat, start

    @property
    def options(self) -> dict[str, Any]:
        """Options of `fmu.export.export` that every FMU has alike."""
        told: dict[str, Any] = {} if self.with_origins else {"sources": {}, "uncertainties": {}}
        alike = {"owner": self.owner, "with_sources": self.with_sources, "audit": self.audit}
        return told | alike | {"platform": self.platform}


class Exported(Answer):
    """What was written: file, checksum, inputs, outputs, parameters, or FMUs and connections of a system."""

    @property
    def path(self) -> Path:
        """The FMU, or the system of FMUs."""
        return Path(self.found.get("fmu") or self.found["ssp"])


def export_rig(asked: Asked) -> Exported:
    """Write a rig as an FMU. Inputs at the shaft ends follow from the options, else from the names that are set."""
    _refuse_together(asked)
    writable(asked.out)
    lasting(asked.out)
    fitting(asked.out, "an FMU")
    chosen = platforms(asked.platform, asked.fmi)
    scenario, setting, whole, start = asked.prepared()
    hidden = constants_of(whole, asked.constants)
    flat = fix(whole, hidden, start)
    beside = folder(asked.extras) if asked.extras is not None else None
    duty = reference_duty(flat, start, setting.shaft_paths())
    options = asked.options | {"start": start, "fmi": asked.fmi}
    directions: list[Directions] = []
    if asked.uncertainty:
        what = collect_uncertain(setting, flat)
        options["uncertain"] = replace(what, mixture=asked.mixture, tell=directions.append)
    kept, run = effective(flat, start), reference_run(flat, duty, start)
    sets = sets_of_oils(setting, kept, told=asked.with_origins, hidden=hidden)
    options["others"] = Related(sets, experiment(flat, duty, run))
    options["drawn"] = figures_of(setting.spec.assembly(), flat, start, run)
    measured: list[RealTime] = []

    def verify(fmu: Path, code: str) -> Sequence[tuple[str, str]]:
        if asked.real_time is None:
            return check_fmu(fmu, flat, duty, run)
        measured.append(measure(fmu, code, flat, duty, start, asked.fmi, asked.real_time))
        return measured[0].rows

    with progress_bar() as options["progress"]:
        write_fmu(setting, flat, asked.out, hidden=hidden, verify=verify, real_time=asked.real_time, **options)
    named = {q.name for q in kept.parameters}
    origins = sources_of(setting, kept) if asked.with_origins else None
    written = [] if beside is None else write_extras(asked.out, beside, setting, kept, duty, start, origins, hidden)
    choices = drop_idle(choices_of(setting, hidden), kept)
    found: dict[str, Any] = {
        "schema": "gearheat.export/1",
        "rig": scenario.name,
        "fmu": str(asked.out),
        "fmi": f"{asked.fmi}.0",
        "sha256": hashlib.sha256(asked.out.read_bytes()).hexdigest(),
        "platforms": [p.name for p in chosen],
        "inputs": [q.name for q in flat.inputs],
        "outputs": [q.name for q in (*flat.states, *flat.outputs)],
        "deviations": [f"{name}.sd" for name in what.shown] if asked.uncertainty else [],
        "linear_off": _judge_deviations(directions[0], asked.mixture) if directions else None,
        "parameters": [q.name for q in kept.parameters],
        "choices": {c.name: [i.name for i in c.items] for c in choices},
        "without_effect": [q.name for q in flat.parameters if q.name not in named],
        "constants": [q.name for q in whole.parameters if q.name in hidden],
        "real_time": measured[0].as_dict() if measured else None,
        "extras": [str(path) for path in written],
        "unchecked": find_unchecked(setting, flat),
    }
    rows = [(name, kind[:-1]) for kind in ("inputs", "outputs") for name in found[kind]]
    return Exported(found, heading=f"{asked.out}: {scenario.name}", shown=(("name", "causality"), rows))


def _refuse_together(asked: Asked) -> None:
    """Refuse what does not go together."""
    if asked.uncertainty and not asked.with_origins:
        raise ScenarioError(
            "--uncertainty tells how uncertain values are, which --no-parameters-source keeps back. Take one away."
        )
    if asked.mixture and asked.real_time is not None:
        raise ScenarioError(
            "--uncertainty mixture takes three steps in one, more than --real-time bounds. Take one away."
        )
    if asked.out.suffix.lower() == ".ssp":
        raise ScenarioError(
            f"-o {asked.out}: a system (.ssp) has several FMUs. Say with --ssp which parts are one, or write a .fmu."
        )
    if asked.extras is not None and asked.extras.resolve() == asked.out.resolve():
        raise ScenarioError(f"--extras {asked.extras}: is the FMU itself. Give the folder another name.")


def _judge_deviations(found: Directions, mixture: bool) -> float | None:
    """By what share linear standard deviations are off; says what to do about them."""
    if found.off is not None and found.off > OFF and not mixture:
        note(
            f"standard deviations are off by up to {found.off:.0%}, as something switches in the default experiment:"
            " repeat the command with --uncertainty mixture for better ones at three times the cost"
        )
    return found.off


def write_fmu(
    scenario: Scenario,
    flat: FlatModel,
    out: Path,
    drawn: Mapping[str, str] | None = None,
    hidden: Collection[str] = (),
    **options: Any,
) -> Path:
    """Write the FMU of a rig with all that is known of it: sources, uncertainties, its network, its equations.

    Args:
        scenario: the rig as set and driven
        flat: its model
        out: file to write
        drawn: figures beside that of the network, title -> SVG
        hidden: parameters that are constants of the model
        options: of `gearheat.fmu.export.export`
    """
    assembly = scenario.spec.assembly()
    known: dict[str, Any] = {"sources": sources_of(scenario, flat), "uncertainties": scenario.standard_uncertainties}
    known["choices"] = choices_of(scenario, hidden)
    known["parts"] = tuple(text_of(part, hidden) for part in assembly.parts)
    figures = {"Network": network_svg(assembly), **(drawn or {})}
    return export(flat, out, figures=figures, **{**known, **options})


def constants_of(flat: FlatModel, patterns: Sequence[str]) -> set[str]:
    """Names of the parameters that are to be constants: by name, by part, or by a pattern such as "*.z_1".

    Raises:
        ScenarioError: one fits no parameter
    """
    names = [q.name for q in flat.parameters]
    fits = {text: [n for n in names if fnmatchcase(n, text) or n.startswith(f"{text}.")] for text in patterns}
    if wrong := [text for text, found in fits.items() if not found]:
        problem = "--constant {}: there is no such parameter.{} Name a parameter, a part, or a pattern such as *.z_1."
        raise ScenarioError([problem.format(text, suggestion(text, names)) for text in wrong])
    return {name for found in fits.values() for name in found}


def choices_of(scenario: Scenario, hidden: Collection[str] = ()) -> tuple[Choice, ...]:
    """How a run begins; for each part that holds oil, the oils of the catalogue that give it all that its own does.

    Args:
        scenario: the rig
        hidden: parameters that are constants of the model; an oil's cannot be chosen
    """
    room = scenario.room if scenario.room in scenario.driven_paths() else None
    filled = [part.name for part in scenario.spec.parts if _OIL in scenario.filled_with(part.name)]
    oils = [_oil(scenario, part) for part in filled]
    free = [oil for oil in oils if not any(item.values.keys() & hidden for item in oil.items)]
    return (start_choice(room), *free)


def _oil(scenario: Scenario, part: str) -> Choice:
    known = catalogue(_OIL)
    own = Item("as exported", "the start values of the parameters")
    others = (
        Item(name, known[name].doc, scenario.following(scenario.entry_values(part, name)))
        for name in scenario.alternatives(part)
    )
    return Choice(f"{part}.{_OIL}", "the oil filled in", (own, *others))


def sources_of(scenario: Scenario, flat: FlatModel) -> dict[str, str]:
    """Where the value of every parameter is from."""
    return {q.name: scenario.value_sources.get(q.name, _DEFAULT) for q in flat.parameters}


def operating_start(
    scenario: Scenario, setting: Scenario, flat: FlatModel, assignments: Sequence[str]
) -> dict[str, float]:
    """Shaft quantities and states at the operating point, for a model that is driven otherwise than its rig.

    What follows at the operating point (the torque that balances, the speed of the other shaft) is what the inputs and
    the rotating masses of the other drive start with, so that it starts at the same point. With torques alone nothing
    but friction holds the speed, so there it starts where friction does (see `_holding`), unless the user has set a
    torque or a speed.

    Args:
        scenario: the rig as it is
        setting: the rig as set and driven by the user
        flat: its model
        assignments: what the user has set, which stays
    """
    own = flat_of(setting.driven(scenario.given))
    names = setting.shaft_paths()
    fixed = {text.partition("=")[0].strip() for text in assignments}
    if {q.name for q in own.inputs} & names == {q.name for q in flat.inputs} & names:
        return {}
    masses = {q.name for q in flat.states if q.unit == "rad/s"}
    if masses and not fixed & (names | masses):
        free = masses | names | first_temperatures(setting, flat, None).keys()
        return {name: value for name, value in _holding(own, flat, names).items() if name in free - fixed}
    at = _evaluate(own, first_temperatures(setting, own, None))
    shafts = {name: at[name] for name in sorted(names) if name in at}
    start = {q.name: shafts[q.name] for q in flat.inputs if q.name in shafts and q.name not in fixed}
    return start | _speeds(flat, shafts, {q.name for q in flat.states} & fixed)


def _holding(own: FlatModel, flat: FlatModel, names: set[str]) -> dict[str, float]:
    """Torques and states of an equilibrium that the machine does not leave by itself.

    Friction that falls with speed or with its own heat lets a loaded machine run away or stop as long as both torques
    stay, so the equilibrium may be one of a part of the load. A machine that holds no speed at all starts at rest.

    Args:
        own: the model driven as its rig
        flat: the model driven by torques
        names: paths of what may be given at the shaft ends
    """
    torques = [q.name for q in flat.inputs if q.name in names]
    for share in _SHARES:
        load = {q.name: share * q.start for q in own.inputs if q.name in names and q.unit == "N.m"}
        try:
            at = steady(own, load)
            balancing = {name: float(at[name][0]) for name in torques}
            shafts = {name: float(at[name][0]) for name in names & at.columns.keys()}
            warm = {q.name: float(at[q.name][0]) for q in flat.states if q.name in at.columns}
            speeds = _speeds(flat, shafts, set())
            found = steady(flat, balancing, guess=warm | speeds)
        except SolveError:
            continue
        if any(abs(float(found[name][0])) < 0.1 * abs(speed) for name, speed in speeds.items()):
            continue  # it has come to rest, where friction holds any load
        return balancing | {q.name: float(found[q.name][0]) for q in flat.states}
    return dict.fromkeys([*torques, *(q.name for q in flat.states if q.unit == "rad/s")], 0.0)


def _evaluate(flat: FlatModel, states: Mapping[str, float]) -> dict[str, float]:
    """Inputs and outputs of a model at its start values."""
    here = point(flat, None, states, who="export")
    y = evaluate_at(flat, here.x, here.u, here.p)["y"]
    return {q.name: float(v) for q, v in (*zip(flat.inputs, here.u, strict=True), *zip(flat.outputs, y, strict=True))}


def _speeds(flat: FlatModel, shafts: Mapping[str, float], fixed: set[str]) -> dict[str, float]:
    """Speeds of the rotating masses at which the shaft ends have their speeds; these are linear in those."""
    masses = [q.name for q in flat.states if q.unit == "rad/s" and q.name not in fixed]
    ends = [q.name for q in flat.outputs if q.name in shafts and q.unit == "rad/s"]
    if not masses or not ends:
        return {}
    rest = _evaluate(flat, dict.fromkeys(masses, 0.0))
    columns = [_evaluate(flat, {name: float(name == one) for name in masses}) for one in masses]
    slope = np.array([[column[end] - rest[end] for column in columns] for end in ends])
    wanted = np.array([shafts[end] - rest[end] for end in ends])
    speeds = np.linalg.lstsq(slope, wanted, rcond=None)[0]
    return {name: float(w) for name, w in zip(masses, speeds, strict=True)}
