"""What pages tell of the laws: blocks that become equations, ranges or the origins of golden rows.

| block | what it becomes |
|---|---|
| `{laws} MODULE, ...` | the equations of all laws of these modules |
| `{ranges}` | every range that a law declares |
| `{evidence}` | by module, how many laws were compared with print, and how many rows are from print |
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import re
from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any

from ...model import laws
from ...model.sources import LawInfo
from ...scenarios.published import golden_rows
from .markdown import code, docstring, list_arguments, table, words

BLOCK = re.compile(r"^```\{(laws|ranges|evidence)\} *(.*)\n```$", re.MULTILINE)

Law = Callable[..., Any]


def fill_blocks(text: str) -> str:
    """A page with what its blocks ask for."""
    return BLOCK.sub(_block, text)


def law_modules() -> list[str]:
    """Names of the modules of laws, those without a law left out."""
    return [module.name for module in pkgutil.iter_modules(laws.__path__) if list(laws_of(module.name))]


def laws_of(module: str) -> Iterator[Law]:
    """The laws of a module in the order of its file.

    Args:
        module: its name in `model.laws`
    """
    found = importlib.import_module(f"{laws.__name__}.{module}")
    yield from (f for f in vars(found).values() if hasattr(f, "law") and f.__module__ == found.__name__)


def title(module: str) -> str:
    """What a module is about: its first sentence, or what stands before its colon."""
    about = words(inspect.getdoc(importlib.import_module(f"{laws.__name__}.{module}")))
    return re.split(r"\.(?: |$)|: ", about, maxsplit=1)[0]


def facts(law: LawInfo, rows: int) -> dict[str, str]:
    """Source, validity, ranges and comparisons of a law, by what they are.

    Args:
        law: the law
        rows: number of its golden rows
    """
    compared = f"{rows} golden rows{'' if law.verified else ', none of them from print'}" if rows else "with no row"
    ranges = "; ".join(f"{name} from {low:.4g} to {high:.4g}" for name, (low, high) in law.ranges.items())
    return {"Source": f"{law.source}, {law.where}", "Valid": law.valid, "Range, in SI": ranges, "Compared": compared}


def info(law: Law) -> LawInfo:
    """What a law declares."""
    return law.law  # type: ignore[attr-defined, no-any-return]


def _block(match: re.Match[str]) -> str:
    kind, asked = match.groups()
    if kind == "ranges":
        return _ranges()
    if kind == "evidence":
        return _evidence()
    rows = Counter(row.law for row in golden_rows())
    modules = asked.split(", ")
    return "".join(_equation(name, law, rows[f"{name}.{law.__name__}"]) for name in modules for law in laws_of(name))


def _link(module: str, law: Law) -> str:
    return f"[{law.__name__}](../generated/laws/{module}.md#{law.__name__.replace('_', '-')})"


def _equation(module: str, law: Law, rows: int) -> str:
    physics = {p.name for p in inspect.signature(law).parameters.values() if p.kind == p.POSITIONAL_OR_KEYWORD}
    symbols = "; ".join(f"`{key}` {words(text)}" for key, text in list_arguments(law) if key in physics)
    about = ". ".join(f"{key}: {words(value)}" for key, value in facts(info(law), rows).items() if value)
    return f"**{_link(module, law)}**: {docstring(law)}{symbols}\n\n*{about}.*\n\n"


def _ranges() -> str:
    rows = [
        (_link(module, law), code(name), f"{low:.4g}", f"{high:.4g}", words(info(law).regimes.get(name, "")))
        for module in law_modules()
        for law in laws_of(module)
        for name, (low, high) in info(law).ranges.items()
    ]
    return table(("law", "argument", "from", "to", "beyond"), rows)


def _evidence() -> str:
    kinds = Counter((row.law, row.recomputed is None) for row in golden_rows())
    rows = []
    for module in law_modules():
        found = list(laws_of(module))
        counts = (sum(kinds[f"{module}.{law.__name__}", printed] for law in found) for printed in (True, False))
        compared = sum(info(law).verified for law in found)
        rows.append((f"[{title(module)}](../generated/laws/{module}.md)", *map(str, (len(found), compared, *counts))))
    return table(("laws on", "laws", "with print", "rows from print", "recomputed rows"), rows)
