"""Which columns of a table fit beside each other on a screen."""

from __future__ import annotations

from collections.abc import Sequence


def fitting(widths: Sequence[int], whole: Sequence[bool], room: int, *, repeated: bool) -> list[list[int]]:
    """Columns that fit beside each other: those of words go first, from the last on; numbers go on in further tables.

    Args:
        widths: of the columns at least
        whole: which of them are numbers or names
        room: of the screen
        repeated: whether further tables begin with the first column
    """

    def size(kept: Sequence[int]) -> int:
        return sum(widths[k] + 3 for k in kept) + 1  # what is drawn around a column

    kept = list(range(len(widths)))
    for i in (i for i in reversed(range(1, len(widths))) if not whole[i]):
        if size(kept) <= room:
            break
        kept.remove(i)
    groups: list[list[int]] = [[]]
    for i in kept:
        if groups[-1] and size([*groups[-1], i]) > room:
            groups.append([0] if repeated else [])
        groups[-1].append(i)
    return groups
