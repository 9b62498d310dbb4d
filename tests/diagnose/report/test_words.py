"""The first screen: plain sentences that agree with the probabilities beside them."""

import re

import pytest
from fabricated_findings import (
    AIR,
    CHURNING,
    KINDS,
    OFFSET,
    ambiguous,
    cause,
    clean,
    explained,
    findings,
    spoiled,
    unexplained,
)
from gearheat.tools.diagnose.answer.evidence import DataQuality, Estimate, NuisanceOff, ResidualMean
from gearheat.tools.diagnose.answer.findings import (
    Alarm,
    Answer,
    Cause,
    CauseSet,
    Channel,
    FormShare,
    Gain,
    Hypothesis,
    Impact,
    Played,
    Remainder,
    RemainderChannel,
    Said,
)
from gearheat.tools.diagnose.report import phrases, tables
from gearheat.tools.diagnose.report.page import render
from gearheat.tools.diagnose.report.phrases import name_of, names_of
from gearheat.tools.diagnose.report.screen import text
from gearheat.tools.diagnose.report.words import contradictions, with_words


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_printed_is_plain(kind: str) -> None:
    said = text(KINDS[kind](), everything=True)
    assert not re.search(r"\d[eE]-?\d\d", said), "nobody reads 2.7e-190"
    assert not re.search(r"\bnan\b|\bNone\b|\binf\b|array\(", said)
    assert "  ." not in said
    assert "((" not in said


@pytest.mark.parametrize("kind", KINDS)
def test_the_first_screen_is_a_screen(kind: str) -> None:
    lines = text(KINDS[kind]()).splitlines()
    assert len(lines) <= 30
    assert max(map(len, lines)) <= 110


@pytest.mark.parametrize("kind", KINDS)
def test_sound_findings_do_not_contradict_themselves(kind: str) -> None:
    assert contradictions(KINDS[kind]()) == []


def test_a_clean_campaign_names_no_cause() -> None:
    said = clean().says
    assert said.verdict == "The data agree with the model within the stated accuracies."
    assert said.do == "Nothing needs doing."
    assert said.size == ""
    assert "93 ± 1 %" in said.sure


def test_a_rig_that_is_off_as_filed_does_not_simply_agree() -> None:
    one = clean()

    def said(above: float, reference: str = "") -> Said:
        quality = one.data_quality.model_copy(update={"as_filed": {"T_oil": above}})
        about = one.about.model_copy(update={"reference": reference})
        return with_words(one.model_copy(update={"about": about, "data_quality": quality})).says

    assert said(36.0).verdict.endswith("once it is calibrated; as filed it is off: T_oil lies 36 K above it.")
    assert "--reference-logs" in said(-1.2).do and "1.2 K below it" in said(-1.2).verdict
    agrees = said(36.0, reference="healthy.csv")
    assert (agrees.verdict, agrees.do) == (one.says.verdict, "Nothing needs doing.")


def test_an_explanation_names_its_class_and_its_size_in_degrees_and_watts() -> None:
    said = explained().says
    assert said.verdict == "One cause explains the data: churning of the oil or windage (97 ± 1 %)."
    assert "2.1 K higher (1.8 to 2.4)" in said.size
    assert "118 W higher (100 to 131)" in said.size
    assert "p < 1e-6" in said.sure
    assert "zero error of the torque transducer" in said.cannot_be
    assert "windage" not in said.cannot_be.partition(".")[0], "what is named is not ruled out"


def test_a_set_is_left_open_with_the_experiment_that_closes_it() -> None:
    said = ambiguous().says
    assert "leave open what: cooling by the air (55 ± 3 %); cooling by radiation (41 ± 3 %)" in said.verdict
    assert "some points in a room of 5 degC" in said.do


def test_look_alikes_that_the_data_rule_out_are_not_left_open() -> None:
    one = Answer(causes=((CHURNING,),), probability=0.96)
    alike = CauseSet(causes=(CHURNING, "losses.windage", "sensor.torque.offset"), distance=0.8)
    said = explained(answers=(one,), sets=(alike,)).says.cannot_be
    assert "cannot tell churning of the oil from windage but by how usual the sizes are." in said


