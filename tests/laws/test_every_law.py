"""What holds for every law: same number for floats and symbols, finite values and slopes at rest, right derivatives.

`NOMINAL` has a value for every argument name; `OWN` overrides it where a name means another thing in one law. An
argument in `ZERO` may vanish and change sign, and is rounded over one of the widths there.
"""

import ast
import importlib
import inspect
import itertools
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
from for_each import for_each
from gearheat.model.laws import convection, smooth
from gearheat.model.sources import sources

NOMINAL = {
    **{"T": 330.0, "nu_40": 320e-6, "nu_100": 30e-6, "nu": 60e-6, "rho": 860.0, "rho_15": 880.0, "alpha_T": -6e-4},
    **{"m": 7.2, "n": 2.73, "s": 8.0, "t": 0.14, "z_sum": 72.0},
    **{"alpha_n": 0.35, "beta": 0.17, "alpha_t": 0.354, "alpha_wt": 0.3512, "beta_b": 0.164},
    **{"a": 0.0731, "a_w": 0.073, "m_n": 0.002, "z": 36.0, "d": 0.085, "x": 0.1},
    **{"d_a": 0.077, "d_b": 0.0686, "p_et": 0.006, "b": 0.042, "eps_alpha": 1.6, "rho_1": 0.0126, "rho_2": 0.02},
    **{"eps_beta": 0.7, "k_r": 0.025},
    **{"z_1": 36.0, "u": 2.0, "eps_1": 0.8, "eps_2": 0.9},
    **{"F_bt": 6e3, "F_bn": 6.1e3, "line_load": 8e4},
    **{"F_n_l": 8e4, "v_sum": 2.0, "u_sum": 2.0, "R": 0.0064, "eta_oil": 0.05, "eta_0": 0.05, "Ra": 0.6e-6, "X_L": 0.7},
    **{"F_t": 2300.0, "d_w1": 0.041, "d_w": 0.041, "H_s": 0.32, "H_t": 0.28, "m_t": 0.003, "dip": 0.16},
    **{"e_max": 0.03, "h_c": 0.1, "l_h": 0.29, "C_Sp": 0.2},
    **{"P_a": 16e3, "mu": 0.035, "H_v": 0.17, "alpha_p": 15e-9, "E_star_eff": 113e9},
    **{"beta_T": 0.03, "k": 0.13, "slide_roll": 0.3, "h": 5e-7, "sigma": 8e-7},
    **{
        "w": 26.0,
        "d_m": 0.1175,
        "K_rs": 3e-8,
        "K_Z": 3.1,
        "K_L": 0.7,
        "i_rw": 2.0,
        "G_rr": 1.05,
        "phi": 0.97,
        "G_sl": 4300.0,
    },
    **{"F_r": 2000.0, "F_a": 1500.0, "R_1": 3.9e-7, "R_2": 1.7, "C_0": 64e3, "S_1": 3.2e-3, "S_2": 36.5, "Y": 1.4},
    **{"phi_bl": 0.3, "mu_bl": 0.1, "mu_EHL": 0.02, "mu_sl": 0.05, "B": 0.028, "H": 0.03, "V_M": 3e-4, "level": 0.4},
    **{"phi_ish": 0.9, "T_pour": 240.0, "f_0": 7.0, "f_1": 2e-4, "P_1": 5000.0, "d_sh": 0.085, "c_sh": 73.4, "c": 50.0},
    **{"R_3": 2.8e-6, "R_4": 5.8, "S_3": 8.8e-3, "S_4": 117.0, "psi": 1e-3, "tau_0": 1.0, "C_trans": 1.0},
    **{"altitude": 800.0, "backlash": 1e-4},
    **{"churning": 2e-4, "friction": 1.5e-4, "slow": 0.4, "fast": 0.8, "thrown": 0.9},
    **{"V": 2e-3, "depth": 0.25, "volume": 0.5, "Fr": 350.0, "width": 0.15},
    **{"T_film": 310.0, "Pr": 0.7, "Re": 5e4, "h_natural": 5.0, "h_forced": 7.0, "A": 0.6},
    **{"T_s": 340.0, "T_f": 300.0, "L": 0.3, "height": 0.3, "v": 1.5, "T_1": 340.0, "T_2": 300.0, "emissivity": 0.9},
    **{"absorptivity": 0.7, "gap": 3e-4, "gap_share": 0.01, "Ta": 80.0, "fill": 0.5, "r_mate": 0.1},
    **{"K": 0.8125, "Zp": 40.0, "Zc": 39.0, "Rp": 0.064, "e": 0.0013, "r_rp": 0.003, "theta": 1.0, "kappa": 215.0},
    **{"T_disc": 206.0, "w_crank": 61.0, "v_slide": 0.15, "v_contact": 0.08, "roll": 0.4, "w_l": 4e4, "E_eff": 230e9},
    **{"F": 4700.0, "F_N": 4065.0, "F_K": 4450.0, "R_0": 0.0475, "w_rel": 160.0, "w_disc": 11.4, "tau_loss": 2.3},
    **{
        "mu_r": 0.005,
        "mu_s": 0.05,
        "P_in": 4000.0,
        "w_in": 148.7,
        "Lambda_ref": 0.4,
        "stir": 0.7,
        "load": 0.8,
        "f": 0.6,
    },
    **{"M": 20.0, "L": 0.3, "U": 1e-11, "G": 5000.0, "W": 1e-4, "D": 0.15, "R_x": 0.01, "R_y": 0.05},
    **{"Lambda": 0.7, "mu_fluid": 0.04, "mu_boundary": 0.12},
    **{"r_i": 0.1, "r_o": 0.11, "thickness": 0.004, "length": 0.03, "R_20": 0.3},
    **{"Re_w": 2e4, "P": 2200.0, "P_N": 2200.0, "w_N": 298.5, "tau": 7.4, "eta": 0.82, "eta_N": 0.82, "eta_g": 0.76},
    **{"share": 0.4, "Q": 1000.0, "S": 0.76, "T_room": 298.0, "psi_1": 0.5, "psi_2": 0.9, "S_3": 0.6, "S_4": 0.3},
    **{"r": 0.15, "T_oil": 345.0, "nu_50": 30e-6, "Ra_1": 0.4e-6, "Ra_2": 0.4e-6, "c_q": 1.25},
    **{"xi": 0.4, "F": 240.0, "C": 1e-17},
    **{"w_0": 0.64e-3, "r_convex": 0.0192194, "r_concave": 0.0192307, "E_eff": 230e9, "u_0": 0.03, "u_m": 0.03},
    **{"shaft_angle": 1.57, "d_e": 0.18, "delta": 1.2, "F_t": 5000.0, "away": 1.0, "m_x": 4e-3},
    **{"mu_0T": 0.04, "Y": 1.1, "h_star": 0.07, "z_2": 41.0},
    **{"d_1": 0.05, "gamma": 0.2, "F_n": 5000.0, "drive": 1.0, "locking": 0.5},
    **{"m_flow": 0.2, "h_a": 1e5, "h_b": 6e4, "c_p": 2000.0, "dp": 2e5, "C_d": 0.6, "p_bypass": 3e5, "eta_m": 0.8},
    **{"C_s": 1e-8},
    **{"T_shaft": 350.0, "T_housing": 330.0, "T_set": 293.0},
    **{"alpha_s": 12e-6, "alpha_h": 23e-6, "alpha": 0.25, "span": -0.2},
    **{"F_set": 500.0, "dx": 1e-5, "F_0": 800.0, "F_own": 600.0, "F_other": 100.0, "S_own": 500.0, "F_pushed": 800.0},
    **{"g": 0.002, "path": 0.0095, "rho_C": 0.012, "eps_gamma": 2.9, "v_1": 3.0, "v_2": 2.0, "B_M": 13e3},
    **{"stage": 12.0, "X_W": 1.0, "tau_test": 530.0, "eps_max": 0.9, "X_S": 1.0, "eta_B": 0.02},
    **{"alpha_B": 12e-9},
    **{"expansion": 6.5e-4, "share_air": 0.1, "v_gain": 35.0, "share_oil": 1e-3, "rho_air": 1.2},
    **{"p": 1e7, "Z": 8.0, "D_w": 0.015, "hardness": 2e9},
    **{"g_V": 20.0, "g_E": 5.0, "rigid_isoviscous": 0.5, "rigid_piezoviscous": 0.4, "elastic_isoviscous": 0.3},
}
CYCLOID = {"e": 4e-3, "Rp": 0.086, "K": 0.651, "Zc": 13.0, "T_disc": 166.0}
OWN = {
    "iso14179_1.mesh_friction": {"K": 5e6},
    "iso14179_1.tip_sliding": {"d_a": 0.045},
    "iso14179_2.hydraulic_torque": {"e": 0.03},
    **{f"cycloid.{key}": CYCLOID for key in ("pin_force_sum", "pin_force_along_crank", "eccentric_force")},
    "cycloid.roller_loss_torque": CYCLOID | {"D": 0.014, "d": 0.008},
    "cycloid.output_roller_power": CYCLOID | {"D": 0.014, "d": 0.007},
    "cycloid.ring_roller_power": CYCLOID | {"D": 0.014, "d": 0.008},
    "bevel.mean_diameter": {"b": 0.025},
    "worm.lead_angle": {"z_1": 2.0},
    "worm.worm_film_parameter": {"z_1": 2.0},
    "worm.worm_size_factor": {"a": 0.1},
    "rolling.starvation": {"s": 0.2},
    "harmonic.conforming_radius": {"r_concave": 0.02},
    "harmonic.flank_speed_radius": {"phi": 0.2},
    "harmonic.pad_shear": {"a": 2.2, "B": 1e-3, "L": 0.012, "v_slide": 0.06},
    "drum.motor_loss": {"a": 1.5},
    "drum.cooling_area": {"S_1": 0.08, "S_2": 0.08},
    "drum.lumped_temperature": {"h": 20.0},
    "pad.wedge_coefficient": {"a": 2.2},
    "pad.side_leakage": {"a": 2.2},
    "pad.combined_film": {"A": 1e-11},
    "pad.fill_arc": {"beta": 0.5},
    "pad.fill_volume_share": {"beta": 0.5},
    "churning.churning_loss": {"a": 2.5, "b": 0.3},
    "churning.churning_torque": {"a": 2.5, "b": 0.3},
    "load_variables.acb_rolling_variable": {"R_3": 2.44e-12},
    "load_variables.acb_sliding_variable": {"S_3": 2.44e-12},
    **{f"journal.{key}": {"r": 0.03, "b": 0.05} for key in ("petrov_torque", "film_torque", "solid_share")},
    "gap_seal.laminar_gap_torque": {"r": 0.025},
    "gap_seal.gap_torque": {"r": 0.025},
    "squeezing.squeezing_torque": {"r": 0.05, "b": 0.02, "m_n": 0.003},
    "squeezing.pocket_closing": {"b": 0.02, "m_n": 0.003},
    "sealing.oil_seal_torque": {"nu_40": 220e-6},
    "gear_churning.submerged_area": {"h": 0.04, "r": 0.08, "b": 0.024},
    "gear_churning.disc_friction": {"h": 0.04, "r": 0.08},
    "gear_churning.fast_share": {"w": 250.0, "r": 0.08, "b": 0.024},
    "gear_churning.gear_churning_torque": {"h": 0.04, "r": 0.08, "b": 0.024},
    "gear_churning.windage_torque": {"r": 0.08, "b": 0.024},
    "dry_sump.fling_off": {"Pr": 260.0, "r": 0.08, "height": 7e-3},
    "sealing.lip_conductance": {"h": 500.0, "k": 45.0},
    "oil_in_motion.thrown_flow": {"h": 0.04, "r": 0.08, "b": 0.024},
    "oil_in_motion.held_volume": {"Q": 1e-3, "width": 0.3},
    "oil_circuit.stream_conductance": {"G": 300.0},
    "oil_circuit.orifice_flow": {"d": 2e-3},
    "oil_circuit.laminar_pressure": {"R": 8e9},
    "oil_circuit.pump_loss_torque": {"D": 1.6e-6},
    "oil_circuit.pump_slip": {"D": 1.6e-6},
    "preload.preload_force": {"k": 1e8},
    "film_line.moes_central": {"L": 10.0},
    "film_point.nijenbanning_central": {"L": 10.0, "D": 0.8},
    "film_point.solved_central": {"L": 10.0, "D": 0.8},
    "film_point.hamrock_dowson_central": {"k": 1.5},
    "film_point.hamrock_dowson_minimum": {"k": 1.5},
    "conduction.fin_efficiency": {"h": 10.0, "k": 100.0},
    "conduction.plane_wall": {"k": 50.0, "d": 0.01},
    "conduction.cylinder_wall": {"k": 50.0},
    "conduction.contact_coefficient": {"k": 50.0, "m": 0.1},
    "conduction.ball_bearing_conductance": {"d_m": 0.065},
    "convection.nusselt_vertical_plate": {"Ra": 1e8},
    **{f"oil_convection.{key}": {"Pr": 800.0} for key in ("nusselt_laminar_plate", "nusselt_rotating_disc")},
    **{f"oil_convection.{key}_in_oil": {"Pr": 800.0} for key in ("forced_wall", "forced_disc", "natural_wall")},
    "convection.nusselt_horizontal_cylinder": {"Ra": 1e8},
    "convection.nusselt_plate_unstable": {"Ra": 4e6},
    "convection.nusselt_plate_stable": {"Ra": 1e7},
}
#: Widths of the roundings that laws have at an argument's zero.
ZERO = {
    "w": (smooth.SPEED_WIDTH,),
    "v": (smooth.V_WIDTH, 1e-2, 0.05),
    "v_sum": (smooth.V_WIDTH,),
    "u_sum": (smooth.U_WIDTH,),
    "slide_roll": (1e-4,),
    **dict.fromkeys(("line_load", "F_n_l"), (smooth.LINE_WIDTH,)),
    **dict.fromkeys(("F_r", "F_a", "P_1"), (smooth.F_WIDTH,)),
    "Lambda": (1e-6,),
}
#: Arguments that may be zero but not negative.
NOT_NEGATIVE = {"P_a", "h_natural", "h_forced", "H", "V_M", "level", "K_rs", "phi_bl", "c", "T_pour"}
NOT_NEGATIVE |= {"fill", "backlash"}
#: Torques and losses: magnitudes, never negative.
MAGNITUDES = ("rolling.", "cylindrical.", "sealing.", "churning.", "mesh.", "film.", "film_line.", "film_point.")
MAGNITUDES += ("gear_churning.", "load_variables.", "journal.", "gap_seal.", "squeezing.", "preload.preload")
MAGNITUDES += ("tooth_flanks.", "oil_convection.", "cycloid.", "iso14179_1.", "iso14179_2.")


