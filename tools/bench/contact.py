"""The point contact of this project against that of `slippy` (PyPI), at equal error, both on one core.

slippy 0.5.2 asks for a NumPy below 1.21, which has no wheel for Python 3.11, and uses names that NumPy 1.24 and
SciPy 1.12 have dropped. The newest versions that still have these names run it unchanged; they need Python 3.8 to 3.11.
The contact is that of slippy's own example, with the density law of this project. Errors are those of the central and
of the minimum film, whichever is larger, against the film of this project extrapolated from its two finest grids.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from math import log
from pathlib import Path
from typing import Any

from ...model.contact import Contact, Lubricant, solve
from ...model.contact.case import ETA_POLE
from ...model.errors import DataError
from ..show.console import note

#: What slippy 0.5.2 runs with.
PINS = (
    "numpy==1.23.5",
    "scipy==1.10.1",
    "numba==0.57.1",
    "scikit-image==0.20.0",
    "pyfftw==0.13.1",
    "matplotlib==3.7.5",
    "sympy",
    "tinydb",
    "setuptools<70",
    "wheel",
)
#: Interpreters these have wheels for.
PYTHONS = ("3.11", "3.10", "3.9", "3.8")
#: The contact: radius, load, mean speed, effective modulus, viscosity, and Roelands' constants.
CASE = {
    "R": 0.01905,
    "F": 800.0,
    "u_m": 4.0,
    "E_eff": 200e9 / (1 - 0.3**2),
    "eta_0": 0.096,
    "p_r": 1 / 5.1e-9,
    "z": 0.68,
}
#: Nodes a side of slippy and of this project.
PEER_GRIDS = (65, 97)
#: Width of slippy's domain over a, relaxation and tolerance as its example.
GRIDS = (33, 65, 129, 257)
OPTIONS = {"width": 6.0, "relax": 0.1, "tolerance": 1e-6, "steps": 20000}
#: One core for all libraries.
ONE = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS", "MKL_NUM_THREADS")}
SCRIPT = """
import contextlib, io, json, sys, time
import slippy
slippy.CUDA = False
import slippy.contact as c
import slippy.surface as s

case = json.loads(sys.argv[1])
R, F, E, eta, nu = case["R"], case["F"], case["E_eff"], case["eta_0"], 0.3
young = E * (1 - nu**2)
dry = c.hertz_full([R, R], [float("inf")] * 2, [young] * 2, [nu] * 2, F)
p_h, a = dry["max_pressure"], dry["contact_radii"][0]

def density(nd_pressure, **_):
    return 1 + 0.6e-9 * p_h * nd_pressure / (1 + 1.7e-9 * p_h * nd_pressure)

def work(n, steps):
    ball = s.RoundSurface((R,) * 3, shape=(n, n), extent=(a * case["width"],) * 2, generate=True)
    flat = s.FlatSurface()
    ball.material = flat.material = c.Elastic(f"steel {n}", {"E": young, "v": nu})
    oil = c.Lubricant("oil")
    oil.add_sub_model("nd_viscosity", c.lubricant_models.nd_roelands(eta, case["p_r"], p_h, case["z"]))
    oil.add_sub_model("nd_density", density)
    model = c.ContactModel("peer", ball, flat, oil)
    reynolds = c.UnifiedReynoldsSolver(
        time_step=0, grid_spacing=ball.grid_spacing, hertzian_pressure=p_h, radius_in_rolling_direction=R,
        hertzian_half_width=a, dimentional_viscosity=eta, dimentional_density=872,
    )
    model.add_step(c.IterSemiSystem(
        "main", reynolds, case["u_m"], 1, no_time=True, normal_load=F, relaxation_factor=case["relax"],
        max_it_pressure=steps, rtol_pressure=case["tolerance"], no_update_warning=False,
    ))
    begun = time.process_time()
    with contextlib.redirect_stdout(io.StringIO()):
        state = model.solve()
    return time.process_time() - begun, state

