"""Results of commands that take long or cost a compiler, made up, and how each is printed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from challenge.printing import show as show_challenge
from challenge.scoring import Outcome, report
from gearheat import Calibration, CampaignRun, FilmTable, Replays
from gearheat.tools.bench import bench
from gearheat.tools.cli import developers, fmu as exporting, measured
from gearheat.tools.cli.solve import print_end
from gearheat.tools.compare.replay import HOURS, Replayed

PLAYED = "over the duty: mean loss 179.7 W, hottest gears 61.3 degC after 60 min, at the end 31.3 degC"
SENSORS = ("T_oil", "T_bearing_high_speed_rotor_side", "T_bearing_high_speed_generator_side")


def run_of_one_point() -> None:
    columns = {"point": 1, "test": 1, "oil": "ISO VG 220 mineral", "n_input_rpm": 1450.0, "T_output_Nm": -592.5}
    row = columns | {"T_oil_C": 40.27, "T_wall_C": 38.3, "P_mesh_W": 98.23, "efficiency": 0.975, "time_s": 28800.0}
    found = {"rig": "mine", "unchecked": [], "energy_residual_max": 1.4e-16}
    measured.print_run(CampaignRun(found | {"rows": [row]}, None, (), heading="mine: operating point"))


def calibration() -> None:
    one = {"standard_error": 0.0123, "unit": "m2", "start": 0.5, "at_bound": False}
    free = {
        "cooling.A": one | {"value": 0.62},
        "foot.G": one | {"value": 7.0, "unit": "W/K", "start": 5.0},
        "stage_2.friction_of_flanks": one | {"value": 1.5, "standard_error": None, "at_bound": True},
    }
    correlation = {a: {b: 1.0 if a == b else -0.95 for b in free} for a in free}
    made = {"rig": "planetary", "readings": 72, "grid": None, "free": free, "correlation": correlation}
    made |= {"rmse_before_K": 4.25, "rmse_after_K": 0.875}
    rows = [(n, f["value"], f["standard_error"], f["unit"], f["start"]) for n, f in free.items()]
    shown = ("name", "value", "standard error", "unit", "before"), rows
    heading = "planetary: fitted to 72 oil temperatures of all tests"
    measured.print_calibration(Calibration(made, None, heading=heading, shown=shown))  # type: ignore[arg-type]


def replayed() -> None:
    methods = ("the rig", "one node", "regression on present and past inputs", "last reading")
    free = {m: {s: 1.25 * (k + 1) + j for j, s in enumerate(SENSORS)} for k, m in enumerate(methods)}
    ahead = {m: {s: tuple(0.5 * h**0.5 for h in HOURS) for s in SENSORS} for m in methods}
    units = dict.fromkeys(SENSORS, "K")
    logs = [Replayed(name, 1000, free, ahead, units, {}, np.zeros(1)) for name in ("R80711 before 2016", "R80721")]
    measured.print_replays(Replays(tuple(logs)))


def film_of_a_part() -> None:
    ends = {"F": (100.0, 2000.0, "N"), "u_m": (0.5, 8.0, "m/s"), "T": (40.0, 100.0, "degC")}
    shown = ("varied", "low", "high", "unit"), [(name, *values) for name, values in ends.items()]
    found: dict[str, Any] = {"terms": 10, "out": "map.csv"}
    found["failed"] = ["F = 2000 N, u_m = 0.5 m/s, T = 100 degC: the film is thinner than the solver can tell"]
    found["fit"] = {"h_c": {"largest": 0.021, "rms": 0.008}, "h_min": {"largest": 0.043, "rms": 0.017}}
    developers.print_films(FilmTable(found, heading="planetary: gear_set: 144 ellipse contacts", shown=shown))


def exported() -> None:
    names = {"inputs": ["carrier.w"] * 4, "outputs": ["oil.T"] * 61, "parameters": ["cooling.A"] * 143}
    extras = [f"beside/{name}" for name in ("planetary.ssv", "planetary_ref.csv", "planetary_in.csv")]
    found: dict[str, Any] = {"fmu": "planetary.fmu", "platforms": ["x86_64-linux", "x86_64-windows"], "extras": extras}
    bounds = {"step_s": 0.01, "solver_steps": 1, "evaluations": 44, "stack_bytes": 7208}
    found["real_time"] = {**bounds, "checks": {"temperature: largest difference": "below 1e-5 K"}}
    exporting._print_fmu({**found, **names, "deviations": [], "unchecked": []})


def challenged() -> None:
    plain = Outcome(
        sheet="own", case="case-001", kind="single", snr=8.5, distance=4.25, truth="churning of the oil",
        top="churning of the oil", p_truth=0.96, p_top=0.96, answered=True, alarm=True, exact=True, shared=1,
        hidden=1, claimed=1, covered=True, size=1, sure_wrong=False, impact_error=0.125, gain=0.25, gross=None,
        seconds=12.5,
    )  # fmt: skip
    other = "friction of the bearings + zero of the torque transducer at the output"
    wrong = replace(plain, case="case-002", top=other, p_truth=0.02, p_top=0.94, exact=False, sure_wrong=True)
    clean = {"kind": "clean", "truth": "nothing", "top": "nothing", "distance": None, "snr": 0.0, "alarm": False}
    cases = [plain, wrong, replace(plain, case="case-003", **clean), replace(plain, sheet="foreign", answered=False)]
    show_challenge(report(cases, 7))


def benched() -> None:
    lsoda = [{"tolerance": 1e-6, "s": 2.5, "error_K": 0.0125}, {"tolerance": 1e-8, "s": 4.5, "error_K": 0.000125}]
    cost = {"help_s": 0.25, "run_s": 12.5, "run_peak_memory_MB": 250.5, "tests": 36, "fmu_s": 0.75}
    bench._print({**cost, "fmu_error_K": 0.00125, "lsoda": lsoda, "ratio": 3.25})


def benched_fmu() -> None:
    peer: Mapping[str, Any] = {"over_fmu_from_c": 12.5, "error_K": 2.5e-3}
    grown = {"nodes": 100, "flatten_s": 0.25, "generate_s": 0.5, "compile_s": 1.5, "rhs_s": 2.5e-6, "step_s": 4e-5}
    goal = {"goal": "right-hand sides of a warm-up of 330 min from C", "bound": "<= 500", "measured": 412.0}
    found = {
        "rhs_s": 1.25e-6,
        "step_rhs": 12.5,
        "outputs_rhs": 1.5,
        "call_rhs": 14.5,
        "jump_rhs": 30.5,
        "fmu_kB": 512.0,
    }
    for step in ("1", "10", "60"):
        found |= {f"warmup_{step}_rhs": 4125.0, f"warmup_{step}_error_K": 2.5e-4}
    found |= {"peers": {"CVODE of another exporter": peer}, "growth": [grown], "goals": [goal | {"met": True}]}
    found["massless"] = [{"conductors": 200, "flatten_s": 0.75, "instructions": 4100}]
    rates = {kind: {"rows_per_core_s": 12500.0} for kind in ("steady", "warmup_330_min")}
    bench._print_fmu({**found, "state_bytes": 2048.0, "batch": rates})


def benched_uncertainty() -> None:
    """Outputs of a temperature and of an efficiency, some rows without a result."""
    one = {
        "way": "linear",
        "name": "oil.T",
        "unit": "K",
        "fmu_sd": 1.25,
        "drawn_sd": 1.375,
        "worst_difference": -0.0225,
    }
    one |= {"worst_time_s": 300.0, "standard_error": 0.0075}
    other = one | {"way": "mixture", "name": "efficiency.eta", "unit": "1", "fmu_sd": 0.0015, "worst_time_s": 14400.0}
    cost = {"plain_rhs": 640.0, "linear_rhs": 1120.0, "mixture_rhs": 3360.0}
    found = {"rig": "mine", "draws": 10_000, "failed": 3, "outputs": [one, other], "cost": cost}
    bench._print_uncertainty(found)


#: Name of the file -> prints it.
ANSWERS: dict[str, Callable[[], None]] = {
    "run": run_of_one_point,
    "calibrate": calibration,
    "replay": replayed,
    "film": film_of_a_part,
    "export": exported,
    "play": partial(print_end, Path("played.csv"), {"rows": 241, "stop_s": 14400.0}, [PLAYED]),
    "challenge": challenged,
    "bench": benched,
    "bench_fmu": benched_fmu,
    "bench_uncertainty": benched_uncertainty,
}
