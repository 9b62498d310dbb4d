from __future__ import annotations

import math

import numpy as np
import pytest
from gearheat.model.errors import DataError
from gearheat.scenarios.measured.logs import Log
from gearheat.scenarios.measured.table import Sensor
from gearheat.tools.compare.errors import compare, noise_floor, repeats, rivals
from gearheat.tools.compare.replay import Rivals

DRIVES = ("n_carrier_rpm", "T_carrier_Nm")


def test_errors_are_simulated_minus_measured(rows):
    found = {(g.by, g.channel): g for g in compare(rows).groups if g.by == "all"}
    assert found["all", "T_oil_K"].mean == pytest.approx(2.0)
    assert found["all", "T_wall_K"].mean == pytest.approx(-1.0)
    assert found["all", "loss_Nm"].rms == pytest.approx(1.0)
    assert found["all", "T_oil_K"].n == 24


def test_rmse_is_given_overall_and_per_grid(rows):
    rows[0]["T_oil_C"] += 3.0
    rmse = compare(rows).rmse()
    assert rmse["overall"]["T_oil_K"] == pytest.approx(math.sqrt((23 * 4 + 25) / 24))
    assert rmse["B-grid"]["T_oil_K"] == pytest.approx(2.0)
    assert set(rmse) == {"overall", "A-grid", "B-grid"}
    assert set(rmse["overall"]) == {"T_oil_K", "T_oil2_K", "T_wall_K", "loss_Nm"}


def test_groups_cover_speed_torque_oil_and_direction(rows):
    groups = compare(rows).groups
    for by in ("grid", "n_set_rpm", "T_set_Nm", "oil", "direction"):
        assert sum(g.n for g in groups if g.by == by and g.channel == "loss_Nm") == len(rows)
    assert [g.value for g in groups if g.by == "n_set_rpm" and g.channel == "loss_Nm"] == [100.0, 200.0, 250.0]


@pytest.fixture
def repeated(rows):
    """Rows whose repeated point is simulated alike both times, and measured 0.4 apart."""
    for twin, row in zip(rows[:2], rows[-2:], strict=True):
        row |= {name: twin[name] for name in ("T_oil_C", "T_oil2_C", "T_wall_C", "loss_Nm")}
    return rows


def test_noise_floor_is_the_pooled_deviation_of_repeated_points(repeated):
    floor = noise_floor(repeated)
    assert floor["repeated"] == [[1, 12]]
    assert floor["readings"] == 4
    assert floor["T_oil_K"] == pytest.approx(0.4 / math.sqrt(2))
    assert floor["loss_Nm"] == pytest.approx(0.4 / math.sqrt(2))


def test_what_the_simulation_explains_is_no_noise(rows):
    """A warmer room makes thinner oil: it warms less than the room, and loses less."""
    for row in rows[-2:]:
        row["T_amb_C"] += 3.0
        for name, change in (("T_oil_C", 2.1), ("T_oil2_C", 2.1), ("T_wall_C", 2.4), ("loss_Nm", -0.3)):
            row[name] += change
            row[f"{name}_meas"] += change
    floor = noise_floor(rows)
    assert floor["repeated"] == [[1, 12]]
    assert [floor[key] for key in ("T_oil_K", "T_wall_K", "loss_Nm")] == pytest.approx([0.0] * 3, abs=1e-12)


def test_points_in_rooms_far_apart_do_not_repeat_each_other(repeated):
    for row in repeated[-2:]:
        row["T_amb_C"] += 10.0
    assert noise_floor(repeated)["repeated"] == []
    for row in repeated:
        del row["T_amb_C"]
    assert noise_floor(repeated)["repeated"] == [[1, 12]]


def test_noise_floor_of_three_readings_pools_their_variance(repeated):
    rows = repeated
    rows.append({**rows[0], "test": 99, "loss_Nm_meas": rows[0]["loss_Nm_meas"] + 1.0})
    values = [0.0, 0.4, 1.0]
    mean = sum(values) / 3
    expected = math.sqrt((sum((v - mean) ** 2 for v in values) + 0.4**2 / 2) / 3)
    assert len(repeats(rows)) == 2
    assert noise_floor(rows)["loss_Nm"] == pytest.approx(expected)


