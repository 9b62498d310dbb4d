"""Decision, sizes, gain, predictions and experiments of a small search."""

from __future__ import annotations

from copy import copy
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from gearheat.model.errors import SolveError
from gearheat.scenarios.load import load
from gearheat.scenarios.measured.card import Card
from gearheat.scenarios.measured.table import Campaign
from gearheat.tools.diagnose.answer import compose, estimate, gain
from gearheat.tools.diagnose.answer.decide import POWER, Chance, decide, invisible, p_adequacy, temper
from gearheat.tools.diagnose.answer.design import Design, Effects, find_alike, rank, simulate_design
from gearheat.tools.diagnose.answer.experiments import build_tests, list_experiments, planned_campaign
from gearheat.tools.diagnose.answer.findings import APART, UNEXPLAINED
from gearheat.tools.diagnose.answer.pictures import pictures
from gearheat.tools.diagnose.answer.predict import simulate
from gearheat.tools.diagnose.answer.quality import adequacy, average_residuals, distances, gross_readings, scatters
from gearheat.tools.diagnose.infer.fit import Begin, Vector, fitted
from gearheat.tools.diagnose.infer.found import Found
from gearheat.tools.diagnose.infer.problem import Acting, Aside, Problem
from gearheat.tools.diagnose.infer.weigh import Options, weigh
from gearheat.tools.diagnose.model.noise import terms
from gearheat.tools.diagnose.report import extension, phrases
from gearheat.tools.diagnose.setting import Setting, setting

from .conftest import noisy

TRUE = "sensor.oil_temp.offset"
#: What may be wrong, and by how much the oil thermometer is, as the fixtures have it [K].
CAUSES = (TRUE, "cooling.air", "losses.churning", "sensor.oil_temp.drift")
OFFSET = 3.0


def test_tempered_probabilities_keep_their_order_and_that_of_nothing(wrong: tuple[Setting, Found]) -> None:
    found = wrong[1]
    tempered = temper(found)
    before, after = decide(found), decide(tempered)
    assert [j.causes for j in before.joints if j.causes] == [j.causes for j in after.joints if j.causes]
    assert tempered.probabilities.sum() == pytest.approx(1.0)
    assert after.joints[0].chance.probability < before.joints[0].chance.probability
    assert list(tempered.probabilities) == sorted(tempered.probabilities, reverse=True)
    kept = [f.probabilities[[not h.causes and not h.extras for h in f.hypotheses]] for f in (found, tempered)]
    assert kept[1] == pytest.approx(kept[0])


def test_a_cause_that_the_design_cannot_show_leads_no_answer(wrong: tuple[Setting, Found]) -> None:
    found = wrong[1]
    assert invisible(found) == set()
    own = np.array([c.id == TRUE for c in found.first.candidates])
    faint = replace(found.first, white=np.where(own, 1e-3, 1.0) * found.first.white)
    hidden = replace(found, first=faint)
    assert invisible(hidden) == {TRUE}
    assert any(TRUE in h.causes for h in found.hypotheses)
    decision = decide(temper(hidden))
    assert TRUE not in decision.members
    assert sum(j.chance.probability for j in decision.joints) == pytest.approx(1.0)


def test_a_power_of_the_likelihood_ratio_keeps_the_prior(wrong: tuple[Setting, Found]) -> None:
    """Answers as likely as their priors stay so; evidence counts to a power, whole where nothing is likely."""
    found = wrong[1]
    nothing = next(h for h in found.hypotheses if not h.causes and not h.extras)
    (one, other), prior = [next(h for h in found.hypotheses if h.causes == (c,)) for c in CAUSES[:2]], found.prior
    for ratio, none, power in ((0.0, -999.0, POWER), (5.0, -999.0, POWER), (5.0, 30.0, 1.0)):
        hypotheses = tuple(
            replace(h, log_joint=prior(h.causes) + value) for h, value in ((one, ratio), (other, 0.0), (nothing, none))
        )
        tempered = temper(replace(found, hypotheses=hypotheses))
        p = {h.causes: p for h, p in zip(tempered.hypotheses, tempered.probabilities, strict=True)}
        expected = prior(one.causes) - prior(other.causes) + power * ratio
        assert np.log(p[one.causes] / p[other.causes]) == pytest.approx(expected)
        assert sum(p.values()) == pytest.approx(1.0)


