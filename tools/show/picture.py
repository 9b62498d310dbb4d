"""What a picture of a result is; nothing here draws."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Picture:
    """What is drawn, and what an HTML page says beside it.

    Attributes:
        figure: the picture
        title, note: what it is, and what to know about it
        columns, rows: of a table below it; none without columns
        courses: series over time as `courses.js` reads them; the figure is then for readers without JavaScript
    """

    figure: Figure
    title: str
    note: str = ""
    columns: Sequence[str] = ()
    rows: Sequence[Sequence[Any]] = ()
    courses: Any = None
