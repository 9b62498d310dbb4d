"""What `diagnose` is built of, each by itself: evidence of several causes, repeated points, courses, folds, starts."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import product
from math import comb, log
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from gearheat.model.errors import DataError, SolveError
from gearheat.scenarios.measured import Campaign, Reading, Test
from gearheat.tools.diagnose import evidence, gain, logged, together
from gearheat.tools.diagnose.campaign_model import CampaignModel
from gearheat.tools.diagnose.card import BY_ROOM, Card
from gearheat.tools.diagnose.evidence import WIDTHS, White
from gearheat.tools.diagnose.family import Family, Sample, pair_evidence
from gearheat.tools.diagnose.hypothesis import Hypothesis, distinct
from gearheat.tools.diagnose.inputs import Request, read_inputs
from gearheat.tools.diagnose.nuisance import ALLOWED, Channels, instrument_covariance
from gearheat.tools.diagnose.problem import CHANGED, REFILLED, Linear, Problem, remainder
from gearheat.tools.diagnose.repeated import repeated, scatter_warning, with_repeatability
from gearheat.tools.diagnose.search import NONE, Search
from gearheat.tools.diagnose.series import Series
from gearheat.tools.diagnose.weigh import ASKED, asked_for, joints
from gearheat.tools.effects.cause import Rows
from gearheat.tools.effects.taxonomy import CAUSES

#: Readings of the made-up families; causes whose sizes have bounds far outside of their priors.
M = 40
TWO_SIDED = ("sensor.oil_temp.offset", "sensor.torque.offset", "sensor.wall_temp.offset")
HEAD = "point,test,order,direction,dwell_min,oil,n_carrier_rpm,T_carrier_Nm,T_sun_Nm,T_oil_C,T_wall_C,T_amb_C"


def family(name: str, seed: int, forms: int = 1, length: float = 6.0, alike: float = 0.0) -> Family:
    """A family whose forms are `length` standard deviations long at the prior's half width, against no residual yet."""
    cause, rng = CAUSES[name], np.random.default_rng(seed)
    own = rng.standard_normal((M, 1)) + 0.5 * rng.standard_normal((M, forms))
    own = own + alike * np.random.default_rng(0).standard_normal((M, 1))
    own *= length / np.linalg.norm(own, axis=0) / cause.size.sd
    empty = np.zeros(forms)
    return Family(
        cause, [{"form": float(k)} for k in range(forms)], own, own, empty, (own**2).sum(axis=0), empty[:, None], empty
    )


def against(parts, sizes, seed: int = 3, forms=None) -> list[Family]:
    """The families against a residual that holds one form of each, by sizes in prior half widths."""
    e = np.random.default_rng(seed).standard_normal(M)
    for f, size, k in zip(parts, sizes, forms or [0] * len(parts), strict=True):
        e = e + f.signatures[:, k] * size * f.cause.size.sd
    white = White(np.eye(M), e)
    return [f.seen(white) for f in parts]


def integrated(parts, widths) -> float:
    """Log Bayes factor of first forms by sums over a grid of sizes; priors normal inside the bounds, widths mixed."""
    G = np.stack([f.white[:, 0] for f in parts], axis=1)
    s, Q = np.array([f.s[0] for f in parts]), G.T @ G
    sd = np.array([f.cause.size.sd for f in parts])
    centre, spread = np.linalg.solve(Q, s), np.sqrt(np.diag(np.linalg.inv(Q)))
    axes = [np.linspace(c - 7 * d, c + 7 * d, 81) for c, d in zip(centre, spread, strict=True)]
    prior = []
    for f, at, own in zip(parts, axes, sd, strict=True):
        low, high = f.cause.size.low, f.cause.size.high
        whole = np.zeros_like(at)
        for width in widths:
            fine = np.linspace(low, high, 40001)
            mass = np.exp(-0.5 * (fine / (width * own)) ** 2).sum() * (fine[1] - fine[0])
            whole += np.exp(-0.5 * (at / (width * own)) ** 2) * (at >= low) * (at <= high) / mass / len(widths)
        prior.append(whole * (at[1] - at[0]))
    x = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    logs = x @ s - 0.5 * np.einsum("...i,ij,...j", x, Q, x)
    weight = prior[0]
    for other in prior[1:]:
        weight = weight[..., None] * other
    return float(np.log((np.exp(logs - logs.max()) * weight).sum()) + logs.max())


# ------------------------------------------------------------------------------------------ several families together


@pytest.fixture
def one_width(monkeypatch):
    """A single width of the priors, in which the algebra of several causes is exact."""

    def use(width: float) -> None:
        for module in (evidence, together):
            monkeypatch.setattr(module, "WIDTHS", np.array([width]))

    return use


@pytest.mark.parametrize("names", [TWO_SIDED[:1], TWO_SIDED[:2], TWO_SIDED])
@pytest.mark.parametrize("width", [0.8, 1.6])
def test_evidence_at_one_width_is_the_integral_over_the_sizes(one_width, names, width):
    one_width(width)
    parts = against([family(n, k, alike=0.6) for k, n in enumerate(names)], (1.0, -0.7, 1.3)[: len(names)])
    value, sizes = together.gaussian(parts, [0] * len(parts))
    assert value == pytest.approx(integrated(parts, [width]), abs=0.01)
    assert value > 3.0
    G, sd = np.stack([f.white[:, 0] for f in parts], axis=1), np.array([f.cause.size.sd for f in parts])
    left = G.T @ G @ sizes + sizes / (width * sd) ** 2 - [f.s[0] for f in parts]
    assert np.abs(left * sd).max() < 1e-9  # the most likely sizes: no slope is left


