"""Line contacts beside another solver's, their limits, Hertz, and their own order of convergence."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from itertools import pairwise
from math import log2
from typing import Any

import numpy as np

from ....model.contact import hertz
from ....model.contact.line import solve_line
from . import cases
from .rows import Found, Job, bound, row
from .studies import SECOND

#: Nodes of the coarser of two grids.
NODES = 201
#: Nodes of the grids of the study.
GRIDS = (101, 201, 401, 801)
#: The same of the quick subset.
QUICK_GRIDS = (51, 101, 201)
#: Domain of the study over the half width of the Hertz contact [1].
DOMAIN = (-4.0, 2.0)
#: Domain of the rigid limit over that half width [1].
WIDE = (-60.0, 10.0)


def jobs(quick: bool) -> list[Job]:
    """The pieces of work, the quick ones on fewer and coarser grids."""
    data = cases.reference("line")
    grids = QUICK_GRIDS if quick else GRIDS
    return [
        *(Job("Line contact", f"M {r['M']} L {r['L']}", partial(_table, r, data.rel), r["M"] == 20) for r in data.rows),
        *(Job("Line contact", limit["name"], partial(_limit, limit)) for limit in data.more["limit"]),
        Job("Hertz", "line, 100 N/mm", _dry, quick=True),
        Job("Convergence", "line contact", partial(_order, grids), quick=True),
    ]


def _extrapolate(M: float, L: float, **more: Any) -> tuple[float, float, float]:
    """H_c and H_min of second order on two grids, extrapolated, and the larger error of the load."""
    contact, U = cases.line(M, max(L, 1.0))
    oil = replace(cases.SIMPLE_OIL, alpha_p=cases.SIMPLE_OIL.alpha_p * L / max(L, 1.0))
    films = [solve_line(replace(contact, lubricant=oil), n=n, **more) for n in (NODES, 2 * NODES - 1)]
    central, least = ([getattr(f, name) / contact.R_x / U**0.5 for f in films] for name in ("h_c", "h_min"))
    worst = max(abs(f.load_error) for f in films)
    return (4 * central[1] - central[0]) / 3, (4 * least[1] - least[0]) / 3, worst


def _table(case: Mapping[str, float], rel: float) -> Found:
    """One row of the table of another solver, whose first order is extrapolated."""
    central, least, missing = _extrapolate(case["M"], case["L"])
    name = f"M {case['M']:g} L {case['L']:g}"
    references = [2 * case[f"{h} 601"] - case[f"{h} 301"] for h in ("H_c", "H_min")]
    return {
        "rows": [
            row(name, f"{what}/R U^(-1/2)", reference, ours, rel, missing)
            for what, reference, ours in zip(("h_c", "h_min"), references, (central, least), strict=True)
        ]
    }


def _limit(limit: dict[str, Any]) -> Found:
    """A limit of the film."""
    rigid = limit["M"] < 1
    central, least, missing = _extrapolate(limit["M"], limit["L"], **({"domain": WIDE} if rigid else {}))
    ours = least * limit["M"] if rigid else central * limit["M"] ** 0.2
    name = f"{limit['name']}, M {limit['M']:g} L {limit['L']:g}"
    return {"rows": [row(name, limit["value"], limit["reference"], ours, limit["rel"], missing)]}


def _dry() -> Found:
    """A line contact at rest."""
    contact = replace(cases.line(20, 10)[0], F=1e5, u_1=0.0, u_2=0.0)
    film, dry = solve_line(contact, n=NODES), hertz(contact)
    ours = float(film.p.max()) / 1e9
    return {"rows": [row("line, 100 N/mm", "largest pressure [GPa]", dry.p_max / 1e9, ours, 0.01, film.load_error)]}


def _order(grids: tuple[int, ...]) -> Found:
    """Differences between grids of doubled nodes, and the order they fall with."""
    contact, _ = cases.line(20.0, 10.0)
    films = [solve_line(replace(contact, lubricant=cases.SIMPLE_OIL), n=n, domain=DOMAIN) for n in grids]
    apart = {
        what: [abs(getattr(a, what) / getattr(b, what) - 1) for a, b in pairwise(films)] for what in ("h_c", "h_min")
    }
    places = np.linspace(-1.5, 0.8, 200) * hertz(contact).a
    fields = [np.interp(places, f.x, np.ravel(f.h)) for f in films]
    apart["h, rms"] = [float(np.sqrt(np.mean((a - b) ** 2) / np.mean(b**2))) for a, b in pairwise(fields)]
    name = f"line, M 20 L 10, {grids[-3]}, {grids[-2]}, {grids[-1]} nodes"
    orders = {what: log2(d[-2] / d[-1]) for what, d in apart.items()}
    rows = [  # the minimum changes by less than 5e-4 already
        bound(name, f"order of {what}", order, least=SECOND, judged=what != "h_min") for what, order in orders.items()
    ]
    return {"rows": rows, "spacing": [6.0 / (n - 1) for n in grids], "apart": apart}