def test_other_data_change_the_odds_by_what_they_say(wrong: tuple[Setting, Found]) -> None:
    found = wrong[1]
    told = found.beside(lambda causes: 2.0 if "cooling.air" in causes else 0.0)
    more = np.array(["cooling.air" in h.causes for h in found.hypotheses])
    expected = found.probabilities * np.where(more, np.exp(2.0), 1.0)
    order = np.argsort(-expected, kind="stable")
    assert told.probabilities == pytest.approx((expected / expected.sum())[order])
    logs = [(h.log_joint, found.hypotheses[k].log_joint) for h, k in zip(told.hypotheses, order, strict=True)]
    assert np.subtract(*np.transpose(logs)) == pytest.approx(2.0 * more[order])


def test_one_gross_reading_is_found_and_sound_ones_beside_it_stay(clean: tuple[Setting, Found]) -> None:
    sound = clean[1].problem
    oil, row = next(s for s in sound.data.read if s.kind == "oil_temp"), 5
    values = {**sound.data.campaign.values}
    values[oil.name] = values[oil.name] + 20 * oil.repeat_sd * (np.arange(sound.data.campaign.n) == row)
    data = replace(sound.data.campaign, values=values)
    problem = Problem([sound.data.another(data)], sound.day_sd)
    bad = Aside(int(np.flatnonzero((problem.data.row == row) & (problem.data.kind == 0))[0]))
    found = weigh(problem, clean[1].formulas)
    assert found.problem.aside == {bad}
    assert decide(found).verdict == "consistent"
    ((_, size_sd, error),) = distances(found.problem, found.null)
    assert size_sd == pytest.approx(20, rel=0.3)
    assert error == pytest.approx(20 * oil.repeat_sd, rel=0.3)


def test_what_others_say_of_a_gross_reading_holds_the_zero_of_its_instrument(clean: tuple[Setting, Found]) -> None:
    """A thermometer of a wide tolerance that reads 4 K too high, and once 4 K less."""
    sound, row = clean[1].problem, 5
    sensors = tuple(replace(s, offset_sd=3.0) if s.kind == "oil_temp" else s for s in sound.data.campaign.sensors)
    oil = next(s for s in sensors if s.kind == "oil_temp")
    values = {**sound.data.campaign.values}
    values[oil.name] = values[oil.name] + 4.0 * (np.arange(sound.data.campaign.n) != row)
    data = replace(sound.data.campaign, sensors=sensors, values=values)
    problem = Problem([sound.data.another(data)], sound.day_sd)
    bad = Aside(int(np.flatnonzero((problem.data.row == row) & (problem.data.kind == 0))[0]))
    problem = problem.without(frozenset({bad}))
    h = SimpleNamespace(fit=fitted(problem, (), Begin(np.zeros(problem.nz))))
    (one,) = gross_readings(replace(clean[1], problem=problem), h)  # type: ignore[arg-type]
    assert one.channel == oil.name and one.shown is not None
    assert one.expected == pytest.approx(one.shown + 4.0, abs=1.2)


def test_a_wrong_speed_is_among_the_given_readings_of_its_row_that_explain_it(clean: tuple[Setting, Found]) -> None:
    sound = clean[1].problem
    campaign = sound.data.campaign
    speed, row = next(s.name for s in sound.data.given if s.kind == "speed"), 5
    values = {**campaign.values, speed: campaign.values[speed] * np.where(np.arange(campaign.n) == row, 1.25, 1.0)}
    found = weigh(Problem([sound.data.another(replace(campaign, values=values))], sound.day_sd), clean[1].formulas)
    (one,) = gross_readings(found, decide(found).leader)
    assert one.row == row + 1 and speed in (one.channel, *one.instead)
    assert not one.instead or f"A wrong {one.instead[0]}" in phrases.gross(one)


def test_the_cause_is_named_and_all_agrees(wrong: tuple[Setting, Found]) -> None:
    decision = decide(wrong[1])
    assert decision.verdict in ("explained", "ambiguous")
    assert decision.answers[0].causes == (TRUE,)
    assert decision.p_any < 0.05
    assert sum(j.chance.probability for j in decision.joints) == pytest.approx(1.0)
    assert decision.marginal[TRUE].probability >= decision.answers[0].chance.probability - 1e-9
    assert 0.0 <= decision.marginal[TRUE].mc_error < 0.5


