"""Tests of many cases: one test of all of them where each is small, one case of each kind where each is large."""

from __future__ import annotations

import os
from collections.abc import Callable, Hashable, Iterable
from typing import Any, TypeVar

#: Whether every case of a check is tried, also where a few stand for all of them.
ALL = os.environ.get("GEARHEAT_TESTS") == "all"

Check = Callable[..., None]
T = TypeVar("T")


def for_each(
    cases: Iterable[Any], name: Callable[[Any], str] = str
) -> Callable[[Callable[..., None]], Callable[[], None]]:
    """Make a check of one case the test of all of them; it fails with every case that does not hold.

    Args:
        cases: what the check is called with, one after the other; a tuple is several arguments
        name: what a case is called in the list of failures
    """

    def join(check: Check) -> Callable[[], None]:
        def test() -> None:
            tried, problems = 0, []
            for case in cases:
                tried += 1
                try:
                    check(*case) if isinstance(case, tuple) else check(case)
                except Exception as error:
                    problems.append(f"{name(case)}: {type(error).__name__}: {error}")
            assert tried, "there is no case"
            assert not problems, "\n".join(problems)

        test.__name__, test.__doc__, test.__module__ = check.__name__, check.__doc__, check.__module__
        return test

    return join


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


def thin(cases: Iterable[T], first: int = 0, apart: int = 3) -> list[T]:
    """The cases, or some of them: checks that take long share them out among each other.

    Args:
        cases: all of them
        first: number of the first that is kept
        apart: distance to the next
    """
    every = list(cases)
    return every if ALL else every[first::apart]
