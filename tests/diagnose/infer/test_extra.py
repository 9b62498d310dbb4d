"""A spread beside a hypothesis: what it explains is no scatter."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
from gearheat.tools.diagnose.infer import extra
from gearheat.tools.diagnose.infer.evidence import White
from gearheat.tools.diagnose.infer.fit import View
from gearheat.tools.diagnose.infer.problem import Noise
from gearheat.tools.diagnose.model.noise import Term, walk

M = 24


def of_a_hypothesis(residual: np.ndarray) -> SimpleNamespace:
    """A fit of nothing, whose scatter has grown to the residual."""
    term = Term("repeat", variance=np.ones(M), loose=0.25)
    noise = Noise((term,), np.zeros(1)).fitted(residual, 1e-6 * np.eye(M))
    views = []
    for scales in (noise.scales, np.zeros(1)):
        white = White.of(Noise((term,), scales).covariance + 1e-6 * np.eye(M))
        views.append(View(white, white(residual)))
    return SimpleNamespace(noise=noise, views=lambda _: views, look=SimpleNamespace(z=np.zeros(0), acting=()))


def test_a_walk_beside_its_own_scatter() -> None:
    """A walk that the scatter had swallowed is far likelier with the scatter that is left."""
    rng = np.random.default_rng(3)
    own = walk(np.ones(M), np.arange(M))
    residual = rng.standard_normal(M) + 1.5 * own @ rng.standard_normal(own.shape[1])
    fit = of_a_hypothesis(residual)
    assert fit.noise.scales[0] > 0.5
    V = fit.views(None)[0].white.L @ fit.views(None)[0].white.L.T
    C = own @ own.T
    seen = np.array([extra._log(V + s**2 * C, residual) for s in extra.SIZES])
    found, noise = extra._anew(fit, V, residual, C, extra.SIZES[int(np.argmax(seen))])
    assert abs(noise.scales[0]) < 0.3
    assert found.max() > seen.max() + 5
    best = extra.SIZES[int(np.argmax(found))]
    assert best in (1.0, 2.0)
    truth = extra._log((1 + 1e-6) * np.eye(M) + best**2 * C, residual) - fit.noise.log_prior
    assert truth <= found.max() < truth + 3
