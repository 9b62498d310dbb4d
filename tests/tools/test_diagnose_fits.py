"""How `diagnose` fits causes: where a fit begins, when it begins again, and what its families and priors hold."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest
from gearheat.model.errors import SolveError
from gearheat.tools.diagnose import refine
from gearheat.tools.diagnose.card import Card
from gearheat.tools.diagnose.extension import of_machine
from gearheat.tools.diagnose.family import Family
from gearheat.tools.diagnose.fit import Fit, Mode
from gearheat.tools.diagnose.habit import HABIT, POWER
from gearheat.tools.diagnose.hypothesis import Hypothesis
from gearheat.tools.diagnose.nuisance import GROUPS, Parameters
from gearheat.tools.diagnose.problem import Linear, Problem
from gearheat.tools.diagnose.refine import PROMISED, Refiner
from gearheat.tools.diagnose.scatter import SCATTER
from gearheat.tools.diagnose.search import LIFT, OTHERS, Search
from gearheat.tools.diagnose.several import fitted_with_days
from gearheat.tools.diagnose.superset import buildable
from gearheat.tools.diagnose.weigh import regime_in_columns
from gearheat.tools.effects.forms import OPEN, THRESHOLDS, USUAL
from gearheat.tools.effects.parts import ExtraLoss
from gearheat.tools.effects.taxonomy import CAUSES

#: Readings of the made-up problems.
M = 12
AIR, DRAG = CAUSES["cooling.air"], CAUSES["losses.seal_drag"]


def linear(scatter: float = 1.0, causes=(), theta=None) -> Linear:
    """A linearisation with one nuisance."""
    noise, J = scatter * np.eye(M), np.ones((M, 1))
    residual = np.linspace(0.0, 1.0, M)
    return Linear(np.zeros(1), {}, residual, residual, noise + J @ J.T, J, noise, J, theta or {}, causes)


def fit_of(cause, cost: float, share: float = 0.5, size: float = 1.0) -> Fit:
    """A fit that ended in the middle of a cause's shapes."""
    shares = np.full(len(cause.shapes), share)
    theta = {cause.id: {**cause.forms(shares[None])[0], cause.size.name: size}}
    free = len(shares) - (cause.choice is not None)
    return Fit(np.zeros(1), theta, {cause.id: Mode(shares, np.eye(free))}, cost, {cause.id: size})


def family_of(cause, lengths, residual) -> Family:
    """Forms along the residual whose effects per unit of size are so long."""
    shares = np.linspace(0.2, 0.8, len(lengths))[:, None] * np.ones(len(cause.shapes))
    G = np.outer(residual / np.linalg.norm(residual), lengths)
    none = np.zeros(len(lengths))
    return Family(cause, cause.forms(shares), G, G, none, none, shares, none)


# ------------------------------------------------------------------------------------------------- beginning a fit


def test_a_fit_begins_without_the_scatter_of_what_a_form_leaves():
    null = linear()
    of_pair = Hypothesis((AIR.id, DRAG.id), 0.0, linear=linear(scatter=50.0, causes=(AIR,)))
    begun = Refiner(SimpleNamespace(), null, 0, lambda n: 0.0)._from(of_pair)
    assert begun.noise == pytest.approx(null.noise)
    assert begun.covariance == pytest.approx(null.noise + begun.jacobian @ begun.jacobian.T)
    assert begun.causes == (AIR,)


def test_a_fit_beside_days_that_differ_begins_with_their_scatter(monkeypatch):
    null, size = linear(), 0.1
    begun = []

    def refined(self, h):
        begun.append(self._from(h).noise)
        raise SolveError("seen enough")

    monkeypatch.setattr(Refiner, "refined", refined)
    h = Hypothesis((AIR.id, SCATTER), 0.0, {AIR.id: {}, SCATTER: {"sd": size}}, linear=linear(causes=(AIR,)))
    toy = Problem.__new__(Problem)
    toy.__dict__.update(rig=None, campaigns=[], card=None, parameters=None)
    monkeypatch.setattr(Problem, "__post_init__", lambda self: None)
    with pytest.raises(SolveError):
        fitted_with_days(SimpleNamespace(problem=toy, null=null, seed=0, prior=lambda n: 0.0), h)
    assert begun[0] == pytest.approx(null.noise + size**2 * null.days @ null.days.T)


@pytest.mark.parametrize(("after", "kept"), [(3.0, True), (39.5, False), (60.0, False)])
def test_a_fit_that_stalled_begins_again_where_a_form_promises_more_and_keeps_it(monkeypatch, after, kept):
    lin = replace(linear(), residual=4.0 * (-1.0) ** np.arange(M))
    near = {AIR.id: family_of(AIR, [0.01, 1.0], lin.residual)}
    problem = SimpleNamespace(put_back=lambda linear: [linear])
    started, stalled, again = [], fit_of(AIR, 40.0), fit_of(AIR, after)
    monkeypatch.setattr(Refiner, "_fitted", lambda self, h, start, z=None: started.append(start) or again)
    h = Hypothesis((AIR.id,), 0.0)
    found = Refiner(problem, linear(), 0, lambda n: 0.0)._better(h, stalled, lin, near)
    assert found is (again if kept else None)
    (start,) = started
    assert start[AIR.id][0] == pytest.approx(near[AIR.id].shares[1])


