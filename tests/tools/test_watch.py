"""Samples that grow, come late, twice or wrong count once; a watch that is killed goes on as if it was not."""

import io
import json
from collections.abc import Iterator
from pathlib import Path

import gearheat as gh
import pytest
from gearheat.model.errors import DataError
from gearheat.scenarios.measured.card import Card
from gearheat.scenarios.measured.table import Sensor
from gearheat.tools.diagnose.request import Request
from gearheat.tools.show.event_lines import as_text, opened
from gearheat.tools.watch.page import page_of
from gearheat.tools.watch.sources import Files, Source, Stream
from gearheat.tools.watch.store import Machine, Store
from gearheat.tools.watch.watch import SILENCE, Watch, identity

HEAD = "time_utc,n_hss_rpm,T_hss_Nm,T_nacelle_C,T_sump_C"
EVERY = 5


@pytest.fixture(scope="module")
def sensors() -> tuple[Sensor, ...]:
    named = {"n_hss_rpm": "speed", "T_hss_Nm": "torque", "T_nacelle_C": "ambient", "T_sump_C": "oil_temp"}
    return tuple(Sensor(name, name, name, kind, "given", "", 1.0, 1.0) for name, kind in named.items())


def line(k: int, sump: object = None) -> str:
    return f"2016-03-{1 + k // 144:02}T{k // 6 % 24:02}:{k % 6}0Z,1500,8000,20,{50 + k / 10 if sump is None else sump}"


def answer(machine, kind, times, rows) -> dict:
    """Of all samples that there are: their number and their sum; an alarm from the third window on."""
    total = sum(row.get("T_sump_C", 0.0) for row in rows)
    verdict = "explained" if len(rows) > 2 * EVERY else "consistent"
    return {"samples": len(rows), "total": round(total, 6), "verdict": verdict, "causes": []}


def events(sensors: tuple[Sensor, ...], source: Source, store: Store) -> Iterator[None]:
    return Watch(sensors, Card(), store, answer, EVERY, lambda: 1.5e9).follow(source)


def said(store: Store) -> list[dict]:
    return [json.loads(text) for _, text in store.events(0)]


def streamed(sensors: tuple[Sensor, ...], *lines: str) -> list[dict]:
    store = Store(None, "")
    for _ in events(sensors, Stream(io.BytesIO("\n".join((HEAD, *lines)).encode()), "one"), store):
        pass
    return said(store)


def test_a_window_is_answered_with_all_that_has_come(sensors: tuple[Sensor, ...]) -> None:
    found = streamed(sensors, *map(line, range(16)))
    assert [(e["event"], e.get("samples")) for e in found] == [
        ("window", 5),
        ("window", 10),
        ("alarm", None),
        ("window", 15),
    ]
    assert found[0]["from"] == "2016-03-01T00:00:00Z" and found[0]["to"] == found[2]["from"].replace("1:40", "0:40")
    assert found[3]["alarm"] == "2016-03-01T02:20:00Z"
    assert as_text(found[2]) == "2016-03-01T02:20:00Z one: ALARM: no cause stands out"


def test_what_is_no_whole_window_at_the_end_waits(sensors: tuple[Sensor, ...]) -> None:
    for samples, windows in ((2 * EVERY, 2), (2 * EVERY - 1, 1), (EVERY - 1, 0)):
        store, lines = Store(None, ""), "\n".join((HEAD, *map(line, range(samples))))
        watch = Watch(sensors, Card(), store, answer, EVERY, lambda: 1.5e9)
        for _ in watch.follow(Stream(io.BytesIO(lines.encode()), "one")):
            pass
        assert [e["event"] for e in said(store)] == ["window"] * windows
        left = samples - EVERY * windows
        assert [(e["machine"], e["samples"]) for e in watch.waiting()] == [("one", left)] * bool(left)
        assert all(f"one: waiting: the last {left} samples" in as_text(e) for e in watch.waiting())


def test_a_german_stream_says_the_same(sensors: tuple[Sensor, ...]) -> None:
    lines, store = [*map(line, range(16))], Store(None, "")
    german = "\n".join((HEAD, *lines)).replace(",", ";").replace(".", ",").encode()
    for _ in events(sensors, Stream(io.BytesIO(german), "one"), store):
        pass
    assert said(store) and said(store) == streamed(sensors, *lines)


def test_times_without_a_calendar_are_seconds(tmp_path: Path) -> None:
    lines = [f"{k / 6:.6f},1500,8000,20,50" for k in range(17)]
    text = "\n".join((HEAD.replace("time_utc", "time_h"), *lines)).encode()
    sensors = (Sensor("T_sump", "T_sump", "sump.T", "oil_temp", "read", "degC", 0.3, 0.3),)
    store = Store(tmp_path / "state", "")
    for _ in events(sensors, Stream(io.BytesIO(text), "one"), store):
        pass
    assert [e["to"] for e in said(store)] == pytest.approx([4 * 600.0, 9 * 600.0, 14 * 600.0, 14 * 600.0], abs=0.01)
    assert Store(tmp_path / "state", "").machines["one"].alarm == said(store)[-1]["alarm"]


