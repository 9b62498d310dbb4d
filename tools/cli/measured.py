"""Measured readings and logs beside the model."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from ..show import console
from .options import Extended, Jobs, Json, Rig, Set, Tests


@console.guarded
def run(
    rig: Rig = "planetary",
    out: Annotated[
        Path, typer.Option("-o", "--out", help="Folder for results; a run that was interrupted goes on from there.")
    ] = Path("out"),
    tests: Tests = None,
    step: Annotated[str, typer.Option(help="Communication step of the FMU.")] = "60 s",
    set_: Set = None,
    jobs: Jobs = 0,
    extended: Extended = None,
    data: Annotated[Path | None, typer.Option(help="Measured table; the rig's own if left out.")] = None,
    card: Annotated[Path | None, typer.Option(help="How that table was taken, see `gearheat card`.")] = None,
    json: Json = None,
) -> None:
    """The main job: export the FMU, play all measured tests, compare, report."""
    from ..compare import run

    run.command(rig, out, tests, step, set_ or [], jobs, json, extended=extended, data=data, card=card)


@console.guarded
def losses(
    rig: Rig = "planetary",
    data: Annotated[Path | None, typer.Option(help="Measured table; the rig's own if left out.")] = None,
    card: Annotated[Path | None, typer.Option(help="How that table was taken, see `gearheat card`.")] = None,
    temperature: Annotated[
        Literal["measured", "model"],
        typer.Option(help="At the measured oil temperature, or the one the model reaches."),
    ] = "measured",
    power_flow: Annotated[
        Literal["ideal", "successive"] | None,
        typer.Option(help="ideal: mesh forces from the input torque; successive: each stage sees upstream losses."),
    ] = None,
    contacts: Annotated[
        bool, typer.Option("--contacts", help="Also every contact over a mesh cycle: loads, speeds, films, friction.")
    ] = False,
    method: Annotated[
        Literal["iso14179-1", "iso14179-2"] | None,
        typer.Option(help="Losses at the operating point beside those of a reference method, and its thermal rating."),
    ] = None,
    limit: Annotated[
        str | None, typer.Option(help="With --method: sump temperature that the rating keeps; 95 degC if left out.")
    ] = None,
    k: Annotated[
        str | None, typer.Option("--k", help='With --method: heat transfer of the bare housing, "20 W/(m2.K)".')
    ] = None,
    dip: Annotated[
        list[str] | None, typer.Option(help='With --method: depth to which a gear dips, "stage_1.wheel=20 mm".')
    ] = None,
    set_: Set = None,
    json: Json = None,
) -> None:
    """Loss of every part at each measured reading, or beside those of a reference method."""
    from ..compare import losses
    from ..rating import command

    others = {"--data": data, "--card": card, "--power-flow": power_flow, "--contacts": contacts}
    if command.asked(method, {"--limit": limit, "--k": k, "--dip": dip}, others):
        command.command(rig, method or "", limit or "95 degC", k, dip or [], set_ or [], json)
        return
    losses.command(rig, data, card, temperature, power_flow, set_ or [], json, contacts=contacts)


@console.guarded
def compare(
    result: Annotated[Path, typer.Argument(help="Simulated readings: CSV with test and direction, or point.")],
    data: Annotated[Path, typer.Argument(help="Measured readings: CSV.")],
    rig: Annotated[str, typer.Option(help="Rig that was measured.")] = "planetary",
    card: Annotated[Path | None, typer.Option(help="How that table was taken, see `gearheat card`.")] = None,
    json: Json = None,
) -> None:
    """Errors of simulated readings by group, with the noise floor and statistical rivals."""
    from ..compare import readings

    readings.command(result, data, rig, card, json)


@console.guarded
def calibrate(
    rig: Rig,
    free: Annotated[list[str], typer.Option(help="Parameter to fit. Repeatable.")],
    grid: Annotated[
        str | None, typer.Option(help="Value of the table's `mounting` or `grid` column to fit; all if left out.")
    ] = None,
    data: Annotated[Path | None, typer.Option(help="Measured table; the rig's own if left out.")] = None,
    card: Annotated[Path | None, typer.Option(help="How that table was taken, see `gearheat card`.")] = None,
    bounds: Annotated[
        list[str] | None, typer.Option(help='Range of a free parameter, "cooling.A=0.4 m2..1.2 m2". Repeatable.')
    ] = None,
    set_: Set = None,
    json: Json = None,
) -> None:
    """Fit parameters to the measured oil temperatures of a table, or of one of its grids."""
    from ..compare import calibrate

    calibrate.command(rig, grid, free, bounds or [], set_ or [], json, data=data, card=card)


@console.guarded
def replay(
    rig: Annotated[str, typer.Argument(help="Name of a shipped rig, or path of a rig file.")],
    fit: Annotated[Path, typer.Option(help="Log on which the rivals are fitted.")],
    until: Annotated[int | None, typer.Option(help="First year of that log that they do not see.")] = None,
    logs: Annotated[list[Path] | None, typer.Option(help="Further logs to predict. Repeatable.")] = None,
    card: Annotated[Path | None, typer.Option(help="How the logs are written: TOML or JSON.")] = None,
    out: Annotated[Path | None, typer.Option("-o", "--out", help="Picture to write, .png or .svg.")] = None,
    json: Json = None,
) -> None:
    """How well a rig predicts logs without correction, beside a one-node model, a regression and the last reading."""
    from ..compare import replay as replaying

    replaying.command(rig, fit, until, logs or [], card, out, json)
