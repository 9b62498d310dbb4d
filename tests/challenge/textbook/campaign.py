"""Campaigns of the textbook rig: tests, instruments that are rougher than their card, days. FROZEN, see the package."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from .. import files
from ..cases import Drawn
from ..plan import Plan, draw_plan, draw_points
from .faults import CAUSES, OUTSIDE, limited, names
from .rig import BODIES, Around, Fault, draw_sizes, run

#: Real tolerances and scatter of the days over what the card states.
UNDERSTATED = 1.5

#: Freedom of a rig of unknown sizes: the diagnosis learns it from the reference.
PRIOR_SD = dict.fromkeys(("mesh", "bearing", "seal", "conv", "rad", "oil_side", "joint", "cap"), 0.4)


def draw(rng: np.random.Generator) -> Drawn:
    """A rig and its campaigns: the data, a reference five weeks earlier, and points to predict."""
    sizes = draw_sizes(rng)
    warm, drift = bool(rng.random() < 0.15), round(float(rng.uniform(-1.5, 0.5)), 2)
    plan = draw_plan(rng, warm_start=warm, room_drift=drift)
    reference = draw_plan(rng, warm_start=warm, room_drift=drift)
    if rng.random() < 0.6:
        reference = replace(reference, n=plan.n + rng.normal(0.0, 0.5, plan.columns), load=plan.load)
    day_sd = UNDERSTATED * files.DAY_COOLING_SD
    a, b = (np.exp(rng.normal(0.0, day_sd, p.columns)) for p in (plan, reference))
    return Drawn(
        run=partial(run, sizes),
        plan=plan,
        points=draw_points(rng, plan, room_drift=drift),
        reference=reference,
        days=(a, b),
        day_sd=day_sd,
        prior=PRIOR_SD,
        instruments=files.draw_instruments(
            rng, 0.6, second_oil=False, understated=UNDERSTATED, tails=4.0, missing=0.08, gross=0.4
        ),
        layout=files.Layout(humidity=True, start=warm, date=bool(rng.random() < 0.5)),
        bearing_oil=sizes.bearing_oil,
        room_drift=drift,
        band=(5.0, 60.0),
        names=_names,
        draw=partial(_fault, plan),
        facts={"bodies": len(BODIES), "understated": UNDERSTATED},
    )


def _names(kind: str) -> Sequence[str]:
    return list(names(kind))


def _fault(plan: Plan, cause: str, kind: str, oil: np.ndarray, rng: np.random.Generator) -> Fault:
    """A fault of a cause in a form for a kind of case; oil: healthy oil temperatures."""
    around = Around(plan.n.ravel(), plan.load.ravel(), oil.ravel(), plan.tests)
    fault = {**CAUSES, **OUTSIDE}[cause](rng, around)
    return limited(fault, rng, around) if kind == "regime" else fault