def test_what_may_act_beside_the_answer_is_left_open() -> None:
    both = Hypothesis(causes=(CHURNING, OFFSET), probability=0.3)
    made = explained(hypotheses=(Hypothesis(causes=(CHURNING,), probability=0.67), both))
    assert "Whether others act as well is left open: zero error" in made.says.verdict
    assert "(30 %)" in made.says.verdict


def test_what_is_outside_the_library_names_its_channel() -> None:
    said = unexplained().says
    assert "no cause of the library explains (94 %), seen in T_oil (1.9 K)" in said.verdict
    assert "closest known cause is churning of the oil (5 %)" in said.verdict


def test_the_data_come_before_the_cause() -> None:
    said = spoiled().says
    assert said.do.startswith("Check the reading in row 17 (T_oil)")
    assert said.data[0].startswith("Row 17 (line 18, point 17): T_oil shows 84.2 °C, the other readings say 71.3 °C")
    assert "A reading of T_amb scatters by 1 K; the card says 0.4 K (2.5 times)." in said.data[1]
    assert "smaller than its stated scatter (p = 0.998)" in said.data[2]
    assert said.verdict.endswith(
        "Beside it the rig differs from its file: heat capacity of the gears (0.17 times that of the file,"
        " 4.2 prior standard deviations down)."
    )


def test_a_value_far_from_its_file_is_in_the_verdict_of_clean_data() -> None:
    off = NuisanceOff(name="bearing loss", z=2.4, factor=1.36, paths=("bearing_a.k", "bearing_a.f"))
    said = clean(data_quality=DataQuality(nuisances=(off,))).says
    assert said.verdict == (
        "The data agree with the model only with values far from those of its file: bearing loss of bearing_a (1.36"
        " times that of the file, 2.4 prior standard deviations up)."
    )
    assert "Nothing" not in said.do
    assert said.do.startswith("Check these values of the rig")


def test_no_smallest_size_is_told_of_a_scatter() -> None:
    """No design judges it; that it was found says how large it is."""
    walk = Cause(id="sensor.oil_temp.random_walk", probability=0.0, usual=0.6, unit="K")
    quiet = (Hypothesis(causes=(), probability=0.95),)
    found = findings("consistent", hypotheses=quiet, causes=(cause(AIR, 0.0), walk))
    (smallest,) = (t for t in tables.sets(found) if t.title.startswith("Smallest"))
    assert [row[0] for row in smallest.rows] == ["cooling by the air"]
    assert "wandering" not in found.says.cannot_be


def test_nothing_and_something_never_both_have_more_than_half() -> None:
    assert "nothing and something both have more than half" in contradictions(
        clean().model_copy(update={"causes": (cause(AIR, 0.6),)})
    )


@pytest.mark.parametrize("nothing", [0.0, 0.07, 0.1, 0.31, 0.49])
@pytest.mark.parametrize("kind", [ambiguous, unexplained])
def test_something_is_wrong_or_may_be_as_nothing_is_probable(kind, nothing: float) -> None:
    known = kind().hypotheses
    left = tuple(h.model_copy(update={"probability": (1 - nothing) * h.probability}) for h in known if h.causes)
    found = kind(hypotheses=(*left, Hypothesis(causes=(), probability=nothing)))
    several = found.model_copy(update={"answers": (Answer(causes=((CHURNING,), (AIR,), (OFFSET,)), probability=0.5),)})
    single = found.model_copy(update={"answers": found.answers[:1]})
    for said in (with_words(one).says.verdict for one in (found, several, single)):
        assert ("may be wrong" in said or "may act" in said) == (nothing >= 0.1)
        assert f", or nothing is wrong ({100 * nothing:.0f} %)" in said or nothing < 0.1


def test_a_runner_up_is_in_the_verdict_of_no_cause() -> None:
    known = (Hypothesis(causes=(), probability=0.52), Hypothesis(causes=(AIR,), probability=0.47))
    said = with_words(clean().model_copy(update={"hypotheses": known, "causes": (cause(AIR, 0.47),)})).says
    assert said.verdict.endswith("within the stated accuracies. Not excluded: cooling by the air (47 %).")
    assert said.do == "To test what is not excluded: blow at the housing."