def test_a_cause_is_the_answer_whether_or_not_another_acts_beside_it(wrong: tuple[Setting, Found]) -> None:
    found = wrong[1]
    both = next(h for h in found.hypotheses if len(h.causes) == 2 and TRUE in h.causes)
    alone = next(h for h in found.hypotheses if h.causes == (TRUE,))
    share = [0.6 * (h is alone) + 0.35 * (h is both) + 0.05 * (not h.causes and not h.extras) for h in found.hypotheses]
    decision = decide(replace(found, probabilities=np.array(share)))
    assert decision.verdict == "explained"
    assert [a.causes for a in decision.answers] == [(TRUE,)]
    assert decision.answers[0].chance.probability == pytest.approx(0.95)
    assert decision.joints[0].chance.probability == pytest.approx(0.6)


def test_what_acts_beside_a_cause_is_no_other_name_for_it(wrong: tuple[Setting, Found]) -> None:
    found, other = wrong[1], "sensor.oil_temp.drift"
    one_class = {c: SimpleNamespace(id=c, family="error") for c in (TRUE, other)}
    formulas = [SimpleNamespace(cause=one_class.get(f.cause.id, f.cause)) for f in found.formulas]
    first, *rest = found.hypotheses
    hypotheses = (
        replace(first, causes=(TRUE, other)),
        *(replace(h, causes=(other, TRUE)) for h in rest[:1]),
        *rest[1:],
    )
    share = [0.5, 0.4, *(0.1 * (not h.causes and not h.extras) for h in rest[1:])]
    told = replace(found, formulas=formulas, hypotheses=hypotheses, probabilities=np.array(share))
    assert decide(told).joints[0].classes == ((TRUE,), (other,))


def test_clean_data_are_consistent(clean: tuple[Setting, Found]) -> None:
    decision = decide(clean[1])
    assert decision.verdict == "consistent"
    assert not decision.answers
    assert 0.05 < decision.p_any <= clean[1].p_any
    assert decision.leader.causes == ()
    assert decision.p_adequacy is not None and 0.001 < decision.p_adequacy < 0.999


@pytest.mark.parametrize("name", ["wrong", "clean"])
def test_the_alarm_is_an_alarm_if_and_only_if_nothing_has_less_than_half(
    name: str, request: pytest.FixtureRequest
) -> None:
    found: Found = request.getfixturevalue(name)[1]
    decision = decide(found)
    nothing = next(j.chance.probability for j in decision.joints if not j.causes)
    assert (nothing < 0.5) == (decision.p_any < 0.05) == (decision.verdict != "consistent")


def test_size_and_impact(wrong: tuple[Setting, Found]) -> None:
    found = wrong[1]
    decision = decide(found)
    size = estimate.estimate_cause(found, TRUE, decision.members[TRUE])[0]
    assert size.ci95[0] < OFFSET < size.ci95[1]
    assert abs(size.value - OFFSET) < 1.0
    changed = estimate.impacts(found.problem, decision.leader, wrong[0].nominal.ratios)
    oil = next(s.name for s in found.problem.data.read if s.kind == "oil_temp")
    assert changed[f"{oil}_K"].value == pytest.approx(size.value, rel=0.2)


def test_an_instrument_has_its_own_size_and_what_it_seems_to_lose_is_apparent(wrong, monkeypatch) -> None:
    found = wrong[1]
    decision = decide(found)
    one = decision.leader.fit.look.acting[0].formula
    monkeypatch.setattr(estimate, "loss_means", lambda o, ratios: (np.ones(o.m), np.zeros(0)))
    known = estimate.estimate_cause(found, TRUE, decision.members[TRUE])[0]
    assert estimate.impacts(found.problem, decision.leader, {})["loss_Nm"].what == "loss"
    monkeypatch.setattr(one, "form", replace(one.form, scale=0.2))
    monkeypatch.setattr(Campaign, "sensor", lambda o, name: SimpleNamespace(kind="torque"))
    told = estimate.estimate_cause(found, TRUE, decision.members[TRUE])[0]
    assert (told.value, *told.ci95) == pytest.approx([0.2 * v for v in (known.value, *known.ci95)], rel=1e-5)
    assert estimate.impacts(found.problem, decision.leader, {})["loss_Nm"].what == "apparent loss"


