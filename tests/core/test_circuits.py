"""Circuits against their closed form: the flat model's equations, and the run of them."""

import numpy as np
import pytest
from gearheat.model.core.flat import FlatModel
from gearheat.model.run.rows import evaluate_at
from gearheat.model.run.schedule import join_phases
from gearheat.model.run.simulate import simulate
from small_parts import Battery, Capacitor, Ground, Inductor, Resistor, model, rc, rl


def derivative(flat: FlatModel, x: list[float], u: list[float]) -> np.ndarray:
    return evaluate_at(flat, x, u, flat.starts("parameter"))["ode"]


@pytest.mark.parametrize(("u", "V"), [(0.0, 5.0), (3.0, 5.0), (7.0, -2.0)])
def test_rc_equation(u: float, V: float) -> None:
    assert derivative(rc(R=100.0, C=1e-3), [u], [V]) == pytest.approx([(V - u) / 0.1], rel=1e-14)


@pytest.mark.parametrize(("i", "V"), [(0.0, 5.0), (0.3, 5.0), (-1.0, 2.0)])
def test_rl_equation(i: float, V: float) -> None:
    assert derivative(rl(R=10.0, L=2.0), [i], [V]) == pytest.approx([(V - 10 * i) / 2], rel=1e-14)


def test_an_input_that_is_held_is_a_parameter() -> None:
    held = rc(R=100.0, C=1e-3).holding(["battery.V"])
    assert held.locate("battery.V") == ("parameter", len(held.parameters) - 1) and not held.inputs
    p = held.starts("parameter")
    p[-1] = 5.0
    assert evaluate_at(held, [3.0], [], p)["ode"] == pytest.approx([20.0], rel=1e-14)


def test_rc_charges_as_in_closed_form() -> None:
    t = np.linspace(0.0, 0.5, 51)
    run = simulate(rc(R=100.0, C=1e-3), join_phases([(0.5, {"battery.V": 5.0})]), times=t)
    assert run["capacitor.u"] == pytest.approx(5 * (1 - np.exp(-t / 0.1)), abs=1e-6)
    assert run["resistor.P"] == pytest.approx((5 * np.exp(-t / 0.1)) ** 2 / 100, abs=1e-6)


def test_rl_builds_up_as_in_closed_form() -> None:
    t = np.linspace(0.0, 1.0, 51)
    run = simulate(rl(R=10.0, L=2.0), join_phases([(1.0, {"battery.V": 5.0})]), times=t)
    assert run["coil.j"] == pytest.approx(0.5 * (1 - np.exp(-t / 0.2)), abs=1e-7)


def test_rlc_rings_as_in_closed_form() -> None:
    R, L, C, V = 1.0, 0.5, 0.02, 3.0
    parts = (Battery("e"), Resistor("r", R=R), Inductor("l", L=L), Capacitor("c", C=C), Ground("g"))
    flat = model(*parts, nets=[("e.a", "r.a"), ("r.b", "l.a"), ("l.b", "c.a"), ("c.b", "e.b", "g.pin")])
    t = np.linspace(0.0, 2.0, 41)
    run = simulate(flat, join_phases([(2.0, {"e.V": V})]), times=t, tolerance=1e-10)
    a = R / (2 * L)
    w = np.sqrt(1 / (L * C) - a**2)
    expected = V * (1 - np.exp(-a * t) * (np.cos(w * t) + a / w * np.sin(w * t)))
    assert run["c.u"] == pytest.approx(expected, abs=1e-6)


def test_parallel_resistors_share_the_current() -> None:
    parts = (Battery("e"), Resistor("r1", R=3.0), Resistor("r2", R=6.0), Inductor("l", L=1.0), Ground("g"))
    flat = model(*parts, nets=[("e.a", "r1.a", "r2.a"), ("r1.b", "r2.b", "l.a"), ("l.b", "e.b", "g.pin")])
    assert derivative(flat, [0.5], [4.0]) == pytest.approx([4.0 - 2.0 * 0.5], rel=1e-13)
    y = evaluate_at(flat, [0.5], [4.0], flat.starts("parameter"))["y"]
    powers = dict(zip([q.name for q in flat.outputs], y, strict=True))
    assert powers["r1.P"] == pytest.approx(1.0**2 / 3.0)
    assert powers["r2.P"] == pytest.approx(1.0**2 / 6.0)