def test_a_fit_that_no_form_betters_is_left(monkeypatch):
    lin = linear()
    near = {AIR.id: family_of(AIR, [1.0, 1.01], np.ones(M))}
    problem = SimpleNamespace(put_back=lambda linear: [linear])
    monkeypatch.setattr(Refiner, "_fitted", lambda *a, **k: pytest.fail("nothing promises more"))
    refiner = Refiner(problem, lin, 0, lambda n: 0.0)
    assert refiner._better(Hypothesis((AIR.id,), 0.0), fit_of(AIR, 40.0), lin, near) is None
    assert PROMISED > refine.KEPT > 0


def hypotheses(*logs: float) -> list[Hypothesis]:
    names = [c for c in CAUSES if CAUSES[c].choice is None and not CAUSES[c].scatter]
    return [Hypothesis((name,), value) for name, value in zip(names, logs, strict=False)]


def fitted_by(lift: dict[str, float], *logs: float) -> list[str]:
    """Which hypotheses are fitted, where a fit lifts each by so much."""
    looked: list[str] = []

    def refined(h: Hypothesis) -> Hypothesis:
        looked.append(h.causes[0])
        return replace(h, log_posterior=h.log_posterior + lift.get(h.causes[0], 0.0))

    search = Search.__new__(Search)
    search.refiner, search.progress = SimpleNamespace(refined=refined), lambda stage, share: None
    search._again([Hypothesis((), -2000.0)], hypotheses(*logs), 8)
    return looked


def test_what_a_fit_lifted_the_first_by_it_may_lift_the_others_by():
    names = [h.causes[0] for h in hypotheses(0.0, 0.0, 0.0)]
    near, far = -10.0 - 0.9 * LIFT[False], -10.0 - 1.5 * LIFT[False]
    assert fitted_by({}, -10.0, near, far) == names[:2]
    loud = {names[0]: 300.0}  # a first look far off: the second and third are 300 behind what was fitted
    assert fitted_by(loud, -10.0, near, far) == names
    assert fitted_by(loud, -10.0, -10.0 - 1.1 * (OTHERS - 1) * 300.0) == names[:1]


# ------------------------------------------------------------------------------------------------- families and priors


def test_convection_changes_no_radiation_and_of_the_foundation_less_is_unknown():
    base = {"cooling.A": 0.5, "cooling.emissivity": 0.7, "foot.G": 9.0}
    card = Card(prior_sd={"hconv": 0.08, "rad": 0.05})
    parameters = Parameters(base, {n: Parameters.of(base, card, wide=False).sd[n] for n in ("convection", "radiation")})
    values = parameters.values(np.array([1.0, 0.0]))
    assert values["cooling.A"] == pytest.approx(0.5 * np.exp(0.08))
    assert values["cooling.A"] * values["cooling.emissivity"] == pytest.approx(0.35)
    radiating = parameters.values(np.array([0.0, 1.0]))
    assert radiating == pytest.approx({"cooling.A": 0.5, "cooling.emissivity": 0.7 * np.exp(0.05)})
    assert parameters.values(np.array([-9.0, 0.0]))["cooling.emissivity"] > 1.0  # over the area that convects
    assert Parameters.of(base, card, wide=False).sd["foundation"] == pytest.approx(0.04)


@pytest.mark.parametrize(("calibrated", "factor", "written"), [(1.2, -0.3, 0.7), (0.95, 0.1, 1.0), (0.8, 0.1, 0.88)])
def test_a_rig_file_holds_no_surface_that_radiates_more_than_a_black_one(calibrated, factor, written):
    base = buildable({"cooling.emissivity": calibrated, "cooling.A": 1.3})
    assert base["cooling.A"] == 1.3 and base["cooling.emissivity"] <= 1.0
    changed = of_machine(CAUSES["cooling.emissivity"], base, {"factor": factor}, {"cooling"})
    assert changed == pytest.approx({"cooling.emissivity": written})


def test_thin_films_set_in_below_a_speed_times_viscosity():
    starved = CAUSES["losses.film_starvation"]
    shares = np.full(len(starved.shapes), 0.5)
    shares[starved.choice] = 0.7
    (form,) = starved.forms(shares[None])
    theta = {**form, "P_ref": 80.0}
    name, threshold = starved.acts(theta)
    low, high = THRESHOLDS["film"]
    assert name == "film-" and threshold == pytest.approx((low + high) / 2)
    values = starved.values({}, theta, None)
    assert values["extra_starvation.film_on"] == threshold and "extra_starvation.film_side" not in values
    assert values["extra_starvation.T_on"] == OPEN["T_on"]
    assert regime_in_columns(starved, theta) == {"film_mm2_s2": (None, pytest.approx(1e6 * threshold))}


