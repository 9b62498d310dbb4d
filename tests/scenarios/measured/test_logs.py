"""Logs as files: CSV, gzipped CSV and Parquet, stretches, spikes, and files that are refused by name."""

import gzip
import re
import warnings
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
from gearheat.model.errors import DataError
from gearheat.scenarios.load import load
from gearheat.scenarios.measured.card import Card, read_card
from gearheat.scenarios.measured.logs import Log, read_log

HEAD = "time_utc,n_hss_rpm,T_hss_Nm,T_sump_C,T_inlet_C,T_bearing1_C,T_bearing2_C,T_nacelle_C,wind_m_s"
N = 60


def lines(n: int = N) -> list[str]:
    rng = np.random.default_rng(3)
    T = 55 + 0.1 * rng.standard_normal(n)
    stamps = [f"2016-03-14T{k // 6:02d}:{10 * (k % 6):02d}Z" for k in range(n)]
    return [f"{t},1500,3000,{v:.2f},50.0,60.0,61.0,20.0,7.1" for t, v in zip(stamps, T, strict=True)]


def read(path: Path, rows: list[str], head: str = HEAD, card: Card | None = None) -> Log:
    path.write_text("\n".join([head, *rows]) + "\n")
    return read_log(path, load("wind_turbine"), card or read_card(None))


def test_a_log_is_in_si_with_one_stretch(tmp_path: Path) -> None:
    log = read(tmp_path / "a.csv", lines())
    assert (log.n, log.step, log.dated, log.stretch.max()) == (N, 600.0, True, 0)
    assert log.values["n_hss"][0] == pytest.approx(1500 * np.pi / 30)
    assert log.values["T_nacelle"][0] == pytest.approx(293.15)
    assert {s.name for s in log.given} == {"n_hss", "T_hss", "T_nacelle"}


def test_gzip_and_parquet_hold_the_same(tmp_path: Path) -> None:
    plain = read(tmp_path / "a.csv", lines())
    with gzip.open(tmp_path / "a.csv.gz", "wt") as file:
        file.write("\n".join([HEAD, *lines()]))
    zipped = read_log(tmp_path / "a.csv.gz", load("wind_turbine"), read_card(None))
    assert np.array_equal(plain.values["T_sump"], zipped.values["T_sump"])
    pa = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    cells = [row.split(",") for row in lines()]
    table = {name: [c[k] if k == 0 else float(c[k]) for c in cells] for k, name in enumerate(HEAD.split(","))}
    parquet.write_table(pa.table(table), tmp_path / "a.parquet")
    same = read_log(tmp_path / "a.parquet", load("wind_turbine"), read_card(None))
    assert np.array_equal(plain.values["T_sump"], same.values["T_sump"])
    assert np.array_equal(plain.time, same.time)


@pytest.mark.parametrize(("sign", "encoding"), [(";", "cp1252"), ("\t", "utf-8")])
def test_a_german_log_holds_the_same(tmp_path: Path, sign: str, encoding: str) -> None:
    plain = read(tmp_path / "a.csv", lines())
    days = ["{2}.{1}.{0} {3}".format(*row[:10].split("-"), row[11:16]) for row in lines()]
    cells = [",".join([day, row.partition(",")[2], "größer"]) for day, row in zip(days, lines(), strict=True)]
    text = "\n".join([HEAD.replace("time_utc", "Datum/Uhrzeit") + ",Bemerkung °", *cells])
    (path := tmp_path / "b.csv").write_text(text.replace(",", sign).replace(".", ",").replace(",03,", ".03."), encoding)
    with gzip.open(tmp_path / "b.csv.gz", "wb") as file:
        file.write(path.read_bytes())
    for same in (path, tmp_path / "b.csv.gz"):
        log = read_log(same, load("wind_turbine"), read_card(None))
        assert all(np.array_equal(log.values[name], values) for name, values in plain.values.items())
        assert np.array_equal(log.time, plain.time)


