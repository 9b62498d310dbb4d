"""One flat model that holds every hypothesis: the rig with all causes at size zero, and inputs as they are read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np

from ...model.core.flat import FlatModel, Quantity
from ...model.machines.spec import Spec
from ..effects.taxonomy import CAUSES
from .habit import HABIT

#: What stands between an input's reading and its truth; the truth is (reading - bias) / (1 + gain).
READ = (
    Quantity("read.room_bias", "K (difference)", "room probe: reading less truth"),
    Quantity("read.speed_gain", "1", "speed reading: relative error"),
    Quantity("read.torque_bias", "N.m", "carrier's torque: reading less truth"),
    Quantity("read.missing_forward", "1", "share of the dwell as multiplier that is missing"),
    Quantity("read.missing_backward", "1", "share of the dwell as reducer that is missing"),
)
#: Where convection and radiation are told apart, an emissivity over the area that convects: it may exceed 1.
EFFECTIVE = "cooling.emissivity"


def buildable(values: Mapping[str, Any]) -> dict[str, Any]:
    """Values of a machine as a rig file can hold them: no surface radiates more than a black one."""
    return {path: np.minimum(v, 1.0) if path == EFFECTIVE else v for path, v in values.items()}


def superset(spec: Spec) -> Spec:
    """The machine with every cause added, neutral, and with friction in thin films that is its own."""
    for cause in (*CAUSES.values(), HABIT):
        spec = cause.added_to(spec)
    return spec


def as_read(flat: FlatModel) -> FlatModel:
    """A flat model whose inputs are readings: parameters stand between them and the truth."""
    p = ca.vertcat(*[ca.SX.sym(q.name) for q in READ])
    u = {q.name: flat.u[i] for i, q in enumerate(flat.inputs)}
    truth = {
        "room.T": u["room.T"] - p[0],
        "carrier.w": u["carrier.w"] / (1 + p[1]),
        "carrier.tau": u["carrier.tau"] - p[2] * ca.sign(u["carrier.tau"]),
    }
    new = ca.vertcat(*[truth.get(q.name, u[q.name]) for q in flat.inputs])
    expressions = [flat.ode, flat.y, flat.residual, flat.supply, flat.throughput, flat.stored, flat.checked]
    d = ca.sign(u["carrier.tau"])
    pace = 1 - (p[3] * (1 + d) + p[4] * (1 - d)) / 2 * d**2  # a stop is no dwell
    ode, y, residual, supply, throughput, stored, checked = (ca.substitute(e, flat.u, new) for e in expressions)
    return replace(
        flat,
        parameters=(*(replace(q, high=np.inf) if q.name == EFFECTIVE else q for q in flat.parameters), *READ),
        p=ca.vertcat(flat.p, p),
        ode=ode * pace,
        y=y,
        residual=residual,
        supply=supply,
        throughput=throughput,
        stored=stored,
        checked=checked,
    )
