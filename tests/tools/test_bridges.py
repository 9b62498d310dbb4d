"""The bridges of the page on watching print what a plant has as the CSV that a watch takes."""

import sqlite3
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from gearheat.scenarios.measured.card import Card
from gearheat.scenarios.measured.table import Sensor
from gearheat.tools.docs.blocks import PAGES, blocks
from gearheat.tools.watch.sources import Stream
from gearheat.tools.watch.store import Store
from gearheat.tools.watch.watch import Watch

BRIDGES = {b.file: b.text for b in blocks((PAGES / "howto" / "watch.md").read_text(encoding="utf-8")) if b.file}
SENSORS = tuple(
    Sensor(n, n, n, kind, "read", "", 1, 1) for n, kind in {"n_hss_rpm": "speed", "T_sump_C": "oil"}.items()
)


@contextmanager
def running(name: str, folder: Path, *changes: str) -> Iterator["subprocess.Popen[bytes]"]:
    """A bridge with some of its texts replaced, each by the one that follows it."""
    text = BRIDGES[name]
    for old, new in zip(changes[::2], changes[1::2], strict=True):
        assert text.count(old) == 1
        text = text.replace(old, new)
    (folder / name).write_text(text)
    process = subprocess.Popen([sys.executable, name], cwd=folder, stdout=subprocess.PIPE)
    yield process
    process.kill()
    process.communicate()


def machines(process: "subprocess.Popen[bytes]", windows: int, every: int) -> Store:
    """A store that has taken what a bridge prints, once so many windows are answered."""
    store, answer = Store(None, ""), {"verdict": "consistent", "causes": []}
    assert process.stdout
    watch = Watch(SENSORS, Card(), store, lambda *asked: {**answer, "rows": asked[3]}, every, lambda: 4e9)
    looks = watch.follow(Stream(process.stdout))  # type: ignore[arg-type]
    while len(list(store.events(0))) < windows:
        next(looks)
    return store


def test_a_bridge_has_twenty_lines() -> None:
    assert all(len([line for line in text.splitlines() if line]) <= 20 for text in BRIDGES.values())


def test_opc_ua(tmp_path: Path) -> None:
    sync = pytest.importorskip("asyncua.sync", reason="asyncua speaks OPC UA")
    server = sync.Server()
    server.set_endpoint(address := "opc.tcp://127.0.0.1:48411")
    index = server.register_namespace("plant")
    hss = server.nodes.objects.add_object(index, "hss")
    for name, value in (("hss.speed", 1500.0), ("sump.temperature", 53.5)):
        hss.add_variable(sync.ua.NodeId(name, index), name, value)
    with (
        server,
        running("opcua.py", tmp_path, "opc.tcp://localhost:4840", address, "600.0, 5.0", "0.2, 0.05") as bridge,
    ):
        store = machines(bridge, 1, 3)
    assert '"T_sump_C": 53.5' in next(iter(store.events(0)))[1]


def test_a_historian_with_pythons_database_interface(tmp_path: Path) -> None:
    rows = [(f"2016-03-01 00:{k:02}:00Z", name, 1500.0, 50.0 + k if k else None) for k in range(9) for name in "ab"]
    with sqlite3.connect(tmp_path / "historian.db") as base:
        base.execute("create table samples (time_utc, machine, n_hss_rpm, T_sump_C)")
        base.executemany("insert into samples values (?, ?, ?, ?)", rows)
    with running("historian.py", tmp_path, "60.0", "0.1") as bridge:
        store = machines(bridge, 4, 4)
    assert list(store.machines) == ["a", "b"]
    assert [store.last(name, "window", 9)[-1]["to"] for name in "ab"] == ["2016-03-01T00:07:00Z"] * 2
