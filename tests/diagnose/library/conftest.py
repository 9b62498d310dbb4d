"""Shipped rigs with their sensors, ranges as around their operating point, and all causes."""

from dataclasses import dataclass, replace
from functools import cache

import pytest
from gearheat.model.core.flat import FlatModel
from gearheat.model.machines.roles import Roles
from gearheat.model.parts.free_form import EXTRA_PARTS
from gearheat.model.run.result import Result
from gearheat.model.run.steady import steady
from gearheat.scenarios.load import load
from gearheat.scenarios.measured.card import Card
from gearheat.scenarios.measured.sensors import sensors_of
from gearheat.scenarios.measured.table import Sensor
from gearheat.scenarios.scenario import Scenario
from gearheat.tools.diagnose.library.cause import Cause, Ranges
from gearheat.tools.diagnose.library.registry import library
from gearheat.tools.diagnose.setting import DOES

#: All that may be known of the rows of a campaign.
ALL_KNOWN = frozenset({"order", "dwell", "mounting", "humidity", "still: T_wall", "still: T_oil"})


@dataclass(frozen=True)
class Case:
    """A rig at its operating point with everything that may be wrong with it."""

    scenario: Scenario
    roles: Roles
    sensors: tuple[Sensor, ...]
    ranges: Ranges
    causes: tuple[Cause, ...]
    nominal: Result

    def cause(self, name: str) -> Cause:
        """The cause of an identifier."""
        return next(c for c in self.causes if c.id == name)

    def with_form(self, cause: str, form: int = 0) -> FlatModel:
        """The rig with the parts of a form."""
        f = self.cause(cause).forms[form]
        return self.scenario.spec.with_parts(f.parts, f.connections, EXTRA_PARTS).flat()


def value(result: Result, path: str) -> float:
    """A value of a steady state."""
    return float(result[path][0])


@cache
def _case(name: str) -> Case:
    scenario = load(name)
    if name == "planetary":
        scenario = scenario.driven({"carrier": ("w", "tau")})
    roles, sensors = Roles.of(scenario.spec), sensors_of(scenario, Card())
    flat = scenario.spec.flat()
    found = steady(flat, scenario.operating_point)
    mid = {"w": abs(value(found, roles.speed)), "tau": abs(value(found, roles.torque)), "T": value(found, roles.oil)}
    mid |= {"nu": value(found, roles.viscosity) if roles.viscosity else 1e-4, "order": 0.5, "direction": 0.0}
    mid |= {"film": mid["w"] * mid["nu"]} | {s.name: abs(value(found, s.reads)) for s in sensors}
    span = {"order": 1.0, "direction": 2.0 if name == "planetary" else 0.0}
    span |= {k: 40.0 for k in mid if k == "T" or k in {s.name for s in sensors if s.unit == "degC"}}
    low = {k: v - span.get(k, 0.8 * v) / 2 for k, v in mid.items()}
    high = {k: v + span.get(k, 0.8 * v) / 2 for k, v in mid.items()}
    rise = max(mid["T"] - scenario.operating_point[f"{roles.room}.T"], 5.0)
    power = sum(value(found, f"{e}.w") * value(found, f"{e}.tau") for e in roles.ends)
    does = {p.name: [path for key in DOES if (path := f"{p.name}.{key}") in flat.index] for p in scenario.spec.parts}
    powers = {part: sum(abs(value(found, path)) for path in paths) for part, paths in does.items()}
    ranges = Ranges(low, mid, high, abs(power), rise, ALL_KNOWN, powers)
    return Case(scenario, roles, sensors, ranges, library(roles, ranges, sensors), found)


@pytest.fixture(scope="session")
def case():
    """Makes the case of a rig by its name, once."""
    return _case


@pytest.fixture(scope="session")
def without():
    """The causes of a rig where less is known of the rows."""

    def of(name: str, *known: str) -> dict[str, Cause]:
        c = _case(name)
        return {x.id: x for x in library(c.roles, replace(c.ranges, known=frozenset(known)), c.sensors)}

    return of
