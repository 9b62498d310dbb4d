"""Tables that users write: every way one can be wrong, and what is read all the same."""

import math
from pathlib import Path

import pytest
from gearheat.model.errors import DataError
from gearheat.scenarios.csv_table import Column, Table, parse, raise_all, read_cells, read_header

COLUMNS = (
    Column("point", "number of the reading", "count", at_least=0),
    Column("direction", "direction (1 = multiplier, 2 = reducer)", "count", options=(1, 2)),
    Column("dwell_min", "time the point was held", above=0),
    Column("T_oil_C", "oil temperature", above=-273.15),
    Column("T_oil2_C", "oil temperature at a second place", required=False, above=-273.15),
)
HEADER = "point,direction,dwell_min,T_oil_C"
ROWS = ("1,1,240,45", "2,2,90,47")


def read(path: Path) -> Table:
    found, problems = parse(path, COLUMNS)
    raise_all(problems, path.name)
    return found


def table(tmp_path: Path, *rows: str, header: str = HEADER) -> Path:
    (path := tmp_path / "data.csv").write_text("\n".join((header, *rows)) + "\n", encoding="utf-8")
    return path


def problems(path: Path) -> tuple[str, ...]:
    with pytest.raises(DataError) as raised:
        read(path)
    return raised.value.problems


def test_no_file_and_a_folder(tmp_path: Path) -> None:
    assert problems(tmp_path) == (f"{tmp_path}: is a folder. Give a CSV file.",)
    assert problems(tmp_path / "no.csv") == (f"{tmp_path / 'no.csv'}: there is no such file. Check the path.",)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"\n\n", "data.csv: the file is empty. It needs a line of column names and at least one row."),
        (HEADER.encode(), "data.csv: there is no row under the column names. Add at least one."),
        (b"\x00\xfe\x00\x81", "data.csv: is not UTF-8 text. Save it as a CSV file."),
        (b"PK\x03\x04 \xe9", "data.csv: is not UTF-8 text. Save it as a CSV file."),
        (
            f"{HEADER}\n1,1,240,45,3\n{ROWS[1]}\n".encode(),
            "data.csv line 2: 5 cells under 4 column names. Write one cell per column, decimals with a point.",
        ),
        (
            f"{HEADER.replace('dwell_min', 'T_oil_C')}\n{ROWS[0]}".encode(),
            'data.csv line 1: column "T_oil_C" is there twice. Keep one.',
        ),
    ],
)
def test_what_is_no_table(tmp_path: Path, content: bytes, said: str) -> None:
    (path := tmp_path / "data.csv").write_bytes(content)
    assert said in problems(path)


def test_a_column_is_missing_or_misspelt(tmp_path: Path) -> None:
    header = HEADER.replace("T_oil_C", "T_oi_C").replace("dwell_min", "held")
    assert problems(table(tmp_path, *ROWS, header=header)) == (
        'data.csv line 1: column "dwell_min" (time the point was held) is missing. Add it.',
        'data.csv line 1: column "T_oil_C" (oil temperature) is missing. Is it "T_oi_C"? Rename it.',
    )


def test_wrong_cells_are_all_named(tmp_path: Path) -> None:
    assert set(problems(table(tmp_path, "1,3,24O,nan", "2.5,1,0,-300", "3,1,,1e999"))) == {
        'data.csv line 2: direction = "3" is not known. Write one of: 1, 2.',
        'data.csv line 2: dwell_min = "24O" is no number. Write a number with a decimal point and no unit.',
        'data.csv line 2: T_oil_C = "nan" is not finite. Write a number or leave out the row.',
        'data.csv line 3: point = "2.5" is no whole number.',
        'data.csv line 3: dwell_min = "0" is out of range. The time the point was held must be above 0.',
        'data.csv line 3: T_oil_C = "-300" is out of range. The oil temperature must be above -273.15.',
        'data.csv line 4: dwell_min = "" is empty. Write a number.',
        'data.csv line 4: T_oil_C = "1e999" is not finite. Write a number or leave out the row.',
    }


def test_a_page_of_problems_is_enough(tmp_path: Path) -> None:
    with pytest.raises(DataError) as raised:
        raise_all([f"data.csv line {k}: is odd." for k in range(100)], "data.csv")
    assert len(raised.value.problems) == 31
    assert raised.value.problems[-1] == "data.csv: 70 more problems. Mend the first ones and read it again."


def test_no_problem_hides_another(tmp_path: Path) -> None:
    said = "is no number. Write a number with a decimal point and no unit."
    assert problems(table(tmp_path, *(f"{i},1,x{i},45" for i in range(1, 101)), "1,1,90", "8,1,90,warm")) == (
        "data.csv line 102: 3 cells under 4 column names. Write one cell per column, decimals with a point.",
        *(f'data.csv line {i + 1}: dwell_min = "x{i}" {said}' for i in range(1, 4)),
        f'data.csv lines 5 to 101, 97 of them: dwell_min = "..." {said}',
        f'data.csv line 103: T_oil_C = "warm" {said}',
    )