def test_the_loss_follows_the_torque_at_the_other_end(wrong: tuple[Setting, Found]) -> None:
    """Ratio 4, one row each way: the torque out falls by 1 where the machine drives, rises where it is driven."""
    assert estimate.loss_means(wrong[1].problem.data, {"input": 1.0}) is None
    speed, out = (
        SimpleNamespace(name=name, kind=kind, reads=reads)
        for name, kind, reads in (("n", "speed", "low.w"), ("T", "torque", "high.tau"))
    )
    o = SimpleNamespace(
        m=2,
        read=[out],
        kind=np.zeros(2, dtype=int),
        row=np.arange(2),
        signs={"n": np.ones(2), "T": np.array([-1.0, 1.0])},
        sensors={"n": np.array([10.0, 10.0])},
        campaign=SimpleNamespace(sensors=[speed, out]),
    )
    torque, power = estimate.loss_means(o, {"low": 1.0, "high": 4.0})
    change = np.array([-1.0, 1.0])
    assert (torque @ change, power @ change) == pytest.approx((4.0, 40.0))


def test_a_size_that_was_found_is_detectable(wrong: tuple[Setting, Found]) -> None:
    smallest = estimate.find_detectable(wrong[1])
    assert 0.0 < smallest[TRUE] < OFFSET


def test_scatter_and_adequacy(clean: tuple[Setting, Found]) -> None:
    _, found = clean
    leader = decide(found).leader
    for term in scatters(found, leader):
        assert term.ci95[0] < term.card < term.ci95[1], term
    assert all(0.001 < p < 0.9999 for p in adequacy(found, leader).values())


def test_folds_hold_as_many_causes_as_the_answer_may(wrong, monkeypatch) -> None:
    asked = []

    def foreseen(found, held, options):
        asked.append(options)
        raise SolveError("none")

    monkeypatch.setattr(gain, "foresee", foreseen)
    assert gain.measure_gains(wrong[1], Options(seed=1, most=2)) == []
    assert asked and {one.most for one in asked} == {2}


def test_gain_is_the_cause_s(wrong: tuple[Setting, Found]) -> None:
    told = gain.measure_gains(wrong[1], Options(seed=1))
    oil = next(s.name for s in wrong[1].problem.data.read if s.kind == "oil_temp")
    one = next(g for g in told if g.channel == oil)
    assert one.n == wrong[1].problem.data.campaign.n
    assert one.chosen.get(TRUE, 0) >= one.folds - 1
    assert one.rmse_after < one.rmse_before
    assert one.ratio_ci90[0] <= one.rmse_after / one.rmse_before <= one.ratio_ci90[1]
    assert set(one.rivals) == {"constant cooling", "linear in the given sensors"}


def test_predictions_of_the_data_are_nearer_with_the_cause(wrong: tuple[Setting, Found]) -> None:
    _, found = wrong
    campaign = found.problem.data.campaign
    nominal, extended = simulate(found, campaign)
    i = next(i for i, s in enumerate(found.problem.data.read) if s.kind == "oil_temp")
    measured = campaign.values[found.problem.data.read[i].name]
    left = [float(np.sqrt(np.mean((table[i] - measured) ** 2))) for table in (nominal, extended)]
    assert left[1] < left[0]
    assert left[1] < 3 * found.problem.data.read[i].repeat_sd


def test_points_that_are_foreseen_change_no_scatter_of_the_data(clean: tuple[Setting, Found]) -> None:
    problem, look = clean[1].problem, clean[1].null.look
    noise = problem.noise(look)
    alone = {t.name: noise.scaled([t]) for t in terms(problem.campaigns, look.seen, problem.day_sd, look.sd)}
    campaign = problem.data.campaign
    speed = next(s.name for s in campaign.given if s.kind == "speed")
    fast = replace(campaign, values={**campaign.values, speed: 1.2 * campaign.values[speed]})
    points = problem.data.another(fast)
    seen = points.at(np.append(look.z, 0.0), [])
    joint = terms([*problem.campaigns, points], [*look.seen, seen], problem.day_sd, look.sd, points=1)
    assert [t.name for t in joint] == list(alone)
    for term in joint:
        np.testing.assert_allclose(noise.scaled([term])[: problem.m, : problem.m], alone[term.name], atol=1e-12)


def designed(found: Found, setting: Setting) -> Design:
    """The campaign of a search with all experiments behind it."""
    tried = list_experiments(found.problem.data.campaign, setting.nominal.value)
    return simulate_design(found.problem, found.null.look, found.null.noise, found.first, CAUSES, tried)


