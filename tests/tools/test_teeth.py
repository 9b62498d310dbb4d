"""`gearheat teeth`: what flanks feel, beside a report of KISSsoft, in rigs, and where there is nothing to feel."""

from __future__ import annotations

from dataclasses import replace
from math import isfinite, pi, radians

import gearheat as gh
import pytest
from gearheat.model.laws.oil import kinematic_viscosity
from gearheat.model.parts.flanks import Flanks
from gearheat.tools.films.flank_methods import MicropittingTest, Rating, along, mean_flash, rate

RIG = "helical_two_stage"
#: Third stage of the 5 MW reference gearbox, see model/golden/tooth_flanks.toml.
STAGE_3 = Flanks(
    name="stage 3",
    z=(24.0, 95.0),
    alpha_t=radians(20.284),
    alpha_wt=radians(22.856),
    beta_b=radians(9.391),
    r_b=0.160013,
    eps=(0.852, 0.611),
    eps_beta=1.421,
    b=0.36,
    a_w=0.861,
    Ra=0.6e-6,
    E_eff=206e9 / 0.91,
    F_bt=40953.0 / 0.160013,
    w=1165.9 * pi / 30,
    mu=0.041,
)


def report_oil(T: float) -> tuple[float, float]:
    """The report's mineral oil, 2.162e-8 1/Pa at 38 degC, warmed as ISO/TR 15144-1 has it."""
    eta = float(kinematic_viscosity(T, 220e-6, 19e-6)) * (890 - 0.7 * (T - 289.15))
    return eta, 2.162e-8 * (1 + 516 * (1 / T - 1 / 311.15))


@pytest.fixture(scope="module")
def report():
    oil = Rating(1.25 * 1.092 * 1.15 * 1.069, 14, 10, report_oil, 353.15, 1.0, 220e-6)
    return rate(STAGE_3, 358.15, oil)


def test_the_geometry_is_that_of_the_report():
    assert 1e3 * STAGE_3.path == pytest.approx(61.276, abs=0.02)
    assert 1e3 * STAGE_3.rho_C == pytest.approx(67.447, abs=0.01)
    R, v_1, v_2 = STAGE_3.at(0.0)
    assert pytest.approx(37.122, rel=1e-3) == 1e3 * R
    assert v_2 - v_1 == pytest.approx(3.912, abs=0.01)
    assert pytest.approx(5e6, rel=1e-3) == STAGE_3.P


def test_the_methods_give_what_the_report_prints(report):
    """Tip relief of 2 um is left out here: the integral flash is 2 % more."""
    points, found = report
    assert found["integral"]["mu"] == pytest.approx(0.030, abs=5e-4)
    assert found["integral"]["T_bulk_C"] == pytest.approx(91.37, abs=0.5)
    assert found["integral"]["T_integral_C"] == pytest.approx(115.75, abs=1.0)
    assert found["micropitting"]["T_bulk_C"] == pytest.approx(85.0, abs=0.05)
    assert found["micropitting"]["lambda_GF"] == pytest.approx(1.053, rel=0.01)
    assert found["limit"]["T_scuffing_C"] == pytest.approx(451.98, abs=0.05)
    assert found["limit"]["lambda_GF"] == pytest.approx(0.143, rel=0.06)
    assert points[0].share == pytest.approx(0.889, abs=5e-4)
    assert 1e-6 * points[0].p == pytest.approx(1014.7, rel=1e-3)


def test_the_flash_along_the_path_is_that_of_the_report(report):
    """By the report's own friction, printed as 0.041: its mean, and its flash where the contact is hottest."""
    loaded = replace(STAGE_3, F_bt=1.678 * STAGE_3.F_bt)
    points = along(loaded, report_oil, 0.041, 367.34)
    assert mean_flash(points) == pytest.approx(30.20, rel=0.02)
    assert points[-1].flash == pytest.approx(75.31, rel=0.05)
    assert min(point.flash for point in points) < 1  # at the pitch point nothing slides


def test_the_test_gears_feel_what_the_report_prints():
    flanks = MicropittingTest().flanks(10, 206e9 / 0.91)
    R, v_1, v_2 = flanks.at(0.0)
    assert flanks.F_bt / flanks.b * MicropittingTest().share == pytest.approx(236.3e3, rel=1e-3)
    assert pytest.approx(3.897, rel=0.01) == 1e3 * R
    assert (v_1, v_2) == pytest.approx((1.053, 4.784), rel=0.01)


@pytest.fixture(scope="module")
def felt():
    return gh.teeth(RIG)


