"""The commands for those who work on gearheat itself: how fast the program is."""

from __future__ import annotations

import os
from typing import Annotated

import typer

from . import console
from .cli_options import Json, Rig, Tests


@console.guarded
def bench(
    rig: Rig = "planetary",
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
        os.environ.setdefault("OMP_NUM_THREADS", "1")
    from . import bench

    bench.command(rig, tests, json, next((name for name, given in asked.items() if given), "job"), draws)