def test_what_the_calibrated_rig_leaves_comes_first() -> None:
    means = [
        ResidualMean(
            channel="T_oil", unit="K", by=("mounting", "speed"), cell=(m, n), n=6, mean=v, sd=0.2, stands_out=v > 1
        )
        for m, n, v in (("A", "100 rpm", 0.1), ("A", "200 rpm", 0.2), ("B", "100 rpm", 0.1), ("B", "200 rpm", 2.1))
    ]
    found = explained(residuals=tuple(means))
    said = text(found, everything=True)
    assert said.startswith("stands out Against the calibrated rig, before any cause: T_oil lies 2.1 K above it at")
    assert "mounting B, speed 200 rpm (n = 6, " in found.says.stands_out
    rows = [line.split() for line in said.splitlines() if "2.1 !" in line]
    assert rows == [["B", "+0.1", "(6)", "+2.1", "!", "(6)"]]
    assert render(found).index("2.1 !") < render(found).index("One cause explains")
    assert text(explained()).startswith("verdict")


def test_what_all_answers_of_several_causes_share_is_said_first() -> None:
    groups = ((CHURNING, "losses.windage"), (AIR,), (OFFSET,))
    answers = (
        Answer(causes=groups, probability=0.7),
        Answer(causes=(*groups[:1], groups[2], ("cooling.emissivity",)), probability=0.2),
    )
    causes = (cause(OFFSET, 0.97), cause(CHURNING, 0.8), cause("losses.windage", 0.1), cause(AIR, 0.7))
    made = ambiguous(answers=answers, causes=(*causes, cause("cooling.emissivity", 0.2)), sets=())
    assert made.says.verdict == (
        "Several causes act together. In all likely answers: zero error of the torque transducer (97 %), churning of"
        " the oil or windage (90 %). More likely than not: cooling by the air (70 %). Perhaps: cooling by radiation (20"
        " %)."
    )


def test_unlikely_causes_are_counted_not_listed() -> None:
    ids = ("a", "b", "c", "d")
    causes = (cause(CHURNING, 0.86), *(cause(OFFSET, 0.02).model_copy(update={"id": f"mine.{i}"}) for i in ids))
    found = explained(causes=causes, answers=(Answer(causes=((CHURNING,),), probability=0.96),))
    assert "each of 4 further causes at most" in render(found)
    assert "mine.a" not in render(found)[: render(found).index("further causes at most")]
    alone = render(explained(causes=causes[:2], answers=found.answers))
    assert "1 further cause" in alone and "1 further causes" not in alone
    answers = (0.5, 0.3, 0.04, 0.03, 0.03)
    left_open = ambiguous(answers=tuple(Answer(causes=((AIR,),), probability=p) for p in answers)).says.verdict
    assert left_open.endswith("; or one of 3 less probable ones (10 % together).")


def test_look_alikes_that_the_data_settle_are_in_no_table() -> None:
    assert "Cannot be told apart" in text(explained(), everything=True), "windage has 1 %"
    settled = explained(causes=(cause(CHURNING, 0.999),), answers=(Answer(causes=((CHURNING,),), probability=0.999),))
    assert "Cannot be told apart" not in text(settled, everything=True)


def test_a_size_at_its_bound_is_no_headline() -> None:
    said = explained(causes=(cause(CHURNING, 0.96, at_bound="high"), cause("losses.windage", 0.01))).says
    assert "One cause explains" not in said.verdict
    assert "only at the limit of the size" in said.verdict
    assert "at its upper bound" in said.size


def test_a_remainder_beside_a_named_cause_is_said() -> None:
    left = Remainder(probability=0.9, channels=(RemainderChannel(channel="T_wall", rms=0.8, unit="K"),))
    said = explained(remainder=left).says
    assert "One cause explains" in said.verdict
    assert "Something that the library lacks acts beside it, seen in T_wall (0.8 K)." in said.verdict


def test_an_extension_that_is_worse_is_told_first() -> None:
    played = {"T_oil": Played(rms_calibrated=2.7, rms_extended=2.9, unit="K")}
    oil = next(c for c in explained().channels if c.name == "T_oil")
    said = explained(played=played, gain=None).says
    assert said.do.startswith("Played over these data the extended rig is worse")
    assert "Do not use the extended rig" in said.do
    within = explained(played=played, gain=None, channels=[oil.model_copy(update={"offset_sd": 3.0})])
    assert "extended rig" not in within.says.do, "an error within the tolerance of the instrument"