def every_function() -> dict[str, Callable[..., Any]]:
    """Every decorated law, and the heat transfer coefficients made of them."""
    folder = Path(inspect.getfile(convection)).parent
    found = {}
    for path in sorted(folder.glob("[a-z]*.py")):
        module = importlib.import_module(f"gearheat.model.laws.{path.stem}")
        for name, value in vars(module).items():
            made_here = getattr(value, "__module__", "") == module.__name__ and inspect.isfunction(value)
            if made_here and (hasattr(value, "law") or name.startswith(("natural_", "forced_"))):
                found[f"{path.stem}.{name}"] = value
    return {name: f for name, f in found.items() if set(arguments(f)) <= NOMINAL.keys()}


def arguments(function: Callable[..., Any]) -> list[str]:
    """The positional arguments: physics; keyword arguments are numerics and choices."""
    parameters = inspect.signature(function).parameters.values()
    return [p.name for p in parameters if p.kind == p.POSITIONAL_OR_KEYWORD]


FUNCTIONS = every_function()


def nominal(name: str) -> dict[str, float]:
    return {a: OWN.get(name, {}).get(a, NOMINAL[a]) for a in arguments(FUNCTIONS[name])}


def structural(name: str) -> set[str]:
    """Arguments that are numbers of the structure, never symbols."""
    annotations = inspect.get_annotations(inspect.unwrap(FUNCTIONS[name]))
    return {a for a in arguments(FUNCTIONS[name]) if annotations[a] == "float"}


