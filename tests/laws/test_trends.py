"""Where physics says more or less, the laws say it too, over their whole range."""

import math
from functools import partial

import pytest
from gearheat.model.laws import churning, conduction, convection, film, mesh, oil, radiation, rolling
from hypothesis import given, strategies as st

SLACK = 1 + 1e-9
speed = st.floats(0.0, 500.0)
factor = st.floats(1.001, 5.0)
load = st.floats(0.0, 5e4)
viscosity = st.floats(3e-6, 1e-3)


@given(st.floats(250.0, 420.0), st.floats(0.5, 30.0), st.floats(20e-6, 700e-6), st.floats(0.06, 0.3))
def test_hot_oil_is_thinner(T: float, dT: float, nu_40: float, share: float) -> None:
    nu_100 = max(share * nu_40, 2e-6)
    assert oil.kinematic_viscosity(T + dT, nu_40, nu_100) < oil.kinematic_viscosity(T, nu_40, nu_100)


@given(st.floats(30e-6, 700e-6), st.floats(0.06, 0.3))
def test_line_passes_through_its_points(nu_40: float, share: float) -> None:
    assert oil.kinematic_viscosity(313.15, nu_40, share * nu_40) == pytest.approx(nu_40, rel=1e-9)
    assert oil.kinematic_viscosity(373.15, nu_40, share * nu_40) == pytest.approx(share * nu_40, rel=1e-9)


@given(st.floats(270.0, 400.0), st.floats(50e-6, 500e-6))
def test_thermoviscosity_is_the_slope_of_the_line(T: float, nu_40: float) -> None:
    nu_100 = 0.12 * nu_40
    _, n = oil.walther_constants(nu_40, nu_100)
    low, nu, high = (oil.kinematic_viscosity(T + dT, nu_40, nu_100) for dT in (-0.01, 0, 0.01))
    assert oil.thermoviscosity(T, nu, n) == pytest.approx((low - high) / 0.02 / nu, rel=1e-5)


@given(load, factor, st.floats(0.01, 20.0), factor)
def test_tooth_friction(F: float, more: float, v: float, faster: float) -> None:
    """More load, more friction; more speed, less."""

    def mu(F_n_l: float, v_sum: float) -> float:
        return mesh.friction_schlenk(F_n_l, v_sum, 0.006, 0.05, 0.6e-6, 0.7)

    assert mu(more * F, v) >= mu(F, v)
    assert mu(F, faster * v) < mu(F, v)


@given(st.floats(0.01, 20.0), factor, st.floats(1e2, 1e6), factor)
def test_film(u: float, faster: float, F: float, more: float) -> None:
    """More speed, thicker; more load, thinner; heating never thickens."""

    def h(u_sum: float, F_n_l: float) -> float:
        return film.film_thickness(0.05, u_sum, 15e-9, F_n_l, 0.006, 113e9)

    assert h(faster * u, F) > h(u, F)
    assert h(u, more * F) < h(u, F)
    assert film.thermal_film_reduction(0.03, 0.05, faster * u, 0.13, 0.2) < 1


@given(speed, factor, viscosity, load, load)
def test_bearing(w: float, more: float, nu: float, F_r: float, F_a: float) -> None:
    """Speed and viscosity lower every reduction factor; load raises every variable."""
    d_m, faster = 0.1175, more * w + 0.1
    assert rolling.shear_heating(faster, nu, d_m) < rolling.shear_heating(w, nu, d_m) <= 1
    assert rolling.boundary_share(faster, nu, d_m) <= rolling.boundary_share(w, nu, d_m) <= 1
    exponents = [rolling.starvation_exponent(n, nu, 0.085, 0.15, 3e-8, 3.1) for n in (faster, w)]
    assert rolling.starvation(exponents[0], 0.9) <= rolling.starvation(exponents[1], 0.9) <= 1
    assert rolling.rolling_torque(1.0, faster, nu, 1.0) > rolling.rolling_torque(1.0, w, nu, 1.0) > 0
    assert rolling.needle_torque_viscous(faster, nu, 0.044, 7) >= rolling.needle_torque_viscous(w, nu, 0.044, 7) > 0
    ball = (d_m, 3.9e-7, 1.7, 64e3)
    roller = (0.14, 2.38e-6, 10.9, 1.4)
    assert rolling.dgb_rolling_variable(more * F_r, F_a, *ball) * SLACK >= rolling.dgb_rolling_variable(F_r, F_a, *ball)
    assert rolling.trb_rolling_variable(F_r, more * F_a, *roller) * SLACK >= rolling.trb_rolling_variable(
        F_r, F_a, *roller
    )
    ball, roller = (d_m, 3.23e-3, 36.5, 64e3), (0.14, 0.014, 2.0, 1.4)
    assert rolling.dgb_sliding_variable(F_r, more * F_a, *ball) * SLACK >= rolling.dgb_sliding_variable(F_r, F_a, *ball)
    assert rolling.trb_sliding_variable(more * F_r, F_a, *roller) * SLACK >= rolling.trb_sliding_variable(
        F_r, F_a, *roller
    )