def test_a_one_sided_size_keeps_half_of_its_prior(one_width):
    one_width(1.6)
    parts = against([family("losses.churning", 1), family(TWO_SIDED[0], 2)], (1.2, 1.0))
    assert together.gaussian(parts, [0, 0])[0] == pytest.approx(integrated(parts, [1.6]), abs=0.01)
    against_it = against([family("losses.churning", 1), family(TWO_SIDED[0], 2)], (-0.5, 1.0))
    alone = together.gaussian(against_it[1:], [0])[0]
    assert together.gaussian(against_it, [0, 0])[0] < alone  # of the other sign it explains nothing


@pytest.mark.parametrize("count", [1, 2, 3])
def test_intervals_hold_the_size_beside_causes_of_any_size(one_width, count):
    one_width(1.6)
    parts = [family(n, k, forms=3, length=3.0, alike=3.0) for k, n in enumerate(TWO_SIDED[:count])]
    held, n, rng = 0, 400, np.random.default_rng(5)
    for seed in range(n):
        shares, k = 1.6 * rng.standard_normal(count), int(rng.integers(3))
        *others, f = against(parts, shares, seed, forms=[*[0] * (count - 1), k])
        sizes = [share * g.cause.size.sd for share, g in zip(shares, parts, strict=True)]
        together_now = [*(replace(g, white=g.white[:, :1]) for g in others), f]
        weights, sd = together.by_form(together_now, sizes)
        assert weights.sum() == pytest.approx(1.0) and weights.shape == sd.shape == (3,)
        found = together.gaussian(together_now, [*[0] * (count - 1), k])[1]
        held += abs(sizes[-1] - found[-1]) < 1.96 * sd[k]
    assert held / n == pytest.approx(0.95, abs=0.03)


def test_a_size_at_its_bound_leaves_the_others_no_room():
    a, b = against([family("losses.churning", 1, alike=3.0), family(TWO_SIDED[0], 2, alike=3.0)], (1.0, 1.0))
    size = a.cause.size
    beside = {x: together.by_form([a, b], (x, 1.0))[1][0] for x in (size.low, size.sd, size.high)}
    assert beside[size.low] == beside[size.high] == pytest.approx(b.sizes()[1][0])
    assert beside[size.sd] > 1.5 * beside[size.low]


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("count", [1, 2, 3])
def test_the_chosen_widths_stand_for_the_mixture(count, seed):
    """One width of four is taken, with its quarter of the prior: never more than all, and log 4 less at most."""
    parts = [family(n, 10 * seed + k, length=6.0, alike=0.4) for k, n in enumerate(TWO_SIDED[:count])]
    parts = against(parts, ((-1) ** seed * 0.6, 1.1, 2.2)[:count], seed)
    exact = integrated(parts, WIDTHS)
    if count == 1:
        assert exact == pytest.approx(float(parts[0].log_bf()[0]), abs=0.01)
    if count == 2:
        assert exact == pytest.approx(pair_evidence(*parts)[0], abs=0.01)
    chosen = together.joint(parts)[0]
    assert exact - count * log(len(WIDTHS)) < chosen < exact


def test_evidence_of_one_and_two_families_is_averaged_over_all_their_forms():
    a, b = against([family("cooling.air", 1, forms=5), family("sensor.torque.offset", 2, forms=4)], (2.0, 2.0))
    assert together.evidence_of([a]) == a.evidence()
    assert together.evidence_of([a, b]) == pair_evidence(a, b)[0]
    # forms that tell nothing of each other: the average of one at a time is that of all
    assert together.joint([a, b])[0] == pytest.approx(pair_evidence(a, b)[0], abs=2 * log(len(WIDTHS)))


def test_averaging_one_family_at_a_time_is_averaging_all_where_families_do_not_meet(one_width):
    one_width(1.6)
    parts = [family(n, k, forms=3) for k, n in enumerate(TWO_SIDED)]
    for k, f in enumerate(parts):  # each has readings of its own
        mine = (np.arange(M) % 3 == k)[:, None]
        parts[k] = replace(f, signatures=f.signatures * mine, log_w=np.log([1.5, 0.9, 0.6]))
    parts = against(parts, (3.0, -2.0, 2.0), forms=[1, 2, 0])
    each = [together.gaussian(parts, k)[0] + sum(f.log_w[i] for f, i in zip(parts, k, strict=True))
            for k in product(range(3), repeat=3)]  # fmt: skip
    exact = float(np.logaddexp.reduce(each) - np.log(len(each)))
    assert together.joint(parts)[0] == pytest.approx(exact, abs=1e-6)
    assert together.evidence_of(parts) == pytest.approx(sum(f.evidence() for f in parts), abs=1e-3)
    assert together.best_together(parts)[0] == [1, 2, 0]


def test_a_cause_that_is_not_there_costs_and_one_that_is_gains():
    parts = [family(n, k, length=6.0) for k, n in enumerate(TWO_SIDED)]
    with_it, without = against(parts, (1.5, -1.5, 1.5)), against(parts, (1.5, -1.5, 0.0))
    assert together.joint(with_it)[0] > together.joint(with_it[:2])[0] + 10.0
    assert together.joint(without)[0] < together.joint(without[:2])[0]


