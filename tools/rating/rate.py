"""Losses of the model beside those of a reference method, sump temperature and rating."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from scipy.optimize import brentq

from ...model.core.flat import Quantity
from ...model.errors import Problems, ScenarioError, suggestion
from ...model.parts.ports import COLDEST, HOTTEST
from ...model.run.result import Outside
from ...model.sources import LawInfo, LawUse, recording
from ...model.units import from_si
from ...scenarios.given import RigLike, Settings, scenario_of
from ...scenarios.values import in_range
from ..show.display import Answer, Table
from ..solve.settings import adjust
from ..solve.steady import list_outside
from .gather import Machine, machine_of
from .methods import FACTORS, METHODS, Method

#: Largest multiple of the load that a rating looks for.
MOST_LOAD = 100.0
#: What the options are values of.
LIMIT = Quantity("--limit", "K", "temperature of the sump", low=COLDEST, high=HOTTEST)
K = Quantity("--k", "W/(m2.K)", "heat transfer coefficient", low=0.0, low_open=True)
DEPTH = Quantity("", "m", "depth to which a gear dips", low=0.0)


@dataclass(frozen=True, eq=False, repr=False)
class MethodRating(Answer):
    """Losses of the model beside those of a reference method, and what the method rates.

    Attributes:
        method: the method in words
    """

    method: str


def rate_by_method(
    rig: RigLike,
    method: str,
    *,
    limit: str = "95 degC",
    k: str | None = None,
    dip: Sequence[str] = (),
    set: Settings = (),
) -> MethodRating:
    """Losses by component of the model and of a reference method, and what the method rates.

    Args:
        rig: name, file or rig
        method: "iso14179-1" or "iso14179-2"
        limit: temperature of the sump that the rating keeps
        k: heat transfer coefficient of the bare housing in the place of the method's, "20 W/(m2.K)"
        dip: depths to which gears dip, "stage_1.wheel=20 mm"
        set: values by name: texts with units, quantities of pint, or numbers in SI

    Raises:
        GearheatError: all that is wrong with what is asked

    Example:
        >>> import gearheat as gh
        >>> gh.rate_by_method("helical_two_stage", "iso14179-1").found["rating"]["limit_C"]
        95.0
    """
    if (known := METHODS.get(method)) is None:
        raise ScenarioError(
            f'--method: there is no "{method}".{suggestion(method, METHODS)} Known: {", ".join(METHODS)}.'
        )
    T_limit = in_range("", limit, LIMIT)
    k_given = None if k is None else in_range("", k, K)
    scenario = adjust(scenario_of(rig), set)
    machine = machine_of(scenario, tuple(FACTORS), _depths(dip))
    found = {"schema": "gearheat.reference/1", "rig": scenario.name, "method": method}
    found |= compare(machine, known, T_limit, k_given)
    heading = f"{scenario.name}: losses at the operating point"
    return MethodRating(found, known.title, heading=heading, shown=_table(found, known.title))


def _table(found: Mapping[str, Any], method: str) -> Table:
    """Losses by kind, efficiency and oil temperature: model, method, method at its own sump temperature."""
    names = {"model": "model", "method": method, "method_at_sump": f"{method}, own sump"}
    columns = [name for name in names if name in found["losses_W"]]
    kinds = list(dict.fromkeys(kind for name in columns for kind in found["losses_W"][name]))
    kinds = [kind for kind in kinds if kind != "total" and any(found["losses_W"][n].get(kind) for n in columns)]
    rows = [[f"{k} [W]", *(found["losses_W"][n].get(k) for n in columns)] for k in (*kinds, "total")]
    rows.append(["efficiency", *(found["eta"][n] for n in columns)])
    rows.append(["oil [degC]", *(found["T_oil_C"][n] for n in columns)])
    return ("", *(names[n] for n in columns)), rows


def compare(machine: Machine, method: Method, T_limit: float, k: float | None) -> dict[str, Any]:
    """Everything that a method says of a machine, beside the model.

    Args:
        machine: the machine
        method: the method
        T_limit: temperature of the sump that the rating keeps [K]
        k: heat transfer coefficient over the bare area in the place of the method's [W/(m2.K)]
    """
    area = sum(s.values["A"] for s in machine.surfaces)

    def conductance(T: float) -> float:
        return k * area if k is not None else method.conductance(machine, T)

    def surplus(T: float, share: float = 1.0) -> float:
        return total(method.losses(machine.loaded(share), T)) - conductance(T) * (T - machine.T_room)

    T_sump = _root(surplus, machine.T_room, HOTTEST)
    share = _root(lambda s: surplus(T_limit, s), 0.0, MOST_LOAD)
    with recording() as uses:
        columns = {"model": machine.ours, "method": method.losses(machine, machine.T_oil)}
        if share is not None:
            method.losses(machine.loaded(share), T_limit)
    if T_sump is not None:
        columns["method_at_sump"] = method.losses(machine, T_sump)
    temperatures = {"model": machine.T_oil, "method": machine.T_oil, "method_at_sump": T_sump}
    return {
        "losses_W": {
            name: {kind: sum(parts.values()) for kind, parts in losses.items()} | {"total": total(losses)}
            for name, losses in columns.items()
        },
        "parts_W": columns,
        "eta": {name: 1 - total(losses) / machine.P_in if machine.P_in else None for name, losses in columns.items()},
        "T_oil_C": {name: _celsius(temperatures[name]) for name in columns},
        "T_sump_C": _celsius(T_sump),
        "T_room_C": _celsius(machine.T_room),
        "conductance_W_K": conductance(T_sump) if T_sump is not None else None,
        "rating": _rating(machine, T_limit, share, surplus(T_limit, 0.0)),
        "gears": [
            {"part": m.name, "v_m_s": m.v, "F_t_N": m.F_t, "dips_mm": [1e3 * dip for dip in m.dips]}
            for m in machine.meshes
        ],
        "not_treated": [asdict(u) for u in machine.untreated],
        "outside": _outside(method, uses),
        "assumptions": list(method.assumptions),
    }


def _outside(method: Method, uses: Sequence[LawUse]) -> list[dict[str, Any]]:
    """The laws that a method uses outside their range, now or at its rating, as results list them."""
    met: dict[tuple[LawInfo, str], list[float]] = {}
    for use in uses:
        for argument, value in use.arguments.items():
            low, high = use.law.ranges[argument]
            if not low <= float(value) <= high:
                met.setdefault((use.law, argument), []).append(float(value))
    return list_outside(
        Outside(method.title, law.name, argument, *law.ranges[argument], min(values), max(values))
        for (law, argument), values in met.items()
    )


def total(losses: Mapping[str, Mapping[str, float]]) -> float:
    """Sum of all losses [W]."""
    return sum(power for parts in losses.values() for power in parts.values())


def _rating(machine: Machine, T_limit: float, share: float | None, at_no_load: float) -> dict[str, Any]:
    """The power that keeps the sump at its limit; none where it is beyond reach, and why."""
    found = {"limit_C": _celsius(T_limit), "load_share": share, "power_W": None, "why": ""}
    if share is not None and machine.P_in is None:
        return found | {"why": f"{share:.3g} times the load, but no power passes through the rig"}
    if share is not None:
        return found | {"power_W": share * (machine.P_in or 0.0)}
    if at_no_load > 0:
        return found | {"power_W": 0.0, "why": "without load the sump already gets hotter than that"}
    return found | {"why": f"even {MOST_LOAD:g} times the load keeps the sump below that"}


def _root(function: Any, low: float, high: float) -> float | None:
    """Where a rising or falling function is zero; None where it is not between the ends."""
    if function(low) * function(high) > 0:
        return None
    return float(brentq(function, low, high, xtol=1e-6))


def _celsius(T: float | None) -> float | None:
    return None if T is None else from_si(T, "K")


def _depths(texts: Sequence[str]) -> dict[str, float]:
    found: dict[str, float] = {}
    problems = Problems()
    for text in texts:
        name, _, raw = (part.strip() for part in text.partition("="))
        with problems:
            found[name] = in_range(f"--dip {name}", raw, DEPTH)
    problems.check()
    return found
