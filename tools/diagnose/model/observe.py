"""What the instruments of a campaign show of a rig with some causes in it, and its exact derivatives."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Self

import numpy as np

from ....scenarios.measured.table import Campaign
from ....scenarios.nuisances import Nuisance
from .entries import Measured, Seen
from .formula import Formula, Parts
from .march import Marched, Phases, duty, march
from .plant import Plant

#: Largest size of a nuisance.
FARTHEST = 6.0
#: Derivatives of a value of each row that are not zero: direction -> of each row (n,).
Slope = dict[int, np.ndarray]
#: Part -> paths that are changed in it, and the bytes of their values of each row, which are equal where these are.
_Changes = dict[str, tuple[tuple[str, bytes], ...]]


def total(terms: Sequence[tuple[np.ndarray | float, Slope]]) -> Slope:
    """Slopes, each times its weight."""
    found: Slope = {}
    for weight, slope in terms:
        for i, own in slope.items():
            found[i] = found[i] + weight * own if i in found else weight * own
    return found


class Observed(Measured):
    """One campaign on a compiled rig.

    Args:
        plant: the rig
        campaign, nuisances: as for `Measured`
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
        super().__init__(campaign, nuisances)
        self.plant, self.oils, self.point = plant, oils, point
        self.shown = [plant.shown.index(s.reads) for s in self.read if s.reads in plant.shown]
        self.inputs = [plant.u_place[s.reads] for s in self.given]
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
        #: Form and parameters at size zero -> as `_Look._neutral`, of those that build on no value of the rig.
        self.neutral: dict[tuple[Formula, bytes], tuple[np.ndarray, _Changes]] = {}
        self._phases = duty(campaign, self.rows, 1.0 * by_room[:, None] * room)
        at = self.entries
        #: Of each place that is read: its test, the run of that, and its number among the reads of a run.
        self.test = self.run = campaign.test[at.place_row]
        self.ran = np.arange(campaign.n_tests)
        self.reads = self.half[at.place_row] * len(self._phases.read[0]) + at.step
        #: Which reads of a run lie along logged courses.
        self.along = np.arange(sum(map(len, self._phases.read))) % len(self._phases.read[0]) < at.step.max()

    @cached_property
    def limits(self) -> np.ndarray:
        """Lowest and highest nuisances (2, k), inside which no value of the rig is beyond what is possible."""
        found = np.array([[-FARTHEST], [FARTHEST]]).repeat(len(self.nuisances), axis=1)
        for k, nuisance in enumerate(self.nuisances):
            for path, exponent in nuisance.paths.items():
                place, slope = self.plant.place.get(path), exponent * nuisance.sd
                if place is None or slope == 0.0:
                    continue
                q, value = self.plant.flat.parameters[place], self.plant.p[place]
                ends = [np.log(end / value) / slope if 0 < end < np.inf else np.nan for end in (q.low, q.high)]
                low, high = ends if slope > 0 else ends[::-1]
                found[:, k] = np.fmax(found[0, k], low), np.fmin(found[1, k], high)
        return found

    def another(self, campaign: Campaign) -> Observed:
        """Another campaign on the same rig."""
        return Observed(self.plant, campaign, self.nuisances, self.oils, self.point)

    def only(self, kept: np.ndarray) -> Self:
        """The same with some of its entries (k,); a test without any is not run, and its places stand for nothing."""
        found = super().only(kept)
        found.ran = np.unique(self.campaign.test[found.row])
        found.run = np.minimum(np.searchsorted(found.ran, self.test), len(found.ran) - 1)
        return found

    def driven(self, truth: np.ndarray) -> tuple[Phases, np.ndarray]:
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
        return replace(phases, u0=u0, u1=u1), start

    def at(self, z: np.ndarray, parts: Parts) -> Seen:
        """Readings and derivatives.

        Args:
            z: nuisances, in standard deviations (k,), or of each row (k, n)
            parts: causes that act, each with its parameters

        Returns:
            readings hold NaN where the model cannot be run
        """
        return _Look(self, z, parts).seen()

    def outputs(self) -> np.ndarray:
        """All that the plant shows in each row as its file has it (n, shown), NaN where it cannot be run."""
        return _Look(self, np.zeros(len(self.nuisances)), ()).outputs()[: self.campaign.n]

    def tangents(self, z: np.ndarray, parts: Parts, candidates: Parts) -> np.ndarray:
        """First-order effects (m, k) of the sizes of candidates beside causes that act, each alone, at size zero."""
        return _Look(self, z, parts, candidates).tangents()

    def shown_by(self, z: np.ndarray, parts: Parts) -> np.ndarray:
        """Readings (m,) only."""
        return _Look(self, z, parts).shown()


