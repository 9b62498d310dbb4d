"""The command of logs: how well a rig predicts them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..show import console
from .options import Json


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
