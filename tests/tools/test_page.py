"""A page of a rig: its module of WebAssembly gives what the commands give, and it lives in a browser."""

import base64
import gzip
import json
import re
import shutil
import struct
import subprocess
from pathlib import Path
from typing import Any

import gearheat as gh
import numpy as np
import pytest
from for_each import ALL
from gearheat.fmu.batch import Batch, Status
from gearheat.model.errors import DataError, ScenarioError
from gearheat.model.run.schedule import Schedule
from gearheat.tools.solve.settings import flat_of

SAME = 1e-9
RIGS = ("planetary", "helical_two_stage", "drum_motor", "wind_turbine") if ALL else ("planetary",)
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), "")


def told(page: gh.Page) -> dict[str, Any]:
    """What the page's script reads."""
    found = re.search(r'id="data">(.*?)</script>', page.html, re.DOTALL)
    assert found
    data: dict[str, Any] = json.loads(found[1])
    return data


class Module:
    """The module of a page in `wasmtime`, called as the page's script calls it."""

    def __init__(self, data: dict[str, Any]) -> None:
        wasmtime = pytest.importorskip("wasmtime", reason="wasmtime runs the module: pip install wasmtime")
        self.about = data["machines"][0]
        code = gzip.decompress(base64.b64decode(data["modules"][self.about["module"]]))
        self.store = wasmtime.Store()
        self.c = wasmtime.Instance(self.store, wasmtime.Module(self.store.engine, code), []).exports(self.store)

    def start(self, kind: str) -> np.ndarray:
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
        n, wide = len(u), len(self.about["outputs"]) + len(self.about["checks"]) + 4
        x, y, status = np.zeros((n, len(self.about["states"]))), np.zeros((n, wide)), np.zeros(n, np.int32)
        p, start, home = self.start("parameters"), self.start("states"), self.start("inputs")
        left = self.call("batch_steady", n, u, u.shape[1], p, 0, start, 0, home, x, y, status, np.zeros(n, np.int32))
        return left[4], left[5][:, : len(self.about["outputs"])], left[6]

    def warmup(self, u: np.ndarray, times: np.ndarray) -> tuple[np.ndarray, int]:
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


@pytest.fixture(scope="module")
def pages() -> dict[str, gh.Page]:
    return {rig: gh.page(rig) for rig in RIGS}


def points(about: dict[str, Any], n: int) -> np.ndarray:
    """Inputs of n operating points between the ends of the sliders."""
    random, u = np.random.default_rng(7), np.tile([q["start"] for q in about["inputs"]], (n, 1))
    for field in about["fields"]:
        if field["group"] == "operating point":
            place = [q["name"] for q in about["inputs"]].index(field["name"])
            u[:, place] = random.uniform(*field["ends"], n)
    return u


def test_the_module_gives_the_steady_states_and_warm_ups_of_the_commands(pages: dict[str, gh.Page]) -> None:
    for rig, page in pages.items():
        module, batch = Module(told(page)), Batch(flat_of(gh.load(rig).scenario))
        u = points(module.about, 200)
        x, y, status = module.steady(u)
        rows = batch.steady(u)
        good = rows.status == int(Status.OK)
        assert good.sum() > 100
        assert (status == 0)[good].all()
        assert x[good] == pytest.approx(rows.x[good], rel=SAME)
        assert y[good] == pytest.approx(rows.y[good], rel=SAME, abs=1e-9)
        times = np.linspace(0.0, 20_000.0, 41)
        for one in u[good][:10]:
            course, stopped = module.warmup(one, times)
            held = Schedule(times[[0, -1]], {})
            native = batch.warmup(held, one[None, :], times=times)
            assert stopped == native.status[0] == 0
            assert course == pytest.approx(native.x[0], rel=SAME)


def test_the_page_is_one_small_file_that_says_what_it_holds(pages: dict[str, gh.Page], tmp_path: Path) -> None:
    page = pages["planetary"]
    assert page.found["bytes"] == len(page.html.encode()) < 1_000_000
    assert not re.search(r'(src|href)="', page.html)
    assert page.found["fields"][:3] == ["carrier.w", "carrier.tau", "room.T"]
    assert "cooling.A" in page.found["fields"]
    assert page.save(tmp_path / "page.html").read_text(encoding="utf-8") == page.html
    machine = told(page)["machines"][0]
    assert set(machine["heat"]) == {"cooling.Q_flow_convection", "cooling.Q_flow_radiation", "foot.Q_flow"}
    assert sum(map(len, machine["losses"].values())) == 8


