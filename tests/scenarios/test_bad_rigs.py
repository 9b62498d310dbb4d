"""Every way a rig file can be wrong: the exact message, and all of them at once."""

import tempfile
from collections.abc import Callable
from pathlib import Path

import pytest
from gearheat.model.errors import GearheatError, ScenarioError, StructureError
from gearheat.scenarios.load import RIGS, load
from hypothesis import given, settings, strategies as st

Problems = Callable[..., tuple[str, ...]]

GEARS = "rig.toml [part.gear_set]"
FACE = 'b = "42 mm"'


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        # values
        (FACE, "b = 42", GEARS + ': b = 42 has no unit. Write "42 mm" or "42 m" (expected a unit like m).'),
        (FACE, 'b = "42"', GEARS + ': b = "42" has no unit. Write "42 mm" or "42 m" (expected a unit like m).'),
        (FACE, 'b = "42 kg"', GEARS + ': b = "42 kg": unit "kg" does not fit m. Write for example "62 mm".'),
        (FACE, 'b = "42 mn"', GEARS + ': b = "42 mn": unit "mn" does not fit m. Write for example "62 mm".'),
        (FACE, 'b = "wide"', GEARS + ': b = "wide" is no number with a unit. Write for example "62 mm".'),
        (FACE, 'b = "-42 mm"', GEARS + ': b = "-42 mm" is out of range. It must be above 0 mm.'),
        (FACE, 'b = "nan mm"', GEARS + ": b = 'nan mm' is not finite. Write a finite number."),
        (
            'C = "9000 J/K"',
            'C = "-9 kJ/K"',
            'rig.toml [part.wall]: C = "-9 kJ/K" is out of range. It must be above 0 kJ/K.',
        ),
        ('V = "1 l"', 'V = "-1 l"', 'rig.toml [part.oil]: V = "-1 l" is out of range. It must be above 0 l.'),
        (
            'material = "painted"',
            "emissivity = 1.2",
            "rig.toml [part.cooling]: emissivity = 1.2 is out of range. It must be at most 1.",
        ),
        (
            'room.T = "25 degC"',
            'room.T = "-300 degC"',
            'rig.toml [operating_point]: room.T = "-300 degC" is out of range. It must be at least -60 degC.',
        ),
        (
            'room.T = "25 degC"',
            "room.T = 25",
            'rig.toml [operating_point]: room.T = 25 has no unit. Write "25 degC" (expected a unit like K).',
        ),
        (
            'power_flow = "successive"',
            'power_flow = "idael"',
            GEARS + ": power_flow = 'idael' is not known. Choose one of: successive, ideal.",
        ),
        (
            'line_load = "F_bn/l"',
            'line_load = "F_bt/l"',
            GEARS + ": line_load = 'F_bt/l' is not known. Choose one of: F_bt/b, F_bn/l.",
        ),
        (
            'line_load = "F_bn/l"\n',
            "",
            GEARS + ": line_load is missing (line load of the friction formula: per face width, or per contact length)."
            " Choose one of: F_bt/b, F_bn/l.",
        ),
        # keys
        (FACE, "", GEARS + ": b is missing (face width). Give it in m."),
        (FACE, 'bb = "42 mm"', GEARS + ': unknown key "bb". Did you mean "b" (face width)?'),
        (
            'F_r_0 = "4660 N"',
            'radial_laod_of_its_own = "4660 N"',
            'rig.toml [part.carrier_bearing]: unknown key "radial_laod_of_its_own".'
            ' Did you mean "F_r_0" (radial load of its own)?',
        ),
        ("[losses]", "[loses]", 'rig.toml: unknown key "loses". Did you mean "losses"?'),
        ("[drive]", "[dirve]", 'rig.toml: "drive" is missing. Expected: what is given at the shaft ends, e.g. carrier'),
        # names
        ('kind = "planetary"', 'kind = "planetry"', 'rig.toml: unknown kind "planetry". Did you mean "planetary"?'),
        ('oil = "PAOR"', 'oil = "PAOOR"', 'rig.toml [part.oil]: unknown oil "PAOOR". Did you mean "PAOR"?'),
        (
            'bearing = "SKF 6217-2Z"',
            'bearing = "SKF 6217-2ZZ"',
            'rig.toml [part.sun_bearing]: unknown bearing "SKF 6217-2ZZ". Did you mean "SKF 6217-2Z" or "SKF 6217"',
        ),
        (
            'bearing = "SKF 6217-2Z"',
            'oil = "PAOR"',
            'rig.toml [part.sun_bearing]: oil = "PAOR" has none of the values of a DeepGrooveBallBearing. Take it out.',
        ),
        (
            'carrier = ["w", "tau"]',
            'carier = ["w", "tau"]',
            'rig.toml [drive]: "carier" is no shaft end. Did you mean "carrier"?',
        ),
        (
            'carrier = ["w", "tau"]',
            'carrier = ["w", "torque"]',
            "rig.toml [drive]: carrier = 'torque' does not fit: it should be 'w', 'tau' or 'load'. Expected: what is"
            " given at the shaft ends",
        ),
        ('"oil.T"', '"oil.TT"', 'rig.toml [sensors] T_oil_C: there is no "oil.TT". Did you mean "oil.T"'),
        (
            '["carrier_bearing.P_loss"]',
            '["carrier_baering.P_loss"]',
            'rig.toml [losses] P_trb_W: there is no "carrier_baering.P_loss". Did you mean "carrier_bearing.P_loss"',
        ),
        (
            'carrier.w = "250 rpm"',
            'carrier.ww = "250 rpm"',
            'rig.toml [operating_point]: there is no input "carrier.ww". Did you mean "carrier.w"',
        ),
        (
            "[part.rotor]",
            '[part.x]\ntype = "ThermalConducter"\n[part.rotor]',
            'rig.toml [part.x]: there is no part type "ThermalConducter". Did you mean "ThermalConductor"',
        ),
        (
            "[part.rotor]",
            "[part.wal]\n[part.rotor]",
            'rig.toml [part.wal]: the machine has no part "wal". Did you mean "wall"? A part of your own needs a type.',
        ),
        (
            "[part.rotor]",
            '[part."a b"]\ntype = "Room"\n[part.rotor]',
            "rig.toml [part.a b]: the name of a part is one word of letters, digits and _. Rename it.",
        ),
        # sources
        (
            'V = "1 l"\nsource = "Dias2014, chapter 4"',
            'V = "1 l"',
            "rig.toml [part.oil]: no source is given for V."
            ' Add source = "..." (a citation, or "assumed: reason") to the table.',
        ),
        (
            '"Dias2014, chapter 4"',
            '"assumed:"',
            'rig.toml [part.oil]: source is "assumed:" without a reason. Write "assumed: why".',
        ),
        (
            '"Dias2014, chapter 4"',
            "3",
            'rig.toml [part.oil]: source is 3. Write a citation such as "Dias2014, table 5.7", or "assumed: reason".',
        ),
        (
            "sources = { A = ",
            "sources = { AA = ",
            'rig.toml [part.cooling]: sources names "AA", which has no value here. Did you mean "A"?',
        ),
        (
            'source = "Dias2014, chapter 4"',
            'sources = "Dias2014"',
            "rig.toml [part.oil]: sources = 'Dias2014' is no table. Write sources = { V = \"...\" }.",
        ),
        # the campaign
        (
            'stop = "5 min"',
            "stop = 5",
            "[campaign]: stop = 5 does not fit: it should be text in quotation marks. Expected: time between",
        ),
        (
            'stop = "5 min"',
            'stop = "5 kg"',
            'rig.toml [campaign]: stop = "5 kg": unit "kg" does not fit s. Write for example "1 s".',
        ),
        (
            'room = "room.T"',
            'room = "rom.T"',
            'rig.toml [campaign]: there is no input "rom.T". Did you mean "room.T"',
        ),
        (
            'column = "n_carrier_rpm"',
            'colum = "n_carrier_rpm"',
            'rig.toml [campaign.inputs.carrier.w]: "column" is missing. Expected: name of the column that gives it.',
        ),
        (
            "sign = [1.0, -1.0]",
            "sign = [1.0]",
            "rig.toml [campaign.inputs.carrier.tau]: sign = [1.0] does not fit: it should have at least 2 items, not 1."
            " Expected: two signs, for direction 1 and 2.",
        ),
        ('"measured.csv"', '"measurd.csv"', "measurd.csv: there is no such file. Check the path."),
        ("evidence = ", "evidense = ", 'rig.toml [errata 1]: "evidence" is missing. Expected: how we know.'),
        # what cannot be
        (
            '["carrier_bearing.P_loss"]',
            '["carrier_bearing.P_loss", "carrier_bearing.P_loss"]',
            "rig.toml [losses] P_trb_W: carrier_bearing.P_loss is there twice. Name it once.",
        ),
        (
            '["carrier_bearing.P_loss"]',
            '["carrier_bearing.P_loss", "oil.T"]',
            "rig.toml [losses] P_trb_W: oil.T (temperature of the oil) is no power. Sum powers only.",
        ),
        (
            'T_oil_C = "oil.T"',
            'T_oil_C = "carrier_bearing.P_loss"',
            'rig.toml [sensors] T_oil_C: carrier_bearing.P_loss in degC: unit "degC" does not fit W.',
        ),
        (
            'V = "1 l"',
            'V = "1 l"\nuncertainties = { V = "100 m3" }',
            "rig.toml [part.oil]: uncertainty of V = '100 m3' is 1e+05 times the value. Check its unit.",
        ),
        (
            'stop = "5 min"',
            'stop = "-5 min"',
            'rig.toml [campaign]: stop = "-5 min" is out of range.',
        ),
        ('E = "206 GPa"', 'E = "206 MPa"', GEARS + ': E = "206 MPa" is out of range. It must be at least 500 MPa.'),
        # connections
        (
            "[sensors]",
            '[connect]\nx = ["oil.heat", "oil.het"]\n[sensors]',
            'rig.toml [connect] x: there is no port "oil.het". Did you mean "oil.heat"',
        ),
        (
            "[sensors]",
            '[connect]\nx = ["oil.heat"]\n[sensors]',
            "rig.toml [connect] x: names 1 port. Name at least two that meet.",
        ),
    ],
)
def test_one_mistake_one_message(problems: Problems, old: str, new: str, expected: str) -> None:
    found = problems((old, new))
    assert expected in found[0]
    assert len(found) <= 2  # what follows from a misspelt key: it is unknown, and the right one is missing


