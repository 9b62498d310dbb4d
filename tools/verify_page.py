"""The page of `gearheat verify`: one self-contained HTML file by which a reader judges the library."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.resources import files
from typing import Any

from jinja2 import Environment

from .verdicts import VERDICTS


def render(found: Mapping[str, Any]) -> str:
    """The page as HTML text, the same bytes for the same verdicts.

    Args:
        found: the object of `--json`
    """
    template = files("gearheat.tools").joinpath("templates/verify.html").read_text(encoding="utf-8")
    page = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True).from_string(template)
    return page.render(found=found, verdicts=VERDICTS)