def test_the_family_of_one_form_is_that_form():
    (f,) = against([family("cooling.air", 1, forms=5)], (2.0,))
    one = together.only(f, f.theta(3, 2.5))
    assert one.forms == [{"form": 3.0}] and one.log_bf()[0] == f.log_bf()[3]
    assert one.evidence() == pytest.approx(f.log_bf()[3])


# ------------------------------------------------------------------------------------------------ hypotheses weighed


def search_of(*hypotheses: Hypothesis) -> SimpleNamespace:
    """As much of a search as weighing asks for: the causes of a library of 32 and their priors."""
    n = 32
    prior = lambda k: log({0: NONE, 1: 0.37}.get(k, 0.08 * 0.25 ** (k - 2)) / comb(n, k))  # noqa: E731
    logs = np.array([h.log_posterior for h in hypotheses])
    shares = np.exp(logs - np.logaddexp.reduce([*logs, -5.0]))
    return SimpleNamespace(prior=prior, hypotheses=list(hypotheses), probabilities=lambda: shares)


def gained(*bayes: tuple[tuple[str, ...], float]) -> list[Hypothesis]:
    """Hypotheses by the Bayes factor of each, their priors as they are."""
    return [Hypothesis(causes, log(value) + search_of().prior(len(causes))) for causes, value in bayes]


def test_causes_that_are_not_asked_for_are_left_away_one_after_the_other():
    a, b, c = "cooling.air", "sensor.torque.offset", "thermal.mass"
    found = gained(((a,), 1e6), ((a, b), 1.2e6), ((a, b, c), 1.5e6), ((b, c), 10.0))
    known = {frozenset(h.causes): h for h in found}
    search = search_of(*found)
    assert asked_for(search, found[2], known) == (a,)  # neither c beside a and b, nor then b beside a
    merged, best = joints(search)
    assert merged[0].causes == (a,) and best[0] is found[0]
    assert {j.causes for j in merged} == {(a,), (b, c)}
    assert merged[0].probability == pytest.approx(search.probabilities()[:3].sum())


def test_causes_that_are_asked_for_stay():
    a, b, c = "cooling.air", "sensor.torque.offset", "thermal.mass"
    found = gained(((a,), 1e3), ((a, b), 1e6), ((a, c), 2e3), ((a, b, c), ASKED * 1.01e6))
    known = {frozenset(h.causes): h for h in found}
    assert asked_for(search_of(*found), found[3], known) == (a, b, c)
    just = replace(found[3], log_posterior=found[3].log_posterior - 0.02)
    assert asked_for(search_of(*found), just, known) == (a, b)
    assert asked_for(search_of(*found), found[0], known) == (a,)


def test_three_causes_of_which_two_are_in_other_members_of_their_classes_are_one_answer():
    b, c = "sensor.torque.offset", "thermal.mass"
    found = gained((("losses.churning", b, c), 1e6), (("losses.windage", b, c), 4e5), (("cooling.air",), 1e2))
    merged, best = joints(search_of(*found))
    assert merged[0].causes == ("losses.churning", b, c) and best[0] is found[0]
    assert len(merged) == 2


def test_hypotheses_of_the_same_causes_are_one_in_whatever_order():
    one, two, other = Hypothesis(("a", "b"), 1.0), Hypothesis(("b", "a"), 2.0), Hypothesis(("a",), 0.5)
    assert distinct([one, other, two]) == [two, other]
    assert distinct([two, other, one]) == [two, other]


def test_priors_of_all_hypotheses_of_a_number_add_up_to_less_with_each_cause():
    search = Search.__new__(Search)
    search.causes = list(CAUSES.values())
    n = len(search.causes)
    shares = [comb(n, k) * np.exp(search.prior(k)) for k in range(6)]
    assert shares[:3] == pytest.approx([0.5, 0.37, 0.08])
    assert shares[3:] == pytest.approx([0.02, 0.005, 0.00125])


def test_first_looks_take_far_secants_where_an_effect_bends():
    bent = [c for c in CAUSES.values() if c.size.far is not None]
    assert {c.id for c in bent} >= {"cooling.contact", "procedure.not_stationary"}
    for cause in CAUSES.values():
        sizes = [size for _, _, size in Sample.of_prior(cause, 6).wanted()]
        assert all(cause.size.low <= size <= cause.size.high for size in sizes), cause.id
        assert sizes[0] == (cause.size.sd if cause.size.sd <= cause.size.high else -cause.size.sd)
        assert (set(sizes[1::2]) == {cause.size.far}) == (cause in bent), cause.id
        assert len(set(sizes[::2])) == 1
    one = Sample(CAUSES["sensor.wall_temp.offset"], np.zeros((3, 0)), np.zeros(3), 2.0)
    assert [size for _, _, size in one.wanted()] == [2.0, 2.0, 2.0]


# -------------------------------------------------------------------------------------------------- repeated points