def test_what_goes_both_ways_is_told_for_single_points() -> None:
    oil = Impact(value=0.19, ci95=(0.1, 0.28), single=(-2.8, 4.3), unit="K", what="oil temperature")
    assert (
        phrases.impact(oil) == "oil temperature 0.19 K higher (0.1 to 0.28; 2.8 lower to 4.3 higher at single points)"
    )
    assert phrases.impact(oil.model_copy(update={"single": (0.05, 0.4)})).endswith("(0.1 to 0.28)")


def test_the_extended_rig_is_worse_where_all_channels_together_say_so() -> None:
    played = {
        "T_oil": Played(rms_calibrated=1.5, rms_extended=0.3, unit="K"),
        "T_wall": Played(rms_calibrated=0.4, rms_extended=0.5, unit="K"),
    }
    assert phrases.doubt(explained(played=played, gain=None)) == ""
    assert "T_wall 0.4" in phrases.doubt(explained(played={"T_wall": played["T_wall"]}, gain=None))


def test_readings_left_out_say_whether_the_extended_rig_is_used() -> None:
    played = {"T_oil": Played(rms_calibrated=2.7, rms_extended=2.9, unit="K")}
    gain = explained().gain
    assert gain is not None
    assert "Do not use" not in explained(played=played).says.do, "0.6 K instead of 2.3 K on readings left out"
    assert "Do not use" in explained(gain=gain.model_copy(update={"rmse_after": 2.4})).says.do
    speeds = explained().gain_grouped[0].model_copy(update={"rmse_after": 2.8})
    said = phrases.doubt(explained(gain_grouped=(speeds,)))
    assert "no better (each speed left out in turn 2.5 before, 2.8 K after): there do not use the extended rig" in said


def test_the_rig_that_is_written_is_the_one_that_was_scored() -> None:
    """It holds the likeliest set alone, which may be worse than the mean of all."""
    gain = explained().gain
    assert gain is not None
    alone = gain.model_copy(update={"leading": Gain.Both(without=2.5, with_=2.4)})
    assert "predicts no better (T_oil: 2.3 before, 2.5 K after)" in explained(gain=alone).says.do


def test_plain_statistics_that_are_better_are_told() -> None:
    gain = explained().gain
    assert gain is not None
    worse = gain.model_copy(update={"rmse_after": 1.4})
    assert (
        "plain statistics (linear in speed and load) predict better: 1.1 against 1.4 K" in explained(gain=worse).says.do
    )
    assert "Do not use" not in explained(gain=worse).says.do
    assert phrases.doubt(explained()) == ""


def test_left_overs_that_are_no_noise_or_too_small_are_told() -> None:
    for p, words in ((1e-4, "is not noise (p = 1e-4)"), (0.9999, "is smaller than the stated scatter")):
        assert words in explained(test=Alarm(alpha=0.05, p_any=1e-4, p_adequacy=p)).says.sure
    assert "What is left" not in explained(test=Alarm(alpha=0.05, p_any=1e-4, p_adequacy=None)).says.sure


def test_a_channel_whose_left_over_is_no_noise_is_named_beside_what_looks_like_noise() -> None:
    quality = explained().data_quality
    for p, odd in ((5e-3, False), (1e-3, True)):  # the smallest of three channels is below 1 % in 3 % of all campaigns
        left = quality.model_copy(update={"adequacy": {"T_oil": p, "T_wall": 0.4, "T_sun": 0.6}})
        said = explained(data_quality=left, test=Alarm(alpha=0.05, p_any=1e-4, p_adequacy=0.5)).says
        assert (", but for T_oil." in said.sure) == odd
        assert any("T_oil is not noise" in line for line in said.data) == odd


