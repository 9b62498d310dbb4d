"""`gearheat losses --method`: reference methods beside the model."""

from __future__ import annotations

import functools
import json
import re
from dataclasses import replace
from pathlib import Path
from typing import ClassVar

import pytest
from gearheat.model.core.component import equation
from gearheat.model.core.declare import Output, Parameter
from gearheat.model.errors import ScenarioError
from gearheat.model.machines.spec import PartSpec
from gearheat.model.parts.friction import Friction
from gearheat.scenarios.load import load
from gearheat.tools.cli.app import app
from gearheat.tools.rating.gather import machine_of
from gearheat.tools.rating.methods import METHODS
from gearheat.tools.rating.rate import rate_by_method
from typer.testing import CliRunner

RIG = "helical_two_stage"
COLUMNS = ("model", "method", "method_at_sump")


@pytest.fixture(scope="module")
def compared():
    """The answer of a method about the rig with two helical stages, each computed once."""

    @functools.cache
    def answer(method: str, *options: str, rig: str = RIG) -> dict:
        result = CliRunner().invoke(app, ["losses", rig, "--method", method, "--json", "-", *options])
        assert result.exit_code == 0, result.stderr
        return json.loads(result.stdout)

    return answer


def test_an_unknown_method():
    with pytest.raises(ScenarioError, match='there is no "iso14179-3"'):
        rate_by_method(RIG, "iso14179-3")


@pytest.mark.parametrize("method", METHODS)
def test_keys_and_sums(compared, method):
    found = compared(method)
    assert found["schema"] == "gearheat.reference/1"
    for column in COLUMNS:
        losses, parts = found["losses_W"][column], found["parts_W"][column]
        assert {"mesh", "churning", "bearings", "seals", "total"} <= losses.keys()
        assert losses["total"] == pytest.approx(sum(p for kind in parts.values() for p in kind.values()))
        assert 0.9 < found["eta"][column] < 1
    keys = "T_sump_C,T_room_C,T_oil_C,conductance_W_K,rating,gears,not_treated,outside,assumptions"
    assert set(keys.split(",")) <= found.keys()


@pytest.mark.parametrize("method", METHODS)
def test_the_model_stands_as_it_is(compared, gearheat, method):
    """What reads speeds and loads changes nothing."""
    found, steady = compared(method), gearheat("steady", RIG, "--json", "-").json["values"]
    assert found["T_oil_C"]["model"] == pytest.approx(steady["oil.T"], rel=1e-9)
    assert found["losses_W"]["model"]["total"] == pytest.approx(steady["efficiency.P_loss"], rel=1e-6)
    assert found["eta"]["model"] == pytest.approx(steady["efficiency.eta"], rel=1e-6)
    assert [gear["F_t_N"] for gear in found["gears"]] == pytest.approx([steady[f"stage_{i}.F_t"] for i in (1, 2)])


@pytest.mark.parametrize("method", METHODS)
def test_losses_equal_heat_at_the_sump(compared, method):
    found = compared(method)
    heat = found["conductance_W_K"] * (found["T_sump_C"] - found["T_room_C"])
    assert found["losses_W"]["method_at_sump"]["total"] == pytest.approx(heat, rel=1e-6)


@pytest.mark.parametrize("method", METHODS)
def test_the_rated_load_heats_the_sump_to_its_limit(compared, method):
    """The bearings carry what the gears bring, and a little less of it where stages lose more: half a kelvin."""
    share = compared(method, "--limit", "60 degC")["rating"]["load_share"]
    again = compared(method, "--set", f"output.tau={-590 * share:.6f} N.m")
    assert again["T_sump_C"] == pytest.approx(60, abs=0.5)


def test_the_second_part_uses_the_tooth_friction_of_the_model_with_its_own_line_load(compared):
    """With F_bt/b in the model, too, the losses differ by the power they count on: here that of the mean tooth force,
    there that of the gear that drives, which is half the loss more.
    """
    options = ("--set", "stage_1.line_load=F_bt/b", "--set", "stage_2.line_load=F_bt/b")
    found = compared("iso14179-2", *options)
    model, method = (found["parts_W"][column]["mesh"] for column in ("model", "method"))
    power = {gear["part"]: gear["F_t_N"] * gear["v_m_s"] for gear in found["gears"]}
    assert {k: P * (1 + P / (2 * power[k])) for k, P in method.items()} == pytest.approx(model, rel=1e-3)


@pytest.mark.parametrize(("method", "power"), [("iso14179-1", 1.0), ("iso14179-2", 1.5)])
def test_gears_that_dip_deeper_churn_more(compared, method, power):
    depths = [("--dip", "stage_1.wheel=0 mm", "--dip", f"stage_2.wheel={mm} mm") for mm in (20, 40)]
    low, high = (compared(method, *dips)["losses_W"]["method"] for dips in depths)
    assert high["churning"] >= 2**power * low["churning"] * (1 - 1e-9)
    assert {k: v for k, v in low.items() if k not in ("churning", "total")} == pytest.approx(
        {k: v for k, v in high.items() if k not in ("churning", "total")}
    )