def reading(point: int, test: int, oil=60.0, wall=58.0, loss=40.0, **other) -> Reading:
    """A reading at 200 rpm and 2000 N.m in a room of 25 degC."""
    values = {"n_carrier_rpm": 200.0, "T_carrier_Nm": 2000.0, "T_amb_C": 25.0, "T_oil_C": oil, "T_wall_C": wall}
    values |= {"dwell_min": 240.0} | {k: v for k, v in other.items() if k in ("n_carrier_rpm", "T_carrier_Nm")}
    direction = other.get("direction", 1)
    values["T_sun_Nm"] = (values["T_carrier_Nm"] - loss) / 4
    return Reading(point, point, test, test, direction, other.get("name", "PAOR"), values)


def campaign(*readings: Reading) -> Campaign:
    return Campaign("DATA.csv", readings, None)


def test_repeated_points_show_their_scatter():
    data = campaign(
        reading(1, 1, 60.0, 50.0, 40.0), reading(2, 2, 62.0, 51.0, 43.0), reading(3, 3, 61.0, 52.0, 43.0),
        reading(4, 4, 80.0, 70.0, 60.0, n_carrier_rpm=250.0), reading(5, 5, 84.0, 70.0, 60.0, n_carrier_rpm=251.0),
        reading(6, 6, 99.0, name="MINE"), reading(7, 1, 90.0, direction=2), reading(8, 8, 70.0, T_carrier_Nm=2100.0),
    )  # fmt: skip
    found = repeated(data)
    assert found is not None and found.freedom == 3
    assert found.T_oil == pytest.approx(np.sqrt((1 + 1 + 0 + 4 + 4) / 3))
    assert found.T_wall == pytest.approx(np.sqrt(2 / 3))
    assert found.loss == pytest.approx(np.sqrt((4 + 1 + 1) / 3))
    assert repeated(campaign(*data.readings[1:])) is None  # two degrees of freedom say nothing


def test_repeatability_of_points_is_taken_where_it_is_more():
    card = Card()
    data = campaign(*(reading(k, k, 60.0 + 3 * (-1) ** k, 58.0, 40.0 + 5 * (-1) ** k) for k in range(1, 5)))
    found = repeated(data)
    wider = with_repeatability(card, found)
    room, sun = card.channel("T_amb_C").repeat_sd, card.channel("T_sun_Nm").repeat_sd
    assert np.hypot(wider.channel("T_oil_C").repeat_sd, room) == pytest.approx(found.T_oil)
    assert np.hypot(wider.channel("T_carrier_Nm").repeat_sd, 4 * sun) == pytest.approx(found.loss)
    assert wider.channel("T_wall_C") == card.channel("T_wall_C")  # these repeat better than stated
    assert wider.channel("T_oil_C").offset_sd == card.channel("T_oil_C").offset_sd
    (said,) = scatter_warning(data, card)
    assert "--repeatability points" in said and "3 degrees of freedom" in said
    assert scatter_warning(data, wider) == ()
    assert scatter_warning(campaign(*data.readings[:2]), card) == ()


# ------------------------------------------------------------------------------------------------- what users ask for


def table(path: Path, tests, more: str = "", head: str = HEAD, warmer: float = 0.0) -> Path:
    """Tests of given speed, torque and oil, both directions of each; the oil of the last one warmer than it should."""
    rows = []
    for k, (n, tau, oil) in enumerate(tests):
        for d in (1, 2):
            loss, rise = 20.0 + 0.005 * tau, 5.0 + 0.1 * n + 0.005 * tau
            sun = (tau - loss) / 4 if d == 1 else (tau + loss) / 4
            dwell = 240 if d == 1 else 90
            rows.append(f"{2 * k + d},{k + 1},{k + 1},{d},{dwell},{oil},{n},{tau},{sun:.3f},"
                        f"{22 + rise + warmer * (k == len(tests) - 1):.2f},{20 + rise:.2f},22.0{more}")  # fmt: skip
    path.write_text("\n".join([head, *rows]) + "\n")
    return path


GRID = [(n, tau, "PAOR") for n in (100.0, 150.0, 200.0, 250.0) for tau in (1500.0, 2500.0)]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--causes", 1), "--causes 1: how many causes may act together. Give 2 to 8."),
        (("--causes", 9), "--causes 9: how many causes may act together. Give 2 to 8."),
        (("--repeatability", "foo"), '--repeatability "foo" is unknown. Give card or points.'),
        (("--repeatability", "points"), "DATA.csv: no points were repeated"),
    ],
)
def test_bad_options_end_with_exit_code_2(gearheat, tmp_path, options, said):
    answer = gearheat("diagnose", table(tmp_path / "DATA.csv", GRID), *options)
    assert answer.code == 2 and answer.out == "" and "Traceback" not in answer.err
    assert said in answer.err and len(answer.problems()) == 1


def test_all_bad_options_are_told_at_once(gearheat, tmp_path):
    answer = gearheat("diagnose", table(tmp_path / "DATA.csv", GRID), "--causes", 0, "--repeatability", "x")
    assert answer.code == 2 and len(answer.problems()) == 2


def test_the_card_takes_the_repeatability_of_points_when_asked(tmp_path):
    data = table(tmp_path / "DATA.csv", [*GRID, GRID[0], GRID[0]], warmer=6.0)
    stated, shown = (read_inputs(Request(data, repeatability=r)) for r in ("card", "points"))
    room = shown.card.channel("T_amb_C").repeat_sd
    oil = np.hypot(shown.card.channel("T_oil_C").repeat_sd, room)
    assert stated.card == Card() and oil == pytest.approx(np.sqrt(2 * (4 + 4 + 16) / 4))
    assert any("--repeatability points" in w for w in stated.warnings)
    assert not any("--repeatability points" in w for w in shown.warnings)


