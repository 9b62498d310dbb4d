"""The export of a rig, as an FMU or as a system of FMUs, and FMUs played over a duty."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from ...fmu.described import Described, describe, settable
from ...fmu.description import Owner
from ...model.errors import FmuError, Problems, ScenarioError, suggestion
from ...model.units import to_si
from ...scenarios.duty import read_duty
from ...scenarios.given import RigLike, Settings, assignments_of, in_seconds, listed, scenario_of
from ...scenarios.values import in_range
from ..show.console import note
from ..solve.settings import refuse_given
from ..solve.simulate import (
    Duty,
    TimeSeries,
    duty_file,
    far_in,
    finer,
    held_over,
    output_step,
    over_the_duty,
    rows_shown,
)
from .fmu import Asked, Exported, export_rig
from .systems import export_system


def export(
    rig: RigLike,
    out: str | Path,
    *,
    fmi: int = 2,
    set: Settings = (),
    drive: str | None = None,
    given: str = "speed",
    platform: str | Sequence[str] = "host,win64",
    license: str = "",
    author: str = "",
    model_version: str = "",
    date: str = "",
    sources: bool = True,
    audit: bool = True,
    parameters_source: bool = True,
    extras: str | Path | None = None,
    uncertainty: bool | str = False,
    constant: str | Sequence[str] = (),
    real_time: str | None = None,
    ssp: Sequence[str] = (),
) -> Exported:
    """Write a rig as an FMU for FMI 2.0 or 3.0, or as a system of FMUs.

    Args:
        rig: name, file or rig
        out: file to write, .fmu, or .ssp for a system
        fmi: version of the standard, 2 or 3
        set: values by name: texts with units, quantities of pint, or numbers in SI
        drive: shaft end that drives; the rig's own if None
        given: "speed": speed and torque of the driving shaft are inputs; "torque": the torques of all shaft ends are
        platform: "host", "all" or names such as "linux64,win64"; of FMI 3.0 "wasm32" as well
        license: licence under which it is given away
        author: who answers for it
        model_version: version of the model
        date: date and time, such as "2026-01-31T12:00:00Z"
        sources: with its C source
        audit: with two states that integrate the energy across the boundary
        parameters_source: telling where values are from
        extras: folder for parameter sets and a reference result
        uncertainty: with standard deviations, such as oil.T.sd: "linear" (True) or "mixture"
        constant: parameters that become constants of its code, by name, part or pattern, and stand in no file of it
        real_time: longest communication step, such as "10 ms", in which its solver takes one step without control of
            its error; what that costs at most and what it is wrong by are told
        ssp: parts of each FMU of a system, "NAME=PART,PART"; the rest is one FMU

    Raises:
        GearheatError: all that is wrong with what is asked

    Example:
        >>> import gearheat as gh
        >>> gh.export("planetary", "planetary.fmu", fmi=3)  # doctest: +SKIP
    """
    if fmi not in (2, 3) or isinstance(fmi, float):
        raise ScenarioError(f"--fmi {fmi}: there is FMI 2 and FMI 3. Give one of the two numbers.")
    if uncertainty not in (False, True, "linear", "mixture"):
        raise ScenarioError(f"--uncertainty {uncertainty}: is neither linear nor mixture.")
    told = {"--author": author, "--license": license, "--model-version": model_version}
    if wrong := [option for option, text in told.items() if not text.isprintable()]:
        raise ScenarioError([f"{option} has characters that cannot be seen. Take them out." for option in wrong])
    scenario = scenario_of(rig)
    asked = Asked(
        scenario,
        Path(out),
        assignments_of(set, scenario.settable),
        drive,
        given,
        ",".join(listed(platform, "platform")),
        None if extras is None else Path(extras),
        owner=Owner(author, model_version, license, date),
        with_sources=sources,
        with_origins=parameters_source,
        fmi=fmi,
        audit=audit,
        uncertainty=bool(uncertainty),
        mixture=uncertainty == "mixture",
        constants=listed(constant),
        real_time=None if real_time is None else _task(real_time),
    )
    return export_system(ssp, asked) if ssp else export_rig(asked)


#: Longest step of a task in real time [s].
LONGEST_STEP = 60.0


def _task(text: str) -> float:
    step = to_si(text, "s", name="--real-time")
    if not 0 < step <= LONGEST_STEP:
        raise ScenarioError(f"--real-time {text}: must be above 0 and at most {LONGEST_STEP:g} s.")
    return step


def play(
    fmu: str | Path, duty: Duty, *, step: Any = 60.0, set: Settings = (), trust: bool = False, every: Any = None
) -> TimeSeries:
    """Play an FMU over a duty; one that was not made here only if it is trusted.

    Args:
        fmu: its file
        duty: CSV file with time and inputs, units in the header, or a DataFrame with the same column names
        step: communication step, such as "10 s", or a number [s]
        set: start values of parameters and states by name
        trust: run native code of an FMU that was not made here
        every: time between two rows, such as "10 min"; a step if None, more where the duty has above 20,000 of them

    Raises:
        GearheatError: all that is wrong with FMU, duty or what is set; the run fails

    Example:
        >>> import gearheat as gh
        >>> gh.play("planetary.fmu", "duty.csv").plot("oil.T")  # doctest: +SKIP
    """
    from ...fmu.apart import play_apart
    from ...fmu.described import is_trusted
    from ...fmu.play import play as play_fmu

    fmu = Path(fmu)
    dt = in_seconds(step, "--step")
    about = describe(fmu)
    made_by = about.description.generationTool or "an unknown tool"
    if not (ours := is_trusted(fmu)):
        if not trust:
            raise FmuError(
                f"{fmu}: was not made by gearheat on this machine (but by {made_by}), and playing it runs native code"
                " of it with your rights. Add --trust if you trust its maker."
            )
        note(f"{fmu}: running native code of {made_by}")
    with duty_file(duty) as path:
        schedule = read_duty(path, ports := about.quantities("input"))
        refuse_given(set, schedule.values, path.name)
        start = _start(about, assignments_of(set, lambda: about.quantities("start")))
        first = start | {name: float(values[0]) for name, values in schedule.values.items()}
        start = _at_room(about, first) | start
    inputs = {name: (schedule.time, values) for name, values in schedule.values.items()}
    run = partial(play_fmu, about) if ours else partial(play_apart, fmu)
    between = output_step(schedule, every, dt)
    fine = between / finer(schedule, between, dt)
    times = None if fine == dt else schedule.even(fine)
    played = run(inputs, schedule.stop, dt, begin=schedule.start, start=start, output_times=times)
    units = {name: q.unit for name, q in about.quantities("input", "output").items()}
    columns = {name: played.values[:, k] for k, name in enumerate(played.names)}
    before = {"schema": "gearheat.play/1", "fmu": str(fmu), "out": None, "plot": None}
    made_here = _of_gearheat(about)
    usual = {name: float(about.variables[name].start or 0.0) for name in inputs if made_here}
    behind = {"far": far_in(path.name, schedule, usual, "the FMU")}
    shown = about.quantities("output")
    warm = {name: columns[name] for name, q in shown.items() if q.unit == "K"}
    lost = [columns[n] for n in shown if n.endswith(".P_loss") and f"{n.removesuffix('P_loss')}eta" in shown]
    held = [replace(q, start=float(about.variables[n].start or 0.0)) for n, q in ports.items() if n not in first]
    told = [*held_over(held, "in the FMU"), *over_the_duty(played.time, warm, lost[0] if lost else None)]
    said = told if made_here else []
    rows = rows_shown(played.time, schedule, between)
    columns = {name: column[rows] for name, column in columns.items()}
    return TimeSeries(f"{fmu.stem}, {path.stem}", played.time[rows], columns, units, (before, behind), said)


def _of_gearheat(about: Described) -> bool:
    return (about.description.generationTool or "").startswith("gearheat")


def _at_room(about: Described, first: Mapping[str, float]) -> dict[str, float]:
    """Start temperatures of an FMU of gearheat that are its room's, where the run gives the room another one.

    Args:
        about: description of the FMU
        first: what the run sets, and the first value of what it gives
    """
    if not _of_gearheat(about):
        return {}
    warm = [v for v in about.variables.values() if v.unit == "K" and v.start and settable(v)]
    rooms = {float(v.start): first[v.name] for v in warm if v.causality == "input" and v.name in first}
    states = [v for v in warm if v.causality in ("output", "local") and float(v.start) in rooms]
    return {v.name: rooms[float(v.start)] for v in states}


def _start(about: Described, assignments: Sequence[str]) -> dict[str, float]:
    """Start values from texts NAME=VALUE, in SI. Raises ScenarioError with all problems at once."""
    known, shown, wholes = about.quantities("start"), about.quantities("output"), about.wholes()
    values: dict[str, float] = {}
    ours = _of_gearheat(about)
    problems = Problems()
    for text in assignments:
        name, _, written = (part.strip() for part in text.partition("="))
        if name in values:
            problems.append(f'"{name}" is set twice. Set it once.')
        with problems:
            if name in wholes:
                values[name] = _parse_whole(name, written, wholes[name])
            elif name in known:
                values[name] = in_range("", written, known[name], sensible=ours)
            else:
                filled = [f' Write "{one}={written}".' for one in wholes if wholes[one] and one.startswith(f"{name}.")]
                close = filled[0] if filled else suggestion(name, [*known, *wholes])
                why = f" It is calculated: {shown[name].doc}." if name in shown else close
                problems.append(f'{about.path.name}: "{name}" cannot be set.{why}')
    problems.check()
    return values


def _parse_whole(name: str, written: str, items: Mapping[str, int]) -> int:
    """A whole number, or that of an item by its name."""
    if written in items:
        return items[written]
    if items:
        raise ScenarioError(f'{name} = "{written}" is not known. Choose one of: {", ".join(items)}.')
    try:
        return int(written)
    except ValueError:
        raise ScenarioError(f'{name} = "{written}" is no whole number.') from None
