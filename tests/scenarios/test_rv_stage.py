"""The RV stage: kinematics and statics of the whole reducer, the mesh cycle's average, and what is refused."""

import math
from dataclasses import replace

import numpy as np
import pytest
from gearheat.model.core.flat import FlatModel
from gearheat.model.errors import ScenarioError
from gearheat.model.laws.cycloid_pin import contact_speed, curvature, entrainment_speed, reduced_radius, sliding_speed
from gearheat.model.laws.film import fluid_share
from gearheat.model.machines.spec import Spec, assemble
from gearheat.model.parts.contacts import ContactTable
from gearheat.model.parts.pin_mesh import Film, PinMesh
from gearheat.model.parts.rv import CycloidPinStage
from gearheat.model.run.result import Result
from gearheat.model.run.steady import steady
from gearheat.scenarios.load import load
from gearheat.scenarios.scenario import Scenario
from gearheat.tools.solve.losses import contacts_part, values_of

K, ZP, RP, R_RP, B, E_EFF = 0.8125, 40, 0.064, 0.003, 8.86e-3, 230.6e9
W_CRANK = 39 * 15 * math.pi / 30


def model(spec: Spec) -> FlatModel:
    return spec.flat()


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    return load("rv_stage")


@pytest.fixture(scope="module")
def rated(scenario: Scenario) -> dict[str, float]:
    result = steady(model(scenario.spec), scenario.operating_point)
    return {name: float(column[0]) for name, column in result.columns.items()}


def test_ratio_is_that_of_a_reducer_with_held_pins(rated: dict[str, float]) -> None:
    assert rated["input.w"] / rated["output.w"] == pytest.approx(1 + 48 / 16 * 40, rel=1e-12)
    assert -rated["mesh.w_crank"] / rated["output.w"] == pytest.approx(39, rel=1e-12)


def test_without_friction_the_power_passes(scenario: Scenario) -> None:
    """Torques at both ends in the ratio of the speeds; the statics of the discs give the torque of one."""
    free = {f"{part}.k_loss": 0.0 for part in ("eccentric_bearing", "crank_bearing", "main_bearing", "churning")}
    free |= {"input_seal.k_loss": 0.0, "output_seal.k_loss": 0.0, "stage_1.k_mu": 0.0, "mesh.disc_torque": "statics"}
    free |= {"mesh.mu_fluid": 0.0, "mesh.mu_boundary": 0.0}
    spec = scenario.spec.with_values(free)
    found = steady(model(spec), scenario.operating_point)
    assert float(found["input.tau"][0]) == pytest.approx(412 / 121, rel=1e-6)
    # both discs hold 117 of 121 parts: one turns the carrier past them, three reach it through the cranks
    assert 2 * float(found["mesh.T_disc"][0]) == pytest.approx(412 * 117 / 121, rel=1e-6)


def test_torque_of_a_disc_is_half_of_the_output_as_the_source_takes_it(rated: dict[str, float]) -> None:
    assert rated["mesh.T_disc"] == pytest.approx(206, rel=1e-6)
    assert rated["mesh.eta_oil"] == pytest.approx(0.10, rel=0.01)
    assert rated["mesh.alpha_p"] == pytest.approx(20e-9, rel=0.01)


def test_force_on_a_disc_follows_from_its_equilibrium(rated: dict[str, float]) -> None:
    """Across the crank's line T/(e Zc), along it the sum of the pins' parts."""
    theta = np.linspace(0, math.pi, 20001)
    S = np.sqrt(1 + K**2 - 2 * K * np.cos(theta))
    F = 4 * 206 * np.sin(theta) / (K * 39 * RP * S)
    along = np.trapezoid(F * (K - np.cos(theta)) / S, theta) * ZP / (2 * math.pi)
    across = 206 / (0.0013 * 39)
    assert rated["mesh.F_disc"] == pytest.approx(math.hypot(along, across), rel=1e-3)


def mesh(rolling: bool) -> PinMesh:
    return PinMesh(ZP, RP, 0.0013, R_RP, B, E_EFF, 5e-8, 0.04, 0.11, rolling)


