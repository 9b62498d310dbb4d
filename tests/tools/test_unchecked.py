"""Catalogue values never checked against a print: told by `show`, FMUs and reports, held in the JSON of every run."""

from __future__ import annotations

import pytest
from gearheat.scenarios.load import load
from gearheat.scenarios.measured.study import read_study
from gearheat.scenarios.write import rig_text
from gearheat.tools.solve.losses import oils_of
from gearheat.tools.solve.settings import adjust, find_unchecked, flat_of

OIL = {
    "catalogue": "oil",
    "entry": "ISO VG 220 mineral",
    "values": [f"oil.{key}" for key in ("nu_100", "rho_15", "alpha_T", "X_L", "c_p", "T_pour")],
}
LINE = (
    'catalogue values not checked against a print: oil "ISO VG 220 mineral":'
    " oil.nu_100, oil.rho_15, oil.alpha_T, oil.X_L, oil.c_p, oil.T_pour\n"
)


def found(rig: str, *assignments: str) -> list[dict]:
    scenario = adjust(load(rig), assignments)
    return find_unchecked(scenario, flat_of(scenario))


def test_what_is_unchecked_and_acts_is_named() -> None:
    """Bearings, seals and paint of the planetary rig are checked, its oil but for the pour point, and of its grease all
    that has an effect."""
    assert found("helical_two_stage") == [OIL]
    assert found("planetary") == [{"catalogue": "oil", "entry": "PAOR", "values": ["oil.T_pour"]}]
    assert list(load("planetary").unchecked()) == [("oil", "PAOR"), ("oil", "bearing grease")]


def test_another_entry_brings_its_own() -> None:
    (typical,) = found("planetary", "oil=ISO VG 320 PAG")
    assert typical == OIL | {"entry": "ISO VG 320 PAG"}
    (pour,) = found("helical_two_stage", "oil=PAOR")
    assert pour == {"catalogue": "oil", "entry": "PAOR", "values": ["oil.T_pour"]}
    assert found("helical_two_stage", "oil=PAOR", "oil.T_pour=-40 degC") == []
    (one,) = found("planetary", "oil=PAGD")
    assert one == {"catalogue": "oil", "entry": "PAGD", "values": ["oil.c_p", "oil.T_pour"]}


def test_value_of_one_s_own_is_none_of_the_catalogue() -> None:
    (rest,) = found("helical_two_stage", "oil.rho_15=890 kg/m3", "oil.X_L=1.1")
    assert rest["values"] == ["oil.nu_100", "oil.alpha_T", "oil.c_p", "oil.T_pour"]
    (rest,) = found("planetary", "oil=ISO VG 320 PAG", "oil.rho_15=1050 kg/m3")
    assert "oil.rho_15" not in rest["values"]


def test_written_rig_still_says_it(tmp_path) -> None:
    (path := tmp_path / "rig.toml").write_text(rig_text(load("helical_two_stage")), encoding="utf-8")
    assert found(str(path)) == [OIL]


def test_oils_of_a_campaign_count() -> None:
    """Each test runs with its own oil: two of the four lack a printed value beside the pour point."""
    scenario = load("planetary")
    told = find_unchecked(scenario, flat_of(scenario), oils_of(read_study(scenario)))
    unprinted = {e["entry"]: [path for path in e["values"] if path != "oil.T_pour"] for e in told}
    assert unprinted == {"PAOR": [], "MINR": [], "MINE": ["oil.s_p", "oil.t_p"], "PAGD": ["oil.c_p"]}


@pytest.mark.parametrize(
    "command",
    [
        ["show", "helical_two_stage"],
        ["steady", "helical_two_stage"],
        ["losses", "helical_two_stage"],
        ["design", "helical_two_stage", "--free", "input.w", "--target", "oil.T=60 degC"],
        ["export", "--platform", "host", "helical_two_stage", "--out", "OUT.fmu"],
        ["simulate", "helical_two_stage", "--duty", "DUTY", "--out", "OUT.csv"],
        ["sweep", "helical_two_stage", "--vary", "room.T=10..30 degC", "--sample", "3", "--out", "OUT.csv"],
    ],
    ids=lambda words: words[0],
)
def test_every_command_holds_it_and_what_is_kept_says_it(gearheat, tmp_path, command: list[str]) -> None:
    (duty := tmp_path / "duty.csv").write_text("time [s],room.T [degC]\n0,20\n60,20\n")
    words = [w.replace("OUT", str(tmp_path / "out")).replace("DUTY", str(duty)) for w in command]
    answer = gearheat(*words)
    assert answer.code == 0, answer.err
    assert (LINE in answer.out) == (command[0] in ("show", "export"))
    assert gearheat(*words, "--json", "-").json["unchecked"] == [OIL]


def test_list_says_what_of_an_entry_is_checked(gearheat) -> None:
    checked = gearheat("list", "--json", "-").json["checked"]
    no_print = {name for name, how in checked["bearing"].items() if how != "all"}
    assert {name for name in no_print if not name.startswith("NU 10")} == {"7208 B", "51108", "81108"}
    assert "NU 1060" not in no_print and {"NU 1064", "NU 10/500"} <= no_print
    assert checked["material"]["oily steel"] == "none"
    assert checked["oil"]["PAGD"] == "not c_p, T_pour"


def test_run_says_it_in_its_report(gearheat, tmp_path) -> None:
    answer = gearheat("run", "helical_two_stage", "--out", str(tmp_path / "out"), "--jobs", "1")
    assert answer.code == 0, answer.err
    assert LINE in answer.out
    page = (tmp_path / "out" / "report.html").read_text("utf-8")
    assert "<p>Catalogue values not checked against a print:</p>" in page
    assert "<li>oil &#34;ISO VG 220 mineral&#34;: oil.nu_100, oil.rho_15" in page
    assert "unchecked (oil &#34;ISO VG 220 mineral&#34;)" in page  # beside each of the values