def test_effects_are_as_uncertain_as_all_that_moves_them(wrong: tuple[Setting, Found]) -> None:
    """The nuisances, too: less air cools less, by how much hangs on what the air takes."""
    found = wrong[1]
    problem, h = found.problem, next(h for h in found.hypotheses if h.causes == ("cooling.air",))
    look, vector = h.fit.look, Vector(found.problem, h.fit.look)

    def change(x: np.ndarray) -> np.ndarray:
        z, acting = vector.split(x)
        without = [replace(one, t=np.r_[0.0, one.t[1:]]) for one in acting]
        here = replace(look, z=z)
        return problem.shown(here, acting) - problem.shown(here, without)

    steps = 1e-4 * np.eye(len(look.x))
    by_hand = np.array([(change(look.x + step) - change(look.x - step)) / 2e-4 for step in steps])
    oil = next(k for k, s in enumerate(problem.data.read) if s.kind == "oil_temp")
    slope = by_hand[:, problem.data.kind == oil].mean(axis=1)
    sd = float(np.sqrt(slope @ estimate.posterior(problem, h.fit) @ slope))
    told = estimate.impacts(problem, h, {})["T_oil_K"]
    assert (told.ci95[1] - told.ci95[0]) / (2 * 1.96) == pytest.approx(sd, rel=0.02)
    assert abs(slope[: problem.nz]).max() > 0.05 * abs(slope).max()


def test_a_picture_leaves_out_what_a_reference_tells_of_the_rig() -> None:
    """Thermometers of both campaigns err by a course of the speed that is no cause."""
    scenario, card = load("helical_two_stage"), Card()
    plan = planned_campaign(scenario, card, None)
    speed, oil = (next(s.name for s in plan.sensors if s.kind == kind) for kind in ("speed", "oil_temp"))
    course = 2.0 * np.sin(6.0 * plan.values[speed] / plan.values[speed].max())
    data, reference = (noisy(plan, offset, seed) for offset, seed in ((OFFSET, 3), (0.0, 4)))
    both = [replace(c, values=c.values | {oil: c.values[oil] + course}) for c in (data, reference)]
    made = setting(scenario, card, *both)
    found = weigh(made.problem, [f for f in made.formulas if f.cause.id in CAUSES and f.form.name == ""])
    leader = next(h for h in found.hypotheses if h.causes == (TRUE,))
    (one,) = pictures(found, leader, ["order"])
    own = made.problem.data.kind == next(k for k, s in enumerate(made.problem.data.read) if s.name == oil)
    plain = (made.problem.measured - leader.fit.look.shown)[made.problem.own][own]
    assert one.channel == oil and np.mean(one.before) == pytest.approx(OFFSET, abs=0.7)
    assert np.std(one.after) < 0.7 * np.std(plain), (np.std(one.after), np.std(plain))


def test_experiments_never_bring_causes_nearer(wrong: tuple[Setting, Found]) -> None:
    setting, found = wrong
    made = designed(found, setting)
    now = made.distances()
    assert {e.id for e in made.experiments} >= {"repeat", "bath", "cold_room"}
    for e in made.experiments:
        after = made.distances(e.id)
        assert all(after[p] >= now[p] - 1e-6 for p in now), e.id
    best = rank(made, dict.fromkeys(CAUSES, 0.25))
    pair = next(p for p in now if set(p) == {TRUE, "cooling.air"})
    told = made.distances("bath")[pair]
    assert told > now[pair], "a bath tells an offset of a thermometer"
    assert told == pytest.approx(made.seen("bath").visible("cooling.air"), rel=0.02), "the air shows, or nothing does"
    assert all(r.separation_after > r.separation_before < APART for r in best), "what is told apart needs nothing"


@pytest.mark.parametrize("sd", [1.0, 0.3])
def test_a_design_knows_the_rig_as_well_as_the_search(clean: tuple[Setting, Found], sd: float) -> None:
    found, problem = clean[1], clean[1].problem
    look = problem.look(found.null.look.z, (), np.full(problem.nz, sd))
    null = replace(found.null, look=look, noise=problem.noise(look, found.null.noise.scales))
    first = found.first.beside(null.linear(problem))
    made, known = simulate_design(problem, look, null.noise, first, CAUSES, ()), Effects(first.candidates, first.white)
    assert [made.seen().visible(c) for c in CAUSES] == pytest.approx([known.visible(c) for c in CAUSES])


