"""The web site: pages and generated reference, put into one folder and built by Sphinx."""

from __future__ import annotations

import re
import shutil
import tempfile
from collections.abc import Mapping
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from typer.core import TyperGroup

from ...model.errors import GearheatError
from ..show.console import folder, note
from . import commands, reference
from .blocks import FENCE, MARKS, PAGES, run_pages
from .laws import fill_blocks
from .markdown import TABLES


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
        static = source / "static"
        static.mkdir()
        shutil.copy(Path(__file__).with_name("narrow.css"), static)
        own = dict.fromkeys(("version", "release"), version("gearheat"))
        settings = {**TABLES["sphinx"], **own, "html_static_path": [str(static)]}
        places = (str(source), None, str(out), str(Path(work) / "trees"), "html")
        try:
            app = Sphinx(*places, confoverrides=settings, status=None, warningiserror=True, exception_on_warning=False)
            app.build()
        except SphinxError as error:
            raise GearheatError(f"docs: {error}") from error
        if app.statuscode:
            raise GearheatError("docs: Sphinx finds faults, see above.")


def gather(program: TyperGroup, public: Mapping[str, Any], source: Path) -> Path:
    """All pages in one folder, with the reference generated from the code.

    Args:
        source: folder to make
    """
    shutil.copytree(PAGES, source)
    place = source / "generated"
    for name, text in (*reference.pages(), *commands.pages(program, public)):
        (place / name).parent.mkdir(parents=True, exist_ok=True)
        (place / name).write_text(text, encoding="utf-8")
    reference.copy_pictures(place)
    for page in source.rglob("*.md"):
        page.write_text(fill_blocks(add_captions(page.read_text(encoding="utf-8"))), encoding="utf-8")
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
