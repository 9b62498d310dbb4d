"""Films of contacts, and published numbers beside what the model gives."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from ..show import console
from .options import Json, Set


@console.guarded
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
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):  # its matrices are small
        os.environ.setdefault(name, "1")
    from ..films import film

    film.command(film.Request(rig, out, part, vary or [], grid, nodes, plot, set_ or [], json))


@console.guarded
def verify(
    rig: Annotated[
        str | None, typer.Argument(help="Name of a shipped rig, or path of a rig file; all shipped rigs if left out.")
    ] = None,
    json: Json = None,
    html: Annotated[Path | None, typer.Option(metavar="FILE", help="HTML page to write.")] = None,
) -> None:
    """Published numbers of each machine beside what the model gives."""
    from ..verify import verify

    verify.command(rig, json, html)


@console.guarded
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
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):  # times are those of one core
        os.environ.setdefault(name, "1")
    from ..verify.contact import command

    command.command(out, quick, cycle, json)
