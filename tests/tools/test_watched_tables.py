"""A log that grows, or comes as a stream, holds the same as one that is diagnosed, however it is written."""

import io
from pathlib import Path

import numpy as np
import pytest
from gearheat.scenarios.load import load
from gearheat.scenarios.measured.card import Card
from gearheat.scenarios.measured.logs import Log, read_log
from gearheat.scenarios.measured.sensors import sensors_of
from gearheat.tools.diagnose.request import Inputs, Request
from gearheat.tools.watch.judge import Judge
from gearheat.tools.watch.sources import Files, Source, Stream
from gearheat.tools.watch.store import Store
from gearheat.tools.watch.watch import Watch

HEAD = "time_utc,n_hss_rpm,T_hss_Nm,T_sump_C,T_inlet_C,T_bearing1_C,T_bearing2_C,T_nacelle_C"
BARE = "time_utc,n_hss,T_hss,T_sump,T_inlet,T_bearing1,T_bearing2,T_nacelle"
UNITS = ",rpm,Nm,°C,°C,°C,°C,[°C]"
N = 40
RIG = load("wind_turbine")


def rows() -> list[str]:
    sump = 55 + 0.1 * np.random.default_rng(3).standard_normal(N)
    stamps = [f"2016-03-14T{k // 6:02}:{10 * (k % 6):02}Z" for k in range(N)]
    return [f"{t},1500,3000,{v:.3f},50.0,60.0,61.0,20.0" for t, v in zip(stamps, sump, strict=True)]


def text(head: str = HEAD, time: str = "{}T{}Z") -> str:
    """A log whose times are written in another way."""
    split = ((row[:10], row[11:16], row.partition(",")[2]) for row in rows())
    return "\n".join([head, *(f"{time.format(day, clock)},{rest}" for day, clock, rest in split), ""])


def with_column(text: str, cell: str) -> str:
    return "".join(f"{line},{cell}\n" for line in text.splitlines())


NAMED = Card(columns={"time": "Messzeitpunkt", "T_sump": "T"})
OWN = HEAD.replace("time_utc", "Messzeitpunkt").replace("T_sump_C", "T [degC]")
UNITS_BELOW = text(f"{BARE}\n{UNITS}")
WIDE = "\N{GURMUKHI LETTER A}\u010a\u0a00"
FORMS = {
    "sep": ("sep=;\n" + text().replace(",", ";"), "utf-8", Card()),
    "sep in quotation marks": ('"sep=;"\n' + text().replace(",", ";"), "utf-8-sig", Card()),
    "units below": (UNITS_BELOW, "utf-8", Card()),
    "units below in cp1252": (UNITS_BELOW.replace(",", ";").replace(".", ","), "cp1252", Card()),
    "UTF-16": (f"\ufeff{UNITS_BELOW}".replace("\n", "\r\n"), "utf-16-le", Card()),
    "UTF-16, bytes of line ends within letters": (f"\ufeff{with_column(text(), WIDE)}", "utf-16-le", Card()),
    "UTF-16, high byte first": (f"\ufeff{with_column(text(), WIDE)}", "utf-16-be", Card()),
    "nothing": (text().replace(",60.0,", ",n/a,", 9), "utf-8", Card()),
    "day and time": (text(HEAD.replace("time_utc", "Datum,Uhrzeit"), time="{},{}"), "utf-8", Card()),
    "headers again": (text().replace(rows()[9], f"{HEAD}\n{rows()[9]}"), "utf-8", Card()),
    "time by the card": (text(OWN), "utf-8", NAMED),
    "three decimals first": (text().replace(".0", ".000", 30).replace(",", ";"), "utf-8", Card()),
}


def watched(source: Source, store: Store, card: Card) -> Log:
    for _ in Watch(sensors_of(RIG, card), card, store, dict, 10 * N, lambda: 1.5e9).follow(source):
        pass
    (m,) = store.machines.values()
    judge = Judge(Inputs(Request("wind_turbine"), RIG, card, None, None, None))
    return judge.log(m.name, m.kind, *store.rows(m, float("inf")))


