"""For those who work on gearheat: its benches and its documentation."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal, cast

import typer
from typer.core import TyperGroup

from ..show import console
from .options import Json, Rig, Tests


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
