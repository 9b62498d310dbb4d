"""Implicit blocks of real parts: surfaces without capacity, and equations whose sides are swapped."""

import math
from collections.abc import Iterator
from dataclasses import replace

import pytest
from gearheat.model.core.component import Component, Equation
from gearheat.model.core.connect import Assembly
from gearheat.model.core.flatten import flatten
from gearheat.model.parts import PARTS
from gearheat.model.run.result import Result
from gearheat.model.run.steady import steady
from gearheat.scenarios.load import load

BOX = dict(A=0.5, emissivity=0.9, height=0.3, length=0.4, width=0.25, share_top=0.2, share_bottom=0.2)


def walled(**surface: float) -> Result:
    """A body of 60 W behind a plane wall whose outside has no capacity, or one."""
    made = {
        "oil": PARTS["HeatCapacity"]("oil", C=2000.0),
        "wall": PARTS["PlaneWall"]("wall", k=0.3, A=0.5, d=0.01),
        "cooling": PARTS["BoxCooling"]("cooling", **BOX),
        "room": PARTS["Room"]("room"),
    }
    outside = ["wall.b", "cooling.surface"]
    if surface:
        made["surface"] = PARTS["HeatCapacity"]("surface", **surface)
        outside.append("surface.heat")
    nets = (("oil.heat", "wall.a"), tuple(outside), ("cooling.air", "room.air"))
    flat = flatten(Assembly("walled", "", tuple(made.values()), nets))
    assert len(flat.states) == len(made) - 3 and len(flat.algebraic) == (0 if surface else 1)
    return steady(flat, {"oil.Q_flow_external": 60.0, "room.T": 293.15, "room.air_speed": 0.5})


def test_a_wall_to_a_surface_without_capacity() -> None:
    """Convection and radiation of a massless surface are those of one with a capacity, once nothing changes."""
    without, with_one = walled(), walled(C=500.0)
    for name in ("oil.T", "cooling.h", "cooling.Q_flow_convection", "cooling.Q_flow_radiation"):
        assert without[name][0] == pytest.approx(with_one[name][0], rel=1e-9)
    T = float(without["oil.T"][0]) - 60.0 / (0.3 * 0.5 / 0.01)
    radiated = 5.670374419e-8 * 0.5 * 0.9 * (T**4 - 293.15**4)
    assert without["cooling.Q_flow_radiation"][0] == pytest.approx(radiated, rel=1e-6)
    assert float(with_one["surface.T"][0]) == pytest.approx(T, abs=1e-6)


def swapped(kind: type[Component], names: tuple[str, ...]) -> type[Component]:
    class Swapped(kind):  # type: ignore[misc, valid-type]
        def equations(self) -> Iterator[Equation]:
            for e in super().equations():
                yield Equation(e.name, e.rhs, e.lhs) if not names or e.name in names else e

    return Swapped


@pytest.mark.parametrize("names", [("mesh loss",), ("torque less loss", "tangential force"), ()], ids=str)
def test_sides_of_equations_do_not_matter(names: tuple[str, ...]) -> None:
    scenario = load("helical_two_stage")
    kinds = {"HelicalGearPair": swapped(PARTS["HelicalGearPair"], names)}
    if not names:
        kinds |= {k: swapped(PARTS[k], ()) for k in ("DeepGrooveBallBearing", "TwoGearSupport", "ShaftEnd", "LipSeal")}
    changed = replace(scenario.spec, types={**scenario.spec.types, **kinds})
    here = steady(scenario.spec.flat(), scenario.operating_point)
    there = steady(changed.flat(), scenario.operating_point)
    for name, column in here.columns.items():
        assert math.isclose(there[name][0], column[0], rel_tol=1e-9, abs_tol=1e-9), name
