"""A table of simulated readings beside a measured one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from ...model.errors import DataError
from ...scenarios.given import RigLike
from ...scenarios.measured.readings import column_of, drives, join_readings, read_result
from ...scenarios.measured.study import load_rig, read_study
from ..show.console import note
from ..show.display import Answer, Table
from .errors import GROUPINGS, Comparison, Score, compare as compare_rows, rivals

#: Name of the line below those of the simulation, above those of the rivals.
NOISE = "noise floor"


@dataclass(frozen=True, eq=False, repr=False)
class Errors(Answer):
    """Errors of simulated readings, with the noise floor and statistical rivals.

    Attributes:
        comparison: errors by channel and group, None where nothing was measured
        scores: of the rivals
    """

    comparison: Comparison | None
    scores: Sequence[Score]

    def table(self) -> Table:
        """Errors with those of the rivals, or the one point there is."""
        if self.comparison is not None:
            return error_lines(self.comparison, self.scores)
        return ("name", "value"), list(self.found["rows"][0].items())

    def groups(self) -> Table:
        """Errors by group, simulated minus measured."""
        return group_lines(self.comparison) if self.comparison is not None else ((), ())


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
    study = read_study(load_rig(rig), data, card)
    assert study is not None  # there is a table
    rows = join_readings(read_result(Path(result), study), study)
    for warning in study.campaign.warnings:
        note(f"warning: {warning}")
    if not rows:
        raise DataError(f"{Path(result).name} and {study.campaign.name} have no reading in common.")
    comparison, scores = compare_rows(rows), rivals(rows, [column_of(s) for s in drives(study)])
    found = {"schema": "gearheat.compare/1", "result": Path(result).name, "data": study.campaign.name, "rows": rows}
    heading = f"{found['result']} beside {found['data']}"
    return Errors({**found, **summarise(comparison, scores)}, comparison, scores, heading=heading)


def summarise(comparison: Comparison, scores: Sequence[Score]) -> dict[str, Any]:
    """Keys `rmse`, `noise_floor`, `rivals`, `groups`."""
    return {
        "rmse": comparison.rmse(),
        "noise_floor": dict(comparison.noise_floor),
        "rivals": {score.name: {k: v for k, v in asdict(score).items() if k != "name"} for score in scores},
        "groups": [asdict(group) for group in comparison.groups],
    }


def hundredths(value: float | None) -> str:
    """An error as a table shows it."""
    return "" if value is None else f"{value:.2f}"


def error_lines(comparison: Comparison, scores: Sequence[Score]) -> tuple[list[str], list[list[Any]]]:
    """Head and body: channels across; simulation overall and by grid, noise floor and rivals down."""
    rmse = comparison.rmse()
    channels = comparison.channels

    def line(name: str, values: Any) -> list[Any]:
        return [name, *(hundredths(values.get(c.key)) for c in channels)]

    body = [line("simulation, all readings", rmse["overall"])]
    body += [line(f"simulation, {grid}", found) for grid, found in rmse.items() if grid != "overall"]
    body.append(line(NOISE, comparison.noise_floor))
    for score in scores:
        body.append(line(f"{score.name}, in sample", score.in_sample))
        body.append(line(f"{score.name}, left-out tests", score.leave_one_test_out))
    return ["root mean square", *(f"{c.label} [{c.unit}]" for c in channels)], body


def group_lines(comparison: Comparison) -> tuple[list[str], list[list[Any]]]:
    """Head and body: groups down, mean and root mean square of each channel across."""
    channels = comparison.channels
    found: dict[tuple[str, Any], dict[str, Any]] = {}
    for group in comparison.groups:
        found.setdefault((group.by, group.value), {"n": group.n})[group.channel] = group
    body = []
    for (by, value), of in found.items():
        pairs = [(of[c.key].mean, of[c.key].rms) if c.key in of else (None, None) for c in channels]
        text = f"{value:g}" if isinstance(value, float) else value
        body.append(
            [
                "all" if by == "all" else f"{GROUPINGS[by]} {text}",
                of["n"],
                *(hundredths(x) for pair in pairs for x in pair),
            ]
        )
    return ["group", "readings", *(f"{c.short} {what} [{c.unit}]" for c in channels for what in ("mean", "rms"))], body
