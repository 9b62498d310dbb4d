"""Losses that change the torque they depend on: algebraic variables, solved or refused by name."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
import small_parts
from gearheat.model.core.component import Component, Equation, equation
from gearheat.model.core.declare import Input, Output, Parameter, Variable
from gearheat.model.core.flat import FlatModel
from gearheat.model.errors import SolveError
from gearheat.model.run.algebra import algebra
from gearheat.model.run.rows import evaluate_at
from gearheat.model.run.search import sensitivities
from gearheat.model.run.steady import steady
from scipy.optimize import brentq
from small_parts import SIGMA, Ambient, Body, Conductor, Radiation, gear, model


def at(flat: FlatModel, w: float, tau: float) -> tuple[dict[str, float], np.ndarray]:
    u = flat.starts("input")
    for name, value in (("drive.w", w), ("load.tau", tau)):
        u[flat.locate(name)[1]] = value
    found = evaluate_at(flat, flat.starts("state"), u, flat.starts("parameter"))
    return dict(zip([q.name for q in flat.outputs], found["y"], strict=True)), found["residual"]


def loss_by_bisection(mu: float, w: float, tau: float, ratio: float = 3.0) -> float:
    """The loss torque of the gear from its equations by hand: tau at b is the load's, force the mean of both sides."""
    direction = w / np.sqrt(w**2 + 1e-4)

    def miss(tau_loss: float) -> float:
        tau_b = tau / ratio  # the load acts on b, so the gear feels it
        tau_a = tau_loss * direction - tau_b
        force = (tau_a - tau_b) / 2
        return tau_loss - mu * np.sqrt(force**2 + 1e-4) ** 0.8

    return brentq(miss, -1.0, 1e4, xtol=1e-14)


