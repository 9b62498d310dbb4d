"""What is the same in every FMU: files of the wrapper in C, tables, its icon, and templates of XML."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from typing import Any
from xml.sax.saxutils import escape

from jinja2 import Environment, PackageLoader, StrictUndefined

from ..model.errors import visible
from ..model.files import tables as read_tables

#: What must not stand in the value of an attribute as it is, beside the brackets.
_IN_ATTRIBUTES = {'"': "&quot;", "\r": "&#13;", "\n": "&#10;", "\t": "&#09;"}


def wrapper(name: str) -> str:
    """Text of a file of the wrapper."""
    return (files("gearheat.fmu") / "wrapper" / name).read_text(encoding="utf-8")


@cache
def tables(name: str) -> dict[str, Any]:
    """The tables of a file."""
    return read_tables("fmu", "tables", f"{name}.toml")


def icon() -> bytes:
    """A wheel and a warm pinion that mesh, as PNG."""
    return (files("gearheat.fmu") / "templates" / "icon.png").read_bytes()


def xml(template: str, **values: Any) -> bytes:
    """The text of an XML file.

    Args:
        template: file in `templates`
        values: what it asks for
    """
    return _templates().get_template(template).render(values).encode()


@cache
def _templates() -> Environment:
    found = Environment(
        loader=PackageLoader("gearheat.fmu"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    found.filters |= {"attributes": _attributes, "quoted": _quoted, "text": _text}
    return found


def _attributes(values: Mapping[str, Any]) -> str:
    """Attributes of an element, those without a value left out; numbers keep all their digits."""
    return "".join(f" {name}={_quoted(value)}" for name, value in values.items() if value is not None)


def _quoted(value: Any) -> str:
    return f'"{escape(visible(str(value)), _IN_ATTRIBUTES)}"'


def _text(value: str) -> str:
    return escape(visible(value))