@pytest.mark.parametrize(("film", "weight"), [(0.2, 1.0), (1.0, 0.5), (5.0, 0.0)])
def test_a_loss_of_thin_films_fades_where_films_are_thick(film, weight):
    loss = ExtraLoss.__new__(ExtraLoss)
    values = OPEN | {"forward": 1.0, "backward": 1.0, "film_on": 1e-3}
    loss.__dict__.update(values)
    loss.__dict__["shaft"] = SimpleNamespace(w=20.0)
    loss.__dict__["reading"] = SimpleNamespace(w=20.0, tau=2000.0)
    loss.__dict__["lubricant"] = SimpleNamespace(T=340.0, nu=film * 1e-3 / 20.0)
    assert float(ca.DM(loss._regime())) == pytest.approx(weight, abs=0.01)


@pytest.mark.parametrize("cause", [c for c in CAUSES.values() if any(s.name == "width" for s in c.shapes)])
def test_a_threshold_is_as_gradual_as_the_form_says(cause):
    shares, seen = np.full(len(cause.shapes), 0.6), {}
    for share in np.linspace(0.01, 0.99, 99):
        shares[cause.choice] = share
        (form,) = cause.forms(shares[None])
        acts = cause.acts(form)
        quantity = acts[0][:-1] if acts else ""
        values = cause.values({}, {**form, cause.size.name: 1.0}, None).items()
        widths = {k.rpartition(".")[2]: v for k, v in values if k.endswith("_width")}
        for name, usual in USUAL.items():
            if f"{name}_width" in widths:
                gradual = form["width"] if name == quantity else 1.0
                assert widths[f"{name}_width"] == pytest.approx(usual * gradual)
        seen[acts[0] if acts else ""] = f"{quantity}_width" in widths
    assert len(seen) == len(cause.shapes[cause.choice].ends)
    assert {name for name, follows in seen.items() if follows} == {name for name in seen if name[:-1] in USUAL}
    assert not seen[""]


def test_thin_films_fall_with_speed_and_viscosity_alike_unless_they_set_in_at_a_threshold():
    starved = CAUSES["losses.film_starvation"]
    shares = np.full(len(starved.shapes), 0.5)
    for share, smooth in ((0.2, True), (0.7, False)):
        shares[starved.choice] = share
        (form,) = starved.forms(shares[None])
        values = starved.values({}, {**form, "P_ref": 80.0}, None)
        a, b = (values[f"extra_starvation.{name}"] for name in "ab")
        assert (a - b, b) == pytest.approx((form["a"], -form["p"] if smooth else 0.0))


def test_a_power_that_falls_with_speed_is_bounded_at_standstill():
    loss = ExtraLoss.__new__(ExtraLoss)
    loss.__dict__.update({"a": -1.3, "b": 0.0, "c": 0.0, "w_ref": 20.0, "nu_ref": 1e-4, "tau_ref": 2000.0})
    loss.__dict__["lubricant"] = SimpleNamespace(nu=1e-4)
    loss.__dict__["reading"] = SimpleNamespace(tau=2000.0)
    powers = []
    for w in (0.0, 10.0, 20.0):
        loss.__dict__["shaft"] = SimpleNamespace(w=w)
        powers.append(float(ca.DM(loss._form())))
    assert powers[1:] == pytest.approx([2**1.3, 1.0], rel=0.02)
    assert powers[0] < 50.0


def test_friction_in_thin_films_is_added_where_a_reference_tells_it():
    base = {path: 2.0 for group in GROUPS.values() for path in group.paths} | {POWER: 0.0}
    card = SimpleNamespace(prior=lambda key: 0.1)
    wide, stated = (Parameters.of(base, card, wide=w) for w in (True, False))
    z = np.array([1.0 if name == HABIT.id else 0.0 for name in wide.names])
    assert wide.values(z) == {**base, POWER: HABIT.size.sd}
    assert HABIT.id not in stated.names and POWER not in stated.values(np.zeros(len(stated.names)))


@pytest.mark.parametrize(("cost", "better"), [(10.0, True), (38.0, False)])
def test_a_pair_with_masses_is_begun_from_afar_where_that_promises_more(monkeypatch, cost, better):
    mass = CAUSES["thermal.mass"]
    near, tried = family_of(mass, [1.0], np.ones(M)), []
    alone = Hypothesis((AIR.id,), -50.0, {AIR.id: {}}, linear=linear(causes=(AIR,)))
    pair = Hypothesis((AIR.id, mass.id), -51.0, {mass.id: near.theta(0, 0.1)}, (near,), alone.linear)

    def fitted(self, h, start, z=None, steps=0):
        if h is alone:
            return fit_of(AIR, 40.0)
        tried.append(start[mass.id][1])
        return fit_of(mass, cost + (0.0 if tried[-1] > 0 else 5.0), size=tried[-1])

    monkeypatch.setattr(Refiner, "_fitted", fitted)
    found = Refiner(SimpleNamespace(), linear(), 0, lambda n: 0.0).from_afar(pair, alone)
    assert sorted(tried) == [-mass.size.far, mass.size.far]
    assert (found is pair) != better
    if better:
        assert found.log_posterior == pytest.approx(-50.0 + 40.0 - cost - refine.OCCAM)
        assert [start[mass.id][1] for start in found.also] == [mass.size.far]
