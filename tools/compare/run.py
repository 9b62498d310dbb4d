"""The main job: export the FMU, play all tests, compare with the readings, write a report."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...model.core.flat import FlatModel
from ...model.units import shown, to_si
from ...scenarios.given import RigLike, Settings
from ...scenarios.measured.readings import ROOM, column_of, drives, sources
from ...scenarios.measured.study import Measured, loaded, measured_of
from ...scenarios.scenario import Scenario
from ..describe import description as describe
from ..export.fmu import write_fmu
from ..show.console import as_json, folder, note, write
from ..show.display import Answer
from ..show.notes import unchecked_lines
from ..solve.losses import oils_of
from ..solve.settings import adjusted, flat_of
from ..solve.unchecked import unchecked
from . import campaign, summary
from .errors import Comparison, Rows, compare, present
from .report import Study, render
from .rivals import Score, rivals

#: First columns of a row, the rest follow in the order they arise.
ROW = ("point", "test", "direction", "oil", "T_oil_C", "T_wall_C", "T_amb_C", "loss_Nm", "P_loss_W", "efficiency")


@dataclass(frozen=True, eq=False, repr=False)
class CampaignRun(Answer):
    """Measured tests that were played through the FMU, beside their readings.

    Attributes:
        rows: one per reading
        comparison: errors by channel and group, None where nothing was measured
        scores: of statistical rivals
        found: the JSON object
    """

    rows: Rows
    comparison: Comparison | None
    scores: Sequence[Score]
    found: Mapping[str, Any]

    @property
    def title(self) -> str:
        """The rig and what is shown."""
        return f"{self.found['rig']}: {'errors' if self.comparison else 'operating point'}"

    def table(self) -> tuple[Sequence[str], Sequence[Sequence[Any]]]:
        """Errors with those of the rivals, or the one point there is."""
        if self.comparison is not None:
            return summary.error_lines(self.comparison, self.scores)
        return ("name", "value"), list(self.rows[0].items())

    def groups(self) -> tuple[Sequence[str], Sequence[Sequence[Any]]]:
        """Errors by group, simulated minus measured."""
        return summary.group_lines(self.comparison) if self.comparison is not None else ((), ())


def run(
    rig: RigLike,
    out: str | Path = "out",
    *,
    tests: str | None = None,
    step: str = "60 s",
    set: Settings = (),
    jobs: int = 0,
    extended: str | Path | None = None,
    data: str | Path | None = None,
    card: str | Path | None = None,
) -> CampaignRun:
    """The main job: export the FMU, play all measured tests, compare, write a report.

    Finished tests in the folder are used again.

    Args:
        rig: name, file or rig
        out: folder for results
        tests: only these, such as "1,13,22-26"
        step: communication step of the FMU
        set: values by name: texts with units, quantities of pint, or numbers in SI
        jobs: how many to run at once, 0 for one per core
        extended: rig file that a diagnosis wrote, which takes the rig's place
        data: measured table; the rig's own if None
        card: how that table was taken

    Raises:
        GearheatError: all that is wrong with what is asked

    Example:
        >>> import gearheat as gh
        >>> gh.run("planetary", "out")  # doctest: +SKIP
    """
    began, out = time.perf_counter(), Path(out)
    dt = to_si(step, "s", name="--step")
    with campaign.crew(jobs) as pool:
        scenario = adjusted(loaded(rig, extended), set)
        study = measured_of(scenario, data, card)
        scenario = study.scenario if study else scenario
        flat = flat_of(scenario)
        found = campaign.runs_of(scenario, flat, study, tests)
        kept = folder(folder(out) / "tests")  # not before the rig, the data and the options are found to be right
        fmu = write_fmu(scenario, flat, out / f"{scenario.name}.fmu")
        note(f"exported {fmu}")
        digest = hashlib.sha256(fmu.read_bytes()).hexdigest()
        record = campaign.recorded(scenario, flat, study)
        todo = campaign.jobs(found, fmu, digest, dt, record, kept)
        played = campaign.play_all(todo, pool)
    rows = [_ordered(row) for row in campaign.rows(scenario, study, found, played)]
    given = [column_of(s) for s in drives(study)] if study else []
    comparison, scores = (compare(rows), rivals(rows, given)) if present(rows) else (None, ())
    result = _result(scenario, fmu, digest, rows, comparison, scores)
    result["unchecked"] = unchecked(scenario, flat, oils_of(study))
    shown = _study(scenario, study, flat, found, played, rows, result, kept)
    write(out / "rows.csv", _csv(rows))
    write(out / "result.json", as_json(result))
    write(out / "report.html", render(shown, comparison, scores))
    note(f"{out / 'report.html'} after {time.perf_counter() - began:.1f} s")
    return CampaignRun(rows, comparison, scores, result)


def _ordered(row: Mapping[str, Any]) -> dict[str, Any]:
    return {name: row[name] for name in ROW if name in row} | dict(row)


def _result(
    scenario: Scenario,
    fmu: Path,
    digest: str,
    rows: Rows,
    comparison: Comparison | None,
    scores: Sequence[Score],
) -> dict[str, Any]:
    """The object of `--json`."""
    nothing: dict[str, Any] = {"rmse": {}, "noise_floor": {}, "rivals": {}, "groups": []}
    return {
        "schema": "gearheat.run/1",
        "rig": scenario.name,
        "fmu": fmu.name,
        "fmu_sha256": digest,
        "rows": rows,
        **(nothing if comparison is None else summary.as_dict(comparison, scores)),
        "energy_residual_max": max(row["energy_residual"] for row in rows),
    }


def _study(
    scenario: Scenario,
    study: Measured | None,
    flat: FlatModel,
    found: Sequence[campaign.Run],
    played: Mapping[int, list[dict[str, float]]],
    rows: Rows,
    result: Mapping[str, Any],
    kept: Path,
) -> Study:
    """What the report shows."""
    columns = _curves(scenario, study)
    curves = {test: _curve(kept / f"test-{test:02d}.csv", columns, flat) for test in _telling(rows)}
    single = [c for c in scenario.losses if c.startswith("P_") and c != "P_total_W"]
    return Study(
        rig=scenario.name,
        doc=scenario.doc,
        fmu=result["fmu"],
        rows=rows,
        curves=curves,
        loss_columns=tuple(single),
        laws=describe.cited(flat),
        outside=campaign.outside_of(flat, found, played),
        parameters=describe.parameters(scenario, flat),
        unchecked=tuple(unchecked_lines(result["unchecked"])),
        errata=tuple((e.place, e.says, e.should_be, e.evidence) for e in scenario.errata),
        energy_residual_max=result["energy_residual_max"],
    )


def _curves(scenario: Scenario, study: Measured | None) -> dict[str, str]:
    """Columns of the curves over time -> path: the temperatures, each once, and the room."""
    room = next((s.reads for s in study.rooms), None) if study else scenario.room
    found: dict[str, str] = {}
    for column, path in sources(scenario, study.warm if study else ()).items():
        found |= {} if path in found.values() else {column: path}
    return found | ({ROOM: room} if room else {})


def _telling(rows: Rows) -> list[int]:
    """Tests whose time series is drawn: the lightest and the heaviest of each of the first three oils."""
    chosen: list[int] = []
    for oil in list(dict.fromkeys(row["oil"] for row in rows))[:3]:
        mine = sorted((row for row in rows if row["oil"] == oil), key=_lost)
        chosen += [mine[0]["test"], mine[-1]["test"]]
    return list(dict.fromkeys(chosen))


def _lost(row: Mapping[str, Any]) -> float:
    """Loss power of a row; a rig without an efficiency, such as a closed loop, has only that of its losses table."""
    return float(row.get("P_loss_W", row.get("P_total_W", 0.0)))


def _curve(path: Path, columns: Mapping[str, str], flat: FlatModel) -> dict[str, np.ndarray]:
    """Time [s] and temperatures of one played test, read back from its file."""
    with path.open(encoding="utf-8") as file:
        head = file.readline().strip().split(",")
        values = np.loadtxt(file, delimiter=",", ndmin=2)
    names = {
        c: f"{p} [{shown(flat.quantity(p).unit)}]" for c, p in columns.items() if c.endswith("_C") and p in flat.index
    }
    return {"time": values[:, 0]} | {c: values[:, head.index(name)] for c, name in names.items() if name in head}


def _csv(rows: Rows) -> str:
    """Rows as CSV; numbers with nine digits, nothing where a value is missing."""
    head = list(dict.fromkeys(name for row in rows for name in row))

    def cell(value: Any) -> str:
        return "" if value is None else f"{value:.9g}" if isinstance(value, float) else str(value)

    return "\n".join([",".join(head), *(",".join(cell(row.get(name)) for name in head) for row in rows)]) + "\n"
