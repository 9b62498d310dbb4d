"""What the instruments of a campaign show of a rig with some causes in it, and its exact derivatives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..campaign.table import Campaign
from ..library.cause import Nuisance
from .formula import Formula
from .march import Phases, Turned, march
from .plant import Plant

#: Shares of a dwell, of a stop and of the time to a steady state [s] where steps end.
DWELL = np.array([0.003, 0.01, 0.022, 0.04, 0.07, 0.11, 0.16, 0.23, 0.32, 0.45, 0.65, 1.0])
STOP = np.array([0.3, 1.0])
STEADY = 60.0 * 4.0 ** np.arange(14)
#: A kind of sensor that reads zero where the machine stands.
RESTS = ("torque", "speed", "power")


@dataclass(frozen=True)
class Seen:
    """Readings (m,), by nuisances and parameters of causes (m, d), by the true values of the given sensors' readings.

    `local` (m, given, H): by the reading of each given sensor in each row of the same test.
    """

    shown: np.ndarray
    by: np.ndarray
    local: np.ndarray


class Observed:
    """One campaign on a compiled rig.

    Args:
        plant: the rig
        campaign: its readings
        nuisances: what may differ from the rig file
        oils: oil of a test -> values by path
        point: values of inputs that no sensor gives
    """

    def __init__(
        self,
        plant: Plant,
        campaign: Campaign,
        nuisances: Sequence[Nuisance],
        oils: Mapping[str, Mapping[str, float]],
        point: Mapping[str, float],
    ) -> None:
        self.plant, self.campaign, self.nuisances = plant, campaign, tuple(nuisances)
        self.height = int(np.bincount(campaign.test).max())
        starts = np.searchsorted(campaign.test, np.arange(campaign.n_tests))
        self.half = np.arange(campaign.n) - starts[campaign.test]
        #: Which row of the campaign each (test, half) is; the last of the test where it has fewer.
        counts = np.bincount(campaign.test)
        self.rows = starts[:, None] + np.minimum(np.arange(self.height), counts[:, None] - 1)
        self.sensors = {s.name: _filled(campaign.values[s.name]) for s in campaign.sensors}
        self.signs = {s.name: s.sign(campaign.direction) for s in campaign.sensors}
        self.given, self.read = campaign.given, campaign.read
        self.shown = [plant.shown.index(s.reads) for s in self.read if s.reads in plant.shown]
        self.inputs = [plant.u_place[s.reads] for s in self.given]
        held = [(i, r) for i, s in enumerate(self.read) for r in np.flatnonzero(np.isfinite(campaign.values[s.name]))]
        #: Sensor (its number among those read) and row of each of the m entries.
        self.kind, self.row = (np.array(column, dtype=int) for column in zip(*held, strict=True))
        self.measured = np.array([campaign.values[self.read[i].name][r] for i, r in held])
        self.p = np.tile(plant.p, (campaign.n, 1))
        for k, oil in enumerate(campaign.oil):
            for path, value in oils.get(oil, {}).items():
                self.p[campaign.test == k, plant.place[path]] = value
        self.u = np.array(plant.u)
        for path, value in point.items():
            if path in plant.u_place:
                self.u[plant.u_place[path]] = value
        by_room = ~np.isfinite(campaign.T_start) & ~np.isfinite(campaign.room_start)
        room = np.array([s.kind == "ambient" for s in self.given])
        #: By how much the start temperature of a test follows the given readings of its first row (tests, given).
        self.starts = 1.0 * by_room[:, None] * room
        self.features = self._features()
        self._phases = self._duty()

    @property
    def m(self) -> int:
        """Number of entries."""
        return len(self.measured)

    def _features(self) -> np.ndarray:
        """Of the rows, in the order of `FEATURES`."""
        c = self.campaign
        humidity = np.nan_to_num(c.humidity, nan=0.5)[c.test]
        oil = [s.name for s in c.sensors if s.kind == "oil_temp"]
        room = [s.name for s in c.sensors if s.kind == "ambient"]
        rise = self.sensors[oil[0]] - self.sensors[room[0]] if oil and room else np.full(c.n, 30.0)
        dwell = np.where(np.isfinite(c.dwell), c.dwell, 1e9)
        return np.array([c.progress, c.direction, rise, humidity, np.minimum(self.half, 1), dwell])

    def _duty(self) -> Phases:
        """All tests as runs: a dwell for each row, a stop before each but the first."""
        c, rows = self.campaign, self.rows
        n, n_given = c.n_tests, len(self.given)
        absent = np.arange(self.height) >= np.bincount(c.test)[:, None]
        dwell = np.where(absent, 0.0, np.where(np.isinf(c.dwell), STEADY.sum(), c.dwell)[rows])
        stop = np.where(absent, 0.0, c.stop[rows])
        lengths, row, steps, read = [], [], [], []
        local = []
        one = np.eye(self.height)
        room = np.array([s.kind == "ambient" for s in self.given], dtype=bool)
        moving = np.array([s.kind in RESTS for s in self.given], dtype=bool)
        shares = np.cumsum(STEADY) / STEADY.sum() if c.steady else DWELL
        reached = np.tile(one[0], (n, 1))  # weights of the rows in the room's temperature so far
        for h in range(self.height):
            if h:
                share = (stop[:, h] / np.maximum(stop[:, h] + dwell[:, h], 1e-9))[:, None]
                after = reached + share * (one[h] - reached)
                lengths.append(stop[:, h])
                weights = np.zeros((2, n, n_given, self.height))
                weights[0][:, room], weights[1][:, room] = reached[:, None], after[:, None]
                weights[:, :, ~room & ~moving] = one[h]
                local.append(weights)
                row.append(h)
                steps.append(STOP)
                read.append(())
                reached = after
            weights = np.tile(one[h], (2, n, n_given, 1))
            if not c.steady:
                weights[0][:, room] = reached[:, None]
            reached = np.tile(one[h], (n, 1))
            lengths.append(dwell[:, h])
            local.append(weights)
            row.append(h)
            steps.append(shares)
            read.append((len(shares) - 1,))
        whole = np.array(local)
        empty = np.empty((n, len(row), 0))
        return Phases(
            np.array(lengths).T,
            empty,
            empty,
            tuple(row),
            tuple(steps),
            tuple(read),
            whole[:, 0].swapaxes(0, 1),
            whole[:, 1].swapaxes(0, 1),
        )

    def _driven(self, truth: np.ndarray) -> tuple[Phases, np.ndarray]:
        """The duty with inputs by the true values of the given sensors (given, n), and start temperatures (tests,)."""
        c, phases = self.campaign, self._phases
        own = truth[:, self.rows].transpose(1, 0, 2)  # tests, given, H
        u0, u1 = (np.tile(self.u, (c.n_tests, len(phases.row), 1)) for _ in (0, 1))
        for u, local in ((u0, phases.local0), (u1, phases.local1)):
            u[:, :, self.inputs] = np.einsum("tfgh,tgh->tfg", local, own)
        room = next((i for i, s in enumerate(self.given) if s.kind == "ambient"), None)
        at_first = own[:, room, 0] if room is not None else np.full(c.n_tests, 293.15)
        begun = np.where(np.isfinite(c.room_start), c.room_start, at_first + c.room_begin)
        if room is not None and not c.steady:
            u0[:, 0, self.inputs[room]] = begun
        start = np.where(np.isfinite(c.T_start), c.T_start, begun + c.start_by_room)
        phases = Phases(phases.length, u0, u1, phases.row, phases.steps, phases.read, phases.local0, phases.local1)
        return phases, start

    def at(self, z: np.ndarray, parts: Sequence[tuple[Formula, np.ndarray]]) -> Seen:
        """Readings and derivatives.

        Args:
            z: nuisances, in standard deviations
            parts: causes that act, each with its parameters

        Returns:
            readings hold NaN where the model cannot be run
        """
        return _Look(self, z, parts).seen()

    def outputs(self) -> np.ndarray:
        """All that the plant shows in each row as its file has it (n, shown), NaN where it cannot be run."""
        return _Look(self, np.zeros(len(self.nuisances)), ()).outputs()

    def tangents(
        self,
        z: np.ndarray,
        parts: Sequence[tuple[Formula, np.ndarray]],
        candidates: Sequence[tuple[Formula, np.ndarray]],
    ) -> np.ndarray:
        """First-order effects (m, k) of the sizes of candidates beside causes that act, each alone, at size zero."""
        return _Look(self, z, parts, candidates).tangents()

    def shown_by(self, z: np.ndarray, parts: Sequence[tuple[Formula, np.ndarray]]) -> np.ndarray:
        """Readings (m,) only."""
        return _Look(self, z, parts).shown()


class _Look:
    """One evaluation: values with their derivatives by d directions, nuisances first, then each part's parameters."""

    def __init__(
        self,
        o: Observed,
        z: np.ndarray,
        parts: Sequence[tuple[Formula, np.ndarray]],
        candidates: Sequence[tuple[Formula, np.ndarray]] = (),
    ) -> None:
        self.o, self.z, self.parts, self.candidates = o, z, parts, candidates
        self.n = o.campaign.n
        self.tried = len(z) + sum(f.size for f, _ in parts)
        self.d = self.tried + len(candidates)
        self.values: dict[str, np.ndarray] = {}
        self.slopes: dict[str, np.ndarray] = {}
        self.truth = dict(o.sensors)
        self.truth_slopes = {s.name: np.zeros((self.n, self.d)) for s in o.given}
        self.pace, self.pace_slopes = np.ones(self.n), np.zeros((self.n, self.d))
        #: Directions of candidates that change parameters: number, values and slopes by path.
        self.apart: list[tuple[int, dict[str, np.ndarray], dict[str, np.ndarray]]] = []
        self._nuisances()
        begin = len(z)
        for formula, t in parts:
            self._act(formula, t, slice(begin, begin + formula.size))
            begin += formula.size
        for k, (formula, t) in enumerate(candidates, start=begin):
            self._try(formula, t, k)

    def _try(self, formula: Formula, t: np.ndarray, k: int) -> None:
        """The direction of a candidate's size, at its own shapes."""
        base = {name: self._base(name) for name in formula.bases}
        value, by_t, _ = formula.physics(_none(t), base, self.o.sensors, self.o.features)
        slopes, n_paths = by_t[:, :, 0], len(formula.paths)
        if n_paths:
            values = dict(zip(formula.paths, value[:n_paths], strict=True))
            self.apart.append((k, values, dict(zip(formula.paths, slopes[:n_paths], strict=True))))
        for i, name in enumerate(formula.given, start=n_paths):
            self.truth_slopes[name][:, k] += slopes[i]
        if formula.paced:
            self.pace_slopes[:, k] += slopes[n_paths + len(formula.given)]

    def _base(self, path: str) -> np.ndarray:
        return self.values[path] if path in self.values else self.o.p[:, self.o.plant.place[path]]

    def _nuisances(self) -> None:
        for k, nuisance in enumerate(self.o.nuisances):
            for path, exponent in nuisance.paths.items():
                factor = np.exp(exponent * nuisance.sd * self.z[k])
                old = self._base(path)
                slope = self.slopes.get(path, np.zeros((self.n, self.d))) * factor
                slope[:, k] += exponent * nuisance.sd * old * factor
                self.values[path], self.slopes[path] = old * factor, slope

    def _act(self, formula: Formula, t: np.ndarray, own: slice) -> None:
        base = {name: self._base(name) for name in formula.bases}
        value, by_t, by_base = formula.physics(t, base, self.o.sensors, self.o.features)
        slopes = np.zeros((*value.shape, self.d))
        slopes[:, :, own] = by_t
        for name, by in by_base.items():
            if name in self.slopes:
                slopes += by[:, :, None] * self.slopes[name]
        n_paths, n_given = len(formula.paths), len(formula.given)
        for i, path in enumerate(formula.paths):
            self.values[path], self.slopes[path] = value[i], slopes[i]
        for i, name in enumerate(formula.given, start=n_paths):
            self.truth[name], self.truth_slopes[name] = value[i], self.truth_slopes[name] + slopes[i]
        if formula.paced:
            self.pace = self.pace * value[n_paths + n_given]
            self.pace_slopes = self.pace_slopes + slopes[n_paths + n_given]

    def _run(self, turned: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        o, plant, rows = self.o, self.o.plant, self.o.rows
        p = o.p.copy()
        for path, value in self.values.items():
            p[:, plant.place[path]] = value
        truth = np.array([self.truth[s.name] * o.signs[s.name] for s in o.given])
        phases, start = o._driven(truth)
        x0 = np.tile(plant.flat.starts("state"), (o.campaign.n_tests, 1))
        thermal = [q.unit == "K" for q in plant.flat.states]
        x0[:, thermal] = start[:, None]
        ways = None
        if turned:
            touched = [k for k in plant.knobs if k in self.slopes]
            by = np.stack([self.slopes[k] for k in touched], axis=1) if touched else np.zeros((self.n, 0, self.d))
            places = np.array([plant.knobs.index(k) for k in touched], dtype=int)
            ways = Turned(by[rows], places, self.pace_slopes[rows], o.starts, *self._apart(p))
        found = march(plant, phases, x0, p[rows], self.pace[rows], ways)
        y = found.y[o.campaign.test, o.half]  # n, shown
        if found.by is None or found.local is None:
            return y, np.empty(0), np.empty(0), truth
        return y, found.by[o.campaign.test, o.half], found.local[o.campaign.test, o.half], truth

    def _apart(self, p: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Directions of candidates (c,), their parameters (tests, H, c, np) and ways (tests, H, c, knobs)."""
        plant, c = self.o.plant, len(self.apart)
        own = np.repeat(p[:, None], c, axis=1)
        ways = np.zeros((self.n, c, len(plant.knobs)))
        for i, (_, values, slopes) in enumerate(self.apart):
            for path, value in values.items():
                own[:, i, plant.place[path]] = value
                ways[:, i, plant.knobs.index(path)] = slopes[path]
        return np.array([k for k, _, _ in self.apart], dtype=int), own[self.o.rows], ways[self.o.rows]

    def outputs(self) -> np.ndarray:
        """All that the plant shows (n, shown)."""
        return self._run(turned=False)[0]

    def shown(self) -> np.ndarray:
        """Readings (m,) only."""
        y = self._run(turned=False)[0]
        true = {s.name: y[:, k] * self.o.signs[s.name] for s, k in zip(self.o.read, self.o.shown, strict=True)}
        for formula, t in self.parts:
            if formula.read:
                value, _, _ = formula.instruments(t, self.o.sensors, true, self.o.features)
                true |= dict(zip(formula.read, value, strict=True))
        whole = np.array([true[s.name] for s in self.o.read])
        return np.asarray(whole[self.o.kind, self.o.row])

    def tangents(self) -> np.ndarray:
        """Effects of the candidates' sizes (m, k)."""
        o, begin = self.o, self.tried
        found = self.seen()
        effects = found.by[:, begin:]
        whole = self.true
        for k, (formula, t) in enumerate(self.candidates):
            if formula.read:
                _, by_t, _ = formula.instruments(_none(t), o.sensors, whole, o.features)
                for i, name in enumerate(formula.read):
                    sensor = next(j for j, s in enumerate(o.read) if s.name == name)
                    mine = o.kind == sensor
                    effects[mine, k] += by_t[i, o.row[mine], 0]
        return effects

    def seen(self) -> Seen:
        """Readings and derivatives."""
        o = self.o
        y, by, local, _ = self._run(turned=True)
        true, slopes, locals_ = {}, {}, {}
        for s, k in zip(o.read, o.shown, strict=True):
            sign = o.signs[s.name]
            true[s.name] = y[:, k] * sign
            locals_[s.name] = local[:, k] * sign[:, None, None]  # n, given, H
            slopes[s.name] = by[:, k] * sign[:, None] + self._through_given(locals_[s.name])
        begin = len(self.z)
        for formula, t in self.parts:
            own = slice(begin, begin + formula.size)
            begin += formula.size
            if not formula.read:
                continue
            value, by_t, by_reads = formula.instruments(t, o.sensors, true, o.features)
            changed = {}
            for i, name in enumerate(formula.read):
                slope = np.zeros((self.n, self.d))
                slope[:, own] = by_t[i]
                far = np.zeros_like(locals_[name])
                for other, weight in by_reads.items():
                    slope += weight[i][:, None] * slopes[other]
                    far += weight[i][:, None, None] * locals_[other]
                changed[name] = (value[i], slope, far)
            for name, (v, slope, far) in changed.items():
                true[name], slopes[name], locals_[name] = v, slope, far
        self.true = true
        pick = [np.array([item[s.name] for s in o.read])[o.kind, o.row] for item in (true, slopes, locals_)]
        return Seen(*pick)

    def _through_given(self, local: np.ndarray) -> np.ndarray:
        """What causes change through the given sensors' truth (n, d)."""
        o, found = self.o, np.zeros((self.n, self.d))
        for g, s in enumerate(o.given):
            slope = self.truth_slopes[s.name]
            if slope.any():
                signed = slope * o.signs[s.name][:, None]
                own = signed[o.rows][o.campaign.test]  # n, H, d
                found += np.einsum("nh,nhd->nd", local[:, g], own)
        return found


def _none(t: np.ndarray) -> np.ndarray:
    """The parameters of a form at size zero."""
    return np.concatenate([[0.0], t[1:]])


def _filled(values: np.ndarray) -> np.ndarray:
    """A column whose missing values stand at the mean of the others."""
    known = values[np.isfinite(values)]
    return np.where(np.isfinite(values), values, known.mean() if len(known) else 0.0)
