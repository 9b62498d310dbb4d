"""Films of contacts and published numbers beside the model's; benches and documentation, for developers."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Literal, cast

import gearheat as gh
import typer
from typer.core import TyperGroup

from ..show import console
from .options import Json, Rig, Set, Tests

#: Exit code where a number is not reproduced.
FAILED = 1


def bench(
    rig: Rig,
    tests: Tests = None,
    fmu: Annotated[bool, typer.Option("--fmu", help="The FMU against its peers, and the batch, instead.")] = False,
    batch: Annotated[bool, typer.Option("--batch", help="Many rows in one call, instead.")] = False,
    uncertainty: Annotated[
        bool, typer.Option("--uncertainty", help="Standard deviations of the FMU beside Monte Carlo, instead.")
    ] = False,
    contact: Annotated[bool, typer.Option("--contact", help="The contact solver against slippy, instead.")] = False,
    draws: Annotated[int, typer.Option(help="Rows that --uncertainty draws.")] = 10_000,
    json: Json = None,
) -> None:
    """Time and memory of the main job, beside SciPy's LSODA on the same equations."""
    asked = {"contact": contact, "fmu": fmu, "batch": batch, "uncertainty": uncertainty}
    if contact:
        console.use_one_thread()
    from ..bench import bench

    bench.command(rig, tests, json, next((name for name, given in asked.items() if given), "job"), draws)


def docs(
    context: typer.Context,
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder of the web site.")],
    run: Annotated[
        Literal["quick", "all", "none"],
        typer.Option(help="Code blocks to run before: those that take seconds, all, or none."),
    ] = "quick",
) -> None:
    """Build the documentation as a web site; its code blocks are run and their output compared with the pages."""
    import gearheat as gh

    from ..docs import build

    public = {name: getattr(gh, name) for name in gh.PUBLIC}
    build.docs_command(cast(TyperGroup, context.find_root().command), public, out, run)


def film(
    rig: Annotated[str, typer.Argument(help="Name of a shipped rig, path of a rig file, or TOML file of one contact.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="CSV to write; a run that was interrupted goes on.")],
    part: Annotated[str | None, typer.Option(help="Part of the rig whose contact it is.")] = None,
    vary: Annotated[
        list[str] | None,
        typer.Option(help='Range of F, u_m or T, for example "F=100..2000 N" or "T=40..100 degC". Repeatable.'),
    ] = None,
    grid: Annotated[str | None, typer.Option(help="Points along each axis that is varied, such as 6x6x4.")] = None,
    nodes: Annotated[int | None, typer.Option(help="Nodes of the contact solver, along a side.")] = None,
    plot: Annotated[Path | None, typer.Option(metavar="FILE", help="Picture to write, .png or .svg.")] = None,
    set_: Set = None,
    json: Json = None,
) -> None:
    """Solve a lubricated contact over load, speed and temperature; fit the film law that parts can use."""
    console.use_one_thread()
    console.writable(console.file_of(json))
    films = gh.film(rig, out, part=part, vary=vary or [], grid=grid, nodes=nodes, plot=plot, set=set_ or [])
    console.answer(films.as_dict(), json, lambda: print_films(films))


def verify(
    rig: Annotated[
        str | None, typer.Argument(help="Name of a shipped rig, or path of a rig file; all shipped rigs if left out.")
    ] = None,
    json: Json = None,
    html: Annotated[Path | None, typer.Option(metavar="FILE", help="HTML page to write.")] = None,
) -> None:
    """Published numbers of each machine beside what the model gives."""
    console.writable(console.file_of(json), html)
    numbers = gh.verify(rig)
    if html is not None:
        numbers.report(html)
    console.answer(numbers.as_dict(), json, lambda: _print_verification(numbers))
    if numbers.failed:
        sys.exit(FAILED)


def verify_contact(
    out: Annotated[
        Path,
        typer.Option("-o", "--out", help="Folder for table and figures; an interrupted run goes on from there."),
    ],
    quick: Annotated[bool, typer.Option("--quick", help="A subset on coarse grids.")] = False,
    cycle: Annotated[
        str | None, typer.Option(metavar="RIG", help="Solve the mesh cycle of this rig too, such as rv_stage.")
    ] = None,
    json: Json = None,
) -> None:
    """Check the contact solver against published films, Hertz and measurements."""
    console.use_one_thread()
    found = gh.verify_contact(out, quick=quick, cycle=cycle)
    console.answer(found.as_dict(), json, lambda: console.table(found.title, *found.table()))


def print_films(films: gh.FilmTable) -> None:
    """Print what was varied and how well the law fits."""
    found = films.found
    console.table(films.title, *films.table())
    for name in found["failed"]:
        console.say(f"without a film: {name}")
    for key, error in found["fit"].items():
        largest, rms = 100 * error["largest"], 100 * error["rms"]
        console.say(f"law of {key}, {found['terms']} terms: error {largest:.2g} % at most, {rms:.2g} % rms")
    console.say(f'{found["out"]}: film = "map:{found["out"]}" in a rig file')


def _print_verification(numbers: gh.Verification) -> None:
    for title, head, rows in numbers.details():
        console.table(title, head, rows, wrapped=True)
    console.table(numbers.title, *numbers.table())
    for remark in numbers.remarks():
        console.say(remark)
