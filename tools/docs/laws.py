"""The laws on one page: the blocks `{laws} MODULE, ...` of a page become the equations of these modules."""

from __future__ import annotations

import importlib
import inspect
import re
from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any

from ...model import laws
from ...model.sources import LawInfo
from ...scenarios.golden import golden_rows
from .markdown import docstring, told_arguments, words

BLOCK = re.compile(r"^```\{laws\} (.*)\n```$", re.MULTILINE)


def filled(text: str) -> str:
    """A page with the equations of the laws that its blocks name."""
    rows = Counter(row.law for row in golden_rows()) if BLOCK.search(text) else Counter()
    return BLOCK.sub(lambda match: "".join(_equations(name, rows) for name in match[1].split(", ")), text)


def laws_of(module: str) -> Iterator[Callable[..., Any]]:
    """The laws of a module in the order of its file.

    Args:
        module: its name in `model.laws`
    """
    found = importlib.import_module(f"{laws.__name__}.{module}")
    yield from (f for f in vars(found).values() if hasattr(f, "law") and inspect.getmodule(f) is found)


def facts(law: LawInfo, rows: int) -> dict[str, str]:
    """Source, validity, ranges and comparisons of a law, by what they are.

    Args:
        law: the law
        rows: number of its golden rows
    """
    compared = f"golden rows {rows}{'' if law.verified else ', none from print'}" if rows else "with no row"
    ranges = "; ".join(f"{name} from {low:.4g} to {high:.4g}" for name, (low, high) in law.ranges.items())
    return {"Source": f"{law.source}, {law.where}", "Valid": law.valid, "Range, in SI": ranges, "Compared": compared}


def _equations(module: str, rows: Counter[str]) -> str:
    return "".join(_equation(module, f, rows[f"{module}.{f.__name__}"]) for f in laws_of(module))


def _equation(module: str, function: Callable[..., Any], rows: int) -> str:
    name = function.__name__
    law: LawInfo = function.law  # type: ignore[attr-defined]
    physics = {p.name for p in inspect.signature(function).parameters.values() if p.kind == p.POSITIONAL_OR_KEYWORD}
    symbols = "; ".join(f"`{key}` {words(text)}" for key, text in told_arguments(function) if key in physics)
    about = ". ".join(f"{key}: {words(value)}" for key, value in facts(law, rows).items() if value)
    link = f"../generated/laws/{module}.md#{name.replace('_', '-')}"
    return f"**[{name}]({link})**: {docstring(function)}{symbols}\n\n*{about}.*\n\n"
