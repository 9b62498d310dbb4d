"""The bench hides what its truth says, shows nothing of it, and scores answers as the bars are meant."""

import csv
import importlib
import json
import math
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from challenge import cases, foreign, forms, model_rig, practice, rig, scoring
from challenge.__main__ import app
from challenge.answers import Answer, Hypothesis, ask_command, read_answer
from challenge.bench import RULES, run, tasks
from challenge.classes import classes_of
from challenge.hide import APART, SHARES, schedule
from challenge.plan import draw_plan
from challenge.printing import show
from challenge.scoring import Outcome, metrics, report, score, wilson
from challenge.sheets import SHEETS
from challenge.signal_to_noise import Noise, Rivals, snr_of
from gearheat.model.errors import DataError
from gearheat.model.run.schedule import join_phases
from gearheat.model.run.simulate import simulate as run_model
from gearheat.model.run.steady import steady_table
from gearheat.scenarios.load import load
from typer.testing import CliRunner

KELVIN = 273.15
PRACTICE = Path(__file__).parent / "practice_cases"

# ------------------------------------------------------------------------------------------------------ simulators


def test_own_rig_is_the_model() -> None:
    """Without faults the columns are what the project's integrator gives for the same protocol."""
    plan = draw_plan(np.random.default_rng(3), warm_start=True)
    shown = rig.run(model_rig.rig_of("planetary"), 7, plan, {}, ())
    scenario = load("planetary")
    flat = scenario.spec.driven({"carrier": ("w", "tau")}).flat()
    j = 6
    begin, first, second = plan.room[:, j] + KELVIN
    restart = first + (second - first) * plan.stop[j] / (plan.stop[j] + plan.dwell[1, j])
    w, tau = plan.n[0, j] * math.pi / 30, plan.load[0, j]
    duty = join_phases(
        [
            (14400.0, {"carrier.w": w, "carrier.tau": tau, "room.T": (begin, first)}),
            (60.0 * plan.stop[j], {"carrier.w": 0.0, "carrier.tau": 0.0, "room.T": (first, restart)}),
            (5400.0, {"carrier.w": w, "carrier.tau": -tau, "room.T": (restart, second)}),
        ]
    )
    draught = {"room.air_speed": scenario.operating_point["room.air_speed"]}
    start = {q.name: plan.start[j] + KELVIN for q in flat.states}
    ends = [14400.0, 14400.0, duty.stop]
    wanted = run_model(flat, duty, start=start, values=draught, times=ends)
    got = dict(zip(rig.CHANNELS, shown[:, :, j], strict=True))
    assert got["T_oil_C"] + KELVIN == pytest.approx(wanted["oil.T"][[0, -1]], abs=0.02)
    assert got["T_wall_C"] + KELVIN == pytest.approx(wanted["wall.T"][[0, -1]], abs=0.02)
    assert got["T_sun_Nm"] == pytest.approx(np.abs(wanted["sun.tau"][[0, -1]]), abs=0.02)


@pytest.mark.parametrize("name", ["helical_two_stage", "harmonic"])
def test_steady_points_are_steady_states_and_a_loss_brakes_as_much_as_it_heats(name: str) -> None:
    """With the heat of a hidden loss the model gets as warm, and its shafts lack the same power."""
    d, machine = model_rig.draw_steady(np.random.default_rng(1), name), model_rig.rig_of(name).machine
    fault = d.draw("losses.churning", "single", np.full((2, 16), 40.0), np.random.default_rng(2))
    scenes: list[rig.Scene] = []
    act = fault.stages["act"]
    seen = replace(fault, stages={"act": lambda s, a: (act(s, a), scenes.append(s))})
    shown = d.run(d.plan, {}, [(seen, slice(None), np.full(16, 20.0))])[:, 1]
    heat = {place: machine.power * machine.loss * q for place, q in scenes[-1].heat.items()}
    w, tau, other = machine.ends
    speed, load_torque = machine.speed * d.plan.n[1] * math.pi / 30, -machine.torque * d.plan.load[1]
    columns = {w: speed, tau: load_torque, "room.T": d.plan.room[2] + KELVIN}
    columns |= {f"{b}.Q_flow_external": heat[p] for p, b in zip(("oil", "gears"), machine.bodies, strict=False)}
    points = [dict(zip(columns, values, strict=True)) for values in zip(*columns.values(), strict=True)]
    wanted = steady_table(load(name).spec.flat(), points)
    assert shown[3] + KELVIN == pytest.approx(wanted["oil.T"], abs=1e-3)
    assert (machine.other * shown[2] - wanted[other]) * speed == pytest.approx(sum(heat.values()), rel=1e-3)
    assert (sum(heat.values()) > 1.0).any()


