"""Duty tables: units in the header, jumps, and every way a table can be wrong."""

from pathlib import Path

import numpy as np
import pytest
from gearheat.model.core.flat import Quantity
from gearheat.model.errors import DataError
from gearheat.scenarios.duty import duty_names, read_duty
from gearheat.scenarios.load import load

INPUTS = {
    q.name: q
    for q in (
        Quantity("carrier.w", "rad/s", "angular velocity"),
        Quantity("carrier.tau", "N.m", "torque into the gearbox"),
        Quantity("room.T", "K", "temperature of the room", low=0.0, low_open=True),
    )
}
HEADER = "time [min],carrier.w [rpm],carrier.tau [N.m],room.T [degC]"


def table(tmp_path: Path, *rows: str, header: str = HEADER) -> Path:
    path = tmp_path / "duty.csv"
    path.write_text("\n".join((header, *rows)) + "\n", encoding="utf-8")
    return path


def problems(path: Path) -> tuple[str, ...]:
    with pytest.raises(DataError) as raised:
        read_duty(path, INPUTS)
    return raised.value.problems


def test_a_duty_in_si_with_a_jump(tmp_path: Path) -> None:
    path = table(tmp_path, "0,100,1500,25", "240,100,1500,26", "240,0,0,26", "245,0,0,26")
    schedule = read_duty(path, INPUTS)
    np.testing.assert_array_equal(schedule.time, [0, 14400, 14400, 14700])
    np.testing.assert_allclose(schedule.values["carrier.w"], np.array([100, 100, 0, 0]) * np.pi / 30, rtol=1e-14)
    np.testing.assert_array_equal(schedule.values["carrier.tau"], [1500, 1500, 0, 0])
    np.testing.assert_allclose(schedule.values["room.T"], [298.15, 299.15, 299.15, 299.15], rtol=1e-15)
    assert [schedule.time[s].tolist() for s in schedule.stretches()] == [[0, 14400], [14400, 14700]]
    assert duty_names(path) == ("carrier.w", "carrier.tau", "room.T")


def test_the_inputs_of_a_rig_and_of_a_flat_model(tmp_path: Path) -> None:

    scenario = load("planetary")
    path = table(tmp_path, "0,100,1500,25", "240,100,1500,26")
    by_rig, by_model = read_duty(path, scenario.inputs()), read_duty(path, scenario.spec.flat())
    assert list(by_rig.values) == list(by_model.values)


@pytest.mark.parametrize(
    ("header", "expected"),
    [
        ("time,room.T [degC]", 'column "time" has no unit. Write it in brackets: "time [s]".'),
        (
            "moment [s],room.T [degC]",
            'the first column is "moment [s]". It must be the time with its unit, such as "time [min]".',
        ),
        ("time [K],room.T [degC]", 'column "time [K]": the unit does not fit time. Write it in brackets: "time [s]".'),
        ("time [s],room.T", 'column "room.T" has no unit. Write it in brackets: "room.T [degC]".'),
        (
            "time [s],room.T [rpm]",
            'column "room.T [rpm]": the unit does not fit temperature of the room.'
            ' Write it in brackets: "room.T [degC]".',
        ),
        ("time [s],rom.T [degC]", 'there is no input "rom.T". Did you mean "room.T"?'),
        ("time [s],q [W]", 'there is no input "q". Inputs: carrier.w, carrier.tau, room.T.'),
        ("time [s],Drehmoment", 'there is no input "Drehmoment". Write "carrier.tau [N.m]" (torque into the gearbox).'),
        ("time [s],n [1/min]", 'there is no input "n". Write "carrier.w [rpm]" (angular velocity).'),
        (
            "time [s],T_oil (°C)",
            'there is no input "T_oil". Temperatures of oil and walls are results: leave the column out.',
        ),
        (
            "time [s],carrier.w (1/s)",
            'column "carrier.w (1/s)": its unit may mean revolutions or radians. Write "carrier.w [Hz]" for revolutions'
            ' per second, "carrier.w [rad/s]" for radians.',
        ),
    ],
)
def test_a_wrong_header(tmp_path: Path, header: str, expected: str) -> None:
    assert problems(table(tmp_path, "0,20", "1,20", header=header)) == (f"duty.csv line 1: {expected}",)


@pytest.mark.parametrize("name", ["Time [s]", "time (s)", "time_s", "t [s]", "t_s", "Zeit [s]"])
def test_the_time_as_it_is_met(tmp_path: Path, name: str) -> None:
    assert read_duty(table(tmp_path, "0,20", "60,21", header=f"{name},room.T [degC]"), INPUTS).stop == 60


@pytest.mark.parametrize(
    "rows", [("2016-03-14T06:00", "2016-03-14 06:01"), ("3/14/2016 11:59 PM", "3/15/2016 12:00 AM")]
)
def test_times_of_a_calendar_count_from_the_first(tmp_path: Path, rows: tuple[str, str]) -> None:
    written = table(tmp_path, *(f"{row},20" for row in rows), header="Zeit,room.T (°C)")
    assert read_duty(written, INPUTS).time.tolist() == [0, 60]


def test_no_input(tmp_path: Path) -> None:
    expected = "duty.csv line 1: no input beside the time. Add a column, one of: carrier.w, carrier.tau, room.T."
    assert problems(table(tmp_path, "0", "1", header="time [s]")) == (expected,)


def test_wrong_cells_are_all_named(tmp_path: Path) -> None:
    rows = ("0,abc,1500,25", "31.5,100,nan,25", "31.0,100,1500,-300", ",100,1500,25", "40,100,1_000,25")
    assert problems(table(tmp_path, *rows)) == (
        'duty.csv line 5: time = "" is empty. Write a number.',
        'duty.csv line 2: carrier.w = "abc" is no number. Write a number with a decimal point and no unit.',
        'duty.csv line 3: carrier.tau = "nan" is not finite. Write a number or leave out the row.',
        'duty.csv line 6: carrier.tau = "1_000" is no number. Write a number with a decimal point and no unit.',
        'duty.csv line 4: room.T = "-300" is out of range. It must be above 0 K.',
        "duty.csv line 4: time goes back (31.0 after 31.5). Sort the rows by time.",
    )


def test_header_and_cells_are_told_together(tmp_path: Path) -> None:
    path = table(
        tmp_path, "0,1,20,,2", "9,x,20,,2,7", "60,x,20,,2", header="time [s],carrier.w [rpm],a,,carrier.w [rpm]"
    )
    assert problems(path) == (
        'duty.csv line 1: column "carrier.w [rpm]" is there twice. Keep one.',
        "duty.csv line 1: column 4 has no name. Give it one.",
        "duty.csv line 3: 6 cells under 5 column names. Write one cell per column, decimals with a point.",
        'duty.csv line 4: carrier.w = "x" is no number. Write a number with a decimal point and no unit.',
        'duty.csv line 1: there is no input "a". Inputs: carrier.w, carrier.tau, room.T.',
    )


def test_a_duty_that_lasts_no_time(tmp_path: Path) -> None:
    expected = "duty.csv: the table lasts no time. A duty needs at least two different times."
    assert problems(table(tmp_path, "5,100,1500,25", "5,100,1500,25")) == (expected,)


def test_empty(tmp_path: Path) -> None:
    (path := tmp_path / "duty.csv").write_text("")
    expected = "duty.csv: the file is empty. It needs a line of column names and at least one row."
    assert problems(path) == (expected,)
