"""Drum motors: with the harmonic drive of the source, and with a planetary set in its place."""

import math
from functools import cache

import numpy as np
import pytest
from gearheat.model.core.flat import FlatModel
from gearheat.model.errors import ScenarioError, SolveError
from gearheat.model.laws.convection import mixed, natural_horizontal_cylinder
from gearheat.model.laws.drum import drum_heat, forced_rotating_cylinder, lumped_temperature, source_coefficient
from gearheat.model.machines.spec import assemble
from gearheat.model.run.design import design
from gearheat.model.run.steady import steady
from gearheat.scenarios.load import load
from hypothesis import given, settings, strategies as st

RIGS = ("drum_motor", "drum_motor_planetary")
RPM = math.pi / 30
AREA = 0.764
#: What a bare drum gives away, radiation included, as the source's corrected balance has it [W/(m2.K)].
BARE = 15.3


@cache
def flat_of(rig: str, drive: tuple[tuple[str, tuple[str, ...]], ...] = (), **values: object) -> FlatModel:
    spec = load(rig).spec.with_values({k.replace("__", "."): v for k, v in values.items()})
    return spec.driven(dict(drive)) if drive else spec.flat()


def at(flat: FlatModel, **values: float) -> dict[str, float]:
    """Everything at a steady state; inputs and parameters as belt__h=..."""
    found = steady(flat, {k.replace("__", "."): v for k, v in values.items()})
    assert found.audit.residual < 1e-9
    return {name: float(column[0]) for name, column in found.columns.items()}


@pytest.mark.parametrize(("h_belt", "published"), [(0.0, 111.0), (4.7, 91.0), (24.7, 58.0), (44.7, 47.0)])
def test_belt_decides_how_warm_the_drum_is(h_belt: float, published: float) -> None:
    """The one body of the source against the model, whose motor and gear lose what the temperature lets them."""
    found = at(flat_of("drum_motor"), belt__h=h_belt)
    assert found["oil.T"] - 273.15 == pytest.approx(published, abs=7.0)
    one_body = lumped_temperature(found["room.Q_flow"], BARE + h_belt, AREA, found["room.T"])
    assert found["shell.T"] == pytest.approx(one_body, abs=6.0)
    assert found["windings.T"] > found["oil.T"] > found["shell.T"] > found["room.T"]


def test_loss_is_that_of_the_source() -> None:
    found = at(flat_of("drum_motor"), belt__h=20.0)
    heat = drum_heat(2200.0, 0.82, found["efficiency.eta"])
    assert found["room.Q_flow"] == pytest.approx(heat, rel=1e-4)
    assert found["room.Q_flow"] == pytest.approx(1010.0, rel=0.02)


def test_design_finds_the_belt_that_keeps_the_oil_at_70_degC() -> None:
    """The target is met from about 30 W/(m2.K) in all, so 15 to the belt."""
    flat = flat_of("drum_motor")
    found = design(flat, ["belt.h"], {"oil.T": 343.15}, {})
    assert 12.0 < found.values["belt.h"] < 20.0
    assert at(flat, belt__h=found.values["belt.h"])["oil.T"] == pytest.approx(343.15, abs=1e-6)


def test_hot_oil_means_less_churning_and_a_thinner_film() -> None:
    warm, hot = (at(flat_of("drum_motor"), room__T=T) for T in (293.15, 313.15))
    assert hot["oil.T"] > warm["oil.T"] + 5.0
    assert hot["churning.P_loss"] < warm["churning.P_loss"]
    assert hot["mesh.h_min"] < warm["mesh.h_min"]