# ------------------------------------------------------------------------------------------------------------- starts


def starts(data: Path, card: Path | None = None) -> tuple[CampaignModel, float]:
    """A campaign on a rig that nobody runs, and how much lower tests start where the room probe reads 2 K too high."""
    inputs = read_inputs(Request(data, card=card))
    rig = SimpleNamespace(batch=SimpleNamespace(prepared=lambda *a: None))
    model = CampaignModel(rig, inputs.data, inputs.oils)
    plain, low = model._start([{}, {"read.room_bias": 2.0}], 0)[:, 0]
    each = np.zeros(len(model.tests))
    each[1] = 2.0
    by_test = [model._start([{"read.room_bias": each}], k)[0, 0] - model.runs[k].T_start for k in (0, 1)]
    assert by_test == pytest.approx([0.0, low - plain])
    return model, float(plain - low)


@pytest.mark.parametrize("key", ["T_start_minus_amb_K", "ambient_start_minus_reading_K"])
def test_a_start_that_follows_from_the_room_follows_its_probe(tmp_path, key):
    card = tmp_path / "CARD.json"
    card.write_text(json.dumps({"schema": "gearheat.card/1", "protocol": {key: 3.0}}))
    data = table(tmp_path / "DATA.csv", GRID)
    model, lower = starts(data, card)
    assert lower == pytest.approx(2.0) and model.runs[0].T_start == pytest.approx(273.15 + 25.0)
    assert model.tests[0].halves[0].values[BY_ROOM] == 1.0 and BY_ROOM not in model.tests[0].halves[1].values
    assert starts(data)[1] == pytest.approx(2.0)  # and the room itself, where nothing is stated


def test_a_start_that_was_measured_does_not(tmp_path):
    card = tmp_path / "CARD.json"
    card.write_text(json.dumps({"schema": "gearheat.card/1", "protocol": {"T_start_minus_amb_K": 3.0}}))
    data = table(tmp_path / "DATA.csv", GRID, ",31.0", HEAD + ",T_start_C")
    for given in (card, None):
        model, lower = starts(data, given)
        assert lower == 0.0 and model.runs[0].T_start == pytest.approx(273.15 + 31.0)


def test_a_room_measured_at_the_start_goes_before_the_card(tmp_path):
    card = tmp_path / "CARD.json"
    card.write_text(json.dumps({"schema": "gearheat.card/1", "protocol": {"T_start_minus_amb_K": 3.0}}))
    data = table(tmp_path / "DATA.csv", GRID, ",19.0", HEAD + ",T_amb_start_C")
    model, lower = starts(data, card)
    assert lower == pytest.approx(2.0) and model.runs[0].T_start == pytest.approx(273.15 + 22.0)


# ------------------------------------------------------------------------------------------------------------ courses


def course(minutes: float, every: float, stretched: float = 1.0):
    """Shares of a dwell at which samples were taken."""
    return np.arange(every, minutes * stretched + 1e-9, every) / minutes


def test_all_samples_count_and_a_smooth_course_stays_what_it_is():
    share = course(240.0, 5.0)
    places, W = logged._places(share)
    assert places.tolist() == list(logged.SHARES)
    for power in range(4):
        assert W @ share**power == pytest.approx(places**power, abs=1e-9)
    assert (np.abs(W) > 1e-6).sum(axis=1).min() > 10  # not two neighbours alone
    assert np.sqrt(np.diag(W @ W.T)).max() < 0.75 and np.sqrt(np.diag(W @ W.T)).mean() < 0.45


def test_few_samples_lie_on_lines_and_places_that_were_not_logged_are_left_out():
    share = course(90.0, 9.0)
    places, W = logged._places(share)
    assert places.tolist() == [p for p in logged.SHARES if p >= 0.1]
    assert W @ np.sin(3 * share) == pytest.approx(np.interp(places, share, np.sin(3 * share)))
    assert logged._places(np.empty(0))[1].shape == (0, 0)


def logged_test(first_dwell: float) -> list[logged.Sampled]:
    """Two halves of 240 and 90 minutes, logged every 5; the first as long as given; oil as its time in minutes."""
    halves = (reading(1, 1), replace(reading(2, 1, direction=2), values={**reading(2, 1).values, "dwell_min": 90.0}))
    one = np.arange(5.0, first_dwell + 1e-9, 5.0)
    two = first_dwell + 5.0 + np.arange(5.0, 90.0 + 1e-9, 5.0)
    time = np.concatenate([one, two])
    columns = {"time_s": 60 * time, "T_oil_C": time, "T_wall_C": 2 * time,
               "direction": np.repeat([1, 2], [len(one), len(two)])}  # fmt: skip
    series = Series("SERIES.csv", {1: columns})
    return logged.sampled(series, Test(1, 1, "PAOR", halves), 300.0)


def test_both_halves_of_a_test_are_reduced_to_places():
    one, two = logged_test(240.0)
    assert (one.dwell, two.dwell) == pytest.approx((240 * 60.0, 90 * 60.0)) and one.interval == 300.0
    assert one.T_oil == pytest.approx(273.15 + 240 * one.shares) and one.T_wall == pytest.approx(
        273.15 + 480 * one.shares
    )
    assert two.T_oil == pytest.approx(273.15 + 245 + 90 * two.shares)
    assert one.scatter == pytest.approx(one.weights @ one.weights.T)


