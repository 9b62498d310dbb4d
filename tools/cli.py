"""The command line `gearheat`. Commands only read their options; the work is imported when a command runs."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Literal

import typer

from . import cli_contact, cli_developers, cli_diagnosis, cli_docs, cli_logs, cli_rigs, console
from .cli_options import Everything, Jobs, Json, Plot, Rig, Set, Ssp, Tests

app = typer.Typer(
    name="gearheat",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(asked: bool) -> None:
    if asked:
        from importlib.metadata import version

        print(f"gearheat {version('gearheat')}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Losses and temperatures of gearboxes: simulate, design, export as FMU, compare with measurements."""


Extended = Annotated[
    Path | None, typer.Option(metavar="FILE", help="Rig file that `diagnose` wrote; it takes the rig's place.")
]


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
    from . import run

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
    from . import losses
    from .reference import command

    others = {"--data": data, "--card": card, "--power-flow": power_flow, "--contacts": contacts}
    if command.asked(method, {"--limit": limit, "--k": k, "--dip": dip}, others):
        command.command(rig, method or "", limit or "95 degC", k, dip or [], set_ or [], json)
        return
    losses.command(rig, data, card, temperature, power_flow, set_ or [], json, contacts=contacts)


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
    from . import points

    points.steady_command(str(extended or rig), set_ or [], json, plot=plot, everything=everything)


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
    from . import designing

    designing.design_command(
        str(extended or rig), free or [], target, set_ or [], among or [], json, everything=everything
    )


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
    from . import transients

    transients.simulate_command(rig, duty, out, set_ or [], json, plot=plot)


@console.guarded
def export(
    rig: Rig,
    out: Annotated[Path, typer.Option("-o", "--out", help="FMU to write.")],
    set_: Set = None,
    extended: Extended = None,
    drive: Annotated[str | None, typer.Option(help="Shaft end that drives, for example carrier or sun.")] = None,
    given: Annotated[
        Literal["speed", "torque"],
        typer.Option(
            help="speed: speed and torque of the driving shaft are inputs; torque: the torques of all shaft ends are."
        ),
    ] = "speed",
    fmi: Annotated[Literal["2", "3"], typer.Option(help="Version of the standard: FMI 2.0 or 3.0.")] = "2",
    platform: Annotated[str, typer.Option(help='"host", "all" or names such as linux64,win64.')] = "host,win64",
    license_: Annotated[str, typer.Option("--license", help="Licence under which you give it away.")] = "",
    author: Annotated[str, typer.Option(help="Who answers for it.")] = "",
    of_version: Annotated[str, typer.Option("--model-version", help="Version you give the model.")] = "",
    made: Annotated[str, typer.Option("--date", help="Date and time, 2026-01-31T12:00:00Z; none unless given.")] = "",
    sources: Annotated[bool, typer.Option("--sources/--no-sources", help="With its C source.")] = True,
    audit: Annotated[
        bool, typer.Option("--audit/--no-audit", help="With two states that integrate the energy across the boundary.")
    ] = True,
    origins: Annotated[
        bool,
        typer.Option("--parameters-source/--no-parameters-source", help="Telling where values are from."),
    ] = True,
    extras: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="Write parameter sets (.ssv) and a reference result there.")
    ] = None,
    uncertainty: Annotated[
        bool, typer.Option("--uncertainty", help="With standard deviations, such as oil.T.sd; co-simulation only.")
    ] = False,
    ssp: Ssp = None,
    json: Json = None,
) -> None:
    """Write the rig as an FMU for FMI 2.0 or 3.0, or as a system of FMUs."""
    from ..fmu.description import Owner
    from . import exporting, systems

    asked = exporting.Asked(
        str(extended or rig),
        out,
        set_ or [],
        drive,
        given,
        platform,
        extras,
        json,
        owner=Owner(author, of_version, license_, made),
        with_sources=sources,
        with_origins=origins,
        fmi=int(fmi),
        audit=audit,
        uncertainty=uncertainty,
    )
    if ssp:
        systems.system_command(ssp, asked)
    else:
        exporting.export_command(asked)