def test_a_syntax_error_names_its_line(problems: Problems) -> None:
    assert problems(('kind = "planetary"', "kind = planetary")) == (
        "rig.toml line 1: TOML syntax, invalid value: kind = planetary\n"
        'Write key = "62 mm": values with a unit stand in quotation marks.',
    )


def test_all_mistakes_at_once(problems: Problems) -> None:
    changes = (
        (FACE, "b = 42"),
        ('oil = "PAOR"', 'oil = "PAOOR"'),
        ("[losses]", "[loses]"),
        ('stop = "5 min"', 'stop = "5 kg"'),
    )
    assert [problem.split(": ")[0] for problem in problems(*changes)] == [
        "rig.toml",
        "rig.toml [part.gear_set]",
        "rig.toml [part.oil]",
        "rig.toml [campaign]",
    ]


def test_a_missing_measured_table_is_reported_with_the_rest(problems: Problems, tmp_path: Path) -> None:
    found = problems(('"measured.csv"', '"other.csv"'), (FACE, "b = 42"))
    assert found[0].startswith("rig.toml [part.gear_set]: b = 42")
    assert found[1] == f"{tmp_path / 'other.csv'}: there is no such file. Check the path."


def test_ports_of_different_kinds_do_not_meet(tmp_path: Path) -> None:
    path = tmp_path / "mixed.toml"
    path.write_text(
        'kind = "network"\ndoc = "x"\n[drive]\n[operating_point]\n[part.room]\ntype = "Room"\n'
        '[part.end]\ntype = "ShaftEnd"\n[connect]\nx = ["room.floor", "end.flange"]\n'
    )
    with pytest.raises(StructureError, match=r"mixed: connect .* joins ports of different kinds"):
        load(path)


