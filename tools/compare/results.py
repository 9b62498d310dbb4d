"""A table of simulated readings beside a measured one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...model.errors import DataError
from ...scenarios.given import RigLike
from ...scenarios.measured.study import loaded, measured_of
from ..show.console import note
from ..show.display import Answer
from . import summary
from .errors import Comparison
from .errors import compare as compare_rows
from .readings import column_of, drives, joined, read_result
from .rivals import Score, rivals


@dataclass(frozen=True, eq=False, repr=False)
class Errors(Answer):
    """Errors of simulated readings, with the noise floor and statistical rivals.

    Attributes:
        comparison: errors by channel and group, None where nothing was measured
        scores: of the rivals
        found: the JSON object
    """

    comparison: Comparison | None
    scores: Sequence[Score]
    found: Mapping[str, Any]

    @property
    def title(self) -> str:
        """What is compared."""
        return f"{self.found['result']} beside {self.found['data']}"

    def table(self) -> tuple[Sequence[str], Sequence[Sequence[Any]]]:
        """Errors with those of the rivals, or the one point there is."""
        if self.comparison is not None:
            return summary.error_lines(self.comparison, self.scores)
        return ("name", "value"), list(self.found["rows"][0].items())

    def groups(self) -> tuple[Sequence[str], Sequence[Sequence[Any]]]:
        """Errors by group, simulated minus measured."""
        return summary.group_lines(self.comparison) if self.comparison is not None else ((), ())


def compare(result: str | Path, data: str | Path, rig: RigLike, *, card: str | Path | None = None) -> Errors:
    """Errors of simulated readings by group, with the noise floor and statistical rivals.

    Args:
        result: simulated readings, CSV with test and direction, or point
        data: measured readings, CSV
        rig: that was measured: name, file or rig
        card: how that table was taken

    Raises:
        DataError: everything wrong with the tables; they have no reading in common

    Example:
        >>> import gearheat as gh
        >>> gh.compare("out/rows.csv", "measured.csv", "planetary")  # doctest: +SKIP
    """
    study = measured_of(loaded(rig), data, card)
    assert study is not None  # there is a table
    rows = joined(read_result(Path(result), study), study)
    for warning in study.campaign.warnings:
        note(f"warning: {warning}")
    if not rows:
        raise DataError(f"{Path(result).name} and {study.campaign.name} have no reading in common.")
    comparison, scores = compare_rows(rows), rivals(rows, [column_of(s) for s in drives(study)])
    found = {"schema": "gearheat.compare/1", "result": Path(result).name, "data": study.campaign.name, "rows": rows}
    return Errors(comparison, scores, {**found, **summary.as_dict(comparison, scores)})