def test_added_tests_are_run_as_the_first_one(wrong: tuple[Setting, Found]) -> None:
    setting, campaign = wrong[0], wrong[1].problem.data.campaign
    tried = list_experiments(campaign, setting.nominal.value)
    cold = next(e for e in tried if e.id == "cold_room")
    more = build_tests(campaign, cold)
    room = next(s.name for s in campaign.given if s.kind == "ambient")
    assert more.n_tests == len(cold.tests) == 4
    assert more.values[room].max() < campaign.values[room].min() - 10.0
    logged = build_tests(campaign, next(e for e in tried if e.logged))
    assert np.isfinite(logged.dwell).all()


def test_added_tests_have_the_load_that_is_asked_where_the_first_one_had_none(wrong: tuple[Setting, Found]) -> None:
    setting, campaign = wrong[0], wrong[1].problem.data.campaign
    torque = next(s.name for s in campaign.given if s.kind == "torque")
    idle = replace(
        campaign, values=campaign.values | {torque: np.where(campaign.test == 0, 0.0, campaign.values[torque])}
    )
    (low,) = (e for e in list_experiments(campaign, setting.nominal.value) if e.id == "low_load")
    asked = [test["torque"] for test in low.tests]
    assert np.abs(build_tests(idle, low).values[torque]) == pytest.approx(asked)
    assert np.sign(build_tests(idle, low).values[torque]) == pytest.approx(np.sign(campaign.values[torque][0]))


def test_points_without_a_running_order_stand_behind_the_campaign(wrong: tuple[Setting, Found]) -> None:
    _, found = wrong
    campaign = found.problem.data.campaign
    last = replace(campaign, order=np.full(campaign.n_tests, campaign.order.max()))
    assert np.array_equal(simulate(found, replace(campaign, ordered=False)), simulate(found, last), equal_nan=True)


def test_what_is_a_little_more_likely_than_nothing_is_an_alarm(clean: tuple[Setting, Found]) -> None:
    found = clean[1]
    none = np.array([not h.causes and not h.extras for h in found.hypotheses])
    p = np.where(none, 0.4999 / none.sum(), 0.5001 / (~none).sum())
    assert decide(replace(found, probabilities=p)).p_any < Options().alpha


def test_fractions_are_a_running_order_and_one_for_all_is_none(clean: tuple[Setting, Found]) -> None:
    scenario, campaign = clean[0].scenario, clean[1].problem.data.campaign
    np.testing.assert_allclose(replace(campaign, order=campaign.order / 100).progress, campaign.progress)
    made = setting(scenario, Card(), replace(campaign, order=np.ones(campaign.n_tests)))
    assert not {"procedure.order", "sensor.oil_temp.drift"} & {cause.id for cause in made.causes}


def test_the_rise_that_causes_follow_does_not_follow_the_scatter_of_readings(clean: tuple[Setting, Found]) -> None:
    o = clean[1].problem.data
    oil = next(s.name for s in o.read if s.kind == "oil_temp")
    noise = np.random.default_rng(1).normal(size=o.campaign.n)
    values = {**o.campaign.values, oil: o.campaign.values[oil] + noise}
    change = o.another(replace(o.campaign, values=values)).features[2] - o.features[2]
    assert change.std() < 0.8 * noise.std()


def test_nothing_is_said_of_what_is_left_where_nothing_is_free(wrong: tuple[Setting, Found]) -> None:
    found = wrong[1]
    assert p_adequacy(found, found.hypotheses[0], np.array([0])) is None


def test_the_first_test_is_told_by_its_name_in_the_file(clean: tuple[Setting, Found]) -> None:
    campaign = clean[1].problem.data.campaign
    named = replace(campaign, names=tuple(f"{200 + k}" for k in range(campaign.n_tests)))
    assert estimate.first_test(campaign, 0.0) == "test 1"
    assert estimate.first_test(named, 0.0) == "test 200"
    assert named.numbers[3] == 203


def test_all_room_probes_are_checked_in_one_experiment(clean: tuple[Setting, Found]) -> None:
    setting, found = clean
    campaign = found.problem.data.campaign
    room = next(s for s in campaign.given if s.kind == "ambient")
    values = campaign.values | {"T_hall": campaign.values[room.name]}
    two = replace(campaign, sensors=(*campaign.sensors, replace(room, name="T_hall")), values=values)
    tried = list_experiments(two, setting.nominal.value)
    known = {e.id: e for e in tried}
    assert len(known) == len(tried)
    assert [check.sensor for check in known["room_probe"].checks] == [room.name, "T_hall"]


