"""Options of the command line: what `options.toml` says of the parameters of the commands."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from importlib.resources import files
from typing import Annotated, Any, TypeVar, get_type_hints

import typer

C = TypeVar("C", bound=Callable[..., None])

TEXTS: dict[str, dict[str, Any]] = tomllib.loads(
    files("gearheat.tools.cli").joinpath("options.toml").read_text("utf-8")
)


def describe(name: str, command: C) -> C:
    """A command whose parameters have their texts.

    Args:
        name: of the command
        command: its function
    """
    texts = {**TEXTS["every"], **TEXTS.get(name, {})}
    kinds = get_type_hints(command)
    options = {key: Annotated[kind, _option(texts[key])] for key, kind in kinds.items() if key in texts}
    command.__annotations__ = kinds | options
    return command


def _option(about: str | Mapping[str, Any]) -> Any:
    """A parameter as Typer takes it."""
    told: dict[str, Any] = {"help": about} if isinstance(about, str) else dict(about)
    kind = typer.Argument if told.pop("argument", False) else typer.Option
    if told.pop("completed", False):
        told["autocompletion"] = _rigs
    return kind(*told.pop("flags", ()), **told)


def _rigs(incomplete: str) -> list[str]:
    """What the shell completes the name of a rig to."""
    from ...scenarios.shipped import RIGS

    return sorted(p.parent.name for p in RIGS.glob("*/rig.toml") if p.parent.name.startswith(incomplete))
