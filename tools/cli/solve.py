"""What a rig does: steady states, runs over time, designs, sweeps, maps and ratings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

import gearheat as gh

from ...model.errors import ScenarioError
from ..show import console
from ..show.display import Display
from ..show.endings import fitting
from ..show.notes import print_outside

#: What is said where a machine runs against what its rig is meant for.
BACKWARD = (
    "power flows the other way than the rig file means it: a sign may be wrong. A load without a sign is set by"
    ' --set "END.load=... N.m", and --set drives=END says where power enters.'
)


def steady(
    rig: str,
    set_: list[str] | None = None,
    extended: Path | None = None,
    plot: Path | None = None,
    everything: bool = False,
    json: str | None = None,
) -> None:
    """Steady temperatures and losses at one operating point."""
    console.plottable(plot)
    state = gh.steady(extended or rig, set_ or [])
    found = _write_picture(state.as_dict(), plot, state)
    shows = list(state.result.columns) if everything else state.first
    console.answer(found, json, lambda: _print_point(state.title, state.rows(shows), found, state.headlines))


def simulate(
    rig: str,
    duty: Path,
    out: Path,
    set_: list[str] | None = None,
    every: str | None = None,
    plot: Path | None = None,
    json: str | None = None,
) -> None:
    """Temperatures and losses over a duty cycle."""
    fitting(out, "a table")
    console.writable(out)
    console.plottable(plot)
    run = gh.simulate(rig, duty, set_ or [], every=every)
    print_run(run, out, plot, json)


def design(
    rig: str,
    target: list[str],
    free: list[str] | None = None,
    among: list[str] | None = None,
    set_: list[str] | None = None,
    extended: Path | None = None,
    everything: bool = False,
    json: str | None = None,
) -> None:
    """Find parameters or inputs for which outputs reach their targets."""
    if len(among or []) > 1:
        raise ScenarioError("--among can be given once. Write all names behind it, for example oil=PAOR,MINR,PAGD.")
    answer = gh.design(extended or rig, free or [], target, set=set_ or [], among=among[0] if among else None)
    console.answer(answer.as_dict(), json, lambda: _print_design(answer, everything))


def sweep(
    rig: str,
    vary: list[str],
    out: Path,
    sample: int | None = None,
    grid: str | None = None,
    method: Literal["lhs", "monte-carlo"] = "lhs",
    seed: int = 0,
    set_: list[str] | None = None,
    output: list[str] | None = None,
    kind: Literal["steady", "warmup"] = "steady",
    duty: Path | None = None,
    duration: str | None = None,
    every: str | None = None,
    jobs: int = 0,
    scheduler: str | None = None,
    plot: Path | None = None,
    json: str | None = None,
) -> None:
    """Many steady states or warm-ups, on a grid or at random. An interrupted sweep goes on."""
    console.writable(out)
    console.plottable(plot)
    rows = gh.sweep(
        rig,
        vary,
        out=out,
        sample=sample,
        grid=grid,
        method=method,
        seed=seed,
        set=set_ or [],
        output=output or [],
        kind=kind,
        duty=duty,
        duration=duration,
        every=every,
        jobs=jobs,
        scheduler=scheduler,
        draw=plot is not None,
    )
    found = _write_picture(rows.as_dict(), plot, rows, say=False)
    console.answer(found, json, lambda: _print_sweep(rows, found))
    rows.check()


def map_(
    rig: str,
    out: Path | None = None,
    speed: str | None = None,
    torque: str | None = None,
    grid: str = "21x21",
    plot: Path | None = None,
    output: list[str] | None = None,
    set_: list[str] | None = None,
    json: str | None = None,
) -> None:
    """Oil temperature, loss and efficiency over speed and torque: table and picture."""
    fitting(out, "a table")
    console.writable(out)
    console.plottable(plot)
    points = gh.map(rig, speed=speed, torque=torque, grid=grid, output=output or [], set=set_ or [])
    if out is not None:
        points.save(out)
    found = _write_picture({**points.as_dict(), "out": out and str(out)}, plot, points, say=False)
    console.answer(found, json, lambda: _print_map(points, found))


def rating(
    rig: str,
    limit: list[str],
    room: str | None = None,
    speed: str | None = None,
    grid: str = "5x6",
    out: Path | None = None,
    set_: list[str] | None = None,
    live: Path | None = None,
    json: str | None = None,
) -> None:
    """Thermal power over room temperature and speed: continuous power at which a limit is kept."""
    fitting(out, "a table")
    console.writable(out, live)
    powers = gh.rating(rig, limit, room=room, speed=speed, grid=grid, set=set_ or [])
    if out is not None:
        powers.save(out)
    if live is not None:
        gh.page(rig, set=set_ or [], limit=powers.limit.partition("=")[2]).save(live)
    found = powers.as_dict() | {"out": out and str(out)}
    console.answer(found, json, lambda: _print_rating(powers))


def teeth(
    rig: str,
    load_factor: float = 1.0,
    scuffing_stage: int = 12,
    micropitting_stage: int = 10,
    set_: list[str] | None = None,
    plot: Path | None = None,
    json: str | None = None,
) -> None:
    """What the teeth feel: temperatures, films, safeties against scuffing and micropitting."""
    console.plottable(plot)
    felt = gh.teeth(
        rig,
        set_ or [],
        load_factor=load_factor,
        scuffing_stage=scuffing_stage,
        micropitting_stage=micropitting_stage,
    )
    found = _write_picture(felt.as_dict(), plot, felt)
    console.answer(found, json, lambda: _print_teeth(felt))


def _write_picture(found: dict[str, Any], plot: Path | None, result: Display, *, say: bool = True) -> dict[str, Any]:
    """The object with the place of its picture, which is written."""
    if plot is None:
        return found
    if result.save_picture(plot) is not None and say:
        console.note(f"wrote {plot}")
    return found | {"plot": str(plot)}


def print_run(run: gh.TimeSeries, out: Path, plot: Path | None, json: str | None) -> None:
    """Write a time series and its picture, and say where it ends."""
    run.save(out)
    found = _write_picture({**run.as_dict(), "out": str(out)}, plot, run)
    console.answer(found, json, lambda: print_end(out, found, run.headlines))


def print_end(out: Path, found: Mapping[str, Any], headlines: Sequence[str] = ()) -> None:
    """Print where a time series ends, from its file and its JSON object."""
    console.say(f"{out}: {found['rows']} rows to {found['stop_s']:g} s")
    for line in headlines:
        console.say(line)
    if found.get("backward"):
        console.note(f"{found['backward']} of {found['rows']} rows: {BACKWARD}")
    _print_far(found)
    print_outside(found.get("outside", ()))


def _print_far(found: Mapping[str, Any]) -> None:
    for line in found.get("far", ()):
        console.note(f"{line}. Check its digits and its unit.")


def _print_point(
    title: str, rows: Sequence[Sequence[Any]], found: Mapping[str, Any], headlines: Sequence[str] = ()
) -> None:
    console.table("\n".join((title, *headlines)), ("name", "value", "unit", "meaning"), rows)
    if more := len(found["values"]) - len(rows):
        console.say(f"{more} more values with --all")
    console.say(f"power balance closed within {found['energy_residual']:.1e} of the throughput")
    if found.get("backward"):
        console.note(BACKWARD)
    _print_far(found)
    print_outside(found["outside"])


def _print_design(answer: gh.DesignAnswer, everything: bool) -> None:
    found = answer.found
    if "among" in found:
        _print_alternatives(answer)
        return
    units, rig = found["units"], found["rig"]
    if found["free"]:
        console.table(f"{rig}: found", ("name", "value", "unit", "meaning"), answer.rows(list(found["free"])))
        aims = next(iter(found["sensitivity"].values()))
        slopes = [[n, *found["sensitivity"][n].values()] for n in found["free"]]
        head = ("change of", *(f"per {units[t] if units[t] != 'degC' else 'K'} of {t}" for t in aims))
        console.table("Sensitivity", head, slopes)
    for note in found["notes"]:
        console.say(note)
    shows = list(found["values"]) if everything else answer.first
    _print_point(f"{rig}: steady state there", answer.rows(shows), found)


def _print_alternatives(answer: gh.DesignAnswer) -> None:
    found = answer.found
    part = found["among"]
    console.table(f"{found['rig']}: alternatives, the best first", *answer.table())
    solved = [a for a in found["alternatives"] if "problems" not in a]
    for alternative in solved:
        if alternative["outside"]:
            console.say(f"{part} = {alternative[part]}:")
            print_outside(alternative["outside"])
    for alternative in found["alternatives"]:
        for problem in alternative.get("problems", ()):
            console.say(f"{part} = {alternative[part]}: {problem}")


def _print_sweep(rows: gh.Sweep, found: Mapping[str, Any]) -> None:
    console.table(rows.title, *rows.table())
    if failed := {name: n for name, n in found["status"].items() if name != "ok"}:
        console.say("rows without a result: " + ", ".join(f"{name} {n}" for name, n in failed.items()))
    if (outside := found["outside"]) is not None:
        count = found["rows_outside"]
        console.say(f"rows with a law outside the range of its source: {count}, most of all row {outside['row']}:")
        print_outside(outside["laws"])
    print(found["out"] + ("" if rows.seconds is None else f" after {rows.seconds:.1f} s"))


def _print_map(points: gh.Map, found: Mapping[str, Any]) -> None:
    console.table(points.title, *points.table())
    if found["without_result"]:
        console.say(f"{found['without_result']} points have no steady state; their cells are nan")
    if written := [name for name in (found["out"], found["plot"]) if name]:
        print(", ".join(written))


def _print_teeth(felt: gh.TeethFelt) -> None:
    for name, (head, rows) in felt.tables().items():
        console.table(f"{felt.title}, {name}", head, rows)
    console.say("flash, integral, micropitting: ISO/TS 6336-20, -21, -22 by their own friction and tooth temperature")
    for assumption in felt.found["assumptions"]:
        console.say(f"assumed: {assumption}")


def _print_rating(powers: gh.Rating) -> None:
    console.table(powers.title, *powers.table())
    if powers.beyond:
        console.note(powers.beyond)
    for place, reason in powers.without_result.items():
        console.note(f"{place}: {reason}")
