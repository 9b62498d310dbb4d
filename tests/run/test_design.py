"""Design: what is found gives the target in a run, what cannot be found is said with what can, slopes are exact."""

import numpy as np
import pytest
from gearheat.model.errors import ScenarioError, SolveError
from gearheat.model.run.design import choose, design
from gearheat.model.run.least import Target, change, least_change
from gearheat.model.run.schedule import join_phases
from gearheat.model.run.sensitivity import sensitivities
from gearheat.model.run.simulate import simulate
from gearheat.model.run.steady import steady
from hypothesis import given, settings, strategies as st
from small_parts import brake, gear, motor, rc

WARM = {"drive.w": 100.0}


@pytest.mark.parametrize("start", [0.01, 5.0, 500.0])
def test_a_conductance_for_an_oil_temperature(start: float) -> None:
    found = design(brake(), ["foot.G"], {"oil.T": 370.0}, {**WARM, "foot.G": start})
    assert found.result["oil.T"][0] == pytest.approx(370.0, abs=1e-6)
    assert found.values["foot.G"] == pytest.approx(9.5644835, rel=1e-6)
    end = simulate(brake(), join_phases([(1e6, WARM)]), values=found.values, times=[1e6])
    assert end["oil.T"][0] == pytest.approx(370.0, abs=1e-4)
    assert abs(found.residuals["oil.T"]) < 1e-6
    assert found.condition == pytest.approx(1.0)


@settings(max_examples=25, deadline=None, derandomize=True)
@given(st.floats(5.0, 300.0), st.floats(0.5, 50.0), st.floats(2.0, 100.0))
def test_design_inverts_steady(w: float, foot: float, film: float) -> None:
    """Two conductances from the two temperatures they make."""
    flat = brake()
    aim = steady(flat, {"drive.w": w, "foot.G": foot, "film.G": film})
    targets = {name: float(aim[name][0]) for name in ("oil.T", "wall.T")}
    found = design(flat, ["foot.G", "film.G"], targets, {"drive.w": w})
    assert found.values["foot.G"] == pytest.approx(foot, rel=1e-6)
    assert found.values["film.G"] == pytest.approx(film, rel=1e-6)


def test_an_input_from_standstill() -> None:
    """At rest no temperature answers to the speed, so the search must look further than the slope there."""
    found = design(brake(), ["drive.w"], {"oil.T": 370.0}, {}, bounds={"drive.w": (0.0, 300.0)})
    assert steady(brake(), found.values)["oil.T"][0] == pytest.approx(370.0, abs=1e-6)
    assert found.values["drive.w"] > 0


def test_both_directions_are_named() -> None:
    found = design(brake(), ["drive.w"], {"oil.T": 310.0}, {})
    (note,) = found.notes
    assert "There is another solution with drive.w between" in note
    assert "rpm" in note


def test_torque_and_speed_of_a_motor() -> None:
    flat = motor(thinning=0.0)
    found = design(flat, ["drive.tau"], {"rotor.w": 60.0}, {})
    assert found.values["drive.tau"] == pytest.approx(2.0 + 0.1 * 60.0, rel=1e-6)


def test_an_implicit_loss_as_a_target() -> None:
    values = {"drive.w": 100.0, "load.tau": -30.0}
    found = design(gear(), ["load.tau"], {"gear.P_loss": 80.0}, values)
    assert steady(gear(), {**values, **found.values})["gear.P_loss"][0] == pytest.approx(80.0, rel=1e-8)


def test_out_of_reach_says_what_is_in_reach() -> None:
    with pytest.raises(SolveError) as caught:
        design(brake(), ["foot.G"], {"oil.T": 290.0}, WARM, bounds={"foot.G": (0.1, 10.0)})
    text = str(caught.value)
    low, high = (steady(brake(), {**WARM, "foot.G": G})["oil.T"][0] - 273.15 for G in (10.0, 0.1))
    assert f"oil.T reaches {low:.6g} degC ... {high:.6g} degC while foot.G goes from 0.1 W/K to 10 W/K" in text
    assert "the target 16.85 degC is out of reach" in text
    assert len(text.splitlines()) <= 3


