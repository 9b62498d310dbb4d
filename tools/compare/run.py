"""The main job: export the FMU, play all tests, compare with the readings, write a report."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any, cast

import numpy as np

from ...model.core.flat import FlatModel
from ...model.units import show_unit, to_si
from ...scenarios.given import RigLike, Settings
from ...scenarios.measured.readings import ROOM, column_of, drives, sources
from ...scenarios.measured.study import Measured, load_rig, read_study
from ...scenarios.scenario import Scenario
from ..describe.description import show
from ..export.fmu import write_fmu
from ..show.columns import rows_text
from ..show.console import as_json, folder, note, write
from ..solve.losses import oils_of
from ..solve.settings import adjust, find_unchecked, flat_of
from . import campaign
from .errors import Rows, compare, present, rivals
from .playing import Job
from .report import render
from .results import Errors, summarise

#: First columns of a row, the rest follow in the order they arise.
ROW = ("point", "test", "direction", "oil", "T_oil_C", "T_wall_C", "T_amb_C", "loss_Nm", "P_loss_W", "efficiency")


class CampaignRun(Errors):
    """Measured tests that were played through the FMU, beside their readings."""

    @property
    def rows(self) -> Rows:
        """One per reading."""
        return cast(Rows, self.found["rows"])


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
        scenario = adjust(load_rig(rig, extended), set)
        study = read_study(scenario, data, card)
        scenario = study.scenario if study else scenario
        flat = flat_of(scenario)
        found = campaign.runs_of(scenario, flat, study, tests)
        kept = folder(folder(out) / "tests")  # not before the rig, the data and the options are found to be right
        fmu = write_fmu(scenario, flat, out / f"{scenario.name}.fmu")
        note(f"exported {fmu}")
        digest = hashlib.sha256(fmu.read_bytes()).hexdigest()
        record = campaign.list_kept(scenario, flat, study)
        todo = [Job(one, fmu, digest, dt, record, kept) for one in found]
        played = campaign.play_all(todo, pool)
    rows = campaign.rows(scenario, study, found, played)
    rows = [{name: row[name] for name in ROW if name in row} | row for row in rows]
    given = [column_of(s) for s in drives(study)] if study else []
    comparison, scores = (compare(rows), rivals(rows, given)) if present(rows) else (None, ())
    nothing: dict[str, Any] = {"rmse": {}, "noise_floor": {}, "rivals": {}, "groups": []}
    result = {
        "schema": "gearheat.run/1",
        "rig": scenario.name,
        "fmu": fmu.name,
        "fmu_sha256": digest,
        "rows": rows,
        **(nothing if comparison is None else summarise(comparison, scores)),
        "energy_residual_max": max(row["energy_residual"] for row in rows),
        "unchecked": find_unchecked(scenario, flat, oils_of(study)),
    }
    columns = _curves(scenario, study)
    curves = {test: _curve(kept / f"test-{test:02d}.csv", columns, flat) for test in _telling(rows)}
    outside = campaign.outside_of(flat, found, played)
    head = list(dict.fromkeys(name for row in rows for name in row))
    write(out / "rows.csv", rows_text(head, ([row.get(name) for name in head] for row in rows)))
    write(out / "result.json", as_json(result))
    machine = show(scenario).drawing()
    told = render(scenario, flat, result, comparison, scores, curves=curves, outside=outside, machine=machine)
    write(out / "report.html", told)
    note(f"{out / 'report.html'} after {time.perf_counter() - began:.1f} s")
    heading = f"{scenario.name}: {'errors' if comparison else 'operating point'}"
    return CampaignRun(result, comparison, scores, heading=heading)


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
        mine = sorted((row for row in rows if row["oil"] == oil), key=_find_loss)
        chosen += [mine[0]["test"], mine[-1]["test"]]
    return list(dict.fromkeys(chosen))


def _find_loss(row: Mapping[str, Any]) -> float:
    """Loss power of a row; a rig without an efficiency, such as a closed loop, has only that of its losses table."""
    return float(row.get("P_loss_W", row.get("P_total_W", 0.0)))


def _curve(path: Path, columns: Mapping[str, str], flat: FlatModel) -> dict[str, np.ndarray]:
    """Time [s] and temperatures of one played test, read back from its file."""
    with path.open(encoding="utf-8") as file:
        head = file.readline().strip().split(",")
        values = np.loadtxt(file, delimiter=",", ndmin=2)
    names = {
        c: f"{p} [{show_unit(flat.quantity(p).unit)}]"
        for c, p in columns.items()
        if c.endswith("_C") and p in flat.index
    }
    return {"time": values[:, 0]} | {c: values[:, head.index(name)] for c, name in names.items() if name in head}
