"""A rig as an FMU, and an FMU played."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import gearheat as gh
import typer

from ..show import console
from ..show.notes import print_unchecked
from .options import Extended, Json, Plot, Rig, Set, Ssp
from .solve import print_run


def export(
    rig: Rig,
    out: Annotated[Path, typer.Option("-o", "--out", help="FMU to write.")],
    set_: Set = None,
    extended: Extended = None,
    drive: Annotated[str | None, typer.Option(help="Shaft end that drives, for example carrier or sun.")] = None,
    given: Annotated[
        Literal["speed", "torque"],
        typer.Option(
            help="speed: speed and torque of the driving shaft are inputs; torque: the torques of all shaft ends are."
        ),
    ] = "speed",
    fmi: Annotated[Literal["2", "3"], typer.Option(help="Version of the standard: FMI 2.0 or 3.0.")] = "2",
    platform: Annotated[str, typer.Option(help='"host", "all" or names such as linux64,win64.')] = "host,win64",
    license_: Annotated[str, typer.Option("--license", help="Licence under which you give it away.")] = "",
    author: Annotated[str, typer.Option(help="Who answers for it.")] = "",
    of_version: Annotated[str, typer.Option("--model-version", help="Version you give the model.")] = "",
    made: Annotated[str, typer.Option("--date", help="Date and time, 2026-01-31T12:00:00Z; none unless given.")] = "",
    sources: Annotated[bool, typer.Option("--sources/--no-sources", help="With its C source.")] = True,
    audit: Annotated[
        bool, typer.Option("--audit/--no-audit", help="With two states that integrate the energy across the boundary.")
    ] = True,
    origins: Annotated[
        bool,
        typer.Option("--parameters-source/--no-parameters-source", help="Telling where values are from."),
    ] = True,
    extras: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="Write parameter sets (.ssv) and a reference result there.")
    ] = None,
    uncertainty: Annotated[
        bool, typer.Option("--uncertainty", help="With standard deviations, such as oil.T.sd; co-simulation only.")
    ] = False,
    ssp: Ssp = None,
    json: Json = None,
) -> None:
    """Write the rig as an FMU for FMI 2.0 or 3.0, or as a system of FMUs."""
    console.writable(out, console.file_of(json))
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
        uncertainty=uncertainty,
        ssp=ssp or (),
    )
    found = written.as_dict()
    console.answer(found, json, lambda: _print_system(found) if ssp else _print_fmu(found))


def play(
    fmu: Annotated[Path, typer.Argument(help="FMU to play.")],
    duty: Annotated[Path, typer.Option(help="CSV with time and inputs, units in the header.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="CSV to write, units in the header.")],
    step: Annotated[str, typer.Option(help="Communication step.")] = "60 s",
    trust: Annotated[bool, typer.Option("--trust", help="Run native code of an FMU that was not made here.")] = False,
    set_: Set = None,
    plot: Plot = None,
    json: Json = None,
) -> None:
    """Play an FMU over a duty cycle."""
    console.writable(out, console.file_of(json))
    console.plottable(plot)
    run = gh.play(fmu, duty, step=step, set=set_ or [], trust=trust)
    print_run(run, out, plot, json)


def _print_fmu(found: Mapping[str, Any]) -> None:
    words = [f"{len(found[kind])} {kind}" for kind in ("inputs", "outputs", "parameters")]
    words += [f"{len(found['deviations'])} standard deviations"] if found["deviations"] else []
    console.say(f"{found['fmu']}: {', '.join(words)}, for {', '.join(found['platforms'])}")
    if found["extras"]:
        console.say(f"{len(found['extras'])} files beside it, from {found['extras'][0]}")
    print_unchecked(found["unchecked"])


def _print_system(found: Mapping[str, Any]) -> None:
    console.say(f"{found['ssp']}: {', '.join(found['fmus'])}")
    for connection in found["connections"]:
        console.say(f"  {connection}")