def test_a_network_part_needs_a_type(problems: Problems) -> None:
    found = problems(('[part.room]\ntype = "Room"', "[part.room]"), rig="helical_two_stage")
    assert found[0].startswith('rig.toml [part.room]: "type" is missing. Give one of: ShaftEnd, ')


def test_a_broken_part_table_stops_the_reading_there(problems: Problems) -> None:
    old = '[part.oil]\noil = "PAOR"\nV = "1 l"\nsource = "Dias2014, chapter 4"\n'
    expected = (
        "rig.toml [part]: oil = 3 does not fit: it should be a table. Expected: a table [part.NAME] for each part."
    )
    assert problems((old, "[part]\noil = 3\n")) == (expected,)


@pytest.mark.parametrize("text", ["", "[part]\n", 'kind = "network"\n', "kind = 3\npart = 4\ndrive = 5\n"])
def test_a_file_with_next_to_nothing_says_what_is_missing(tmp_path: Path, text: str) -> None:
    (path := tmp_path / "rig.toml").write_text(text)
    with pytest.raises(ScenarioError) as raised:
        load(path)
    assert raised.value.problems
    assert all(problem.startswith("rig.toml") for problem in raised.value.problems)


@given(st.data())
@settings(max_examples=60, deadline=None)
def test_whatever_stands_in_a_rig_file_is_accepted_or_explained(data: st.DataObject) -> None:
    """One random value of the shipped rig is replaced by another kind of value, or left out."""
    lines = (RIGS / "planetary" / "rig.toml").read_text(encoding="utf-8").splitlines()
    lines[lines.index('data = "measured.csv"')] = ""
    places = [i for i, line in enumerate(lines) if " = " in line]
    place = data.draw(st.sampled_from(places))
    key = lines[place].split(" = ")[0]
    value = data.draw(
        st.sampled_from(
            ['""', "0", "-1e300", "true", "[]", "[1, 2]", '["w", {}]', "{}", "{ a = 1 }", '"1 m"', "1979-05-27", "nan"]
        )
    )
    lines[place] = data.draw(st.sampled_from([f"{key} = {value}", f"{key}x = {value}", ""]))
    with tempfile.TemporaryDirectory() as folder:
        (path := Path(folder) / "rig.toml").write_text("\n".join(lines), encoding="utf-8")
        try:
            load(path)
        except GearheatError as error:
            assert error.problems
            assert all(problem.strip() for problem in error.problems)