work(17, 3)  # compiles
seconds, state = work(case["n"], case["steps"])
gap, middle = state["gap"], case["n"] // 2
print(json.dumps([seconds, float(gap[middle, middle]), float(gap.min()), bool(state["converged"])]))
"""


def measure() -> dict[str, Any]:
    """Processor times and errors of both, and the ratio at equal error.

    Raises:
        DataError: slippy cannot be installed or run here
    """
    note("this project's contact")
    contact, seconds, films = _contact(), [], []
    for n in GRIDS:
        begun = time.process_time()
        film = solve(contact, n=n)
        seconds.append(time.process_time() - begun)
        films.append((film.h_c, film.h_min))
    exact = [(4 * fine - coarse) / 3 for coarse, fine in zip(*films[-2:], strict=True)]
    own = [{"n": n, "s": s, "error": _error(f, exact)} for n, s, f in zip(GRIDS, seconds, films, strict=True)]
    with tempfile.TemporaryDirectory() as folder:
        note("slippy, in an environment of its own")
        python = _install(Path(folder))
        peers = [_peer(python, Path(folder), n, exact) for n in PEER_GRIDS]
    found = {"case": CASE, "h_c_m": exact[0], "h_min_m": exact[1], "own": own, "slippy": peers}
    return found | {"ratios": [_ratio(peer, own) for peer in peers]}


def _contact() -> Contact:
    alpha_p = CASE["z"] * log(CASE["eta_0"] / ETA_POLE) / CASE["p_r"]
    oil = Lubricant(CASE["eta_0"], alpha_p, p_r=CASE["p_r"])
    speeds = {"u_1": CASE["u_m"], "u_2": CASE["u_m"]}
    return Contact(F=CASE["F"], R_x=CASE["R"], R_y=CASE["R"], E_eff=CASE["E_eff"], lubricant=oil, **speeds)


def _error(films: Sequence[float], exact: Sequence[float]) -> float:
    return max(abs(film / true - 1) for film, true in zip(films, exact, strict=True))


def _ratio(peer: dict[str, Any], own: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Time of the peer over that of the cheapest run of this project whose error is no larger."""
    equal = next((line for line in own if line["error"] <= peer["error"]), own[-1])
    return {"n_slippy": peer["n"], "n": equal["n"], "ratio": peer["s"] / equal["s"]}


def _install(folder: Path) -> Path:
    """The interpreter of an environment with slippy."""
    here = ".".join(map(str, sys.version_info[:2]))
    base = (
        sys.executable if here in PYTHONS else next(filter(None, (shutil.which(f"python{v}") for v in PYTHONS)), None)
    )
    if base is None:
        raise DataError(f"slippy needs Python {PYTHONS[-1]} to {PYTHONS[0]}, here is {here}. Install one of these.")
    python = folder / "peer" / ("Scripts" if sys.platform == "win32" else "bin") / "python"
    pip = [str(python), "-m", "pip", "install", "-q"]
    for command in (
        [base, "-m", "venv", str(folder / "peer")],
        [*pip, *PINS],
        [*pip, "--no-deps", "--no-build-isolation", "slippy==0.5.2"],
    ):
        done = subprocess.run(command, check=False, capture_output=True, text=True)
        if done.returncode:
            raise DataError(f"slippy cannot be installed: {done.stderr.strip().splitlines()[-1]}")
    return python


def _peer(python: Path, folder: Path, n: int, exact: Sequence[float]) -> dict[str, Any]:
    """One run of slippy."""
    note(f"slippy on {n} x {n} nodes")
    (folder / "run.py").write_text(SCRIPT, encoding="utf-8")
    command = [str(python), "run.py", json.dumps({**CASE, **OPTIONS, "n": n})]
    done = subprocess.run(command, cwd=folder, check=False, capture_output=True, text=True, env={**os.environ, **ONE})
    if done.returncode:
        raise DataError(f"slippy does not run: {done.stderr.strip().splitlines()[-1]}")
    seconds, h_c, h_min, converged = json.loads(done.stdout.splitlines()[-1])
    error = _error((h_c, h_min), exact)
    return {"n": n, "s": seconds, "error": error, "h_c_m": h_c, "h_min_m": h_min, "converged": converged}


def rows(found: dict[str, Any]) -> list[list[Any]]:
    """The table: what, value."""
    lines = [
        [
            f"{name}, {line['n']} x {line['n']} nodes [s; error of the film]",
            f"{line['s']:.2f}; {100 * line['error']:.2f} %",
        ]
        for name, key in (("this project", "own"), ("slippy 0.5.2", "slippy"))
        for line in found[key]
    ]
    for r in found["ratios"]:
        what = f"slippy on {r['n_slippy']}^2 over this project on {r['n']}^2, error no larger"
        lines.append([what, f"{r['ratio']:.0f} times"])
    return lines