def test_many_samples_are_averaged_in_groups():
    time = np.arange(1.0, 240.0 * 60 + 1)  # every second
    columns = {"time_s": time, "T_oil_C": time / 60, "T_wall_C": time / 30, "direction": np.ones(len(time), int)}
    (one,) = logged.sampled(Series("SERIES.csv", {1: columns}), Test(1, 1, "PAOR", (reading(1, 1),)), 300.0)
    assert len(one.when) == logged.MOST and one.count.sum() == len(time) and one.count.min() == 150
    assert one.T_oil == pytest.approx(273.15 + 240 * one.shares)
    assert np.diag(one.scatter).max() < 0.3 / 150 * 1.1  # hardly any noise is left


def test_behind_a_dwell_not_as_stated_there_are_no_places():
    one, two = logged_test(180.0)
    assert one.dwell == pytest.approx(180 * 60.0) and two.dwell == pytest.approx(90 * 60.0)
    assert len(one.shares) and one.shares.max() < 0.75 and not len(two.shares)
    assert two.scatter.shape == (0, 0) and len(two.when) == 0
    assert one.T_oil == pytest.approx(273.15 + 240 * one.shares)


def rows(n: int = 4, places: int = 6) -> Rows:
    """One test per two readings; places along the first half behind them."""
    which = np.concatenate([np.arange(n), np.zeros(places, dtype=int)])
    test = np.arange(n) // 2
    return Rows(
        test=test[which], order=(test / test.max())[which], direction=np.where(which % 2, -1.0, 1.0),
        w=np.full(n + places, 20.0), tau=np.full(n + places, 2000.0), T_room=np.full(n + places, 298.0),
        rise=np.full(n + places, 40.0), share=np.concatenate([np.ones(n), np.linspace(0.05, 0.85, places)]),
    )  # fmt: skip


def test_what_the_model_leaves_of_a_course_ends_as_that_of_its_readings():
    r, holds = rows(), {"T_oil": np.arange(4), "T_oil course": np.arange(4, 10)}
    at_end = replace(r, share=np.ones_like(r.share))
    left, ended = (remainder(Channels(holds), each) for each in (r, at_end))
    own = {name for name in left if "course" in name}
    assert own and all(not left[name][:4].any() for name in own)  # a reading is the end of its course
    assert all(not ended[name].any() for name in own)
    for name in left.keys() - own:
        assert left[name][4:] == pytest.approx(left[name][0])  # the same conditions
    # the first minutes may differ from all that comes later
    A = np.stack([left[name][4:] for name in sorted(own)], axis=1)
    first = np.eye(6)[0]
    sharp = A @ np.linalg.solve(A.T @ A + 0.01 * np.eye(A.shape[1]), A.T @ first)
    assert sharp[0] > 0.9 and np.abs(sharp[1:]).max() < 0.15


def test_values_along_courses_scatter_as_their_curve_does():
    r, card = rows(), Card()
    W = np.linalg.qr(np.random.default_rng(1).standard_normal((30, 6)))[0].T * 0.5
    W[1] = 0.8 * W[0] + 0.6 * W[1]
    holds = {"T_oil": np.arange(4), "T_oil course": np.arange(4, 10)}
    with_it, without = (instrument_covariance(Channels(holds, s), r, card)[0] for s in (W @ W.T, np.zeros((6, 6))))
    sd = card.channel("T_oil_C").repeat_sd
    assert (with_it - without)[4:, 4:] == pytest.approx(ALLOWED * sd**2 * W @ W.T)
    assert (with_it - without)[:4] == pytest.approx(np.zeros((4, 10)))
    assert np.linalg.eigvalsh(with_it).min() > 0
    room = card.channel("T_amb_C").repeat_sd
    assert with_it[0, 0] == pytest.approx(sd**2 + room**2)
    # a room that scatters moves the start as well, of the same half alone
    calm = card.model_copy(
        update={"channels": {"T_amb_C": card.channel("T_amb_C").model_copy(update={"repeat_sd": 0.0})}}
    )
    moved = with_it - instrument_covariance(Channels(holds, W @ W.T), r, calm)[0]
    assert moved[4, 4] > 0.6 * room**2 and np.diag(moved)[4:].min() < 0.35 * room**2
    assert moved[2:4, 4:] == pytest.approx(np.zeros((2, 6))) and moved[1, 4:] == pytest.approx(np.zeros(6))


# ------------------------------------------------------------------------------------------------------ the problem


class Toy(Problem):
    """A problem whose readings are a given function of its nuisances."""

    def __init__(self, shows, measured, names=("one",), scatter: float = 0.05, runs=lambda z: True) -> None:
        self.shows, self.measured, self.runs = shows, np.asarray(measured, dtype=float), runs
        self.parameters, self.noise = SimpleNamespace(names=names), scatter**2 * np.eye(len(measured))
        self.campaigns, self.costs = [], []

    def linearised(self, z, theta=None, causes=()):
        if not self.runs(z):
            raise SolveError("no")
        nominal = self.shows(z)
        J = np.stack([(self.shows(z + 1e-6 * u) - nominal) / 1e-6 for u in np.eye(len(z))], axis=1)
        r, none = self.measured - nominal + J @ z, np.zeros((len(nominal), 1))
        found = Linear(z, {}, nominal, r, self.noise + J @ J.T, J, self.noise, none, theta or {}, causes)
        r = self.measured - nominal
        self.costs.append(float(0.5 * r @ np.linalg.solve(self.noise, r) + 0.5 * z @ z))
        return found

    def moved(self, linear, z, theta, causes):
        if not self.runs(z):
            raise SolveError("no")
        return replace(linear, z=z, nominal=self.shows(z))


