"""What the search does beside its first order: causes far out, and others in place of one of a set."""

from __future__ import annotations

import numpy as np
import pytest
from gearheat.tools.diagnose.infer.fit import fitted
from gearheat.tools.diagnose.infer.found import Found
from gearheat.tools.diagnose.infer.problem import Acting
from gearheat.tools.diagnose.infer.weigh import Options, Weighing
from gearheat.tools.diagnose.setting import Setting


def test_far_out_an_effect_is_what_its_slope_says_and_its_bend(wrong: tuple[Setting, Found]) -> None:
    problem, formulas = wrong[1].problem, [f for f in wrong[1].formulas if f.cause.id == "cooling.air"]
    z, formula = np.zeros(problem.nz), formulas[0]
    slope = problem.tangents(z, (), [Acting(formula, np.zeros(formula.size))])[:, 0]
    (found,) = problem.bends(formulas)
    assert {np.sign(acting.t[0]) for acting, _ in found} == {-1.0, 1.0}
    for acting, bend in found:
        change = problem.shown(z, [acting]) - problem.shown(z)
        assert acting.t[0] * (slope + bend) == pytest.approx(change, abs=1e-9)
        assert np.abs(bend).max() > 0.01 * np.abs(slope).max()


def test_the_right_cause_takes_the_place_of_a_wrong_one_in_a_set(wrong: tuple[Setting, Found]) -> None:
    found, pair = wrong[1], ("cooling.air", "losses.churning")
    own = Weighing(found.problem, found.formulas, Options(critical=found.critical))
    own.ask_alarm()
    formulas = [next(f for f in own.formulas if f.cause.id == cause) for cause in pair]
    acting = [Acting(f, np.r_[0.2, np.zeros(f.size - 1)]) for f in formulas]
    fit = fitted(found.problem, acting, own.null.look.z)
    own._keep((frozenset(formulas), frozenset(), found.problem.aside), fit, (), {})
    assert own.leader().causes == pair
    own._exchange()
    assert "sensor.oil_temp.offset" in own.leader().causes and len(own.leader().causes) == 2