def test_gaps_and_segments_begin_stretches(tmp_path: Path) -> None:
    rows = lines()
    assert read(tmp_path / "a.csv", rows[:20] + rows[30:]).stretch.max() == 1
    numbered = [f"{'a' if k < 10 else 'b'},{row}" for k, row in enumerate(rows)]
    log = read(tmp_path / "b.csv", numbered, f"segment,{HEAD}")
    assert log.stretch.tolist() == [0] * 10 + [1] * (N - 10)


def test_a_single_spike_is_set_aside_by_line_and_column(tmp_path: Path) -> None:
    rows = lines()
    cells = rows[20].split(",")
    rows[20] = ",".join([*cells[:3], "396.0", *cells[4:]])
    log = read(tmp_path / "a.csv", rows)
    (gross,) = log.gross
    assert (gross.line, gross.column) == (22, "T_sump_C")
    assert gross.shown == pytest.approx(396 + 273.15)
    assert np.isnan(log.values["T_sump"][20])


def test_a_power_gives_the_torque_and_at_rest_hardly_any(tmp_path: Path) -> None:
    rows = [row.replace(",3000,", ",471.2389,") for row in lines()]
    rows[40] = rows[40].replace(",1500,471.2389,", ",0,0.5,")
    (tmp_path / "card.toml").write_text('columns.T_hss = "P [kW]"')
    log = read(tmp_path / "a.csv", rows, HEAD.replace("T_hss_Nm", "P [kW]"), read_card(tmp_path / "card.toml"))
    assert log.values["T_hss"][[0, 59]] == pytest.approx([3000.0, 3000.0])
    assert log.values["T_hss"][40] == pytest.approx(0.5 / 471.2389 * 3000 / 0.01, rel=0.2)


def test_own_names_and_units_by_the_card(tmp_path: Path) -> None:
    card = Card(columns={"T_sump": "Sumpf"}, units={"Sumpf": "degC"})
    log = read(tmp_path / "a.csv", lines(), HEAD.replace("T_sump_C", "Sumpf"), card)
    assert 320 < log.values["T_sump"][0] < 340


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda head, rows: (head.replace("n_hss_rpm", "n"), rows), "drives the model"),
        (lambda head, rows: (head.replace("time_utc", "when"), rows), "no column of time"),
        (lambda head, rows: (head, rows[:5] + rows[3:]), "line 7: time does not go on"),
        (lambda head, rows: (head, rows[:12] + rows[6:]), "line 14: time goes back an hour, as clocks do in autumn"),
        (lambda head, rows: (head, [rows[0].replace("1500", "fast"), *rows[1:]]), 'line 2: n_hss_rpm is "fast"'),
        (lambda head, rows: (head, []), "holds no samples"),
    ],
)
def test_bad_files_say_where_and_what(tmp_path: Path, change, told: str) -> None:
    head, rows = change(HEAD, lines())
    with pytest.raises(DataError, match=told):
        read(tmp_path / "a.csv", rows, head)


def cells_of(name: str, change):
    """A log with the cells of a column changed."""

    def made(head: str, rows: list[str]) -> tuple[str, list[str]]:
        k = head.split(",").index(name)
        cells = [row.split(",") for row in rows]
        return head, [",".join([*c[:k], str(change(c[k], i)), *c[k + 1 :]]) for i, c in enumerate(cells)]

    return made


def seconds(change):
    """A log with numbers for times."""
    timed = cells_of("time_utc", lambda _, k: change(600.0 * k))
    return lambda head, rows: (head.replace("time_utc", "time_s"), timed(head, rows)[1])


def bare(change):
    """The same in a column that says no unit."""
    timed = seconds(change)
    return lambda head, rows: (head.replace("time_utc", "time"), timed(head, rows)[1])


def fahrenheit(head: str, rows: list[str]) -> tuple[str, list[str]]:
    for name in (h for h in head.split(",") if h.endswith("_C")):
        rows = cells_of(name, lambda cell, _: 1.8 * float(cell) + 32)(head, rows)[1]
    return head, rows


def at_rest(head: str, rows: list[str]) -> tuple[str, list[str]]:
    return cells_of("T_hss_Nm", lambda _, k: -7)(*cells_of("n_hss_rpm", lambda _, k: k % 3)(head, rows))


