"""From what a search found to the rig: its values as calibrated, and the rig file with what was found."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ....model.parts.free_form import EXTRA_PARTS
from ....model.units import from_si
from ....scenarios.nuisances import Nuisance
from ..answer.estimate import posterior
from ..infer.found import Found, Hypothesis
from ..library.cause import Cause, Form, Row, Size, Theta, Values
from ..setting import Setting
from .extension import Applied, Extended, directions, extended
from .findings import Calibrated


def values(found: Found, z: np.ndarray) -> dict[str, float]:
    """Values of the rig by path as nuisances (n,) calibrate them [SI], those of added parts among them."""
    plant, told = found.problem.data.plant, dict[str, float]()
    for nuisance, change in zip(found.problem.data.nuisances, z, strict=False):
        for path, exponent in nuisance.paths.items():
            before = told.get(path, float(plant.p[plant.place[path]]))
            told[path] = before * float(np.exp(exponent * nuisance.sd * change))
    return told


def calibrated(setting: Setting, found: Found, h: Hypothesis) -> tuple[Calibrated, ...]:
    """Values that the data moved, in the units of the rig file.

    Args:
        setting: the rig
        found: the search
        h: the hypothesis of the answer
    """
    known, told = setting.scenario.settable(), []
    nominal, extended = values(found, found.null.look.z), values(found, h.fit.look.z)
    for path, value in nominal.items():
        if path in known:
            unit = known[path].unit
            file = float(setting.plant.p[setting.plant.place[path]])
            shown = [float(from_si(v, unit)) for v in (file, value, extended[path])]
            causes = shown[2] if h.causes else None
            told.append(Calibrated(path=path, unit=unit, file=shown[0], nominal=shown[1], extended=causes))
    return tuple(told)


def rig_file(setting: Setting, found: Found, h: Hypothesis) -> str:
    """The text of the rig file: calibrated, with the causes of a hypothesis, and how uncertain the data leave both.

    Args:
        setting: the rig
        found: the search
        h: the hypothesis of the answer
    """
    data, scenario = found.problem.data.campaign, replace(setting.scenario, spec=setting.spec)
    oils = dict.fromkeys(data.oil)
    if len(oils) == 1 and (own := setting.oils.get(next(iter(oils)))):
        known = scenario.settable()
        filled = {path: value for path, value in own.items() if path in known}
        scenario = scenario.with_values(filled, f"inferred: the oil of {data.name}")

    def at(x: np.ndarray) -> Extended:
        z, acting = h.fit.split(found.problem, x)
        told = values(found, z)
        added = [_added(n, told) for n in found.problem.data.nuisances if n.parts]
        causes = [Applied(a.formula.cause, a.formula.form, a.formula.theta(a.t)) for a in acting]
        return extended(scenario, told, causes, data.name, EXTRA_PARTS, len(oils), added)

    x = h.fit.look.x
    uncertain = directions(lambda near: at(near).values, x, posterior(found.problem, h)[1])
    return at(x).text(uncertain)


def _added(nuisance: Nuisance, calibrated_values: dict[str, float]) -> Applied:
    """What calibration adds to a rig, as if it were a cause."""
    own = {path: calibrated_values[path] for path in nuisance.paths}

    def held(theta: Theta, row: Row) -> Values:
        return own

    form = Form(parts=nuisance.parts, connections=nuisance.connections, values=held)
    entry = Cause(
        f"calibration of {nuisance.name}", "Calibration adds it.", Size("factor", "1", "", 1.0, 0.0, 1.0), (form,)
    )
    return Applied(entry, form, {})
