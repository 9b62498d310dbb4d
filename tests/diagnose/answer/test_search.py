"""What the search does beside its first order: other causes in place of one of a set; what lasts of what is anew."""

from __future__ import annotations

import numpy as np
from gearheat.tools.diagnose.infer.fit import Begin, fitted
from gearheat.tools.diagnose.infer.found import Found
from gearheat.tools.diagnose.infer.prior import Prior
from gearheat.tools.diagnose.infer.problem import Acting
from gearheat.tools.diagnose.infer.terms import spreads
from gearheat.tools.diagnose.infer.weigh import Options, Weighing
from gearheat.tools.diagnose.setting import Setting


def test_the_right_cause_takes_the_place_of_a_wrong_one_in_a_set(wrong: tuple[Setting, Found]) -> None:
    found, pair = wrong[1], ("cooling.air", "losses.churning")
    own = Weighing(found.problem, found.formulas, Options(critical=found.critical))
    own.hypotheses.clear()  # a fit without a cause would lead the pair
    formulas = [next(f for f in own.formulas if f.cause.id == cause) for cause in pair]
    acting = [Acting(f, np.r_[0.2, np.zeros(f.size - 1)]) for f in formulas]
    fit = fitted(found.problem, acting, Begin(own.null.look.z))
    own._keep((frozenset(formulas), frozenset(), found.problem.aside), fit, (), {})
    assert own.leader().causes == pair
    own._exchange()
    assert "sensor.oil_temp.offset" in own.leader().causes and len(own.leader().causes) == 2


def test_what_lasts_of_errors_that_are_anew_in_each_test_is_their_mean(wrong: tuple[Setting, Found]) -> None:
    made, found = wrong
    formulas = [f for f in made.formulas if f.form.spread == "test" and not f.paced]
    terms = list(spreads(found.problem, found.null.look, formulas, Prior(f.cause for f in formulas)))
    assert "procedure.day_scatter" in {t.name for t in terms}
    for t in terms:
        effect, tests = t.columns.sum(axis=1, keepdims=True), found.problem.data.campaign.n_tests
        assert t.passing is not None and np.allclose(t.columns - t.passing, effect / tests)