@cache
def symbolic(name: str) -> tuple[ca.Function, list[str]]:
    """The law as a CasADi function of its symbols, with its Jacobian."""
    fixed = {a: v for a, v in nominal(name).items() if a in structural(name)}
    free = [a for a in nominal(name) if a not in fixed]
    x = ca.SX.sym("x", len(free))
    result = FUNCTIONS[name](**fixed, **{a: x[i] for i, a in enumerate(free)})
    value = ca.vertcat(*result) if isinstance(result, tuple) else ca.SX(result)
    return ca.Function("law", [x], [value, ca.jacobian(value, x)]), free


def vector(name: str, values: dict[str, float], free: list[str]) -> np.ndarray:
    return np.array([values[a] for a in free])


def test_all_laws_of_the_source_folder_are_covered() -> None:
    """`NOMINAL` has a value for every argument of every law."""
    folder = Path(inspect.getfile(convection)).parent
    for path in sorted(folder.glob("[a-z]*.py")):
        tree = ast.parse(path.read_text("utf-8"))
        decorated = {n.name for n in tree.body if isinstance(n, ast.FunctionDef) and n.decorator_list}
        assert {f"{path.stem}.{n}" for n in decorated} <= FUNCTIONS.keys()


@for_each(FUNCTIONS)
def test_source_exists(name: str) -> None:
    info = getattr(FUNCTIONS[name], "law", None)
    if info:
        assert info.source in sources()
        assert info.where