@console.guarded
def play(
    fmu: Annotated[Path, typer.Argument(help="FMU to play.")],
    duty: Annotated[Path, typer.Option(help="CSV with time and inputs, units in the header.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="CSV to write, units in the header.")],
    step: Annotated[str, typer.Option(help="Communication step.")] = "60 s",
    trust: Annotated[bool, typer.Option("--trust", help="Run native code of an FMU that was not made here.")] = False,
    set_: Set = None,
    plot: Plot = None,
    json: Json = None,
) -> None:
    """Play an FMU over a duty cycle."""
    from . import transients

    transients.play_command(fmu, duty, out, step, set_ or [], json, trust=trust, plot=plot)


@console.guarded
def compare(
    result: Annotated[Path, typer.Argument(help="Simulated readings: CSV with test and direction, or point.")],
    data: Annotated[Path, typer.Argument(help="Measured readings: CSV.")],
    rig: Annotated[str, typer.Option(help="Rig that was measured.")] = "planetary",
    card: Annotated[Path | None, typer.Option(help="How that table was taken, see `gearheat card`.")] = None,
    json: Json = None,
) -> None:
    """Errors of simulated readings by group, with the noise floor and statistical rivals."""
    from . import readings

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
    from . import calibrate

    calibrate.command(rig, grid, free, bounds or [], set_ or [], json, data=data, card=card)


@console.guarded
def list_(json: Json = None) -> None:
    """The shipped rigs and catalogues."""
    from . import listing

    listing.list_command(json)


@console.guarded
def show(
    rig: Rig,
    errata: Annotated[bool, typer.Option("--errata", help="Show where the rig's sources are wrong.")] = False,
    everything: Everything = False,
    json: Json = None,
) -> None:
    """What a rig is made of, how it is driven, and which parameters matter most; --all for everything."""
    from . import describe

    describe.show_command(rig, errata, json, everything)


@console.guarded
def verify(
    rig: Annotated[
        str | None, typer.Argument(help="Name of a shipped rig, or path of a rig file; all shipped rigs if left out.")
    ] = None,
    json: Json = None,
    html: Annotated[Path | None, typer.Option(metavar="FILE", help="HTML page to write.")] = None,
) -> None:
    """Published numbers of each machine beside what the model gives."""
    from . import verify

    verify.command(rig, json, html)


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
    from . import sweep

    options = (sample, grid, method, seed, set_ or [], output or [], kind, duty, duration, every)
    sweep.command(sweep.Request(rig, vary, out, *options, jobs, scheduler, json, plot))


#: The commands by what they are for, in the order in which the help shows them.
PANELS = {
    "Your gearbox": (cli_rigs.new, list_, show, cli_rigs.parts, cli_rigs.schema),
    "What it does": (steady, simulate, design, sweep, cli_rigs.map_, cli_rigs.rating),
    "FMU": (export, play),
    "Measured data": (
        run,
        losses,
        compare,
        calibrate,
        cli_diagnosis.diagnose,
        cli_diagnosis.plan,
        cli_diagnosis.card,
        cli_logs.replay,
    ),
    "Films, and proof": (cli_contact.film, verify, cli_contact.verify_contact),
    "For developers": (cli_developers.bench, cli_docs.docs),
}
for _panel, _commands in PANELS.items():
    for _command in _commands:
        app.command(_command.__name__.strip("_").replace("_", "-"), rich_help_panel=_panel)(_command)


def program() -> None:
    """Run the command line. A named command stands alone: to read all options takes long. `docs` runs others."""
    named = [command for command in app.registered_commands if sys.argv[1:2] == [command.name] != ["docs"]]
    app.registered_commands = named or app.registered_commands
    app()


if __name__ == "__main__":
    program()
