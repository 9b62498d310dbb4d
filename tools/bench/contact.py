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
import sys
import tempfile
from collections.abc import Sequence
from functools import partial
from math import log
from pathlib import Path
from typing import Any

from ...model.contact import Contact, Lubricant, solve
from ...model.contact.case import ETA_POLE
from ...model.errors import DataError
from ..show.console import note
from .harness import TABLES, environment, run, script, timed

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
#: Nodes a side of this project's grids.
GRIDS = (33, 65, 129, 257)
#: One core for all libraries.
ONE = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS", "MKL_NUM_THREADS")}


def measure() -> dict[str, Any]:
    """Processor times and errors of both, and the ratio at equal error.

    Raises:
        DataError: slippy cannot be installed or run here
    """
    note("this project's contact")
    runs = [timed(partial(solve, _contact(), n=n)) for n in GRIDS]
    films = [(film.h_c, film.h_min) for _, film in runs]
    exact = [(4 * fine - coarse) / 3 for coarse, fine in zip(*films[-2:], strict=True)]
    own = [{"n": n, "s": s, "error": _error(f, exact)} for n, (s, _), f in zip(GRIDS, runs, films, strict=True)]
    with tempfile.TemporaryDirectory() as folder:
        note("slippy, in an environment of its own")
        python = _install(Path(folder))
        peers = [_peer(python, Path(folder), n, exact) for n in TABLES["slippy"]["grids"]]
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
    here, known = ".".join(map(str, sys.version_info[:2])), TABLES["slippy"]["pythons"]
    others = filter(None, (shutil.which(f"python{v}") for v in known))
    base = sys.executable if here in known else next(others, None)
    if base is None:
        raise DataError(f"slippy needs Python {known[-1]} to {known[0]}, here is {here}. Install one of these.")
    unbuilt = ("--no-deps", "--no-build-isolation", "slippy==0.5.2")
    return environment(folder, "slippy", [TABLES["slippy"]["pins"], unbuilt], base)


def _peer(python: Path, folder: Path, n: int, exact: Sequence[float]) -> dict[str, Any]:
    """One run of slippy."""
    note(f"slippy on {n} x {n} nodes")
    asked = json.dumps({**CASE, **TABLES["slippy"]["options"], "n": n})
    command = [str(python), str(script(folder, "contact")), asked]
    seconds, h_c, h_min, converged = json.loads(run(command, folder, "slippy does not run", {**os.environ, **ONE}))
    error = _error((h_c, h_min), exact)
    return {"n": n, "s": seconds, "error": error, "h_c_m": h_c, "h_min_m": h_min, "converged": converged}