@given(st.floats(1.0, 500.0), factor, st.floats(0.05, 1.2), st.floats(0.0, 2e-3))
def test_drag(w: float, faster: float, level: float, V_M: float) -> None:
    """More speed, more drag, in ball and roller bearings; a higher level, a higher factor."""
    ball = (60e-6, 0.085, 0.15, level * 0.1175, V_M, 3.1)
    assert rolling.drag_torque_ball(faster * w, *ball) > rolling.drag_torque_ball(w, *ball) >= 0
    roller = (60e-6, 0.11, 0.17, 0.038, level * 0.14, V_M, 6, 0.7)
    assert rolling.drag_torque_roller(faster * w, *roller) > rolling.drag_torque_roller(w, *roller) >= 0
    for is_roller in (True, False):
        higher = rolling.drag_loss_factor(1.01 * level, roller=is_roller)
        assert higher > rolling.drag_loss_factor(level, roller=is_roller)


COLDER = st.floats(1.001, 1e4)
#: From thin hot oil to the thickest there is.
any_viscosity = st.floats(2e-6, 10.0)


@given(st.floats(0.0, 1000.0), any_viscosity, COLDER, st.sampled_from([0.0, 3e-8, 6e-8]), st.floats(0.02, 0.4))
def test_thicker_oil_never_drags_less(w: float, nu: float, thicker: float, K_rs: float, d: float) -> None:
    """Rolling with inlet heating and starvation, drag of bearings, needles: rising with viscosity everywhere."""
    D = 1.9 * d
    d_m = (d + D) / 2

    def torques(nu: float) -> list[float]:
        phi = rolling.shear_heating(w, nu, d_m)
        phi *= rolling.starvation(rolling.starvation_exponent(w, nu, d, D, K_rs, 3.1), phi)
        return [
            rolling.rolling_torque(1.0, w, nu, phi),
            rolling.drag_torque_ball(w, nu, d, D, 0.4 * d_m, 3e-4, 3.1),
            rolling.drag_torque_roller(w, nu, d, D, 0.3 * d, 0.9 * d_m, 3e-4, 6, 0.7),
            rolling.needle_torque_viscous(w, nu, d_m, 7.0),
            churning.churning_torque(w, 860.0, nu, 50.0, 2.5, 0.2),
        ]

    for thin, thick in zip(torques(nu), torques(thicker * nu), strict=True):
        assert thick * SLACK >= thin


def test_starvation_does_not_free_a_cold_bearing() -> None:
    """A 6306 at 1450 rpm in oil of 44 700 mm2/s: the printed factor leaves 1e-11 of its rolling torque."""
    w, nu, d, D = 1450 * math.pi / 30, 44.7e-3, 0.030, 0.072
    s = rolling.starvation_exponent(w, nu, d, D, 3e-8, 3.1)
    assert math.exp(-s) < 1e-10
    assert rolling.starvation(s, rolling.shear_heating(w, nu, 0.051)) > 0.5
    assert rolling.starvation(0.1, 0.95) == pytest.approx(math.exp(-0.1), rel=1e-7)


def test_drag_is_the_printed_one_up_to_its_largest_viscosity() -> None:
    """nu^1.379 below 500 mm2/s, nu beyond it."""

    def drag(nu: float) -> float:
        return rolling.drag_torque_ball(50.0, nu, 0.085, 0.15, 0.05, 0.0, 3.1)

    assert drag(100e-6) / drag(50e-6) == pytest.approx(2**1.379, rel=1e-5)
    assert drag(0.2) / drag(0.1) == pytest.approx(2.0, rel=1e-3)


