"""Repeated points in running order, and what a campaign cannot show."""

from __future__ import annotations

import numpy as np
import pytest
from gearheat.diagnose.campaign.card import Card
from gearheat.diagnose.campaign.invisible import invisible
from gearheat.diagnose.campaign.read import read_campaign
from gearheat.diagnose.campaign.repeats import repeats, scatters
from gearheat.scenarios.load import RIGS


@pytest.fixture(scope="module")
def shipped(rig):
    return read_campaign(RIGS / "planetary" / "measured.csv", rig("planetary"), Card())


def test_the_shipped_campaign_repeats_five_points(shipped):
    found = repeats(shipped)
    assert sorted(tuple(group.order.astype(int)) for group in found) == [(5, 18), (6, 19), (13, 17), (14, 20), (15, 21)]
    for group in found:
        assert group.mounting == ("PAOR-16", "PAOR-5") and group.oil == "PAOR"
    oil, sun = (next(s for s in scatters(shipped, found) if s.sensor == name) for name in ("T_oil", "T_sun"))
    assert oil.freedom == 5 and oil.total > 2 * oil.stated > 0.5
    assert np.isfinite([oil.difference, sun.total, sun.difference]).all()


def test_sum_and_difference_of_the_directions(shipped):
    group = next(g for g in repeats(shipped) if 13 in g.order)
    for k, order in enumerate(group.order):
        rows = np.flatnonzero(shipped.test == np.flatnonzero(shipped.order == order)[0])
        rise = (shipped.values["T_oil"] - shipped.values["T_amb"])[rows]
        assert group.total["T_oil"][k] == pytest.approx(rise.mean())
        assert group.difference["T_oil"][k] == pytest.approx((rise[0] - rise[1]) / 2)


def test_scatter_of_white_noise_is_that_of_the_card(read, helical):
    rng = np.random.default_rng(3)
    columns = {c: v * 12 for c, v in helical.items()}
    for column, sd in (("T_oil_C", 0.35), ("T_wall_C", 0.35), ("T_amb_C", 0.3)):
        columns[column] = [round(v + sd * rng.standard_normal(), 3) for v in columns[column]]
    found = read("helical_two_stage", columns)
    groups = repeats(found)
    assert len(groups) == 6 and all(len(g.order) == 12 for g in groups)
    for scatter in scatters(found, groups):
        assert scatter.freedom == 66 and scatter.total == pytest.approx(scatter.stated, rel=0.25), scatter.sensor
        assert np.isnan(scatter.difference)


def test_points_that_are_not_repeated_say_nothing(read, helical):
    found = read("helical_two_stage", helical)
    assert not repeats(found)
    assert all(np.isnan(s.total) and s.freedom == 0 for s in scatters(found, ()))


def test_missing_columns_make_causes_invisible(shipped, read, helical):
    assert {"cooling.humidity", "thermal.mass"} == set(invisible(shipped))
    assert set(invisible(shipped, logged=True)) == {"cooling.humidity"}
    found = invisible(read("helical_two_stage", helical))
    assert {
        "procedure.day_scatter", "losses.mesh_direction", "sensor.oil_temp.by_direction", "sensor.torque.mounting",
        "losses.torque_only", "procedure.not_stationary", "sensor.oil_temp.position",
    } <= set(found)  # fmt: skip
    assert "sensor.torque.gain" not in found and "losses.churning" not in found
    assert "cooling.contact" not in found


def test_one_speed_and_one_torque_hide_causes(read, helical):
    kept = [0, 0, 0, 0]
    columns = {c: [v[k] + 0.3 * i * (c[-2:] == "_C") for i, k in enumerate(kept)] for c, v in helical.items()}
    found = invisible(read("helical_two_stage", columns))
    assert "one speed only" in found["losses.churning"] and "one torque only" in found["sensor.torque.gain"]