@for_each(FUNCTIONS)
def test_symbols_give_the_same_number(name: str) -> None:
    function, free = symbolic(name)
    result = FUNCTIONS[name](**nominal(name))
    expected = np.atleast_1d(np.array(result, dtype=float))
    assert function(vector(name, nominal(name), free))[0].full().ravel() == pytest.approx(expected, rel=1e-12)


def extremes(name: str) -> list[dict[str, float]]:
    """Every vanishing argument at zero, alone and all together, and reversed; equal temperatures."""
    base = nominal(name)
    zero = [a for a in base if a in ZERO or a in NOT_NEGATIVE or name + "." + a == "conduction.fin_efficiency.h"]
    points = [base | {a: 0.0} for a in zero] + [base | dict.fromkeys(zero, 0.0)]
    points += [base | {a: -base[a]} for a in base if a in ZERO]
    points += [base | {b: base[a]} for a, b in (("T_s", "T_f"), ("T_1", "T_2")) if a in base]
    return points


@for_each(FUNCTIONS)
def test_finite_at_rest_and_reversed(name: str) -> None:
    function, free = symbolic(name)
    for point in extremes(name):
        value, slope = function(vector(name, point, free))
        assert np.isfinite(value.full()).all(), point
        assert np.isfinite(slope.full()).all(), point
        if name.startswith(MAGNITUDES):
            assert (value.full() >= 0).all(), point