@pytest.mark.parametrize("eta", [0.02, 1.0])
@pytest.mark.parametrize("rolling", [False, True])
def test_few_angles_give_the_average_over_the_cycle(rolling: bool, eta: float) -> None:
    """Against a fine trapezoidal rule; a held pin's film closes where its entrainment turns."""
    film, one = Film(206.0, W_CRANK, eta, 20e-9), mesh(rolling)

    def rubbing(theta: float) -> float:
        c = one.contact(theta, film)
        mu = one.groove_friction(c, 5e-6, 3e-7, film) if rolling else c.mu
        return float(c.F * c.v_rub * mu)

    fine = np.linspace(0, math.pi, 8001)
    exact = np.trapezoid([rubbing(theta) for theta in fine], fine)
    found = sum(float(weight) * rubbing(float(theta)) for theta, weight in one.quadrature())
    assert found == pytest.approx(exact, rel=1e-3)


@pytest.mark.parametrize(("rolling", "r_rp", "count"), [(False, 0.003, 2), (False, 0.004, 1), (True, 0.003, 0)])
def test_angles_at_which_the_entrainment_turns(rolling: bool, r_rp: float, count: int) -> None:
    """Found by its sign over the cycle; where it does not turn, the angles still part the cycle."""
    one, film = replace(mesh(rolling), r_rp=r_rp), Film(206.0, W_CRANK, 0.1, 20e-9)
    first, second = map(float, one.turning_angles())
    assert 0 <= first <= second <= math.pi
    fine = np.linspace(0, math.pi, 2001)
    u = np.array([float(one.contact(theta, film).U) for theta in fine])
    turns = fine[:-1][np.diff(np.sign(u)) != 0]
    assert len(turns) == count
    for theta in turns:
        assert min(abs(theta - first), abs(theta - second)) < 2e-3


@pytest.fixture(scope="module", params=["held", "rolling"])
def table(scenario: Scenario, request: pytest.FixtureRequest) -> tuple[str, Result, ContactTable]:
    """Choice of the pins, the steady state, and the contacts there."""
    spec = scenario.spec.with_values({"mesh.pin": request.param})
    flat = model(spec)
    result = steady(flat, scenario.operating_point)
    part, values = contacts_part(replace(scenario, spec=spec))
    return request.param, result, part.contact_table(values)