@pytest.mark.parametrize(
    ("found", "words"),
    [
        (lambda: clean(test=Alarm(alpha=0.05, p_any=1e-4, p_adequacy=0.5)), "is an alarm"),
        (lambda: explained(test=Alarm(alpha=0.05, p_any=0.3, p_adequacy=0.5)), "is none"),
        (lambda: explained(answers=(Answer(causes=((AIR,),), probability=0.4),)), "explains it with 40 %"),
        (lambda: explained(answers=()), "none or several"),
        (lambda: ambiguous(hypotheses=clean().hypotheses), "yet nothing has 93 %"),
        (lambda: ambiguous(causes=()), "is named and not listed"),
        (lambda: clean(answers=(Answer(causes=((AIR,),), probability=0.03),)), "there is an answer"),
    ],
)
def test_contradictions_are_found_and_printed(found: object, words: str) -> None:
    made = found()  # type: ignore[operator]
    assert any(words in text for text in contradictions(made))
    assert "warning    the result contradicts itself" in text(made)


def test_words_are_the_same_twice() -> None:
    found = explained()
    assert with_words(found) == found


def test_numbers_as_people_write_them() -> None:
    assert [phrases.number(v) for v in (0.0, -0.0, 1234.5, 1e5, 0.00123, 2.5e-9)] == [
        "0", "0", "1234", "100000", "0.00123", "2.5e-09",
    ]  # fmt: skip
    assert [phrases.percent(p) for p in (1.0, 0.996, 0.5, 0.001, 0.0)] == ["> 99 %", "> 99 %", "50 %", "< 1 %", "< 1 %"]
    assert [phrases.p_value(p) for p in (0.4, 0.9984, 1.0, 2e-5, 1e-6)] == [
        "p = 0.4", "p = 0.9984", "p = 0.9999", "p = 2e-5", "p < 1e-6",
    ]  # fmt: skip


def test_logarithms_are_told_as_factors() -> None:
    found = Estimate(name="ln_factor", value=-0.4, ci95=(-0.5, -0.3), unit="1", doc="logarithm of the coefficient")
    assert phrases.estimate(found) == "0.67 times (0.607 to 0.741)"
    assert phrases.meaning(found) == "coefficient"
    change = Estimate(name="change", value=0.155, ci95=(0.1, 0.2), unit="1", doc="logarithm of the factor")
    assert phrases.estimate(change).startswith("1.17 times")


def test_a_regime_names_its_sides() -> None:
    both = cause(CHURNING, 0.5).model_copy(
        update={"regime": {"n_carrier [rpm]": (120.0, None), "film [mm²/s²]": (None, 3.0)}}
    )
    assert phrases.regime(both) == "only at n_carrier above 120 rpm, film below 3 mm²/s²"
    later = both.model_copy(update={"regime": {"order [1]": (0.868, None)}, "since": "test 31 (2024-03-05)"})
    assert phrases.where(later) == "from test 31 (2024-03-05) on"


def test_another_instrument_that_may_err_is_told() -> None:
    shares = {"T_input": 0.72, "T_input, opposite signs": 0.1, "T_output": 0.08, "T_output, opposite signs": 0.05}
    forms = tuple(FormShare(name=name, share=share) for name, share in (shares | {"T_middle": 0.05}).items())
    found = cause(OFFSET, 0.9).model_copy(update={"forms": forms})
    torques = [Channel(name=name, kind="torque", unit="N.m") for name in ("T_input", "T_output", "T_middle")]
    assert phrases.where(found, torques) == "T_input, or T_output: 13 %"
    alone = found.model_copy(update={"forms": forms[:1]})
    assert phrases.where(alone, torques) == "T_input"


def test_none_of_a_thousand_draws_is_below_one_of_a_thousand() -> None:
    assert phrases.chance(1 / 1001).startswith("fewer than 1 of 1000") and "(p < 1e-3)" in phrases.chance(1 / 1001)
    assert "(p = 2e-5)" in phrases.chance(2e-5) and phrases.chance(0.02).startswith("2 of 100 ")


def test_names() -> None:
    assert name_of("sensor.oil_temp.lag") == "lag of the oil thermometer"
    assert name_of("mine.sticky_valve") == "sticky valve"
    assert [names_of("abc"[:n]) for n in range(4)] == ["", "a", "a and b", "a, b and c"]
    assert names_of("abcd", most=2) == "a, b and 2 more"
