"""A watch of an MQTT broker: whichever of the two is killed, no sample is lost and none counts twice."""

import json
import multiprocessing
import os
import shutil
import socket
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random

import gearheat as gh
import pytest
from gearheat.model.errors import DataError
from gearheat.scenarios.measured.card import Card
from gearheat.scenarios.measured.table import Sensor
from gearheat.tools.watch.broker import Broker
from gearheat.tools.watch.store import Store
from gearheat.tools.watch.watch import Watch

#: Debian has it where only root looks.
MOSQUITTO = shutil.which("mosquitto", path=os.environ["PATH"] + ":/usr/sbin:/usr/local/sbin") or ""
SENSORS = (Sensor("T_sump", "T_sump_C", "sump.T", "oil_temp", "read", "degC", 0.3, 0.3),)
EVERY, SAMPLES = 5, 44

pytest.importorskip("paho", reason="paho-mqtt speaks to brokers: pip install gearheat[mqtt]")


@pytest.fixture
def port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


class Server:
    """A broker that keeps sessions on the disk, started again after each kill."""

    def __init__(self, folder: Path, port: int) -> None:
        self.port, self.config = port, folder / "mosquitto.conf"
        lines = [f"listener {port} 127.0.0.1", "allow_anonymous true", "persistence true", "user root"]
        lines += [f"persistence_location {folder}/", "autosave_on_changes true", "autosave_interval 1"]
        self.config.write_text("\n".join(lines) + "\n")
        self.start()

    def start(self) -> None:
        self.process = subprocess.Popen([MOSQUITTO, "-c", self.config], stderr=subprocess.DEVNULL)
        until(lambda: not socket.socket().connect_ex(("127.0.0.1", self.port)))

    def kill(self) -> None:
        self.process.kill()
        self.process.wait()

    def send(self, messages: list[tuple[str, str]]) -> None:
        from paho.mqtt import publish

        publish.multiple([(topic, text, 1, False) for topic, text in messages], "127.0.0.1", self.port)


@pytest.fixture
def server(tmp_path: Path, port: int) -> Iterator[Server]:
    if not MOSQUITTO:
        pytest.skip("no broker: mosquitto is not installed")
    server = Server(tmp_path, port)
    yield server
    server.kill()


def until(true: Callable[[], object], seconds: float = 30.0) -> None:
    end = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < end
        time.sleep(0.02)


def message(k: int) -> tuple[str, str]:
    sample = {"time_utc": f"2016-03-01T{k // 6:02}:{k % 6}0Z", "T_sump_C": 50 + k / 10}
    return "farm/one", json.dumps(sample)


def answer(machine, kind, times, rows) -> dict:  # type: ignore[no-untyped-def]
    return {"total": round(sum(row["T_sump_C"] for row in rows), 6), "verdict": "consistent", "causes": []}


def follow(state: Path | None, port: int, publish: str = "") -> Iterator[Store]:
    store = Store(state, "")
    broker = Broker(f"mqtt://127.0.0.1:{port}/farm/#", state and "session", publish)
    for _ in Watch(SENSORS, Card(), store, answer, EVERY, lambda: 1.5e9).follow(broker):
        yield store


def child(state: Path, port: int) -> None:
    for _ in follow(state, port):
        pass


def said(store: Store, kind: str = "window") -> list[dict]:
    return [event for _, text in store.events(0) if (event := json.loads(text))["event"] == kind]


def test_broker_and_watch_are_killed_and_every_sample_counts_once(server: Server, tmp_path: Path) -> None:
    state, random = tmp_path / "state", Random(39)
    fork = multiprocessing.get_context("fork")
    kept = Store(state, "")
    watcher = fork.Process(target=child, args=(state, server.port))
    watcher.start()

    def there() -> int:
        return int(kept.base.execute("select count(*) from rows").fetchone()[0])

    def first() -> bool:
        server.send([message(0)])
        return there() > 0

    until(first)  # what comes before the first subscription is nobody's
    sent, kills = 1, 0
    while sent < SAMPLES:
        killed = random.sample(["watcher", "broker"], random.randint(0, 2))
        kills += len(killed)
        for process in killed:
            if process == "broker":
                server.kill()
                server.start()
            else:
                watcher.kill()
                watcher.join()
        if not watcher.is_alive() and random.random() < 0.7:
            watcher = fork.Process(target=child, args=(state, server.port))
            watcher.start()
        again, more = 6 if "broker" in killed else 1, random.randint(1, 5)  # a sender that is not sure sends again
        server.send([message(k) for k in range(max(sent - again, 0), min(sent + more, SAMPLES))])
        sent = min(sent + more, SAMPLES)
        time.sleep(random.choice([0.0, 0.01, 0.1]))
    if not watcher.is_alive():
        watcher = fork.Process(target=child, args=(state, server.port))
        watcher.start()
    until(lambda: there() == SAMPLES and len(said(kept)) == (SAMPLES - 1) // EVERY)
    watcher.kill()
    watcher.join()
    assert kills > 5
    totals = [round(sum(50 + k / 10 for k in range(n)), 6) for n in range(EVERY, SAMPLES, EVERY)]
    assert [event["total"] for event in said(kept)] == totals
    assert [n for n, _ in kept.events(0)] == list(range(1, len(list(kept.events(0))) + 1))


def test_messages_that_are_no_samples_are_told_and_cells_make_samples(server: Server) -> None:
    looks = follow(None, server.port)
    store = next(looks)
    cells = [
        (f"farm/one/{column}", json.dumps({"time_utc": f"2016-03-01T00:0{k}Z", "value": value}))
        for k in range(EVERY + 1)
        for column, value in (("T_sump_C", 50.0), ("P_kW", 7.0))
    ]
    wrong = [
        ("farm/one", "warm"),
        ("farm/one", "53.1"),
        ("farm/one/colour", '{"time_utc": "2016-03-01T00:00Z", "value": 3}'),
    ]
    wrong += [("farm/two", '{"time_utc": "2016-03-01T00:00Z", "T_sump_C": "warm"}'), ("farm/two", b"\xff")]

    def heard() -> bool:
        next(looks)
        if not said(store):
            server.send([*wrong, *cells])
        return bool(said(store))

    until(heard)
    warnings = " ".join(event["text"] for event in said(store, "warning"))
    assert '"warm" is no sample; expected {"time_utc"' in warnings and '"53.1" is no sample' in warnings
    assert "topic farm/one/colour: holds no column of a sensor" in warnings
    assert 'T_sump_C is "warm", expected a number' in warnings
    assert said(store)[0]["machine"] == "one" and said(store)[0]["total"] == 250.0


def test_a_broker_that_is_not_there_is_told_once_and_waited_for(port: int) -> None:
    looks = follow(None, port)
    store = next(looks)
    until(lambda: next(looks) and said(store, "warning"))
    (warning,) = said(store, "warning")
    assert warning["text"].startswith(f"127.0.0.1:{port}: cannot be reached at ")


@pytest.mark.parametrize("address", ["mqtt://localhost", "mqtt:///farm", "mqtt://localhost:no/farm"])
def test_an_address_that_is_none_is_refused(address: str) -> None:
    with pytest.raises(DataError, match="expected mqtt://HOST:PORT/TOPIC"):
        Broker(address, None)


def test_what_does_not_go_with_a_broker_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DataError, match=r"--once: a broker has no end(.|\n)*no-such-file"):
        gh.watch("wind_turbine", "mqtt://localhost/farm", once=True, card=tmp_path / "no-such-file")
    with pytest.raises(DataError, match="--publish: only the broker"):
        gh.watch("wind_turbine", "-", publish="events")
