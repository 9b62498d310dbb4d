"""A campaign with the readings of all experiments that may follow it, so that one simulation serves all of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import norm

from ...model.errors import SolveError
from ...scenarios.measured import Campaign, Reading, Test
from ..effects.cause import spread
from .campaign_model import CampaignModel, Rig
from .candidates import LOG, Candidate, Point
from .problem import Campaigned, Problem
from .series import Series

#: Samples of each half in a log.
SAMPLES = 50
#: Humidity of the days where it is not known [%]: mean and standard deviation.
HUMIDITY = (50.0, 15.0)


@dataclass(frozen=True)
class Enlarged:
    """A problem whose acting campaign holds the readings of all experiments.

    `experiments` are those that the machine can run; `present` is a mask (m) of what there is without them, `added`
    holds one for each of what it adds.
    """

    problem: Problem
    experiments: tuple[Candidate, ...]
    present: np.ndarray
    added: Mapping[str, np.ndarray]

    @staticmethod
    def of(problem: Problem, experiments: Sequence[Candidate]) -> Enlarged:
        """The campaign with all tests and channels of the experiments."""
        before = problem.data
        readings, owners, kept = list[Reading](), dict[int, str](), list[Candidate]()
        for experiment in experiments:
            with suppress(SolveError):  # what the machine cannot do is no experiment
                added = _added(problem, experiment, max([r.test for r in before.model.readings] + list(owners)))
                readings += added
                owners |= {r.test: experiment.id for r in added}
                kept.append(experiment)
        now = Campaigned.of(_model(problem, readings, {c for e in kept for c in e.channels}), acting=True)
        campaigns = [now if c is before else c for c in problem.campaigns]
        whole = Problem(problem.rig, campaigns, problem.card, problem.parameters)
        return Enlarged(whole, tuple(kept), *_masks(before, whole, kept, owners))


def answered(
    rig: Rig, campaign: Campaign, oils: Mapping[str, Mapping[str, float]], values: Mapping[str, float]
) -> Campaign:
    """A campaign with the readings that the model gives with some values changed."""
    model = CampaignModel(rig, campaign, oils)
    shown = model.simulate([values])[0]
    place = {(r.test, r.direction): k for k, r in enumerate(model.readings)}

    def filled(reading: Reading) -> Reading:
        k = place[reading.test, reading.direction]
        read = {f"{channel}_C": float(shown[channel][k]) - 273.15 for channel in ("T_oil", "T_oil2", "T_wall")}
        loss = float(shown["loss"][k] * model.rows.direction[k])
        read["T_sun_Nm"] = (reading.values["T_carrier_Nm"] - loss) / 4
        kept = {name: value for name, value in read.items() if name != "T_oil2_C" or name in reading.values}
        return replace(reading, values={**reading.values, **kept})

    return replace(campaign, readings=tuple(filled(reading) for reading in campaign.readings))


def _added(problem: Problem, experiment: Candidate, last: int) -> tuple[Reading, ...]:
    """Readings of the tests of an experiment, numbered behind the last test there is."""
    model = problem.data.model
    tests = [_test(model, last + k, point) for k, point in enumerate(experiment.points, start=1)]
    if not tests:
        return ()
    campaign = replace(model.campaign, readings=tuple(reading for test in tests for reading in test))
    return answered(problem.rig, campaign, _oils(model), {}).readings


def _test(model: CampaignModel, number: int, point: Point) -> list[Reading]:
    """The readings of an added test before anything is read, run as the first test was."""
    n, tau, room = point
    values = {"n_carrier_rpm": n, "T_carrier_Nm": tau, "T_amb_C": room}
    values |= dict.fromkeys(("T_oil_C", "T_start_C", "T_amb_start_C"), np.nan)
    order = max(r.order for r in model.readings)
    return [replace(half, test=number, order=order, values={**half.values, **values}) for half in model.tests[0].halves]


def _model(problem: Problem, added: Sequence[Reading], channels: set[str]) -> CampaignModel:
    """The campaign with added tests, and with channels of which only the signatures and the scatter count."""
    model = problem.data.model
    readings = [*model.campaign.readings, *added]
    if "T_oil2" in channels:
        readings = [replace(r, values={**r.values, "T_oil2_C": r.values["T_oil_C"]}) for r in readings]
    if "humidity" in channels:
        tests = list(dict.fromkeys(r.test for r in readings))
        drawn = HUMIDITY[0] + HUMIDITY[1] * norm.ppf(spread(len(tests), 1)[:, 0])
        humid = dict(zip(tests, drawn, strict=True))
        readings = [replace(r, values={**r.values, "humidity_pct": float(humid[r.test])}) for r in readings]
    logs = {
        test.number: _log(test, run.moments)
        for test, run, own in zip(model.tests, model.runs, model.logged, strict=True)
        if own or set(LOG) <= channels
    }
    orders = [float(r.order) for r in model.readings]
    campaign = replace(model.campaign, readings=tuple(readings))
    span = (min(orders), max(orders))
    return CampaignModel(problem.rig, campaign, _oils(model), model.memory, span, Series("", logs))


def _oils(model: CampaignModel) -> dict[str, Mapping[str, float]]:
    return {test.oil: oil for test, oil in zip(model.tests, model.oils, strict=True)}


def _log(test: Test, moments: Sequence[float]) -> dict[str, np.ndarray]:
    """Samples of a test; only when they are taken counts, not what they show."""
    parts = []
    for half, end in zip(test.halves, moments, strict=True):
        times = end - half.si("dwell_min") * np.arange(SAMPLES)[::-1] / SAMPLES
        shown = {name: np.full(SAMPLES, half.values[name]) for name in ("T_oil_C", "T_wall_C")}
        parts.append({"direction": np.full(SAMPLES, half.direction), "time_s": times, **shown})
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def _masks(
    before: Campaigned, whole: Problem, experiments: Sequence[Candidate], owners: Mapping[int, str]
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Which readings there are, and which each experiment adds."""
    now, begin = whole.data, whole.place(whole.data).start
    logged = [test.number for test, own in zip(before.model.tests, before.model.logged, strict=True) if own]
    number = np.array([test.number for test in now.model.tests])[now.model.rows.test]
    owner = np.array([owners.get(int(k), "") for k in number])
    present = np.ones(len(whole.measured), dtype=bool)
    added = {e.id: np.zeros(len(present), dtype=bool) for e in experiments}
    for channel, rows in now.channels.holds.items():
        part = now.channels.part(channel)
        place = slice(begin + part.start, begin + part.stop)
        usual = channel in before.channels.names
        had = np.isin(number[rows], logged) if channel in LOG else np.full(len(rows), usual)
        present[place] = had & (owner[rows] == "")
        for e in experiments:
            new = ~had & (owner[rows] == "") & (channel in e.channels)
            added[e.id][place] = new | (had & (owner[rows] == e.id))
    return present, added
