"""Measured tables of any rig: columns, units, signs, directions, tests in running order."""

from __future__ import annotations

from contextlib import nullcontext

import numpy as np
import pytest
from gearheat.model.errors import DataError
from gearheat.scenarios.measured.card import Card, read_card
from gearheat.scenarios.measured.nominal import Nominal, model_values
from gearheat.scenarios.measured.read import read_campaign
from gearheat.scenarios.measured.shafts import torques
from gearheat.scenarios.measured.table import Sensor
from gearheat.scenarios.shipped import RIGS
from made_tables import made, written

MINUTE = 60.0


def test_the_shipped_campaign_reads_with_the_signs_of_the_model(rig):
    found = read_campaign(RIGS / "planetary" / "measured.csv", rig("planetary"), Card())
    assert (found.n, found.n_tests, found.steady) == (72, 36, False)
    assert {s.name for s in found.given} == {"n_carrier", "T_carrier", "T_amb"}
    assert {s.name for s in found.read} == {"T_sun", "T_oil", "T_oil2", "T_wall"}
    assert list(found.direction[:4]) == [1, -1, 1, -1]
    assert list(found.dwell[:2] / MINUTE) == [240, 90] and found.dwell[31] == 75 * MINUTE
    assert list(found.stop[:3]) == [0, 5 * MINUTE, 0]
    assert set(found.oil) == {"PAOR", "MINR", "MINE", "PAGD"} and found.mounting[0] == "PAOR-16"
    carrier, sun = found.sensor("T_carrier"), found.sensor("T_sun")
    assert list(carrier.sign(found.direction)[:2]) == [1, -1]
    assert list((found.values["T_sun"] * sun.sign(found.direction))[:2]) == [-383.0, 395.9]
    assert found.values["T_oil"][0] == pytest.approx(43.26 + 273.15)
    assert found.values["n_carrier"][0] == pytest.approx(102.6 * np.pi / 30)
    assert (carrier.repeat_sd, sun.offset_sd) == (1.0, 0.5)


def test_own_column_names_units_and_decimal_commas(rig, helical, tmp_path):
    names = {"n_input_rpm": "n_an [1/min]", "T_oil_C": "Ölsumpf", "T_wall_C": "Wand (°F)", "T_amb_C": "Raum"}
    columns = {names.get(c, c): v for c, v in helical.items() if c != "T_output_Nm"}
    columns["M_ab [kNm]"] = [abs(v) / 1000 for v in helical["T_output_Nm"]]
    columns["Wand (°F)"] = [round(v * 1.8 + 32, 3) for v in helical["T_wall_C"]]
    rows = [";".join(str(v).replace(".", ",") for v in row) for row in zip(*columns.values(), strict=True)]
    path = tmp_path / "prüfstand.csv"
    path.write_text("\n".join([";".join(columns), *rows]), encoding="utf-8")
    card = tmp_path / "card.toml"
    card.write_text(
        'sensors.T_output.magnitude = true\n[columns]\nn_input = "n_an"\n"output.tau" = "M_ab"\n'
        'T_oil = "Ölsumpf"\nT_wall_C = "Wand"\nT_amb = "Raum"\n[units]\nRaum = "degC"\n'
    )
    found = read_campaign(path, rig("helical_two_stage"), read_card(card))
    output = found.sensor("T_output")
    assert (output.column, output.unit, output.signs) == ("M_ab [kNm]", "kN.m", (-1.0, -1.0))
    model = found.values["T_output"] * output.sign(found.direction)
    assert model == pytest.approx(helical["T_output_Nm"], abs=1e-9)
    for name in ("T_oil", "T_wall", "T_amb"):
        assert found.values[name] == pytest.approx(np.array(helical[f"{name}_C"]) + 273.15, abs=2e-3), name
    assert found.steady and found.n_tests == found.n == 6 and not found.direction.any()


@pytest.mark.parametrize(("end", "sign"), [("input", 1.0), ("output", -1.0)])
@pytest.mark.parametrize("turned", [1.0, -1.0])
def test_a_power_and_a_speed_give_the_torque_at_their_end(rig, read, helical, end, sign, turned):
    turns, speed = np.array([1, 1, 1, 1, 1, turned]), np.array(helical["n_input_rpm"]) * np.pi / 30
    torque = sign * np.array([100.0, 200, 100, 200, 100, 200])
    power = np.abs(torque * speed * Nominal(rig("helical_two_stage")).ratios[end]) / 1e3
    columns = helical | {"n_input_rpm": helical["n_input_rpm"] * turns, f"P_{end} [kW]": power}
    del columns["T_output_Nm"]
    card = {
        "input": 'sensors."P_input [kW]" = { reads = "input.tau", role = "given" }\nsensors.T_output.role = "read"',
        "output": 'columns.T_output = "P_output [kW]"\nsensors.T_output.magnitude = true',
    }[end]
    found = read("helical_two_stage", columns, card)
    given = next(s for s in found.given if s.kind == "torque")
    assert found.values[given.name] * given.signs[0] == pytest.approx(torque * turns, rel=1e-9)
    assert given.unit == "kW"


