"""The command `losses`: its rows and columns; `verify` compares them with the breakdown of the source's own model."""

from __future__ import annotations

import functools
import json
from typing import Any

import pytest
from gearheat.tools.cli.app import app
from typer.testing import CliRunner

PARTS = ("P_mesh_W", "P_trb_W", "P_dgb_W", "P_needle_W", "P_seal_W")


@pytest.fixture(scope="module")
def losses():
    """Rows of the command by power flow and further options, each computed once."""

    @functools.cache
    def rows(*options: str) -> list[dict[str, Any]]:
        result = CliRunner().invoke(app, ["losses", "planetary", "--json", "-", *options])
        assert result.exit_code == 0, result.stderr
        return json.loads(result.stdout)["rows"]

    return rows


IDEAL = ("--temperature", "measured", "--power-flow", "ideal")


def test_rows_carry_the_keys_that_programs_read(losses):
    keys = (
        "point,P_mesh_W,P_trb_W,P_dgb_W,P_needle_W,P_seal_W,P_churn_W,P_total_W,mu_sp,mu_pr,Lambda_sp,Lambda_pr,"
        "alphaA_W_K,test,direction"
    )
    rows = losses(*IDEAL)
    assert len(rows) == 72
    assert set(keys.split(",")) <= rows[0].keys()
    for row in rows:
        parts = sum(row[name] for name in (*PARTS, "P_churn_W"))
        assert row["P_total_W"] == pytest.approx(parts, rel=1e-9)


def test_alpha_a_is_the_total_over_the_rise(losses):
    row = losses(*IDEAL)[0]
    assert row["alphaA_W_K"] == pytest.approx(row["P_total_W"] / (43.26 - 25.18), rel=1e-9)


def test_losses_in_the_power_flow_change_the_mesh_loss_in_opposite_ways(losses):
    """The carrier's torque is given: less reaches the teeth of the multiplier, more has come through the reducer's."""
    ideal, successive = losses(*IDEAL), losses("--power-flow", "successive")
    for i in (0, 1):
        assert ideal[i]["direction"] == i + 1
    assert successive[0]["P_mesh_W"] < ideal[0]["P_mesh_W"]
    assert successive[1]["P_mesh_W"] > ideal[1]["P_mesh_W"]


def test_oil_set_by_the_user_holds_for_every_test(losses):
    ours, mineral = losses(*IDEAL), losses(*IDEAL, "--set", "oil=MINR")
    assert mineral[0]["mu_sp"] > ours[0]["mu_sp"]
    assert mineral[42]["oil"] == "MINR" and mineral[42]["mu_sp"] == ours[42]["mu_sp"]


def test_a_rig_without_measured_data_shows_its_operating_point(gearheat):
    found = gearheat("losses", "helical_two_stage", "--json", "-").json
    assert len(found["rows"]) == 1
    assert all(value >= 0 for name, value in found["rows"][0].items() if name.startswith("P_"))
