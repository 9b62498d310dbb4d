"""Sets of terms are weighed as the integrals say, several things at once are found, a sampler finds the same.

With `GEARHEAT_HIDDEN=all` the measured planetary campaign is searched and sampled, too, with three seeds each.
"""

from __future__ import annotations

import os
from dataclasses import replace
from itertools import combinations
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from gearheat.scenarios.shipped import RIGS
from gearheat.tools.diagnose.infer import sets
from gearheat.tools.diagnose.infer.evidence import WIDTHS
from gearheat.tools.diagnose.infer.prior import Prior
from gearheat.tools.diagnose.infer.problem import Aside, Noise
from gearheat.tools.diagnose.infer.terms import ERRORS, SPREADS, Linear, Scatter, Term, TermSet
from gearheat.tools.diagnose.infer.weigh import Options, Weighing
from gearheat.tools.diagnose.model import entries
from gearheat.tools.diagnose.request import Request, read
from gearheat.tools.diagnose.setting import setting
from sampled_sets import gain, likely, shares
from scipy.special import logsumexp
from scipy.stats import multivariate_normal

M, CAUSES = 40, 12
CRITICAL = 2.0


def linear(residual: np.ndarray, more: list[Term], seed: int = 1, alike: bool = False) -> Linear:
    """Twelve causes with random effects on forty readings of noise one, and further terms."""
    rng = np.random.default_rng(seed)
    names = [f"cause{k}" for k in range(CAUSES)]
    prior = Prior(SimpleNamespace(id=n, family=n, common=1.0) for n in names)  # type: ignore[misc]
    formula: Any = SimpleNamespace()
    effects = effects_of(rng)
    own = [
        Term(n, "one" if alike else n, prior.share[n], effects[:, [k]], WIDTHS, -90.0, 90.0, SimpleNamespace(), formula)  # type: ignore[arg-type]
        for k, n in enumerate(names)
    ]
    gross = [t for t in more if t.aside is not None]
    scatters = [t for t in more if t.aside is None]

    noise = Noise((entries.Term("readings", variance=np.ones(M), loose=0.25),), np.zeros(1))
    return Linear([*own, *gross, *scatters], residual, np.zeros((M, M)), noise, prior, CRITICAL, 8)


def effects_of(rng: np.random.Generator) -> np.ndarray:
    """Effects (M, CAUSES)."""
    return np.asarray(rng.normal(size=(M, CAUSES)))


def noise(seed: int) -> np.ndarray:
    """Of readings (M,)."""
    return np.asarray(np.random.default_rng(seed).normal(size=M))


def named(problem: Linear, found: TermSet) -> set[str]:
    """What a set holds."""
    return {problem.terms[k].name for k in found.terms}


@pytest.mark.parametrize("sizes", [{}, {2: 3.0}, {0: 2.0, 5: -3.0}, {1: 2.0, 3: -2.0, 7: 2.5, 9: -3.0, 11: 2.0}])
def test_all_that_acts_is_found(sizes: dict[int, float]) -> None:
    effects = effects_of(np.random.default_rng(1))
    residual = noise(5) + sum((t * effects[:, k] for k, t in sizes.items()), np.zeros(M))
    problem = linear(residual, [])
    best = sets.search(problem, [Scatter((0.0,))], lambda share: None)[0]
    assert named(problem, best) == {f"cause{k}" for k in sizes}


def test_a_set_counts_as_much_as_its_integral() -> None:
    effects = effects_of(np.random.default_rng(1))
    residual = noise(6) + 1.2 * effects[:, 4] + 0.8 * effects[:, 8]
    problem = linear(residual, [])
    table = sets.Table(problem)
    white = sets.Whitened(table, Scatter((0.0,)))
    for own in [(), (4,), (8,), (4, 8)]:
        logs = []
        for widths in np.array(np.meshgrid(*[WIDTHS] * len(own))).reshape(len(own), -1).T if own else [np.zeros(0)]:
            G = effects[:, list(own)] * widths
            logs.append(
                multivariate_normal.logpdf(residual, np.zeros(M), np.eye(M) + G @ G.T) + M * np.log(2 * np.pi) / 2
            )
        exact = logsumexp(logs) - np.log(len(logs)) + table.log_prior(own)
        assert white.scored(own, [1.6] * len(own)).log == pytest.approx(exact, abs=0.15), own