@pytest.mark.parametrize("begin", [1.2, -2.0, 0.6])
def test_the_calibration_goes_downhill_where_plain_steps_go_back_and_forth(begin):
    toy = Toy(lambda z: 2 * np.arctan(8 * z), [0.0])
    found = toy.settled(np.array([begin]))
    assert abs(found.z[0]) < 0.01
    assert (np.diff(toy.costs) <= 1e-6).all() and toy.costs[-1] < 0.1 * toy.costs[0]


def test_the_calibration_stays_where_the_model_can_be_run():
    toy = Toy(lambda z: 4.0 * z, [3.0], runs=lambda z: z[0] < 0.5)
    found = toy.settled(np.zeros(1))
    assert 0.2 < found.z[0] < 0.5
    free = Toy(lambda z: 4.0 * z, [3.0]).settled(np.zeros(1))
    assert free.z[0] == pytest.approx(3.0 / 0.05**2 * 4 / (16 / 0.05**2 + 1))


def acting(grids, share=None):
    """As much of a campaign as covariances ask for: one reading of each test."""
    n = len(grids)
    tests = [SimpleNamespace(halves=[SimpleNamespace(texts={"grid": g} if g else {})]) for g in grids]
    r = Rows(
        test=np.arange(n), order=np.linspace(0, 1, n), direction=np.where(np.arange(n) % 2, -1.0, 1.0),
        w=np.linspace(10.0, 26.0, n), tau=np.linspace(1500.0, 2700.0, n), T_room=np.full(n, 298.0),
        rise=np.full(n, 40.0), share=np.ones(n),
    )  # fmt: skip
    model = SimpleNamespace(tests=tests, rows=r, n=n)
    channels = SimpleNamespace(rows=np.arange(n))
    return SimpleNamespace(measured=np.zeros(n), channels=channels, model=model, acting=True)


def test_each_grid_of_a_campaign_has_losses_of_its_own():
    names = (*REFILLED, "area", "foundation")
    toy = Toy(lambda z: z, np.zeros(6), names)
    J = np.random.default_rng(2).standard_normal((6, len(names)))
    toy.campaigns = [acting("AABBBC")]
    found = toy._between_grids(J)
    own = J[:, : len(REFILLED)]
    for k, m in product(range(6), repeat=2):
        same = "AABBBC"[k] == "AABBBC"[m]
        assert found[k, m] == pytest.approx(CHANGED**2 * own[k] @ own[m] if same else 0.0)
    for grids in ("AAAAAA", [""] * 6):
        toy.campaigns = [acting(grids)]
        assert not toy._between_grids(J).any()
    toy.campaigns = [acting("AAA"), acting("BBB")]  # two campaigns of a grid each: what differs is the remainder's
    assert not toy._between_grids(J).any()


def test_effects_are_put_back_with_scatter_for_what_each_form_leaves():
    causes = [CAUSES["sensor.wall_temp.offset"], CAUSES["cooling.air"]]
    toy = Toy(lambda z: np.zeros(6), np.arange(6.0))
    toy.campaigns = [acting("AAAAAA")]
    G = np.random.default_rng(3).standard_normal((6, 2))
    toy.signatures = lambda linear, wanted: G[:, : len(wanted)]
    theta = {causes[0].id: {"offset": 2.0}, causes[1].id: {CAUSES["cooling.air"].size.name: -1.5}}
    linear = toy.linearised(np.zeros(1), theta, causes)
    effects = G * [2.0, -1.5]
    plain, rough = toy.put_back(linear, [0.0, 0.2])
    for back in (plain, rough):
        assert back.residual == pytest.approx(linear.residual + effects.sum(axis=1))
    assert plain.covariance == pytest.approx(linear.covariance)
    added = rough.covariance - linear.covariance
    assert np.diag(added) == pytest.approx(0.04 * (effects**2).sum(axis=1))
    assert added == pytest.approx(rough.noise - linear.noise) and np.linalg.eigvalsh(added).min() > -1e-12
    whole = 0.04 * effects @ effects.T
    assert abs(added[0, 5]) < 0.2 * abs(whole[0, 5]) and added[0, 5] * whole[0, 5] > 0  # far apart: hardly alike
    none = replace(linear, theta={causes[0].id: {"offset": 0.0}}, causes=causes[:1])
    assert toy.put_back(none, [0.0, 0.2, 0.3]) == [none] * 3


# ------------------------------------------------------------------------------------------------------- held-out folds


