from __future__ import annotations

from dataclasses import replace

import pytest
from gearheat.fmu.export import export
from gearheat.model.errors import ScenarioError
from gearheat.model.machines.spec import PartSpec
from gearheat.model.run.design import design
from gearheat.model.run.steady import steady
from gearheat.scenarios.load import load
from gearheat.scenarios.scenario import deduce_drive
from gearheat.tools.solve.settings import adjust, drive_at, flat_of

GIVEN = {"carrier": ("w", "tau")}


@pytest.mark.parametrize(
    ("named", "drive"),
    [
        ((), {"carrier": ("w", "tau")}),
        (("carrier.w",), {"carrier": ("tau", "w")}),
        (("sun.w",), {"carrier": ("tau",), "sun": ("w",)}),
        (("sun.tau",), {"carrier": ("w",), "sun": ("tau",)}),
        (("sun.w", "sun.tau"), {"sun": ("w", "tau")}),
        (("carrier.tau", "sun.tau"), {"carrier": ("tau",), "sun": ("tau",)}),
    ],
)
def test_named_quantities_take_the_place_of_given_ones(named, drive):
    found = deduce_drive(GIVEN, named)
    assert {end: set(quantities) for end, quantities in found.items()} == {e: set(q) for e, q in drive.items()}


def test_a_shaft_that_turns_apart_keeps_its_drive():
    scenario = load("helical_two_stage")
    parts, net = (
        [PartSpec("motor", "ShaftEnd"), PartSpec("wheel", "Inertia", {"J": 0.1})],
        ("motor.flange", "wheel.flange"),
    )
    apart = replace(scenario, spec=scenario.spec.with_parts(parts, [net])).driven({**scenario.given, "motor": ("w",)})
    assert apart.deduced_drive(["input.w"]) == {**scenario.deduced_drive(["input.w"]), "motor": ("w",)}
    assert apart.deduced_drive(["motor.tau"]) == {**scenario.given, "motor": ("tau",)}
    flat = flat_of(adjust(apart, ["input.tau=50 N.m", "output.tau=-600 N.m"]))
    assert [q.name for q in flat.states if q.name.endswith(".w")] == ["rotor.w"]


def test_a_machine_driven_by_torques_alone_keeps_its_speed_as_a_state():
    flat = flat_of(adjust(load("planetary"), ["carrier.tau=2500 N.m", "sun.tau=-600 N.m"]))
    assert "rotor.w" in {q.name for q in flat.states}
    assert {"carrier.tau", "sun.tau"} <= {q.name for q in flat.inputs}


def test_settings_reach_the_model_in_si():
    scenario = adjust(load("planetary"), ["cooling.A=5000 cm2", "room.T=0 degC", "wall.T=40 degC", "oil=MINE"])
    flat = flat_of(scenario)
    assert flat.quantity("cooling.A").start == pytest.approx(0.5)
    assert flat.quantity("room.T").start == pytest.approx(273.15)
    assert flat.quantity("wall.T").start == pytest.approx(313.15)
    assert flat.quantity("oil.rho_15").start == pytest.approx(893.0)
    assert scenario.value_sources["cooling.A"] == "set on the command line"


def test_inputs_that_are_no_shaft_quantities_leave_the_drive_alone():
    scenario = load("planetary")
    assert scenario.driven_by(["room.T", "room.air_speed"]).given == scenario.given


def test_drives_of_an_fmu():
    scenario = load("planetary")
    assert drive_at(scenario, None, "speed") == dict(scenario.given)
    assert drive_at(scenario, "sun", "speed") == {"sun": ("w", "tau")}
    assert drive_at(scenario, None, "torque") == {"carrier": ("tau",), "sun": ("tau",)}
    with pytest.raises(ScenarioError, match="shaft end"):
        drive_at(scenario, "room", "speed")


class TestDerived:
    """A parameter that follows from others: set or named by the user, it has a value of its own."""

    def test_set_it_holds(self):
        flat = flat_of(adjust(load("helical_two_stage"), ["stage_1.eps_alpha=1.5"]))
        assert flat.quantity("stage_1.eps_alpha").start == 1.5
        assert "stage_1.eps_alpha" not in flat.derived
        assert steady(flat, {})["stage_1.mu"][0] != steady(flat, {"stage_1.eps_alpha": 1.6})["stage_1.mu"][0]

    def test_named_it_begins_with_the_value_it_had(self):
        scenario = load("helical_two_stage")
        flat = flat_of(adjust(scenario, named=["stage_1.H_v", "stage_1.z_1"]))
        assert flat.index["stage_1.H_v"][0] == "parameter"
        assert flat.quantity("stage_1.H_v").start == flat_of(scenario).quantity("stage_1.H_v").start
        found = design(flat, ["stage_1.H_v"], {"stage_1.P_loss": 45.0}, {})
        assert found.result["stage_1.P_loss"][0] == pytest.approx(45.0)

    def test_a_sweep_varies_it(self, gearheat, tmp_path):
        out = tmp_path / "table.csv"
        vary = ["--vary", "stage_1.eps_alpha=1.4..1.8", "--vary", "stage_1.a_w=100 mm..101 mm", "--grid", "2x2"]
        answer = gearheat("sweep", "helical_two_stage", *vary, "-o", out, "--output", "stage_1.P_loss", "--json", "-")
        assert answer.code == 0, answer.err
        assert answer.json["status"] == {"ok": 2, "contradiction": 2}

    def test_shown_with_what_it_follows_from_or_as_given(self, gearheat):
        shown = {line["name"]: line for line in gearheat("show", "helical_two_stage", "--json", "-").json["parameters"]}
        assert shown["stage_1.eps_alpha"]["kind"] == "derived"
        assert shown["stage_1.eps_alpha"]["value"] == pytest.approx(1.6178, abs=1e-4)
        assert shown["stage_1.eps_alpha"]["source"].startswith("follows from z_1, z_2, ")
        assert shown["stage_1.z_1"]["kind"] == "given"
        assert shown["stage_1.tau_width"]["kind"] == "default"

    def test_played_it_says_what_it_follows_from(self, gearheat, tmp_path):
        fmu, duty = tmp_path / "rig.fmu", tmp_path / "duty.csv"
        duty.write_text("time [s],room.T [degC]\n0,20\n60,20\n")
        export(flat_of(load("helical_two_stage")), fmu)
        answer = gearheat("play", fmu, "--duty", duty, "-o", tmp_path / "out.csv", "--set", "stage_1.eps_alpha=1.5")
        assert answer.code == 2
        assert '"stage_1.eps_alpha" cannot be set. It is calculated: ' in answer.err
        assert "follows from z_1, z_2, m_n" in answer.err
