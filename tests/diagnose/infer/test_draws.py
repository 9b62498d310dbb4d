"""Importance sampling finds what the Gaussian approximation of an evidence misses where a model bends."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from gearheat.tools.diagnose.infer import draws
from gearheat.tools.diagnose.infer.draws import correction
from gearheat.tools.diagnose.infer.evidence import WIDTHS
from gearheat.tools.diagnose.infer.fit import Fit
from gearheat.tools.diagnose.infer.problem import Acting
from scipy.optimize import minimize

#: Effects of one nuisance and of a size on five readings, and the size at which it saturates.
BY_Z, BY_T, MOST = np.array([1.0, 0.5, 0.0, 0.3, -0.2]), np.array([0.5, 1.0, 1.5, 1.0, 0.4]), 2.5
FORMULA: Any = SimpleNamespace(size=1, cause=SimpleNamespace(id="cause"), limits=(-50.0, 50.0))


class Bent:
    """Readings that are linear in a nuisance and saturate with a size."""

    nz = 1
    measured = np.array([0.6, 0.9, 1.5, 1.0, 0.4])

    def shown(self, z: np.ndarray, acting: tuple[Acting, ...]) -> np.ndarray:
        t = acting[0].t[0]
        return np.asarray(BY_Z * z[0] + BY_T * MOST * np.tanh(t / MOST))

    def cost(self, x: np.ndarray) -> float:
        e = self.measured - self.shown(x[:1], (Acting(FORMULA, x[1:]),))
        return float(0.5 * e @ e + 0.5 * x[0] ** 2 + 0.5 * (x[1] / WIDTHS[-1]) ** 2)


def test_the_correction_is_the_integral_over_the_approximation(monkeypatch: pytest.MonkeyPatch) -> None:
    problem: Any = Bent()
    x = minimize(problem.cost, np.array([0.0, 1.0])).x
    J = np.column_stack([BY_Z, BY_T / np.cosh(x[1] / MOST) ** 2])
    acting = (Acting(FORMULA, x[1:]),)
    look = SimpleNamespace(z=x[:1], acting=acting, shown=problem.shown(x[:1], acting), jacobian=J, x=x)
    fit = Fit(look, SimpleNamespace(covariance=np.eye(5)), 0.0, 0.0, 0.0)  # type: ignore[arg-type]
    # a far plateau, which no draw reaches, is left out
    z, t = np.linspace(-6, 6, 241), np.linspace(-3, 4.5, 1501)
    costs = np.array([[problem.cost(np.array([a, b])) for b in t] for a in z])
    exact = np.log(np.exp(problem.cost(x) - costs).sum() * (z[1] - z[0]) * (t[1] - t[0]))
    H = J.T @ J + np.diag([1.0, 1 / WIDTHS[-1] ** 2])
    missed = exact - (np.log(2 * np.pi) - 0.5 * np.linalg.slogdet(H)[1])
    assert missed > 0.06
    few = correction(problem, fit, seed=0)
    assert abs(few.log - missed) < 2 * few.error < 0.2
    monkeypatch.setattr(draws, "DRAWS", 4096)
    many = correction(problem, fit, seed=0)
    assert many.log == pytest.approx(missed, abs=0.03)
    assert many.error < 0.02
