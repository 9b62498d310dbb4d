"""Measured tables: the shipped campaign, the duty of its tests, and every way a table can be wrong."""

from pathlib import Path

import numpy as np
import pytest
from gearheat.model.errors import DataError
from gearheat.scenarios.load import load
from gearheat.scenarios.measured import POINTS, Campaign, Driven, Protocol, column_si, read_measured, schedule_of

HEADER = "point,test,order,direction,dwell_min,oil,n_carrier_rpm,T_carrier_Nm,T_sun_Nm,T_oil_C,T_wall_C,T_amb_C"
ROWS = (
    "1,1,1,1,240,PAOR,100,1500,370,45,44,25",
    "2,1,1,2,90,PAOR,100,1500,380,47,45,27",
    "3,2,2,1,240,MINR,150,2000,495,60,58,28",
)
PROTOCOL = Protocol(
    {"carrier.w": Driven("n_carrier_rpm"), "carrier.tau": Driven("T_carrier_Nm", (1.0, -1.0))}, "room.T", "oil", 300.0
)


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    found = load("planetary").campaign
    assert found is not None
    return found


def table(tmp_path: Path, *rows: str, header: str = HEADER) -> Path:
    path = tmp_path / "data.csv"
    path.write_text("\n".join((header, *rows)) + "\n", encoding="utf-8")
    return path


def problems(path: Path) -> tuple[str, ...]:
    with pytest.raises(DataError) as raised:
        read_measured(path)
    return raised.value.problems


class TestShippedCampaign:
    def test_it_has_36_tests_of_two_directions(self, campaign: Campaign) -> None:
        assert len(campaign.readings) == 72
        assert len(campaign.tests()) == 36
        assert all([half.direction for half in test.halves] == [1, 2] for test in campaign.tests())
        assert campaign.warnings == ()

    def test_oils_stand_as_in_the_test_plan(self, campaign: Campaign) -> None:
        oils = [test.oil for test in campaign.tests()]
        assert oils == ["PAOR"] * 21 + ["MINR"] * 5 + ["MINE"] * 5 + ["PAGD"] * 5

    def test_printed_efficiencies_follow_from_the_readings(self, campaign: Campaign) -> None:
        carrier, sun = campaign.column("T_carrier_Nm"), 4 * campaign.column("T_sun_Nm")
        multiplier = np.array([r.direction == 1 for r in campaign.readings])
        eta = np.where(multiplier, sun / carrier, carrier / sun)
        np.testing.assert_allclose(100 * eta, campaign.column("eta_printed_pct"), atol=0.03)

    def test_printed_losses_follow_from_the_readings(self, campaign: Campaign) -> None:
        loss = campaign.column("T_carrier_Nm") - 4 * campaign.column("T_sun_Nm")
        np.testing.assert_allclose(np.abs(loss), campaign.column("loss_printed_Nm"), atol=0.4)

    def test_the_torque_held_is_0_9675_of_the_imposed_one(self, campaign: Campaign) -> None:
        share = campaign.column("T_carrier_Nm") / campaign.column("T_set_Nm")
        assert np.mean(share) == pytest.approx(0.9675, abs=5e-5)
        np.testing.assert_allclose(share, 0.9675, atol=3e-3)

    def test_the_seal_stopped_test_16_after_75_minutes(self, campaign: Campaign) -> None:
        dwells = [tuple(half.values["dwell_min"] for half in test.halves) for test in campaign.tests()]
        assert dwells[15] == (240, 75)
        assert set(dwells[:15] + dwells[16:]) == {(240, 90)}

    def test_an_unknown_column_is_refused_with_a_suggestion(self, campaign: Campaign) -> None:
        with pytest.raises(DataError, match='Did you mean "T_oil_C" or "T_oil2_C"'):
            campaign.column("T_oil3_C")


