"""The web site: pages and generated reference, put into one folder and built by Sphinx.

The program's own pages are written here: its commands with their options, the keys of their JSON, the modules.
"""

from __future__ import annotations

import contextlib
import gc
import json
import re
import shlex
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from importlib.metadata import version
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from typer.core import TyperGroup

from ...model.errors import GearheatError
from ..show.console import folder, note
from . import reference
from .blocks import FENCE, MARKS, PAGES, call, run_pages
from .reference import TABLES, code, fill_blocks, page

#: New objects after which the collector of cycles looks through them, 700 by default.
LOOK_AFTER = 100_000
DUTY = "time [min],input.w [rpm],output.tau [N.m],room.T [degC]\n0,1450,-500,20\n240,1450,-500,20\n"


def docs_command(program: TyperGroup, public: Mapping[str, Any], out: Path, run: str) -> None:
    """Run the pages' code blocks and build the web site.

    Args:
        program: the command line
        public: functions and classes of `gearheat` by name
        out: folder of the web site
        run: which blocks are run before: "quick", "all" or "none"

    Raises:
        GearheatError: Sphinx is not installed, a block does not do what its page says, or Sphinx finds a fault
    """
    if not (find_spec("sphinx") and find_spec("myst_parser")):
        raise GearheatError('docs: Sphinx is not installed. Run pip install "gearheat[docs]".')
    if run != "none" and (found := run_pages(program, run == "all")):
        raise GearheatError(found)
    note(f"{len(list(PAGES.rglob('*.md')))} pages and the reference; code blocks are run with --run quick or all")
    build(program, public, folder(out))
    note(f"{out / 'index.html'}")


def build(program: TyperGroup, public: Mapping[str, Any], out: Path) -> None:
    """Build the web site; every warning of Sphinx is a fault.

    Raises:
        GearheatError: Sphinx finds a fault
    """
    from sphinx.application import Sphinx
    from sphinx.errors import SphinxError

    with tempfile.TemporaryDirectory() as work:
        source = gather(program, public, Path(work) / "source")
        note("building with Sphinx")
        static = source / "static"
        static.mkdir()
        shutil.copy(Path(__file__).with_name("narrow.css"), static)
        own = dict.fromkeys(("version", "release"), version("gearheat"))
        theme = "furo" if find_spec("furo") else "alabaster"
        settings = {**TABLES["sphinx"], **own, "html_theme": theme, "html_static_path": [str(static)]}
        places = (str(source), None, str(out), str(Path(work) / "trees"), "html")
        gc.collect()  # before trees of millions of nodes are made, in which the collector would look for cycles
        gc.freeze()
        usual = gc.get_threshold()
        gc.set_threshold(LOOK_AFTER)
        try:
            app = Sphinx(*places, confoverrides=settings, status=None, warningiserror=True, exception_on_warning=False)
            app.build()
        except SphinxError as error:
            raise GearheatError(f"docs: {error}") from error
        finally:
            gc.set_threshold(*usual)
            gc.unfreeze()
        if app.statuscode:
            raise GearheatError("docs: Sphinx finds faults, see above.")


def gather(program: TyperGroup, public: Mapping[str, Any], source: Path) -> Path:
    """All pages in one folder, with the reference generated from the code.

    Args:
        source: folder to make
    """
    shutil.copytree(PAGES, source)
    place = source / "generated"
    for title, found in (
        ("parts, laws and rigs", reference.pages()),
        ("commands, modules and gallery", _list_program_pages(program, public, place / "gallery")),
    ):
        note(f"writing {title}")
        for name, text in found:
            (place / name).parent.mkdir(parents=True, exist_ok=True)
            # linked by the page above it: 150 more entries in the tree beside every page would cost much of the build
            alone = "" if Path(name).parent == Path() or Path(name).stem == "index" else "---\norphan: true\n---\n\n"
            (place / name).write_text(alone + text, encoding="utf-8")
    reference.copy_pictures(place)
    for path in source.rglob("*.md"):
        path.write_text(fill_blocks(add_captions(path.read_text(encoding="utf-8"))), encoding="utf-8")
    return source