def test_several_targets_out_of_reach() -> None:
    with pytest.raises(SolveError) as caught:
        design(brake(), ["film.G", "foot.G"], {"oil.T": 350.0, "wall.T": 360.0}, WARM)  # the wall is never warmer
    text = str(caught.value)
    assert "no values of film.G, foot.G found that give oil.T = 76.85 degC, wall.T = 86.85 degC" in text
    assert "wall.T reaches" in text
    assert len(text.splitlines()) <= 3


def test_a_target_that_does_not_depend_on_what_is_free() -> None:
    with pytest.raises(SolveError, match=r"wall\.T does not depend on wall\.C: it stays at 87\.0"):
        design(brake(), ["wall.C"], {"wall.T": 330.0}, WARM)


def test_no_steady_state_anywhere() -> None:
    with pytest.raises(SolveError, match=r"no steady state at any foot\.G from 0\.1 W/K to 1 W/K"):
        design(brake(thinning=-0.02), ["foot.G"], {"oil.T": 330.0}, WARM, bounds={"foot.G": (0.1, 1.0)})


def test_a_runaway_at_the_start_does_not_stop_the_search() -> None:
    """No balance at the values given, but there is one with the cooling that is asked for."""
    flat = brake(thinning=-0.02)
    with pytest.raises(SolveError):
        steady(flat, {"drive.w": 40.0})
    found = design(flat, ["foot.G"], {"oil.T": 325.0}, {"drive.w": 40.0}, bounds={"foot.G": (1.0, 1000.0)})
    assert steady(flat, {"drive.w": 40.0, **found.values})["oil.T"][0] == pytest.approx(325.0, abs=1e-6)


def test_freed_values_stay_in_their_bounds() -> None:
    found = design(brake(), ["foot.G"], {"oil.T": 370.0}, {**WARM, "foot.G": 300.0}, bounds={"foot.G": (1.0, 12.0)})
    assert found.values["foot.G"] == pytest.approx(9.5644835, rel=1e-6)


def test_two_that_do_the_same() -> None:
    """The loss is the heat through the film: two values freed for these two give a large condition number or none."""
    flat = brake()
    aim = steady(flat, WARM)
    targets = {"film.Q_flow": float(aim["film.Q_flow"][0]), "bearing.P_loss": float(aim["bearing.P_loss"][0])}
    try:
        found = design(flat, ["film.G", "foot.G"], targets, WARM)
    except SolveError:
        return
    assert found.condition > 1e6
    assert any("do nearly the same" in note for note in found.notes)


def test_sensitivity_of_a_design_against_central_differences() -> None:
    flat, free, targets = brake(), ["film.G", "foot.G"], {"oil.T": 370.0, "wall.T": 330.0}
    found = design(flat, free, targets, WARM)
    for j, name in enumerate(found.targets):
        h = 1e-3
        ends = [design(flat, free, {**targets, name: targets[name] + s}, WARM).values for s in (h, -h)]
        slope = [(ends[0][f] - ends[1][f]) / (2 * h) for f in free]
        assert found.sensitivity[:, j] == pytest.approx(slope, rel=1e-5)


@pytest.mark.parametrize("flat", [brake(), motor(thinning=0.005), gear()], ids=["brake", "motor", "gear"])
def test_sensitivities_against_central_differences(flat) -> None:
    drive = {"drive.w": 80.0, "drive.tau": 5.0, "load.tau": -2.0}
    values = {name: v for name, v in drive.items() if flat.index.get(name, ("",))[0] == "input"}
    outputs = [q.name for q in (*flat.states, *flat.outputs)]
    names = [q.name for q in flat.parameters if not q.name.endswith((".C", ".J"))] + ["room.T"]
    found = sensitivities(flat, outputs, names, values)
    starts = {q.name: q.start for q in (*flat.parameters, *flat.inputs)}
    for j, name in enumerate(names):
        h = 1e-4 * max(abs(starts[name]), 1e-2)
        ends = [steady(flat, {**values, name: starts[name] + s}) for s in (h, -h)]
        slope = [float(ends[0][o][0] - ends[1][o][0]) / (2 * h) for o in outputs]
        assert found[:, j] == pytest.approx(slope, rel=1e-4, abs=1e-6)


def test_what_does_not_matter_has_no_sensitivity() -> None:
    assert np.abs(sensitivities(brake(), ["oil.T"], ["oil.C", "wall.C"], WARM)).max() < 1e-12