def test_terms_of_one_family_are_one_answer() -> None:
    effects = effects_of(np.random.default_rng(1))
    residual = noise(5) + 3.0 * effects[:, 2] - 3.0 * effects[:, 7]
    problem = linear(residual, [], alike=True)
    assert all(len(s.terms) <= 1 for s in sets.search(problem, [Scatter((0.0,))], lambda share: None))


def test_a_gross_reading_is_no_cause_and_no_scatter() -> None:
    residual = noise(8)
    residual[17] += 12.0
    column = np.zeros((M, 1))
    column[17] = 1.0
    reading = Term("reading 17", "reading 17", np.log(0.002), column, ERRORS, aside=Aside(17))
    problem = linear(residual, [reading])
    best = sets.search(problem, [Scatter((0.0,))], lambda share: None)[0]
    assert named(problem, best) == {"reading 17"}
    assert abs(best.scatter.scales[0]) < 0.3


def test_a_walk_beside_its_own_scatter() -> None:
    """A walk is found where the scatter has grown to hold it, and the scatter is then what it is."""
    rng = np.random.default_rng(3)
    walk = np.tril(np.ones((M, M)))
    residual = rng.standard_normal(M) + 1.5 * walk @ rng.standard_normal(M)
    term = Term("cause0", "walk", np.log(0.05), walk, SPREADS, formula=SimpleNamespace(form=SimpleNamespace(name="")))  # type: ignore[arg-type]
    problem = linear(residual, [term])
    best = sets.search(problem, [Scatter((1.2,))], lambda share: None)[0]
    assert CAUSES in best.terms
    assert dict(best.scatter.beside)[CAUSES] in (1.0, 2.0)
    assert abs(best.scatter.scales[0]) < 0.5


def test_one_more_scatter_counts_as_where_it_whitens() -> None:
    """It is weighed by what a set leaves of products, never whitened anew."""
    walk, pairs, halves = np.tril(np.ones((M, M)))[:, ::4], np.kron(np.eye(10), np.ones((4, 1))), np.eye(M)[:, :10]
    problem = linear(noise(4), [Term(f"s{k}", f"s{k}", -3.0, C, SPREADS) for k, C in enumerate((walk, pairs, halves))])
    table = sets.Table(problem)
    white = sets.Whitened(table, Scatter((0.1,), ((CAUSES, 0.5),)))
    own = white.scored([3, 7], [0.8, 1.6])

    def density(scatter: Scatter) -> float:
        V = problem.covariance((0.1,), (*own.sized, *scatter.beside))
        return float(multivariate_normal.logpdf(problem.residual, np.zeros(M), V))

    others = [item for item in white.scatters(own, -np.inf) if len(item[1].beside) == 2 and item[2] == own]
    assert {k for _, scatter, _ in others for k, _ in scatter.beside} == {CAUSES, CAUSES + 1, CAUSES + 2}
    for log, scatter, _ in others:
        terms = sorted((3, 7, *(k for k, _ in scatter.beside)))
        prior = table.log_prior(terms) - table.log_prior(own.terms)
        assert log - own.log == pytest.approx(density(scatter) - density(own.scatter) + prior, abs=1e-9)


def test_scatters_are_added_as_long_as_sets_become_likelier() -> None:
    blocks = np.kron(np.eye(10), np.ones((4, 1)))
    problem = linear(
        noise(4) + 4.0 * blocks.sum(axis=1),
        [Term(f"s{k}", f"s{k}", -1.0, blocks[:, [k]], SPREADS) for k in range(10)],
    )
    best = sets.search(problem, [Scatter((0.0,))], lambda share: None)[0]
    assert best.terms == tuple(range(CAUSES, CAUSES + 10))


def test_no_better_set_of_two_is_missed() -> None:
    effects = effects_of(np.random.default_rng(1))
    residual = noise(9) + 1.0 * effects[:, 3] + 1.0 * effects[:, 6]
    problem = linear(residual, [])
    white = sets.Whitened(sets.Table(problem), Scatter((0.0,)))
    every = [white.scored(own, [1.6] * len(own)) for n in (0, 1, 2) for own in combinations(range(CAUSES), n)]
    found = [s for s in sets.search(problem, [Scatter((0.0,))], lambda share: None) if len(s.terms) <= 2]
    assert found[0].terms == max(every, key=lambda s: s.log).terms


