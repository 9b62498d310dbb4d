"""A rig as an FMU or as a page, an FMU played, and the desk."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

import gearheat as gh

from ..show import console
from ..show.endings import fitting
from ..show.notes import print_unchecked
from .solve import print_run


def export(
    rig: str,
    out: Path,
    set_: list[str] | None = None,
    extended: Path | None = None,
    drive: str | None = None,
    given: Literal["speed", "torque"] = "speed",
    fmi: Literal["2", "3"] = "2",
    platform: str = "host,win64",
    license_: str = "",
    author: str = "",
    of_version: str = "",
    made: str = "",
    sources: bool = True,
    audit: bool = True,
    origins: bool = True,
    extras: Path | None = None,
    uncertainty: Literal["linear", "mixture"] | None = None,
    constant: list[str] | None = None,
    real_time: str | None = None,
    ssp: list[str] | None = None,
    json: str | None = None,
) -> None:
    """Write the rig as an FMU for FMI 2.0 or 3.0, or as a system of FMUs."""
    console.writable(out)
    written = gh.export(
        extended or rig,
        out,
        fmi=int(fmi),
        set=set_ or [],
        drive=drive,
        given=given,
        platform=platform,
        license=license_,
        author=author,
        model_version=of_version,
        date=made,
        sources=sources,
        audit=audit,
        parameters_source=origins,
        extras=extras,
        uncertainty=uncertainty or False,
        constant=constant or (),
        real_time=real_time,
        ssp=ssp or (),
    )
    found = written.as_dict()
    console.answer(found, json, lambda: _print_system(found) if ssp else _print_fmu(found))


def page(
    rig: str,
    out: Path,
    set_: list[str] | None = None,
    with_: list[str] | None = None,
    limit: str = "95 degC",
    data: Path | None = None,
    extended: list[Path] | None = None,
    json: str | None = None,
) -> None:
    """Write the machine as one HTML file that computes in any browser, without a server or a network."""
    fitting(out, "a page")
    console.writable(out)
    made = gh.page(rig, set=set_ or [], more=with_ or [], limit=limit, data=data, extended=extended or ())
    made.save(out)
    found = made.as_dict() | {"out": str(out)}
    console.answer(found, json, lambda: console.say(f"{out}: {made.title}, fields: {', '.join(found['fields'])}"))


def play(
    fmu: Path,
    duty: Path,
    out: Path,
    step: str = "60 s",
    trust: bool = False,
    set_: list[str] | None = None,
    every: str | None = None,
    plot: Path | None = None,
    json: str | None = None,
) -> None:
    """Play an FMU over a duty cycle."""
    fitting(out, "a table")
    console.writable(out)
    console.plottable(plot)
    run = gh.play(fmu, duty, step=step, set=set_ or [], trust=trust, every=every)
    print_run(run, out, plot, json)


def desk(
    out: Path = Path("desk"),
    port: int = 0,
    browser: bool = True,
) -> None:
    """The commands by clicks: a local web app for tables and diagnoses, rigs of your own, maps and comparisons."""
    from ..desk import serve

    serve(out, port, browser=browser)


def _print_fmu(found: Mapping[str, Any]) -> None:
    words = [f"{len(found[kind])} {kind}" for kind in ("inputs", "outputs", "parameters")]
    words += [f"{len(found['deviations'])} standard deviations"] if found["deviations"] else []
    console.say(f"{found['fmu']}: {', '.join(words)}, for {', '.join(found['platforms'])}")
    if told := found["real_time"]:
        bounds = f"{told['evaluations']} evaluations of implicit equations, {told['stack_bytes']} bytes of stack"
        console.say(f"in a step of {told['step_s']:g} s at most: {told['solver_steps']} step of the solver, {bounds}")
        for what, result in told["checks"].items():
            console.say(f"  {what}: {result}")
    if found["extras"]:
        console.say(f"{len(found['extras'])} files beside it, from {found['extras'][0]}")
    print_unchecked(found["unchecked"])


def _print_system(found: Mapping[str, Any]) -> None:
    console.say(f"{found['ssp']}: {', '.join(found['fmus'])}")
    for connection in found["connections"]:
        console.say(f"  {connection}")
