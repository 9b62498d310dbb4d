"""HTML pages of all rooms, in one frame and one style."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from functools import cache
from importlib.resources import files
from typing import Any

from jinja2 import ChoiceLoader, Environment, PackageLoader
from markupsafe import Markup, escape

from .console import cell

#: The package whose templates all pages may use: the frame is one of them.
OWN = "gearheat.tools.show"


@cache
def _templates(package: str) -> Environment:
    loader = ChoiceLoader([PackageLoader(name, "templates") for name in dict.fromkeys((package, OWN))])
    return Environment(loader=loader, autoescape=True, trim_blocks=True, lstrip_blocks=True)


def page(package: str, template: str, **values: Any) -> str:
    """A self-contained page as HTML text, the same bytes for the same values.

    Args:
        package: whose folder `templates` holds the template
        template: file in that folder
        values: what it shows, by the template's own names
    """
    return _templates(package).get_template(template).render(**values)


def html_table(head: Sequence[str], body: Iterable[Sequence[Any]], ours: int = -1) -> Markup:
    """An HTML table: columns of numbers to the right, columns of words to the left.

    Args:
        head: names of the columns
        body: a text or a number per column
        ours: number of a row that stands out
    """
    lines = [[cell(value) for value in row] for row in body]
    columns = zip(*lines, strict=True) if lines else [()] * len(head)
    words = [any(text and text[0] not in "-+<>±.0123456789" for text in column) for column in columns]

    def row(tag: str, values: Sequence[str]) -> str:
        cells = ((f'<{tag} class="text">' if word else f"<{tag}>", v) for v, word in zip(values, words, strict=True))
        return "".join(f"{opening}{escape(value)}</{tag}>" for opening, value in cells)

    rows = [f"<tr>{row('th', head)}</tr>"]
    rows += [f"<tr{' class=ours' if i == ours else ''}>{row('td', line)}</tr>" for i, line in enumerate(lines)]
    return Markup("<table>\n" + "\n".join(rows) + "\n</table>")


def as_data(value: Any) -> Markup:
    """A value as JSON that may stand in a page."""
    return Markup(json.dumps(value, ensure_ascii=False, allow_nan=False).replace("<", "\\u003c"))


@cache
def load_plot_library() -> dict[str, Markup]:
    """The plot library of the pages: its script, style and licence."""
    names = {"script": "uPlot.iife.min.js", "css": "uPlot.min.css", "licence": "uPlot.LICENSE"}
    folder = files(OWN).joinpath("vendor")
    return {key: Markup(folder.joinpath(name).read_text(encoding="utf-8").strip()) for key, name in names.items()}
