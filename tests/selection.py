"""Which cases of a long table run: some of each kind by default, all of them where `GEARHEAT_TESTS=all`."""

from collections.abc import Callable, Hashable, Iterable
from typing import TypeVar

from for_each import ALL

T = TypeVar("T")


def one_of_each(cases: Iterable[T], kind: Callable[[T], Hashable]) -> list[T]:
    """The cases, or one of each kind: the first, second, third ... in turn, so that all positions are met.

    Args:
        cases: all of them
        kind: what cases have in common of which one is enough
    """
    every = list(cases)
    if ALL:
        return every
    groups: dict[Hashable, list[T]] = {}
    for case in every:
        groups.setdefault(kind(case), []).append(case)
    return [group[k % len(group)] for k, group in enumerate(groups.values())]
