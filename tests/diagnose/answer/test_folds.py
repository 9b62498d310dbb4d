"""Folds from the data, and the plain statistics on them."""

from __future__ import annotations

from copy import copy
from dataclasses import replace

import numpy as np
import pytest
from gearheat.model.errors import SolveError
from gearheat.scenarios.load import load
from gearheat.scenarios.measured.card import Card
from gearheat.tools.diagnose.answer import gain
from gearheat.tools.diagnose.answer.channels import levels
from gearheat.tools.diagnose.answer.experiments import planned_campaign
from gearheat.tools.diagnose.answer.gain import schemes
from gearheat.tools.diagnose.answer.quality import group_rows
from gearheat.tools.diagnose.infer.found import Found
from gearheat.tools.diagnose.infer.problem import Aside, Problem
from gearheat.tools.diagnose.setting import Setting


def test_levels_are_where_the_gaps_are() -> None:
    values = np.array([100.1, 300.0, 99.8, 201.0, 299.5, 199.7])
    assert [rows.tolist() for rows in levels(values)] == [[0, 2], [3, 5], [1, 4]]
    assert len(levels(np.full(4, 7.0))) == len(levels(np.zeros(4))) == 1
    assert [rows.tolist() for rows in levels(np.array([100.1, 95.0, 99.7, 94.8]))] == [[1, 3], [0, 2]]


def test_a_speed_that_only_scatters_is_one(wrong: tuple[Setting, Found]) -> None:
    campaign = wrong[1].problem.data.campaign
    speed = next(s for s in campaign.given if s.kind == "speed")
    held = 150.0 + speed.repeat_sd * np.random.default_rng(1).standard_normal(campaign.n)
    still = replace(campaign, values=campaign.values | {speed.name: held})
    assert "speed" in group_rows(campaign)
    assert "speed" not in group_rows(still)
    assert len(levels(held)) == 1


