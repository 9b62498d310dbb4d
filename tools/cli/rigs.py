"""Rigs, catalogues and part types: what there is, and a rig of your own."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..show import console
from .options import Everything, Json, Rig


@console.guarded
def new(
    name: Annotated[str, typer.Argument(help="Name of the rig, and of its file.")],
    stages: Annotated[
        str, typer.Option(help="Stages from the input: helical, spur; bevel first; worm or planetary alone.")
    ],
    ratio: Annotated[float, typer.Option(help="Speed of the input over that of the output.")],
    power: Annotated[str, typer.Option(help='Power at the input, such as "7.5 kW".')],
    speed: Annotated[str, typer.Option(help='Speed of the input, such as "1450 rpm".')],
    oil: Annotated[str, typer.Option(help="Oil of the catalogue, see `gearheat list`.")] = "ISO VG 220 mineral",
    out: Annotated[Path | None, typer.Option("-o", "--out", help="File to write; NAME.toml if left out.")] = None,
    json: Json = None,
) -> None:
    """A rig of your own from a name plate: it runs at once, and tells the rule of every number."""
    from ..build import new

    new.new_command(name, stages, ratio, power, speed, oil, out, json)


@console.guarded
def list_(json: Json = None) -> None:
    """The shipped rigs and catalogues."""
    from ..describe import listing

    listing.list_command(json)


@console.guarded
def show(
    rig: Rig,
    errata: Annotated[bool, typer.Option("--errata", help="Show where the rig's sources are wrong.")] = False,
    everything: Everything = False,
    json: Json = None,
) -> None:
    """What a rig is made of, how it is driven, and which parameters matter most; --all for everything."""
    from ..describe import rig as describe

    describe.show_command(rig, errata, json, everything)


@console.guarded
def parts(
    kind: Annotated[str | None, typer.Argument(metavar="TYPE", help="Part type; all types if left out.")] = None,
    json: Json = None,
) -> None:
    """What a rig can be built of: part types, and all about one with an example."""
    from ..describe import parts

    parts.parts_command(kind, json)


@console.guarded
def schema(
    out: Annotated[Path | None, typer.Option("-o", "--out", help="File to write; printed if left out.")] = None,
) -> None:
    """JSON schema of rig files: editors complete and check them with it."""
    from ..describe import parts

    parts.schema_command(out)
