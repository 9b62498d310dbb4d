"""Plans: which experiments tell causes apart, what they say where none does, and what they refuse."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from gearheat.model.errors import DataError
from gearheat.tools.diagnose.candidates import LOG, candidates
from gearheat.tools.diagnose.checks import Check, at_rest
from gearheat.tools.diagnose.design import Design, Scatter, prior_size
from gearheat.tools.diagnose.enlarged import Enlarged
from gearheat.tools.diagnose.experiments import ranked
from gearheat.tools.diagnose.family import Sample
from gearheat.tools.diagnose.plan import APART, nominal, plan_from
from gearheat.tools.diagnose.plan_inputs import PlanRequest, read_plan
from gearheat.tools.diagnose.plan_output import as_object, picture, sentence
from gearheat.tools.effects.taxonomy import CAUSES

COOLING = ("cooling.air", "cooling.emissivity")
WARMING = ("thermal.mass", "procedure.not_stationary")
TORQUE = ("sensor.torque.offset", "sensor.torque.gain")
OIL_PROBE = ("sensor.oil_temp.offset", "sensor.oil_temp.position")
DAYS = ("cooling.humidity", "procedure.day_scatter")
SAME = ("losses.bearing_preload", "losses.seal_drag")
ALL = (*COOLING, *WARMING, *TORQUE, *OIL_PROBE, *DAYS, *SAME, "sensor.torque.drift", "sensor.speed.gain")
HEAD = "point,test,order,direction,dwell_min,oil,n_carrier_rpm,T_carrier_Nm,T_amb_C"


@pytest.fixture(scope="module")
def inputs():
    found = read_plan(PlanRequest("planetary", ",".join(ALL)))
    bare = [{k: v for k, v in r.values.items() if k != "T_oil2_C"} for r in found.campaign.readings]
    readings = [replace(r, values=v) for r, v in zip(found.campaign.readings, bare, strict=True)]
    return replace(found, campaign=replace(found.campaign, readings=tuple(readings)))


@pytest.fixture(scope="module")
def problem(inputs):
    return nominal(inputs)


@pytest.fixture(scope="module")
def design(problem) -> Design:
    """One simulation for all plans below, with few forms."""
    samples = [Sample(c, *c.sample(3, 1), prior_size(c)) for c in (CAUSES[name] for name in ALL)]
    return Design.of(problem, np.zeros(len(problem.parameters.names)), candidates(problem.data.model), samples)


@pytest.fixture(scope="module")
def plan(inputs, design):
    def of(*causes: str):
        own = {name: design.families[name] for name in causes}
        return plan_from(replace(inputs, causes=causes), replace(design, families=own))

    return of


@pytest.fixture
def points(tmp_path):
    """Three tests: few enough to be quick."""
    rows = [(100, 1600), (250, 1600), (250, 2600)]
    lines = [
        f"{2 * k + d},{k + 1},{k + 1},{d},{240 if d == 1 else 90},PAOR,{n},{tau},22"
        for k, (n, tau) in enumerate(rows)
        for d in (1, 2)
    ]
    path = tmp_path / "points.csv"
    path.write_text("\n".join([HEAD, *lines]) + "\n")
    return path


def after(found, *experiments: str) -> float:
    """The smallest distance behind an experiment."""
    return next(o.smallest for o in found.outlooks if tuple(e.id for e in o.experiments) == experiments)


# ---------------------------------------------------------------------------------------------- the campaign enlarged


def test_the_campaign_holds_the_first_grid_and_what_the_model_reads(inputs, problem):
    assert len(inputs.campaign.tests()) == 16 and {r.oil for r in inputs.campaign.readings} == {"PAOR"}
    linear = problem.linearised(np.zeros(len(problem.parameters.names)))
    assert np.abs(linear.residual).max() < 1e-6


def test_what_there_is_stays_what_it_was(problem):
    """Among all readings of experiments, those of the campaign have the scatter and the signatures they have alone."""
    z = np.zeros(len(problem.parameters.names))
    linear = problem.linearised(z)
    some = [e for e in candidates(problem.data.model) if e.id != "transients"]  # a log moves the solver's steps
    causes = [CAUSES["cooling.foundation"], CAUSES["sensor.torque.drift"]]
    samples = [Sample(c, np.full((1, len(c.shapes)), 0.5), np.zeros(1), c.size.sd) for c in causes]
    found = Design.of(problem, z, some, samples)
    there = found.covariance[np.ix_(found.present, found.present)]
    np.testing.assert_allclose(there, linear.covariance, rtol=1e-9, atol=1e-9)
    alone = problem.signatures(linear, [(c, found.families[c.id].forms[0], c.size.sd) for c in causes])
    for k, c in enumerate(causes):
        np.testing.assert_allclose(found.families[c.id].signatures[found.present, 0], alone[:, k], rtol=1e-9, atol=1e-9)


def test_experiments_add_what_they_say(problem, design):
    tests, halves = problem.data.model.rows.n_tests, problem.data.model.n
    added = {name: int(mask.sum()) for name, mask in design.added.items()}
    assert not any((design.present & mask).any() for mask in design.added.values())
    assert added["cold_room"] == 4 * 2 * 3 and added["first_again"] == 2 * 3  # oil, wall and loss in two directions
    assert added["second_probe"] == halves
    assert added["transients"] == halves * (1 + 2 * 7)  # the dwell, and seven places of two courses
    assert added["humidity"] == 0 and added["tares"] == tests and added["room_probe"] == halves


def test_a_log_that_is_there_is_no_experiment(problem):
    logged = Enlarged.of(problem, [e for e in candidates(problem.data.model) if e.id == "transients"]).problem
    assert set(LOG) <= set(logged.data.channels.names)
    left = candidates(logged.data.model)
    assert "transients" not in {e.id for e in left}
    again = Enlarged.of(logged, left)
    assert again.present.sum() == len(logged.measured)


# ----------------------------------------------------------------------------------------------------------- checks


def test_checks_show_instruments_and_nothing_else():
    def shown(check, name, **shapes):
        cause = CAUSES[name]
        return check.signatures(
            cause, [{**cause.forms(np.full((1, len(cause.shapes)), 0.5))[0], **shapes, cause.size.name: 2.0}], {}
        )

    bath = Check("T_oil", 0.05, at_rest(T=333.15), 333.15)
    assert shown(bath, "sensor.oil_temp.offset") == pytest.approx(1.0)
    assert shown(bath, "sensor.oil_temp.gain", fixed=273.15) == pytest.approx(60.0)
    assert shown(bath, "sensor.oil_temp.position") == pytest.approx(0.0)
    assert shown(bath, "sensor.wall_temp.offset") == 0.0
    room = Check("T_amb", 0.05, at_rest())
    assert shown(room, "sensor.ambient.bias") == pytest.approx(1.0)
    assert shown(room, "sensor.ambient.heated") == 0.0  # nothing is warm here
    tares = Check("loss", 0.3, at_rest(3, order=np.array([0.0, 0.5, 1.0])))
    assert shown(tares, "sensor.torque.offset") == pytest.approx(1.0)
    assert shown(tares, "sensor.torque.gain") == pytest.approx(0.0)
    assert shown(tares, "sensor.torque.drift", power=1.0, zero=0.5).ravel() == pytest.approx([-0.5, 0.0, 0.5])
    assert shown(Check("loss", 0.3, at_rest(tau=2000.0)), "sensor.torque.gain") == pytest.approx(2000.0)
    assert shown(Check("speed", 2e-3, at_rest()), "sensor.speed.gain") == pytest.approx(1.0)
    np.testing.assert_allclose(Check("T_amb", 0.3, at_rest(2), standard=0.1).covariance(), [[0.1, 0.01], [0.01, 0.1]])


# ----------------------------------------------------------------------------------------------------------- ranking


def test_a_cold_room_or_a_log_tells_air_from_emissivity(plan):
    found = plan(*COOLING)
    first, second = (o.experiments[0].id for o in found.outlooks[:2])
    assert {first, second} == {"cold_room", "transients"}
    assert after(found, "cold_room") > 2 * found.now.smallest
    assert found.verdict == "none"
    assert [o.smallest for o in found.together] == sorted(o.smallest for o in found.together)


def test_a_log_tells_a_mass_from_early_readings(plan):
    found = plan(*WARMING)
    best = found.outlooks[0]
    assert best.experiments[0].id == "transients" and best.separates and found.verdict == "one"
    assert found.now.smallest < 1.0 and found.outlooks[1].smallest < 1.0
    assert len(found.together) == 1


@pytest.mark.parametrize(
    ("causes", "tells", "does_not"),
    [
        (TORQUE, ("tare", "tares", "lever_arm"), ("repeat", "bath", "transients")),
        (OIL_PROBE, ("bath",), ("tare", "stroboscope")),
        (("sensor.speed.gain", "cooling.air"), ("stroboscope",), ("repeat", "tare")),
        (("sensor.torque.drift", "sensor.torque.offset"), ("tares",), ("bath", "second_probe")),
    ],
)
def test_checks_tell_the_faults_of_their_instruments(plan, causes, tells, does_not):
    found = plan(*causes)
    assert min(after(found, e) for e in tells) > max(after(found, e) for e in does_not) + 0.5
    assert found.outlooks[0].experiments[0].id in tells


def test_no_experiment_takes_knowledge_away(design):
    seen = design.seen()
    plain = [name for name, cause in seen.items() if not isinstance(cause, Scatter)]
    before = design.distances()
    for experiment in design.experiments:
        now = design.distances(experiment.id)
        for pair in combinations(plain, 2):
            assert now[pair] > before[pair] - 1e-6, (experiment.id, pair)


def test_days_that_differ_follow_the_humidity_only_where_it_is_logged(plan, design):
    assert set(DAYS) <= {name for name, cause in design.seen().items() if isinstance(cause, Scatter)}
    found = plan(*DAYS)
    assert found.now.smallest == 0.0 and not found.one_answer
    assert found.outlooks[0].experiments[0].id == "humidity" and found.outlooks[0].separates
    assert all(o.smallest == 0.0 for o in found.outlooks[1:])


def test_causes_of_one_class_are_one_answer(plan):
    found = plan(*SAME)
    assert found.verdict == "same" and found.outlooks == () and found.now is None
    assert "one answer" in sentence(found)
    told = as_object(found)
    assert "every steady instrument" in told["pairs"][0]["one_answer"] and told["experiments"] == []
    assert all("measured by hand" in cause["exposes"] for cause in told["causes"])
    assert picture(found, "svg").startswith(b"<svg")


def test_a_pair_of_one_class_does_not_hide_the_others(plan):
    found = plan(*SAME, "procedure.not_stationary")
    assert list(found.one_answer) == [SAME] and found.now is not None
    assert SAME not in {o.nearest for o in found.outlooks}
    assert "Nothing here tells losses.bearing_preload and losses.seal_drag apart" in sentence(found)


def test_several_experiments_where_one_is_not_enough(plan):
    found = plan(*WARMING, *TORQUE)
    assert found.verdict == "several"
    assert {e.id for e in found.together[-1].experiments} == {"transients", "tare"}
    assert found.together[-1].smallest > APART > found.together[0].smallest


def test_what_a_diagnosis_proposes_next(problem):
    """The ranking inside a diagnosis looks at the same experiments."""
    z = np.zeros(len(problem.parameters.names))
    found = ranked(problem, z, {**dict.fromkeys(TORQUE, 0.5), "procedure.day_scatter": 0.02})
    assert found[0].id in ("tare", "tares", "lever_arm") and set(found[0].separates) == set(TORQUE)
    assert found[0].after > APART > found[0].before
    assert ranked(problem, z, {"cooling.air": 1.0}) == []


# ----------------------------------------------------------------------------------------------------------- command


def test_json_and_picture_are_the_same_every_time(gearheat, points, tmp_path):
    def run(k: int, kind: str):
        out = tmp_path / f"plan{k}.{kind}"
        done = gearheat(
            "plan", "planetary", "--separate", ",".join(TORQUE), "--points", points, "--json", "-", "-o", out
        )
        assert done.code == 0, done.err
        return done.out, out.read_bytes()

    text, drawn = run(1, "png")
    assert (text, drawn) == run(2, "png") and drawn.startswith(b"\x89PNG")
    found = json.loads(text)
    assert found["schema"] == "gearheat.plan/1" and found["campaign"]["tests"] == 3
    assert {"rig", "apart", "verdict", "says", "causes", "pairs", "experiments", "together", "warnings"} <= set(found)
    assert [p["causes"] for p in found["pairs"]] == [list(TORQUE)]
    assert {"second_probe", "humidity", "transients"} <= {e["id"] for e in found["experiments"]}
    for e in found["experiments"]:
        assert {
            "id",
            "what",
            "tests",
            "channels",
            "checks",
            "smallest",
            "nearest",
            "gain",
            "separates",
            "pairs",
        } <= set(e)
        assert e["pairs"][0]["before"] == found["pairs"][0]["distance"]
        assert e["smallest"] == e["pairs"][0]["after"] and e["separates"] == (e["smallest"] >= found["apart"])
    assert found["experiments"][0]["smallest"] == max(e["smallest"] for e in found["experiments"])


def test_a_screen_of_text_with_a_reference_and_a_card(gearheat, points, tmp_path):
    card = tmp_path / "card.json"
    card.write_text(
        json.dumps({"schema": "gearheat.card/1", "channels": {"T_oil_C": {"repeat_sd": 0.1, "offset_sd": 0.1}}})
    )
    done = gearheat(
        "plan", "planetary", "--separate", ",".join(WARMING), "--points", points, "--reference", "--card", card
    )
    assert done.code == 0, done.err
    assert "transients" in done.out and "the campaign as it is" in done.out
    assert "no card" not in done.out


def test_all_that_is_wrong_is_told_at_once(gearheat, tmp_path):
    wrong = tmp_path / "points.csv"
    wrong.write_text(f"{HEAD}\n1,1,1,1,240,PAOX,100,-1600,22\n")
    card = tmp_path / "card.json"
    card.write_text('{"prior_sd": {"mu": -1}}')
    out = tmp_path / "no" / "plan.pdf"
    done = gearheat(
        "plan", "planetry", "--separate", "cooling.ari,seal_drag", "--points", wrong, "--card", card,
        "--out", out, "--json", card,
    )  # fmt: skip
    assert done.code == 2 and done.out == "" and "Traceback" not in done.err
    words = ['"cooling.air"', '"losses.seal_drag"', '"planetary"', "prior_sd.mu", "line 2", "PAOX", ".png"]
    for word in (*words, "cannot be written", "is the file of --card"):
        assert word in done.err, done.err


@pytest.mark.parametrize("names", ["cooling.air", "cooling.air,cooling.air", " , "])
def test_one_cause_alone_needs_no_plan(names):
    with pytest.raises(DataError, match="two causes or more"):
        read_plan(PlanRequest("planetary", names))


def test_too_few_points_and_other_layouts_are_refused(tmp_path):
    few = tmp_path / "few.csv"
    few.write_text(f"{HEAD}\n1,1,1,1,240,PAOR,100,1600,22\n")
    with pytest.raises(DataError, match="too few"):
        read_plan(PlanRequest("planetary", ",".join(COOLING), points=few))
    with pytest.raises(DataError, match="campaign"):
        read_plan(PlanRequest("helical_two_stage", ",".join(COOLING)))


def test_a_rig_without_a_campaign_gets_a_grid(rig):
    rig.line("campaign", "data", "")
    found = read_plan(PlanRequest(str(rig), ",".join(COOLING)))
    speeds = {round(r.values["n_carrier_rpm"]) for r in found.campaign.readings}
    assert len(found.campaign.tests()) == 16 and speeds == {100, 150, 200, 250}
    assert {r.values["T_amb_C"] for r in found.campaign.readings} == {25.0}