def test_a_power_without_a_speed_is_refused(rig):
    power = Sensor("T_input", "P [kW]", "input.tau", "torque", "given", "kW", 0.1, 0.1)
    with pytest.raises(DataError, match="is a power, and no column says the speed of input"):
        torques(rig("helical_two_stage"), [power], {"T_input": np.array([3e3])}, "data.csv")


@pytest.mark.parametrize(("lag", "card", "refused"), [(0.0, "", 0), (0.9, "", 1), (0.9, 'protocol = "steady"', 0)])
def test_samples_of_a_log_are_no_readings(read, helical, lag, card, refused):
    place = np.repeat(np.random.default_rng(1).integers(0, 6, 20), 12)
    columns = {name: np.array(values)[place] for name, values in helical.items()}
    for name in ("T_oil_C", "T_wall_C"):
        for k in range(1, len(place)):
            columns[name][k] += lag * (columns[name][k - 1] - columns[name][k])
    with pytest.raises(DataError, match="seems to be a log") if refused else nullcontext():
        read("helical_two_stage", columns, card)


def test_a_torque_may_be_an_estimate(read, helical):
    found = read("helical_two_stage", helical, 'channels.T_output.offset_sd = "180 N.m"')
    assert found.sensor("T_output").offset_sd == 180.0
    with pytest.raises(DataError, match="is no accuracy of such an instrument"):
        read("helical_two_stage", helical, 'channels.T_output.offset_sd = "300 N.m"')


def test_a_path_of_the_model_becomes_a_sensor(read, helical):
    columns = {**helical, "M_an [Nm]": [v / -12.4 for v in helical["T_output_Nm"]]}
    found = read("helical_two_stage", columns, '[columns]\n"input.tau" = "M_an [Nm]"\n')
    made = found.sensor("T_input")
    assert (made.kind, made.role, made.reads) == ("torque", "read", "input.tau")
    assert made.repeat_sd == pytest.approx(4e-4 * 48.27, rel=0.05)


def test_another_drive_is_given_by_the_card(read, helical):
    columns = {**helical, "T_input_Nm": [v / -12.4 for v in helical["T_output_Nm"]]}
    given = '[sensors.T_input_Nm]\nreads = "input.tau"\nrole = "given"\n'
    found = read("helical_two_stage", columns, given)
    assert {s.reads for s in found.given} == {"input.w", "input.tau", "room.T"}
    assert found.sensor("T_output").role == "read"
    with pytest.raises(DataError, match="cannot all be given"):
        read(
            "helical_two_stage",
            columns,
            given + '[sensors.T_output]\nrole = "given"\n[sensors.n_input]\nrole = "given"\n',
        )


@pytest.mark.parametrize("path", ["room.T", "input.w"])
def test_a_second_sensor_of_what_drives_is_compared(path, read, helical):
    column = next(name for name in helical if name.startswith({"room.T": "T_amb", "input.w": "n_input"}[path]))
    columns = {**helical, "another": [1.001 * v for v in helical[column]]}
    second = f'[sensors.another]\nreads = "{path}"\nunit = "{column.rpartition("_")[2].replace("C", "degC")}"\n'
    found = read("helical_two_stage", columns, second)
    assert {s.role for s in found.sensors if s.reads == path} == {"given", "read"}
    assert found.sensor("another").role == "read"
    both = f'[sensors.{column.rpartition("_")[0]}]\nrole = "given"\n' + second + 'role = "given"\n'
    with pytest.raises(DataError, match=f"several sensors of {path} are given"):
        read("helical_two_stage", columns, both)


def test_tests_stand_in_running_order_and_rows_in_sequence(read, planetary):
    order = [int(5 * (t - 1) % 6) + 1 for t in planetary["test"]]
    found = read("planetary", {**planetary, "order": order})
    assert list(found.order) == [1, 2, 3, 4, 5, 6]
    assert list(found.test) == [0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5]
    assert list(found.direction) == [1, -1] * 6
    assert list(found.points[:4]) == [1, 2, 11, 12] and list(found.lines[:3]) == [2, 3, 12]


