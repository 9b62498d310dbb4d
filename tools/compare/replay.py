"""The command `replay`: how well a rig predicts logs without correction, beside plain rivals fitted on one of them."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...model.errors import DataError
from ...scenarios.load import load
from ...scenarios.measured.card import read_card
from ...scenarios.measured.logs import Log, read_log
from ..diagnose.infer.logs import filter_of, year_of
from ..diagnose.infer.replay import HOURS, Replayed, Rivals, replay
from ..show.console import answer, note, table, writable, write

#: Width and height of the picture [inch], and its longest stretch [samples].
SIZE, LONGEST = (9.0, 4.5), 1000


def command(
    rig: str, fit: Path, until: int | None, logs: Sequence[Path], card: Path | None, out: Path | None, json: str | None
) -> None:
    """Replay logs.

    Args:
        rig: name or file, whose parameters are used as they are
        fit: log on which the rivals are fitted; it is replayed as well
        until: first year of that log which the rivals do not see; all of it without
        logs: further logs
        card: how the logs are written
        out: picture of the longest stretch of the last log, .svg or .png
        json: where the result goes as JSON
    """
    writable(out)
    scenario, known = load(rig), read_card(card)
    first = read_log(fit, scenario, known)
    own, _ = filter_of(scenario, first)
    pieces = _split(first, until)
    rivals = Rivals(pieces[0], own.given, own.read)
    others = [read_log(path, scenario, known) for path in logs]
    found = []
    for log in (*pieces, *others):
        note(f"{log.name}: {log.n} samples")
        found.append(replay(own, log, rivals))
    if out is not None:
        write(out, _picture(found[-1], out.suffix.removeprefix(".")))
    answer({"hours": HOURS, "logs": [_plain(r) for r in found]}, json, lambda: _show(found))


def _split(log: Log, until: int | None) -> list[Log]:
    """The log before and from a year on."""
    if until is None:
        return [log]
    years = year_of(log.time, log.dated)
    if not (years < until).any():
        raise DataError([f"{log.name}: has no samples before {until}. Give a later year as --until."])
    parts = [(years < until, f"{log.name} before {until}"), (years >= until, f"{log.name} from {until}")]
    return [log.rows(keep, name) for keep, name in parts if keep.any()]


def _plain(r: Replayed) -> dict[str, Any]:
    return {"log": r.name, "rows": r.rows, "free_K": r.free, "ahead_K": r.ahead}


def _show(found: Sequence[Replayed]) -> None:
    sensors = list(next(iter(found[0].free.values())))
    sensor = sensors[0]
    for r in found:
        rows = [[m, *(f"{e[s]:.2f}" for s in sensors)] for m, e in r.free.items()]
        table(f"{r.name}, free run from the first sample of each stretch: RMSE [K]", ["method", *sensors], rows)
        rows = [[m, *(f"{v:.2f}" for v in e[sensor])] for m, e in r.ahead.items()]
        table(f"{r.name}, {sensor}: RMSE [K] by hours ahead", ["method", *(f"{h:g} h" for h in HOURS)], rows)


def _picture(r: Replayed, kind: str) -> bytes:
    """Free run and readings of one stretch."""
    from matplotlib.figure import Figure

    figure = Figure(SIZE, layout="constrained")
    panels = np.ravel(figure.subplots(len(r.shown), 1, sharex=True))
    days = (r.time - r.time[0])[:LONGEST] / 86400
    for panel, (name, (model, read)) in zip(panels, r.shown.items(), strict=True):
        panel.plot(days, read[:LONGEST] - 273.15, color="0.6", lw=0.8, label="measured")
        panel.plot(days, model[:LONGEST] - 273.15, color="C0", lw=0.8, label="free run of the rig")
        panel.set_ylabel(f"{name} [degC]", fontsize=7)
        panel.tick_params(labelsize=7)
    panels[0].legend(fontsize=7, ncols=2)
    panels[0].set_title(f"{r.name}, free run", fontsize=8)
    panels[-1].set_xlabel("days", fontsize=7)
    file = io.BytesIO()
    figure.savefig(file, format=kind or "png", dpi=80, metadata={"Date": None} if kind == "svg" else None)
    return file.getvalue()