@given(st.floats(1e-3, 2e4), COLDER)
def test_tooth_friction_stops_falling_on_a_full_film(eta: float, thicker: float) -> None:
    """eta^-0.05 in mixed friction, as printed; beyond 1 Pa.s only the rounding of the corner is left."""

    def mu(eta_oil: float) -> float:
        return mesh.friction_schlenk(1e5, 5.0, 0.006, eta_oil, 0.6e-6, 0.7)

    full_film = mu(1e6)
    assert full_film * (1 - 1e-12) <= mu(thicker * eta) <= mu(eta) * (1 + 1e-12)
    assert full_film == pytest.approx(mu(1.0), rel=5e-3)
    assert mu(0.1) / mu(0.2) == pytest.approx(2**0.05, rel=1e-6)


@given(st.floats(0.0, 1e6), st.floats(0.0, 1e6), factor)
def test_ball_bearing_slides_by_one_law_under_radial_and_axial_load(F_r: float, F_a: float, more: float) -> None:
    """The catalogue's two formulas at the ends, and more axial load never slides less."""
    d_mm, S_1, S_2, C_0 = 51.0, 3.73e-3, 36.5, 16e3

    def sliding(F_r: float, F_a: float) -> float:
        return rolling.dgb_sliding_variable(F_r, F_a, 1e-3 * d_mm, S_1, S_2, C_0)

    assert sliding(F_r, more * F_a) * SLACK >= sliding(F_r, F_a)
    if F_r > 100:
        assert sliding(F_r, 0.0) == pytest.approx(S_1 * d_mm**-0.26 * F_r ** (5 / 3), rel=1e-3)
    if 100 < F_r < 5 * C_0:
        axial = S_2 * d_mm**1.5 * F_r**4 / math.sin(math.radians(24.6) * min(F_r / C_0, 1.0) ** 0.24)
        printed = S_1 * d_mm**-0.145 * (F_r**5 + axial) ** (1 / 3)
        assert sliding(F_r, F_r) == pytest.approx(printed, rel=0.011)  # 1/C_0 rounding; 0.1 % below half of C_0
    if 100 < F_a < 0.5 * C_0:
        axial = S_2 * d_mm**1.5 * F_a**4 / math.sin(math.radians(24.6) * (F_a / C_0) ** 0.24)
        assert sliding(0.0, F_a) == pytest.approx(S_1 * d_mm**-0.145 * axial ** (1 / 3), rel=1e-5)


def test_needle_torque_joins_the_branches() -> None:
    """Both printed branches beside nu n = 2000, and no jump at it."""
    nu, d_m, f_0 = 15e-6, 0.044, 7.0
    torque = {n: rolling.needle_torque_viscous(n * math.pi / 30, nu, d_m, f_0) for n in (20, 1999 / 15, 2001 / 15, 750)}
    assert torque[20] == pytest.approx(1.6e-8 * f_0 * 44**3, rel=1e-5)
    assert torque[750] == pytest.approx(1e-10 * f_0 * (15 * 750) ** (2 / 3) * 44**3, rel=1e-5)
    assert torque[2001 / 15] == pytest.approx(torque[1999 / 15], rel=1e-3)


@given(speed, factor, st.floats(1.0, 4.0), st.floats(-0.3, 0.5))
def test_churning(w: float, faster: float, a: float, b: float) -> None:
    power = churning.churning_loss(w, 835.0, 75e-6, 50.0, a, b)
    assert churning.churning_loss(faster * w, 835.0, 75e-6, 50.0, a, b) >= power >= 0
    torque = churning.churning_torque(w, 835.0, 75e-6, 50.0, a, b)
    assert torque * math.hypot(w, 1e-2) == pytest.approx(power, rel=1e-9)


def test_churning_at_its_reference_point() -> None:
    w = 200 * math.pi / 30
    for a, b in ((1.0, 0.5), (2.5, -0.3), (4.0, 0.0)):
        assert churning.churning_loss(w, 835.0, 75e-6, 50.0, a, b) == pytest.approx(50.0, rel=1e-5)