def test_direction_follows_the_sign_of_a_signed_torque(read, helical):
    columns = {c: [*v, *v] for c, v in helical.items()}
    columns["T_output_Nm"] = [*helical["T_output_Nm"], *(-v for v in helical["T_output_Nm"])]
    found = read("helical_two_stage", columns)
    assert list(found.direction) == [1] * 6 + [-1] * 6


#: Whether speed, load and torque at the input turn their sign in the second direction, None without the column; and
#: whether a column says the direction.
BOTH_WAYS = {
    "the model's signs": (True, True, True, False),
    "a load without a sign": (True, False, True, False),
    "no torque has a sign": (True, False, False, False),
    "signed speeds alone": (True, False, None, False),
    "signed speeds and a direction": (True, False, False, True),
    "signed speeds, a direction, one torque": (True, False, None, True),
    "a direction alone": (False, False, False, True),
}


@pytest.mark.parametrize("way", BOTH_WAYS)
def test_both_directions_of_rotation_have_the_signs_of_the_model(read, helical, way):
    *signs, told = BOTH_WAYS[way]
    columns = {c: [*v, *v] for c, v in helical.items()}
    second = np.repeat([1.0, -1.0], 6)
    load = np.abs(columns["T_output_Nm"])
    columns["T_input_Nm"] = load / 12.45 / 0.97
    if told:
        columns["direction"] = np.where(second < 0, 2, 1)
    for column, sign in zip(("n_input_rpm", "T_output_Nm", "T_input_Nm"), signs, strict=True):
        if sign is None:
            del columns[column]
        else:
            columns[column] = np.abs(columns[column]) * (second if sign else 1.0)
    if signs[1]:
        columns["T_output_Nm"] *= -1.0
    card = "sensors.T_output.magnitude = true\n" * (not signs[1])
    card += '[sensors.T_input_Nm]\nreads = "input.tau"\n' * (signs[2] is not None)
    found = read("helical_two_stage", columns, card)
    model = model_values(found)
    assert list(found.direction) == list(second)
    assert list(np.sign(model["input.w"])) == list(second) == list(-np.sign(model["output.tau"]))
    assert "input.tau" not in model or list(np.sign(model["input.tau"])) == list(second)


def test_losses_tell_a_direction_of_the_power_from_one_of_the_rotation(read, helical):
    columns = {c: [*v, *v] for c, v in helical.items()}
    load = columns["T_output_Nm"] = np.abs(columns["T_output_Nm"])
    columns |= {"direction": np.repeat([1, 2], 6), "T_input_Nm": load / 12.45 * np.repeat([1.03, 0.97], 6)}
    card = 'sensors.T_output.magnitude = true\n[sensors.T_input_Nm]\nreads = "input.tau"\n'
    model = model_values(read("helical_two_stage", columns, card))
    assert (model["input.w"] > 0).all() and list(np.sign(model["input.tau"])) == [1.0] * 6 + [-1.0] * 6


def test_dwell_stop_and_start_come_from_the_card_where_no_column_says_them(read, planetary):
    columns = {c: v for c, v in planetary.items() if c != "dwell_min"}
    protocol = "[protocol]\ndwell_min = [120, 60]\nstop_min = 7\nT_start_minus_amb_K = 3\n"
    found = read("planetary", columns, protocol + "ambient_start_minus_reading_K = -2\n")
    assert list(found.dwell[:4] / MINUTE) == [120, 60, 120, 60] and found.stop[1] == 7 * MINUTE
    assert found.start_by_room == 3.0 and found.room_begin == -2.0 and np.isnan(found.room_start).all()
    assert read("planetary", columns, 'protocol = "steady"\n').steady


def test_columns_of_the_table_lead(read, planetary):
    n = len(planetary["test"])
    more = {"T_start_C": [30.0] * n, "T_amb_start_C": [25.0] * n, "stop_min": [9] * n, "humidity_pct": [50] * n}
    found = read("planetary", {**planetary, **more}, "[protocol]\nstop_min = 7\nT_start_minus_amb_K = 3\n")
    assert found.T_start[0] == 303.15 and found.room_start[0] == 298.15
    assert list(found.stop[:2]) == [0, 9 * MINUTE] and found.humidity[0] == 0.5


