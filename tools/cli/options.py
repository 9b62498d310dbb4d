"""Options that several commands of the command line have."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..show.console import PICTURES

Set = Annotated[
    list[str] | None,
    typer.Option("--set", help='NAME=VALUE with a unit, for example "carrier.w=250 rpm". Repeatable.'),
]
Json = Annotated[str | None, typer.Option("--json", metavar="FILE", help="Write the result as JSON; - for stdout.")]


def _rigs(incomplete: str) -> list[str]:
    """What the shell completes the name of a rig to."""
    from ...scenarios.shipped import RIGS

    return sorted(p.parent.name for p in RIGS.glob("*/rig.toml") if p.parent.name.startswith(incomplete))


Rig = Annotated[
    str,
    typer.Argument(help="Name of a shipped rig (see `gearheat list`), or path of a rig file.", autocompletion=_rigs),
]
Plot = Annotated[
    Path | None, typer.Option(metavar="FILE", help=f"Picture to write; its name ends in {', '.join(PICTURES)}.")
]
Jobs = Annotated[int, typer.Option("-j", "--jobs", min=0, help="How many to run at once; 0 for one per core.")]
Tests = Annotated[str | None, typer.Option(help="Only these tests, for example 1,13,22-26.")]
Everything = Annotated[bool, typer.Option("--all", help="Print everything, not the first screen alone.")]
Ssp = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME=PART,...",
        help="Write a system of coupled FMUs (.ssp): these parts are one, again for more, the rest is gearbox.",
    ),
]
Extended = Annotated[
    Path | None, typer.Option(metavar="FILE", help="Rig file that `diagnose` wrote; it takes the rig's place.")
]
