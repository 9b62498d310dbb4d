"""HTML pages: one frame and one style for all of them."""

from __future__ import annotations

from functools import cache
from typing import Any

from jinja2 import Environment, PackageLoader


@cache
def _templates() -> Environment:
    loader = PackageLoader("gearheat.tools", "templates")
    return Environment(loader=loader, autoescape=True, trim_blocks=True, lstrip_blocks=True)


def page(template: str, **values: Any) -> str:
    """A self-contained page as HTML text, the same bytes for the same values.

    Args:
        template: file in the folder of templates
        values: what it shows, by the template's own names
    """
    return _templates().get_template(template).render(**values)
