"""Effects that bend: what slopes promise beyond a stalled fit counts for nothing, and they are not the effect."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from gearheat.tools.diagnose.infer import fit
from gearheat.tools.diagnose.infer.evidence import WIDTHS
from gearheat.tools.diagnose.infer.fit import _Line
from gearheat.tools.diagnose.infer.problem import Acting

#: Effects of one nuisance and of a size on five readings; the size at which its effect turns back.
BY_Z, BY_T, TURNS = np.array([1.0, 0.5, 0.0, 0.3, -0.2]), np.array([0.5, 1.0, 1.5, 1.0, 0.4]), 1.5
FORMULA: Any = SimpleNamespace(size=1, cause=SimpleNamespace(id="cause"), limits=(-50.0, 50.0), paths=("",))
NOISE: Any = SimpleNamespace(covariance=np.eye(5), log_prior=0.0)


class Turning:
    """Readings that fall again behind a size, and never get as far as they are measured."""

    nz, m, own, data = 1, 5, slice(0, 5), SimpleNamespace(m=5, limits=np.array([[-6.0], [6.0]]))
    alike, same, near = np.ones((5, 5)), np.eye(5), np.ones(1)
    measured = 4.0 * BY_T

    def shown(self, look: Any, acting: tuple[Acting, ...]) -> np.ndarray:
        t = acting[0].t[0] if acting else 0.0
        return np.asarray(BY_Z * look.z[0] + BY_T * t * np.exp(-0.5 * (t / TURNS) ** 2))

    def cost(self, x: np.ndarray) -> float:
        e = self.measured - self.shown(SimpleNamespace(z=x[:1]), (Acting(FORMULA, x[1:]),))
        return float(0.5 * e @ e + 0.5 * x[0] ** 2 + 0.5 * (x[1] / WIDTHS[-1]) ** 2)


def stalled(problem: Any) -> fit.Fit:
    x = np.array([0.0, 0.9 * TURNS])
    acting = (Acting(FORMULA, x[1:]),)
    slope = (1 - (x[1] / TURNS) ** 2) * np.exp(-0.5 * (x[1] / TURNS) ** 2)
    J = np.column_stack([BY_Z, BY_T * slope])
    look = SimpleNamespace(z=x[:1], acting=acting, jacobian=J, x=x, by_sd=J, sd=np.ones(1))
    look.shown = problem.shown(look, acting)
    return _Line(problem, look).weighed(NOISE)  # type: ignore[arg-type]


def test_evidence_lacks_what_the_slopes_promise(monkeypatch: pytest.MonkeyPatch) -> None:
    problem: Any = Turning()
    found = stalled(problem)
    J, x = found.look.jacobian, found.look.x
    precision = np.array([1.0, 1 / WIDTHS[-1] ** 2])
    r = problem.measured - found.look.shown + J @ x
    best = np.linalg.solve(J.T @ J + np.diag(precision), J.T @ r)
    least = 0.5 * ((r - J @ best) ** 2).sum() + 0.5 * precision @ best**2
    monkeypatch.setattr(fit, "STALLED", np.inf)
    short = stalled(problem).evidence - found.evidence
    assert short == pytest.approx(problem.cost(x) - least) and short > 3


def test_what_a_cause_does_is_no_slope_times_its_size() -> None:
    problem: Any = Turning()
    found = stalled(problem)
    alone = problem.shown(found.look, found.look.acting) - problem.shown(found.look, ())
    assert found.effects == pytest.approx(alone[:, None])
    slope = found.look.jacobian[:, 1] * found.look.x[1]
    assert np.linalg.norm(slope) < 0.5 * np.linalg.norm(alone)
