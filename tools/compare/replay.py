"""How well a rig predicts logs without correction, beside plain rivals fitted on one: free-running, by hours ahead."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.signal import lfilter

from ...model.errors import DataError
from ...model.units import from_si
from ...scenarios.frames import Table, Tables, path_of, paths_of, rows_told
from ...scenarios.given import RigLike, scenario_of
from ...scenarios.measured.card import read_card
from ...scenarios.measured.logs import Log, read_log
from ...scenarios.measured.sensors import SI
from ..diagnose.infer.logs import filter_of, season_of
from ..diagnose.model.logs import Filter
from ..diagnose.model.windows import Windows, windows
from ..show.console import note
from ..show.display import Display
from ..show.picture import Picture

#: Width and height of the picture [inch].
SIZE = (9.0, 4.5)
#: Longest stretch of the picture [samples].
LONGEST = 1000
#: Hours ahead at which errors are told, and lags of the regression [samples].
HOURS = (1.0, 3.0, 6.0, 12.0, 24.0)
LAGS = (0, 1, 2, 4, 8, 16, 32, 64, 128)
#: Samples in which the filter settles before a prediction.
BEFORE = 100
#: Logits of the decay of a node from sample to sample: time constants of half a sample to 160 000.
LOGITS = (-2.0, 12.0)
#: Stretches that the rig runs through at a time, few as each is copied.
SIDE = 16


@dataclass(frozen=True)
class Replayed:
    """Errors of one log: root mean squares by method and sensor, in SI.

    Args:
        name: of the log
        rows: number of samples
        free: method -> sensor -> error without any correction from the first sample of each stretch
        ahead: method -> sensor -> error at each of `HOURS` for which a stretch is long enough
        units: sensor -> SI unit
        shown: free run of the rig and readings of the longest stretch, thermometer -> (2, n)
        time: of that stretch [s] (n,)
    """

    name: str
    rows: int
    free: Mapping[str, Mapping[str, float]]
    ahead: Mapping[str, Mapping[str, tuple[float, ...]]]
    units: Mapping[str, str]
    shown: Mapping[str, np.ndarray]
    time: np.ndarray


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
        return f"{', '.join(log.name for log in self.logs)}: free runs, RMSE"

    def table(self) -> tuple[Sequence[str], Sequence[Sequence[Any]]]:
        """Errors of free runs, a row for each log and method."""
        units = self.logs[0].units
        rows = [(r.name, method, *(e[s] for s in units)) for r in self.logs for method, e in r.free.items()]
        return ("log", "method", *(f"{s} [{unit}]" for s, unit in units.items())), rows

    def as_dict(self) -> dict[str, Any]:
        """Errors of free runs and by hours ahead."""
        logs = [{"log": r.name, "rows": r.rows, "free_K": r.free, "ahead_K": r.ahead} for r in self.logs]
        return {"hours": HOURS, "logs": logs}

    def drawing(self) -> Picture | None:
        """Free run and readings of the longest stretch of the last log; None without a thermometer."""
        from ..show.drawing import empty

        if not (r := self.logs[-1]).shown:
            return None
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


@rows_told()
def replay(
    rig: RigLike,
    fit: Table,
    *,
    until: int | None = None,
    logs: Tables = (),
    card: str | Path | None = None,
) -> Replays:
    """How well a rig predicts logs without correction, beside a one-node model, a regression and the last reading.

    Args:
        rig: name, file or rig, whose parameters are used as they are
        fit: log, file or DataFrame, on which the rivals are fitted; it is replayed as well
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
    first = read_log(path_of(fit, name="--fit"), scenario, known)
    own = filter_of(scenario, first)
    pieces = _split_log(first, until)
    rivals = Rivals(pieces[0], own.given, own.read)
    others = [read_log(path, scenario, known) for path in paths_of(logs)]
    found = []
    for log in (*pieces, *others):
        note(f"{log.name}: {log.n} samples")
        found.append(_replay_log(own, log, rivals))
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


class Rivals:
    """A one-node model and a linear regression on present and past inputs, for each sensor.

    Args:
        fitted: log on which they are fitted
        given, read: names of the sensors
    """

    def __init__(self, fitted: Log, given: Sequence[str], read: Sequence[str]) -> None:
        data = windows([fitted], given, read, 0)
        self.scale = np.maximum(np.abs(data.given[data.there]).max(axis=0), 1e-9)
        self.node = [self._node(data, j) for j in range(len(read))]
        self.regression = self._regress(data)

    def _regress(self, data: Windows) -> np.ndarray:
        """Coefficients of regressions of all sensors on inputs now and before (terms, reads), window by window."""
        reads = range(data.read.shape[2])
        A: list[Any] = [0.0 for _ in reads]
        b: list[Any] = [0.0 for _ in reads]
        for u, y, n in zip(data.given, data.read, _lengths(data), strict=True):
            X = _lagged(u[:n] / self.scale)
            for j in reads:
                known = np.isfinite(y[:n, j])
                A[j], b[j] = A[j] + X[known].T @ X[known], b[j] + X[known].T @ y[:n, j][known]
        ridges = [1e-6 * np.trace(own) / len(own) * np.eye(len(own)) for own in A]
        return np.column_stack([np.linalg.solve(A[j] + ridges[j], b[j]) for j in reads])

    def _node(self, data: Windows, j: int) -> np.ndarray:
        """Decay [logit] and gains of a first-order model of sensor j, by least squares of its free run."""
        pieces = [
            (np.column_stack([u[:n] / self.scale, np.ones(n)]), y[:n, j])
            for u, y, n in zip(data.given, data.read, _lengths(data), strict=True)
        ]

        def fit(logit: float) -> tuple[np.ndarray, float]:
            """The best gains for a decay, and the sum of squares that they leave."""
            decay, A = 1 / (1 + np.exp(-logit)), np.zeros((len(self.scale) + 2, len(self.scale) + 2))
            for u, y in pieces:
                left = y[::3] - y[0] * decay ** np.arange(1, len(y) + 1, 3)
                terms = np.column_stack([lfilter([1.0], [1.0, -decay], u, axis=0)[::3], left])[np.isfinite(left)]
                A += terms.T @ terms
            gains = np.linalg.lstsq(A[:-1, :-1], A[:-1, -1])[0]
            return gains, A[-1, -1] - gains @ A[:-1, -1]

        best = minimize_scalar(lambda logit: fit(logit)[1], bounds=LOGITS, method="bounded").x
        return np.array([best, *fit(best)[0]])

    def one_node(self, x: np.ndarray, u: np.ndarray, start: float) -> np.ndarray:
        """Free run (n,) from a start."""
        decay = 1 / (1 + np.exp(-x[0]))
        drive = u @ (x[1:-1] / self.scale) + x[-1]
        found, _ = lfilter([1.0], [1.0, -decay], drive, zi=[decay * start])
        return np.asarray(found)

    def regressed(self, u: np.ndarray) -> np.ndarray:
        """Predictions of all sensors (n, reads)."""
        return np.asarray(_lagged(u / self.scale) @ self.regression)


