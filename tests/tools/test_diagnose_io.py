"""Around the inference of `diagnose`: files in, JSON, page, predictions and extended rig out, with made-up findings."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from gearheat.model.core.flatten import flatten
from gearheat.model.errors import DataError, GearheatError
from gearheat.model.machines.spec import assemble
from gearheat.scenarios.measured import schedule_of
from gearheat.scenarios.write import rig_text
from gearheat.tools.diagnose import words
from gearheat.tools.diagnose.command import Outputs, command
from gearheat.tools.diagnose.extension import extended, extended_text
from gearheat.tools.diagnose.findings import UNEXPLAINED, Estimate, Experiment, Findings, Gain, Joint, Named
from gearheat.tools.diagnose.infer import verdict_of
from gearheat.tools.diagnose.inputs import Request, read_inputs
from gearheat.tools.diagnose.memory import Memory, fingerprint, memory_of
from gearheat.tools.diagnose.output import as_object, schema, show
from gearheat.tools.diagnose.predictions import predictions_text
from gearheat.tools.diagnose.report import render
from gearheat.tools.diagnose.superset import superset
from gearheat.tools.diagnose.weigh import outside, with_outside
from gearheat.tools.effects.taxonomy import CAUSES
from gearheat.tools.losses import oil_values
from gearheat.tools.rigs import load
from gearheat.tools.settings import loaded

SPEEDS, TORQUES = (100.0, 150.0, 200.0, 250.0), (1500.0, 2500.0)
HEAD = "point,test,order,direction,dwell_min,oil,n_carrier_rpm,T_carrier_Nm,T_sun_Nm,T_oil_C,T_wall_C,T_amb_C"
OIL = {"nu40": 320.0, "nu100": 25.0, "rho15": 870.0, "alpha_T": 6e-4}
SHAPES = {"a": 2.1, "b": 0.2, "oil_share": 0.8, "regime": 0.6, "threshold": 0.3}


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


def line(point: int, test: int, order: int, direction: int, n: float, tau: float, oil: str = "PAOR") -> str:
    loss = 20.0 + 0.005 * tau
    sun = (tau - loss) / 4 if direction == 1 else (tau + loss) / 4
    rise = 5.0 + 0.1 * n + 0.005 * tau
    dwell = 240 if direction == 1 else 90
    return f"{point},{test},{order},{direction},{dwell},{oil},{n},{tau},{sun:.2f},{22 + rise:.2f},{20 + rise:.2f},22.0"


def table(path: Path, oil: str = "PAOR", tests: int = 8, head: str = HEAD, more: str = "") -> Path:
    """Tests in another running order than their rows stand in."""
    rows = []
    for k, (n, tau) in enumerate((n, tau) for n in SPEEDS for tau in TORQUES):
        rows += [line(2 * k + d, k + 1, (5 * k) % 8 + 1, d, n, tau, oil) + more for d in (1, 2)]
    path.write_text("\n".join([head, *rows[: 2 * tests]]) + "\n")
    return path


@pytest.fixture
def data(tmp_path) -> Path:
    return table(tmp_path / "DATA.csv")


@pytest.fixture
def card(tmp_path):
    def write(**entries: object) -> Path:
        path = tmp_path / "CARD.json"
        path.write_text(json.dumps({"schema": "gearheat.card/1", **entries}))
        return path

    return write


def made_up(inputs, causes=("losses.churning",), verdict: str = "explained") -> Findings:
    """Findings as an inference might give them."""
    theta = {c: {CAUSES[c].size.name: CAUSES[c].size.sd, **{s.name: s.mean for s in CAUSES[c].shapes}} for c in causes}
    if "losses.churning" in theta:
        theta["losses.churning"] = {"P_ref": 62.0, **SHAPES}
    rest = [c for c in CAUSES if c not in causes]
    named = [
        Named(c, 0.94, 11.0, (Estimate(CAUSES[c].size.name, 62.0, 50.0, 74.5, CAUSES[c].size.unit),)) for c in causes
    ]
    if causes:
        named[0] = replace(named[0], regime={"n_carrier_rpm": (148.0, None)})
    rest_named = [Named(c, 0.03 if k == 0 else 0.0, math.inf if k == 1 else 4.5) for k, c in enumerate(rest)]
    n = len(inputs.data.readings)
    measured = np.linspace(310.0, 350.0, n)
    off = np.linspace(-4.0, 1.0, n)
    return Findings(
        verdict=verdict, alpha=0.05, p_any=0.0004, p_omnibus=0.012, p_adequacy=0.41, draws=4000,
        hypotheses=(Joint(tuple(causes), 0.94, theta), Joint((rest[0],), 0.03), Joint((), 0.01)),
        causes=(*named, *rest_named),
        confusable=((*causes, "losses.windage", "losses.oil_level"), ("cooling.air",)),
        impact={"T_oil_K": (3.21, 2.7, 3.8), "T_wall_K": (2.9, 2.4, 3.4), "loss_Nm": (4.4, 3.9, 5.0)},
        gain=Gain("leave-one-operating-point", "T_oil_C", 2.41, 0.52, (0.17, 0.31), 0.44, n),
        next_experiment=(Experiment("fast", "four points at 400 rpm", ("losses.churning", "cooling.air"), 1.9, 6.3),),
        warnings=("no card",),
        nominal={"cooling.A": 0.43, "gear_set.k_mu": 1.05}, extended={"cooling.A": 0.44, "read.room_bias": 0.1},
        rows={"T_oil": (measured, measured + off, measured + 0.1 * off), "loss": (off + 30, 29 + 2 * off, off + 30.2)},
    )  # fmt: skip


@pytest.fixture
def inputs(data):
    return read_inputs(Request(data))


def fake(findings_of=made_up):
    """An inference that takes no time."""

    def infer(inputs, alpha, seed, progress):
        progress("search", 0.5)
        temperatures = lambda c: np.array([50.0 + r.point for t in c.tests() for r in t.halves])  # noqa: E731
        return replace(findings_of(inputs), alpha=alpha), lambda c: (temperatures(c), temperatures(c) + 2.0)

    return infer


# -------------------------------------------------------------------------------------------------------------- inputs


def test_inputs_hold_everything_and_say_what_cannot_be_seen(inputs):
    assert len(inputs.data.readings) == 16 and inputs.reference is None and inputs.points is None
    assert inputs.oils["PAOR"]["oil.nu_40"] == pytest.approx(324.38e-6)
    assert {"cooling.humidity", "sensor.oil_temp.position", "procedure.day_scatter"} <= set(inputs.invisible)
    assert any("humidity_pct" in w for w in inputs.warnings) and any("no card" in w for w in inputs.warnings)


def test_optional_columns_make_causes_visible_and_unknown_ones_warn(tmp_path):
    path = table(tmp_path / "D.csv", head=f"{HEAD},T_oil2_C,date,humidity_pct,humdity", more=",44,2020-01-01,50,1")
    inputs = read_inputs(Request(path))
    assert set(inputs.invisible) == {"thermal.mass"}
    assert any('"humdity" is not used' in w for w in inputs.warnings)


def test_card_states_protocol_oil_and_lubrication(tmp_path, card):
    stated = card(
        protocol={"stop_min": 12, "T_start_minus_amb_K": 3, "ambient_start_minus_reading_K": -1},
        oil=OIL, lubrication={"gears": "oil", "bearings": "oil", "needles": "grease"}, chanels={}, prior_sd={"mju": 1},
    )  # fmt: skip
    inputs = read_inputs(Request(table(tmp_path / "D.csv", oil="VG 320"), card=stated))
    run = schedule_of(inputs.data, inputs.data.tests()[0])
    assert run.T_start == pytest.approx(273.15 + 22 - 1 + 3)
    assert run.schedule.values["room.T"][0] == pytest.approx(273.15 + 21)
    assert run.schedule.time[3] - run.schedule.time[2] == pytest.approx(12 * 60)
    own = inputs.spec.part("oil").values
    oil = inputs.oils["VG 320"]
    assert oil["oil.nu_100"] == pytest.approx(25e-6) and oil["oil.alpha_T"] == -6e-4 and oil["oil.X_L"] == own["X_L"]
    (net,) = (n for n in inputs.spec.connections if "oil.lubricant" in n)
    assert {"carrier_bearing.lubricant", "sun_bearing.lubricant"} <= set(net)
    assert "planet_bearing.lubricant" not in net
    assert any('Did you mean "channels"' in w for w in inputs.warnings)
    assert any('Did you mean "mu"' in w for w in inputs.warnings)
    flatten(assemble(inputs.spec))


def test_start_columns_overrule_the_card(tmp_path, card):
    path = table(tmp_path / "D.csv", head=f"{HEAD},T_start_C,T_amb_start_C", more=",30,25")
    inputs = read_inputs(Request(path, card=card(protocol={"T_start_minus_amb_K": 9})))
    assert schedule_of(inputs.data, inputs.data.tests()[0]).T_start == pytest.approx(303.15)


def test_all_parts_may_run_in_oil(data, card):
    inputs = read_inputs(Request(data, card=card(lubrication={"bearings": "oil", "needles": "oil"})))
    assert not [net for net in inputs.spec.connections if "grease.lubricant" in net]
    flatten(assemble(inputs.spec))


def test_prose_as_protocol_means_the_defaults(data, card):
    inputs = read_inputs(Request(data, card=card(protocol="240 min, a short stop, 90 min")))
    assert inputs.data.protocol.stop == 300.0
    assert any("in words" in w for w in inputs.warnings)


def test_another_oil_on_the_card_than_in_the_catalogue_warns(data, card):
    assert any("VG" not in w and "catalogue" in w for w in read_inputs(Request(data, card=card(oil=OIL))).warnings)


def test_problems_of_all_files_come_at_once(tmp_path, card):
    bad = tmp_path / "DATA.csv"
    bad.write_text("\n".join([HEAD, line(1, 1, 1, 3, 100, 1500), line(2, 1, 1, 2, 100, 1500, "PAOX")]) + "\n")
    reference = table(tmp_path / "REF.csv")
    reference.write_text(reference.read_text().replace("22.0\n", "322.0\n", 1))
    series = tmp_path / "S.csv"
    series.write_text("test,time_s,direction,n_carrier_rpm,T_carrier_Nm,T_oil_C,T_wall_C,T_amb_C\n1,0,5,1,1,1,1,1\n")
    points = table(tmp_path / "P.csv", head=HEAD.replace("dwell_min", "dwell"))
    request = Request(
        bad, "planetry", card(lubrication={"wheels": "oil"}, prior_sd={"mu": -1}), series, reference, None, points
    )
    with pytest.raises(DataError) as error:
        read_inputs(request)
    text = "\n".join(error.value.problems)
    for word in (
        'direction = "3"', '"PAOX"', "REF.csv line 2", "Celsius", 'S.csv line 2: direction = "5"', '"dwell_min"',
        '"planetry"', "prior_sd.mu",
    ):  # fmt: skip
        assert word in text, word


@pytest.mark.parametrize(
    ("entries", "word"),
    [
        ({"lubrication": {"wheels": "oil"}}, '"wheels"'),
        ({"lubrication": {"bearings": "water"}}, '"water"'),
        ({"lubrication": {"gears": "grease"}}, "not modelled"),
        ({"oil": {"nu40": 0.00032, "nu100": 0.00002}}, "mm2/s"),
        ({"oil": {"nu40": 30, "nu100": 40}}, "thinner"),
        ({"protocol": {"dwell_min": [0, 90]}}, "dwell_min"),
        ({"protocol": {"stop_min": -1}}, "stop_min"),
        ({"schema": "other/1"}, "schema"),
    ],
)
def test_cards_that_are_wrong(data, card, entries, word):
    with pytest.raises(DataError, match=re.escape(word)):
        read_inputs(Request(data, card=card(**entries)))


def test_unknown_oils_need_one_card_for_one_name(tmp_path, card):
    with pytest.raises(DataError, match='unknown oil "VG 320"'):
        read_inputs(Request(table(tmp_path / "D.csv", oil="VG 320")))
    other = table(tmp_path / "R.csv", oil="VG 220")
    with pytest.raises(DataError, match="VG 220, VG 320"):
        read_inputs(Request(table(tmp_path / "D.csv", oil="VG 320"), card=card(oil=OIL), reference=other))


def test_a_table_too_small_to_say_anything_is_refused(tmp_path):
    with pytest.raises(DataError, match="4 readings of 2 tests are too few"):
        read_inputs(Request(table(tmp_path / "D.csv", tests=2)))


def test_a_rig_of_another_layout_is_refused(data):
    with pytest.raises(GearheatError, match="helical_two_stage"):
        read_inputs(Request(data, rig="helical_two_stage"))


def test_series_belong_to_their_tests_and_run_forward(tmp_path, data):
    head = "test,time_s,direction,n_carrier_rpm,T_carrier_Nm,T_oil_C,T_wall_C,T_amb_C"
    good, bad = tmp_path / "S.csv", tmp_path / "B.csv"
    good.write_text(f"{head}\n1,0,1,100,1500,22,22,22\n1,300,1,100,1500,24,23,22\n2,0,1,100,2500,22,22,22\n")
    inputs = read_inputs(Request(data, series=good))
    assert inputs.series.samples == 3 and list(inputs.series.tests[1]["time_s"]) == [0, 300]
    assert any("6 of 8 tests were not logged" in w for w in inputs.warnings)
    bad.write_text(f"{head}\n1,300,1,100,1500,22,22,22\n1,0,1,100,1500,24,23,22\n99,0,1,100,2500,22,22,22\n")
    with pytest.raises(DataError, match=r"(?s)line 3: time goes back in test 1.*no test 99"):
        read_inputs(Request(data, series=bad))


def test_the_digest_follows_every_file(tmp_path, data, card):
    first = read_inputs(Request(data)).digest
    assert read_inputs(Request(data)).digest == first
    assert read_inputs(Request(data, card=card())).digest != first
    data.write_text(data.read_text().replace("22.0\n", "22.1\n", 1))
    assert read_inputs(Request(data)).digest != first


# -------------------------------------------------------------------------------------------------------------- output


@pytest.mark.parametrize(
    ("causes", "verdict"),
    [
        (("losses.churning",), "explained"),
        ((), "consistent"),
        (("sensor.torque.offset", "cooling.air"), "ambiguous"),
        (("losses.churning",), "unexplained"),
    ],
)
def test_the_object_fits_its_schema_and_the_screen_names_the_verdict(inputs, capsys, causes, verdict):
    findings = made_up(inputs, causes, verdict)
    made = json.loads(json.dumps(as_object(findings), allow_nan=False))
    jsonschema.Draft202012Validator(schema()).validate(made)
    assert made["verdict"] == verdict and sum(h["probability"] for h in made["hypotheses"]) <= 1.0
    assert [c["id"] for c in made["causes"]] == [c.id for c in findings.causes]
    assert "detectable" not in next(c for c in made["causes"] if c["id"] == findings.causes[len(causes) + 1].id)
    assert all(len(group) > 1 for group in made["confusable"])
    show(findings)
    screen = capsys.readouterr().out
    assert words.verdict(findings) in screen and len(screen.splitlines()) < 30
    assert all(words.name_of(c) in screen for c in causes) or verdict == "consistent"


def test_every_cause_has_a_plain_name():
    assert not [c for c in CAUSES if c not in words.NAMES]


def test_probabilities_that_add_up_to_one_still_do_after_rounding(inputs):
    thirds = tuple(Joint((c,), 1 / 3) for c in list(CAUSES)[:3])
    made = as_object(replace(made_up(inputs), hypotheses=thirds))
    assert sum(h["probability"] for h in made["hypotheses"]) <= 1.0


def test_the_page_is_whole_and_the_same_each_time(inputs):
    findings = made_up(inputs)
    page = render(inputs, findings)
    assert page == render(inputs, findings)
    assert page.count("<svg") == 1 and "{{" not in page and "None" not in re.sub(r"<svg.*?</svg>", "", page, flags=re.S)
    assert not re.search(r'(?:src|href)="(?!#)', re.sub(r"<svg.*?</svg>", "", page, flags=re.S))
    for words_ in ("churning of the oil", "carrier speed above 148 rpm", "four points at 400 rpm", "94 %", "3.2 K"):
        assert words_ in page, words_


def test_the_page_of_a_clean_campaign_shows_what_would_have_been_seen(inputs):
    page = render(inputs, made_up(inputs, (), "consistent"))
    assert "<details open><summary>Smallest size" in page and "after, direction" not in page


# --------------------------------------------------------------------------------------- predictions, extended rig


def test_predictions_stand_in_the_order_of_the_points(tmp_path, data):
    points = table(tmp_path / "P.csv")
    inputs = read_inputs(Request(data, predict=points))
    _, predictor = fake()(inputs, 0.05, 0, lambda stage, share: None)
    lines = predictions_text(inputs.points, predictor).splitlines()
    assert lines[0] == "point,T_oil_nominal_C,T_oil_extended_C"
    assert lines[1:] == [f"{p},{50 + p:.4f},{52 + p:.4f}" for p in range(1, 17)]


def test_the_extended_rig_loads_with_what_was_found(inputs, tmp_path):
    findings = made_up(inputs)
    path = tmp_path / "OUT.toml"
    path.write_text(extended_text(inputs, findings))
    rig = load(path)
    part = rig.spec.part("found_churning")
    assert part.values["P_ref"] == 62.0 and part.values["a"] == 2.1
    assert part.values["w_on"] > 0 and part.values["w_side"] == 1.0  # only above a speed
    assert rig.spec.part("cooling").values["A"] == 0.44
    assert rig.value_sources["found_churning.P_ref"] == "inferred: diagnosis of DATA.csv, losses.churning"
    assert rig.value_sources["cooling.A"] == "calibrated: diagnosis of DATA.csv"
    assert rig.losses["P_found_churning_W"] == ("found_churning.P",)
    assert "found_churning.P" in flatten(assemble(rig.spec)).index
    assert extended_text(inputs, findings) == extended_text(inputs, findings)


def test_an_extended_rig_can_be_diagnosed_and_extended_again(inputs, data, tmp_path):
    path = tmp_path / "OUT.toml"
    path.write_text(extended_text(inputs, made_up(inputs)))
    again = read_inputs(Request(data, rig=str(path)))
    twice = extended(again, made_up(again)).scenario
    assert {"found_churning", "found_churning_2"} <= {part.name for part in twice.spec.parts}
    flatten(assemble(twice.spec))


@pytest.mark.parametrize("cause", sorted(CAUSES))
def test_every_cause_goes_into_the_rig_or_into_a_comment(inputs, cause):
    findings = made_up(inputs, (cause,))
    extension = extended(inputs, findings)
    calibrated = replace(findings, hypotheses=(), extended=findings.extended)
    plain = extended(inputs, replace(calibrated, nominal=findings.extended)).scenario
    changed = repr(extension.scenario.spec.parts) != repr(plain.spec.parts)
    assert changed != bool(extension.outside)
    assert changed or cause in extended_text(inputs, findings).partition("kind =")[0]


def test_every_command_takes_the_extended_rig(inputs, tmp_path, gearheat):
    path = tmp_path / "OUT.toml"
    path.write_text(extended_text(inputs, made_up(inputs)))
    plain, more = (
        gearheat("steady", "planetary", "--set", "carrier.w=250 rpm", *options, "--json", "-").json["values"]
        for options in ((), ("--extended", path))
    )
    assert more["found_churning.P"] > 50 and more["efficiency.P_loss"] > plain["efficiency.P_loss"]
    rig = loaded("planetary", path)
    assert len(rig.campaign.readings) == 72 and "found_churning.P_ref" in rig.settable()
    assert len(loaded("planetary", path, tmp_path / "DATA.csv").campaign.readings) == 16


def test_a_viscosity_that_was_found_holds_for_every_test(inputs, tmp_path):
    path = tmp_path / "OUT.toml"
    path.write_text(extended_text(inputs, made_up(inputs, ("losses.oil_viscosity",))))
    rig = load(path)
    assert rig.spec.part("oil").values["nu_40"] > 1.3 * inputs.oils["PAOR"]["oil.nu_40"]
    taken = oil_values(rig, rig.protocol, "PAOR")
    assert "oil.rho_15" in taken and not {"oil.nu_40", "oil.nu_100"} & set(taken)


def test_without_an_alarm_the_rig_is_calibrated_and_nothing_is_added(inputs):
    findings = replace(made_up(inputs), verdict="consistent")
    rig = extended(inputs, findings).scenario
    assert not [part for part in rig.spec.parts if part.name.startswith("found_")]
    assert rig.spec.part("cooling").values["A"] == 0.43


# -------------------------------------------------------------------------------------------------- outside the library


def unexplained(inputs, verdict="unexplained", best=0.2, causes=("losses.churning",)) -> Findings:
    """Findings of which the likeliest is that the library lacks the cause."""
    findings = made_up(inputs, causes, verdict)
    first, *others = findings.hypotheses
    hypotheses = (Joint((UNEXPLAINED,), 0.7), replace(first, probability=best), *others)
    named = (Named(UNEXPLAINED, 0.7, math.inf), *findings.causes)
    return replace(findings, hypotheses=hypotheses, causes=named, played={"T_oil": (2.0, 1.0)})


def test_what_is_missing_to_one_is_outside_the_library():
    found = [Joint(("a",), 0.5), Joint((), 0.1), Joint(("b",), 0.03)]
    assert [j.causes for j in with_outside(found)] == [("a",), (UNEXPLAINED,), (), ("b",)]
    assert with_outside(found)[1].probability == pytest.approx(0.37)
    assert with_outside([Joint(("a",), 0.996)]) == [Joint(("a",), 0.996)]
    assert outside([Joint(("a",), 0.6), Joint((), 0.4 + 1e-12)]) == 0.0


def test_what_the_library_lacks_explains_nothing():
    lacks, one = Joint((UNEXPLAINED,), 0.95), Joint(("losses.churning",), 0.95)
    assert verdict_of(True, lacks, 0.5) == "unexplained" and verdict_of(False, lacks, 0.5) == "consistent"
    assert verdict_of(True, one, 0.5) == "explained" and verdict_of(True, one, 0.001) == "unexplained"


def test_the_model_is_extended_by_the_best_of_the_library(inputs, capsys):
    findings = unexplained(inputs)
    assert words.applied(findings).causes == words.top(findings).causes == ("losses.churning",)
    assert "found_churning" in {part.name for part in extended(inputs, findings).scenario.spec.parts}
    said = words.verdict(findings)
    assert "most probably outside the library (70 %)" in said and "churning of the oil (20 %)" in said
    assert "leaves more than noise" in words.verdict(replace(findings, p_adequacy=0.001))
    result = as_object(findings)
    jsonschema.validate(result, schema())
    assert result["hypotheses"][0] == {"causes": [UNEXPLAINED], "probability": 0.7}
    assert result["causes"][0] == {"id": UNEXPLAINED, "probability": 0.7, "parameters": []}
    show(findings)
    page, screen = render(inputs, findings), capsys.readouterr().out
    assert said in page.replace("&gt;", ">") and "something outside the library" in page
    assert said in screen.replace("\n", " ") and UNEXPLAINED in screen


def test_nothing_extends_the_model_where_the_best_of_the_library_is_no_cause(inputs):
    findings = unexplained(inputs, causes=())
    findings = replace(findings, extended=findings.nominal)
    assert words.applied(findings) is None and "found_" not in extended_text(inputs, findings)
    assert words.verdict(findings) == "Something is wrong, most probably outside the library (70 %)."
    assert words.verdict(unexplained(inputs, "consistent")).startswith("Nothing beyond")
    assert words.applied(unexplained(inputs, "consistent")) is None


def test_what_the_library_lacks_is_one_of_what_is_left_open(inputs):
    assert "something outside the library (70 %)" in words.verdict(unexplained(inputs, "ambiguous"))


# ------------------------------------------------------------------------------------------------------ command, memory


def run(tmp_path, data, infer=None, alpha=0.05, **files):
    outputs = Outputs(tmp_path / "O.csv", str(tmp_path / "O.json"), tmp_path / "O.html", tmp_path / "O.toml")
    command(Request(data, predict=data, **files), outputs, alpha, 3, infer or fake())
    return outputs


def test_the_command_writes_all_its_files_the_same_each_time(tmp_path, data, capsys):
    outputs = run(tmp_path, data)
    before = {name: path.read_bytes() for name, path in outputs.files().items()}
    assert len(before) == 4 and json.loads(before["--json"])["schema"] == "gearheat.diagnosis/1"
    run(tmp_path, data)
    assert before == {name: path.read_bytes() for name, path in outputs.files().items()}
    assert " 50 %  search" in capsys.readouterr().err
    assert not list((tmp_path / "cache" / "gearheat" / "diagnose").iterdir())


def test_wrong_options_come_with_wrong_files_before_any_work(tmp_path, data):
    def never(*arguments):
        raise AssertionError("work began")

    outputs = Outputs(None, str(data), tmp_path / "no" / "O.html", tmp_path / "no" / "O.html")
    with pytest.raises(DataError) as error:
        command(Request(tmp_path / "missing.csv", card=data, predict=data), outputs, 1.5, -1, never)
    text = "\n".join(error.value.problems)
    for word in (
        "--alpha",
        "--seed",
        "--predictions",
        "no such file",
        "no JSON",
        "cannot be written",
        "file of --report",
    ):
        assert word in text, word


def test_the_program_knows_the_command(gearheat, tmp_path, data):
    answer = gearheat("diagnose", data, "--card", tmp_path / "no.json", "--rig", "planetry", "--predictions", "p.csv")
    assert answer.code == 2 and answer.out == "" and "Traceback" not in answer.err
    for word in ("no.json", "planetry", "--predict"):
        assert word in answer.err


def test_an_interrupted_diagnosis_goes_on_where_it_was(tmp_path, data, capsys):
    made = []

    def infer(stop):
        def work(inputs, alpha, seed, progress):
            for k in range(4):
                progress(f"stage {k}", k / 4)
                if k == stop:
                    raise KeyboardInterrupt
                inputs.memory.kept(("stage", k, {"x": np.arange(3.0)}), lambda k=k: made.append(k) or {"y": np.ones(k)})
            return fake()(inputs, alpha, seed, progress)

        return work

    with pytest.raises(KeyboardInterrupt):
        run(tmp_path, data, infer(2))
    assert made == [0, 1] and "goes on from there" in capsys.readouterr().err
    run(tmp_path, data, infer(9))
    assert made == [0, 1, 2, 3]
    assert "was interrupted" in capsys.readouterr().err


def test_memory_keeps_bits_and_tells_things_apart(tmp_path):
    values = {"a": np.array([0.1, np.nan, -0.0]), "b": np.arange(6).reshape(2, 3)}
    first = Memory(tmp_path / "m.kept")
    first.kept([1, "x"], lambda: values)
    second = Memory(tmp_path / "m.kept")
    found = second.kept([1, "x"], lambda: pytest.fail("computed again"))
    assert all(found[k].tobytes() == values[k].tobytes() and found[k].dtype == values[k].dtype for k in values)
    assert second.reused == 1
    assert len({fingerprint(w) for w in (1, 1.0, "1", [1], [[1]], {"1": 1}, np.array([1]), np.array([1.0]), None)}) == 9
    assert fingerprint({"a": 1, "b": 2}) == fingerprint({"b": 2, "a": 1})


def test_memory_that_cannot_be_kept_is_done_without(tmp_path, monkeypatch):
    (tmp_path / "blocked").write_text("a file, no folder")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "blocked"))
    memory = memory_of("digest")
    assert memory.kept("x", lambda: {"y": np.ones(2)})["y"].sum() == 2.0
    memory.forget()
    (tmp_path / "bad.kept").write_bytes(b"no database at all, but long enough to be looked at as one" * 20)
    assert Memory(tmp_path / "bad.kept").kept("x", lambda: {"y": np.ones(2)})["y"].sum() == 2.0


def test_a_rig_with_every_cause_is_read_back_as_it_was_written(tmp_path):
    rig = load("planetary")
    everything = replace(rig, spec=superset(rig.spec), entries={}, overrides=(), campaign=None)
    path = tmp_path / "all.toml"
    path.write_text(rig_text(everything), encoding="utf-8")
    found = {part.name: part for part in load(path).spec.parts}
    for part in (part for part in everything.spec.parts if part.name.startswith("extra_")):
        assert found[part.name].values == pytest.approx(part.values)
