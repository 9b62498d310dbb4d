"""Options that several commands of the command line have."""

from __future__ import annotations

from typing import Annotated

import typer

Set = Annotated[
    list[str] | None,
    typer.Option("--set", help='NAME=VALUE with a unit, for example "carrier.w=250 rpm". Repeatable.'),
]
Json = Annotated[str | None, typer.Option("--json", metavar="FILE", help="Write the result as JSON; - for stdout.")]
Rig = Annotated[str, typer.Argument(help="Name of a shipped rig (see `gearheat list`), or path of a rig file.")]