def add_captions(text: str) -> str:
    """A page whose blocks of files have the file's name as caption."""

    def block(match: re.Match[str]) -> str:
        language, rest, body = match.groups()
        file = " ".join(word for word in rest.split() if word not in MARKS)
        if not file or file.startswith("{"):
            return match[0] if not language else f"```{language}\n{body}```"
        return f"```{{code-block}} {language}\n:caption: {file}\n\n{body}```"

    return FENCE.sub(block, text)


def _list_program_pages(program: TyperGroup, public: Mapping[str, Any], drawn: Path) -> Iterator[tuple[str, str]]:
    """Path below the folder of generated pages, and text, of every page on commands and public names.

    Args:
        drawn: folder of the gallery's pictures, made
    """
    commands = sorted(program.commands.items())
    yield "commands.md", page("commands", commands=commands, named=_named, default=_default)
    schema = json.loads(files("gearheat.tools.diagnose.report").joinpath("diagnosis.schema.json").read_text("utf-8"))
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        Path("duty.csv").write_text(DUTY, encoding="utf-8")
        pictures = {c: ("--plot", str(drawn / f"{name}.png")) for name, (_, c) in TABLES["gallery"].items()}
        drawn.mkdir(parents=True)
        answers = {c: _ask(program, c, *pictures.pop(c, ())) for c in TABLES["asked"]}
        for command, plot in pictures.items():
            _ask(program, command, *plot)
    yield "json.md", page("json", answers={c: dict(_keys(answer)) for c, answer in answers.items()}, schema=schema)
    yield "gallery.md", page("gallery", pictures=TABLES["gallery"], duty=DUTY)
    members = list(_public(public))
    yield "api/index.md", page("api", modules=TABLES["modules"], members=members, public=public)
    yield "api/gearheat.md", page("public", members=members)
    for module in TABLES["modules"]:
        yield f"api/{module}.md", page("module", name=module)


def _named(param: Any) -> str:
    """An argument or an option as it is written."""
    if param.opts[0].startswith("-"):
        return ", ".join(code(name) for name in (*param.opts, *param.secondary_opts))
    return code((param.metavar or param.name).upper())


def _default(param: Any) -> str:
    known = param.default is not None and not param.required and not callable(param.default)
    return code(param.default) if known else ""


def _ask(program: TyperGroup, command: str, *options: str) -> Any:
    """The JSON of a command."""
    ended, out, said = call(program, [*shlex.split(command), *options, "--json", "-"])
    if ended:
        raise GearheatError(f"docs: gearheat {command} ends with {ended}: {said}")
    return json.loads(out)


def _keys(value: Any, path: str = "") -> Iterator[tuple[str, str]]:
    """Every path into a value with its type; names that are data, such as parts or columns, are one path."""
    if isinstance(value, Mapping) and value:
        named = path in TABLES["named"] or (path and not all(key.isidentifier() for key in value))
        for key, entry in value.items():
            yield from _keys(entry, f"{path}.*" if named else f"{path}.{key}".strip("."))
    elif isinstance(value, list) and value:
        for entry in reversed(value):  # of several types that of the first
            yield from _keys(entry, f"{path}[]")
    else:
        kinds = {"str": "text", "NoneType": "null", "bool": "true or false", "int": "number", "float": "number"}
        yield path, kinds.get(type(value).__name__, f"empty {type(value).__name__}")


def _public(public: Mapping[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Public names with their places and kinds, functions first, but for those whose module has a page."""
    pages = {f"gearheat.{module}" for module in TABLES["modules"]}
    members = {name: member for name, member in public.items() if member.__module__ not in pages}
    for name, member in sorted(members.items(), key=lambda item: (isinstance(item[1], type), item[0])):
        kind = "class" if isinstance(member, type) else "function"
        yield name, f"{member.__module__}.{member.__qualname__}", kind