def test_what_is_late_or_there_twice_counts_once(sensors: tuple[Sensor, ...]) -> None:
    plain = list(map(line, range(16)))
    mixed = [*plain[:6], plain[4], *plain[7:9], plain[6], plain[8], *plain[9:], plain[0]]
    late, straight = streamed(sensors, *mixed), streamed(sensors, *plain)
    assert late == straight


@pytest.mark.parametrize(
    ("wrong", "text"),
    [
        (line(4, "warm"), 'T_sump_C is "warm", expected a number'),
        (line(3, 99), "T_sump_C at a time that is there with another value"),
        ("noon,1,2,3,4", 'its time is "noon"'),
        ("3/1/2016 6:00 AM,1,2,3,4", 'It may be "2016-03-01" or "2016-01-03": write one of these; the row is left out'),
        ("2099" + line(4)[4:], "has not come yet"),
        ("12," + line(4).partition(",")[2], "has numbers without a unit, earlier samples times with a zone"),
        (line(4) + ",7", "has 6 cells, the header has 5"),
    ],
)
def test_what_is_wrong_is_said_once_and_the_rest_goes_on(sensors: tuple[Sensor, ...], wrong: str, text: str) -> None:
    found = streamed(sensors, *map(line, range(4)), wrong, *map(line, range(4, 8)))
    (warning,) = (e for e in found if e["event"] == "warning")
    assert text in warning["text"] and "line 6" in warning["text"]
    assert [e["samples"] for e in found if e["event"] == "window"] == [5]


@pytest.mark.parametrize("ends", [range(1, 60, 7), [2, 3, 4], [33]])
def test_a_watch_that_is_killed_goes_on_as_if_it_was_not(sensors: tuple[Sensor, ...], tmp_path: Path, ends) -> None:
    log, rows = tmp_path / "one.csv", [line(k) for k in range(44)]
    log.write_text("\n".join([HEAD, *rows[:20], rows[3], line(18, 7), *rows[20:], ""]))
    for stop in (*ends, None):
        store = Store(tmp_path / "state", "")
        for n, _ in enumerate(events(sensors, Files(log, store.place, once=True), store)):
            if n == stop:
                break
        store.base.close()  # what is not committed is lost, as if the process was killed
    whole = Store(None, "")
    for _ in events(sensors, Files(log, whole.place, once=True), whole):
        pass
    assert said(Store(tmp_path / "state", "")) == said(whole)
    assert len(said(whole)) == 10


def test_a_file_that_grows_and_is_made_anew(sensors: tuple[Sensor, ...], tmp_path: Path) -> None:
    log, store = tmp_path / "farm" / "one.csv", Store(None, "")
    log.parent.mkdir()
    log.write_text("\n".join([HEAD, *map(line, range(6))]))  # the last line is under way
    looks = events(sensors, Files(log.parent, store.place), store)
    next(looks)
    assert not said(store)
    log.write_text("\n".join([HEAD, *map(line, range(7)), ""]))
    while not said(store):
        next(looks)
    log.write_text("\n".join([HEAD, *map(line, range(7, 11)), ""]))
    while len(said(store)) < 2:
        next(looks)
    assert [e["samples"] for e in said(store)] == [5, 10]
    assert list(store.machines) == ["one"]


def test_a_source_that_is_silent_is_told_every_hour(sensors: tuple[Sensor, ...]) -> None:
    store, clock = Store(None, ""), iter(1.5e9 + k * SILENCE / 2 for k in range(99))

    class Silent:
        def rows(self) -> Iterator[None]:
            yield from [None] * 5

        def kept(self) -> None:
            pass

    for _ in Watch(sensors, Card(), store, answer, EVERY, lambda: next(clock)).follow(Silent()):
        pass
    first, second = (event["text"] for event in said(store))
    assert first.startswith("no sample has come for 60 min, at 2017-07-14T0") and second > first


