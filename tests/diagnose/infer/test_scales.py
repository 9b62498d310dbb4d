"""Scales of the scatter: those weighed by few columns are those of the whole covariance."""

import numpy as np
import pytest
from gearheat.tools.diagnose.infer import scales
from gearheat.tools.diagnose.infer.problem import Noise
from gearheat.tools.diagnose.model.entries import Term


def test_few_columns_weigh_scales_as_the_whole_covariance(monkeypatch) -> None:
    rng = np.random.default_rng(3)
    n = 60
    A = rng.standard_normal((n, n))
    A[:6] = 0.0  # readings whose only scatter is loose
    loose = (
        Term("readings", variance=np.where(np.arange(n) < 6, 0.5, 0.0), loose=0.25),
        Term("room", rng.standard_normal((n, 5)), loose=0.35),
        Term("days", rng.standard_normal((n, 4)), loose=0.35),
    )
    noise = Noise((Term("fixed", covariance=A @ A.T), *loose), np.zeros(3))
    residual, known = 2 * rng.standard_normal(n), np.zeros((n, n))
    few = noise.fitted(residual, known).scales
    monkeypatch.setattr(scales, "FEW", 0.0)
    assert few == pytest.approx(noise.fitted(residual, known).scales, abs=1e-4)
    assert np.abs(few).max() > 0.1
