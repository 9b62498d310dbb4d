"""The command that builds the documentation."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal, cast

import typer
from typer.core import TyperGroup

from ..show import console


@console.guarded
def docs(
    context: typer.Context,
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder of the web site.")],
    run: Annotated[
        Literal["quick", "all", "none"],
        typer.Option(help="Code blocks to run before: those that take seconds, all, or none."),
    ] = "quick",
) -> None:
    """Build the documentation as a web site; its code blocks are run and their output compared with the pages."""
    from ..docs import build

    build.docs_command(cast(TyperGroup, context.find_root().command), out, run)
