"""The sources cited by the laws, and the decorator that ties a law to its source.

A law is one formula of one source. `@law` stores key, place and validity on the function; while a `recording()` is
open every law called notes itself and those of its arguments that have a range, so a model knows what it cites and
where its correlations stop being valid.
"""

from __future__ import annotations

import functools
import inspect
import operator
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import Any, ParamSpec, TypeVar

from .files import tables

P = ParamSpec("P")
R = TypeVar("R")


@dataclass(frozen=True)
class Source:
    """One entry of sources.toml."""

    key: str
    title: str
    author: str
    year: int | str
    where: str = ""

    @property
    def cited(self) -> str:
        """In a line."""
        return f"{self.author} {self.year}, {self.title}"


#: What may stand between two arguments of a law in the name of a range: "F_a / C_0".
_BETWEEN: Mapping[str, Callable[[Any, Any], Any]] = {
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
}


@dataclass(frozen=True, eq=False)
class LawInfo:
    """What a law declares: source key, place in the source, validity in words and as ranges (SI).

    A range belongs to an argument, "nu", or to the difference, product or quotient of two, "T - T_pour", "w * d_m",
    "F_a / C_0". Where one is left, `regimes` says what reigns there; "{name}" in it stands for the value of that output
    of the part. `formula` is that of the law's docstring, in LaTeX, "" where it has none.
    """

    name: str
    source: str
    where: str
    valid: str = ""
    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    verified: bool = True
    regimes: Mapping[str, str] = field(default_factory=dict)
    formula: str = ""


@dataclass(frozen=True, eq=False)
class LawUse:
    """One call of a law inside a model: the law and the expressions of what has a range."""

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
    regimes: Mapping[str, str] | None = None,
) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Tie a pure function to the source it comes from.

    Args:
        source: key of sources.toml
        where: equation, table or section of the source
        valid: range of validity in words
        ranges: argument, or two of them as "a - b", "a * b" or "a / b" -> (low, high) in SI, checked by every run that
            uses the law; a range of an argument that a call leaves out does not count
        verified: False for a law without a golden row from print; reports list it as unverified
        regimes: argument with a range -> what reigns where it is left, in words; see `LawInfo`
    """
    limits = dict(ranges or {})

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        more = dict(regimes or {}), _formula(function)
        info = LawInfo(function.__name__, source, where, valid, limits, verified, *more)
        signature = inspect.signature(function)
        operands = {operand for name in limits for operand in name.split(" ")[::2]}
        if unknown := operands - signature.parameters.keys():
            raise TypeError(f"law {function.__name__}: ranges name unknown arguments {sorted(unknown)}")

        @functools.wraps(function)
        def called(*args: P.args, **kwargs: P.kwargs) -> R:
            uses = _uses.get()
            if uses is not None:
                bound = signature.bind(*args, **kwargs).arguments
                uses.append(LawUse(info, {name: _pick(name, bound) for name in limits if _has(name, bound)}))
            return function(*args, **kwargs)

        called.law = info  # type: ignore[attr-defined]
        return called

    return decorate


def _formula(function: Callable[..., Any]) -> str:
    """The formulas of a docstring in one line."""
    found = re.findall(r"^\.\. math::[ \n]*((?:.+\n?)+)", inspect.getdoc(function) or "", re.MULTILINE)
    return " ; ".join(" ".join(formula.split()) for formula in found)


def _has(name: str, bound: Mapping[str, Any]) -> bool:
    """Whether a call gives all arguments that a range names."""
    return all(operand in bound for operand in name.split(" ")[::2])


def _pick(name: str, bound: Mapping[str, Any]) -> Any:
    """What a range limits: an argument, or two of them joined."""
    first, *rest = name.split(" ")
    return _BETWEEN[rest[0]](bound[first], bound[rest[1]]) if rest else bound[first]


@functools.cache
def sources() -> Mapping[str, Source]:
    """All sources by key."""
    return {key: Source(key=key, **entry) for key, entry in tables("model", "sources.toml").items()}
