"""What a rig does: steady states, runs over time, designs, sweeps, maps and ratings."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from ..show import console
from .options import Everything, Extended, Jobs, Json, Plot, Rig, Set


@console.guarded
def steady(
    rig: Rig,
    set_: Set = None,
    extended: Extended = None,
    plot: Plot = None,
    everything: Everything = False,
    json: Json = None,
) -> None:
    """Steady temperatures and losses at one operating point."""
    from ..solve import steady as points

    points.steady_command(str(extended or rig), set_ or [], json, plot=plot, everything=everything)


@console.guarded
def simulate(
    rig: Rig,
    duty: Annotated[Path, typer.Option(help="CSV with time and inputs, units in the header.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="CSV to write, units in the header.")],
    set_: Set = None,
    plot: Plot = None,
    json: Json = None,
) -> None:
    """Temperatures and losses over a duty cycle."""
    from ..solve import simulate as transients

    transients.simulate_command(rig, duty, out, set_ or [], json, plot=plot)


@console.guarded
def design(
    rig: Rig,
    target: Annotated[
        list[str],
        typer.Option(help="Value to reach, NAME=VALUE, or limit to keep, NAME<VALUE or NAME>VALUE. Repeatable."),
    ],
    free: Annotated[
        list[str] | None, typer.Option(help="Parameter or input that may change, one per value to reach. Repeatable.")
    ] = None,
    among: Annotated[
        list[str] | None,
        typer.Option(
            help="Alternatives from a catalogue, for example oil=PAOR,MINR, or oil=all; the best comes first."
        ),
    ] = None,
    set_: Set = None,
    extended: Extended = None,
    everything: Everything = False,
    json: Json = None,
) -> None:
    """Find parameters or inputs for which outputs reach their targets."""
    from ..solve import design as designing

    designing.design_command(
        str(extended or rig), free or [], target, set_ or [], among or [], json, everything=everything
    )


@console.guarded
def sweep(
    rig: Rig,
    vary: Annotated[
        list[str],
        typer.Option(
            help='NAME=LOW..HIGH, for example "carrier.tau=500..2700 N.m", NAME~normal(MEAN, DEVIATION),'
            " or the word uncertainty: every uncertain parameter of the rig. Repeatable."
        ),
    ],
    out: Annotated[Path, typer.Option("-o", "--out", help="CSV or Parquet file to write.")],
    sample: Annotated[int | None, typer.Option(help="Number of random rows.")] = None,
    grid: Annotated[str | None, typer.Option(help="Rows of a grid, one number for each --vary, such as 20x10.")] = None,
    method: Annotated[
        Literal["lhs", "monte-carlo"], typer.Option(help="How random rows are drawn; lhs: Latin hypercube.")
    ] = "lhs",
    seed: Annotated[int, typer.Option(help="The same seed gives the same sample.")] = 0,
    set_: Set = None,
    output: Annotated[
        list[str] | None, typer.Option(help="Outputs to keep, for example oil.T,efficiency.eta; all if left out.")
    ] = None,
    kind: Annotated[Literal["steady", "warmup"], typer.Option(help="Steady states, or warm-ups over time.")] = "steady",
    duty: Annotated[Path | None, typer.Option(help="Warm-up: CSV with time and inputs, the same for all rows.")] = None,
    duration: Annotated[
        str | None, typer.Option(help='Warm-up at constant inputs: how long, such as "330 min".')
    ] = None,
    every: Annotated[str | None, typer.Option(help="Warm-up: time between rows; only the end if left out.")] = None,
    jobs: Jobs = 0,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Dask scheduler that spreads the rows over its workers.")
    ] = None,
    plot: Plot = None,
    json: Json = None,
) -> None:
    """Many steady states or warm-ups, on a grid or at random. An interrupted sweep goes on."""
    from ..solve import sweep

    options = (sample, grid, method, seed, set_ or [], output or [], kind, duty, duration, every)
    sweep.command(sweep.Request(rig, vary, out, *options, jobs, scheduler, json, plot))


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
