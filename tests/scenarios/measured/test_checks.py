"""Tables and cards that cannot be: each is refused with the row and what to do."""

from __future__ import annotations

from dataclasses import replace

import pytest
from gearheat.model.errors import DataError
from gearheat.scenarios.measured.checks import (
    not_in_reference,
    outlying,
    same_as_reference,
    too_small,
    unlike_reference,
)
from made_tables import made


def problems(read, rig, columns, card="") -> str:
    with pytest.raises(DataError) as error:
        read(rig, columns, card)
    return "\n".join(error.value.problems)


def times(columns, column, factor, digits=4):
    return {**columns, column: [round(v * factor, digits) for v in columns[column]]}


def test_torque_in_kilonewtonmetres(read, planetary, helical):
    found = problems(read, "planetary", times(planetary, "T_carrier_Nm", 1e-3, 6))
    assert "data.csv line 4: T_carrier_Nm is at most 2.5 N.m, the rig runs at 2500 N.m. Check its unit" in found
    assert "T_output_Nm is at most 0.59 N.m" in problems(read, "helical_two_stage", times(helical, "T_output_Nm", 1e-3))


@pytest.mark.parametrize("factor", [0.0, 4.0, 0.25, 1e-3])
def test_sun_torque_zero_or_far_off(read, planetary, factor):
    found = problems(read, "planetary", times(planetary, "T_sun_Nm", factor))
    assert "T_sun_Nm" in found and "data.csv" in found
    assert "the model" in found or "in all 12 rows" in found


def test_speed_in_radians_per_second(read, rig, planetary):
    for name, columns, column in (
        ("planetary", planetary, "n_carrier_rpm"),
        ("harmonic", made(rig("harmonic")), "n_wave_generator_rpm"),
    ):
        found = problems(read, name, times(columns, column, 0.10472))
        assert "over the room, the model gives" in found and f"{column} (rpm)" in found


def test_a_torque_of_the_other_sign(read, helical, planetary):
    columns = {**helical, "T_input_Nm": [v / 12.4 for v in helical["T_output_Nm"]]}
    assert "its sign is the other one, or that of T_output_Nm is. Turn it, or say magnitude = true" in problems(
        read, "helical_two_stage", columns, '[sensors.T_input_Nm]\nreads = "input.tau"\n'
    )
    mixed = {**columns, "T_input_Nm": [v * w for v, w in zip(columns["T_input_Nm"], [1, -1] * 3, strict=True)]}
    assert "its sign is the other one in 3 of 6 rows" in problems(
        read, "helical_two_stage", mixed, '[sensors.T_input_Nm]\nreads = "input.tau"\n'
    )
    turned = {**planetary, "direction": [3 - d for d in planetary["direction"]]}
    assert "efficiency of 1.0" in problems(read, "planetary", turned)


def test_instruments_that_err_are_no_other_unit(read, helical):
    torques = {**helical, "T_input_Nm": [-v / 13 for v in helical["T_output_Nm"]]}
    assert read("helical_two_stage", torques, '[sensors.T_input_Nm]\nreads = "input.tau"\n').n == 6, "efficiency 1.03"


def test_all_temperatures_equal(read, planetary):
    columns = {**planetary, **{c: [50.0] * 12 for c in ("T_oil_C", "T_wall_C")}}
    found = problems(read, "planetary", columns)
    assert "T_wall_C holds the numbers of T_oil_C" in found
    assert "T_oil_C is 50 degC in all 12 rows" in found


def test_temperatures_in_another_unit(read, helical):
    kelvin = {**helical, "T_oil_C": [round(v + 273.15, 2) for v in helical["T_oil_C"]]}
    assert "above 200 degC. Check its unit, which is taken for degC" in problems(read, "helical_two_stage", kelvin)
    below = {**helical, "T_oil_K": helical["T_oil_C"]}
    del below["T_oil_C"]
    assert "below -60 degC. Check its unit, which is taken for K" in problems(read, "helical_two_stage", below)
    fahrenheit = {**helical, "T_oil_C": [1.8 * v + 32 for v in helical["T_oil_C"]]}  # beside a room in degC
    found = problems(read, "helical_two_stage", fahrenheit)
    assert "In degF it would fit. Check its unit, which is taken for degC, and those of what drives it" in found


@pytest.mark.parametrize("factor", [1e-3, 1e3])
def test_accuracies_a_thousand_times_off(read, helical, factor):
    card = (
        f'[channels]\nT_oil = {{ repeat_sd = "{0.35 * factor} K" }}\nT_output_Nm = {{ offset_sd = {0.5 * factor} }}\n'
    )
    found = problems(read, "helical_two_stage", helical, card)
    assert "T_oil: repeat_sd = " in found and "0.35 K is usual" in found and "T_output: offset_sd = " in found


def test_rows_and_points_that_are_there_twice(read, planetary):
    doubled = {c: [*v, v[-1]] for c, v in planetary.items()}
    found = problems(read, "planetary", doubled)
    assert "data.csv line 14: point 12 is the number of line 13 too." in found
    assert "data.csv line 14: all readings are those of line 13. Keep one of them." in found


