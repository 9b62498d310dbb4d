"""Golden rows of laws as published numbers: a law of the model against a number from print.

A row of `model/golden/*.toml` has `law` ("module.function"), `args` (numbers in SI, or text with a unit), `expect`
with `unit`, and `tol` in that unit or `rel`. `kind` says what the number is: "published" as the source prints it,
"corrected" by an erratum (`published` and `why` then say what stands in print and why it cannot), "reproduced" a
recomputation that no one printed, "misprint" what a misprint of the source leads to. `item` picks from a law with
several results.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

from ..model.errors import Problems
from .document import read_toml
from .published import PublishedTable, Row

GOLDEN = Path(str(files("gearheat.model").joinpath("golden")))


def golden_rows() -> tuple[Row, ...]:
    """The golden rows of all laws.

    Raises:
        ScenarioError: everything wrong with the files at once
    """
    found: list[Row] = []
    problems = Problems()
    for path in sorted(GOLDEN.glob("*.toml")):
        raw = [_published(row) for row in read_toml(path).get("row", []) if "law" in row]
        with problems:
            found += PublishedTable.read(path.name, {"row": raw}).row
    problems.check()
    return tuple(found)


def _published(row: Mapping[str, Any]) -> dict[str, Any]:
    """A golden row in the form of all published numbers."""
    kind = row["kind"] if row["kind"] in ("published", "corrected") else "recomputed"
    names = {"source": "where", "expect": kind}
    kept = {names.get(key, key): value for key, value in row.items() if key not in ("kind", "unit")}
    return kept | {"run": "law", "unit": row.get("unit", "").removesuffix("1")}
