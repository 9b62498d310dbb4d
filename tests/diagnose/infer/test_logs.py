"""Logs made by the rig itself: what was changed in a year is found, and where nothing was, nothing is."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from gearheat.scenarios.load import load
from gearheat.scenarios.measured.card import Card
from gearheat.scenarios.measured.logs import Log
from gearheat.scenarios.measured.table import Sensor
from gearheat.tools.diagnose.answer.findings import Findings
from gearheat.tools.diagnose.answer.numbers import as_object
from gearheat.tools.diagnose.infer.logs import Fleet, filter_of, fleet, question
from gearheat.tools.diagnose.library.knobs import moves
from gearheat.tools.diagnose.logs import LogDiagnosis, Logs, composed, formulas_of
from gearheat.tools.diagnose.request import Inputs, Request
from gearheat.tools.watch.expect import expect
from gearheat.tools.watch.judge import BAND, Judge
from made_logs import MACHINES, YEARS, differing, made

#: Samples of one stretch: a week; seasons of the healthy logs and of that in question.
N, PAST, ASKED = 1008, 4, 2
#: Seed of a year with a worn cooler, the knob that has moved, by how much and since when.
WORN = 200, "cooler: conductance", float(np.log(0.7)), 0.0


def sensors() -> tuple[Sensor, ...]:
    read = {"T_sump": ("sump.T", "oil_temp"), "T_inlet": ("line.T", "wall_temp")}
    read |= {"T_bearing1": ("bearing_1.T", "wall_temp"), "T_bearing2": ("bearing_2.T", "wall_temp")}
    given = {"n_hss": ("generator.w", "speed", "rpm"), "T_nacelle": ("nacelle.T", "ambient", "degC")}
    found = [Sensor(name, name, path, kind, "given", unit, 0.3, 0.3) for name, (path, kind, unit) in given.items()]
    found.append(Sensor("T_hss", "T_hss", "generator.tau", "torque", "given", "N.m", 20.0, 20.0, (-1.0, -1.0)))
    found += [Sensor(name, name, path, kind, "read", "degC", 0.3, 0.3) for name, (path, kind) in read.items()]
    return tuple(found)


class Farm:
    """A machine and two siblings: each with knobs of its own that differ a little from year to year."""

    def __init__(self) -> None:
        empty = np.zeros(0)
        self.scenario = load("wind_turbine")
        self.like = Log("made", sensors(), {}, empty, empty, 600.0, empty, True)
        self.filter = filter_of(self.scenario, self.like)
        self.filter.parts = 8
        rng = np.random.default_rng(5)
        self.machines = [differing(self.filter.knobs, rng, MACHINES) for _ in range(3)]
        past = [[self.log(m, q / 4, 10 * m + q) for q in range(PAST)] for m in range(3)]
        joined = [self.joined(logs, f"machine {m}") for m, logs in enumerate(past)]
        self.asked = cache(self._ask)
        self.fleet: Fleet = fleet(self.scenario, joined[:1], joined[1:], self.like)

    def log(self, machine: int, year: float, seed: int, change: np.ndarray | float = 0.0) -> Log:
        z = self.machines[machine] + differing(self.filter.knobs, np.random.default_rng([seed, machine]), YEARS)
        return made(self.filter, self.like, seed, year, N, z + change)

    def joined(self, logs: list[Log], name: str) -> Log:
        values = {key: np.concatenate([log.values[key] for log in logs]) for key in logs[0].values}
        time = np.concatenate([log.time for log in logs])
        stretch = np.repeat(np.arange(len(logs)), [log.n for log in logs])
        return replace(logs[0], name=name, values=values, time=time, stretch=stretch, lines=np.arange(2, len(time) + 2))

    def _ask(self, seed: int, name: str = "", size: float = 0.0, since: float = 0.0) -> LogDiagnosis:
        logs = [self.third_year(seed, name, size, since)]
        inputs = Inputs(Request("wind_turbine", quick=True), self.scenario, Card(), None, None, None)
        return composed(inputs, self.fleet, question(self.fleet, logs), Logs(logs))

    def third_year(self, seed: int, name: str = "", size: float = 0.0, since: float = 0.0) -> Log:
        """That of the first machine, in which a knob has moved in its last seasons."""
        change = np.zeros((ASKED, N, len(self.filter.knobs)))
        if name:
            change[int(since * ASKED) :, :, [k.name for k in self.filter.knobs].index(name)] = size
        parts = [self.log(0, 3.0 + q / 4, seed + q, change[q]) for q in range(ASKED)]
        return self.joined(parts, "asked")


@pytest.fixture(scope="module")
def farm() -> Farm:
    return Farm()


@pytest.mark.parametrize("seed", [100, 110])
def test_a_year_like_others_has_no_alarm(farm: Farm, seed: int) -> None:
    found = farm.asked(seed).findings
    assert found.nothing > 0.5
    assert found.verdict == "consistent"
    assert found.test.p_any > found.test.alpha


@pytest.mark.parametrize(
    ("name", "size", "since"),
    [
        WORN[1:],
        ("thermostat: set point", 4.0, 0.0),
        ("T_sump: offset", 3.0, 0.5),
    ],
)
def test_what_has_changed_is_found(farm: Farm, name: str, size: float, since: float) -> None:
    told = farm.asked(200, name, size, since)
    found = told.findings
    cause = next(k.cause for k in farm.filter.knobs if k.name == name)
    assert found.nothing < 0.1
    first = found.causes[0]
    assert (
        first.id == cause and first.probability > 0.6 and told.of(cause) == pytest.approx(first.probability, abs=1e-5)
    )
    assert first.forms[0].name.startswith(name)
    assert (first.forms[0].name != name) == bool(since)
    assert found.verdict in ("explained", "ambiguous")
    assert Findings.model_validate(as_object(found)).verdict == found.verdict
    (low, high), value = first.parameters[0].ci95, first.parameters[0].value
    assert value == pytest.approx(size, abs=high - low + 0.2 * abs(size))


def test_what_switches_has_no_curve(farm: Farm) -> None:
    curved = {farm.filter.knobs[j].name for j in farm.fleet.curves.of}
    assert "bearing_1_loss: loss" in curved and "cooler: conductance" not in curved


def test_what_logs_say_of_a_cause_is_free_of_its_prior(farm: Farm) -> None:
    found = farm.asked(*WORN).found
    assert found.log_bayes_factor(["cooling.cooler"]) > 3
    assert found.log_bayes_factor(["cooling.cooler", "losses.windage"]) == found.log_bayes_factor(["cooling.cooler"])
    assert found.log_bayes_factor([]) == found.log_bayes_factor(["losses.windage"]) == 0
    single = [h for h in found.hypotheses if h.causes == ("cooling.cooler",)]
    logs = [h.log_joint - found.prior(h.causes) for h in single]
    none = [h.log_joint - found.critical for h in found.hypotheses if not h.causes]
    expected = np.logaddexp.reduce(logs) - np.logaddexp.reduce(none)
    assert found.log_bayes_factor(["cooling.cooler"]) == pytest.approx(expected)


def test_a_cause_that_logs_were_not_asked_about_counts_as_one_like_it(farm: Farm) -> None:
    told, found = farm.asked(*WORN), {cause.id: cause for cause in moves(farm.filter.knobs)}
    preload = found["losses.bearing_preload"]
    assert told.asked(preload) == "losses.bearing_preload"
    alike = {id for id, cause in found.items() if cause.like == preload.like}
    assert told.asked(replace(preload, id="losses.bearing_friction")) in alike
    assert told.asked(replace(preload, id="losses.windage", like="")) == "losses.windage"


def test_the_picture_of_a_cause_shows_the_past_and_what_the_cause_takes_away(farm: Farm) -> None:
    told = farm.asked(*WORN).findings
    picture = told.pictures[0]
    days = np.array(told.rows.quantities[picture.quantity].values)
    before, after = np.array(picture.before), np.array(picture.after)
    past, now = days < 0, days >= 0
    assert past.any() and now.any() and (np.diff(days) >= 0).all()
    np.testing.assert_array_equal(before[past], after[past])
    assert np.mean(after[now] ** 2) < 0.5 * np.mean(before[now] ** 2)
    shown = told.rows.channels[picture.channel]
    assert np.array(shown.measured) - np.array(shown.nominal) == pytest.approx(before, abs=1e-3)


def test_a_watch_says_of_a_log_what_the_diagnosis_says(farm: Farm, monkeypatch: pytest.MonkeyPatch) -> None:
    told = farm.asked(*WORN)
    log = farm.third_year(*WORN)
    judge = Judge(Inputs(Request("wind_turbine"), farm.scenario, Card(), None, None, None))
    monkeypatch.setattr(judge, "log", lambda *said: log)
    monkeypatch.setattr(judge, "known", lambda log: (farm.fleet, formulas_of(farm.fleet, log)))
    said = judge.answer("asked", "", [], [])
    assert said["changed"] == round(1 - told.findings.nothing, 4)
    assert said["causes"][0]["id"] == told.findings.causes[0].id == "cooling.cooler"
    sump = said["readings"]["T_sump"]
    assert sump["measured"] == pytest.approx(log.values["T_sump"][-N // 4 :].mean() - 273.15, abs=1e-3)
    assert sump["low"] < sump["predicted"] < sump["high"]


def test_healthy_windows_lie_in_their_bands(farm: Farm) -> None:
    inside = []
    for k in range(0, len(farm.fleet.past.time), 2):
        last = expect(farm.fleet, farm.fleet.past.some(np.array([k])))
        inside.append(np.abs(last.measured - last.predicted) < BAND * last.sd)
    assert 0.85 < np.mean(inside) <= 1.0