def test_contradictions_within_a_test(read, planetary):
    order, oil = [k // 2 + 1 for k in range(12)], ["PAOR"] * 12
    order[3], oil[5] = 1, "MINR"
    found = problems(read, "planetary", {**planetary, "order": order, "oil": oil})
    assert "data.csv line 5: order goes back within test 2 (1 after 2). Sort its rows." in found
    assert "data.csv line 7: test 3 has oil PAOR in line 6, here MINR. Mend one of them." in found


def test_order_that_goes_back_between_tests_warns(read, planetary):
    order = [[2, 1, 3, 4, 5, 6][t - 1] for t in planetary["test"]]
    found = read("planetary", {**planetary, "order": order})
    assert any("line 4: order goes back (1 after 2). Tests are taken in this order." in w for w in found.warnings)


def test_wrong_cells_are_all_named(read, planetary):
    columns = {c: list(v) for c, v in planetary.items()}
    columns["n_carrier_rpm"][0], columns["T_carrier_Nm"][1], columns["T_amb_C"][2] = "1OO", -1500, ""
    columns["direction"][3], columns["oil"][4] = 3, "PAOOR"
    found = problems(read, "planetary", columns)
    for text in (
        'data.csv line 2: n_carrier_rpm = "1OO" is no number.',
        'data.csv line 3: T_carrier_Nm = "-1500" is out of range.',
        'data.csv line 4: T_amb_C = "" is empty.',
        'data.csv line 5: direction = "3" is not known. Write one of: 1, 2, -1, 0.',
        'data.csv line 6: unknown oil "PAOOR". Did you mean "PAOR"?',
    ):
        assert text in found, text


def test_too_few_rows_and_a_campaign_that_is_its_own_reference(read, helical):
    whole = read("helical_two_stage", helical)
    short = read("helical_two_stage", {c: v[:4] for c, v in helical.items()})
    assert not too_small(whole) and "4 readings of 4 tests are too few" in too_small(short)[0]
    assert "its readings are those of the reference" in same_as_reference(whole, whole)[0]
    assert not same_as_reference(short, whole)


def test_a_reference_without_a_compared_channel_warns(read, helical):
    whole = read("helical_two_stage", helical)
    assert not not_in_reference(whole, whole)
    less = read("helical_two_stage", {c: v for c, v in helical.items() if c != "T_wall_C"})
    assert [text.partition(",")[0] for text in not_in_reference(whole, less)] == ["data.csv lacks T_wall_C"]
    speed = next(s.name for s in whole.given if s.kind == "speed")
    slip = replace(whole, values={**whole.values, speed: whole.values[speed] / 60})
    (said,) = unlike_reference(slip, whole)
    assert not unlike_reference(whole, whole)
    assert "in data.csv, 1015 rpm in data.csv. Check that the units of both are what they say." in said


def test_points_far_outside_warn(read, helical):
    whole = read("helical_two_stage", helical)
    points = {**helical, "n_input_rpm": [v * 1.5 for v in helical["n_input_rpm"]]}
    far = read("helical_two_stage", points, points=True)
    assert "n_input_rpm of 2 points is far outside of 580 rpm to 1450 rpm" in outlying(whole, far)[0]
    assert not outlying(whole, whole)


def test_copies_of_readings_do_not_count(read, helical):
    copied = read("helical_two_stage", {c: [v[3]] * 6 for c, v in helical.items()})
    assert "data.csv lines 6 to 7, 2 of them: all readings are those of line 2. Keep one of them." in copied.warnings
    assert "6 readings of 6 tests, 5 of them copies, are too few" in too_small(copied)[0]


def test_magnitudes_a_little_below_zero_are_an_error_of_the_zero(read, helical):
    card, torque = "sensors.T_output.magnitude = true\n", [-v for v in helical["T_output_Nm"]]
    found = read("helical_two_stage", {**helical, "T_output_Nm": [-3.0, *torque[1:]]}, card)
    assert found.values["T_output"][0] == -3.0
    assert (
        "line 2: T_output_Nm holds magnitudes and is below zero, in 1 of 6 rows, by 3 N.m at most" in found.warnings[0]
    )
    assert 'line 2: T_output_Nm = "-51" is out of range. The output.tau must be at least 0.' in problems(
        read, "helical_two_stage", {**helical, "T_output_Nm": [-51, *torque[1:]]}, card
    )
    stated = card + 'channels.T_output.offset_sd = "20 N.m"\n'
    assert read("helical_two_stage", {**helical, "T_output_Nm": [-51, *torque[1:]]}, stated).warnings


@pytest.mark.parametrize(("eta", "warned"), [(0.97, 0), (1.04, 1), (1.2, 1)])
def test_an_efficiency_above_1_is_told(read, helical, eta, warned):
    columns = {**helical, "T_input_Nm": [-v / 12.4 / eta for v in helical["T_output_Nm"]]}
    found = read("helical_two_stage", columns, 'sensors.T_input_Nm.reads = "input.tau"')
    assert len(found.warnings) == warned
    assert all("more than 1 in 6 of 6 rows. No gearbox has it" in text for text in found.warnings)
    columns["T_input_Nm"] = [v * eta / 1.3 for v in columns["T_input_Nm"]]
    assert "give an efficiency of 1.28" in problems(
        read, "helical_two_stage", columns, 'sensors.T_input_Nm.reads = "input.tau"'
    )


@pytest.mark.parametrize("name", ["Mittelwert", "mean:", ""])
def test_a_row_below_that_sums_up_is_no_test(read, helical, name):
    columns = {"test": [*range(1, 7), name], **{c: [*v, v[2]] for c, v in helical.items()}}
    assert f'line 8: test = "{name}" is no test. Write which one' in problems(read, "helical_two_stage", columns)


def test_cells_rows_and_units_are_told_at_once(read, helical):
    columns = {c.replace("T_amb_C", "T_amb [bar]"): list(v) for c, v in helical.items()}
    columns["T_oil_C"][0], columns["T_wall_C"][1] = "warm", "1,2"
    found = problems(read, "helical_two_stage", columns)
    for text in ('T_oil_C = "warm"', "line 3: 6 cells under 5 column names", '"bar" does not fit degC'):
        assert text in found, text