def test_the_page_tells_each_machine_with_bands_cause_and_since_when(
    sensors: tuple[Sensor, ...], tmp_path: Path
) -> None:
    store = Store(None, "")
    assert "No window is full yet" in page_of(store, "wind turbine")

    def told(machine, kind, times, rows) -> dict:
        warm = len(rows) * 0.5
        shown = {"measured": 50 + warm, "predicted": 50.0, "low": 48.0, "high": 52.25}
        cause = {"id": "cooling.cooler", "name": "oil cooler <2>", "probability": 0.59, "since": "2016-03-01"}
        alarm = machine == "two" and len(rows) > EVERY
        return {"readings": {"T_sump": shown}, "changed": 0.9, "p_any": 0.01, "causes": [cause]} | {
            "verdict": "explained" if alarm else "consistent"
        }

    for machine in ("one", "two"):
        lines = io.BytesIO("\n".join((HEAD, *map(line, range(11)), "x,1,2,3,4")).encode())
        for _ in Watch(sensors, Card(), store, told, EVERY, lambda: 1.5e9).follow(Stream(lines, machine)):
            pass
    html = page_of(store, "wind turbine")
    assert html.index("<h2>two</h2>") < html.index("<h2>one</h2>")
    assert html.count('class="alarm"') == 1
    assert "Alarm since 2016-03-01T01:30:00Z: oil cooler &lt;2&gt; 59% since 2016-03-01" in html
    assert "<td>55.0</td><td>50.0</td><td>48.0 to 52.2</td>" in html
    assert 'class="measured" points="0.0,22.0 300.0,2.0"' in html
    assert "location.reload()" in html and "2 last warnings" in html


def test_a_state_is_that_of_one_watch(tmp_path: Path) -> None:
    Store(tmp_path / "state", "a rig").base.close()
    with pytest.raises(DataError, match="another rig"):
        Store(tmp_path / "state", "another")
    (tmp_path / "text").write_text("no database, but some text" * 50)
    with pytest.raises(DataError, match="no state of a watch"):
        Store(tmp_path / "text", "a rig")


def test_a_file_of_events_has_each_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "events.jsonl"
    path.write_text('{"number": 3, "event": "cleared"}\n{"number": 4, "eve')
    with opened(str(path)) as lines:
        assert lines.last == 3
        lines.write({"number": 4, "event": "cleared", "machine": "one", "to": "today"})
        lines.write({"event": "waiting", "machine": "one", "text": "2 samples"})
    assert [json.loads(text)["number"] for text in path.read_text().splitlines()] == [3, 4]
    assert capsys.readouterr().out == "today one: alarm over\none: waiting: 2 samples\n"


def test_a_fleet_on_the_workers_of_a_cluster(gearheat, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:  # type: ignore[no-untyped-def]
    farm = tmp_path / "farm"
    farm.mkdir()
    for name in ("one", "two"):
        rows = (f"2016-03-01T{k // 6:02}:{k % 6}0Z,{k % 2},-7,{20 + k % 3},{50 - k / 10}" for k in range(13))
        (farm / f"{name}.csv").write_text("\n".join([HEAD, *rows, ""]))
    command = ("watch", farm, "--rig", "wind_turbine", "--every", EVERY, "--once", "--scheduler")
    with monkeypatch.context() as without:
        without.setattr("gearheat.tools.watch.api.find_spec", lambda name: None)
        answer = gearheat(*command, "tcp://127.0.0.1:9")
        assert answer.code == 2 and 'pip install "gearheat[dask]"' in answer.err
    distributed = pytest.importorskip("distributed", reason="Dask is not installed: pip install gearheat[dask]")
    options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None, "worker_dashboard_address": None}
    answer = gearheat(*command[:-1], "--json", tmp_path / "here.jsonl")
    assert answer.code == 0 and answer.out.count("waiting: the last 3 samples") == 2
    with distributed.LocalCluster(**options) as there:
        answer = gearheat(*command, there.scheduler_address, "--json", tmp_path / "there.jsonl")
    assert answer.code == 0, answer.err
    here, there = (
        sorted(line.partition(",")[2] for line in (tmp_path / name).read_text().splitlines())
        for name in ("here.jsonl", "there.jsonl")
    )
    assert here == there and len(here) == 4 and all("the machine stands still" in line for line in here)


def test_a_rig_in_python_is_known_by_what_it_holds() -> None:
    rig = gh.load("planetary")
    known = identity(Request(rig))
    assert known.startswith("planetary ") and known == identity(Request(gh.load("planetary")))
    assert known != identity(Request(rig.with_({"cooling.A": "1 m2"})))
    assert identity(Request("planetary")) == identity(Request(Path("planetary")))


@pytest.mark.parametrize("apart", [0.0, 0.2])
def test_cells_that_come_one_by_one_make_samples_whatever_their_stamps(apart: float) -> None:
    """The time from cell to cell was taken for the step, so that a sample never had a second cell."""
    store, m = Store(None, ""), Machine("one", "numbers")
    for k in range(30):
        for j, column in enumerate("abc"):
            assert not store.add(m, 600.0 * k + apart * j, {column: float(k)})
    times, rows = store.rows(m, 1e9)
    assert times == [600.0 * k for k in range(30)] and rows == [dict.fromkeys("cba", float(k)) for k in range(30)]
    assert m.step == pytest.approx(600.0) and m.count == 30
