"""How well a rig predicts logs without correction, beside plain rivals fitted on one of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...model.errors import DataError
from ...model.units import from_si
from ...scenarios.given import RigLike, scenario_of
from ...scenarios.measured.card import read_card
from ...scenarios.measured.logs import Log, read_log
from ..diagnose.infer.logs import filter_of, season_of
from ..diagnose.infer.replay import HOURS, Replayed, Rivals, replay as replay_log
from ..show.console import note
from ..show.display import Display
from ..show.picture import Picture

#: Width and height of the picture [inch].
SIZE = (9.0, 4.5)
#: Longest stretch of the picture [samples].
LONGEST = 1000


@dataclass(frozen=True, eq=False, repr=False)
class Replays(Display):
    """How well a rig predicts logs without correction, beside plain rivals.

    Attributes:
        logs: errors of each log
    """

    logs: tuple[Replayed, ...]

    @property
    def title(self) -> str:
        """The logs."""
        return f"{', '.join(log.name for log in self.logs)}: free runs, RMSE [K]"

    def table(self) -> tuple[Sequence[str], Sequence[Sequence[Any]]]:
        """Errors of free runs, a row for each log and method."""
        sensors = list(next(iter(self.logs[0].free.values())))
        rows = [(r.name, method, *(e[s] for s in sensors)) for r in self.logs for method, e in r.free.items()]
        return ("log", "method", *sensors), rows

    def as_dict(self) -> dict[str, Any]:
        """Errors of free runs and by hours ahead."""
        logs = [{"log": r.name, "rows": r.rows, "free_K": r.free, "ahead_K": r.ahead} for r in self.logs]
        return {"hours": HOURS, "logs": logs}

    def drawing(self) -> Picture:
        """Free run and readings of the longest stretch of the last log."""
        from ..show.drawing import empty

        r = self.logs[-1]
        title = f"{r.name}, free run"
        figure, panels = empty(*SIZE, len(r.shown), 1, sharex=True)
        days = (r.time - r.time[0])[:LONGEST] / 86400
        for panel, (name, (model, read)) in zip(panels, r.shown.items(), strict=True):
            panel.plot(days, from_si(read[:LONGEST], "K"), color="0.6", lw=0.8, label="measured")
            panel.plot(days, from_si(model[:LONGEST], "K"), color="C0", lw=0.8, label="free run of the rig")
            panel.set_ylabel(f"{name} [degC]", fontsize=7)
            panel.tick_params(labelsize=7)
        panels[0].legend(fontsize=7, ncols=2)
        panels[0].set_title(title, fontsize=8)
        panels[-1].set_xlabel("days", fontsize=7)
        return Picture(figure, title)


def replay(
    rig: RigLike,
    fit: str | Path,
    *,
    until: int | None = None,
    logs: Sequence[str | Path] = (),
    card: str | Path | None = None,
) -> Replays:
    """How well a rig predicts logs without correction, beside a one-node model, a regression and the last reading.

    Args:
        rig: name, file or rig, whose parameters are used as they are
        fit: log on which the rivals are fitted; it is replayed as well
        until: first year of that log which the rivals do not see; all of it without
        logs: further logs
        card: how the logs are written

    Raises:
        GearheatError: all that is wrong with the files

    Example:
        >>> import gearheat as gh
        >>> gh.replay("wind_turbine", "log.csv", until=2016)  # doctest: +SKIP
    """
    scenario, known = scenario_of(rig), read_card(None if card is None else Path(card))
    first = read_log(Path(fit), scenario, known)
    own, _ = filter_of(scenario, first)
    pieces = _split_log(first, until)
    rivals = Rivals(pieces[0], own.given, own.read)
    others = [read_log(Path(path), scenario, known) for path in logs]
    found = []
    for log in (*pieces, *others):
        note(f"{log.name}: {log.n} samples")
        found.append(replay_log(own, log, rivals))
    return Replays(tuple(found))


def _split_log(log: Log, until: int | None) -> list[Log]:
    """The log before and from a year on."""
    if until is None:
        return [log]
    years = season_of(log.time, log.dated) // 4
    if not (years < until).any():
        raise DataError([f"{log.name}: has no samples before {until}. Give a later year as --until."])
    parts = [(years < until, f"{log.name} before {until}"), (years >= until, f"{log.name} from {until}")]
    return [log.rows(keep, name) for keep, name in parts if keep.any()]
