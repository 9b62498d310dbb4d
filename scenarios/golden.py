"""Golden rows of laws as published numbers: a law of the model against a number from print.

A row of `model/golden/*.toml` has `law` ("module.function"), `args` (numbers in SI, or text with a unit), `expect`
with `unit`, and `tol` in that unit or `rel`. `kind` says what the number is: "published" as the source prints it,
"corrected" by an erratum (`published` and `why` then say what stands in print and why it cannot), "reproduced" a
recomputation that no one printed, "misprint" what a misprint of the source leads to. `item` picks from a law with
several results.
"""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path
from typing import Any, Literal

from pydantic import Field

from ..model.errors import Problems
from .document import read_toml
from .published import Number, Row
from .tables import Strict

GOLDEN = Path(str(files("gearheat.model").joinpath("golden")))


class GoldenRow(Strict):
    """One golden row of a law."""

    name: str = Field(description="what the number is, in words")
    law: str = Field(description='"module.function" of a law')
    source: str = Field(description="where the number is from")
    kind: Literal["published", "corrected", "reproduced", "misprint"] = Field(description="what the number is")
    args: dict[str, Any] = Field(description="argument -> number in SI, or text with a unit")
    item: int | None = Field(None, description="which of several results, from 0")
    expect: float = Field(description="the number")
    unit: str = Field("", description="its unit")
    tol: float | None = Field(None, description="distance allowed")
    rel: float | None = Field(None, description="distance allowed over the number")
    published: Number | None = Field(None, description="what stands in print where that was corrected")
    why: str = Field("", description="why the printed number does not stand")

    def as_row(self) -> Row:
        """The row in the form of all published numbers."""
        given = self.kind if self.kind in ("published", "corrected") else "recomputed"
        return Row.model_validate(
            {
                **self.model_dump(include={"name", "published", "why", "tol", "rel", "law", "args", "item"}),
                "where": self.source,
                given: self.expect,
                "unit": "" if self.unit == "1" else self.unit,
                "run": "law",
            }
        )


class GoldenTable(Strict):
    """A file of golden rows."""

    row: list[GoldenRow] = Field([], description="one table [[row]] a number")


def golden_rows() -> tuple[Row, ...]:
    """The golden rows of all laws.

    Raises:
        ScenarioError: everything wrong with the files at once
    """
    found: list[Row] = []
    problems = Problems()
    for path in sorted(GOLDEN.glob("*.toml")):
        raw = {"row": [row for row in read_toml(path).get("row", []) if "law" in row]}
        with problems:
            found += [row.as_row() for row in GoldenTable.read(path.name, raw).row]
    problems.check()
    return tuple(found)