@pytest.mark.parametrize("seed", range(6))
def test_foreign_rigs_conserve_energy(seed: int) -> None:
    """In the end the surface gives the room what the torques lack; heat paths and capacities only spread it."""
    r, plan = foreign.ForeignRig(foreign.draw_sizes(np.random.default_rng(seed))), draw_plan(np.random.default_rng(9))
    long = replace(plan, dwell=np.full_like(plan.dwell, 6000.0), room=np.full_like(plan.room, 22.0))
    seen: list[tuple[np.ndarray, rig.Scene]] = []
    rate = r.rate
    r.rate = lambda T, scene: seen.append((T, scene)) or rate(T, scene)
    shown = rig.run(r, 7, long, {}, ())
    T, scene = [s for s in seen if (s[1].direction == 1).all() and (s[1].n > 0).all()][-1]
    given = r.cooling(T[foreign.NODES[r.nodes]["surface"]], scene)
    lost = (shown[1, 0] - 4 * shown[2, 0]) * long.n[0] * math.pi / 30
    assert given == pytest.approx(lost, rel=2e-3)


@pytest.fixture(scope="module")
def drawn() -> tuple[cases.Drawn, Noise]:
    d = SHEETS["foreign"](np.random.default_rng(5))
    return d, Noise(cases.setting(d))


def oil(d: cases.Drawn, noise: Noise) -> np.ndarray:
    return noise.healthy[d.instruments.channels.index("T_oil_C")]


def test_columns_do_not_know_each_other(drawn: tuple[cases.Drawn, Noise]) -> None:
    """Two faults side by side in copies of a campaign do what they do alone."""
    d, noise = drawn
    faults = [d.draw(c, "single", oil(*drawn), np.random.default_rng(1)) for c in ("losses.churning", "cooling.air")]
    both = noise.signatures(faults, np.array([150.0, 0.3]))
    for i, fault in enumerate(faults):
        assert both[i] == pytest.approx(noise.signatures([fault], np.array([(150.0, 0.3)[i]]))[0], abs=1e-9)


@pytest.mark.parametrize("cause", [*forms.CAUSES, *forms.OUTSIDE])
def test_every_cause_shows(cause: str, drawn: tuple[cases.Drawn, Noise]) -> None:
    """Some sensible amount of it has a signal-to-noise ratio above the band's lower end."""
    d, noise = drawn
    kind = "outside" if cause in forms.OUTSIDE else "single"
    reached, wanted = 0.0, 0.2 if cause == "thermal.split" else 5.0  # after four hours hardly any of it is left
    for seed in range(6):
        if reached > wanted:
            break
        fault = d.draw(cause, kind, oil(*drawn), np.random.default_rng(seed))
        snr, sensible = noise.survey(fault, fault.signs[0] * fault.high * np.array([0.1, 0.3, 1.0]))
        reached = max(reached, snr[sensible].max(initial=0.0))
    assert reached > wanted


@pytest.mark.parametrize("cause", forms.REGIMES)
def test_regimes_limit(cause: str, drawn: tuple[cases.Drawn, Noise]) -> None:
    """Limited, a fault does less than everywhere."""
    d, noise = drawn
    rngs = (np.random.default_rng(2) for _ in range(2))
    everywhere, limited = (d.draw(cause, k, oil(*drawn), r) for k, r in zip(("single", "regime"), rngs, strict=True))
    change = noise.signatures([everywhere, limited], np.full(2, 0.2 * everywhere.high))
    size = np.abs(change).sum(axis=(1, 2, 3))
    assert limited.regime and 0.0 < size[1] < size[0]


# ------------------------------------------------------------------------------------------- signal-to-noise ratio