@pytest.mark.parametrize("rig", RIGS)
class TestEveryDrumMotor:
    def test_the_motor_has_its_efficiency_at_the_rated_point(self, rig: str) -> None:
        found = at(flat_of(rig))
        assert found["motor_shaft.P"] / found["motor.P_electric"] == pytest.approx(0.82, abs=1e-5)

    def test_a_driven_motor_feeds_back_less_than_it_gets(self, rig: str) -> None:
        rated = load(rig).operating_point["motor_shaft.tau"]
        found = at(flat_of(rig), motor_shaft__tau=-rated)
        assert found["motor_shaft.P"] < found["motor.P_electric"] < 0.0
        assert found["motor.P_loss"] == pytest.approx(at(flat_of(rig))["motor.P_loss"], rel=1e-9)
        assert found["drum.P"] + found["motor_shaft.P"] == pytest.approx(found["efficiency.P_loss"], rel=1e-9)

    def test_at_rest_without_load_nothing_is_lost(self, rig: str) -> None:
        found = at(flat_of(rig), motor_shaft__tau=0.0, motor_shaft__w=0.0)
        assert found["motor.P_electric"] == 0.0
        assert found["oil.T"] == pytest.approx(found["room.T"], abs=1e-3)

    def test_churning_is_lost_without_load_and_more_of_it_cold(self, rig: str) -> None:
        idle = at(flat_of(rig), motor_shaft__tau=0.0)
        cold = at(flat_of(rig), motor_shaft__tau=0.0, room__T=263.15)
        assert cold["churning.P_loss"] > idle["churning.P_loss"] > 1.0

    def test_more_oil_is_churned_and_reaches_more_of_the_drum(self, rig: str) -> None:
        half, low = (at(flat_of(rig), oil__beta=beta) for beta in (1.0, 0.3))
        assert half["oil.V"] > low["oil.V"]
        assert half["churning.tau_loss"] > 1.5 * low["churning.tau_loss"]
        assert half["oil.T"] - half["shell.T"] < low["oil.T"] - low["shell.T"]

    def test_air_cools(self, rig: str) -> None:
        T = [at(flat_of(rig), room__air_speed=v)["oil.T"] for v in (0.0, 1.0, 3.0)]
        assert T[0] > T[1] > T[2]

    def test_a_warm_belt_takes_less(self, rig: str) -> None:
        cold, warm = (at(flat_of(rig), belt__h=20.0, belt__dT_belt=dT) for dT in (0.0, 10.0))
        assert cold["oil.T"] < warm["oil.T"] < cold["oil.T"] + 10.0

    def test_the_source_s_coefficient_can_be_chosen(self, rig: str) -> None:
        printed = dict(cooling__P_N=2200.0, cooling__psi_1=1.0, cooling__psi_2=1.0, cooling__A_belt=0.3)
        found = at(flat_of(rig, cooling__coefficient="source", **printed))
        K = source_coefficient(2200.0, 0.32, abs(found["drum.w"]) * 0.16)
        assert found["cooling.h"] == pytest.approx(K, rel=1e-12)
        assert found["shell.T"] == pytest.approx(lumped_temperature(found["room.Q_flow"], K, AREA, 298.15), abs=1e-6)

    @pytest.mark.parametrize("eta", [0.0, 1.0, 1.2, -0.1, math.nan])
    def test_an_efficiency_outside_0_to_1_is_refused(self, rig: str, eta: float) -> None:
        with pytest.raises(ScenarioError, match=r"eta = .* It must be .*(above 0|below 1)|not finite"):
            assemble(load(rig).spec.with_values({"motor.eta": eta}))
        with pytest.raises((ScenarioError, SolveError), match=r"motor\.eta"):
            steady(flat_of(rig), {"motor.eta": eta})

    @pytest.mark.parametrize("beta", [0.0, -0.2, 1.01])
    def test_a_fill_out_of_range_is_refused(self, rig: str, beta: float) -> None:
        with pytest.raises(ScenarioError, match=r"beta = .* out of range"):
            assemble(load(rig).spec.with_values({"oil.beta": beta}))

    def test_an_oil_temperature_that_no_belt_gives_is_refused_by_name(self, rig: str) -> None:
        with pytest.raises(SolveError, match=r"oil\.T"):
            design(flat_of(rig), ["belt.h"], {"oil.T": 280.0}, {})


@settings(max_examples=60, deadline=None)
@given(w=st.floats(0.0, 40.0), faster=st.floats(0.1, 20.0), dT=st.floats(-20.0, 120.0))
def test_a_drum_that_turns_is_cooled_better_either_way(w: float, faster: float, dT: float) -> None:
    """From free convection at rest on, and in both directions alike."""
    T_air, D = 298.15, 0.32
    natural = natural_horizontal_cylinder(T_air + dT, T_air, D)

    def h(speed: float) -> float:
        return float(mixed(natural, forced_rotating_cylinder(speed, T_air + dT / 2, D)))

    assert h(w + faster) > h(w) == h(-w)
    if abs(dT) > 5.0:
        assert h(0.0) == pytest.approx(float(natural), rel=2e-2)


def test_bare_drum_gives_away_what_the_source_s_balance_takes() -> None:
    """15.3 W/(m2.K) with radiation at 111 degC, 57 rpm."""
    spec = load("drum_motor").spec.part("cooling").values
    T, T_air, w = 384.15, 298.15, 57 * RPM
    natural = natural_horizontal_cylinder(T, T_air, spec["D"])
    h = mixed(natural, forced_rotating_cylinder(w, (T + T_air) / 2, spec["D"]))
    radiation = 5.670374e-8 * spec["emissivity"] * (T**4 - T_air**4) / (T - T_air)
    assert h + radiation == pytest.approx(BARE, rel=0.08)  # 7 % of it by free convection beside the rotation


def test_outputs_are_finite_from_cold_to_hot_and_from_rest_to_twice_the_speed() -> None:
    for rig in RIGS:
        flat = flat_of(rig)
        for w, T in ((0.0, 233.15), (0.0, 423.15), (2.0, 293.15)):
            speed = w * load(rig).operating_point["motor_shaft.w"]
            found = at(flat, motor_shaft__w=speed, room__T=T)
            assert all(np.isfinite(v) for v in found.values())
