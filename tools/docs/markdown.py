"""Pages as text: tables, escaped words, docstrings with their formulas."""

from __future__ import annotations

import inspect
import re
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from importlib.resources import files
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

#: What the pages tell of, and settings of the web site.
TABLES: dict[str, Any] = tomllib.loads(files("gearheat.tools.docs").joinpath("docs.toml").read_text(encoding="utf-8"))
MATH = re.compile(r"^\.\. math::[ \n]*((?:.+\n?)+?)(?:\n|\Z)", re.MULTILINE)


def words(value: Any) -> str:
    """A value as words of a page: nothing in it is markup but text between backticks."""
    text = ", ".join(map(str, value)) if isinstance(value, list | tuple) else str(value)
    parts = re.split(r"(`[^`]*`)", " ".join(text.split()))
    return "".join(re.sub(r"(\|)" if k % 2 else r"([*<\[\]|])", r"\\\1", part) for k, part in enumerate(parts))


def code(value: Any) -> str:
    """A name or a value as code; nothing for nothing."""
    text = str(value).replace("|", "\\|")
    return f"`{text}`" if text else ""


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table, nothing where it has no rows."""
    lines = [f"| {' | '.join(row)} |" for row in rows]
    return "\n".join([f"| {' | '.join(head)} |", f"|{'---|' * len(head)}", *lines]) + "\n\n" if lines else ""


def listing(lines: Sequence[Mapping[str, Any]], keys: Sequence[str]) -> str:
    """A table of dictionaries, columns in which all are empty left out; names are code.

    Args:
        lines: the rows
        keys: the columns
    """
    kept = [key for key in keys if any(str(line[key]) for line in lines)]
    shown = ((code(line[key]) if key == "name" else words(line[key]) for key in kept) for line in lines)
    return table([key.replace("_", " ") for key in kept], [list(row) for row in shown])


def fenced(language: str, text: str) -> str:
    """A block of code."""
    return f"```{language}\n{text.rstrip()}\n```\n\n"


def docstring(of: Any) -> str:
    """What a docstring says before its arguments, its formulas as formulas."""
    text = re.split(r"^(?:Args|Returns|Raises):$", inspect.getdoc(of) or "", maxsplit=1, flags=re.MULTILINE)[0]
    pieces = MATH.split(text)
    shown = [fenced("{math}", p) if k % 2 else "\n\n".join(map(words, p.split("\n\n"))) for k, p in enumerate(pieces)]
    return "\n\n".join(piece.strip() for piece in shown if piece.strip()) + "\n\n"


def list_arguments(of: Any) -> list[tuple[str, str]]:
    """The arguments that a docstring tells, with what it says of them."""
    told = (inspect.getdoc(of) or "").partition("Args:\n")[2].partition("\n\n")[0]
    return re.findall(r"^    (\w[\w, ]*): (.*(?:\n {5,}.*)*)", told, re.MULTILINE)


def arguments(of: Any) -> str:
    """The arguments that a docstring tells, as a list."""
    found = list_arguments(of)
    return "".join(f"- `{name}`: {words(text)}\n" for name, text in found) + "\n" if found else ""


def toctree(names: Iterable[str]) -> str:
    """The pages below a page."""
    return fenced("{toctree}", "\n".join([":hidden:", "", *names]))


@cache
def _templates() -> Environment:
    found = Environment(
        loader=PackageLoader("gearheat.tools.docs"), undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    found.filters |= {"words": words, "code": code, "doc": inspect.getdoc}
    found.globals |= {f.__name__: f for f in (fenced, listing, docstring, arguments, toctree)}
    return found


def page(name: str, /, **values: Any) -> str:
    """A page by its template.

    Args:
        name: of the template
        values: what it asks for
    """
    return f"{_templates().get_template(f'{name}.md.jinja').render(values).rstrip()}\n"
