"""The campaigns with something hidden are what their cards say: they read back, and clean ones differ by noise only."""

import numpy as np
import pytest
from diagnose.hidden.benches import BENCHES, HARMONIC, HELICAL, PLANETARY
from diagnose.hidden.cases import HIDDEN
from diagnose.hidden.loudness import chi_square, signal_to_noise
from diagnose.hidden.maker import Gross, make, model, run
from gearheat.scenarios.load import load
from gearheat.scenarios.measured.card import read_card
from gearheat.scenarios.measured.read import read_campaign


@pytest.mark.parametrize("rig", BENCHES)
def test_a_campaign_reads_back(rig, tmp_path) -> None:
    case = make(BENCHES[rig], [], 3, tmp_path)
    campaign = read_campaign(case.data, load(BENCHES[rig].rig), read_card(case.card))
    assert {s.name: s.role for s in campaign.sensors if s.name != "T_oil2"} == {
        g.name: "given" if g.given else "read" for g in BENCHES[rig].gauges
    }
    assert campaign.steady == (not BENCHES[rig].dwells)
    assert 270 < campaign.values["T_amb"].min() < campaign.values["T_oil"].min() < 400
    assert not campaign.warnings


def test_the_same_seed_gives_the_same_bytes(tmp_path) -> None:
    one, other = (make(HELICAL, [HIDDEN["helical"]["air"]], 5, tmp_path / k) for k in "ab")
    assert one.data.read_bytes() == other.data.read_bytes()


def test_a_gross_reading_is_one_reading(tmp_path) -> None:
    plain = make(HELICAL, [], 5, tmp_path / "a").data.read_text("utf-8").splitlines()
    wrong = make(HELICAL, [], 5, tmp_path / "b", Gross(6, "T_oil", 20)).data.read_text("utf-8").splitlines()
    (line,) = [k for k, (a, b) in enumerate(zip(plain, wrong, strict=True)) if a != b]
    assert line == 7  # the first line is the header
    cells = [a for a, b in zip(plain[line].split(","), wrong[line].split(","), strict=True) if a != b]
    assert len(cells) == 1


@pytest.mark.parametrize("bench", [HELICAL, HARMONIC], ids=lambda b: b.name)
def test_clean_campaigns_differ_from_the_file_by_what_the_card_says(bench, tmp_path) -> None:
    ratios = [chi_square(bench, make(bench, [], seed, tmp_path / str(seed)), seed) for seed in range(6)]
    assert 0.8 < float(np.mean(ratios)) < 1.2


@pytest.mark.parametrize("name", ["churning", "seals by torque"])
def test_a_hidden_loss_brakes_as_much_as_it_heats(name) -> None:
    effect = HIDDEN["helical"][name]
    true = run(HELICAL, HELICAL.tests(np.random.default_rng(0)), [{}] * 24, [effect])
    heat = sum(true[q.name] for q in model(HELICAL.rig).inputs if q.name.endswith(".Q_flow_external"))
    assert heat == pytest.approx(true["P_extra"], rel=1e-3)
    assert true["P_extra"].max() > 20.0


def test_a_timed_campaign_is_warmer_with_a_neighbour() -> None:
    tests = PLANETARY.tests(np.random.default_rng(0))[:2]
    plain = run(PLANETARY, tests, [{}] * 2, [])
    warm = run(PLANETARY, tests, [{}] * 2, [HIDDEN["planetary"]["neighbour"]])
    assert ((warm["oil.T"] - plain["oil.T"]) > 1.0).all()
    assert plain["direction"].tolist() == [1, 2, 1, 2]


def test_steady_cases_are_loud_enough_to_be_found() -> None:
    quiet = {name for name, effect in HIDDEN["helical"].items() if signal_to_noise(HELICAL, [effect]) < 3.0}
    assert quiet == {"seals"}  # half as much again lies within three standard deviations of what the card grants seals