def test_experiments_stay_within_the_rig_and_a_hall(wrong: tuple[Setting, Found]) -> None:
    """At most the speed of the operating point, and no room below 5 degC, nor one that is hardly colder."""
    setting, campaign = wrong[0], wrong[1].problem.data.campaign
    speed, room = (next(s for s in campaign.given if s.kind == kind) for kind in ("speed", "ambient"))
    fastest = np.abs(campaign.values[speed.name]).max()

    def values(kind: str, scale: float, shift: float, usual: float) -> list[float]:
        changed = {speed.name: scale * campaign.values[speed.name], room.name: campaign.values[room.name] + shift}
        tried = list_experiments(replace(campaign, values=campaign.values | changed), lambda path: usual)
        return [test[kind] for e in tried for test in e.tests if kind in test]

    assert max(values("speed", 1.0, 0.0, fastest)) == pytest.approx(fastest)
    assert max(values("speed", 0.5, 0.0, fastest)) == pytest.approx(0.8 * fastest)
    assert max(values("speed", 0.8, 0.0, fastest)) == pytest.approx(fastest)
    assert min(values("ambient", 1.0, 0.0, fastest)) >= 278.15
    assert not values("ambient", 1.0, 278.15 - campaign.values[room.name].min(), fastest)
    checked = replace(campaign, sensors=tuple(replace(s, checked=s.kind != "torque") for s in campaign.sensors))
    assert [e.id for e in list_experiments(checked, setting.nominal.value) if e.checks] == ["tare", "lever_arm"]
    made = designed(wrong[1], setting)
    weights = dict.fromkeys(CAUSES, 0.25)
    assert all(r.separation_after >= r.separation_before + 0.1 for r in rank(made, weights))


def test_residuals_stand_out_where_a_mounting_errs(clean: tuple[Setting, Found]) -> None:
    found = clean[1]
    problem = copy(found.problem)
    o, n = problem.data, problem.data.campaign.n_tests
    mounting = tuple("AB"[k % 2] for k in range(n))
    o = copy(o)
    o.campaign = replace(o.campaign, mounting=mounting)
    problem.data, problem.campaigns = o, [o]
    assert not any(r.stands_out for r in average_residuals(replace(found, problem=problem)))
    oil = next(i for i, s in enumerate(o.read) if s.kind == "oil_temp")
    errs = (o.kind == oil) & (np.array(mounting)[o.campaign.test[o.row]] == "B")
    problem.measured = problem.measured + 3.0 * errs
    told = average_residuals(replace(found, problem=problem))
    apart = [r for r in told if r.stands_out]
    assert apart
    assert {r.channel for r in apart} == {o.read[oil].name}
    assert all(r.cell[0] == "B" for r in apart if r.by[0] == "mounting")
    one = next(r for r in told if r.by == ("mounting", "speed") and r.cell[0] == "B" and r.channel == o.read[oil].name)
    assert one.mean == pytest.approx(3.0, abs=1.0)
    assert {r.by for r in told} == {("mounting", "speed"), ("load", "speed"), ("running order",)}


def test_a_rival_that_says_nothing_of_a_reading_is_left_out(wrong: tuple[Setting, Found]) -> None:
    o = wrong[1].problem.data
    rows, kept = np.arange(o.campaign.n), np.arange(o.campaign.n) % 4 > 0
    for i, s in enumerate(o.read):
        said = gain.constant_cooling(o, i, rows, kept)
        assert (said is None) == (not s.kind.endswith("_temp"))


def test_a_rig_is_played_with_its_inputs_as_found(clean: tuple[Setting, Found]) -> None:
    """A room that reads 6 K too high is no fault of a rig that cools less."""
    setting, problem, null = clean[0], copy(clean[1].problem), clean[1].null
    formulas = [next(f for f in setting.formulas if f.cause.id == c) for c in ("cooling.air", "sensor.ambient.bias")]
    acting = [Acting(f, np.r_[t, np.zeros(f.size - 1)]) for f, t in zip(formulas, (-1.0, 4.0), strict=True)]
    look, problem.data = problem.look(null.look.z, acting), copy(problem.data)
    problem.data.measured = look.shown[problem.own]
    played = estimate.replay(problem, null, SimpleNamespace(fit=SimpleNamespace(look=look)))  # type: ignore[arg-type]
    assert set(played) == {s.name for s in problem.data.read}
    assert all(p.rms_extended < 1e-6 < 1.0 < p.rms_calibrated for p in played.values()), played


