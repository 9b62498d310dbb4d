"""The errors of the project: each carries all problems found, each problem says where, what and what to do."""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Iterable
from types import TracebackType
from typing import TypeVar

T = TypeVar("T")

#: What acts on a screen, or no XML can hold, in a text: controls, marks of direction, odd ends of lines, halves.
_HIDDEN = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200b-\u200f\u2028-\u202e\u2060-\u2069\ud800-\udfff\ufeff\ufffe\uffff]"
)


def visible(text: str) -> str:
    """A text with all that cannot be seen in it written as escapes, such as \\x1b; tabs and ends of lines stay.

    Args:
        text: of a user
    """
    return _HIDDEN.sub(lambda found: ascii(found[0])[1:-1], text)


class GearheatError(Exception):
    """Base of every error a user can cause. `problems` holds one text per problem, at most three lines each."""

    def __init__(self, problems: str | Iterable[str]) -> None:
        self.problems = tuple(map(visible, (problems,) if isinstance(problems, str) else problems))
        super().__init__("\n".join(self.problems))


class ScenarioError(GearheatError):
    """A rig file, a catalogue entry or a value on the command line is wrong."""


class StructureError(GearheatError):
    """The parts and connections do not make a solvable system of equations."""


class SolveError(GearheatError):
    """A run found no solution."""


class FmuError(GearheatError):
    """An FMU cannot be made, read or run."""


class DataError(GearheatError):
    """A measured or scheduled table is wrong."""


class Problems(list[str]):
    """What is wrong with one thing, gathered so that a user is told all of it at once.

    An error within `with problems:` is taken note of, and the work goes on behind the block.
    """

    def __enter__(self) -> Problems:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None) -> bool:
        self += [p for p in error.problems if p not in self] if isinstance(error, GearheatError) else ()
        return isinstance(error, GearheatError)

    def of(self, step: Callable[[], T]) -> T | None:
        """What a step gives, None where it is refused.

        Args:
            step: that may be refused
        """
        with self:
            return step()
        return None

    def check(self, kind: type[GearheatError] = ScenarioError) -> None:
        """Raise an error of a class that carries all problems, if there are any."""
        if self:
            raise kind(self)


def suggestion(name: str, known: Iterable[str], key: Callable[[str], str] = str) -> str:
    """' Did you mean "x"?' for a misspelt name, or an empty text.

    Args:
        name: what was written
        known: all names that would be right
        key: what is compared of a name
    """
    named = {key(k): k for k in reversed([*known])}
    close = difflib.get_close_matches(key(name), [*named], n=3, cutoff=0.6)
    quoted = " or ".join(f'"{named[c]}"' for c in close)
    return f" Did you mean {quoted}?" if close else ""
