"""Evidence of sizes by Gaussian algebra is the integral over the sizes; priors of hypotheses add up."""

from __future__ import annotations

from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest
from gearheat.tools.diagnose.infer.evidence import WIDTHS, White, log_bayes_factor, log_bayes_factors
from gearheat.tools.diagnose.infer.prior import MORE, TWO, Prior
from scipy.integrate import quad
from scipy.stats import multivariate_normal, norm


def ratio(e: np.ndarray, g: np.ndarray, t: float) -> float:
    """Likelihood of a whitened residual with a size over that without."""
    return float(np.exp(g @ e * t - 0.5 * g @ g * t**2))


def integral(e: np.ndarray, g: np.ndarray, low: float, high: float) -> float:
    """Mean of that ratio over the prior of the size."""
    found = []
    for width in WIDTHS:
        prior = norm(scale=width)
        value, _ = quad(lambda t, own=prior: ratio(e, g, t) * own.pdf(t), low, high, limit=200)
        found.append(value / (prior.cdf(high) - prior.cdf(low)))
    return float(np.mean(found))


@pytest.mark.parametrize(("low", "high"), [(-20.0, 20.0), (0.0, 20.0), (-0.5, 0.8)])
@pytest.mark.parametrize("seed", range(3))
def test_evidence_of_one_size_is_the_integral_over_it(seed: int, low: float, high: float) -> None:
    rng = np.random.default_rng(seed)
    e, g = rng.normal(size=8), rng.normal(size=8)
    exact = np.log(integral(e, g, low, high))
    bounds = np.array([low]), np.array([high]), WIDTHS[:, None]
    assert log_bayes_factor(g[:, None], e, *bounds) == pytest.approx(exact, abs=1e-5)
    assert log_bayes_factors(np.array([g @ e]), np.array([g @ g]), *bounds)[0] == pytest.approx(exact, abs=1e-5)


@pytest.mark.parametrize("beyond", [3.0, 20.0, 60.0])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_evidence_of_a_size_at_either_bound_is_the_integral_up_to_it(sign: float, beyond: float) -> None:
    g, e, t = np.array([10.0, 0.0]), np.array([sign * beyond, 0.0]), np.linspace(-10.0, 1.0, 200_001)
    logs = -0.5 * (t / WIDTHS[:, None]) ** 2
    misfit = beyond * 10 * t - 50 * t**2
    exact = (np.logaddexp.reduce(logs + misfit, axis=1) - np.logaddexp.reduce(logs, axis=1)).tolist()
    low, high = sorted((-10.0 * sign, sign))
    bounds = np.array([low]), np.array([high]), WIDTHS[:, None]
    exact_mean = np.logaddexp.reduce(exact) - np.log(len(exact))
    assert log_bayes_factor(g[:, None], e, *bounds) == pytest.approx(exact_mean, abs=0.02)
    assert log_bayes_factors(np.array([g @ e]), np.array([g @ g]), *bounds)[0] == pytest.approx(exact_mean, abs=0.02)


def test_evidence_of_two_sizes_is_the_integral_over_both() -> None:
    rng = np.random.default_rng(5)
    e, G = rng.normal(size=6), rng.normal(size=(6, 2))
    t = np.linspace(-9, 9, 241)
    places = np.stack(np.meshgrid(t, t, indexing="ij"), axis=-1)
    likelihood = np.exp(places @ (G.T @ e) - 0.5 * np.einsum("abi,ij,abj->ab", places, G.T @ G, places))
    priors = [norm(scale=width).pdf(t) for width in WIDTHS]
    found = [(a @ likelihood @ b) * (t[1] - t[0]) ** 2 for a in priors for b in priors]
    bounds = np.full(2, -50.0), np.full(2, 50.0), np.column_stack([WIDTHS, WIDTHS])
    assert log_bayes_factor(G, e, *bounds) == pytest.approx(np.log(np.mean(found)), abs=1e-3)


def test_a_cause_that_is_not_there_costs_and_one_that_is_gains() -> None:
    g = np.full(20, 1.0)
    wide = np.array([-50.0]), np.array([50.0]), WIDTHS[:, None]
    assert log_bayes_factor(g[:, None], np.zeros(20), *wide) < -0.5
    assert log_bayes_factor(g[:, None], 2 * g, *wide) > 20


def test_whitening_gives_the_density_of_the_covariance() -> None:
    rng = np.random.default_rng(1)
    root = rng.normal(size=(5, 5))
    V, r = root @ root.T + np.eye(5), rng.normal(size=5)
    white = White.of(V)
    exact = multivariate_normal(cov=V).logpdf(r) + 2.5 * np.log(2 * np.pi)
    assert white.log_density(white(r)) == pytest.approx(exact)
    np.testing.assert_allclose(white.back(r), np.linalg.solve(V, r))


def test_priors_of_one_cause_add_up_and_classes_share_theirs() -> None:
    """Every pair counts in both orders; two members of a class together have the share of one cause."""
    made = [("a", "a", 1.0), ("b", "class", 1.0), ("c", "class", 0.5), ("d", "d", 2.0)]
    prior = Prior(SimpleNamespace(id=i, family=f, common=c) for i, f, c in made)
    names = [i for i, _, _ in made]
    share = {name: np.exp(prior([name])) for name in names}
    assert sum(share.values()) == pytest.approx(1.0)
    assert share["b"] + share["c"] == pytest.approx(share["a"])
    assert share["b"] == pytest.approx(2 * share["c"])
    assert share["d"] == pytest.approx(2 * share["a"])
    pairs = sum(np.exp(prior(pair)) for pair in combinations(names, 2))
    assert pairs == pytest.approx(TWO * (1 - sum(s**2 for s in share.values())))
    assert prior(names[:3]) - prior(names[:2]) == pytest.approx(np.log(3 * MORE * share["c"]))