def folds(oils="AAAAAABB", rise=None, loss=None) -> SimpleNamespace:
    """As much of a search as schemes and rivals ask for: tests of two readings at four speeds and two torques."""
    n = len(oils)
    rpm, tau = np.array([100.0, 150.0, 200.0, 250.0] * 2)[:n], np.repeat([1500.0, 2500.0], 4)[:n]
    test = np.repeat(np.arange(n), 2)
    r = Rows(
        test=test, order=test / n, direction=np.tile([1.0, -1.0], n), w=np.repeat(rpm, 2) * np.pi / 30,
        tau=np.repeat(tau, 2), T_room=np.linspace(295.0, 300.0, 2 * n), rise=np.full(2 * n, 40.0), share=np.ones(2 * n),
    )  # fmt: skip
    tests = [SimpleNamespace(oil=oil) for oil in oils]
    readings = campaign(*(reading(k, k, n_carrier_rpm=100.0 + 10 * k) for k in range(1, 3)))
    model = SimpleNamespace(rows=r, tests=tests, n=2 * n, campaign=readings)
    rise = np.zeros(2 * n) if rise is None else rise(r)
    loss = np.full(2 * n, 40.0) if loss is None else loss(r)
    channels = Channels({"T_oil": np.arange(2 * n), "loss": np.arange(2 * n)})
    data = SimpleNamespace(model=model, channels=channels, measured=np.concatenate([r.T_room + rise, loss]))
    return SimpleNamespace(problem=SimpleNamespace(data=data, card=Card()))


def test_groups_hold_every_test_of_a_kind():
    search = folds()
    assert list(gain.groups(search, "leave-one-speed")) == [[0, 4], [1, 5], [2, 6], [3, 7]]
    assert list(gain.groups(search, "leave-one-load")) == [[0, 1, 2, 3], [4, 5, 6, 7]]
    assert list(gain.groups(search, "leave-one-oil")) == [[0, 1, 2, 3, 4, 5], [6, 7]]
    assert list(gain.groups(search, "first-oil-to-others")) == [[6, 7]]
    assert list(gain.groups(search, "leave-one-operating-point")) == [[k] for k in range(8)]


def test_only_schemes_that_leave_something_on_both_sides_are_told(monkeypatch):
    monkeypatch.setattr(gain, "gain", lambda search, leading, seed, scheme: scheme)
    assert gain.gains(folds(), [], 0) == gain.SCHEMES
    search = folds("AAAAAAAA")
    assert gain.gains(search, [], 0) == ("leave-one-speed", "leave-one-load")
    assert gain.gains(folds("AAAA"), [], 0) == ("leave-one-speed",)


def test_rivals_are_exact_where_their_assumption_holds():
    power = lambda r: 40.0 + 0.01 * r.tau * r.direction  # noqa: E731
    kept = np.arange(16) < 10
    by_loss = folds(rise=lambda r: 0.3 * np.abs(power(r) * r.w), loss=power)
    by_conditions = folds(rise=lambda r: 3.0 + 1.2 * r.w + 0.01 * r.tau, loss=power)
    cases = [
        (gain.constant_cooling, by_loss, by_conditions), (gain.linear_in_conditions, by_conditions, by_loss)
    ]  # fmt: skip
    for rival, its_own, other in cases:
        assert np.abs(rival(its_own, kept, ~kept)).max() < 1e-9
        assert gain.rms(rival(other, kept, ~kept)) > 0.5


def test_the_noise_floor_is_that_of_repeated_points_where_there_are_some():
    search = folds(rise=lambda r: np.full(len(r.w), 40.0))
    card, c = search.problem.card, search.problem.data
    by_card = np.sqrt(card.channel("T_oil_C").repeat_sd ** 2 + card.channel("T_amb_C").repeat_sd ** 2
                      + (card.day_cooling_sd * 40.0) ** 2)  # fmt: skip
    assert gain.noise_floor(search) == pytest.approx(by_card)
    c.model.campaign = campaign(*(reading(k, k, 60.0 + 2 * (-1) ** k) for k in range(1, 5)))
    assert gain.noise_floor(search) == pytest.approx(np.sqrt(16 / 3))


@pytest.mark.parametrize("count", [1, 2, 3])
def test_a_fold_predicts_what_was_held_out_by_the_causes_that_act(count):
    rng = np.random.default_rng(5)
    parts = [family(n, k, forms=3, length=40.0) for k, n in enumerate(TWO_SIDED[:count])]
    sizes = [1.0, -1.2, 0.8][:count]
    r = 0.3 * rng.standard_normal(M) + sum(
        f.signatures[:, 1] * x * f.cause.size.sd for f, x in zip(parts, sizes, strict=True)
    )
    white = White.of(r, np.eye(M))
    parts = tuple(f.seen(white) for f in parts)
    none = np.zeros((M, 1))
    linear = Linear(np.zeros(1), {}, np.zeros(M), r, np.eye(M), none, np.eye(M), none)
    kept, held = np.arange(0, 30), np.arange(30, M)
    view = gain.View(linear, ((log(0.5), ()), (log(0.1), parts)))
    (without, before), (with_it, after) = gain.seen(view, kept, held)
    assert before == pytest.approx(r[held])
    assert gain.rms(after) < 0.6 < 2.0 < gain.rms(before) and with_it > without + 50
    blind = r.copy()
    blind[held] += 100.0  # what was held out has no say in the choice
    again = list(gain.seen(replace(view, linear=replace(linear, residual=blind)), kept, held))
    assert [value for value, _ in again] == pytest.approx([without, with_it])
    assert again[1][1] - after == pytest.approx(np.full(len(held), 100.0))


def test_points_without_repetition_are_refused_before_any_work(tmp_path):
    with pytest.raises(DataError, match="no points were repeated"):
        read_inputs(Request(table(tmp_path / "DATA.csv", GRID), repeatability="points"))
