"""What a picture of a result is; nothing here draws."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure


#: A place in a figure, in shares of its width and of its height from above, and what is said there.
Mark = tuple[float, float, str]


@dataclass(frozen=True)
class Picture:
    """What is drawn, and what an HTML page says beside it.

    Attributes:
        figure: the picture
        title, note: what it is, and what to know about it
        columns, rows: of a table below it; none without columns
        courses: series over time as `courses.js` reads them; the figure is then for readers without JavaScript
        marks: what a page says beside the pointer
    """

    figure: Figure
    title: str
    note: str = ""
    columns: Sequence[str] = ()
    rows: Sequence[Sequence[Any]] = ()
    courses: Any = None
    marks: Sequence[Mark] = ()
