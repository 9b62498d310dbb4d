"""Pages of rigs: their size, what they need until the first numbers and per drag, and that they equal native code."""

from __future__ import annotations

import base64
import gzip
import json
import re
import struct
import tempfile
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from ...fmu.batch import Batch, Status
from ...model.errors import DataError
from ...model.run.schedule import Schedule
from ...scenarios.given import RigLike, scenario_of
from ..build.new import new
from ..page.page import Page, page
from ..show.console import note
from ..solve.settings import flat_of
from .harness import TABLES, timed

#: Head of the table of `rows_of`.
HEAD = ("rig", "page [kB]", "module [kB]", "first numbers [ms]", "a drag [ms]", "steady states, warm-ups: differ by")
#: Operating points that are compared.
POINTS = 200
#: Warm-ups that are compared.
WARMUPS = 10
#: Drags that are timed.
DRAGS = 50
#: What is smaller is compared with this, in its unit.
SMALL = 1e-6
#: Times of a warm-up [s].
TIMES = np.linspace(0.0, 20_000.0, 41)


def measure() -> dict[str, Any]:
    """The figures of the pages of some shipped rigs, and of one from a name plate.

    Raises:
        DataError: wasmtime, which runs the modules, is not installed
    """
    if find_spec("wasmtime") is None:
        raise DataError("bench --page: wasmtime is not installed. Run pip install wasmtime.")
    asked = TABLES["page"]
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / f"{asked['new']['name']}.toml"
        new(**asked["new"], out=made)
        return {"pages": [_measured(rig) for rig in (*asked["rigs"], made)]}


def _measured(rig: RigLike) -> dict[str, Any]:
    note(f"{rig}")
    return measure_page(rig, page(rig))


def measure_page(rig: RigLike, page: Page) -> dict[str, Any]:
    """The figures of one page: processor times without drawing, largest relative differences from native code.

    Args:
        rig: whose page it is
        page: the page
    """
    first_s, module = timed(lambda: _first(page))
    flat = flat_of(scenario_of(rig))
    batch, u = Batch(flat), module.points(POINTS)
    drag_s, _ = timed(lambda: [module.steady(row[None, :]) for row in u[:DRAGS]])
    (x, y, status), rows = module.steady(u), batch.steady(u)
    good = rows.status == int(Status.OK)
    steady = max(_differ(x[good], rows.x[good]), _differ(y[good], rows.y[good])) if (status[good] == 0).all() else 1.0
    warmup = 0.0
    for one in u[good][:WARMUPS]:
        course, stopped = module.warmup(one, TIMES)
        native = batch.warmup(Schedule(TIMES[[0, -1]], {}), one[None, :], times=TIMES)
        alike = stopped == native.status[0]
        warmup = max(warmup, _differ(course, native.x[0]) if alike else 1.0)
    return {
        "rig": flat.name,
        "bytes": page.found["bytes"],
        "module_bytes": page.found["module_bytes"][0],
        "first_s": first_s,
        "drag_s": drag_s / DRAGS,
        "points": int(good.sum()),
        "steady": steady,
        "warmup": warmup,
    }


def rows_of(found: Mapping[str, Any]) -> list[tuple[Any, ...]]:
    """The rows of the table under `HEAD`."""
    return [
        (
            one["rig"],
            round(one["bytes"] / 1000),
            round(one["module_bytes"] / 1000),
            round(1000 * one["first_s"]),
            round(1000 * one["drag_s"], 2),
            f"{one['steady']:.1g}, {one['warmup']:.1g}",
        )
        for one in found["pages"]
    ]


def _differ(a: np.ndarray, b: np.ndarray) -> float:
    """The largest relative difference."""
    return float(np.max(np.abs(a - b) / np.maximum(np.abs(b), SMALL), initial=0.0))


def _first(page: Page) -> Module:
    """Unpacked, compiled, and asked once."""
    module = Module(told(page))
    module.steady(module.start("inputs")[None, :])
    return module