def same(log: Log, other: Log) -> bool:
    values = (np.array_equal(log.values[name], other.values[name], equal_nan=True) for name in other.values)
    return log.values.keys() == other.values.keys() and all(values) and np.array_equal(log.time, other.time)


@pytest.mark.parametrize("form", FORMS)
def test_a_watched_log_is_read_as_a_diagnosed_one(tmp_path: Path, form: str) -> None:
    written, encoding, card = FORMS[form]
    (path := tmp_path / "one.csv").write_bytes(written.encode(encoding))
    log = read_log(path, RIG, card)
    assert log.n == N
    for source in (Stream(io.BytesIO(path.read_bytes()), "one"), Files(path, lambda name: None, once=True)):
        store = Store(None, "")
        assert same(watched(source, store, card), log)
        assert not list(store.events(0))


@pytest.mark.parametrize("form", FORMS)
def test_a_log_may_grow_from_any_byte_on(tmp_path: Path, form: str) -> None:
    written, encoding, card = FORMS[form]
    raw, path, store = written.encode(encoding), tmp_path / "one.csv", Store(None, "")
    sources = Files(path, store.place)
    path.write_bytes(b"")
    looks = Watch(sensors_of(RIG, card), card, store, dict, 10 * N, lambda: 1.5e9).follow(sources)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("gearheat.tools.watch.sources.POLL", 0.0)
        for end in [*range(1, 250), *range(250, len(raw), 97), len(raw)]:
            path.write_bytes(raw[:end])
            next(looks)
    sources.once = True
    assert same(watched(sources, store, card), read_log(path, RIG, card))
    assert not list(store.events(0))


def told(text: str, card: Card) -> list[str]:
    store = Store(None, "")
    source = Stream(io.BytesIO(text.encode()), "one")
    for _ in Watch(sensors_of(RIG, card), card, store, dict, 10 * N, lambda: 1.5e9).follow(source):
        pass
    return [event for _, event in store.events(0)]


def test_decimals_with_two_readings_are_left_out_and_told() -> None:
    written = text().replace(",", ";").replace(".", ",").replace(";3000;", ";3.000;")
    warnings = told(written, Card())
    assert len(warnings) == N and 'stdin line 2: \\"3.000\\" may be 3 or 3000' in warnings[0]
    (warning,) = told(text().replace(".0,", ".000,").replace(".0\n", ".000\n").replace(",", ";"), Card())
    assert "may be 55." in warning


def test_times_without_a_unit_are_told(tmp_path: Path) -> None:
    lines = [f"{10 * k},{row.partition(',')[2]}" for k, row in enumerate(rows())]
    (warning,) = told("\n".join([HEAD.replace("time_utc", "t"), *lines]), Card())
    assert "t has no unit and is taken for seconds" in warning
    assert not told("\n".join([HEAD.replace("time_utc", "t"), *lines]), Card(units={"t": "min"}))
    assert not told("\n".join([HEAD.replace("time_utc", "t [min]"), *lines]), Card())


def test_a_time_in_another_unit_is_told_and_does_not_end_the_watch() -> None:
    lines = [f"{10 * k},{row.partition(',')[2]}" for k, row in enumerate(rows())]
    (warning,) = told("\n".join([HEAD.replace("time_utc", "t [kg]"), *lines]), Card())
    assert 'stdin t [kg]: unit \\"kg\\" does not fit s. Write one that does' in warning


def test_american_times_are_read() -> None:
    lines = [f"3/14/2016 {1 + k // 6}:{k % 6}0 PM,{row.partition(',')[2]}" for k, row in enumerate(rows())]
    assert not told("\n".join([HEAD.replace("time_utc", "Time"), *lines]), Card())


def test_two_columns_of_time_are_refused_once() -> None:
    (warning,) = told(text(HEAD.replace("time_utc", "time_utc,time_s"), time="{}T{}Z,0"), Card())
    assert "time_utc and time_s are columns of time. Keep one." in warning