class TestSchedule:
    def test_signs_and_jumps(self, campaign: Campaign) -> None:
        run = schedule_of(campaign, campaign.tests()[0])
        np.testing.assert_array_equal(run.schedule.time / 60, [0, 240, 240, 245, 245, 335])
        n = np.array([102.6, 102.6, 0, 0, 102.5, 102.5])
        np.testing.assert_allclose(run.schedule.values["carrier.w"], n * np.pi / 30, rtol=1e-12)
        np.testing.assert_allclose(run.schedule.values["carrier.tau"], [1549.5, 1549.5, 0, 0, -1549.5, -1549.5])
        assert run.moments == (14400.0, 20100.0)

    def test_the_room_stays_and_then_goes_in_one_line(self, campaign: Campaign) -> None:
        run = schedule_of(campaign, campaign.tests()[0])
        T, time = run.schedule.values["room.T"] - 273.15, run.schedule.time
        assert T[:3] == pytest.approx([25.18] * 3)
        assert T[-1] == pytest.approx(26.96)
        np.testing.assert_allclose(T[2:], 25.18 + (26.96 - 25.18) * (time[2:] - 14400) / (20100 - 14400))
        assert run.T_start == pytest.approx(25.18 + 273.15)

    def test_columns_of_the_table_overrule_the_protocol(self, tmp_path: Path) -> None:
        header = HEADER + ",T_start_C,T_amb_start_C,stop_min"
        path = table(tmp_path, ROWS[0] + ",21,22,", ROWS[1] + ",21,22,20", header=header)
        campaign = read_measured(path, PROTOCOL)
        run = schedule_of(campaign, campaign.tests()[0])
        np.testing.assert_array_equal(run.schedule.time / 60, [0, 240, 240, 260, 260, 350])
        assert run.schedule.values["room.T"][:2] - 273.15 == pytest.approx([22, 25])
        assert run.T_start == pytest.approx(294.15)

    def test_a_test_may_begin_with_the_other_direction(self, tmp_path: Path) -> None:
        campaign = read_measured(table(tmp_path, ROWS[1], ROWS[0].replace("1,1,1,1", "1,1,2,1", 1)), PROTOCOL)
        run = schedule_of(campaign, campaign.tests()[0])
        np.testing.assert_array_equal(np.sign(run.schedule.values["carrier.tau"]), [-1, -1, 0, 0, 1, 1])

    def test_it_needs_a_protocol(self, tmp_path: Path) -> None:
        campaign = read_measured(table(tmp_path, *ROWS))
        with pytest.raises(DataError, match="how it was run is not known"):
            schedule_of(campaign, campaign.tests()[0])

    def test_it_starts_every_temperature_and_nothing_else(self, campaign: Campaign) -> None:
        from gearheat.model.core.flatten import flatten
        from gearheat.model.machines.spec import assemble

        flat = flatten(assemble(load("planetary").driven({"carrier": ("tau",), "sun": ("tau",)}).spec))
        start = schedule_of(campaign, campaign.tests()[0]).start(flat)
        assert set(start) == {"oil.T", "gears.T", "carrier_body.T", "wall.T", "surface.T"}
        assert "rotor.w" in flat.index


class TestUnits:
    @pytest.mark.parametrize(
        ("name", "value", "si"),
        [("T_oil_C", 20.0, 293.15), ("n_carrier_rpm", 30.0, np.pi), ("T_sun_Nm", 2.5, 2.5), ("dwell_min", 90.0, 5400.0)]
        + [("time_s", 7.0, 7.0), ("humidity_pct", 40.0, 0.4), ("point", 3.0, 3.0)],
    )
    def test_the_ending_of_a_name_is_its_unit(self, name: str, value: float, si: float) -> None:
        assert column_si(name, value) == pytest.approx(si, rel=1e-12)


