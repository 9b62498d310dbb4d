"""What the data and the nominal model say of sizes and ranges."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ....model.core.flatten import flatten
from ....model.errors import SolveError
from ....model.machines.roles import Roles
from ....model.machines.spec import Spec, assemble
from ....scenarios.measured.table import Campaign
from ..library.cause import Ranges
from .observe import Observed
from .plant import Plant


def ranges_of(
    spec: Spec,
    roles: Roles,
    campaign: Campaign,
    oils: Mapping[str, Mapping[str, float]],
    point: Mapping[str, float],
) -> Ranges:
    """Of a campaign on a rig as its file has it.

    Args:
        spec: the rig, driven as the campaign drives it
        roles: of its parts
        campaign: the data
        oils: oil of a test -> values by path
        point: values of inputs that no sensor gives

    Raises:
        SolveError: the rig cannot be run in any test
    """
    flat = flatten(assemble(spec))
    ends = [f"{end}.{quantity}" for end in roles.ends for quantity in ("w", "tau")]
    shown = [roles.speed, roles.torque, roles.oil, *([roles.viscosity] if roles.viscosity else []), *ends]
    given = [s.reads for s in campaign.given]
    plant = Plant(flat, (), given, tuple(dict.fromkeys(shown)))
    o = Observed(plant, campaign, (), oils, point)
    values = dict(zip(plant.shown, o.outputs().T, strict=True))
    if not (fine := np.isfinite(values[roles.oil])).any():
        raise SolveError(f"{spec.name}: the rig cannot be run at any point of {campaign.name}. Check its rig file.")
    power = [values[w] * values[tau] for w, tau in zip(ends[::2], ends[1::2], strict=True)]
    w, tau, T = np.abs(values[roles.speed]), np.abs(values[roles.torque]), values[roles.oil]
    nu = values[roles.viscosity] if roles.viscosity else np.full(campaign.n, 1e-4)
    rooms = [s.name for s in campaign.sensors if s.kind == "ambient"]
    room = o.sensors[rooms[0]] if rooms else np.full(campaign.n, point.get(f"{roles.room}.T", 293.15))
    whole = {"w": w, "tau": tau, "T": T, "nu": nu, "film": w * nu}
    whole |= {s.name: np.abs(o.sensors[s.name]) for s in campaign.sensors}
    whole |= {"order": campaign.progress, "direction": campaign.direction}
    low, mid, high = ({name: float(np.quantile(v[fine], q)) for name, v in whole.items()} for q in (0.05, 0.5, 0.95))
    loss = float(np.median(np.abs(np.sum(power, axis=0)[fine])))
    known = {"order"} if campaign.n_tests > 1 else set()
    known |= {"dwell"} if np.isfinite(campaign.dwell).any() else set()
    known |= {"humidity"} if np.isfinite(campaign.humidity).any() else set()
    known |= {"mounting"} if len(set(campaign.mounting)) > 1 else set()
    known |= {f"still: {s.name}" for s in campaign.read if campaign.still(s)}
    rise = max(float(np.median((T - room)[fine])), 1.0)
    return Ranges(low, mid, high, max(loss, 1e-3), rise, frozenset(known))
