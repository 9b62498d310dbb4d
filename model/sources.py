"""The sources cited by the laws, and the decorator that ties a law to its source.

A law is one formula of one source. `@law` stores key, place and validity on the function; while a `recording()` is
open every law called notes itself and those of its arguments that have a range, so a model knows what it cites and
where its correlations stop being valid.
"""

from __future__ import annotations

import functools
import inspect
import tomllib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from importlib.resources import files
from typing import Any, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")


@dataclass(frozen=True)
class Source:
    """One entry of sources.toml."""

    key: str
    title: str
    author: str
    year: int
    where: str = ""


@dataclass(frozen=True, eq=False)
class LawInfo:
    """What a law declares: source key, place in the source, validity in words and as ranges of its arguments (SI)."""

    name: str
    source: str
    where: str
    valid: str = ""
    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    verified: bool = True


@dataclass(frozen=True, eq=False)
class LawUse:
    """One call of a law inside a model: the law and the expressions of the arguments that have a range."""

    law: LawInfo
    arguments: Mapping[str, Any]


_uses: ContextVar[list[LawUse] | None] = ContextVar("law uses", default=None)


@contextmanager
def recording() -> Iterator[list[LawUse]]:
    """Collect the laws called inside the block."""
    uses: list[LawUse] = []
    token = _uses.set(uses)
    try:
        yield uses
    finally:
        _uses.reset(token)


def law(
    *,
    source: str,
    where: str,
    valid: str = "",
    ranges: Mapping[str, tuple[float, float]] | None = None,
    verified: bool = True,
) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Tie a pure function to the source it comes from.

    Args:
        source: key of sources.toml
        where: equation, table or section of the source
        valid: range of validity in words
        ranges: argument name -> (low, high) in SI, checked by every run that uses the law
        verified: False for a law without a golden row from print; reports list it as unverified
    """
    limits = dict(ranges or {})

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        info = LawInfo(function.__name__, source, where, valid, limits, verified)
        signature = inspect.signature(function)
        if unknown := limits.keys() - signature.parameters.keys():
            raise TypeError(f"law {function.__name__}: ranges name unknown arguments {sorted(unknown)}")

        @functools.wraps(function)
        def called(*args: P.args, **kwargs: P.kwargs) -> R:
            uses = _uses.get()
            if uses is not None:
                bound = signature.bind(*args, **kwargs).arguments
                uses.append(LawUse(info, {name: bound[name] for name in limits if name in bound}))
            return function(*args, **kwargs)

        called.law = info  # type: ignore[attr-defined]
        return called

    return decorate


@functools.cache
def sources() -> Mapping[str, Source]:
    """All sources by key."""
    table = tomllib.loads(files("gearheat.model").joinpath("sources.toml").read_text(encoding="utf-8"))
    return {key: Source(key=key, **entry) for key, entry in table.items()}
