"""The command `verify-contact` of the command line."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer


def verify_contact(
    out: Annotated[
        Path,
        typer.Option("-o", "--out", help="Folder for table and figures; an interrupted run goes on from there."),
    ],
    quick: Annotated[bool, typer.Option("--quick", help="A subset on coarse grids.")] = False,
    cycle: Annotated[
        str | None, typer.Option(metavar="RIG", help="Solve the mesh cycle of this rig too, such as rv_stage.")
    ] = None,
    json: Annotated[
        str | None, typer.Option("--json", metavar="FILE", help="Write the result as JSON; - for stdout.")
    ] = None,
) -> None:
    """The contact solver beside published films, Hertz and measurements: table, convergence, figures."""
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):  # times are those of one core
        os.environ.setdefault(name, "1")
    from .ehl import command

    command.command(out, quick, cycle, json)
