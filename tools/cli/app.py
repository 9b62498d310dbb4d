"""The command line `gearheat`. Commands only read their options; the work is imported when a command runs."""

from __future__ import annotations

import sys
from importlib.util import find_spec
from typing import Annotated

import typer

from ..show.console import guard
from . import developers, diagnosis, fmu, measured, rigs, solve
from .options import Command, describe

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


#: The commands by what they are for, in the order in which the help shows them.
PANELS = {
    "Your gearbox": (rigs.new, rigs.list_, rigs.show, rigs.parts, rigs.schema),
    "What it does": (solve.steady, solve.simulate, solve.design, solve.sweep, solve.map_, solve.rating, solve.teeth),
    "FMU, page, desk": (fmu.export, fmu.play, fmu.page, fmu.desk),
    "Measured data": (
        measured.run,
        measured.losses,
        measured.compare,
        measured.calibrate,
        diagnosis.diagnose,
        diagnosis.plan,
        diagnosis.card,
        diagnosis.campaign,
        measured.replay,
        measured.watch,
    ),
    "Films, and proof": (developers.film, developers.verify, developers.verify_contact),
    "For developers": (*((developers.bench,) if find_spec("gearheat.tools.bench") else ()), developers.docs),
}
for _panel, _commands in PANELS.items():
    for _command in _commands:
        _name = _command.__name__.strip("_").replace("_", "-")
        app.command(_name, cls=Command, rich_help_panel=_panel)(guard(describe(_name, _command)))


def program() -> None:
    """Run the command line. A named command stands alone: to read all options takes long. `docs` runs others."""
    named = [command for command in app.registered_commands if sys.argv[1:2] == [command.name] != ["docs"]]
    app.registered_commands = named or app.registered_commands
    app()