def test_choosing_among_named_values() -> None:
    grades = {"thin": {"bearing.d_40": 0.05}, "middle": {"bearing.d_40": 0.1}, "thick": {"bearing.d_40": 0.2}}
    aim = float(steady(brake(), {**WARM, "bearing.d_40": 0.11})["oil.T"][0])
    ranked = choose(brake(), grades, {"oil.T": aim}, WARM)
    assert ranked[0].name == "middle"
    assert [c.distance for c in ranked] == sorted(c.distance for c in ranked)
    for candidate in ranked:
        expected = abs(float(steady(brake(), {**WARM, **grades[candidate.name]})["oil.T"][0]) - aim) / aim
        assert candidate.distance == pytest.approx(expected, rel=1e-9)


def test_a_candidate_without_steady_state_comes_last() -> None:
    kinds = {"runs away": {"bearing.thinning": -0.02}, "stays": {"bearing.thinning": 0.02}}
    ranked = choose(brake(), kinds, {"oil.T": 350.0}, WARM)
    assert [c.name for c in ranked] == ["stays", "runs away"]
    assert ranked[1].result is None
    assert "no solution" in ranked[1].problem


def test_all_wrong_names_at_once() -> None:
    with pytest.raises(ScenarioError) as caught:
        design(brake(), ["foot.GG", "drive.w", "drive.w"], {"drive.w": 1.0}, WARM, bounds={"x": (0.0, 1.0)})
    text = str(caught.value)
    assert 'unknown name "foot.GG". Did you mean "foot.G"' in text
    assert "drive.w is an input of bench. Expected an output or a state" in text
    assert "drive.w is free twice" in text
    assert "bounds for x, which is not free" in text
    assert "3 free values for 1 targets" in text
    with pytest.raises(ScenarioError, match="0 free values"):
        design(rc(), [], {}, {})


def limit(name: str, sign: str, celsius: float) -> Target:
    return Target(name, sign, celsius + 273.15)


def test_a_limit_that_holds_changes_nothing() -> None:
    found = least_change(brake(), ["foot.G"], [limit("oil.T", "<", 300.0)], WARM)
    assert found.values == {} and found.notes == ("met already: nothing has to change",)
    assert found.result["oil.T"][0] == pytest.approx(steady(brake(), WARM)["oil.T"][0])


def test_the_least_change_of_several_is_taken() -> None:
    flat, T = brake(), float(steady(brake(), WARM)["oil.T"][0]) - 273.15
    aim = [limit("oil.T", "<", T - 10)]
    found = least_change(flat, ["foot.G", "film.G"], aim, WARM)
    alone = {name: design(flat, [name], {"oil.T": aim[0].value}, WARM) for name in ("foot.G",)}
    assert change(flat, found, WARM) <= change(flat, alone["foot.G"], WARM)
    assert len(found.values) == 1 and found.result["oil.T"][0] == pytest.approx(aim[0].value, abs=1e-6)
    warmer = least_change(flat, ["foot.G"], [limit("oil.T", ">", T + 10)], WARM)
    assert warmer.values["foot.G"] < alone["foot.G"].values["foot.G"]


def test_a_value_and_limits_together() -> None:
    flat = brake()
    there = steady(flat, WARM)
    oil, wall = (float(there[name][0]) - 273.15 for name in ("oil.T", "wall.T"))
    loose = [Target("oil.T", "=", oil + 268.15), limit("wall.T", "<", wall + 50)]
    assert len(least_change(flat, ["foot.G", "film.G"], loose, WARM).values) == 1
    tight = [loose[0], limit("wall.T", "<", wall - 20)]
    found = least_change(flat, ["foot.G", "film.G"], tight, WARM)
    assert found.result["oil.T"][0] == pytest.approx(oil + 268.15, abs=1e-6)
    assert found.result["wall.T"][0] <= wall + 253.15 + 1e-6


def test_a_limit_with_nothing_free_says_how_far_it_is() -> None:
    with pytest.raises(ScenarioError, match=r"oil\.T is .* degC, which is not < 26\.85 degC\. Free more"):
        least_change(brake(), [], [Target("oil.T", "<", 300.0)], WARM)
    with pytest.raises(ScenarioError, match=r"foot\.G"):
        least_change(brake(), [], [Target("foot.G", "<", 1.0)], WARM)
    with pytest.raises(SolveError, match="out of reach"):
        least_change(brake(), ["foot.G"], [Target("oil.T", "<", 290.0)], WARM)
