"""HTML pages of the commands, in the frame and style that all pages share."""

from __future__ import annotations

from typing import Any

from ..diagnose.report import frame


def page(template: str, **values: Any) -> str:
    """A self-contained page as HTML text, the same bytes for the same values.

    Args:
        template: file in the folder of templates
        values: what it shows, by the template's own names
    """
    return frame.page("gearheat.tools", template, **values)