def test_the_file_beside_is_suggested(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "gearbox_7.toml").write_text("")
    with pytest.raises(GearheatError, match=r'Did you mean "gearbox_7\.toml"'):
        load("gearbox_7.tml")
    (tmp_path / "gearbox_7.toml").write_text((RIGS / "helical_two_stage" / "rig.toml").read_text(encoding="utf-8"))
    assert load("gearbox_7").name == load("gearbox_7.toml").name, "its ending may be left out"


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("planetry", 'there is no rig "planetry" and no such file. Did you mean "planetary"? Shipped rigs: '),
        (RIGS / "planetary" / "publised.toml", 'published.toml" or '),
        ("no/such.toml", "no/such.toml: there is no such file. Check the path."),
    ],
)
def test_no_such_rig(name: str, expected: str) -> None:
    with pytest.raises(GearheatError) as raised:
        load(name)
    assert expected in raised.value.problems[0]


def test_a_folder_without_a_rig(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r"is a folder without a rig\.toml"):
        load(tmp_path)


def test_a_file_that_is_no_text(tmp_path: Path) -> None:
    (path := tmp_path / "rig.toml").write_bytes(b"\xff\x00")
    with pytest.raises(ScenarioError, match="is not UTF-8 text"):
        load(path)


@pytest.mark.parametrize("slip", ["oil.heat", "cooling.surface"])
def test_one_port_in_two_nets_does_not_make_one_body_of_two(tmp_path: Path, slip: str) -> None:
    text = (RIGS / "helical_two_stage" / "rig.toml").read_text(encoding="utf-8")
    path = tmp_path / "slip.toml"
    path.write_text(text.replace("heat_wall = [", f'heat_wall = ["{slip}",'), encoding="utf-8")
    with pytest.raises(ScenarioError) as caught:
        load(path)
    net, body = {"oil.heat": ("heat_oil", "oil"), "cooling.surface": ("heat_surface", "surface")}[slip]
    nets = sorted([net, "heat_wall"], key=text.index)
    assert str(caught.value) == (
        f"slip.toml [connect] {nets[0]} and {nets[1]} both name {slip}: they would be one net, and "
        f"{' and '.join(sorted([body, 'wall']))} one body. Name {slip} in one of them, or write one net."
    )


def test_a_heat_port_in_no_net_is_refused(tmp_path: Path) -> None:
    text = (RIGS / "helical_two_stage" / "rig.toml").read_text(encoding="utf-8")
    path = tmp_path / "slip.toml"
    path.write_text(text.replace('"oil_gears.b", "gears_shafts.a"', '"gears_shafts.a"'), encoding="utf-8")
    with pytest.raises(StructureError, match=r"slip: oil_gears\.b is connected to nothing: its heat has no way out"):
        load(path)
