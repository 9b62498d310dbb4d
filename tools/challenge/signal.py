"""How loud a hidden effect is: its signal-to-noise in the files that the diagnosis gets.

The signature of an effect is what it changes in the readings, simulated without noise: all channels (speed, both
torques, temperatures, room) at the ends of both halves of every test, and, where the campaign has a time series, oil
and wall at a few moments of each half. The signal-to-noise is the norm of the whitened signature,

    snr = sqrt(s' S^-1 s),   S = R + J Sigma J'

R holds the repeatabilities of the card squared. Each column of J is what a nuisance does to the readings, simulated by
differences; Sigma is its variance:

- the fixed tolerance of every channel (its own column of ones);
- the eight parameters of the card with their `prior_sd`; with a reference campaign, where the rig is not the model,
  `WIDE_SD` each instead;
- the cooling of the day of every test (`day_cooling_sd`);
- with a reference campaign, a smooth remainder that no parameter removes: a quadratic of speed and load and a line in
  the room's temperature for every direction, in oil, wall and loss (`REMAINDER_SD`), the same in both campaigns;
- true speed, torque and room temperature of every half, practically free: they are known by their readings only, so
  a fault of such an instrument shows in what does not follow;
- beside another hidden effect, the size of that one, practically free; days that scatter are noise to the others.

A reference campaign adds its own readings, in which the signature is zero, and its own days and conditions; parameters
and tolerances are shared. The samples of a series are given the noise of the mean over the samples they stand for.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import block_diag, solve_triangular

from .card import DAY_COOLING_SD, PRIOR_FACTORS, PRIOR_SD, Instruments, scaled, tiled
from .hidden import Effect, side_by_side
from .plan import Plan
from .rig import CLOCK, Acting, Rig, Run, misread, simulate
from .stepping import Clock

WIDE_SD = 0.4

#: Remainder of a rig that is not the model: sun torque [N.m], oil and wall [K].
REMAINDER_SD = {"T_sun_Nm": 0.25, "T_oil_C": 1.0, "T_oil2_C": 1.0, "T_wall_C": 1.0}

#: Change of an oil temperature at which a rig would be stopped [K].
OBVIOUS = 35.0

#: Practically free: true speed [rpm], torque [N.m] and room [K] of a half.
FREE = {"n": 300.0, "load": 3000.0, "room": 100.0}

#: A step of the size of another effect, and how uncertain it is, both over that size.
RESIZED, ANY_SIZE = 0.05, 10.0

#: The effect that is chance itself: its size is the standard deviation of the cooling of the days.
SCATTER = "procedure.day_scatter"

#: Shares of the steps of both halves at which a series counts, and how many of its samples each stands for.
MOMENTS = 8
SAMPLES = 6.0

#: Copies of a campaign in one run of several effects.
BATCH = 128

SERIES_CHANNELS = ("T_oil_C", "T_wall_C")


@dataclass(frozen=True)
class Campaign:
    """A plan, the factors of the rig in it, and whether it has a time series."""

    plan: Plan
    base: Mapping[str, Any]
    series: bool


def _moments() -> np.ndarray:
    """Rows of the steps of a run at which a series counts."""
    first, second = (len(half) for half in CLOCK.halves)
    a = np.linspace(3, first - 3, MOMENTS).astype(int)
    b = first + np.linspace(2, second - 3, MOMENTS).astype(int)
    return np.concatenate([a, b])


def _readings(run: Run, instruments: Instruments, campaign: Campaign, copies: int, clock: Clock = CLOCK) -> np.ndarray:
    """All readings of every copy: (copies, rows, tests); rows are channels and moments."""
    found = run.ends.stacked(instruments.channels)
    stacked = found.reshape(-1, found.shape[-1])
    if campaign.series:
        steps = run.steps.stacked(SERIES_CHANNELS)[:, _moments()]
        stacked = np.concatenate([stacked, steps.reshape(-1, steps.shape[-1])])
    return stacked.reshape(len(stacked), copies, -1).swapaxes(0, 1)


def _labels(instruments: Instruments, series: bool) -> tuple[list[str], np.ndarray]:
    """Channel and repeatability of every row."""
    rows = [c for c in instruments.channels for _ in (0, 1)]
    sd = [instruments.repeat_sd[c] for c in rows]
    if series:
        extra = [c for c in SERIES_CHANNELS for _ in range(2 * MOMENTS)]
        rows += extra
        sd += [instruments.repeat_sd[c] / np.sqrt(SAMPLES) for c in extra]
    return rows, np.array(sd)


@dataclass(frozen=True)
class _Block:
    """One campaign: readings without effect (rows, tests), and what nuisances do, flat over rows and tests."""

    quiet: np.ndarray
    shared: np.ndarray
    local: np.ndarray
    sd: np.ndarray


def _block(
    rig: Rig,
    campaign: Campaign,
    instruments: Instruments,
    prior: Mapping[str, float],
    wide: bool,
    beside: tuple[Effect, float] | None = None,
) -> _Block:
    """Sensitivities by differences, all in one run of many copies; `wide` for a rig that is not the model."""
    plan, eps = campaign.plan, 0.05
    m, copies = plan.columns, 3 + len(prior) + 6
    big, base = plan.tiled(copies), tiled(campaign.base, copies)

    def only(copy: int, size: float) -> np.ndarray:
        mask = np.zeros(copies * m)
        mask[copy * m : (copy + 1) * m] = size
        return mask

    for i, name in enumerate(prior):
        base = scaled(base, PRIOR_FACTORS[name], 1 + only(1 + i, eps))
    day = 1 + len(prior)
    base = scaled(base, ("conv", "rad"), 1 + only(day, eps))
    moves: list[tuple[str, tuple[int, ...], float]] = [
        ("n", (0,), 2.0),
        ("n", (1,), 2.0),
        ("load", (0,), 20.0),
        ("load", (1,), 20.0),
    ]
    moves += [("room", (0, 1), 1.0), ("room", (2,), 1.0)]
    for i, (name, which, size) in enumerate(moves):
        for row in which:
            getattr(big, name)[row] += only(day + 1 + i, size)
    acting: list[Acting] = [(beside[0], beside[1] * (1 + only(copies - 1, RESIZED)))] if beside else []
    y = _readings(simulate(rig, big, base, acting, series=campaign.series), instruments, campaign, copies)
    change = y[1:] - y[:1]
    rows, sd = _labels(instruments, campaign.series)
    shared = [change[i].ravel() / eps * s for i, s in enumerate(prior.values())]
    shared += [np.repeat([float(r == c) for r in rows], m) * instruments.offset_sd[c] for c in instruments.channels]
    days = beside[1] if beside and beside[0].cause == SCATTER else 0.0
    locals_ = [(change[day - 1] / eps, float(np.hypot(DAY_COOLING_SD, days)))]
    locals_ += [(change[day + i] / size, FREE[name]) for i, (name, _, size) in enumerate(moves)]
    if wide:
        shared += _remainder(plan, rows, campaign.series)
    shared.append(change[-1].ravel() / RESIZED * ANY_SIZE)
    local = [_per_test(effect * s) for effect, s in locals_]
    return _Block(y[0], np.array(shared).T, np.concatenate(local, axis=1), np.repeat(sd, m))


def _remainder(plan: Plan, rows: list[str], series: bool) -> list[np.ndarray]:
    """Smooth terms of the conditions, per channel and direction, flat over rows and tests."""
    x, y = (plan.n[0] - 175.0) / 75.0, (plan.load[0] - 2130.0) / 580.0
    terms = [np.ones_like(x), x, y, x * y, x * x, y * y, (plan.room[1] - 24.0) / 5.0]
    ends = len(rows) - (len(SERIES_CHANNELS) * 2 * MOMENTS if series else 0)
    half = np.concatenate([np.arange(ends) % 2, np.arange(len(rows) - ends) // MOMENTS % 2])
    found = []
    for channel, sd in REMAINDER_SD.items():
        for direction in (0, 1):
            here = np.array([float(r == channel) for r in rows]) * (half == direction)
            found += [sd * np.outer(here, term).ravel() for term in terms]
    return found


def _per_test(effect: np.ndarray) -> np.ndarray:
    """One column for each test, from what all tests do at once (rows, tests)."""
    rows, m = effect.shape
    columns: np.ndarray = (effect[:, :, None] * np.eye(m)[None]).reshape(rows * m, m)
    return columns


class Yardstick:
    """Signal-to-noise of effects in one campaign.

    Args:
        rig, campaign, instruments: that show them
        reference: the healthy campaign, if there is one
        beside: another effect that acts as well, and about how much of it
    """

    def __init__(
        self,
        rig: Rig,
        campaign: Campaign,
        instruments: Instruments,
        reference: Campaign | None,
        beside: tuple[Effect, float] | None = None,
    ) -> None:
        self.rig, self.campaign, self.instruments = rig, campaign, instruments
        self._reference, self._other = reference, beside
        prior = dict(PRIOR_SD) if reference is None else dict.fromkeys(PRIOR_SD, WIDE_SD)
        wide = reference is not None
        blocks = [_block(rig, campaign, instruments, prior, wide, beside)]
        if reference is not None:
            blocks.append(_block(rig, reference, instruments, prior, wide))
        self._quiet = blocks[0].quiet
        J = np.hstack([np.vstack([b.shared for b in blocks]), block_diag(*(b.local for b in blocks))])
        S = J @ J.T
        S[np.diag_indices_from(S)] += np.concatenate([b.sd for b in blocks]) ** 2
        self._root = np.linalg.cholesky(S)
        self._runs: dict[Clock, Run] = {}

    def beside(self, effect: Effect, amplitude: float) -> Yardstick:
        """The same where another effect acts, too, the size of which nobody knows."""
        return Yardstick(self.rig, self.campaign, self.instruments, self._reference, (effect, amplitude))

    @property
    def oil(self) -> np.ndarray:
        """Oil temperatures at the ends of the halves, without effect [degC]."""
        i = 2 * self.instruments.channels.index("T_oil_C")
        return self._quiet[i : i + 2]

    def signatures(self, effect: Effect, amplitudes: np.ndarray, *, clock: Clock = CLOCK) -> np.ndarray:
        """What some amplitudes change (amplitudes, rows, tests); not finite where the rig runs away."""
        copies = len(amplitudes)
        plan, base = self.campaign.plan.tiled(copies), tiled(self.campaign.base, copies)
        amounts = np.repeat(amplitudes, self.campaign.plan.columns)
        quiet = self._without_effect(clock)
        with np.errstate(all="ignore"):
            if effect.act is None and effect.pace is None:
                run = misread(quiet, effect, amounts)
            else:
                acting = [(effect, amounts), *self._others(len(amounts))]
                run = simulate(self.rig, plan, base, acting, series=self.campaign.series, clock=clock)
            shown = _readings(run, self.instruments, self.campaign, copies)
            change: np.ndarray = shown - _readings(quiet, self.instruments, self.campaign, 1)
        if effect.pace is not None:  # a series shows its own clock: the same curve, cut off earlier
            change[:, 2 * len(self.instruments.channels) :] = 0.0
        return change

    def together(self, effects: Sequence[Effect], amplitudes: np.ndarray, *, clock: Clock = CLOCK) -> np.ndarray:
        """What each of several effects changes with an amplitude of its own (effects, rows, tests)."""
        found = np.empty((len(effects), *self._quiet.shape))
        sorts: dict[object, list[int]] = {}
        for i, effect in enumerate(effects):
            sorts.setdefault(i if effect.read is not None else effect.pace is None, []).append(i)
        for alike in sorts.values():
            for k in range(0, len(alike), BATCH):
                some = alike[k : k + BATCH]
                effect = effects[some[0]] if len(some) == 1 else side_by_side([effects[i] for i in some])
                found[some] = self.signatures(effect, amplitudes[some], clock=clock)
        return found

    def _without_effect(self, clock: Clock) -> Run:
        """The campaign without the effects that are looked at."""
        if clock not in self._runs:
            plan, base, series = self.campaign.plan, self.campaign.base, self.campaign.series
            others = self._others(plan.columns)
            self._runs[clock] = simulate(self.rig, plan, base, others, series=series, clock=clock)
        return self._runs[clock]

    def _others(self, columns: int) -> list[Acting]:
        """What acts whatever effect is looked at."""
        return [(self._other[0], np.full(columns, self._other[1]))] if self._other else []

    def whitened(self, signatures: np.ndarray) -> np.ndarray:
        """Whitened signatures (rows of all campaigns, amplitudes)."""
        padded = np.zeros((len(self._root), len(signatures)))
        padded[: self._quiet.size] = signatures.reshape(len(signatures), self._quiet.size).T
        white: np.ndarray = solve_triangular(self._root, padded, lower=True)
        return white

    def survey(self, effect: Effect, amplitudes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Signal-to-noise for some amplitudes, and which of them change no oil temperature by more than `OBVIOUS`."""
        signatures = self.signatures(effect, amplitudes)
        i = 2 * self.instruments.channels.index("T_oil_C")
        with np.errstate(invalid="ignore"):
            sensible = (np.abs(signatures[:, i : i + 2]) < OBVIOUS).all(axis=(1, 2))
        snr = np.full(len(amplitudes), np.inf)
        snr[sensible] = np.linalg.norm(self.whitened(signatures[sensible]), axis=0)
        return snr, sensible

    def snr(self, effect: Effect, amplitude: float) -> float:
        """Signal-to-noise for one amplitude."""
        return float(self.survey(effect, np.array([amplitude]))[0][0])
