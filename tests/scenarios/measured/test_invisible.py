"""What a campaign cannot show, and why."""

from __future__ import annotations

import pytest
from gearheat.scenarios.measured.card import Card
from gearheat.scenarios.measured.checks import invisible
from gearheat.scenarios.measured.read import read_campaign
from gearheat.scenarios.shipped import RIGS


@pytest.fixture(scope="module")
def shipped(rig):
    return read_campaign(RIGS / "planetary" / "measured.csv", rig("planetary"), Card())


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
