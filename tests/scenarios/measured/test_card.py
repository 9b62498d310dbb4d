"""Cards: both formats and versions, every problem at once, and a card with every key that says what holds anyway."""

from __future__ import annotations

import itertools
import json
from dataclasses import replace
from pathlib import Path

import pytest
from gearheat.model.errors import DataError
from gearheat.model.machines.roles import Roles
from gearheat.scenarios.load import list_rigs, load
from gearheat.scenarios.measured.card import Card, read_card
from gearheat.scenarios.measured.lubrication import oil_values
from gearheat.scenarios.measured.sensors import sensors_of
from gearheat.scenarios.measured.write import as_json, as_toml, default_card
from gearheat.scenarios.nuisances import nuisances, usual_priors

FIRST = {
    "schema": "gearheat.card/1",
    "units": {"T": "degC", "torque": "N.m"},
    "channels": {
        "T_oil_C": {"repeat_sd": 0.5, "offset_sd": 0.15},
        "T_carrier_Nm": {"repeat_sd": 1.5, "full_scale": 3000},
    },
    "day_cooling_sd": 0.02,
    "prior_sd": {"mu": 0.1, "brg": 0.12},
    "protocol": {"dwell_min": [240, 90], "stop_min": 5, "ambient_start_minus_reading_K": -2},
    "lubrication": {"gears": "oil", "needles": "oil"},
    "series": False,
}


@pytest.fixture
def card(tmp_path):
    def write(content: object, name: str = "card.json") -> Path:
        path = tmp_path / name
        path.write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8")
        return path

    return write


@pytest.mark.parametrize("name", list_rigs())
def test_a_card_with_every_key_says_what_is_taken_without_one(rig, card, name):
    scenario = rig(name)
    whole = default_card(scenario, usual_priors(scenario))
    toml = as_toml(whole)
    for path in (card(toml, "card.toml"), card(as_json(whole))):
        again = read_card(path)
        assert again.model_dump() == whole.model_dump()
        assert sensors_of(scenario, again) == sensors_of(scenario, Card())
        roles = Roles.of(scenario.spec)
        stated = nuisances(roles, again.prior_sd, scenario.uncertainties)
        for one, other in zip(stated, nuisances(roles, {}, scenario.uncertainties), strict=True):
            assert one.paths == pytest.approx(other.paths, rel=2e-3) and one.sd == pytest.approx(other.sd, rel=2e-3)


def test_every_key_of_the_written_card_has_a_comment(rig):
    lines = as_toml(default_card(rig("planetary"), {})).splitlines()
    tables = ("", "protocol", "oil", "channels.T_oil", "sensors.T_oil")
    place = ""
    assert max(map(len, lines)) <= 80
    for before, line in itertools.pairwise(lines):
        place = line[1:].split("]")[0] if line.startswith("[") else place
        if " = " in line and place in tables and not line.startswith("# "):
            assert "  # " in line or (before.startswith("# ") and " = ..." not in before), line


def test_a_card_of_version_1(rig, card):
    found = read_card(card(FIRST))
    sensors = {s.name: s for s in sensors_of(rig("planetary"), found)}
    assert (sensors["T_oil"].repeat_sd, sensors["T_oil"].offset_sd) == (0.5, 0.15)
    assert (sensors["T_carrier"].repeat_sd, sensors["T_carrier"].offset_sd) == (1.5, 2.0)
    assert found.protocol.dwell_min == [240, 90] and found.prior_sd["mu"] == 0.1 and not found.warnings


def test_keys_of_version_1_that_nothing_reads_warn(card):
    found = read_card(card({**FIRST, "chanels": {}, "protocol": {"stop": 5}}))
    assert 'card.json: "chanels" is not used. Did you mean "channels"?' in found.warnings
    assert any('"protocol.stop" is not used' in w for w in found.warnings)


def test_words_as_protocol(card):
    assert any("in words" in w for w in read_card(card({**FIRST, "protocol": "a stop, then 90 min"})).warnings)
    assert not read_card(card('protocol = "steady"\n', "card.toml")).warnings


@pytest.mark.parametrize("name", list_rigs())
def test_a_rig_without_sensors_has_those_of_its_ends_and_bodies(card, name):
    bare = replace(load(name), instruments=())
    sensors = sensors_of(bare, read_card(card({"schema": "gearheat.card/2"})))
    assert {"speed", "torque"} <= {s.kind for s in sensors}
    assert [s.name for s in sensors if s.kind == "ambient"]


def test_without_a_card_there_is_a_warning():
    assert read_card(None).warnings == ("no card: default accuracies and priors.",)


