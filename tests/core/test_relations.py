"""Parameters that follow from others are expressions; what must hold between parameters is told where it does not."""

from collections.abc import Iterator
from typing import Any

import casadi as ca
import numpy as np
import pytest
from gearheat.model.core.component import Component, Equation, equation
from gearheat.model.core.declare import Input, Output, Parameter
from gearheat.model.core.flat import FlatModel
from gearheat.model.errors import ScenarioError
from gearheat.model.run.rows import evaluate_at
from small_parts import model


class Pipe(Component):
    """A pipe: its wall is what lies between its diameters, its area what the wall leaves; both follow unless given."""

    d = Parameter("m", "inner diameter", above=0.0)
    D = Parameter("m", "outer diameter", above=0.0)
    n = Parameter("1", "number of pipes", above=0.0, whole=True)
    A = Parameter("m2", "open area", above=0.0, derived=lambda p: ca.pi / 4 * p.n * (p.D - 2 * p.wall) ** 2)
    wall = Parameter("m", "wall", above=0.0, derived=lambda p: (p.D - p.d) / 2)
    root = Parameter("m", "root of the wall", derived=lambda p: ca.sqrt(p.wall))
    v = Input("m/s", "speed", start=2.0)
    V_flow = Output("m3/s", "flow")

    def equations(self) -> Iterator[Equation]:
        yield equation("flow", self.V_flow, self.A * self.v)

    def relations(self) -> Iterator[Any]:
        yield self.relation(
            "D fits d", "D over d", self.D / self.d, 1.01, 4.0, remedy="Give a thicker or thinner pipe."
        )


def pipe(**values: float) -> FlatModel:
    return model(Pipe("pipe", **{"d": 0.1, "D": 0.12, "n": 2.0} | values), nets=[])


def output(flat: FlatModel, name: str, p: np.ndarray) -> float:
    y = evaluate_at(flat, flat.starts("state"), flat.starts("input"), p)["y"]
    return float(y[flat.locate(name)[1]])


def moved(flat: FlatModel, **values: float) -> np.ndarray:
    p = flat.starts("parameter")
    for name, value in values.items():
        p[flat.locate(f"pipe.{name}")[1]] = value
    return p


def test_a_derived_parameter_moves_with_what_it_follows_from() -> None:
    """Also where it follows from another derived one, declared behind it."""
    flat = pipe()
    assert [q.name for q in flat.parameters] == ["pipe.d", "pipe.D", "pipe.n"]
    assert flat.derived["pipe.A"] == ("pipe.d", "pipe.D", "pipe.n")
    assert output(flat, "pipe.V_flow", moved(flat, d=0.08)) == pytest.approx(2 * np.pi / 4 * 2 * 0.08**2)
    assert output(flat, "pipe.wall", moved(flat, d=0.08)) == pytest.approx(0.02)
    assert flat.quantity("pipe.wall").start == pytest.approx(0.01)


def test_a_given_one_is_a_parameter_like_any_other() -> None:
    flat = pipe(wall=0.03)
    assert "pipe.wall" in [q.name for q in flat.parameters]
    assert output(flat, "pipe.V_flow", moved(flat, d=0.08)) == pytest.approx(2 * np.pi / 4 * 2 * 0.06**2)


def test_relations_hold_or_are_told_with_values_and_remedy() -> None:
    flat = pipe()
    assert not flat.contradictions(flat.starts("parameter"))
    (told,) = flat.contradictions(moved(flat, d=0.01, D=0.1)).values()
    assert told == (
        'pipe: "D fits d" does not hold: D over d is 10, expected from 1.01 to 4 (d = 0.01 m, D = 0.1 m).\n'
        "Give a thicker or thinner pipe."
    )


def test_whole_numbers_are_whole() -> None:
    flat = pipe()
    (told,) = flat.contradictions(moved(flat, n=2.5)).values()
    assert '"n is whole" does not hold' in told
    assert "n = 2.5" in told


def test_a_part_whose_relations_are_broken_is_not_made() -> None:
    with pytest.raises(ScenarioError, match=r"Pipe p: .*D over d is 0\.5"):
        Pipe("p", d=0.2, D=0.1, n=1.0)


def test_what_has_no_value_is_told_where_nothing_else_is() -> None:
    """The root of a negative wall is no exception; the wall itself is the problem, and told first."""
    flat = pipe()
    broken = flat.contradictions(moved(flat, d=0.2))
    assert {relation.name for relation in broken} == {"D fits d", "wall can be derived"}


def test_parameters_that_follow_from_each_other_are_refused() -> None:
    class Circle(Component):
        r = Parameter("m", "radius", derived=lambda p: p.d / 2)
        d = Parameter("m", "diameter", derived=lambda p: 2 * p.r)

    assert Circle("c", r=1.0).values["d"] == 2.0
    with pytest.raises(ScenarioError, match="Circle c: r is missing"):
        Circle("c")
