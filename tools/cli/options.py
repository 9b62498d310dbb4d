"""Options of the command line: what `options.toml` says of the parameters of the commands."""

from __future__ import annotations

import functools
import inspect
import tomllib
from collections.abc import Callable, Mapping
from importlib.resources import files
from typing import Annotated, Any, TypeVar, cast, get_type_hints

import gearheat as gh
import typer
from typer.core import TyperCommand

C = TypeVar("C", bound=Callable[..., None])

TEXTS: dict[str, dict[str, Any]] = tomllib.loads(
    files("gearheat.tools.cli").joinpath("options.toml").read_text("utf-8")
)


class Command(TyperCommand):
    """A command some of whose options may stand without a value: the first of those under `bare` in `options.toml`.

    An option with one value is refused a second time: the first value would be dropped unseen.
    """

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Read the arguments."""
        for about in TEXTS.get(self.name or "", {}).values():
            values: list[str] = about.get("bare", []) if isinstance(about, dict) else []
            for k in [k for k, text in enumerate(args) if values and text in about["flags"]][::-1]:
                if not any(text in values for text in args[k + 1 : k + 2]):
                    args.insert(k + 1, values[0])
        options: Any = self.make_parser(ctx).parse_args(list(args))[2]
        for option in options if not ctx.resilient_parsing else ():
            if options.count(option) > 1 and not (option.multiple or option.is_flag):
                ctx.fail(f"{option.opts[-1]} is given {options.count(option)} times. Give it once.")
        return super().parse_args(ctx, args)


def describe(name: str, command: C) -> C:
    """A command whose parameters have their texts.

    Args:
        name: of the command
        command: its function
    """
    texts = {**TEXTS["every"], **TEXTS.get(name, {})}
    kinds = get_type_hints(command)
    options = {key: Annotated[kind, _option(texts[key], kind)] for key, kind in kinds.items() if key in texts}
    command.__annotations__ = kinds | options
    return _with_parts(command) if "rig" in kinds else command


def _with_parts(command: C) -> C:
    """A command that takes modules whose part types its rig may name, and values beyond what gear units have."""

    @functools.wraps(command)
    def run(*args: Any, parts: list[str] | None = None, override: bool = False, **kwargs: Any) -> None:
        gh.use_parts(*(parts or ()))
        with gh.override(override):
            command(*args, **kwargs)

    own = inspect.signature(command)
    kinds = {"parts": list[str] | None, "override": bool}
    told = {key: Annotated[kind, _option(TEXTS["every"][key])] for key, kind in kinds.items()}
    more = [
        inspect.Parameter(key, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=told[key])
        for key, default in (("parts", None), ("override", False))
    ]
    vars(run)["__signature__"] = own.replace(parameters=[*own.parameters.values(), *more])
    run.__annotations__ = {**command.__annotations__, **told}
    return cast(C, run)


def _option(about: str | Mapping[str, Any], type_: Any = str) -> Any:
    """A parameter as Typer takes it."""
    told: dict[str, Any] = {"help": about} if isinstance(about, str) else dict(about)
    kind = typer.Argument if told.pop("argument", False) else typer.Option
    told.pop("bare", None)
    if told.pop("completed", False):
        told["autocompletion"] = _rigs
    if type_ is float:
        told |= {"parser": _number, "metavar": "<float>"}
    return kind(*told.pop("flags", ()), **told)


def _number(text: str | float) -> float:
    """A number as it is written, or its default."""
    from ...model.errors import ScenarioError
    from ..show.console import number

    try:
        return number(str(text))
    except ScenarioError as error:
        raise typer.BadParameter(str(error)) from None


def _rigs(incomplete: str) -> list[str]:
    """What the shell completes the name of a rig to."""
    from ...scenarios.shipped import RIGS

    return sorted(p.parent.name for p in RIGS.glob("*/rig.toml") if p.parent.name.startswith(incomplete))