#: Ends of what a run may meet: -60 and 200 degC, the thickest oil there is, 1000 rad/s, 1e6 N.
_ROOM, _OIL = (213.15, 473.15), (1e-6, 20.0)
EXTREME = {
    **{"T": (100.0, *_ROOM), "T_film": _ROOM, "T_s": _ROOM, "T_f": _ROOM, "T_1": _ROOM, "T_2": _ROOM},
    **{"w": (-1000.0, 0.0, 1e-5, 1000.0), "v": (0.0, 100.0), "v_sum": (0.0, 200.0), "u_sum": (0.0, 200.0)},
    **{"F_r": (0.0, 1.0, 1e6), "F_a": (0.0, 1.0, 1e6), "P_1": (0.0, 1e6), "F_n_l": (0.0, 1e8), "P_a": (0.0, 1e9)},
    **{"m_flow": (-10.0, 0.0, 10.0), "dp": (-1e7, 0.0, 1e7), "dx": (-1e-3, 1e-3), "F_own": (0.0, 1e6)},
    **{"nu": _OIL, "eta_oil": (1e-3, 2e4), "eta_0": (1e-3, 2e4), "s": (0.0, 1e9), "phi_ish": (0.0910, 1.0)},
    **{"H": (0.0, 0.2), "K_rs": (0.0, 6e-8), "nu_40": (32e-6, 680e-6), "slide_roll": (0.0, 2.0)},
    **{"Lambda": (0.0, 1e-6, 1e-3, 2.0, 1e3), "M": (1e-2, 1e6), "L": (1e-2, 100.0)},
    **{"phi": (0.0, 1.0), "phi_bl": (0.0, 1.0), "Ra": (1e-7, 1e-5)},
}