def test_a_lone_offset_has_its_closed_form() -> None:
    """A reference shares the instruments' tolerances, so an offset is told by its readings' scatter alone."""
    d = SHEETS["foreign"](np.random.default_rng(5))
    quiet = {c: 1e-6 for c in d.prior}
    s = replace(cases.setting(d), prior=quiet, day_sd=1e-9)
    noise = Noise(replace(s, reference=None))
    fault = d.draw("sensor.wall_temp.offset", "single", np.zeros(2), np.random.default_rng(0))
    snr, _ = noise.survey(fault, np.array([1.0]))
    n, repeat, fixed = 2 * d.plan.columns, s.repeat_sd["T_wall_C"], s.offset_sd["T_wall_C"]
    assert snr[0] < 1.0 / math.hypot(repeat / math.sqrt(n), fixed)
    with_reference = Noise(replace(s, offset_sd=dict.fromkeys(s.offset_sd, 1e3)))
    assert with_reference.survey(fault, np.array([1.0]))[0][0] > 3.0 * 0.5 / repeat


def test_look_alikes_are_near_and_others_far(drawn: tuple[cases.Drawn, Noise]) -> None:
    """Drag of bearings and seals are one class; a torque's zero is far from churning."""
    d, noise = drawn
    rng = np.random.default_rng(3)

    def rival(called: str, cause: str) -> float:
        rivals = Rivals(noise, {called: partial(d.draw, cause, "single", oil(*drawn))}, rng)
        return rivals.nearest(churning, 150.0)[1].distance

    churning = d.draw("losses.churning", "single", oil(*drawn), rng)
    assert (
        rival("called otherwise", "losses.churning") < 0.2 < 10 < rival("sensor.torque.offset", "sensor.torque.offset")
    )


def test_rivals_of_a_limited_fault_are_limited_as_well(drawn: tuple[cases.Drawn, Noise]) -> None:
    """Above a speed only, a seal's drag is nearer to churning above that speed than to churning everywhere.

    Churning may act there only, too, where the fault is not known to be limited.
    """
    d, noise = drawn
    rng = np.random.default_rng(3)
    faults = (d.draw("losses.seal_drag", "regime", oil(*drawn), rng) for _ in range(200))
    limited = next(f for f in faults if f.regime.get("speed") == "above")

    def distance(fault: Any, called: str = "other") -> float:
        family = partial(d.draw, "losses.churning", "single", oil(*drawn))
        return Rivals(noise, {called: family}, np.random.default_rng(4)).nearest(fault, 8.0)[1].distance

    at, width = limited.regime["threshold"], limited.regime["width"]
    acting = noise.share(limited.regime, oil(*drawn))
    inside, outside = d.plan.n > at + 3 * width, d.plan.n < at - 3 * width
    assert inside.any() and (acting[inside] > 0.99).all() and outside.any() and (acting[outside] < 0.01).all()
    assert (noise.share({"speed": "above", "threshold": d.plan.n, "width": width}, oil(*drawn)) == 0.5).all()
    everywhere = replace(limited, regime={})
    assert max(distance(limited), distance(everywhere, "losses.churning")) < 0.9 * distance(everywhere)


def test_what_scatters_from_test_to_test_is_as_loud_as_its_likelihood_says() -> None:
    """Half the squared signal-to-noise is the mean log likelihood ratio, as it is for a known signature."""
    n, m = 40, 0.7
    u = np.sqrt(1 + m) * np.random.default_rng(6).standard_normal((20000, n))
    ratios = 0.5 * (u**2 * m / (1 + m) - np.log1p(m)).sum(axis=1)
    length = math.sqrt(n * m)
    assert snr_of("procedure.day_scatter", length, n) ** 2 / 2 == pytest.approx(ratios.mean(), rel=0.02)
    assert snr_of("cooling.air", length, n) == length


# ------------------------------------------------------------------------------------------------------------ cases


def test_schedule() -> None:
    kinds = [schedule(1, 4, k)[0] for k in range(150)]
    assert {kind: kinds.count(kind) for kind in SHARES} == {kind: 6 * n for kind, n in SHARES.items()}