class _Look:
    """One evaluation: values with their derivatives by some directions, nuisances first, then each part's parameters,
    then the size of each candidate. Slopes hold those that are not zero: direction -> one of each row (n,).
    """

    def __init__(self, o: Observed, z: np.ndarray, parts: Parts, candidates: Parts = ()) -> None:
        self.o, self.z, self.parts, self.candidates = o, z, parts, candidates
        self.n = o.campaign.n
        self.values: dict[str, np.ndarray] = {}
        self.slopes: dict[str, Slope] = {}
        self.truth = dict(o.sensors)
        self.truth_slopes: dict[str, Slope] = {s.name: {} for s in o.given}
        self.pace, self.pace_slopes = np.ones(self.n), Slope()
        #: Settings of the parameters beside the one that acts: whether no other candidate may join, what is changed.
        self.settings: list[tuple[bool, _Changes]] = []
        self.acting = {path.partition(".")[0] for formula, _ in parts for path in formula.paths}
        #: Slopes of candidates: setting, path, direction, of each row.
        self.tried_slopes: list[tuple[int, str, int, np.ndarray]] = []
        self._nuisances()
        self.d = len(z)
        for formula, t in parts:
            self._act(formula, t)
            self.d += formula.size
        self.tried = self.d
        for formula, t in candidates:
            self._try(formula, t)
            self.d += 1

    def _nuisances(self) -> None:
        for k, nuisance in enumerate(self.o.nuisances):
            for path, exponent in nuisance.paths.items():
                rate = exponent * nuisance.sd
                self.values[path] = self._base(path) * (factor := np.exp(rate * self.z[k]))
                self.slopes[path] = total([(factor, self.slopes.get(path, {})), (rate, {k: self.values[path]})])

    def _base(self, path: str) -> np.ndarray:
        return self.values[path] if path in self.values else self.o.p[:, self.o.plant.place[path]]

    def _physics(self, formula: Formula, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]:
        base = {name: self._base(name) for name in formula.bases}
        return formula.physics(t, base, self.o.sensors, self.o.features)

    def _neutral(self, formula: Formula, t: np.ndarray) -> tuple[np.ndarray, _Changes]:
        """Slopes of a candidate's values by its size at zero (v, n), and what changes there; kept if always so."""
        key, untouched = (formula, t.tobytes()), self.values.keys().isdisjoint(formula.paths)
        if not untouched or (known := self.o.neutral.get(key)) is None:
            value, by_t, _ = self._physics(formula, t)
            changes: _Changes = {}
            for path, v in zip(formula.paths, value, strict=False):
                if not np.array_equal(v, self._base(path)):
                    part = path.partition(".")[0]
                    changes[part] = (*changes.get(part, ()), (path, v.tobytes()))
            known = by_t[:, :, 0].copy(), changes
            if untouched and not formula.bases:
                self.o.neutral[key] = known
        return known

    def _act(self, formula: Formula, t: np.ndarray) -> None:
        value, by_t, by_base = self._physics(formula, t)
        slopes = []
        for i in range(len(value)):
            through = [(by[i], self.slopes[name]) for name, by in by_base.items() if name in self.slopes]
            slopes.append(total([(1.0, {self.d + k: by_t[i, :, k] for k in range(formula.size)}), *through]))
        names = (*formula.paths, *formula.given)
        for i, (name, slope) in enumerate(zip(names, slopes, strict=False)):
            if i < len(formula.paths):
                self.values[name], self.slopes[name] = value[i], slope
            else:
                self.truth[name] = self.truth[name] + value[i] - self.o.sensors[name]
                self.truth_slopes[name] = total([(1.0, self.truth_slopes[name]), (1.0, slope)])
        if formula.paced:
            self.pace_slopes = total([(value[-1], self.pace_slopes), (self.pace, slopes[-1])])
            self.pace = self.pace * value[-1]

    def _try(self, formula: Formula, t: np.ndarray) -> None:
        """The direction of a candidate's size, at its own shapes."""
        slopes, wanted = self._neutral(formula, np.append(0.0, t[1:]))
        setting = self._setting(wanted)
        sized = [(path, slopes[i]) for i, path in enumerate(formula.paths) if path in formula.sized]
        self.tried_slopes += [(setting, path, self.d, slope) for path, slope in sized]
        for i, name in enumerate(formula.given, start=len(formula.paths)):
            self.truth_slopes[name][self.d] = slopes[i]
        if formula.paced:
            self.pace_slopes[self.d] = self.pace * slopes[-1]

    def _setting(self, wanted: _Changes) -> int:
        """Number of the setting a candidate is tried at; what it changes of a part, no other there changes."""
        if not wanted:
            return 0
        alone = not self.acting.isdisjoint(wanted)
        for k, (closed, known) in enumerate(self.settings, start=1):
            if not (alone or closed or any(known[part] != wanted[part] for part in known.keys() & wanted)):
                known.update(wanted)
                return k
        self.settings.append((alone, dict(wanted)))
        return len(self.settings)

    def _run(self, wanted: Collection[int] | None = None) -> Marched:
        """Readings of all rows. Logged series use their own time stamps; a shortened dwell does not apply to them."""
        found = self._paced(self.pace, wanted)
        if not (along := self.o.along).any():
            return found
        if (self.pace != 1).any():
            logged = self._paced(np.ones(self.n), wanted)
            for name in ("y", "by", "local", "tried"):
                getattr(found, name)[..., along, :] = getattr(logged, name)[..., along, :]
        found.by[:, :, -1, along] = 0.0
        return found

    def _paced(self, pace: np.ndarray, wanted: Collection[int] | None) -> Marched:
        o, plant = self.o, self.o.plant
        p = np.tile(o.p, (1 + len(self.settings), 1, 1))
        for path, value in self.values.items():
            p[:, :, plant.place[path]] = value
        for own, (_, changes) in zip(p[1:], self.settings, strict=True):
            for path, bits in (item for part in changes.values() for item in part):
                own[:, plant.place[path]] = np.frombuffer(bits)
        truth = np.array([self.truth[s.name] * o.signs[s.name] for s in o.given]).reshape(-1, self.n)
        phases, start = o.driven(truth)
        x0 = np.tile(plant.flat.starts("state"), (o.campaign.n_tests, 1))
        x0[:, [q.name in plant.flat.bodies for q in plant.flat.states]] = start[:, None]
        rows = o.rows[o.ran]
        return march(plant, phases.of(o.ran), x0[o.ran], p[:, rows], pace[rows], wanted)

    def outputs(self) -> np.ndarray:
        """All that the plant shows at each place (p, shown)."""
        return np.asarray(self._run().y[self.o.run, self.o.reads])

    def instruments(
        self, formula: Formula, t: np.ndarray, true: Mapping[str, np.ndarray]
    ) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]:
        """What a cause's instruments show at each place, where its row's conditions hold."""
        row = self.o.entries.place_row
        sensors = {name: values[row] for name, values in self.o.sensors.items()}
        return formula.instruments(t, sensors, true, self.o.features[:, row])

    def shown(self) -> np.ndarray:
        """Readings (m,) only."""
        y = self.outputs()
        row = self.o.entries.place_row
        true = {s.name: y[:, k] * self.o.signs[s.name][row] for s, k in zip(self.o.read, self.o.shown, strict=True)}
        for formula, t in self.parts:
            if formula.read:
                value, _, _ = self.instruments(formula, t, true)
                true |= dict(zip(formula.read, value, strict=True))
        return self.o.entries.picked(np.array([true[s.name] for s in self.o.read]), self.pace - 1)

    def tangents(self) -> np.ndarray:
        """Effects of the candidates' sizes (m, k)."""
        o, names = self.o, [s.name for s in self.o.read]
        effects = self.seen().by[:, self.tried :]
        for k, (formula, t) in enumerate(self.candidates):
            if formula.read:
                _, by_t, _ = self.instruments(formula, np.append(0.0, t[1:]), self.true)
                for i, name in enumerate(formula.read):
                    mine = o.entries.sensor == names.index(name)
                    effects[mine, k] += by_t[i, o.entries.at[mine], 0]
        return effects

    def seen(self) -> Seen:
        """Readings and derivatives."""
        o = self.o
        y, by, local = self._turned()
        true, slopes, locals_ = {}, {}, {}
        for s, k in zip(o.read, o.shown, strict=True):
            sign = o.signs[s.name][o.entries.place_row]
            true[s.name] = y[:, k] * sign
            locals_[s.name] = local[:, :, :, k] * sign[:, None, None]  # p, given, H
            slopes[s.name] = by[:, k] * sign[:, None]
        begin = len(self.z)
        for formula, t in self.parts:
            own = slice(begin, begin + formula.size)
            begin += formula.size
            if not formula.read:
                continue
            value, by_t, by_reads = self.instruments(formula, t, true)
            slopes_before, locals_before = dict(slopes), dict(locals_)
            for i, name in enumerate(formula.read):
                slope, far = np.zeros((len(y), self.d)), np.zeros_like(locals_[name])
                slope[:, own] = by_t[i]
                for other, weight in by_reads.items():
                    slope += weight[i][:, None] * slopes_before[other]
                    far += weight[i][:, None, None] * locals_before[other]
                true[name], slopes[name], locals_[name] = value[i], slope, far
        self.true = true
        dwells = np.zeros((self.n, self.d))
        for i, slope in self.pace_slopes.items():
            dwells[:, i] = slope
        rest = (self.pace - 1, dwells, np.zeros((self.n, *local.shape[1:3])))
        whole = [np.array([item[s.name] for s in o.read]) for item in (true, slopes, locals_)]
        return Seen(*(o.entries.picked(item, own) for item, own in zip(whole, rest, strict=True)))

    def _turned(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """What the plant shows (p, shown), by all directions (p, shown, d), by given readings (p, given, H, shown)."""
        o, entries = self.o, sorted(self._entries(), key=lambda e: e[0])
        found = self._run({k for _, k, _ in entries})
        test, run = o.test, o.run
        local = found.local[run, :, :, o.reads]
        signs = np.array([o.signs[s.name] for s in o.given]).reshape(-1, self.n)
        by_truth = local.swapaxes(1, 2) * signs[:, o.rows[test]].transpose(1, 2, 0)[..., None]  # p, H, given, shown
        own = found.by[run, :, :, o.reads]  # p, H, knobs + 1, shown
        tried = found.tried[run, :, :, :, o.reads].swapaxes(1, 2)  # p, H, further settings, tried knobs, shown
        tried = tried.reshape(len(test), o.height, -1, found.y.shape[2])
        all_by = np.concatenate([own, by_truth, tried], axis=2)
        by = np.zeros((len(test), found.y.shape[2], self.d))
        if entries:
            places, first = np.unique([i for i, _, _ in entries], return_index=True)
            ways = np.array([v for _, _, v in entries])[:, o.rows[test]]  # entries, p, H
            effects = np.einsum("nhes,enh->nse", all_by[:, :, [k for _, k, _ in entries]], ways, optimize=False)
            by[:, :, places] = np.add.reduceat(effects, first, axis=2)
        return found.y[run, o.reads], by, local

    def _entries(self) -> list[tuple[int, int, np.ndarray]]:
        """All slopes: direction, column (knobs, pace, given sensors, tried knobs of further settings), of each row."""
        plant = self.o.plant
        place = {name: k for k, name in enumerate(plant.knobs)}
        sizes = {name: k for k, name in enumerate(plant.tried)}
        slopes = [(place[name], slope) for name, slope in self.slopes.items() if name in place]
        slopes.append((len(place), self.pace_slopes))
        slopes += [(k, self.truth_slopes[s.name]) for k, s in enumerate(self.o.given, start=len(place) + 1)]
        first = len(place) + 1 + len(self.o.given)
        found = [(i, k, v) for k, slope in slopes for i, v in slope.items()]
        for setting, path, i, v in self.tried_slopes:
            found.append((i, first + len(sizes) * (setting - 1) + sizes[path] if setting else place[path], v))
        return found
