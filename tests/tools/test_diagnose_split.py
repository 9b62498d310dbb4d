"""The split certificate: uniform without a cause, small with one, and blind to a card's wrong scale."""

from __future__ import annotations

import numpy as np
import pytest
from gearheat.tools.diagnose.family import Family
from gearheat.tools.diagnose.split import false_shares, halves, split_p
from gearheat.tools.effects.taxonomy import CAUSES
from scipy.stats import binom, kstest

#: Tests, readings of each, readings of a reference; forms of each cause.
TESTS, EACH, REFERENCE, FORMS = 16, 8, 40, 12
IDS = ("losses.churning", "cooling.air", "sensor.torque.offset", "heat.external_source", "cooling.foundation")
DRAWS, LEVEL = 200, 0.05
N, DATA = REFERENCE + TESTS * EACH, np.arange(REFERENCE, REFERENCE + TESTS * EACH)
FIRST = np.repeat(np.arange(TESTS) % 2 == 0, EACH)
PARTS = (DATA[FIRST], DATA[~FIRST])


@pytest.fixture(scope="module")
def setting():
    """Causes with forms that resemble each other, and a covariance whose tolerances all readings share."""
    rng = np.random.default_rng(4)
    shared = rng.standard_normal((N, 6))
    found = {}
    for cause in (CAUSES[name] for name in IDS):
        forms = 0.8 * rng.standard_normal((N, 1)) + 0.4 * rng.standard_normal((N, FORMS))
        forms[:REFERENCE] = 0.0
        empty = np.zeros(FORMS)
        own = [{"form": float(k)} for k in range(FORMS)]
        found[cause.id] = Family(cause, own, forms / cause.size.sd, forms, empty, empty, empty[:, None], empty)
    return found, np.diag(rng.uniform(0.5, 2.0, N)) + 4.0 * shared @ shared.T


def drawn(covariance: np.ndarray, count: int) -> np.ndarray:
    return np.random.default_rng(7).standard_normal((count, N)) @ np.linalg.cholesky(covariance).T


@pytest.mark.parametrize("scale", [1.0, 3.0])
def test_without_a_cause_it_rejects_as_often_as_it_says(setting, scale):
    """Also when the readings scatter three times as much as the card says."""
    found, covariance = setting
    p = [split_p(scale * r, covariance, PARTS, found) for r in drawn(covariance, DRAWS)]
    low, high = binom.ppf([0.0005, 0.9995], DRAWS, LEVEL)
    for cause in IDS:
        rejected = sum(each[cause] <= LEVEL for each in p)
        assert low <= rejected <= high, (cause, rejected)
    # twice the smaller of two independent p has the distribution p - p^2/4 up to 1, where the rest of it lies
    below = np.array([each[IDS[1]] for each in p])
    assert kstest(below[below < 1], lambda v: (v - v**2 / 4) / 0.75).pvalue > 0.001


def test_a_cause_has_a_small_q_whose_form_is_found_and_direction_too(setting):
    found, covariance = setting
    f = found["cooling.air"]
    effect = f.signatures[:, 5] * f.cause.size.sd
    for k, r in enumerate(drawn(covariance, 5)):
        p = split_p(r + (3.0 if k % 2 else -3.0) * effect, covariance, PARTS, found)
        assert false_shares(p)["cooling.air"] < 0.001, k
        assert min(p, key=p.__getitem__) == "cooling.air"


def test_a_one_sided_cause_is_not_certified_by_the_opposite(setting):
    found, covariance = setting
    assert CAUSES["losses.churning"].size.low == 0.0
    f = found["losses.churning"]
    effect = f.signatures[:, 3] * f.cause.size.sd
    one = {"losses.churning": f}
    for r in drawn(covariance, 5):
        assert split_p(r - 3.0 * effect, covariance, PARTS, one)["losses.churning"] > 0.05
        assert split_p(r + 3.0 * effect, covariance, PARTS, one)["losses.churning"] < 0.001


def test_the_halves_are_balanced():
    rng = np.random.default_rng(1)
    rpm, tau = (v.ravel() for v in np.meshgrid([100.0, 150.0, 200.0, 250.0], [1500.0, 1900.0, 2300.0, 2700.0]))
    order = rng.permutation(len(rpm)).astype(float)
    first = halves(["A"] * len(rpm), rpm + rng.normal(0, 0.5, len(rpm)), tau, order)
    assert first.sum() == len(rpm) / 2
    for values in (rpm, tau):
        assert np.ptp(values[first]) >= 0.66 * np.ptp(values) and np.ptp(values[~first]) >= 0.66 * np.ptp(values)
    for speed in set(rpm):
        assert first[rpm == speed].sum() == 2
    repeated = halves(["A", "A", "B"], np.array([100.0, 100.4, 100.0]), np.full(3, 1500.0), np.array([3.0, 1.0, 2.0]))
    assert repeated.tolist() == [False, True, False]


def test_false_shares_are_those_of_benjamini_and_hochberg():
    q = false_shares({"a": 0.01, "b": 0.02, "c": 0.03, "d": 0.5})
    assert q == pytest.approx({"a": 0.04, "b": 0.04, "c": 0.04, "d": 0.5})
    assert false_shares({"a": 0.9, "b": 0.001})["b"] == pytest.approx(0.002)