def test_a_loss_that_is_all_gone_is_at_its_bound(wrong: tuple[Setting, Found], monkeypatch: pytest.MonkeyPatch) -> None:
    setting, found = wrong
    formula = next(f for f in setting.formulas if f.cause.id == "losses.seal_drag" and f.form.name == "")
    one = Acting(formula, np.r_[formula.limits[0], np.zeros(formula.size - 1)])
    assert formula.form.low > formula.cause.size.low, "no more than what is there"
    monkeypatch.setattr(estimate, "_of_cause", lambda *of: (one.t, 0.01 * np.eye(formula.size)))
    fit = SimpleNamespace(causes=(one.id,), look=SimpleNamespace(acting=(one,)))
    told = estimate.estimate_cause(found, one.id, [(SimpleNamespace(fit=fit, form=lambda cause: ""), 1.0)])[0]
    assert told.at_bound == "low"
    assert told.value == told.ci95[0] == pytest.approx(formula.form.low)


def test_a_place_in_the_running_order_is_a_test_with_its_date(clean: tuple[Setting, Found]) -> None:
    campaign = clean[1].problem.data.campaign
    dated = replace(campaign, date=tuple(f"2024-03-{k + 1:02d}" for k in range(campaign.n_tests)))
    assert campaign.n_tests == 16
    assert estimate.first_test(dated, 0.868) == "test 15 (2024-03-15)"
    assert estimate.first_test(campaign, 0.0) == "test 1"
    assert estimate.first_test(campaign, 1.0) == "test 16"


def test_a_cause_is_like_itself_alone(wrong: tuple[Setting, Found]) -> None:
    found = wrong[1]
    seen = Effects(found.first.candidates, found.first.white)
    like = dict.fromkeys(CAUSES, "")
    distances = seen.distances(TRUE)
    assert TRUE not in distances
    assert all(d <= seen.visible(TRUE) + 1e-9 for d in distances.values()), "a rival of size zero is none"
    group = find_alike(seen, TRUE, 1e-3, like)
    assert group is not None, "what cannot be seen is like everything"
    assert group.causes[0] == TRUE
    assert UNEXPLAINED not in group.causes


@pytest.mark.parametrize(("size", "alike"), [(-5.0, True), (-0.1, True), (5.0, False)])
def test_what_is_like_a_cause_is_like_it_on_the_side_that_was_found(
    clean: tuple[Setting, Found], size: float, alike: bool
) -> None:
    first = clean[1].first
    own = [next(c for c in first.candidates if c.id == name) for name in (TRUE, "losses.churning")]
    assert own[1].formula.limits[0] == 0.0, "a loss that only adds"
    made = SimpleNamespace(first=SimpleNamespace(candidates=own, white=np.array([[9.0, -9.0]])))
    best = SimpleNamespace(fit=SimpleNamespace(look=SimpleNamespace(acting=[SimpleNamespace(id=TRUE, t=[size])])))
    decision = SimpleNamespace(answers=(), marginal={TRUE: Chance(1.0, 0.0)}, members={TRUE: [(best, 1.0)]})
    told = compose.sets(clean[0].causes, made, decision)
    assert [s.causes for s in told] == ([(TRUE, "losses.churning")] if alike else [])


def test_a_design_tells_two_causes_apart_only_if_it_does_on_both_sides(clean: tuple[Setting, Found]) -> None:
    offset, added = (next(c for c in clean[1].first.candidates if c.id == id) for id in (TRUE, "losses.churning"))
    seen = Effects((offset, added), np.array([[9.0, -9.0]]))
    assert seen.distances(TRUE, 1.0) == {"losses.churning": 9.0}
    assert seen.distances(TRUE)["losses.churning"] == pytest.approx(0.0), "the probe may show too little"
    assert seen.distances("losses.churning")[TRUE] == pytest.approx(0.0)


def test_calibration_goes_no_further_than_what_is_possible(clean: tuple[Setting, Found]) -> None:
    data = clean[1].problem.data
    names = [n.name for n in data.nuisances]
    nuisance = data.nuisances[k := names.index("radiation")]
    base = {path: data.plant.p[data.plant.place[path]] for path in nuisance.paths}
    low, high = data.limits[:, k]
    assert low == -6.0 and max(base.values()) * np.exp(nuisance.sd * high) == pytest.approx(1.0)
    z = np.zeros(len(names))
    z[k] = high
    told = extension.values(clean[1], z)
    assert {path: told[path] for path in base} == dict.fromkeys(base, pytest.approx(1.0))
