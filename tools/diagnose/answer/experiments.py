"""Campaigns before they are run, and experiments that may follow one.

A campaign is the points of a table or a grid over the rig's range, with the readings the model gives. Experiments are
further tests, logged warm-ups, and instruments read where the truth is known.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from ....model.errors import DataError
from ....scenarios.measured.card import Card
from ....scenarios.measured.nominal import Nominal, drive_by
from ....scenarios.measured.sensors import sensors_of
from ....scenarios.measured.table import Campaign, Sensor
from ....scenarios.scenario import Scenario

#: The coldest that a hall can be kept [K].
COLDEST = 278.15
#: How much colder than in the campaign a cold room is [K].
COLDER = 15.0
#: A room that is not this much colder is none [K].
LEAST_COLDER = 5.0
#: A low speed over the least of the campaign.
SLOWER = 0.4
#: A high speed over the largest of the campaign, where the rig is made for it.
FASTER = 1.6
#: What a high speed has to be at least over the largest of the campaign.
LEAST_FASTER = 1.1
#: A low load over the least of the campaign.
LIGHTER = 0.2
#: Loads at a high speed and at a low one, over the largest of the campaign.
FAST_LOADS = (0.25, 0.45, 0.6, 0.75)
SLOW_LOADS = (0.6, 0.75, 0.9, 1.0)
#: Samples of a logged dwell.
SAMPLES = 8
#: Its length where the campaign holds steady states [s].
DWELL = 4 * 3600.0
#: Temperatures of a bath [K].
BATH = (293.15, 333.15)
#: Scatter in it.
BESIDE = 0.05
#: Accuracy of a reference thermometer [K].
THERMOMETER = 0.1
#: Of a tare (share of the sensor's own scatter).
TARE = 0.3
#: Of a stroboscope (share of the speed).
STROBOSCOPE = 5e-4
#: Speeds and loads of the grid.
SPEEDS = (0.4, 0.6, 0.8, 1.0)
#: As shares of those at the operating point.
LOADS = (0.55, 0.7, 0.85, 1.0)
#: A change of the room along it [K].
ROOM = 4.0
#: Dwells where power flows both ways and no card says it [min].
DWELLS = (240.0, 90.0)


@dataclass(frozen=True)
class Check:
    """A sensor read where the truth is known.

    Args:
        sensor: its name
        true: truth in each reading (n,) [SI]
        sd: scatter from reading to reading; `standard`: of the truth, the same in all readings
    """

    sensor: str
    true: tuple[float, ...]
    sd: float
    standard: float = 0.0


@dataclass(frozen=True)
class Experiment:
    """Tests at the end of a campaign, run as its first one, and checks of instruments.

    Args:
        id: stable identifier
        what: it in words
        tests: kind of given sensor -> magnitude [SI], of each test; others are left as they are
        logged: whether each dwell is logged, not read at its end alone
        checks: instruments
    """

    id: str
    what: str
    tests: tuple[Mapping[str, float], ...] = ()
    logged: bool = False
    checks: tuple[Check, ...] = ()


def list_experiments(campaign: Campaign, usual: Callable[[str], float]) -> tuple[Experiment, ...]:
    """The experiments that add something to a campaign, and that its rig and a hall can do.

    Args:
        campaign: the data
        usual: value of a path at the operating point of the rig; no speed beyond this and the campaign's is proposed
    """
    speed = campaign.driving("speed")
    fastest = abs(usual(speed.reads)) if speed else 0.0
    doubtful = replace(campaign, sensors=tuple(s for s in campaign.sensors if not s.checked))
    return (*_tests(campaign, fastest), *_checks(doubtful))


def _tests(campaign: Campaign, fastest: float) -> Iterator[Experiment]:
    speed, load, room = (campaign.range_of(kind) for kind in ("speed", "torque", "ambient"))
    speeds = [{"speed": n} for n in dict.fromkeys(speed)] if speed else [{}]
    loads = [{"torque": tau} for tau in dict.fromkeys(load)] if load else [{}]
    corners = tuple(n | tau for n in speeds for tau in loads)
    if room is not None and (cold := max(COLDEST, room[0] - COLDER)) < room[0] - LEAST_COLDER:
        text = f"the corners of the campaign in a room of {cold - 273.15:.0f} degC"
        yield Experiment("cold_room", text, tuple(test | {"ambient": cold} for test in corners))
    if load is not None:
        least = LIGHTER * load[0] if load[0] > 0.05 * load[1] else 0.05 * load[1]
        middle = [{"speed": float(n)} for n in np.linspace(*speed, 4)] if speed else [{}]
        text = f"{len(middle)} points at {least:.3g} N.m"
        yield Experiment("low_load", text, tuple(n | {"torque": least} for n in middle))
    if speed is not None:
        tried = [("low_speed", SLOWER * speed[0], SLOW_LOADS)]
        if fastest > LEAST_FASTER * speed[1]:
            tried.insert(0, ("high_speed", min(FASTER * speed[1], fastest), FAST_LOADS))
        for name, n, shares in tried:
            own = [{"torque": share * load[1]} for share in shares] if load else [{}]
            text = f"{len(own)} points at {n * 30 / np.pi:.0f} rpm"
            yield Experiment(name, text, tuple({"speed": n} | tau for tau in own))
    yield Experiment("repeat", "the corners of the campaign again", corners)
    yield Experiment("transients", "the warm-up logged at the corners of the campaign", corners, logged=True)


def _checks(campaign: Campaign) -> Iterator[Experiment]:
    if bath := tuple(Check(s.name, BATH, BESIDE) for s in campaign.read if s.kind.endswith("_temp")):
        yield Experiment("bath", "all thermometers in one bath, at 20 and at 60 degC", checks=bath)
    if torques := [s for s in campaign.sensors if s.kind == "torque"]:
        tare = tuple(Check(s.name, (0.0,) * 3, TARE * s.repeat_sd) for s in torques)
        yield Experiment("tare", "a tare of all torque transducers", checks=tare)
        top = {s.name: float(np.nanmax(np.abs(campaign.values[s.name]))) for s in torques}
        lever = tuple(Check(s.name, (0.0, top[s.name]), TARE * s.repeat_sd, 5e-4 * top[s.name]) for s in torques)
        yield Experiment("lever_arm", "all torque transducers under a lever arm, empty and loaded", checks=lever)
    means = {s.name: float(np.nanmean(np.abs(campaign.values[s.name]))) for s in campaign.given}
    of_kind = {kind: [s for s in campaign.given if s.kind == kind] for kind in ("ambient", "speed")}
    if rooms := tuple(Check(s.name, (means[s.name],) * 4, s.repeat_sd, THERMOMETER) for s in of_kind["ambient"]):
        yield Experiment("room_probe", "a reference thermometer for the room, away from the machine", checks=rooms)
    if speeds := tuple(Check(s.name, (means[s.name],) * 2, STROBOSCOPE * means[s.name]) for s in of_kind["speed"]):
        yield Experiment("stroboscope", "the speed by a stroboscope", checks=speeds)


def build_tests(campaign: Campaign, experiment: Experiment) -> Campaign:
    """The tests of an experiment as a campaign of their own, run as the first test of a campaign.

    Readings of compared sensors stand at their means, and only say what is read.
    """
    template = np.flatnonzero(campaign.test == 0)
    pieces = SAMPLES if experiment.logged else 1
    rows = np.repeat(template, pieces)
    n, k = len(rows), len(experiment.tests)
    first = np.tile(np.arange(n) % pieces == 0, k)
    dwell = np.where(np.isinf(campaign.dwell[rows]), DWELL if pieces > 1 else np.inf, campaign.dwell[rows]) / pieces
    stop = np.where(first, np.tile(campaign.stop[rows], k), 0.0)
    values = {s.name: np.full(n * k, float(np.nanmean(campaign.values[s.name]))) for s in campaign.read}
    for s in campaign.given:
        own = campaign.values[s.name][rows]
        main = campaign.driving(s.kind)
        scale = [test.get(s.kind) for test in experiment.tests]
        usual = float(np.nanmean(np.abs(campaign.values[main.name][rows]))) if main else 1.0
        share = own / usual if usual else np.full(n, float(np.sign(np.nansum(campaign.values[s.name])) or 1.0))
        wanted = [own if v is None else own + v - usual if s.kind == "ambient" else share * v for v in scale]
        values[s.name] = np.concatenate(wanted)
    return Campaign.of(
        campaign.name,
        campaign.sensors,
        values,
        np.repeat(np.arange(k), n),
        order=np.full(k, float(campaign.order.max())),
        direction=np.tile(campaign.direction[rows], k),
        dwell=np.tile(dwell, k),
        stop=stop,
        oil=(campaign.oil[0],) * k,
        mounting=(campaign.mounting[0],) * k,
        points=np.zeros(n * k, dtype=int),
        start_by_room=campaign.start_by_room,
        room_begin=campaign.room_begin,
    )


def planned_campaign(scenario: Scenario, card: Card, points: Campaign | None) -> Campaign:
    """Conditions, a grid of 4 x 4 points where none are given, with the readings of the rig as in its file.

    Raises:
        DataError: the rig has no sensor, or cannot be run at any point
    """
    sensors = sensors_of(scenario, card)
    if not any(s.role == "read" for s in sensors):
        raise DataError(f"{scenario.name}: no sensor is compared. Declare one under [sensors] in the rig file.")
    nominal = Nominal(drive_by(scenario, sensors))
    campaign = _grid(scenario, card, sensors, nominal) if points is None else points
    missing = [s for s in sensors if s.role == "read" and s.name not in campaign.values]
    return _answered(campaign, missing, nominal)


def _grid(scenario: Scenario, card: Card, sensors: tuple[Sensor, ...], nominal: Nominal) -> Campaign:
    """Speeds and loads in a mixed running order, both directions in each test where the rig's tests have them."""
    protocol, given = scenario.protocol, [s for s in sensors if s.role == "given"]
    directions = np.array([1.0, -1.0]) if protocol else np.zeros(1)
    grid = np.array(list(product(SPEEDS, LOADS)))
    rows, n = len(directions), len(grid)
    shares = {"speed": 0, "torque": 1, "power": 1}
    order = (np.arange(n) * 7) % n  # neighbours of the grid are no neighbours in time
    place = np.repeat(grid[order], rows, axis=0)
    values = {}
    for s in given:
        full = nominal.value(s.reads) / s.sign(np.ones(1))[0]
        share = place[:, shares[s.kind]] if s.kind in shares else np.ones(n * rows)
        drift = ROOM * (np.arange(n * rows) / (n * rows) - 0.5) if s.kind == "ambient" else 0.0
        values[s.name] = full * share + drift
    minutes = card.protocol.dwell_min or list(DWELLS)
    dwell = [60.0 * minutes[min(k, len(minutes) - 1)] for k in range(rows)] if protocol else [np.inf]
    stop = np.tile([0.0] + [protocol.stop if protocol else 0.0] * (rows - 1), n)
    name, test = f"grid of {len(SPEEDS)} x {len(LOADS)} points", np.repeat(np.arange(n), rows)
    direction = np.tile(directions, n)
    return Campaign.of(name, given, values, test, direction=direction, dwell=np.tile(dwell, n), stop=stop)


def _answered(campaign: Campaign, missing: Sequence[Sensor], nominal: Nominal) -> Campaign:
    """The campaign with compared sensors that it lacks, which show what the model does in steady states."""
    found = {s.name: np.full(campaign.n, np.nan) for s in missing}
    given = {s.reads: campaign.values[s.name] * s.sign(campaign.direction) for s in campaign.given}
    for row in range(campaign.n):
        at = nominal.at({path: float(column[row]) for path, column in given.items()})
        for s in missing:
            found[s.name][row] = s.sign(campaign.direction)[row] * at[s.reads] if at is not None else np.nan
    if missing and not any(np.isfinite(column).any() for column in found.values()):
        raise DataError(f"{campaign.name}: the rig has no steady state at any of the points. Give milder ones.")
    return replace(campaign, sensors=(*campaign.sensors, *missing), values={**campaign.values, **found})
