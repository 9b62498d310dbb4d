"""Pages on the program as it is called: its commands with their options, the keys of their JSON, the modules."""

from __future__ import annotations

import contextlib
import json
import shlex
import tempfile
from collections.abc import Iterator, Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

import gearheat
from typer.core import TyperGroup

from ...model.errors import GearheatError
from .blocks import called
from .markdown import code, fenced, table, words
from .reference import toctree

#: What parts, machines and causes of one's own are made with.
MODULES = (
    "scenarios.load",
    "model.machines.spec",
    "model.core.component",
    "model.core.declare",
    "model.core.connect",
    "model.core.flatten",
    "model.core.flat",
    "model.run.steady",
    "model.run.simulate",
    "model.run.schedule",
    "model.run.design",
    "model.run.result",
    "model.run.sensitivity",
    "model.contact",
    "model.sources",
    "model.units",
    "fmu.export",
    "fmu.play",
    "tools.diagnose.library.cause",
)
#: Commands whose JSON is shown: quick ones, on a rig that comes with gearheat.
ASKED = (
    "list",
    "parts LipSeal",
    "show helical_two_stage",
    "losses helical_two_stage",
    "steady helical_two_stage",
    'design helical_two_stage --free cooling.A --target "oil.T=45 degC"',
    "map helical_two_stage -o map.csv --grid 3x3",
    'rating helical_two_stage --limit "oil.T=95 degC" --grid 2x2',
    'new mine --stages helical --ratio 4 --power "2 kW" --speed "1450 rpm"',
    'sweep helical_two_stage --vary "room.T=10..30 degC" --grid 3 -o sweep.csv',
    "simulate helical_two_stage --duty duty.csv -o warmup.csv",
    "verify fzg_four_square",
)
#: Keys whose entries are named by the rig or the catalogue.
NAMED = ("rigs", "reproduces", "sensors")
DUTY = "time [min],input.w [rpm],output.tau [N.m],room.T [degC]\n0,1450,-500,20\n10,1450,-500,20\n"


def pages(program: TyperGroup) -> Iterator[tuple[str, str]]:
    """Path below the folder of generated pages, and text, of every page."""
    yield "commands.md", _commands(program)
    yield "json.md", _json(program)
    about = (
        "`import gearheat` has all that the commands do; the modules below it are for parts and machines of one's own."
    )
    yield "api/index.md", f"# Python\n\n{about}\n\n{toctree(['gearheat', *MODULES])}"
    yield "api/gearheat.md", _public()
    for module in MODULES:
        yield f"api/{module}.md", _module(module)


def _commands(program: TyperGroup) -> str:
    text = "".join(
        f"## {name}\n\n{words(command.help)}\n\n"
        + table(
            ("option", "needed", "default", "meaning"),
            [_option(p) for p in command.params if getattr(p, "help", None)],
        )
        for name, command in sorted(program.commands.items())
    )
    return f"# Commands\n\nEvery command takes `--help`; exit code 2 means bad input.\n\n{text}"


def _option(param: Any) -> tuple[str, str, str, str]:
    names = ", ".join(code(name) for name in (*param.opts, *param.secondary_opts))
    argument = not param.opts[0].startswith("-")
    default = "" if callable(param.default) else str(param.default)
    named = code((param.metavar or param.name).upper()) if argument else names
    shown = "" if param.default is None or param.required else code(default)
    return named, "yes" if param.required else "", shown, words(param.help)


def _json(program: TyperGroup) -> str:
    text = (
        "`--json -` writes one object to standard output, `--json FILE` into a file. `schema` names its form: keys are"
        " added to a form, never taken away or given another meaning. Entries of a list have the keys behind `[]`;"
        " `*` stands for names of the rig.\n\n"
    )
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        Path("duty.csv").write_text(DUTY, encoding="utf-8")
        shown = "".join(_keys_of(program, command) for command in ASKED)
    schema = json.loads(files("gearheat.tools.diagnose.report").joinpath("diagnosis.schema.json").read_text("utf-8"))
    rows = [(code(key), words(about.get("description", ""))) for key, about in schema["properties"].items()]
    findings = f"## diagnose\n\nSchema: `{schema['$id']}`, as a JSON schema beside the module.\n\n"
    return f"# JSON\n\n{text}{shown}{findings}{table(('key', 'meaning'), rows)}"


def _keys_of(program: TyperGroup, command: str) -> str:
    code_, out, said = called(program, [*shlex.split(command), "--json", "-"])
    if code_:
        raise GearheatError(f"docs: gearheat {command} ends with {code_}: {said}")
    keys = dict(_keys(json.loads(out)))
    rows = [(code(key), kind) for key, kind in keys.items()]
    shown = fenced("sh", f"gearheat {command} --json -")
    return f"## {command.split(maxsplit=1)[0]}\n\n{shown}{table(('key', 'type'), rows)}"


def _keys(value: Any, path: str = "") -> Iterator[tuple[str, str]]:
    """Every path into a value with its type; names that are data, such as parts or columns, are one path."""
    if isinstance(value, Mapping) and value:
        named = path in NAMED or (path and not all(key.isidentifier() for key in value))
        for key, entry in value.items():
            yield from _keys(entry, f"{path}.*" if named else f"{path}.{key}".strip("."))
    elif isinstance(value, list) and value:
        for entry in reversed(value):  # of several types that of the first
            yield from _keys(entry, f"{path}[]")
    else:
        kinds = {"str": "text", "NoneType": "null", "bool": "true or false", "int": "number", "float": "number"}
        yield path, kinds.get(type(value).__name__, f"empty {type(value).__name__}")


def _public() -> str:
    """All public names, functions first."""
    names = [name for name, module in gearheat.PUBLIC.items() if module not in MODULES]
    classes = {name: isinstance(getattr(gearheat, name), type) for name in names}
    blocks = []
    for name in sorted(classes, key=lambda name: (classes[name], name)):
        kind = "class" if classes[name] else "function"
        member = f"gearheat.{gearheat.PUBLIC[name]}.{gearheat.RENAMED.get(name, name)}"
        options = "\n   :members:" if classes[name] else ""
        blocks.append(f"## {name}\n\n" + fenced("{eval-rst}", f".. auto{kind}:: {member}{options}"))
    return "# gearheat\n\n" + "\n".join(blocks)


def _module(name: str) -> str:
    return f"# gearheat.{name}\n\n" + fenced("{eval-rst}", f".. automodule:: gearheat.{name}\n   :members:")
