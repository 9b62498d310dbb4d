"""The commands that make rigs and judge them as a whole: `new`, `parts`, `schema`, `map`, `rating`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..show import console
from .options import Json, Plot, Rig, Set


@console.guarded
def map_(
    rig: Rig,
    out: Annotated[Path, typer.Option("-o", "--out", help="CSV to write, a row per point.")],
    speed: Annotated[str | None, typer.Option(help='Range such as "300..1800 rpm".')] = None,
    torque: Annotated[str | None, typer.Option(help='Range such as "-600..-60 N.m".')] = None,
    grid: Annotated[str, typer.Option(help="Points: speeds x torques.")] = "21x21",
    plot: Plot = None,
    output: Annotated[list[str] | None, typer.Option(help="Output to map. Repeatable.")] = None,
    set_: Set = None,
    json: Json = None,
) -> None:
    """Oil temperature, loss and efficiency over speed and torque: table and picture."""
    from ..solve import maps

    maps.map_command(rig, out, {"w": speed, "tau": torque}, grid, plot, output or [], set_ or [], json)


@console.guarded
def rating(
    rig: Rig,
    limit: Annotated[str, typer.Option(help='What must be kept, such as "oil.T=95 degC".')],
    room: Annotated[str | None, typer.Option(help='Range of the room, such as "0..40 degC".')] = None,
    speed: Annotated[str | None, typer.Option(help='Range such as "300..1800 rpm".')] = None,
    grid: Annotated[str, typer.Option(help="Points: rooms x speeds.")] = "5x5",
    out: Annotated[Path | None, typer.Option("-o", "--out", help="CSV to write.")] = None,
    set_: Set = None,
    json: Json = None,
) -> None:
    """Thermal power over room temperature and speed: what the rig carries for ever within a limit."""
    from ..solve import maps

    maps.rating_command(rig, limit, {"room": room, "w": speed}, grid, out, set_ or [], json)


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
