"""Experiments that may follow a campaign: further tests, further instruments, checks of those that are there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .campaign_model import CampaignModel
from .checks import Check, at_rest, first_of

#: Speed [rpm], magnitude of the torque [N.m] and room [degC] of a test.
Point = tuple[float, float, float]
#: Channels that only the log of a test has.
LOG = ("T_oil course", "T_wall course", "dwell")
#: A cold room [degC], and how much colder than in the campaign it is at least [K].
COLD, COLDER = 5.0, 15.0
#: Speeds and torques outside of the campaign's range, as shares of its least or largest.
SLOWER, FASTER, LIGHTER = 0.4, 1.6, 0.2
FAST_TORQUES, SLOW_TORQUES = (0.25, 0.45, 0.6, 0.75), (0.6, 0.75, 0.9, 1.0)
#: Scatter of probes in a bath, of the room probe beside a better one [K], of a tare [N.m], of a stroboscope; accuracy
#: of a reference thermometer [K] and of a lever arm.
BATH, BESIDE, TARE, STROBOSCOPE = 0.05, 0.3, 0.3, 2e-3
THERMOMETER, LEVER = 0.1, 5e-4


@dataclass(frozen=True)
class Candidate:
    """An experiment.

    Args:
        id: stable identifier
        what: it in words
        points: tests at the end of the campaign, run as its first one was
        channels: what all tests of the campaign show beside what they do: T_oil2, what a log has, humidity
        checks: instruments read where the truth is known
    """

    id: str
    what: str
    points: tuple[Point, ...] = ()
    channels: tuple[str, ...] = ()
    checks: tuple[Check, ...] = ()


def candidates(model: CampaignModel) -> tuple[Candidate, ...]:
    """The experiments that add something to a campaign."""
    return (*_tests(model), *_instruments(model), *_checks(model))


def _tests(model: CampaignModel) -> tuple[Candidate, ...]:
    n = [r.values["n_carrier_rpm"] for r in model.readings]
    tau = [r.values["T_carrier_Nm"] for r in model.readings]
    room = float(np.mean([r.values["T_amb_C"] for r in model.readings]))
    slow, fast, light, heavy = _near(min(n), 10), _near(max(n), 10), _near(min(tau), 50), _near(max(tau), 50)
    corners = [(a, b) for a in (slow, fast) for b in (light, heavy)]
    low, high, least = _near(SLOWER * slow, 10), _near(FASTER * fast, 10), _near(LIGHTER * light, 50)
    usual, cold = float(round(room)), min(COLD, round(room - COLDER))
    first = model.readings[0].values
    again = (first["n_carrier_rpm"], first["T_carrier_Nm"], first["T_amb_C"])
    return (
        Candidate("cold_room", f"four points in a room of {cold:g} degC", tuple((*c, cold) for c in corners)),
        Candidate(
            "low_load",
            f"four points at {least:g} N.m",
            tuple((_near(v, 10), least, usual) for v in np.linspace(slow, fast, 4)),
        ),
        Candidate(
            "high_speed",
            f"four points at {high:g} rpm",
            tuple((high, _near(share * heavy, 50), usual) for share in FAST_TORQUES),
        ),
        Candidate(
            "low_speed",
            f"four points at {low:g} rpm",
            tuple((low, _near(share * heavy, 50), usual) for share in SLOW_TORQUES),
        ),
        Candidate("repeat", "four points of the grid again", tuple((*c, usual) for c in corners)),
        Candidate("first_again", "the first point again at the end of the campaign", (again,)),
    )


def _instruments(model: CampaignModel) -> tuple[Candidate, ...]:
    found = []
    if not all(model.logged):
        found.append(Candidate("transients", "a log of the warm-up in all tests", channels=LOG))
    if not all(r.given("T_oil2_C") for r in model.readings):
        found.append(Candidate("second_probe", "a second probe in the oil in all tests", channels=("T_oil2",)))
    if model.rows.humidity is None:
        found.append(Candidate("humidity", "humidity of the room logged in all tests", channels=("humidity",)))
    return tuple(found)


def _checks(model: CampaignModel) -> tuple[Candidate, ...]:
    bath = [Check(p, BATH, at_rest(T=T), T) for p in ("T_oil", "T_oil2", "T_wall", "T_amb") for T in (293.15, 333.15)]
    orders = model.rows.per_test(model.rows.order)
    torque = max(r.values["T_carrier_Nm"] for r in model.readings)
    tare, tares = Check("loss", TARE, at_rest()), Check("loss", TARE, at_rest(len(orders), order=orders))
    lever = Check("loss", TARE, at_rest(tau=torque), standard=LEVER * torque)
    beside = Check("T_amb", BESIDE, first_of(model.rows, model.n), standard=THERMOMETER)
    return (
        Candidate("bath", "all probes in one bath, at 20 and at 60 degC", checks=tuple(bath)),
        Candidate("room_probe", "a reference thermometer for the room, out of the gearbox's warmth", checks=(beside,)),
        Candidate("tare", "a tare of both torque transducers", checks=(tare,)),
        Candidate("tares", "a tare of both torque transducers before each test", checks=(tares,)),
        Candidate("lever_arm", "both torque transducers under a lever arm, empty and loaded", checks=(tare, lever)),
        Candidate("stroboscope", "the speed by a stroboscope", checks=(Check("speed", STROBOSCOPE, at_rest()),)),
    )


def _near(value: float, step: float) -> float:
    """The nearest multiple of a step, not zero."""
    return float(max(round(value / step), 1) * step)