@pytest.mark.parametrize(
    "h",
    [
        convection.natural_vertical_plate,
        convection.natural_horizontal_cylinder,
        convection.natural_horizontal,
        partial(convection.natural_horizontal, up=False),
    ],
)
def test_free_convection_grows_with_the_difference(h: object) -> None:
    for T_air in (270.0, 300.0):
        warm = [h(T_air + dT, T_air, 0.3) for dT in (0.5, 1, 3, 10, 30, 100)]
        assert warm == sorted(warm)
        cold = [h(T_air - dT, T_air, 0.3) for dT in (0.5, 1, 3, 10, 30)]
        assert cold == sorted(cold)


def test_hot_plate_up_is_cold_plate_down() -> None:
    """Buoyancy: the two are mirror images, up to the film temperature."""
    up = convection.natural_horizontal(320.0, 300.0, 0.3)
    down = convection.natural_horizontal(320.0, 300.0, 0.3, up=False)
    assert up > 1.5 * down
    assert convection.natural_horizontal(300.0, 320.0, 0.3, up=False) == pytest.approx(up, rel=1e-5)
    assert convection.natural_horizontal(300.0, 320.0, 0.3) == pytest.approx(down, rel=1e-5)


def test_worked_examples_with_air_of_our_own() -> None:
    """Incropera2007 9.2 and 7.4, Cengel2003 9-1: 7.0, 96.0 and 5.869 W/(m2.K), to the 2 % of the air's properties."""
    assert convection.natural_vertical_plate(505.0, 296.0, 0.71) == pytest.approx(7.0, rel=0.02)
    assert convection.forced_cylinder(10.0, 350.0, 0.0127) == pytest.approx(96.0, rel=0.02)
    assert convection.natural_horizontal_cylinder(343.15, 293.15, 0.08) == pytest.approx(5.869, rel=0.02)


@given(st.floats(0.0, 20.0), st.floats(0.01, 5.0), st.floats(280.0, 400.0))
def test_wind(v: float, dv: float, T_film: float) -> None:
    assert convection.forced_plate(v + dv, T_film, 0.3) > convection.forced_plate(v, T_film, 0.3)
    assert convection.forced_cylinder(v + dv, T_film, 0.3) > convection.forced_cylinder(v, T_film, 0.3)


@given(st.floats(0.1, 50.0), st.floats(0.0, 50.0))
def test_mixed_is_above_both(h_natural: float, h_forced: float) -> None:
    h = convection.mixed(h_natural, h_forced)
    assert max(h_natural, h_forced) * (1 - 1e-6) <= h <= (h_natural + h_forced) * SLACK


@pytest.mark.parametrize("Ra", [1e4, 1e6, 9e6, 1.1e7, 1e9, 1e11])
def test_unstable_plate_meets_both_branches_of_the_source(Ra: float) -> None:
    """0.54 Ra^(1/4) or 0.15 Ra^(1/3), whichever is larger, with at most 3.6 % more where they meet."""
    larger = max(0.54 * Ra**0.25, 0.15 * Ra ** (1 / 3))
    assert larger <= convection.nusselt_plate_unstable(Ra) <= larger * 1.036
    if not 5e5 < Ra < 5e7:
        assert convection.nusselt_plate_unstable(Ra) == pytest.approx(larger, rel=1e-3)


@given(st.floats(250.0, 500.0), st.floats(250.0, 500.0))
def test_radiation_goes_from_hot_to_cold(T_1: float, T_2: float) -> None:
    assert radiation.radiated(T_1, T_2, 0.5, 0.9) * (T_1 - T_2) >= 0


@given(st.floats(0.0, 200.0), st.floats(0.1, 50.0))
def test_fin(h: float, dh: float) -> None:
    """Without convection a fin is as warm as its root; the more convection, the less."""
    assert conduction.fin_efficiency(0.0, 100.0, 0.004, 0.03) == pytest.approx(1.0, rel=1e-6)
    more = conduction.fin_efficiency(h + dh, 100.0, 0.004, 0.03)
    assert more < conduction.fin_efficiency(h, 100.0, 0.004, 0.03) <= 1


def test_thin_cylinder_wall_is_a_plane_wall() -> None:
    cylinder = conduction.cylinder_wall(50.0, 0.3, 0.1, 0.1001)
    assert cylinder == pytest.approx(conduction.plane_wall(50.0, 2 * math.pi * 0.10005 * 0.3, 0.0001), rel=1e-6)
