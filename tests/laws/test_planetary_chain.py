"""The laws in a row: loss breakdown, line load and film of the planetary gearbox of Dias2014.

What its source prints of the gearbox as a whole stands in the rig's table of published numbers; `verify` asserts it.

The model is the source's own: torque and speed as measured, oil temperature as measured, bearings in grease of the same
temperature, friction of the teeth raised by k_mu = 1.044, ball bearing without boundary friction, needles with f_0 = 7.
"""

import csv
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gearheat.model.laws import film, gears, mesh, oil, rolling, sealing

OILS = {  # nu_40, nu_100 [cSt], rho_15, alpha_T, X_L, s, t
    "PAOR": (324.38, 35.27, 859, -5.6e-4, 0.666, 7.382, 0.1335),
    "MINR": (319.25, 22.41, 902, -5.8e-4, 0.858, 9.904, 0.1390),
    "MINE": (324.38, 37.88, 893, -6.7e-4, 0.746, 9.904, 0.1390),
    "PAGD": (290.26, 51.06, 1059, -7.1e-4, 0.572, 5.489, 0.1485),
}
BETA_B = float(gears.base_helix_angle(math.radians(20), math.radians(10)))
RHO, RHO_RING, A_REF, RA, E_STAR = 0.012563, -0.037689, 0.073111, 0.6e-6, 113.19e9
SIGMA = RA * math.sqrt(2)
MESHES = {"SP": (RHO, 1.666, 0.167709), "PR": (RHO_RING, 1.883, 0.062473)}  # radius, contact ratio, H_V


def table(path: Path) -> list[dict[str, Any]]:
    lines = [line for line in path.read_text("utf-8").splitlines() if not line.startswith("#")]
    return [
        {k: v if k in ("oil", "date", "grid") else float(v) for k, v in row.items()} for row in csv.DictReader(lines)
    ]


RIG = Path(__file__).parents[2] / "scenarios" / "rigs" / "planetary"
BREAKDOWN = table(RIG / "breakdown.csv")
MEASURED = table(RIG / "measured.csv")
POINTS = {(int(r["test"]), int(r["direction"])): r for r in MEASURED}


def viscosity(name: str, T: float) -> tuple[float, float]:
    """Kinematic and dynamic viscosity of an oil."""
    nu_40, nu_100, rho_15, alpha_T, *_ = OILS[name]
    nu = oil.kinematic_viscosity(T, 1e-6 * nu_40, 1e-6 * nu_100)
    return nu, nu * oil.density(T, rho_15, alpha_T)


def contact(point: dict[str, Any], mesh_name: str) -> tuple[float, float, float]:
    """Line load, sum speed and reduced radius at the pitch point, in the carrier's frame."""
    rho_2, eps, _ = MESHES[mesh_name]
    w_4 = point["n_carrier_rpm"] * math.pi / 30
    F_t = point["T_carrier_Nm"] / (6 * A_REF)
    F_bn = F_t / math.cos(gears.transverse_pressure_angle(math.radians(20), math.radians(10))) / math.cos(BETA_B)
    line = gears.contact_length(0.042, eps, BETA_B)
    return mesh.load_per_contact_length(F_bn, line), 2 * 3 * w_4 * RHO, gears.reduced_radius(RHO, rho_2, BETA_B)


def friction(point: dict[str, Any], mesh_name: str) -> float:
    """Friction coefficient of a mesh by the printed formula."""
    _, eta = viscosity(point["oil"], point["T_oil_C"] + 273.15)
    F_n_l, v, R = contact(point, mesh_name)
    return mesh.friction_schlenk(F_n_l, v, R, eta, RA, OILS[point["oil"]][4])


def film_parameter(point: dict[str, Any], mesh_name: str, **choice: float) -> float:
    """Specific film thickness at the pitch point, heating included."""
    T = point["T_oil_C"] + 273.15
    nu_40, nu_100, rho_15, _, _, s, t = OILS[point["oil"]]
    nu, eta = viscosity(point["oil"], T)
    _, n = oil.walther_constants(1e-6 * nu_40, 1e-6 * nu_100)
    F_n_l, v, R = contact(point, mesh_name)
    beta, k = oil.thermoviscosity(T, nu, n), oil.conductivity(T, rho_15)
    h = film.film_thickness(eta, v, oil.pressure_viscosity(nu, s, t), F_n_l, R, E_STAR, **choice)
    return film.specific_film_thickness(h * film.thermal_film_reduction(beta, eta, v, k, 0.0), SIGMA)