def read(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def make(sheet: str, folder: Path, seed: int = 3, k: int = 2, **what: str) -> dict:
    return cases.make_case(SHEETS[sheet], list(SHEETS).index(sheet), seed, k, folder, **what)


def test_only_the_data_tell(tmp_path: Path) -> None:
    """All else that the diagnosis gets is the same whether something is hidden or not."""
    make("foreign", tmp_path / "ill", kind="weak", cause="cooling.air")
    make("foreign", tmp_path / "well", kind="clean")
    ill, well = ({p.name: p.read_bytes() for p in (tmp_path / n / "case").iterdir()} for n in ("ill", "well"))
    assert [name for name in sorted(ill.keys() | well.keys()) if ill.get(name) != well.get(name)] == ["DATA.csv"]


def test_same_seed_same_bytes_and_the_truth_holds(tmp_path: Path) -> None:
    """A sensor's step is its whole impact, and lies at the points to predict where it lies in the campaign."""
    for name in "ab":
        truth = make("textbook", tmp_path / name, kind="single", cause="sensor.wall_temp.since")
    files = [{p.name: p.read_bytes() for p in (tmp_path / n).rglob("*") if p.is_file()} for n in "ab"]
    assert files[0] == files[1]
    step = truth["effects"][0]["amount"]
    assert 0.0 < truth["impact"]["T_wall_K"] / step < 1.0
    assert truth["impact"]["T_oil_K"] == truth["impact"]["loss_Nm"] == 0.0
    assert all(p["T_oil_C"] == p["T_oil_without_C"] for p in truth["points"])
    assert truth["effects"][0]["snr"] > 5.0 and truth["rival"]["distance"] >= APART


def test_the_own_rig_has_no_reference(tmp_path: Path) -> None:
    truth = make("own", tmp_path, kind="clean")
    assert {p.name for p in (tmp_path / "case").iterdir()} == {"DATA.csv", "CARD.json", "POINTS.csv"}
    assert truth["answer"] == [] and truth["gross"] == {} and len(read(tmp_path / "case/DATA.csv")) == 32


def test_gross_readings_stand_where_the_truth_says(tmp_path: Path) -> None:
    """Rows are missing, and the gross reading is far from the same campaign without it."""
    truths = [make("textbook", tmp_path / str(k), seed=7, k=k, kind="clean") for k in range(6)]
    assert any(len(read(tmp_path / str(k) / "case/DATA.csv")) < 32 for k in range(6))
    k, gross = next((k, t["gross"]["DATA"]) for k, t in enumerate(truths) if "DATA" in t["gross"])
    row = read(tmp_path / str(k) / "case/DATA.csv")[gross["row"] - 1]
    assert int(row["point"]) == gross["point"]
    sd = json.loads((tmp_path / str(k) / "case/CARD.json").read_text())["channels"][gross["channel"]]["repeat_sd"]
    assert 12.0 <= abs(gross["by"]) / sd <= 25.1


# ------------------------------------------------------------------------------------------------------------ scores


def write_answer(
    place: Path, verdict: str, hypotheses: list, impact: dict, points: list, quality: dict | None = None
) -> None:
    said = {"verdict": verdict, "hypotheses": hypotheses, "impact": impact}
    said |= {"data_quality": quality} if quality else {}
    (place / "RESULT.json").write_text(json.dumps(said), encoding="utf-8")
    lines = [f"{p},{a},{b}\n" for p, a, b in points]
    (place / "PREDICTIONS.csv").write_text("point,T_oil_nominal_C,T_oil_extended_C\n" + "".join(lines))


def oracle(rig: str, files: Mapping[str, Path], place: Path) -> None:
    """Reads the key; names what has a name."""
    truth = practice.truth(files["data"].parent)
    hypotheses = [{"causes": truth["answer"] + ["model.unexplained"], "probability": 0.97}]
    points = [(p["point"], p["T_oil_without_C"], p["T_oil_C"]) for p in truth["points"]]
    gross = [{"row": g["row"], "channel": g["channel"]} for g in truth["gross"].values()]
    write_answer(place, "explained", hypotheses, truth["impact"], points, {"gross": gross})


def always_sure(rig: str, files: Mapping[str, Path], place: Path) -> None:
    """Is always sure of the same wrong thing."""
    write_answer(place, "explained", [{"causes": ["model.nonsense"], "probability": 0.99}], {"T_oil_K": 5.0}, [])


def fail(rig: str, files: Mapping[str, Path], place: Path) -> None:
    """Breaks down."""
    raise RuntimeError("no idea")


def score_practice(who: object, place: Path) -> dict[str, scoring.Metric]:
    found = run(tasks("practice", 9, 0, place, given=PRACTICE, diagnose=who), jobs=2)
    assert [o.case for o in found] == sorted(p.name for p in PRACTICE.iterdir())
    return {m.name: m for m in metrics(found)}


def test_the_oracle_reaches_every_bar(tmp_path: Path) -> None:
    found = score_practice(oracle, tmp_path)
    assert all(m.ambitious_met in (True, None) for m in found.values())
    assert found["exact name first"].value == 1.0
    assert found["gross reading named by row and channel"].value == 1.0
    assert found["held-out RMSE after/before, median"].value == pytest.approx(0.0, abs=1e-9)


def test_sure_and_wrong_costs(tmp_path: Path) -> None:
    found = score_practice(always_sure, tmp_path)
    assert found["detection"].value == 1.0
    assert found["exact name first"].value == 0.0
    assert found["single or regime wrong with > .9"].value == 1.0
    assert found["held-out RMSE after/before, median"].value == 1.0


def test_no_answer_counts_as_missed(tmp_path: Path) -> None:
    found = score_practice(fail, tmp_path)
    assert found["detection"].value == 0.0
    assert found["size of the 90 % set, mean"].value is None


def test_a_run_goes_on_where_it_stopped(tmp_path: Path) -> None:
    asked: list[str] = []

    def counted(rig: str, files: Mapping[str, Path], place: Path) -> None:
        asked.append(place.parent.name)
        write_answer(place, "consistent", [{"causes": [], "probability": 1.0}], {}, [])

    first = run(tasks("textbook", 2, 6, tmp_path, kind="clean", diagnose=counted), jobs=1)
    again = run(tasks("textbook", 3, 6, tmp_path, kind="clean", diagnose=counted), jobs=1)
    assert asked == ["0000", "0001", "0002"]
    assert again[:2] == first and not any(o.alarm for o in again)


def outcome(k: int, kind: str, truth: str, top: str, distance: float | None = 5.0) -> Outcome:
    got = {"p_truth": 0.5, "p_top": 0.5, "answered": True, "alarm": True, "exact": truth == top, "shared": 1}
    rest = {
        "hidden": 1,
        "claimed": 1,
        "covered": True,
        "size": 1,
        "sure_wrong": False,
        "impact_error": None,
        "gain": None,
        "gross": None,
    }
    return Outcome("own", str(k), kind, 9.0, distance, truth, top, **got, **rest, seconds=2.0 + k)


def test_what_is_near_counts_by_the_set() -> None:
    near = outcome(0, "single", "a", "b", 2.9)
    sure = replace(outcome(1, "alike", "a", "b", 1.0), covered=False, sure_wrong=True)
    named = outcome(2, "single", "c", "c")
    found = {m.name: m for m in metrics([near, sure, named])}
    told = found["nearer than 3 sigma: truth in the 90 % set"]
    assert (told.value, told.n, told.must) == (0.5, 2, 0.88)
    assert found["nearer than 3 sigma: wrong with > .9"].value == 0.5
    assert (found["exact name first"].value, found["exact name first"].n) == (1.0, 1)
    assert found["detection"].n == 3


def truth_of(*causes: str, kind: str = "single") -> dict:
    return {
        "case": 0,
        "kind": kind,
        "answer": sorted(classes_of(causes)),
        "effects": [{"snr": 9.0}] * len(causes),
        "impact": {"T_oil_K": 2.0, "loss_Nm": 0.0},
        "repeat_sd": {"T_oil_K": 0.5, "loss_Nm": 1.0},
        "points": [{"point": i, "T_oil_C": 52.0, "T_oil_without_C": 50.0} for i in (1, 2)],
    }


def answer(*hypotheses: tuple[tuple[str, ...], float], verdict: str = "explained", **rest: dict) -> Answer:
    ranked = tuple(Hypothesis(classes_of(causes), p) for causes, p in hypotheses)
    names = {name for h in ranked for name in h.names}
    chances = {name: sum(h.probability for h in ranked if name in h.names) for name in names}
    return Answer(verdict, ranked, chances=chances, **rest)


def test_look_alikes_are_one_answer(tmp_path: Path) -> None:
    hypotheses = [
        {"causes": ["cooling.air"], "probability": 0.4},
        {"causes": ["losses.seal_drag"], "probability": 0.3},
        {"causes": ["losses.bearing_preload", "model.unexplained"], "probability": 0.25},
    ]
    write_answer(tmp_path, "ambiguous", hypotheses, {"T_oil_K": {"value": 2.5}, "loss_Nm": 0.0}, [])
    found = score(truth_of("losses.seal_drag"), read_answer(tmp_path), 1.0)
    assert found.exact and found.covered and found.size == 2
    assert found.p_truth == pytest.approx(0.55)
    assert found.impact_error == pytest.approx(0.25)
    assert found.gain == 1.0  # no predictions, no gain


def test_sets_pairs_and_certainty() -> None:
    pair = truth_of("cooling.air", "losses.churning", kind="pair")
    half = score(pair, answer((("losses.windage",), 0.95)), 1.0)
    assert not half.exact and half.shared == 1 and half.sure_wrong
    full = score(pair, answer((("losses.windage", "cooling.air"), 0.95)), 1.0)
    assert full.exact and full.shared == 2 and not full.sure_wrong
    three = (("losses.windage", "cooling.air"), 0.3), (("losses.windage", "cooling.contact"), 0.4)
    likely = score(truth_of("cooling.air", "losses.churning", kind="several"), answer(*three), 1.0)
    assert (likely.shared, likely.claimed) == (1, 1)
    unnamed = score(truth_of("outside.crosstalk", kind="outside"), answer((("model.unexplained",), 0.99)), 1.0)
    assert unnamed.alarm and not unnamed.sure_wrong
    wide = score(truth_of("cooling.air"), answer((("cooling.contact",), 0.5), (("cooling.air",), 0.45)), 1.0)
    assert wide.covered and wide.size == 2 and not wide.exact and not wide.sure_wrong
    fair = score(truth_of("x.fan", kind="outside") | {"fair": ["cooling.air"]}, answer((("cooling.air",), 0.99)), 1.0)
    assert fair.exact and not fair.sure_wrong


def test_gain_is_the_error_at_the_points() -> None:
    told = answer((("cooling.air",), 0.95), nominal={1: 50.0, 2: 50.0}, extended={1: 51.5, 2: 52.5})
    assert score(truth_of("cooling.air"), told, 1.0).gain == pytest.approx(0.25)


def test_wilson_intervals() -> None:
    """Values of the score interval without continuity correction: Newcombe 1998, table I, 81 of 263, 15 of 148, ..."""
    for hits, n, low, high in ((81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611)):
        assert wilson(hits, n) == pytest.approx((low, high), abs=5e-5)
    assert wilson(29, 29) == pytest.approx((0.8830, 1.0), abs=5e-5)
    assert wilson(0, 0) == (0.0, 1.0)


def test_command_refuses_what_it_cannot_do(tmp_path: Path) -> None:
    for words, said in (
        (["--sheet", "own", "--only", "claen"], 'Did you mean "clean"'),
        (["--sheet", "machines", "--only", "severe"], "Kinds: clean, single, several."),
        (["--sheet", "practice", "--only", "claen", "--practice", str(tmp_path)], 'Did you mean "clean"'),
        (["--sheet", "own", "--n", "0"], "at least one case"),
        (["--sheet", "own", "--off", "exchang"], 'Did you mean "exchange"'),
        (["--sheet", "practice"], "--practice FOLDER"),
        (["--sheet", "practice", "--practice", str(tmp_path)], "no campaigns"),
    ):
        answer = CliRunner().invoke(app, words)
        assert answer.exit_code == 2 and said in answer.stderr


def test_rules_that_can_be_off_are_constants_of_the_inference() -> None:
    for rule in RULES.values():
        assert rule["says"]
        for name, value in rule["set"].items():
            module, _, constant = name.rpartition(".")
            own = getattr(importlib.import_module(f"gearheat.tools.diagnose.{module}"), constant)
            assert isinstance(own, (int, float, tuple)) and own != value, name


def test_report_counts(capsys: pytest.CaptureFixture[str]) -> None:
    outcomes = [outcome(0, "single", "a", "b"), outcome(1, "single", "a", "a"), outcome(2, "weak", "a", "b")]
    found = report([*outcomes, replace(outcomes[0], sheet="foreign")], 3)
    assert found["sheets"] == {"own": 3, "foreign": 1}
    assert found["seconds"]["median"] == 2.5
    json.dumps(found)
    show(found)
    printed = capsys.readouterr().out
    assert all(m["name"] in printed for m in found["metrics"])
    assert "0.33" in printed and "missed" in printed  # exact name: one of three


def test_a_question_is_a_process_of_its_own(tmp_path) -> None:
    """What the command refuses is the command's word, not that of a program which does not begin."""
    data = tmp_path / "DATA.csv"
    data.write_text("n_carrier_rpm\n100\n", encoding="utf-8")
    with pytest.raises(DataError, match=r"ended with code 2: (?!.*(Import|Attribute)Error)"):
        ask_command("planetary", {"data": data}, tmp_path)
    assert float((tmp_path / "SECONDS").read_text(encoding="utf-8")) > 0