def told(page: Page) -> dict[str, Any]:
    """What the script of a page reads."""
    found = re.search(r'id="data">(.*?)</script>', page.html, re.DOTALL)
    assert found
    data: dict[str, Any] = json.loads(found[1])
    return data


class Module:
    """The module of a page in `wasmtime`, called as the page's script calls it."""

    def __init__(self, data: dict[str, Any]) -> None:
        import wasmtime

        self.about = data["machines"][0]
        code = gzip.decompress(base64.b64decode(data["modules"][self.about["module"]]))
        self.store = wasmtime.Store()
        self.c = wasmtime.Instance(self.store, wasmtime.Module(self.store.engine, code), []).exports(self.store)

    def start(self, kind: str) -> np.ndarray:
        """Start values of "states", "inputs" or "parameters" (n,)."""
        return np.array([q["start"] for q in self.about[kind]])

    def call(self, name: str, *arguments: Any) -> list[np.ndarray]:
        """A driver with numbers and arrays; the arrays as it leaves them."""
        arrays = [a for a in arguments if isinstance(a, np.ndarray)]
        memory, places = self.c["memory"], [self.c["malloc"](self.store, max(8, a.nbytes)) for a in arrays]
        for array, place in zip(arrays, places, strict=True):
            memory.write(self.store, array.tobytes(), place)
        rest = iter(places)
        done = self.c[name](self.store, *(next(rest) if isinstance(a, np.ndarray) else a for a in arguments))
        assert done == 1
        read = [memory.read(self.store, p, p + a.nbytes) for a, p in zip(arrays, places, strict=True)]
        return [np.frombuffer(bytes(r), a.dtype).reshape(a.shape) for r, a in zip(read, arrays, strict=True)]

    def steady(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """States (n, states), outputs (n, outputs) and status (n,) of rows of inputs."""
        n, wide = len(u), len(self.about["outputs"]) + len(self.about["checks"]) + 4
        x, y, status = np.zeros((n, len(self.about["states"]))), np.zeros((n, wide)), np.zeros(n, np.int32)
        p, start, home = self.start("parameters"), self.start("states"), self.start("inputs")
        left = self.call("batch_steady", n, u, u.shape[1], p, 0, start, 0, home, x, y, status, np.zeros(n, np.int32))
        return left[4], left[5][:, : len(self.about["outputs"])], left[6]

    def warmup(self, u: np.ndarray, times: np.ndarray) -> tuple[np.ndarray, int]:
        """States at times (n, states), and the status, at constant inputs."""
        m, n = len(times) - 1, len(times)
        before, after = np.zeros(n, np.int32), np.ones(n, np.int32)
        before[m], after[m] = 1, 0
        pieces = [np.diff(times), np.zeros((m, len(u))), np.zeros((m, len(u))), np.zeros(len(u), np.int32)]
        places = []
        for array in (*pieces, before, after):
            places.append(self.c["malloc"](self.store, array.nbytes))
            self.c["memory"].write(self.store, array.tobytes(), places[-1])
        duty = np.frombuffer(struct.pack("<q6Id", m, *places, 1e-4), np.uint8).copy()
        wide = len(self.about["outputs"]) + len(self.about["checks"])
        x, y, status = np.zeros((n, len(self.about["states"]))), np.zeros((n, wide)), np.zeros(1, np.int32)
        inputs = [u, 0, self.start("parameters"), 0, self.start("states"), 0, n]
        left = self.call("batch_warmup", 1, duty, *inputs, x, y, np.zeros(4), status, np.zeros(1, np.int32))
        return left[4], int(left[7][0])

    def points(self, n: int) -> np.ndarray:
        """Inputs of n operating points between the ends of the sliders."""
        random, u = np.random.default_rng(7), np.tile([q["start"] for q in self.about["inputs"]], (n, 1))
        for field in self.about["fields"]:
            if field["group"] == "operating point":
                place = [q["name"] for q in self.about["inputs"]].index(field["name"])
                low, high = field["ends"]
                u[:, place] = random.uniform(low, high, n)
        return u
