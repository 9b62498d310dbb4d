"""The solver's step as an expression: order, error estimate and damping."""

from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest
from gearheat.fmu.rosenbrock import RODAS3, RODAS4, Tableau, step
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

Step = Callable[..., tuple[np.ndarray, np.ndarray]]


def compiled(ode: ca.SX, x: ca.SX, u: ca.SX, tableau: Tableau) -> Step:
    x_new, _, error, slope, h = step(ode, ca.SX(0, 1), x, ca.SX(0, 1), u, tableau)
    function = ca.Function("step", [x, u, slope, h], [x_new, error])
    return lambda *arguments: tuple(np.array(v).ravel() for v in function(*arguments))


@pytest.mark.parametrize("tableau", [RODAS3, RODAS4], ids=["RODAS3", "RODAS4"])
def test_order_of_result_and_error_with_a_sloped_input(tableau: Tableau) -> None:
    x, u = ca.SX.sym("x", 2), ca.SX.sym("u")
    ode = ca.vertcat(-(x[0] ** 2) + ca.sin(u), x[0] * x[1] - x[1] ** 3 + u**2)
    run = compiled(ode, x, u, tableau)

    def rate(t: float, z: np.ndarray) -> list[float]:
        w = 0.3 + 0.7 * t
        return [-(z[0] ** 2) + np.sin(w), z[0] * z[1] - z[1] ** 3 + w**2]

    exact = solve_ivp(rate, (0, 1), [1, 0.5], method="DOP853", rtol=1e-13, atol=1e-13).y[:, -1]
    errors, estimates = [], []
    for count in (20, 40):
        z, estimate = np.array([1, 0.5]), 0.0
        for k in range(count):
            z, e = run(z, 0.3 + 0.7 * k / count, 0.7, 1 / count)
            estimate = max(estimate, np.abs(e).max())
        errors.append(np.abs(z - exact).max())
        estimates.append(estimate)
    assert np.log2(errors[0] / errors[1]) > tableau.order - 0.15
    assert np.log2(estimates[0] / estimates[1]) > tableau.order - 0.3


@pytest.mark.parametrize("tableau", [RODAS3, RODAS4], ids=["RODAS3", "RODAS4"])
def test_order_with_an_algebraic_equation(tableau: Tableau) -> None:
    """x' = u - x z with z + z^3/5 = x + cos u: states and algebraic variables, against an explicit integrator."""
    x, z, u = ca.SX.sym("x"), ca.SX.sym("z"), ca.SX.sym("u")
    x_new, z_new, error, slope, h = step(u - x * z, z + z**3 / 5 - x - ca.cos(u), x, z, u, tableau)
    run = ca.Function("step", [x, z, u, slope, h], [x_new, z_new, error])

    def algebraic(x: float, w: float) -> float:
        return brentq(lambda z: z + z**3 / 5 - x - np.cos(w), -5, 5, xtol=1e-15)

    def rate(t: float, x: np.ndarray) -> list[float]:
        w = 0.3 + 0.7 * t
        return [w - x[0] * algebraic(x[0], w)]

    exact = solve_ivp(rate, (0, 1), [1.0], method="DOP853", rtol=1e-13, atol=1e-13).y[0, -1]
    errors, estimates = [], []
    for count in (40, 80):
        at, estimate = (1.0, algebraic(1.0, 0.3)), 0.0
        for k in range(count):
            *at, e = map(float, run(*at, 0.3 + 0.7 * k / count, 0.7, 1 / count))
            estimate = max(estimate, abs(e))
        errors.append([abs(at[0] - exact), abs(at[1] - algebraic(exact, 1.0))])
        estimates.append(estimate)
    assert (np.log2(np.divide(*errors)) > tableau.order - 0.15).all()
    assert np.log2(estimates[0] / estimates[1]) > tableau.order - 0.3


@pytest.mark.parametrize("tableau", [RODAS3, RODAS4], ids=["RODAS3", "RODAS4"])
def test_a_step_much_longer_than_the_time_constant_lands_on_the_steady_state(tableau: Tableau) -> None:
    x, u = ca.SX.sym("x", 2), ca.SX.sym("u")
    run = compiled(ca.vertcat(-1e3 * (x[0] - u), x[0] - x[1]), x, u, tableau)
    far = [np.abs(run([7.0, -3.0], 2.0, 0.0, h)[0] - 2.0).max() for h in (1e6, 1e8)]
    assert far[1] < far[0] / 50  # what is left falls as 1/h
    assert far[1] < 1e-6


def test_a_step_of_no_length_changes_nothing() -> None:
    x, u = ca.SX.sym("x"), ca.SX.sym("u")
    z, error = compiled(u - x**3, x, u, RODAS3)(0.7, 2.0, 1.0, 0.0)
    assert z.tolist() == [0.7]
    assert error.tolist() == [0.0]