class Dipping(Friction):
    """A gear that churns and knows how deep it dips."""

    role: ClassVar[str] = "churning"
    r = Parameter("m", "pitch radius", nominal=0.1)
    h = Output("m", "depth", nominal=0.01)

    def torque(self):
        """None."""
        return 0.0

    def equations(self):
        """A given depth."""
        yield equation("depth", self.h, 0.02)
        yield from super().equations()


@pytest.mark.parametrize(("r", "depth"), [(0.0957, 0.023), (0.05, 0.02269)])
def test_a_gear_that_knows_its_depth_tells_it(r, depth):
    """Its pitch circle dips by 20 mm, its tips by a module more; of another radius it is none of this mesh's."""
    rig = load(RIG)
    part = PartSpec("dips", "Dipping", {"count": 1, "inner_share": 1, "r": r})
    nets = [("dips.shaft", "stage_2.wheel"), ("dips.inner", "dips.outer", "oil.heat")]
    machine = machine_of(replace(rig, spec=rig.spec.with_parts([part], nets, {"Dipping": Dipping})), (), {})
    assert machine.meshes[1].dips == pytest.approx((0.0, depth), rel=1e-3)
    assert len(machine.untreated) == 7  # no bearing is known here, and the foot has no rule


def test_heat_transfer_may_be_given(compared):
    found = compared("iso14179-1", "--k", "34 W/(m2.K)")
    assert found["conductance_W_K"] == pytest.approx(2 * compared("iso14179-1")["conductance_W_K"])


@pytest.mark.parametrize("method", METHODS)
def test_what_has_no_rule_is_named(compared, method):
    (foot,) = compared(method)["not_treated"]
    assert (foot["part"], foot["type"]) == ("foot", "ThermalConductor")
    assert foot["power"] > 0
    assert any("no print" in text for text in compared(method)["assumptions"])


def test_what_is_outside_its_range_is_named(compared):
    """The second stage is slow, and at the rated load its load intensity is high."""
    load, speed = sorted(compared("iso14179-1")["outside"], key=lambda o: o["argument"])
    assert {o["law"] for o in (load, speed)} == {"mesh_friction"}
    assert speed["met"][0] == pytest.approx(compared("iso14179-1")["gears"][1]["v_m_s"])
    assert load["met"][0] > load["range"][1] == 14e6


def test_a_closed_loop_has_no_efficiency(compared):
    found = compared("iso14179-2", rig="fzg_four_square")
    assert set(found["eta"].values()) == {None}
    assert found["rating"]["power_W"] is None and found["rating"]["load_share"] > 0


def test_a_limit_out_of_reach_is_said(compared):
    assert compared("iso14179-1", "--limit", "21 degC")["rating"]["power_W"] == 0
    assert "even 100 times" in compared("iso14179-1", "--k", "1000 W/(m2.K)")["rating"]["why"]


def test_text_for_people(gearheat):
    out = gearheat("losses", RIG, "--method", "iso14179-1").out
    for words in ("sump by ISO/TR 14179-1", "thermal rating at 95.0 degC", "not treated: foot", "outside its range"):
        assert words in out


def test_refusals(gearheat):
    planetary = gearheat("losses", "planetary", "--method", "iso14179-1")
    assert planetary.code == 2 and "gear_set (PlanetarySet)" in planetary.err
    wrong = gearheat(
        "losses", RIG, "--method", "iso14179-1", "--dip", "stage_9.wheel=1 mm", "--dip", "stage_1.ring=1 mm"
    )
    assert wrong.code == 2 and len(wrong.problems()) == 2
    assert gearheat("losses", RIG, "--method", "iso14179-1", "--limit", "95 bar").code == 2
    assert gearheat("losses", RIG, "--method", "iso14179-1", "--dip", "stage_1.wheel").code == 2
    assert gearheat("losses", RIG, "--method", "iso14179-1", "--contacts").code == 2
    assert gearheat("losses", RIG, "--k", "20 W/(m2.K)").code == 2


def test_the_table_of_the_page(compared):
    """`tools/rating/README.md` prints what the command does."""
    page = (Path(__file__).parents[2] / "tools" / "rating" / "README.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^\| (mesh|churning|bearings|seals|total) \|((?: [\d.]+ \|){5})$", page, re.MULTILINE))
    found = [compared(method)["losses_W"] for method in METHODS]
    for kind in ("mesh", "churning", "bearings", "seals", "total"):
        numbers = [found[0]["model"], *(f[column] for f in found for column in COLUMNS[1:])]
        assert [float(cell) for cell in rows[kind].split("|")[:5]] == pytest.approx(
            [n[kind] for n in numbers], rel=2e-3
        )
