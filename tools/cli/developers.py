"""Films of contacts and published numbers beside the model's; benches and documentation, for developers."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Literal, cast

import gearheat as gh
import typer
from typer.core import TyperGroup

from ..show import console
from ..show.endings import fitting

#: Exit code where a number is not reproduced.
FAILED = 1


def bench(
    rig: str = "planetary",
    tests: str | None = None,
    fmu: bool = False,
    batch: bool = False,
    uncertainty: bool = False,
    contact: bool = False,
    scale: bool = False,
    watch: bool = False,
    page: bool = False,
    draws: int = 10_000,
    json: str | None = None,
) -> None:
    """Time and memory of the main job, beside SciPy's LSODA on the same equations."""
    asked = {"contact": contact, "fmu": fmu, "batch": batch, "uncertainty": uncertainty}
    asked |= {"scale": scale, "watch": watch, "page": page}
    from ..bench import bench

    bench.command(rig, tests, json, next((name for name, given in asked.items() if given), "job"), draws)


def docs(
    context: typer.Context,
    out: Path,
    run: Literal["quick", "all", "none"] = "none",
) -> None:
    """Build the documentation as a web site; with --run its code blocks are run and compared with what they print."""
    import gearheat as gh

    from ..docs import build

    public = {name: getattr(gh, name) for name in gh.PUBLIC}
    build.docs_command(cast(TyperGroup, context.find_root().command), public, out, run)


def film(
    rig: str,
    out: Path,
    part: str | None = None,
    vary: list[str] | None = None,
    grid: str | None = None,
    nodes: int | None = None,
    plot: Path | None = None,
    set_: list[str] | None = None,
    json: str | None = None,
) -> None:
    """Solve a lubricated contact over load, speed and temperature; fit the film law that parts can use."""
    films = gh.film(rig, out, part=part, vary=vary or [], grid=grid, nodes=nodes, plot=plot, set=set_ or [])
    console.answer(films.as_dict(), json, lambda: print_films(films))


def verify(
    rig: str | None = None,
    json: str | None = None,
    html: Path | None = None,
) -> None:
    """Published numbers of each machine beside what the model gives."""
    fitting(html, "a page", "--html")
    console.writable(html)
    numbers = gh.verify(rig, draw=gh.new)
    if html is not None:
        numbers.report(html)
    console.answer(numbers.as_dict(), json, lambda: _print_verification(numbers))
    if numbers.failed:
        sys.exit(FAILED)


def verify_contact(
    out: Path,
    quick: bool = False,
    cycle: str | None = None,
    json: str | None = None,
) -> None:
    """Check the contact solver against published films, Hertz and measurements."""
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
