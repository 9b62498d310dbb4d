"""What a drive engineer checks before believing a rig: values that do not fit each other are refused by name."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache

import numpy as np
import pytest
from gearheat.fmu.batch import Batch
from gearheat.model.core.flat import FlatModel
from gearheat.model.errors import ScenarioError, SolveError
from gearheat.model.laws.gears import profile_shift_sum, transverse_pressure_angle, working_pressure_angle
from gearheat.model.machines.spec import Spec, assemble
from gearheat.model.parts import PARTS
from gearheat.model.run.design import design
from gearheat.model.run.search import sensitivities
from gearheat.model.run.steady import steady
from gearheat.scenarios.load import list_rigs, load

HELICAL, PLANETARY, CYCLOIDAL = "helical_two_stage", "planetary", "cycloidal_printed"


@cache
def spec(name: str) -> Spec:
    return load(name).spec


@cache
def flat(name: str) -> FlatModel:
    return spec(name).flat()


@pytest.mark.parametrize("name", list_rigs())
def test_the_shipped_rigs_hold_all_relations(name: str) -> None:
    model = flat(name)
    assert model.relations
    assert not model.contradictions(model.starts("parameter"))


#: Rig, values that do not fit, and what is told.
WRONG: list[tuple[str, dict[str, float], str]] = [
    (HELICAL, {"stage_1.a_w": 0.09}, "a_w is more than the base circles need"),
    (HELICAL, {"stage_1.m_n": 0.003}, "a_w is more than the base circles need"),
    (HELICAL, {"stage_1.a_w": 0.11}, "a_w fits z_1, z_2, m_n, beta, x_1, x_2"),
    (HELICAL, {"stage_1.z_1": 25.0}, "a_w fits z_1, z_2, m_n, beta, x_1, x_2"),
    (HELICAL, {"stage_1.beta": math.radians(20)}, "a_w fits z_1, z_2, m_n, beta, x_1, x_2"),
    (HELICAL, {"stage_1.x_1": 0.9, "stage_1.x_2": 0.9}, "a_w fits z_1, z_2, m_n, beta, x_1, x_2"),
    (HELICAL, {"stage_1.x_1": -1.5}, "x_1 is above undercut"),
    (HELICAL, {"stage_1.x_1": 1.5, "stage_1.x_2": -1.5}, "the teeth of gear 1 are not pointed"),
    (HELICAL, {"stage_1.eps_alpha": 0.9}, "the teeth overlap"),
    (HELICAL, {"stage_1.z_1": 15.5}, "z_1 is whole"),
    (HELICAL, {"input_bearing_a.count": 2.5}, "count is whole"),
    (HELICAL, {"input_bearing_a.d": 0.08}, "D is larger than d"),
    (HELICAL, {"input_bearing_a.d_m": 0.075}, "d_m lies between d and D"),
    (HELICAL, {"middle_support.x_2": 0.4}, "x_2 fits span"),
    (HELICAL, {"cooling.share_top": 0.9, "cooling.share_bottom": 0.9}, "the shares fit into one area"),
    (HELICAL, {"oil.nu_100": 3e-4}, "nu_40 is above nu_100"),
    (PLANETARY, {"gear_set.a_w": 0.065}, "a_w is more than the base circles need"),
    (PLANETARY, {"gear_set.a_w": 0.09}, "a_w lies near the reference distance"),
    (PLANETARY, {"gear_set.z_3": 117.0}, "z_3 fits z_1 + 2 z_2"),
    (PLANETARY, {"gear_set.z_1": 37.0}, "the planets stand at equal angles"),
    (PLANETARY, {"gear_set.N": 6.0}, "neighbouring planets do not touch"),
    (PLANETARY, {"gear_set.N": 2.5}, "N is whole"),
    (PLANETARY, {"gear_set.n_axial_sun": 4.0}, "n_axial_sun fits N"),
    (PLANETARY, {"carrier_bearing.Y": 14.0}, "Y = 14"),
    (CYCLOIDAL, {"reducer.z_2": 15.0}, "z_2 is z_1 + 1"),
    (CYCLOIDAL, {"reducer.u": 7.5}, "u is whole"),
    (CYCLOIDAL, {"reducer.e": 0.0065}, "e leaves the disc without cusps"),
    (CYCLOIDAL, {"reducer.e": 0.006}, "the pins do not undercut the disc"),
    (CYCLOIDAL, {"reducer.R_0": 0.02375}, "the holes lie outside the bearing"),
    (CYCLOIDAL, {"reducer.P_rated": 100.0}, "eta can be derived"),
    (CYCLOIDAL, {"housing.d": 0.175}, "d leaves room inside"),
]


@pytest.mark.parametrize(("name", "values", "told"), WRONG, ids=str)
def test_what_does_not_fit_is_refused(name: str, values: dict[str, float], told: str) -> None:
    """In the rig file and, where the rig has these parameters, at the beginning of a run."""
    with pytest.raises(ScenarioError) as caught:
        assemble(spec(name).with_values(values))
    assert any(told in problem for problem in caught.value.problems)
    if values.keys() <= {q.name for q in flat(name).parameters}:
        with pytest.raises(ScenarioError) as caught:
            steady(flat(name), values)
        assert any(told in problem for problem in caught.value.problems)


def test_the_oil_stays_in_the_housing_wherever_the_level_comes_from() -> None:
    """What the rig file refuses: in runs, in rows of a sweep, and in the search of a design."""
    model, told = flat(HELICAL), 'oil: "level is below the top"'
    with pytest.raises(ScenarioError, match=f"{told} does not hold: .*level = 5 m, cooling.height = "):
        steady(model, {"oil.level": 5.0})
    p = np.tile(model.starts("parameter"), (2, 1))
    p[1, model.locate("oil.level")[1]] = 5.0
    assert Batch(model).contradictions(p) == [None, told]
    with pytest.raises(SolveError, match=f"(?s)out of reach.*limited by {told}"):
        design(model, ["oil.level"], {"oil.T": 500.0}, {})


def test_a_cylinder_wall_has_a_thickness() -> None:
    with pytest.raises(ScenarioError, match="r_o is larger than r_i"):
        PARTS["CylinderWall"]("wall", k=50.0, L=0.3, r_i=0.15, r_o=0.14)


def test_the_message_names_part_relation_values_and_remedy() -> None:
    with pytest.raises(ScenarioError) as caught:
        steady(flat(HELICAL), {"stage_1.z_1": 25.0})
    assert caught.value.problems == (
        'steady: stage_1: "a_w fits z_1, z_2, m_n, beta, x_1, x_2" does not hold: profile shift that a_w asks for '
        "beyond x_1 + x_2 is -2.019, expected from -0.05 to 0.05 (z_1 = 25, z_2 = 77, m_n = 0.002 m, "
        "alpha_n = 0.349066 rad, beta = 0.245566 rad, a_w = 0.1 m, x_1 = 0, x_2 = 0).\n"
        "Give the a_w, beta or profile shifts that belong to these teeth.",
    )


def test_all_that_does_not_fit_is_told_at_once() -> None:
    values = {"stage_1.z_1": 25.0, "cooling.share_top": 0.9, "cooling.share_bottom": 0.9, "input_bearing_a.d": 0.08}
    with pytest.raises(ScenarioError) as caught:
        steady(flat(HELICAL), values)
    assert {p.split(": ")[1] for p in caught.value.problems} == {"stage_1", "cooling", "input_bearing_a"}


def test_another_pair_on_the_same_centre_distance_moves_everything() -> None:
    """25 and 72 teeth instead of 20 and 77: contact ratio, loss factor and ratio follow, as in the rig file."""
    teeth = {"stage_1.z_1": 25.0, "stage_1.z_2": 72.0}
    changed, before = steady(flat(HELICAL), teeth), steady(flat(HELICAL), {})
    again = steady(spec(HELICAL).with_values(teeth).flat(), {})
    for name in ("stage_1.P_loss", "stage_1.eps_alpha", "stage_1.H_v", "efficiency.tau_loss", "output.w"):
        assert changed[name][0] == pytest.approx(again[name][0], rel=1e-9)
        assert changed[name][0] != pytest.approx(before[name][0], rel=1e-3)
    assert changed["output.w"][0] / changed["input.w"][0] == pytest.approx(25 / 72 * 19 / 62, rel=1e-12)


def test_sensitivities_go_through_what_is_derived() -> None:
    """A profile shift acts through contact ratio and loss factor alone."""
    model, h = flat(HELICAL), 1e-5
    (slope,) = sensitivities(model, ["stage_1.P_loss"], ["stage_1.x_1"], {})[0]
    low, high = (steady(model, {"stage_1.x_1": s * h})["stage_1.P_loss"][0] for s in (-1, 1))
    assert slope == pytest.approx((high - low) / (2 * h), rel=1e-4)
    assert abs(slope) > 1.0


def test_the_loss_torque_is_the_loss_over_the_speed_of_a() -> None:
    found = steady(flat(PLANETARY), {})
    assert found["efficiency.tau_loss"][0] == pytest.approx(found["carrier.tau"][0] + 4 * found["sun.tau"][0], rel=1e-9)
    with pytest.raises(ScenarioError, match='unknown key "ratio"'):
        PARTS["Efficiency"]("efficiency", ratio=1.0)


def test_a_derived_parameter_cannot_be_set_for_a_run() -> None:
    told = r"stage_1\.eps_alpha follows from z_1, z_2, .* or give stage_1\.eps_alpha a value of its own in the rig file"
    with pytest.raises(ScenarioError, match=told):
        steady(flat(HELICAL), {"stage_1.eps_alpha": 1.6})
    with pytest.raises(ScenarioError, match=told):
        design(flat(HELICAL), ["stage_1.eps_alpha"], {"stage_1.P_loss": 40.0}, {})


def test_a_design_ends_where_the_parameters_fit() -> None:
    """What a profile shift could only reach at teeth that do not mesh is out of reach, and the relation is named."""
    model = flat(HELICAL)
    loss = steady(model, {})["stage_1.P_loss"][0]
    found = design(model, ["stage_1.x_1"], {"stage_1.P_loss": 1.001 * loss}, {})
    assert not model.contradictions(moved(model, found.values))
    with pytest.raises(SolveError, match='limited by stage_1: "a_w fits'):
        design(model, ["stage_1.x_1"], {"stage_1.P_loss": 1.3 * loss}, {})


def test_a_design_does_not_cut_teeth_into_pieces() -> None:
    with pytest.raises(SolveError, match=r'(?s)is out of reach.*limited by .*"z_1 is whole"'):
        design(flat(HELICAL), ["stage_1.z_1"], {"stage_1.P_loss": 45.0}, {})


def test_a_design_gives_what_the_rig_file_gives() -> None:
    model = flat(HELICAL)
    found = design(model, ["stage_1.b"], {"stage_1.P_loss": 45.0}, {})
    again = steady(spec(HELICAL).with_values(found.values).flat(), {})
    for name in ("stage_1.P_loss", "oil.T", "efficiency.P_loss"):
        assert found.result[name][0] == pytest.approx(again[name][0], rel=1e-9)


def moved(model: FlatModel, values: Mapping[str, float]) -> np.ndarray:
    p = model.starts("parameter")
    for name, value in values.items():
        p[model.locate(name)[1]] = value
    return p


def test_profile_shifts_of_the_fzg_test_gear_in_print() -> None:
    """FZG type C: a = 91.5 mm, 16 and 24 teeth of 4.5 mm, x_1 = 0.1817 and x_2 = 0.1715 (ISO 14635-1)."""
    alpha_n = math.radians(20)
    alpha_t = transverse_pressure_angle(alpha_n, 0.0)
    alpha_wt = working_pressure_angle(alpha_t, 0.0045 * 40 / 2, 0.0915)
    assert float(profile_shift_sum(alpha_wt, alpha_t, alpha_n, 40)) == pytest.approx(0.1817 + 0.1715, abs=1e-4)