def losses(point: dict[str, Any]) -> dict[str, float]:
    """Losses of the gearbox by part [W]."""
    w_4, M_4, T = point["n_carrier_rpm"] * math.pi / 30, point["T_carrier_Nm"], point["T_oil_C"] + 273.15
    F_t = M_4 / (6 * A_REF)
    F_a = F_t * math.tan(math.radians(10))
    nu = oil.kinematic_viscosity(T, 100e-6, 10e-6)  # the grease of the bearings
    gear = sum(
        3 * mesh.mesh_loss(M_4 * w_4 / 4, 1.044 * friction(point, name), MESHES[name][2]) for name in ("SP", "PR")
    )

    mu_trb = rolling.sliding_friction(rolling.boundary_share(w_4, nu, 0.14), 0.10, 0.002)
    G_trb = rolling.trb_rolling_variable(4660, 16500 + F_a, 0.14, 2.38e-6, 10.9, 1.4)
    S_trb = rolling.trb_sliding_variable(4660, 16500 + F_a, 0.14, 0.014, 2, 1.4)
    trb = rolling.rolling_torque(G_trb, w_4, nu, rolling.shear_heating(w_4, nu, 0.14))
    trb += rolling.sliding_torque(S_trb, mu_trb)

    G_dgb = rolling.dgb_rolling_variable(0, 3 * F_a, 0.1175, 3.9e-7, 1.7, 64e3)
    S_dgb = rolling.dgb_sliding_variable(0, 3 * F_a, 0.1175, 3.23e-3, 36.5, 64e3)
    dgb = rolling.rolling_torque(G_dgb, 4 * w_4, nu, rolling.shear_heating(4 * w_4, nu, 0.1175))
    dgb += rolling.sliding_torque(S_dgb, 0.02)

    P_1 = math.hypot(F_t, 2 * F_a * 0.036555 / 0.021)
    needle = rolling.needle_torque_viscous(3 * w_4, nu, 0.044, 7) + rolling.needle_torque_load(P_1, 0.044, 0.0002)
    seal = sealing.lip_seal_torque(0.14) + 4 * sealing.lip_seal_torque(0.085)
    parts = {
        "mesh": gear,
        "trb": 2 * trb * w_4,
        "dgb": dgb * 4 * w_4,
        "needle": 6 * needle * 3 * w_4,
        "seal": seal * w_4,
    }
    return {name: float(value) for name, value in parts.items()}


@pytest.mark.parametrize("row", BREAKDOWN, ids=lambda r: f"test {r['test']:.0f}")
def test_breakdown(row: dict[str, Any]) -> None:
    """Every cell within the stated 0.3 W, and the total in both directions."""
    found = losses(POINTS[int(row["test"]), 1])
    for name, value in found.items():
        assert abs(value - row[f"P_{name}_W"]) < 0.3, name
    for direction in (1, 2):
        total = sum(losses(POINTS[int(row["test"]), direction]).values())
        assert abs(total - row[f"P_total_{direction}_W"]) < 0.3


# ------------------------------------------------------------------------------------------------ printed numbers


def nominal() -> dict[str, Any]:
    return {"oil": "PAOR", "n_carrier_rpm": 250.0, "T_carrier_Nm": 2500.0, "T_oil_C": 85.0}


def test_printed_coefficients_of_the_gear_program_tell_the_line_load() -> None:
    """The second sheet of appendix D prints 0.058 and 0.047: their ratio is that of a load per face width."""
    point = nominal()
    per_length = friction(point, "SP") / friction(point, "PR")
    per_width = per_length * (MESHES["SP"][1] / MESHES["PR"][1]) ** 0.2
    low, high = 0.0575 / 0.0475, 0.0585 / 0.0465
    assert low < per_width < high
    assert not low < per_length < high


def test_factor_on_the_friction_belongs_to_the_line_load() -> None:
    """1.044 with the load per contact length is 0.943 (sun) and 0.920 (ring) with that per face width."""
    point = nominal()
    _, eta = viscosity(point["oil"], point["T_oil_C"] + 273.15)
    F_bt = 2500 / (6 * A_REF) / math.cos(gears.transverse_pressure_angle(math.radians(20), math.radians(10)))
    for name, k_mu in (("SP", 0.943), ("PR", 0.920)):
        _, v, R = contact(point, name)
        printed = mesh.friction_schlenk(mesh.load_per_face_width(F_bt, 0.042), v, R, eta, RA, OILS["PAOR"][4])
        assert k_mu * printed == pytest.approx(1.044 * friction(point, name), rel=1e-3)


# ------------------------------------------------------------------------------------------------- film thickness

FIRST_GRID = range(1, 17)