@for_each(FUNCTIONS)
def test_extreme_values_are_finite_and_no_loss_is_negative(name: str) -> None:
    """At every combination of the ends; slopes as well, which solvers need."""
    function, free = symbolic(name)
    base = nominal(name) | ({"nu_40": 680e-6} if "nu_40" in nominal(name) else {})
    own = {} if name == "oil.pressure_viscosity" else EXTREME
    ends = [own.get(a, (base[a],)) for a in free]
    for values in itertools.product(*ends):
        value, slope = function(np.array(values))
        assert np.isfinite(value.full()).all(), dict(zip(free, values, strict=True))
        assert np.isfinite(slope.full()).all(), dict(zip(free, values, strict=True))
        if name.startswith(MAGNITUDES):
            assert (value.full() >= 0).all(), dict(zip(free, values, strict=True))


@for_each(FUNCTIONS)
def test_reversal_changes_nothing(name: str) -> None:
    base = nominal(name)
    for argument in [a for a in base if a in ZERO]:
        here, there = FUNCTIONS[name](**base), FUNCTIONS[name](**base | {argument: -base[argument]})
        assert there == pytest.approx(here, rel=1e-12), argument


def blend_points(name: str) -> list[tuple[dict[str, float], str, float]]:
    """Point, argument and step: nominal in every argument, and across every rounding."""
    base = nominal(name)
    points = [(base, a, 1e-5 * abs(base[a])) for a in base if a not in structural(name)]
    for argument, width in ((a, width) for a in ZERO if a in base for width in ZERO[a]):
        points += [(base | {argument: f * width}, argument, 1e-4 * width) for f in (-5, -1, -0.3, 0, 0.3, 1, 5)]
    if "T_s" in base:
        points += [(base | {"T_s": base["T_f"] + dT}, "T_s", 1e-5) for dT in (-1, -0.05, -0.01, 0, 0.003, 0.05, 1)]
    if name == "rolling.needle_torque_viscous":  # where the two branches meet
        points += [(base | {"w": nu_n / 60 * np.pi / 30}, "w", 1e-4) for nu_n in (1900, 2000, 2024, 2050, 2200)]
    if name == "convection.nusselt_plate_unstable":
        points += [({"Ra": Ra}, "Ra", 1e-5 * Ra) for Ra in (1e5, 3e6, 4.74e6, 1e7, 1e9)]
    if name.startswith("rolling.drag_torque"):  # dry, half and fully submerged
        d_m = 0.5 * (base["d"] + base["D"])
        points += [
            (base | {"H": H * d_m}, "H", 1e-5 * d_m) for H in (0.0, 0.001, 0.3, 0.599, 0.6, 0.601, 1.199, 1.2, 1.3)
        ]
    return points


@for_each(FUNCTIONS)
def test_derivative_is_the_difference_quotient(name: str) -> None:
    function, free = symbolic(name)
    for point, argument, step in blend_points(name):
        i = free.index(argument)
        x = vector(name, point, free)
        dx = np.eye(len(x))[i] * step
        slope = function(x)[1].full()[:, i]
        low, here, high = (function(x + s * dx)[0].full().ravel() for s in (-1, 0, 1))
        noise = 1e-13 * np.abs(here) / step
        scale = np.abs(slope) + np.abs(high - 2 * here + low) / step  # curvature within the step
        assert (np.abs((high - low) / (2 * step) - slope) <= 1e-4 * scale + 10 * noise + 1e-300).all(), (
            point,
            argument,
        )
