"""One step of a Rosenbrock method as one expression: right-hand side, Jacobian, input slopes, elimination, all stages.

A one-step method has no restart cost, which is what co-simulation asks for: inputs change at every communication
point. The methods are L-stable, so a fast shaft beside slow temperatures costs accuracy, never stability.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

from ..model.core.eliminate import Factors
from .fixed import tables


@dataclass(frozen=True)
class Tableau:
    """Coefficients of a Rosenbrock method in the form that needs no product with the Jacobian.

    (M - h gamma J) U_i = h gamma (f(x + sum a_ij U_j, t + alpha_i h) + h d_i df/dt) + gamma M sum c_ij U_j,
    x_new = x + sum m_i U_i, error = sum e_i U_i (Hairer and Wanner 1996, sections IV.7 and VI.4). M is the identity,
    with zeros for algebraic equations.

    Attributes:
        order: order of the result; that of the error estimate's companion is one less
        gamma: diagonal coefficient
        a, c: lower triangles, row i for stage i
        alpha, d: stage times and factors of df/dt
        m, e: weights of the result and of the error
    """

    order: int
    gamma: float
    a: tuple[tuple[float, ...], ...]
    c: tuple[tuple[float, ...], ...]
    alpha: tuple[float, ...]
    d: tuple[float, ...]
    m: tuple[float, ...]
    e: tuple[float, ...]


def _read(name: str) -> Tableau:
    """The coefficients of a method in `rosenbrock.toml`."""

    def fixed(value: Any) -> Any:
        return tuple(map(fixed, value)) if isinstance(value, list) else value

    return Tableau(**{key: fixed(value) for key, value in tables("rosenbrock")[name].items()})


#: Four stages, order 3(2), for the short steps of an FMU.
RODAS3 = _read("RODAS3")
#: Six stages, order 4(3).
RODAS4 = _read("RODAS4")


def _combine(weights: tuple[float, ...], stages: list[Any]) -> Any:
    """Sum of the stages that have a weight, 0.0 when none has."""
    total: Any = 0.0
    for weight, stage in zip(weights, stages, strict=False):
        if weight:
            total = total + (stage if weight == 1 else weight * stage)
    return total


def step(ode: Any, residual: Any, x: Any, z: Any, u: Any, tableau: Tableau = RODAS3) -> tuple[Any, Any, Any, Any, Any]:
    """One step of size h of dx/dt = ode(x, z, u), 0 = residual(x, z, u) with inputs u + slope t.

    Args:
        ode: SX column (n); may hold further symbols, which stay constant within the step
        residual: SX column (k), solvable for z
        x, z: SX symbols of the states (n) and of the algebraic variables (k)
        u: SX symbols of the inputs at the step's beginning (m)
        tableau: coefficients of the method

    Returns:
        the new states (n) and algebraic variables (k), the error estimate of the states (n), and the symbols slope (m)
        and h (1) they are written in
    """
    n, k = x.shape[0], z.shape[0]
    slope, h = ca.SX.sym("slope", u.shape[0]), ca.SX.sym("h")
    gamma_h = tableau.gamma * h
    w, whole = ca.vertcat(x, z), ca.vertcat(ode, residual)
    jacobian = ca.jacobian(whole, w)
    # algebraic rows are divided by -gamma h, so that h alone scales the others
    factors = Factors(ca.vertcat(ca.horzcat(ca.SX.eye(n), ca.SX(n, k)) - gamma_h * jacobian[:n, :], jacobian[n:, :]))
    slopes = ca.jtimes(whole, u, slope)
    rates: dict[tuple[tuple[float, ...], float], Any] = {}
    stages: list[Any] = []
    for a, c, alpha, d in zip(tableau.a, tableau.c, tableau.alpha, tableau.d, strict=True):
        key = (a if any(a) else (), alpha)
        if key not in rates:
            moved = [w + _combine(a, stages), u + alpha * h * slope]
            rates[key] = ca.substitute([whole], [w, u], moved)[0] if any(a) or alpha else whole
        right = rates[key] + d * h * slopes
        past = _combine(c, stages)
        upper = gamma_h * right[:n, :] + (tableau.gamma * past[:n, :] if any(c) else 0.0)
        stages.append(factors.solve(ca.vertcat(upper, -right[n:, :])))
    w_new, error = w + _combine(tableau.m, stages), ca.densify(ca.SX(_combine(tableau.e, stages)))
    return w_new[:n, :], w_new[n:, :], error[:n, :], slope, h