@pytest.mark.parametrize("sign", [";", "\t"])
def test_semicolons_or_tabs_with_decimal_commas(tmp_path: Path, sign: str) -> None:
    path = table(tmp_path, sign.join(("1", "1", "240", "45,25")), header=HEADER.replace(",", sign))
    assert read(path).columns["T_oil_C"] == (45.25,)


def test_a_table_in_the_encoding_of_windows(tmp_path: Path) -> None:
    (path := tmp_path / "data.csv").write_bytes("Ölsumpf [°C];n\n45,25;1\n".encode("cp1252"))
    assert read_cells(path) == (["Ölsumpf [°C]", "n"], [(2, ["45.25", "1"])])


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        (("1;1;1.450;45,5",), '"1.450" may be 1.45 or 1450'),
        (("1;1;1.450;45",), '"1.450" may be 1.45 or 1450'),
        (("1;1;1,450;45.5",), '"1,450" may be 1.45 or 1450'),
        (("1;1;240;45", "2;2;90,5;-1.250"), 'line 3: "-1.250" may be -1.25 or -1250'),
        (("1;1;1.450;45.5",), ""),
        (("1;1;1,450;45,5",), ""),
        (("1;1;0.450;45.125",), ""),
        (("1;1;1450;45",), ""),
    ],
)
def test_a_point_or_a_comma_with_two_readings(tmp_path: Path, rows: tuple[str, ...], said: str) -> None:
    path = table(tmp_path, *rows, header=HEADER.replace(",", ";"))
    if not said:
        assert read(path).columns["dwell_min"][0] in (1.45, 0.45, 1450.0)
        return
    with pytest.raises(DataError, match=said):
        read(path)


def test_unknown_columns_warn(tmp_path: Path) -> None:
    path = table(tmp_path, *(row + ",7,8" for row in ROWS), header=HEADER + ",T_oil2,colour")
    assert tuple(read(path).warnings) == (
        'data.csv: column "T_oil2" is not used. Did you mean "T_oil2_C"?',
        'data.csv: column "colour" is not used.',
    )


def test_the_accounts_of_a_sweep_do_not_warn(tmp_path: Path) -> None:
    own = "row,status,iterations,energy_residual [1],outside [1]"
    path = table(tmp_path, *(row + ",1,ok,3,1e-16,0" for row in ROWS), header=f"{HEADER},{own}")
    assert read(path).warnings == ()
    path = table(tmp_path, *(row + ",ok" for row in ROWS), header=f"{HEADER},status")
    assert tuple(read(path).warnings) == ('data.csv: column "status" is not used.',)


def test_a_byte_order_mark_and_blank_lines_do_no_harm(tmp_path: Path) -> None:
    path = table(tmp_path, ROWS[0], "", ROWS[1], ",,,", header="\ufeff" + HEADER)
    assert list(read(path).lines) == [2, 4]


@pytest.mark.parametrize("sign", [",", ";", "\t"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_excel_tells_what_separates_columns(tmp_path: Path, sign: str, encoding: str) -> None:
    (path := tmp_path / "data.csv").write_text(
        "\n".join((f"sep={sign}", "Öl_C,n", "45,1")).replace(",", sign), encoding
    )
    assert read_cells(path) == (["Öl_C", "n"], [(3, ["45", "1"])])
    assert read_header(path) == ["Öl_C", "n"]


def test_units_in_a_row_of_their_own(tmp_path: Path) -> None:
    header, units = "test,n,M_ab [Nm],T_oil_C,wind_m_s,time", "-,1/min,N.m,[°C],m/s,hh:mm"
    found = read_cells(table(tmp_path, units, "a,1,2,3,4,5", header=header))
    assert found == (
        ["test", "n [rpm]", "M_ab [Nm]", "T_oil_C", "wind_m_s", "time"],
        [(3, ["a", "1", "2", "3", "4", "5"])],
    )
    first, *_ = problems(table(tmp_path, units.replace("°C", "K"), "a,1,2,3,4,5", header=header))
    assert first == 'data.csv line 2: column "T_oil_C" is in degC by its name, and in K by the row of units. Mend one.'
    assert len(read_cells(table(tmp_path, "A,ok", "V,bad", header="phase,state"))[1]) == 2


def test_a_header_that_is_there_again_is_left_out(tmp_path: Path) -> None:
    assert read(table(tmp_path, ROWS[0], HEADER, ROWS[1])).lines == (2, 4)


@pytest.mark.parametrize("cell", ["", "nan", "NaN", "n/a", "N/A", "#NV", "-", "null"])
def test_what_stands_for_no_reading(tmp_path: Path, cell: str) -> None:
    path = table(tmp_path, f"{ROWS[0]},{cell}", f"{ROWS[1]},45", header=f"{HEADER},T_oil2_C")
    assert math.isnan(read(path).columns["T_oil2_C"][0])


def test_a_name_is_no_number_of_a_reading(tmp_path: Path) -> None:
    column = Column("point", "number of the reading", "count", required=False)
    _, found = parse(table(tmp_path, "P1", header="point"), [column])
    assert found == [
        'data.csv line 2: point = "P1" is no whole number. Write the number of the reading, or give the column another'
        " name."
    ]