@pytest.mark.parametrize("seed", [10, 12])
def test_a_walk_is_found_where_a_size_and_another_scatter_stand_in_for_it(seed: int) -> None:
    """It is tried beside none and in the place of what is there, not beside the likeliest set alone."""
    rng, ramp, pairs = np.random.default_rng(seed), np.linspace(0, 1, M)[:, None], np.kron(np.eye(20), np.ones((2, 1)))
    walk = np.tril(np.ones((M, M)))[:, ::2]
    residual = rng.standard_normal(M) + 1.5 * walk @ rng.standard_normal(20)
    named_so: Any = SimpleNamespace(form=SimpleNamespace(name=""))
    problem = linear(residual, [])
    trend = Term("cause0", "cause0", np.log(1 / 12), 6 * ramp, WIDTHS, -9.0, 9.0, SimpleNamespace(), named_so)  # type: ignore[arg-type]
    steps = Term("steps", "remainder", np.log(0.06), pairs, SPREADS)
    wander = Term("cause1", "walk", np.log(1 / 12), walk, SPREADS, formula=named_so)
    whole = replace(problem, terms=[trend, *problem.terms[1:], steps, wander])
    best = sets.search(whole, [Scatter((0.0,))], lambda share: None)[0]
    assert named(whole, best) == {"cause1"}


def test_a_cause_that_has_a_size_and_is_drawn_anew_counts_once() -> None:
    named_so: Any = SimpleNamespace(form=SimpleNamespace(name=""))
    share = np.log(1 / 12)
    anew = Term("cause3", "cause3, anew", share + np.log(0.5), np.eye(M), SPREADS, formula=named_so)
    table = sets.Table(linear(noise(3), [anew]))
    alone, both, other = (table.log_prior(own) for own in ((CAUSES,), (3, CAUSES), (4, CAUSES)))
    assert both == pytest.approx(alone)
    assert other < both - 3
    assert table.log_priors([CAUSES])[[3, 4]] == pytest.approx([both, other])
    assert table.log_priors([3])[CAUSES] == pytest.approx(both)


def test_a_sampler_weighs_one_more_scatter_by_its_density_too() -> None:
    """At each width: the share of the width is in the prior of the term, for both."""
    pairs, residual = np.kron(np.eye(20), np.ones((2, 1))), noise(4)
    log = [multivariate_normal.logpdf(residual, np.zeros(M), np.eye(M) + w**2 * pairs @ pairs.T) for w in (0, *SPREADS)]
    found = gain(Term("pairs", "pairs", -3.0, pairs, SPREADS), pairs, residual)
    assert found == pytest.approx(np.array(log[1:]) - log[0], abs=1e-9)


def test_what_acts_is_as_likely_as_a_sampler_says() -> None:
    effects = effects_of(np.random.default_rng(1))
    problem = linear(noise(9) + 2.0 * effects[:, 3] + 0.6 * effects[:, 6], [])
    found = likely(problem, sets.search(problem, [Scatter((0.0,))], lambda share: None))
    drawn = shares(problem, 1, 300)
    for name in found.keys() | drawn.keys():
        assert drawn.get(name, 0.0) == pytest.approx(found.get(name, 0.0), abs=0.12), (name, found, drawn)


@pytest.mark.skipif(
    os.environ.get("GEARHEAT_HIDDEN") != "all",
    reason="three searches of a measured campaign and three chains take minutes",
)
@pytest.mark.xfail(raises=AssertionError, strict=True, reason="one of three chains holds an oil probe's offset, too")
def test_search_and_sampler_name_the_same_in_the_measured_campaign() -> None:
    folder = RIGS / "planetary"
    inputs = read(Request("planetary", data=folder / "measured.csv", card=folder / "card.json"), {}, [])
    whole = setting(inputs.scenario, inputs.card, inputs.data, None, (), [])
    named = set()
    for seed in range(3):
        own = Weighing(whole.problem, whole.formulas, Options(seed=seed))
        own.run()
        near = own.leader().fit
        searched = own.search(near, own.screened(near, own.problem), "", 0.0)  # makes the linear problem of both
        found, drawn = likely(own.linear, searched), shares(own.linear, seed, 45)
        print(seed, {k: (round(found.get(k, 0.0), 2), round(drawn.get(k, 0.0), 2)) for k in found if found[k] > 0.3})
        named |= {frozenset(k for k, share in by.items() if share > 0.5) for by in (found, drawn)}
    assert len(named) == 1, named
    assert set(own.leader().causes) <= next(iter(named))
