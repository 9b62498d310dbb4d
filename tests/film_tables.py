"""Film maps of contacts that follow a power law: what a fitted law has to give back is known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from gearheat.scenarios.film_map import COLUMNS

#: Reduced radius, length and modulus of the contacts.
R, LENGTH, E_EFF = 0.01, 0.02, 226e9
LOADS, SPEEDS, VISCOSITIES = np.geomspace(100, 1e4, 4), np.geomspace(0.1, 10, 4), np.geomspace(0.01, 0.5, 4)

#: A case of films, whose map is computed.
CASE = """
[contact]
R_x = "10 mm"
length = "10 mm"
E_eff = "226 GPa"
slide_roll = 0.1
sigma = "0.3 um"
mu_boundary = 0.12
source = "assumed: a disc machine"

[oil]
oil = "ISO VG 220 mineral"

[vary]
F = "1000..4000 N"
u_m = "1..4 m/s"
T = "60..90 degC"
"""


def central(F: float, u_m: float, eta_0: float, radius: float = R) -> float:
    """A film with the similarity of line contacts: over radius, of load and speed over radius, and of viscosity."""
    return radius * 2e-6 * (eta_0 * u_m / radius) ** 0.7 * (F / LENGTH / radius / 1e6) ** -0.1


def rows() -> list[dict[str, object]]:
    """A map of 64 contacts."""
    found = []
    for F in LOADS:
        for u_m in SPEEDS:
            for eta_0 in VISCOSITIES:
                h = central(F, u_m, eta_0)
                found.append(
                    dict.fromkeys((c.name for c in COLUMNS), "")
                    | {"F [N]": F, "u_m [m/s]": u_m, "T [degC]": 40.0, "eta_0 [Pa.s]": eta_0, "alpha_p [1/Pa]": 2e-8}
                    | {"h_c [m]": h, "h_min [m]": 0.8 * h, "mu_fluid [1]": 0.05 * (eta_0 * u_m) ** 0.1}
                    | {"status": "ok", "R_x [m]": R, "length [m]": LENGTH, "E_eff [Pa]": E_EFF, "slide_roll [1]": 0.1}
                )
    return found


def written(path: Path, table: list[dict[str, object]] | None = None, without: str = "") -> Path:
    """The map in a file, without one of its columns."""
    names = [c.name for c in COLUMNS if c.name != without]
    lines = [",".join(names)] + [",".join(str(row[n]) for n in names) for row in (rows() if table is None else table)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path