class TestBadTables:
    def test_no_file(self, tmp_path: Path) -> None:
        assert problems(tmp_path / "no.csv") == (f"{tmp_path / 'no.csv'}: there is no such file. Check the path.",)

    def test_a_folder(self, tmp_path: Path) -> None:
        assert problems(tmp_path) == (f"{tmp_path}: cannot be read (Is a directory). Give a CSV file.",)

    def test_empty(self, tmp_path: Path) -> None:
        (path := tmp_path / "data.csv").write_text("\n\n")
        expected = "data.csv: the file is empty. It needs a line of column names and at least one row."
        assert problems(path) == (expected,)

    def test_no_rows(self, tmp_path: Path) -> None:
        assert problems(table(tmp_path)) == ("data.csv: there is no row under the column names. Add at least one.",)

    def test_no_text(self, tmp_path: Path) -> None:
        (path := tmp_path / "data.csv").write_bytes(b"\xff\xfe\x00\x81")
        assert problems(path) == ("data.csv: is not UTF-8 text. Save it as a CSV file.",)

    def test_tabs(self, tmp_path: Path) -> None:
        path = table(tmp_path, ROWS[0].replace(",", "\t"), header=HEADER.replace(",", "\t"))
        assert problems(path) == ("data.csv line 1: the columns are separated by tabs. Write commas or semicolons.",)

    def test_a_decimal_comma(self, tmp_path: Path) -> None:
        found = problems(table(tmp_path, ROWS[0].replace("45", "45,3"), ROWS[1]))
        expected = "data.csv line 2: 13 cells under 12 column names. Write one cell per column, decimals with a point."
        assert found == (expected,)

    def test_a_column_is_missing_or_misspelt(self, tmp_path: Path) -> None:
        found = problems(table(tmp_path, *ROWS, header=HEADER.replace("T_oil_C", "T_oi_C").replace("T_amb_C", "room")))
        assert found == (
            'data.csv line 1: column "T_amb_C" (room temperature) is missing. Add it.',
            'data.csv line 1: column "T_oil_C" (oil temperature) is missing. Is it "T_oi_C"? Rename it.',
        )

    def test_a_column_is_there_twice(self, tmp_path: Path) -> None:
        found = problems(table(tmp_path, *ROWS, header=HEADER.replace("T_wall_C", "T_oil_C")))
        assert found == ('data.csv line 1: column "T_oil_C" is there twice. Keep one.',)

    def test_wrong_cells_are_all_named(self, tmp_path: Path) -> None:
        first = "1,1,1,3,240,PAOR,1OO,1500,370,nan,44,"
        second = "2.5,1,1,2,0,PAOOR,100,-1500,380,1e999,-300,27"
        assert set(problems(table(tmp_path, first, second))) == {
            'data.csv line 2: direction = "3" is not known. Write one of: 1, 2.',
            'data.csv line 2: n_carrier_rpm = "1OO" is no number. Write a number with a decimal point and no unit.',
            'data.csv line 2: T_oil_C = "nan" is not finite. Write a number or leave out the row.',
            'data.csv line 2: T_amb_C = "" is empty. Write a number.',
            'data.csv line 3: point = "2.5" is no whole number.',
            'data.csv line 3: dwell_min = "0" is out of range. The time the point was held must be above 0.',
            'data.csv line 3: T_carrier_Nm = "-1500" is out of range.'
            " The magnitude of the carrier torque must be at least 0.",
            'data.csv line 3: T_oil_C = "1e999" is not finite. Write a number or leave out the row.',
            'data.csv line 3: T_wall_C = "-300" is out of range. The wall temperature must be above -273.15.',
            'data.csv line 3: unknown oil "PAOOR". Did you mean "PAOR"?',
        }

    def test_contradictions_within_a_test(self, tmp_path: Path) -> None:
        rows = (
            "1,1,5,1,240,PAOR,100,1500,370,45,44,25",
            "1,1,4,2,90,MINR,100,1500,380,47,45,27",
            "3,1,5,2,90,PAOR,100,1500,380,47,45,27",
        )
        assert problems(table(tmp_path, *rows)) == (
            "data.csv line 3: point 1 is the number of line 2 too. Give each reading its own.",
            "data.csv line 3: test 1 has oil PAOR in line 2, here MINR. Mend one of them.",
            "data.csv line 3: order goes back within test 1 (4 after 5). Sort its rows.",
            "data.csv line 4: test 1 has direction 2 in line 3 too. Mend one of them.",
            "data.csv line 4: test 1 has oil MINR in line 3, here PAOR. Mend one of them.",
        )

    def test_a_page_of_problems_is_enough(self, tmp_path: Path) -> None:
        rows = [f"{i},{i},{i},1,240,PAOR,x,1500,370,45,44,25" for i in range(1, 101)]
        found = problems(table(tmp_path, *rows))
        assert len(found) == 31
        assert found[-1] == "data.csv: 70 more problems. Mend the first ones and read it again."


class TestTolerantReading:
    def test_semicolons_with_decimal_commas(self, tmp_path: Path) -> None:
        row = ROWS[0].replace(",", ";").replace(";45;", ";45,25;")
        campaign = read_measured(table(tmp_path, row, header=HEADER.replace(",", ";")))
        assert campaign.readings[0].values["T_oil_C"] == 45.25

    def test_unknown_columns_warn(self, tmp_path: Path) -> None:
        path = table(tmp_path, *(row + ",7,8" for row in ROWS), header=HEADER + ",T_oil2,colour")
        assert read_measured(path).warnings == (
            'data.csv: column "T_oil2" is not used. Did you mean "T_oil2_C"?',
            'data.csv: column "colour" is not used.',
        )

    def test_optional_columns_may_be_missing_or_empty(self, tmp_path: Path) -> None:
        header = HEADER + ",T_oil2_C"
        campaign = read_measured(table(tmp_path, ROWS[0] + ",46.5", ROWS[1] + ",", header=header))
        assert campaign.has("T_oil2_C")
        assert not campaign.has("humidity_pct")
        assert [r.given("T_oil2_C") for r in campaign.readings] == [True, False]

    def test_rows_out_of_running_order_warn_and_are_run_in_order(self, tmp_path: Path) -> None:
        campaign = read_measured(table(tmp_path, ROWS[2], *ROWS[:2]))
        assert [test.number for test in campaign.tests()] == [1, 2]
        assert campaign.warnings == ("data.csv line 3: order goes back (1 after 2). Tests are taken in this order.",)

    def test_points_need_no_readings(self, tmp_path: Path) -> None:
        header = "point,test,order,direction,dwell_min,oil,n_carrier_rpm,T_carrier_Nm,T_amb_C"
        campaign = read_measured(table(tmp_path, "1,1,1,1,240,PAOR,100,1500,25", header=header), columns=POINTS)
        assert campaign.readings[0].si("T_carrier_Nm") == 1500

    def test_oils_beside_the_catalogue(self, tmp_path: Path) -> None:
        path = table(tmp_path, ROWS[0].replace("PAOR", "X320"))
        assert read_measured(path, oils=("X320",)).readings[0].oil == "X320"

    def test_a_byte_order_mark_and_blank_lines_do_no_harm(self, tmp_path: Path) -> None:
        path = table(tmp_path, ROWS[0], "", ROWS[1], ",,,,,,,,,,,", header="\ufeff" + HEADER)
        assert [r.line for r in read_measured(path).readings] == [2, 4]
