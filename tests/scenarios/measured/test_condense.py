"""Large campaigns become small ones that say the same of every condition."""

from dataclasses import replace

import numpy as np
import pytest
from gearheat.scenarios.measured.card import Card
from gearheat.scenarios.measured.condense import LARGE, LEFT, condensed
from gearheat.scenarios.measured.table import Campaign, Sensor

#: Tests, each a row forwards and one backwards; speeds [rad/s].
TESTS, SPEEDS = 200, (10.0, 20.0, 30.0)


def campaign(tests: int = TESTS) -> Campaign:
    """Steady readings at three speeds in turn, whose thermometers follow speed, direction and room."""
    rng, n = np.random.default_rng(4), 2 * tests
    sensors = [Sensor("n", "n", "input.w", "speed", "given", "rad/s", 0.01, 0.1)]
    sensors.append(Sensor("T_room", "T_room", "room.T", "ambient", "given", "degC", 0.3, 0.3))
    sensors += [Sensor(f"T{k}", f"T{k}", "oil.T", "oil_temp", "read", "degC", 0.4, 0.3) for k in range(4)]
    speed, room = np.repeat(np.resize(SPEEDS, tests), 2), np.repeat(295.0 + rng.normal(0.0, 2.0, tests), 2)
    direction = np.resize([1, -1], n)
    values = {"n": speed + rng.normal(0.0, 0.01, n), "T_room": room}
    values |= {f"T{k}": room + speed + direction + rng.normal(0.0, 0.4, n) for k in range(4)}
    return Campaign.of("made.csv", sensors, values, np.repeat(np.arange(tests), 2), direction=direction)


def test_like_tests_are_joined_and_say_the_same() -> None:
    whole, card = campaign(), Card()
    assert whole.n * len(whole.read) > LARGE
    found, own = condensed(whole, card)
    assert found.n * len(found.read) <= LEFT and found.n == 2 * found.n_tests
    np.testing.assert_array_equal(found.direction, np.resize([1, -1], found.n))
    assert (np.diff(found.order) >= 0).all() and found.test.tolist() == np.repeat(range(found.n_tests), 2).tolist()
    speed = found.values["n"]
    assert np.abs(speed[:, None] - SPEEDS).min(axis=1).max() < 0.02  # no two speeds in one
    rise = found.values["T0"] - found.values["T_room"] - speed - found.direction
    each, before = found.sensor("T0").repeat_sd, whole.sensor("T0").repeat_sd
    assert 0.1 * before < each < 0.6 * before
    assert np.std(rise) < 2.0 * each
    assert own.day_cooling_sd == pytest.approx(card.day_cooling_sd * each / before)
    assert any("400 readings are many" in text for text in found.warnings)


def test_a_wrong_reading_and_missing_ones_leave_no_trace() -> None:
    whole = campaign()
    wrong = whole.values["T1"].copy()
    wrong[7] += 500.0
    wrong[20:40] = np.nan
    found, _ = condensed(replace(whole, values={**whole.values, "T1": wrong}), Card())
    plain, _ = condensed(whole, Card())
    assert np.abs(found.values["T1"] - plain.values["T1"]).max() < 3.0


def test_small_campaigns_stay_as_they_are() -> None:
    small, card = campaign(20), Card()
    assert condensed(small, card) == (small, card)