def _lengths(data: Windows) -> np.ndarray:
    return np.asarray(data.there.sum(axis=1))


def _lagged(u: np.ndarray) -> np.ndarray:
    """Inputs now and before, those before the first sample as the first; squares; one."""
    n = len(u)
    past = [u[np.maximum(np.arange(n) - lag, 0)] for lag in LAGS]
    return np.column_stack([*past, u**2, np.ones(n)])


def _replay_log(own: Filter, log: Log, rivals: Rivals) -> Replayed:
    """Errors of the rig and of rivals, fitted elsewhere, on one log."""
    ahead, whole = _ahead(own, log, rivals), windows([log], own.given, own.read, 0)
    lengths = _lengths(whole)
    shown, predicted = _run_freely(own, whole), np.empty_like(whole.read)
    free = {"rig": _rms(own.read, whole.read - shown)}
    for i, n in enumerate(lengths):
        for j in range(len(own.read)):
            predicted[i, :n, j] = rivals.one_node(rivals.node[j], whole.given[i, :n], whole.read[i, 0, j])
    free["one node"] = _rms(own.read, whole.read - predicted)
    for i, n in enumerate(lengths):
        predicted[i, :n] = rivals.regressed(whole.given[i, :n])
    free["regression with lags"] = _rms(own.read, whole.read - predicted)
    longest = int(lengths.argmax())
    n = lengths[longest]
    both = {s: np.array([shown[longest, :n, j], whole.read[longest, :n, j]]) for j, s in enumerate(own.read)}
    pictured = {s.name: both[s.name] for s in log.read if s.kind.endswith("_temp")}
    units = {s.name: SI[s.kind] for s in sorted(log.read, key=lambda s: own.read.index(s.name))}
    return Replayed(log.name, log.n, free, ahead, units, pictured, log.time[whole.rows[longest, :n]])


def _run_freely(own: Filter, data: Windows) -> np.ndarray:
    """What the rig shows (N, L, reads)."""
    shown, order = np.empty_like(data.read), np.argsort(-_lengths(data), kind="stable")
    for some in np.array_split(order, -(-len(order) // SIDE)):
        z = np.zeros((len(some), len(own.knobs)))
        shown[some] = own.run(data.some(some), z, slopes=False).shown
    return shown


def _rms(names: Sequence[str], error: np.ndarray) -> dict[str, float]:
    return {name: float(np.sqrt(np.nanmean(error[..., j] ** 2))) for j, name in enumerate(names)}


def _ahead(own: Filter, log: Log, rivals: Rivals) -> dict[str, dict[str, tuple[float, ...]]]:
    """Errors some hours after the last correction."""
    steps = [max(round(h * 3600 / log.step), 1) for h in HOURS]
    found: dict[str, dict[str, tuple[float, ...]]] = {
        m: {} for m in ("rig", "one node", "regression with lags", "last reading")
    }
    while steps:
        data = windows([log], own.given, own.read, steps[-1], BEFORE)
        if (long := data.counts.sum(axis=1) >= steps[-1]).any():
            break
        steps.pop()
    else:
        return {method: dict.fromkeys(own.read, ()) for method in found}
    data = data.some(long)
    begin = data.counts.argmax(axis=1)
    shown = _run_freely(own, data)
    at = begin[:, None] + np.array(steps) - 1
    regressed = np.array([rivals.regressed(u)[k] for u, k in zip(data.given, at, strict=True)])
    for j, name in enumerate(own.read):
        errors: dict[str, list[np.ndarray]] = {method: [] for method in found}
        for i, b in enumerate(begin):
            y, last, u = data.read[i, :, j], data.read[i, b - 1, j], data.given[i]
            predicted = {
                "rig": shown[i, at[i], j],
                "one node": rivals.one_node(rivals.node[j], u[b:], last)[at[i] - b],
                "regression with lags": regressed[i, :, j],
                "last reading": np.full(len(steps), last),
            }
            for method, value in predicted.items():
                errors[method].append(y[at[i]] - value)
        for method, e in errors.items():
            found[method][name] = tuple(float(v) for v in np.sqrt(np.nanmean(np.array(e) ** 2, axis=0)))
    return found