@pytest.mark.parametrize("mu", [0.0, 0.02, 0.1, 0.3, 2.0])
@pytest.mark.parametrize(("w", "tau"), [(100.0, -30.0), (100.0, 30.0), (-50.0, -30.0), (100.0, -600.0), (0.5, 3.0)])
def test_loss_against_bisection(mu: float, w: float, tau: float) -> None:
    """Also losses larger than the load, far from a start without losses."""
    y, _ = at(gear(mu), w, tau)
    expected = loss_by_bisection(mu, w, tau)
    assert y["gear.P_loss"] == pytest.approx(expected * w**2 / np.sqrt(w**2 + 1e-4), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(("w", "tau"), [(100.0, -30.0), (0.0, -30.0), (100.0, 0.0), (0.0, 0.0), (-100.0, 500.0)])
def test_residual_is_round_off_and_named(w: float, tau: float) -> None:
    flat = gear(0.1)
    y, residual = at(flat, w, tau)
    assert flat.residual_names == ("gear: loss",)
    assert np.abs(residual).max() < 1e-12
    assert np.isfinite(list(y.values())).all()


def test_derivative_of_an_implicit_loss() -> None:
    flat = gear(0.1)
    h = 1e-4
    slope = (at(flat, 100.0, -30.0 + h)[0]["drive.tau"] - at(flat, 100.0, -30.0 - h)[0]["drive.tau"]) / (2 * h)
    exact = sensitivities(flat, ["drive.tau"], ["load.tau"], {"drive.w": 100.0, "load.tau": -30.0})
    assert exact.item() == pytest.approx(slope, rel=1e-6)


class Cubic(Component):
    """y^3 - 6 y^2 + 11 y = a + 6: three solutions around a = 0, one beyond, and slopes that turn Newton back."""

    a = Input("1", "right side")
    y = Output("1", "unknown", guess=0.0)

    def equations(self) -> Iterator[Equation]:
        yield equation("cubic", self.y**3 - 6 * self.y**2 + 11 * self.y, self.a + 6)


class Pair(Component):
    """A circle and a parabola, which meet for some radii only."""

    r = Input("1", "radius", start=2.0)
    b = Parameter("1", "lowest point of the parabola")
    x, y = Variable("1", "first unknown"), Output("1", "second unknown")

    def equations(self) -> Iterator[Equation]:
        yield equation("circle", self.x**2 + self.y**2, self.r**2)
        yield equation("parabola", self.y, self.b + self.x**2 + 0.1 * self.x)


@pytest.mark.parametrize("a", [-1e6, -30.0, 0.0, 30.0, 1e6])
def test_a_cubic_far_from_its_guess(a: float) -> None:
    y = steady(model(Cubic("cubic"), nets=[]), {"cubic.a": a})["cubic.y"][0]
    assert y**3 - 6 * y**2 + 11 * y == pytest.approx(a + 6, rel=1e-9, abs=1e-8)


def test_a_block_without_guesses_is_torn_at_its_nonlinear_unknowns() -> None:
    flat = model(Pair("pair", b=-1.0), nets=[])
    assert {q.name for q in flat.algebraic} == {"pair.x", "pair.y"}
    found = steady(flat, {"pair.r": 3.0})
    assert found.implicit and max(found.implicit.values()) < 1e-12


def test_what_has_no_solution_is_refused_by_name() -> None:
    with pytest.raises(SolveError, match=r'the equation "pair: \w+" has no solution here \(last pair\.'):
        steady(model(Pair("pair", b=5.0), nets=[]), {"pair.r": 0.5})


def test_rows_are_solved_as_single_points_are() -> None:
    flat, n = gear(0.3), 50
    x, u, p = (np.tile(flat.starts(kind)[:, None], (1, n)) for kind in ("state", "input", "parameter"))
    u[flat.locate("drive.w")[1]], u[flat.locate("load.tau")[1]] = np.linspace(-80, 80, n), np.linspace(500, -900, n)
    single = [algebra(flat).solve(x[:, k], u[:, k], p[:, k])[0] for k in range(n)]
    assert algebra(flat).solve_rows(x, u, p)[0] == pytest.approx(single, rel=1e-12, abs=1e-12)


def test_sides_of_equations_do_not_matter(monkeypatch: pytest.MonkeyPatch) -> None:
    class Swapped(small_parts.LossyGear):
        def equations(self) -> Iterator[Equation]:
            yield from (Equation(e.name, e.rhs, e.lhs) for e in super().equations())

    as_written, _ = at(gear(0.1), 100.0, -30.0)
    monkeypatch.setattr(small_parts, "LossyGear", Swapped)
    other, _ = at(gear(0.1), 100.0, -30.0)
    assert other == pytest.approx(as_written, rel=1e-12)


def massless(*surfaces: Component) -> tuple[FlatModel, dict[str, Any]]:
    """A body at 420 K that conducts to a node without capacity, which gives its heat to surfaces."""
    parts = (Body("body", C=1000.0), Conductor("wall", G=2.0), *surfaces, Ambient("room"))
    node = ("wall.b", *(f"{part.name}.a" for part in surfaces))
    air = ("room.heat", *(f"{part.name}.b" for part in surfaces))
    flat = model(*parts, nets=[("body.heat", "wall.a"), node, air])
    y = evaluate_at(flat, np.array([420.0]), flat.starts("input"), flat.starts("parameter"))["y"]
    return flat, dict(zip([q.name for q in flat.outputs], y, strict=True))


def test_a_node_without_capacity_radiates_and_conducts() -> None:
    flat, y = massless(Radiation("surface", A=0.1), Conductor("air", G=0.5))
    assert len(flat.algebraic) == 1
    T = brentq(lambda T: 2 * (420 - T) - SIGMA * 0.1 * (T**4 - 300**4) - 0.5 * (T - 300), 250, 420, xtol=1e-12)
    assert y["surface.Q_flow"] == pytest.approx(SIGMA * 0.1 * (T**4 - 300**4), rel=1e-9)
    assert y["wall.Q_flow"] == pytest.approx(2 * (420 - T), rel=1e-9)


def test_many_nodes_without_capacity() -> None:
    """A bar of massless nodes that radiate: one algebraic variable a node, the heat that enters leaves."""
    n = 40
    walls, skins = (
        [kind(f"{name}{k}", **value) for k in range(n)]
        for kind, name, value in ((Conductor, "wall", dict(G=5.0)), (Radiation, "skin", dict(A=0.02)))
    )
    nets = [(f"wall{k}.b", f"skin{k}.a", *([f"wall{k + 1}.a"] if k + 1 < n else [])) for k in range(n)]
    nets += [("body.heat", "wall0.a"), ("room.heat", *(f"skin{k}.b" for k in range(n)))]
    flat = model(Body("body", C=1000.0), *walls, *skins, Ambient("room"), nets=nets)
    assert len(flat.algebraic) == n
    found = evaluate_at(flat, np.array([900.0]), flat.starts("input"), flat.starts("parameter"))
    y = dict(zip([q.name for q in flat.outputs], found["y"], strict=True))
    assert y["wall0.Q_flow"] == pytest.approx(sum(y[f"skin{k}.Q_flow"] for k in range(n)), rel=1e-12)
    assert y["wall0.Q_flow"] > y[f"wall{n - 1}.Q_flow"] > 0