def test_an_oil_is_completed_by_that_of_the_rig(rig, card):
    scenario = rig("planetary")
    oil = oil_values(
        scenario, "VG 320", read_card(card("[oil]\nnu40 = 320\nnu100 = 25\nalpha_T = 6e-4\n", "card.toml"))
    )
    own = scenario.spec.part("oil").values
    assert oil["oil.nu_100"] == pytest.approx(25e-6) and oil["oil.alpha_T"] == -6e-4 and oil["oil.X_L"] == own["X_L"]
    assert oil_values(scenario, "", Card()) == {}
    assert oil_values(scenario, "MINR", Card())["oil.nu_40"] != own["nu_40"]


def test_all_problems_of_a_card_come_at_once(card):
    text = """
schema = "gearheat.card/3"
day_cooling_sd = -1
columms = {}
[channels.T_oil]
repeat_sd = true
[protocol]
stop_min = -1
dwell_min = [0, 90]
[prior_sd]
mu = "10 %"
"""
    with pytest.raises(DataError) as error:
        read_card(card(text, "card.toml"))
    found = "\n".join(error.value.problems)
    assert len(error.value.problems) == 7
    for words in (
        "card.toml: schema = 'gearheat.card/3' does not fit: it should be 'gearheat.card/1' or 'gearheat.card/2'.",
        "card.toml: day_cooling_sd = -1 does not fit: it should be at least 0. Expected: relative scatter from day to"
        " day of what surfaces and coolers give off.",
        'card.toml: unknown key "columms". Did you mean "columns"?',
        "card.toml [channels.T_oil]: repeat_sd = True does not fit: it should be text in quotation marks. Expected: ",
        "card.toml [protocol]: stop_min = -1 does not fit: it should be at least 0. Expected: ",
        "card.toml [protocol]: dwell_min = [0, 90] does not fit: it should be minutes, 0.01 to 1e+06 each. Expected: ",
        "card.toml [prior_sd]: mu = '10 %' does not fit: it should be a number. Expected: ",
    ):
        assert words in found, words


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[prior_sd]\nmu = -0.1\n", "prior_sd.mu = -0.1 is not above 0"),
        ("[prior_sd]\nmu = inf\n", "card.toml [prior_sd]: mu = inf does not fit"),
        ("[prior_sd]\nmu = 10\n", "prior_sd.mu = 10 is not above 0 and at most 3"),
        ("[oil]\nnu40 = 0.00032\nnu100 = 0.00002\n", "mm2/s"),
        ("[oil]\nnu40 = 30\nnu100 = 40\n", "thinner"),
        ("[oil]\nnu40 = 30\n", "give both nu40 and nu100"),
        ("x = [", "card.toml line 1: TOML syntax"),
        *(
            (f"{table}{key} = {value}\n", f"{key} = {value} does not fit")
            for table, key, value in (
                ("", "day_cooling_sd", "1000000.0"),
                ("[oil]\nnu100 = 5\n", "nu40", "1e+30"),
                ("[oil]\n", "rho15", "0.88"),
                ("[protocol]\n", "dwell_min", "[1e-09]"),
                ("[protocol]\n", "dwell_min", "[240, -90]"),
                ("[protocol]\n", "stop_min", "-5"),
                ("[protocol]\n", "stop_min", "1e+30"),
                ("[protocol]\n", "T_start_minus_amb_K", "293"),
            )
        ),
    ],
)
def test_values_that_cannot_be(card, text, words):
    with pytest.raises(DataError) as error:
        read_card(card(text, "card.toml"))
    assert words in str(error.value)


@pytest.mark.parametrize(
    "content", ["[1]", '"text"', "{", "3", '{"oil": {}, "oil": {}}', '{"channels": {"a": {}, "a": {}}}', "[" * 100_000]
)
def test_what_is_no_card(card, content):
    with pytest.raises(DataError, match=r"card\.json"):
        read_card(card(content))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('[channels.T_oill]\nrepeat_sd = "1 K"\n', 'there is no sensor "T_oill". Did you mean "T_oil"'),
        ('[columns]\nT_wal = "x"\n', 'there is no sensor "T_wal". Did you mean "T_wall"'),
        ('[sensors.x]\nreads = "oil.TT"\n', 'there is no "oil.TT" to read. Did you mean "oil.T"'),
        ('[channels.T_oil]\nrepeat_sd = "1 N.m"\n', "channels.T_oil.repeat_sd"),
        ("[channels.T_oil]\nrepeat_sd = -1\n", "is below zero"),
        ('[sensors.x]\nreads = "gear_set.mu_sp"\n', "no kind of sensor reads"),
    ],
)
def test_sensors_of_a_card_that_cannot_be(rig, card, text, words):
    with pytest.raises(DataError) as error:
        sensors_of(rig("planetary"), read_card(card(text, "card.toml")))
    assert words in str(error.value)


def test_an_unknown_channel_of_version_1(rig, card):
    with pytest.raises(DataError, match='no sensor "T_oill_C"'):
        sensors_of(rig("planetary"), read_card(card({**FIRST, "channels": {"T_oill_C": {"repeat_sd": 0.5}}})))