def lambdas(mesh_name: str, **choice: float) -> dict[tuple[int, int], float]:
    """Specific film thickness of the first grid by nominal speed and torque."""
    points = [POINTS[test, 1] for test in FIRST_GRID]
    return {(int(p["n_set_rpm"]), int(p["T_set_Nm"])): film_parameter(p, mesh_name, **choice) for p in points}


def test_plain_radius_contradicts_the_printed_film_statement() -> None:
    """The source's "equivalent radius" is twice the reduced radius, 2^0.364 = 1.287 in the film."""
    plain = lambdas("PR", radius_factor=1.0)
    assert max(plain.values()) < 0.7
    for point, value in lambdas("PR").items():
        assert value / plain[point] == pytest.approx(2**0.364, rel=1e-9)


def test_twice_the_radius_is_grubins_formula() -> None:
    """h/R = 1.95 (alpha eta u_mean / R)^(8/11) (E' R l / F)^(1/11) with E' = 2 E*, to the rounding of the exponents."""
    eta, u, alpha, F, R = 0.04, 2.0, 15e-9, 8e4, 0.01
    h = film.film_thickness(eta, u, alpha, F, R, E_STAR)
    grubin = 1.95 * R * (alpha * eta * (u / 2) / R) ** (8 / 11) * (2 * E_STAR * R / F) ** (1 / 11)
    assert h == pytest.approx(grubin, rel=0.01)


def test_thermal_factor_of_the_misprint() -> None:
    """1.48 for 14.8 makes the film 2 to 7 % thicker at the sliding of gears; nothing at the pitch point."""
    arguments = (0.031, 0.0448, 2.0, 0.138)  # PAOR at 85 degC, 250 rpm
    assert film.thermal_film_reduction(*arguments, 0.0, coefficient=1.48) == film.thermal_film_reduction(
        *arguments, 0.0
    )
    changes = [
        film.thermal_film_reduction(*arguments, s, coefficient=1.48) / film.thermal_film_reduction(*arguments, s) - 1
        for s in (0.1, 0.2, 0.3)
    ]
    assert changes == sorted(changes)
    assert 0.02 < changes[0] < changes[-1] < 0.07


# ------------------------------------------------------------------------------------------------- tooth loss factor


@pytest.mark.parametrize("eps", [(0.833, 0.833), (1.05, 0.833), (0.4, 0.75), (1.3, 1.25), (0.9, 1.8), (2.2, 1.1)])
def test_tooth_loss_factor_is_the_integral_over_equally_loaded_pairs(eps: tuple[float, float]) -> None:
    """2/p times the integral of |x| dx over the path of contact, over the number of pairs in contact."""
    x = np.linspace(-eps[0], eps[1], 200001)
    x = 0.5 * (x[1:] + x[:-1])
    pairs = sum((-eps[0] <= x + shift) & (x + shift <= eps[1]) for shift in range(-6, 7))
    integral = 2 * np.mean(np.abs(x) / pairs) * (eps[0] + eps[1])
    assert mesh.tooth_loss_factor(36, 1, 0.0, *eps) == pytest.approx(math.pi * 2 / 36 * integral, rel=1e-4)


def test_tooth_loss_factor_is_ohlendorfs_below_two() -> None:
    found = mesh.tooth_loss_factor(20, 2.5, 0.2, 0.7, 0.8)
    expected = math.pi * 3.5 / (20 * 2.5 * math.cos(0.2)) * (1 - 1.5 + 0.7**2 + 0.8**2)
    assert found == pytest.approx(expected, rel=1e-12)


# ------------------------------------------------------------------------------------------------- viscosity


def walther(T: float, m: float, n: float) -> float:
    """Kinematic viscosity [cSt] by the Walther equation in its printed form."""
    return 10**10 ** (m - n * math.log10(T)) - 0.7


def test_grease_through_explicit_constants_meets_the_printed_moments() -> None:
    """Viscosity at 85 degC from the two printed rolling moments: 15.2562 and 15.2550 cSt."""
    m, n = oil.walther_constants(100e-6, 10e-6)
    assert walther(358.15, m, n) == pytest.approx(15.2556, abs=0.001)


@pytest.mark.parametrize("name", OILS)
@pytest.mark.parametrize("T", [253.15, 313.15, 343.15, 373.15, 413.15])
def test_both_forms_of_the_walther_line_agree(name: str, T: float) -> None:
    nu_40, nu_100 = 1e-6 * OILS[name][0], 1e-6 * OILS[name][1]
    explicit = walther(T, *oil.walther_constants(nu_40, nu_100))
    assert 1e6 * oil.kinematic_viscosity(T, nu_40, nu_100) == pytest.approx(explicit, rel=1e-10)