def test_tests_of_one_running_order_stay_together(wrong: tuple[Setting, Found]) -> None:
    campaign = wrong[1].problem.data.campaign
    halves = replace(campaign, order=np.repeat([1.0, 2.0], campaign.n_tests // 2))
    found = group_rows(halves)["running order"]
    assert {name: len(rows) for name, rows in found.items()} == {"1 to 1": campaign.n // 2, "2 to 2": campaign.n // 2}
    days = group_rows(replace(campaign, order=20240101.0 + np.arange(campaign.n_tests)))["running order"]
    assert next(iter(days)) == "20240101 to 20240104" and sum(map(len, days.values())) == campaign.n


def test_a_row_that_cannot_be_run_is_named_by_its_line(
    wrong: tuple[Setting, Found], monkeypatch: pytest.MonkeyPatch
) -> None:
    o = copy(wrong[1].problem.data)
    o.campaign = replace(o.campaign, lines=o.campaign.lines[::-1])
    run = o.at
    monkeypatch.setattr(o, "at", lambda *at: replace(run(*at), shown=np.where(o.row == 3, np.nan, o.measured)))
    with pytest.raises(SolveError, match=f" line {o.campaign.n - 2}: the rig cannot be run there"):
        Problem([o], 0.01).look(np.zeros(len(o.nuisances) - 1))


def test_every_row_is_left_out_once(wrong: tuple[Setting, Found]) -> None:
    campaign = wrong[1].problem.data.campaign
    for folds in schemes(campaign).values():
        assert sorted(np.concatenate(folds)) == list(range(campaign.n))


def test_without_some_tests_all_else_is_as_it_was(wrong: tuple[Setting, Found]) -> None:
    found = wrong[1]
    whole, tests = found.problem, found.problem.data.campaign.test[found.problem.data.row]
    kept = np.flatnonzero(~np.isin(tests, [1, 2]))
    some = whole.without(frozenset({Aside(int(kept[3])), Aside(1, "n_sun")})).only(kept)
    assert some.aside == {Aside(3), Aside(1, "n_sun")}
    for z, acting in ((found.null.look.z, ()), (found.hypotheses[0].fit.look.z, found.hypotheses[0].fit.look.acting)):
        look, part = whole.look(z, acting), some.look(z, acting)
        np.testing.assert_allclose(part.shown, look.shown[kept], rtol=1e-12)
        np.testing.assert_allclose(part.jacobian, look.jacobian[kept], rtol=1e-9, atol=1e-12)
        noise = Problem([*some.campaigns], some.day_sd).noise(part)
        rest = whole.without(frozenset()).noise(look).covariance[np.ix_(kept, kept)]
        np.testing.assert_allclose(noise.covariance, rest, rtol=1e-9, atol=1e-12)


def test_a_large_campaign_is_grouped_by_its_own_levels() -> None:
    planetary = planned_campaign(load("planetary"), Card(), None)
    twice = replace(
        planetary,
        values={k: np.tile(v, 2) for k, v in planetary.values.items()},
        test=np.concatenate([planetary.test, planetary.test + planetary.n_tests]),
        order=np.arange(2.0 * planetary.n_tests),
        direction=np.tile(planetary.direction, 2),
        dwell=np.tile(planetary.dwell, 2),
        oil=("a",) * planetary.n_tests + ("b",) * planetary.n_tests,
    )
    found = schemes(twice)
    assert set(found) == {"leave-out-tests", "leave-one-speed", "leave-one-load", "leave-one-oil"}
    assert [len(found[name]) for name in ("leave-one-speed", "leave-one-load", "leave-one-oil")] == [4, 4, 2]
    for folds in found.values():  # both directions of a test stay together
        assert all(set(twice.test[rows]).isdisjoint(twice.test[np.setdiff1d(range(twice.n), rows)]) for rows in folds)


def test_rivals_are_exact_where_they_hold() -> None:
    kept = np.arange(20) % 4 > 0
    X = np.random.default_rng(1).normal(size=(20, 3))
    left = gain.fitted(np.column_stack([np.ones(20), X]), 2.0 + X @ [1.0, -2.0, 0.5], kept, 1e-9)
    assert np.abs(left).max() < 1e-6


def test_constant_cooling_needs_the_power_that_passes(wrong: tuple[Setting, Found]) -> None:
    """A second torque is no factor of it, and a speed alone is none."""
    o = copy(wrong[1].problem.data)
    known = {s.kind: s for s in o.given}
    rows, kept, power = np.arange(16), np.arange(16) % 4 > 0, o.sensors["n_input"] * o.sensors["T_output"]
    o.campaign = replace(o.campaign, values=o.campaign.values | {"T_oil": o.sensors["T_amb"] + power / power.max()})
    two = (*o.given, replace(known["torque"], name="T_second"))
    for given, says in ((two, True), ((known["speed"], known["ambient"]), False)):
        o.sensors = o.sensors | {"T_second": np.linspace(1.0, 2.0, 16)}
        o.campaign, o.given = replace(o.campaign, sensors=(*given, *o.read)), given
        left = gain.constant_cooling(o, 0, rows, kept)
        assert (left is not None and np.abs(left).max() < 1e-9) == says


def test_statistics_say_nothing_of_a_channel_with_a_single_reading(wrong: tuple[Setting, Found]) -> None:
    found = wrong[1]
    whole, folds = found.problem, schemes(found.problem.data.campaign)["leave-out-tests"]
    others = np.flatnonzero(whole.data.kind == 0)[1:].tolist()
    one = replace(found, problem=whole.without(frozenset(map(Aside, others))))
    held = [np.setdiff1d(np.flatnonzero(np.isin(whole.data.row, rows)), others) for rows in folds]
    sides = ("before", "after", "leading")
    errors = [gain.Foreseen(own, {side: np.ones((2, len(own))) for side in sides}, ()) for own in held]
    told = gain._gain(one, "leave-out-tests", folds, errors, 0, 0)
    assert told is not None
    assert (told.n, told.rivals) == (1, {})