#: What may be wrong with a log -> the change that makes it so, and words of the answer.
WRONG = {
    "torque in kN.m": (cells_of("T_hss_Nm", lambda c, _: float(c) / 1000), "T_hss_Nm is at most 3 N.m, the rig runs"),
    "speed in Hz": (cells_of("n_hss_rpm", lambda c, _: float(c) / 60), "n_hss_rpm is at most 25 rpm, the rig runs"),
    "a machine at rest": (at_rest, "the machine stands still, n_hss_rpm is at most 1.2 rpm, the rig runs at 1800 rpm"),
    "speed in rad/s": (
        cells_of("n_hss_rpm", lambda c, _: float(c) / 9.55),
        "unit, .* and those of what drives it",
    ),
    "oil in degF": (cells_of("T_sump_C", lambda c, _: 1.8 * float(c) + 32), "T_sump_C .* In degF it would fit"),
    "all in degF": (fahrenheit, "Check its unit|In degF it would fit"),
    "oil in K": (cells_of("T_sump_C", lambda c, _: float(c) + 273.15), "T_sump_C is .* such in 60 rows"),
    "no torque": (cells_of("T_hss_Nm", lambda c, _: ""), "T_hss_Nm holds no number"),
    "no oil": (cells_of("T_sump_C", lambda c, _: "nan"), "T_sump_C holds no number"),
    "a torque that is infinite": (cells_of("T_hss_Nm", lambda c, k: "inf" if k == 7 else c), 'T_hss_Nm is "inf"'),
    "milliseconds since 1970": (seconds(lambda t: 1e3 * (1.4e9 + t)), "time_s goes to .* years. Check its unit"),
    "milliseconds": (seconds(lambda t: 1e3 * t), "600000 s from sample to sample"),
    "times that are none": (seconds(lambda t: "nan"), 'line 2: time_s is "nan"'),
    "a time that is infinite": (seconds(lambda t: "inf" if t == 6000 else t), 'line 12: time_s is "inf"'),
    "times backward": (seconds(lambda t: -t), "time does not go on"),
    "a time twice": (seconds(lambda t: 600 * (t // 600 - (t > 6000))), "line 13: it has the time of the line above"),
    "days of Excel": (bare(lambda t: 46109.83 + t / 86400), "46109.83 to .* as days since 1900 .* 2026-03-28 19:55"),
    "a mean below": (
        lambda h, r: (h, [*r, r[0].replace(r[0][:17], "Mittelwert")]),
        'line 62: time_utc is "Mittelwert"',
    ),
    "a zone now and then": (cells_of("time_utc", lambda c, k: c[: 16 + k % 2]), "30 times without a zone and 30 times"),
    "numbers among dates": (cells_of("time_utc", lambda c, k: k if k > 50 else c), "with a zone and 9 numbers"),
    "a block twice": (
        lambda h, r: (h, [a[:17] + b[17:] for a, b in zip(r, [*r[:30], *r[:30]], strict=True)]),
        "line 32: 24 rows and more are those from line 2 on",
    ),
    "a column twice": (lambda h, r: (f"{h},T_sump_C", [f"{x},90" for x in r]), 'column "T_sump_C" is there twice'),
    "two of one sensor": (lambda h, r: (f"{h},T_sump [K]", [f"{x},330" for x in r]), "are columns of one sensor"),
    "no name": (lambda h, r: (f"{h},", [f"{x},1" for x in r]), "has no name"),
}


@pytest.mark.parametrize("kind", WRONG)
def test_logs_are_checked_as_tables_are(tmp_path: Path, kind: str) -> None:
    change, told = WRONG[kind]
    head, rows = change(HEAD, lines())
    with pytest.raises(DataError, match=told):
        read(tmp_path / "a.csv", rows, head)


def test_all_problems_of_a_log_come_at_once(tmp_path: Path) -> None:
    rows = [row.replace(",1500,", ",fast,") for row in lines()]
    rows[3], rows[7] = rows[3] + ",1", rows[6]
    with pytest.raises(DataError) as raised:
        read(tmp_path / "a.csv", rows, HEAD.replace("T_nacelle_C", "T_nacelle_bar"))
    said = "\n".join(raised.value.problems)
    for text in (
        "line 5: 10 cells under 9 column names",
        'line 4: n_hss_rpm is "fast"',
        'lines 6 to 61, 56 of them: n_hss_rpm is "..."',
        "line 9: it has the time of the line above. Keep one of the two.",
        '"T_nacelle_C" drives the model (nacelle.T) and is missing.',
    ):
        assert text in said, text


def test_a_reading_that_hangs_is_told(tmp_path: Path) -> None:
    """Always the same far longer than otherwise; not while the machine goes on alike, nor of a coarse thermometer."""
    moving = []
    for k, row in enumerate(lines(140)):
        stamp, _, torque, sump, *_ = row.split(",")
        speed = 1500 - 400 * (k // 20 % 2)
        moving.append(f"{stamp},{speed},{torque},{sump},{50 + k % 3},{60 + k % 4},{61 + k // 30},20.0,7.1")
    assert not read(tmp_path / "a.csv", moving).warnings
    hung = [re.sub(r"^(([^,]*,){3})[^,]*", r"\g<1>55.02", row) for row in moving]
    hangs = [*moving[:60], *hung[60:120], *moving[120:]]
    (told,) = read(tmp_path / "a.csv", hangs).warnings
    assert told.startswith("a.csv lines 62 to 121: T_sump_C is always the same, while what drives the rig moves.")
    alike = [row.replace(",1100,", ",1500,") for row in hangs]
    assert not read(tmp_path / "a.csv", alike).warnings


def test_a_time_without_a_unit_is_in_seconds_and_warns(tmp_path: Path) -> None:
    head, rows = bare(lambda t: t / 60)(HEAD, lines())
    log = read(tmp_path / "a.csv", rows, head)
    assert log.step == 10.0
    assert "a.csv: time has no unit and is taken for seconds, 10 s from sample to sample." in log.warnings[0]
    said = read(tmp_path / "a.csv", rows, head.replace("time", "time [min]"))
    by_card = read(tmp_path / "a.csv", rows, head, Card(units={"time": "min"}))
    assert said.step == by_card.step == 600.0 and not said.warnings + by_card.warnings
    assert not read(tmp_path / "a.csv", bare(lambda t: 1.4e9 + t)(HEAD, lines())[1], head).warnings


@pytest.mark.parametrize(("day", "clock"), [("date", "time"), ("Datum", "Uhrzeit")])
def test_day_and_time_of_day_in_two_columns(tmp_path: Path, day: str, clock: str) -> None:
    rows = [row.replace("T0", ",").replace("T", ",").replace("Z", "", 1) for row in lines()]
    log = read(tmp_path / "a.csv", rows, HEAD.replace("time_utc", f"{day},{clock}"))
    assert log.dated and np.array_equal(log.time, read(tmp_path / "b.csv", lines()).time)


def test_the_card_names_the_columns_of_time_and_segments(tmp_path: Path) -> None:
    head, rows = seconds(lambda t: t / 60)(f"{HEAD},part", [f"{row},{'ab'[k > 9]}" for k, row in enumerate(lines())])
    card = Card(columns={"time": "Takt", "segment": "part"}, units={"Takt": "min"})
    log = read(tmp_path / "a.csv", rows, head.replace("time_s", "Takt"), card)
    assert (log.step, log.stretch.max()) == (600.0, 1)
    assert read(tmp_path / "a.csv", rows, head.replace("time_s", "Takt [min]"), Card(columns={"time": "Takt"})).n == N
    assert read(tmp_path / "b.csv", lines(), card=card).dated  # the usual names hold for a log that lacks it


def test_units_in_a_row_and_headers_again(tmp_path: Path) -> None:
    units = "-,rpm,Nm,°C,°C,°C,°C,°C,m/s"
    plain = read(tmp_path / "a.csv", lines())
    text = "\n".join(["sep=,", HEAD.replace("_rpm", ""), units, *lines()[:20], HEAD.replace("_rpm", ""), *lines()[20:]])
    (tmp_path / "b.csv").write_text(text, encoding="utf-16")
    with gzip.open(tmp_path / "b.csv.gz", "wb") as file:
        file.write((tmp_path / "b.csv").read_bytes())
    for path in (tmp_path / "b.csv", tmp_path / "b.csv.gz"):
        log = read_log(path, load("wind_turbine"), read_card(None))
        assert np.array_equal(log.values["n_hss"], plain.values["n_hss"])
        assert log.lines.tolist() == [*range(4, 24), *range(25, 65)]


def test_a_slow_channel_has_no_two_readings_in_a_row(tmp_path: Path) -> None:
    head, rows = cells_of("T_sump_C", lambda c, k: c if k % 3 == 0 else "n/a")(HEAD, lines())
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        log = read(tmp_path / "a.csv", rows, head)
    assert np.isfinite(log.values["T_sump"]).sum() == N // 3


def test_a_machine_that_has_stopped_is_still_warm(tmp_path: Path) -> None:
    _, rows = cells_of("n_hss_rpm", lambda c, k: c if k < 15 else 0)(HEAD, lines())
    log = read(tmp_path / "a.csv", rows)
    assert log.n == 60


def test_a_compressed_file_that_is_broken(tmp_path: Path) -> None:
    whole = gzip.compress("\n".join([HEAD, *lines()]).encode())
    (tmp_path / "a.csv.gz").write_bytes(whole[:40] + b"\0\xff" * 20 + whole[80:])
    with pytest.raises(DataError, match="cannot be read"):
        read_log(tmp_path / "a.csv.gz", load("wind_turbine"), read_card(None))


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(DataError, match="no such file"):
        read_log(tmp_path / "none.csv", load("wind_turbine"), read_card(None))


def stamped(tmp_path: Path, form: str, day: int) -> Log:
    """A log whose times are in a form of `strftime`, from nine in the evening of a day of March on."""
    stamps = [(datetime(2016, 3, day, 21) + timedelta(minutes=10 * k)).strftime(form) for k in range(N)]
    rows = [f"{stamp},{row.partition(',')[2]}" for stamp, row in zip(stamps, lines(), strict=True)]
    return read(tmp_path / "a.csv", rows, HEAD.replace("time_utc", "Date,Clock" if "," in form else "Time"))


@pytest.mark.parametrize(
    ("form", "day"),
    [
        ("%m/%d/%Y %I:%M %p", 14),
        ("%m/%d/%Y %I:%M:%S %p", 12),  # the 13th tells of the 12th
        ("%d/%m/%Y %H:%M", 14),
        ("%-m/%-d/%Y %H:%M", 14),
        ("%d.%m.%Y %I:%M %p", 2),
        ("%Y-%m-%d %I:%M%p", 2),
        ("%m/%d/%Y,%I:%M %p", 14),
    ],
)
def test_dates_of_other_countries(tmp_path: Path, form: str, day: int) -> None:
    log = stamped(tmp_path, form, day)
    assert log.time[0] == datetime(2016, 3, day, 21, tzinfo=UTC).timestamp() and log.stretch.max() == 0


def test_dates_that_may_be_two_are_refused(tmp_path: Path) -> None:
    with pytest.raises(DataError) as error:
        stamped(tmp_path, "%m/%d/%Y %H:%M", 3)
    first, *_ = error.value.problems
    said = 'a.csv line 20: Time is "03/04/2016 00:00". It may be "2016-03-04" or "2016-04-03": write one of these.'
    assert first == said  # the third of March is the third of March


def test_header_and_cells_are_told_together(tmp_path: Path) -> None:
    rows = [f"{row},1" for row in lines()]
    with pytest.raises(DataError) as error:
        read(tmp_path / "a.csv", [rows[0].replace("1500", "fast"), *rows[1:]], f"{HEAD},T_sump_C")
    assert error.value.problems == (
        'a.csv line 1: column "T_sump_C" is there twice. Keep one.',
        'a.csv line 2: n_hss_rpm is "fast", expected a number or nothing.',
    )