class TestContacts:
    def test_every_number_is_finite_and_none_is_negative(self, table) -> None:
        _, _, found = table
        assert [row["theta_deg"] for row in found.rows] == list(range(181))
        assert all(math.isfinite(v) and v >= 0 for row in found.rows for v in row.values())
        assert all(row.keys() == found.columns.keys() for row in found.rows)
        assert found.rows[0]["w_N_m"] == found.rows[-1]["w_N_m"] == 0 == found.rows[0]["p_H_Pa"]

    def test_loads_recover_the_torque(self, table) -> None:
        _, _, found = table
        assert found.totals["torque_recovery"] == pytest.approx(1, abs=1e-3)
        assert found.totals["torque_recovery_worst"] == pytest.approx(1, abs=1.5e-3)

    @pytest.mark.parametrize("degree", [20, 60, 90, 150])
    def test_columns_are_the_laws(self, table, degree: int) -> None:
        pin, _, found = table
        row, theta = found.rows[degree], math.radians(degree)
        v_s = float(sliding_speed(W_CRANK, K, 39, RP, R_RP, theta))
        v_c = float(contact_speed(W_CRANK, K, R_RP, theta))
        roll = 1.0 if pin == "rolling" else 0.0
        S = math.sqrt(1 + K**2 - 2 * K * math.cos(theta))
        assert row["R_m"] == pytest.approx(float(reduced_radius(curvature(K, ZP, RP, theta), R_RP)), rel=1e-9)
        assert row["w_N_m"] == pytest.approx(4 * 206 * math.sin(theta) / (K * 39 * RP * S) / B, rel=1e-6)
        assert row["U_m_s"] == pytest.approx(abs(float(entrainment_speed(v_s, v_c, roll))), rel=1e-9)
        assert row["v_slide_m_s"] == pytest.approx(0.0 if roll else v_s, abs=1e-12)
        assert row["p_H_Pa"] == pytest.approx(math.sqrt(row["w_N_m"] * E_EFF / (2 * math.pi * row["R_m"])), rel=1e-9)
        assert row["Lambda"] == pytest.approx(row["h_c_m"] / 5e-8, rel=1e-9)
        f = float(fluid_share(row["Lambda"]))
        assert row["asperity_share"] == pytest.approx(1 - f, abs=1e-12)
        assert row["mu"] == pytest.approx(0.04 * f + 0.11 * (1 - f), rel=1e-9)

    def test_film_of_the_source(self, table) -> None:
        """Rolling pins work at the specific film thickness of the source where most is carried, held ones below it."""
        pin, _, found = table
        loaded = [row["Lambda"] for row in found.rows if 40 <= row["theta_deg"] <= 100]
        low, high = (0.5, 1.0) if pin == "rolling" else (0.0, 0.6)
        assert low < min(loaded) and max(loaded) < high

    def test_the_loss_is_that_of_the_table(self, table) -> None:
        pin, result, found = table
        if pin == "rolling":
            return
        power = [row["mu"] * row["w_N_m"] * B * row["v_slide_m_s"] for row in found.rows]
        mean = 2 * ZP / (2 * math.pi) * np.trapezoid(power, dx=math.pi / 180)
        assert float(result["mesh.P_loss"][0]) == pytest.approx(mean, rel=5e-3)


def test_cases_for_a_contact_solver(scenario: Scenario) -> None:
    flat = model(scenario.spec)
    result = steady(flat, scenario.operating_point)
    part = next(p for p in assemble(scenario.spec).parts if isinstance(p, CycloidPinStage))
    values = values_of(part, flat, result)
    cycle = part.mesh_cycle(values)
    assert len(cycle) == 15
    assert all(case.F > 0 and case.R_x > 0 and abs(case.u_1 + case.u_2) > 0 for case in cycle)
    assert np.diff([case.time for case in cycle]) == pytest.approx(math.pi / 15 / W_CRANK, rel=1e-9)
    one = part.contact_case(values, math.radians(60))
    row = part.contact_table(values).rows[60]
    assert one.F / one.length == pytest.approx(row["w_N_m"], rel=1e-12)
    assert abs(one.u_1 + one.u_2) / 2 == pytest.approx(row["U_m_s"], rel=1e-12)


def test_held_pins_lose_more(scenario: Scenario, rated: dict[str, float]) -> None:
    held = steady(model(scenario.spec.with_values({"mesh.pin": "held"})), scenario.operating_point)
    assert float(held["mesh.P_loss"][0]) > 1.5 * rated["mesh.P_loss"]


@pytest.mark.parametrize(
    ("values", "told"),
    [
        ({"mesh.Zp": 2.0, "mesh.Zc": 1.0}, "Zp"),
        ({"mesh.Zc": 38.0}, "Give one lobe less than pins"),
        ({"mesh.e": 0.0017}, "no cusps"),
        ({"mesh.r_rp": 0.0047}, "undercut"),
        ({"mesh.e": 0.00135, "mesh.r_rp": 0.0047}, "Give a smaller e or r_rp, or a larger Rp"),
        ({"mesh.r_rp": 0.0055}, "neighbouring pins"),
        ({"mesh.a_0": 0.07}, "inside the pin circle"),
        ({"mesh.pin": "loose"}, "held, rolling"),
    ],
    ids=str,
)
def test_what_no_stage_can_be_is_refused_by_name(scenario: Scenario, values: dict[str, float], told: str) -> None:
    with pytest.raises(ScenarioError) as raised:
        assemble(scenario.spec.with_values(values))
    assert any("mesh" in problem and told in problem for problem in raised.value.problems), raised.value.problems