def test_without_repeated_points_there_is_no_noise_floor(rows):
    floor = noise_floor(rows[:10])
    assert "T_oil_K" not in floor
    assert floor["repeated"] == []


def test_rows_without_a_measured_channel_leave_it_out(rows):
    for row in rows:
        del row["T_oil2_C_meas"]
    assert "T_oil2_K" not in compare(rows).rmse()["overall"]


def test_rows_with_nothing_measured_are_refused():
    with pytest.raises(DataError, match="nothing to compare"):
        compare([{"test": 1, "T_oil_C": 50.0}])


def test_linear_rival_finds_the_plane_it_was_given(rows):
    linear = {score.name: score for score in rivals(rows[:22], DRIVES)}["linear"]
    assert linear.coefficients["T_oil_K"] == pytest.approx([5.0, 0.1, 0.005])
    assert linear.in_sample["T_oil_K"] == pytest.approx(0.0, abs=1e-9)
    assert linear.leave_one_test_out["loss_Nm"] == pytest.approx(0.0, abs=1e-9)


def test_leaving_out_costs_more_than_fitting(rows):
    for score in rivals(rows, DRIVES):
        for channel, error in score.in_sample.items():
            assert score.leave_one_test_out[channel] >= error


def test_leave_one_test_out_drops_both_directions(rows):
    rows = rows[:22]
    for row in rows:
        if row["test"] == 3:
            row["loss_Nm_meas"] += 100.0
    linear = {score.name: score for score in rivals(rows, DRIVES)}["linear"]
    assert linear.leave_one_test_out["loss_Nm"] > math.sqrt(2 * 100.0**2 / 22)
    others = [row for row in rows if row["test"] != 3]
    assert {s.name: s for s in rivals(others, DRIVES)}["linear"].in_sample["loss_Nm"] == pytest.approx(0.0, abs=1e-9)


def test_constant_alpha_a_is_power_over_rise(rows):
    for row in rows:
        for name in ("T_oil_C_meas", "T_oil2_C_meas", "T_wall_C_meas"):
            row[name] = row["T_amb_C"] + row["P_loss_W"] / 15.9
        row["loss_Nm_meas"] = 0.012 * row["T_carrier_Nm"]
    score = {s.name: s for s in rivals(rows, DRIVES)}["constant_alphaA"]
    assert 1 / score.coefficients["T_oil_K"][0] == pytest.approx(15.9)
    assert score.coefficients["loss_Nm"][0] == pytest.approx(0.012)
    assert score.in_sample["T_wall_K"] == pytest.approx(0.0, abs=1e-9)


def test_the_rival_of_one_node_finds_a_body_that_is_one():
    """In two stretches that begin in balance; a tenth of its readings is missing, and one input stands still."""
    rng, n, names, decay = np.random.default_rng(0), 800, ("a", "b", "c"), 0.93
    u = np.column_stack([rng.uniform(0.0, 50.0, n), rng.uniform(0.0, 20.0, n), np.full(n, 3.0)])
    drive, stretch, true = u @ (0.4, -0.05, 0.0) + 18.0, np.arange(n) // 500, np.empty(n)
    for k in range(n):
        true[k] = decay * true[k - 1] + drive[k] if k % 500 else drive[k] / (1 - decay)
    read = np.where((rng.random(n) < 0.1) & (np.arange(n) % 500 > 0), np.nan, true)
    sensors = tuple(Sensor(name, name, f"{name}.T", "wall_temp", "given", "K", 0.1, 0.1) for name in (*names, "y"))
    values = dict(zip((*names, "y"), (*u.T, read), strict=True))
    log = Log("made", sensors, values, 600.0 * np.arange(n), stretch, 600.0, np.arange(n), dated=False)
    rival = Rivals(log, names, ["y"])
    assert rival.one_node(rival.node[0], u[500:], true[500]) == pytest.approx(true[500:], abs=0.01)