def test_the_rig_stands_as_it_is(felt):
    hot = gh.steady(RIG)
    for mesh in felt.found["meshes"]:
        network = mesh["columns"]["network"]
        assert network["T_bulk_C"] == pytest.approx(hot.to("gears.T", "degC"), rel=1e-9)
        assert network["mu"] == pytest.approx(hot[f"{mesh['mesh']}.mu"], rel=1e-9)
        assert mesh["T_oil_C"] == pytest.approx(hot.to("oil.T", "degC"), rel=1e-9)
        assert network["T_contact_C"] == pytest.approx(network["T_bulk_C"] + network["flash_K"])
        assert network["T_contact_C"] == pytest.approx(max(point["T"] for point in mesh["path"]) - 273.15)


def test_more_load_is_less_safe_and_a_better_oil_safer(felt):
    def safeties(answer):
        found = [mesh["columns"] for mesh in answer.found["meshes"]]
        return [v for c in found for name, column in c.items() for key, v in column.items() if key.startswith("S_")]

    here = safeties(felt)
    assert len(here) == 12
    assert all(more < less for more, less in zip(safeties(gh.teeth(RIG, load_factor=1.5)), here, strict=True))
    poor = gh.teeth(RIG, scuffing_stage=10, micropitting_stage=8)
    assert all(lower < higher for lower, higher in zip(safeties(poor), here, strict=True))


def test_either_direction_of_rotation_and_power_feels_the_same(felt):
    turned = gh.teeth(RIG, {"input.w": "-1450 rpm", "output.tau": "590 N.m"})
    for one, other in zip(felt.found["meshes"], turned.found["meshes"], strict=True):
        assert one["columns"]["network"] == pytest.approx(other["columns"]["network"], rel=1e-6)


def test_planets_without_friction_turn_all_the_same():
    """Only the flash of the network is none."""
    mesh = gh.teeth("planetary", {"gear_set.k_mu": 0.0}).found["meshes"][0]
    assert mesh["columns"]["network"]["flash_K"] == 0
    assert mesh["columns"]["flash"]["flash_K"] > 5


def test_undercut_teeth_end_before_their_base_circle():
    """Tips of the wheel that reach beyond the pinion's involute touch nothing there."""
    shifted = gh.teeth(RIG, {"stage_2.x_1": -0.45, "stage_2.x_2": 0.45}).found["meshes"][1]
    plain = gh.teeth(RIG).found["meshes"][1]
    assert shifted["path"][0]["y"] < plain["path"][0]["y"]
    assert plain["columns"]["network"]["flash_K"] < shifted["columns"]["network"]["flash_K"] < 200


@pytest.mark.parametrize(
    ("room", "tau"), [("-30 degC", "-40 N.m"), ("-30 degC", "-4000 N.m"), ("60 degC", "-4000 N.m")]
)
def test_cold_and_heavily_loaded_teeth_have_finite_figures(room, tau):
    found = gh.teeth(RIG, {"room.T": room, "output.tau": tau}, load_factor=2.0).found["meshes"]
    assert all(v > 0 for m in found for c in m["columns"].values() for key, v in c.items() if key.startswith("S_"))
    figures = [v for mesh in found for column in mesh["columns"].values() for v in column.values()]
    figures += [v for mesh in found for point in mesh["path"] for v in point.values()]
    assert all(isfinite(v) for v in figures)


def test_a_film_of_teeth_without_load_is_named(gearheat, tmp_path):
    options = ("--part", "stage_1", "-o", tmp_path / "film.csv", "--set", "output.tau=0 N.m")
    answer = gearheat("film", RIG, *options)
    assert answer.code == 2
    assert "a contact without load or speed has no film" in answer.err, answer.err


def test_planets_have_two_kinds_of_meshes(gearheat, tmp_path):
    picture = tmp_path / "teeth.svg"
    found = gearheat("teeth", "planetary", "--plot", picture, "--json", "-").json
    assert [mesh["mesh"] for mesh in found["meshes"]] == ["gear_set.sp", "gear_set.pr"]
    sun, ring = (mesh["columns"]["network"] for mesh in found["meshes"])
    assert ring["flash_K"] < sun["flash_K"]  # flanks that nestle
    assert found["plot"] == str(picture) and picture.stat().st_size > 0


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ((RIG, "--set", "output.tau=0 N.m"), "stage_1 carries"),
        ((RIG, "--set", "input.w=0 rpm"), "without load or speed have no film, friction or safety"),
        (("harmonic",), "no part has involute teeth"),
        ((RIG, "--load-factor", "0"), "--load-factor 0: give a factor above 0"),
        ((RIG, "--scuffing-stage", "15"), "--scuffing-stage 15: the test has load stages. Give one from 1 to 14."),
        ((RIG, "--micropitting-stage", "4"), "Give one from 5 to 10."),
    ],
)
def test_what_cannot_be_felt_is_named(gearheat, arguments, says):
    answer = gearheat("teeth", *arguments)
    assert answer.code == 2
    assert says in answer.err, answer.err