def test_measured_points_and_further_fields(tmp_path: Path) -> None:
    table = tmp_path / "read.csv"
    table.write_text("carrier.w [rpm],carrier.tau [Nm],oil.T [degC]\n250,2500,80\n100,500,50\n")
    gh.load("planetary").with_({"cooling.A": "0.3 m2"}).save(tmp_path / "dusty.toml")
    page = gh.page("planetary", data=table, more=["foot.G", "oil.c_p"], extended=[tmp_path / "dusty.toml"])
    data = told(page)
    assert data["measured"]["names"] == ["carrier.w", "carrier.tau", "oil.T"]
    assert data["measured"]["rows"][0][2] == pytest.approx(353.15)
    assert page.found["machines"] == ["as given", "dusty"]
    assert len(data["modules"]) == 1
    assert [f["name"] for f in data["machines"][1]["fields"]].count("foot.G") == 1


def test_what_does_not_fit_a_page_is_told_by_name(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r'no parameter "seat_1.H".* Did you mean "seat_1.G"'):
        gh.page("wind_turbine", more=["seat_1.H"])
    table = tmp_path / "read.csv"
    table.write_text("sump.Temp [degC],sump.T [degC]\n50,x\n")
    with pytest.raises(DataError, match=r'the model has no "sump.Temp"(.|\n)*"sump.T \[degC\]" is no number'):
        gh.page("wind_turbine", data=table)


#: Opens a page at three widths, moves a slider, and writes what it sees into itself.
HARNESS = """<body><script>
const seen = {};
const wait = (frame, then) =>
  frame.contentDocument?.body?.dataset.ready ? then() : setTimeout(() => wait(frame, then), 50);
for (const width of [360, 800, 1400]) {
  const frame = document.createElement("iframe");
  frame.width = width; frame.height = 900; frame.src = "page.html#room.T=30";
  document.body.append(frame);
  frame.onload = () => wait(frame, () => {
    const page = frame.contentDocument, oil = () => Number(page.querySelector('[data-name="oil.T"]').dataset.si);
    const slider = page.querySelector('[id="f-carrier.tau"]').parentElement.querySelector("[type=range]");
    const own = { overflow: page.documentElement.scrollWidth - width, before: oil() };
    own.status = page.getElementById("status").textContent;
    slider.value = slider.min;
    slider.dispatchEvent(new Event("input"));
    Object.assign(own, { after: oil(), drag: page.body.dataset.drag, plots: page.querySelectorAll(".u-over").length,
      cells: page.querySelectorAll("#map rect").length, link: frame.contentWindow.location.hash,
      unlabelled: [...page.querySelectorAll("input")].filter((i) => !i.labels.length && !i.ariaLabel).length });
    seen[width] = own;
    if (Object.keys(seen).length === 3) document.body.textContent = JSON.stringify(seen);
  });
}
</script></body>"""


@pytest.mark.skipif(not CHROMIUM, reason="no browser")
def test_in_a_browser_a_slider_moves_the_numbers_and_nothing_overflows(
    pages: dict[str, gh.Page], tmp_path: Path
) -> None:
    pages["planetary"].save(tmp_path / "page.html")
    (tmp_path / "all.html").write_text(HARNESS)
    options = ["--headless=new", "--no-sandbox", "--disable-gpu", "--allow-file-access-from-files"]
    options += [f"--user-data-dir={tmp_path / 'profile'}", "--virtual-time-budget=20000", "--dump-dom"]
    command = [CHROMIUM, *options, (tmp_path / "all.html").as_uri()]
    dom = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True).stdout
    seen = json.loads(re.search(r"\{.*\}", dom)[0])  # type: ignore[index]
    hot = gh.steady("planetary", {"room.T": "30 degC"})
    for width in ("360", "800", "1400"):
        one = seen[width]
        assert one["overflow"] <= 0, width
        assert one["before"] == pytest.approx(hot["oil.T"], rel=SAME)
        assert one["after"] < one["before"] - 10
        assert (one["plots"], one["unlabelled"], one["status"]) == (1, 0, "")
        assert one["cells"] > 441
        assert "room.T=30" in one["link"] and "carrier.tau=" in one["link"]