def test_points_need_no_readings_and_readings_may_be_missing(read, planetary):
    conditions = {c: v for c, v in planetary.items() if c not in ("T_oil_C", "T_oil2_C", "T_wall_C", "T_sun_Nm")}
    assert not read("planetary", conditions, points=True).read
    with pytest.raises(DataError, match="there is nothing to compare"):
        read("planetary", conditions)
    found = read("planetary", {**planetary, "T_oil_C": ["", *planetary["T_oil_C"][1:]]})
    assert np.isnan(found.values["T_oil"][0]) and np.isfinite(found.values["T_oil"][1:]).all()


def test_a_first_half_that_was_run_and_not_read_is_run_all_the_same(read, planetary):
    kept = [k for k in range(12) if k != 2]
    found = read("planetary", {c: [v[k] for k in kept] for c, v in planetary.items()})
    whole = read("planetary", planetary)
    assert found.n == 12 and list(found.direction) == list(whole.direction) and list(found.dwell) == list(whole.dwell)
    assert list(found.stop) == list(whole.stop) and found.points[2] == found.lines[2] == 0
    assert all(np.isnan(found.values[s.name][2]) for s in found.read)
    for name in ("n_carrier", "T_carrier", "T_amb"):
        assert found.values[name][2] == pytest.approx(whole.values[name][2], rel=1e-3)
    assert any("tests of order 2" in w for w in found.warnings)


def test_an_unread_second_half_needs_no_row(read, planetary):
    kept = [k for k in range(12) if k != 3]
    assert read("planetary", {c: [v[k] for k in kept] for c, v in planetary.items()}).n == 11


def test_what_drives_the_model_must_be_there(read, helical):
    columns = {c: v for c, v in helical.items() if c not in ("n_input_rpm", "T_amb_C")}
    with pytest.raises(DataError) as error:
        read("helical_two_stage", {**columns, "n_inputt_rpm": helical["n_input_rpm"]})
    first, second, guess = error.value.problems
    assert "`gearheat card helical_two_stage --data" in guess
    assert '"n_input_rpm" drives the model (input.w) and is missing. Did you mean "n_inputt_rpm"?' in first
    assert '"T_amb_C" drives the model (room.T)' in second


def test_columns_are_alike_by_their_names_not_by_their_units(read, helical):
    names = {"T_oil_C": "Oelsumpf [°C]", "T_amb_C": "Raum [°C]"}
    columns = {names.get(c, c): v for c, v in helical.items()}
    with pytest.raises(DataError) as error:
        read("helical_two_stage", columns, 'columns = { T_oil = "Sumpf [°C]", T_amb = "Raum [°C]" }\n')
    assert error.value.problems[0].endswith('has no column "Sumpf [°C]". Did you mean "Oelsumpf [°C]"?')


def test_an_oil_that_the_catalogue_lacks_is_described_by_the_card(read, planetary):
    columns = {**planetary, "oil": ["VG 320"] * 12}
    with pytest.raises(DataError, match='unknown oil "VG 320"'):
        read("planetary", columns)
    card = "[oil]\nnu40 = 320\nnu100 = 25\n"
    assert set(read("planetary", columns, card).oil) == {"VG 320"}
    with pytest.raises(DataError, match="names 2 that the catalogue lacks: VG 220, VG 320"):
        read("planetary", {**planetary, "oil": ["VG 320"] * 6 + ["VG 220"] * 6}, card)


@pytest.mark.parametrize(
    "rig_name", ["cycloidal", "drum_motor", "fzg_four_square", "harmonic", "helical_two_stage", "planetary", "rv_stage"]
)
def test_every_rig_has_sensors_that_its_own_tables_pass(rig, rig_name, tmp_path):
    path = written(tmp_path / "data.csv", made(rig(rig_name)))
    found = read_campaign(path, rig(rig_name), Card())
    assert found.given and found.read


def test_a_log_is_no_table_of_readings(read, helical):
    n = 10 * len(helical["T_oil_C"])
    columns = {name: [*column] * 10 for name, column in helical.items()} | {"Zeit [min]": [*range(n)]}
    columns["T_oil_C"] = [T + 0.01 * k for k, T in enumerate(columns["T_oil_C"])]
    with pytest.raises(DataError, match="is a log, with a row each 60 s"):
        read("helical_two_stage", columns)
    assert read("helical_two_stage", columns, 'protocol = "steady"').n == n
    assert read("helical_two_stage", columns | {"test": [*range(n)]}).n == n
    assert read("helical_two_stage", columns | {"Zeit [min]": [60 * k for k in range(n)]}).n == n
