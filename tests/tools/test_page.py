"""A page of a rig: its module of WebAssembly gives what the commands give, and it lives in a browser."""

import base64
import gzip
import json
import os
import re
import subprocess
from pathlib import Path

import gearheat as gh
import pytest
from browser import CHROMIUM, Browser
from for_each import ALL
from gearheat.model.errors import DataError, ScenarioError
from gearheat.tools.bench.pages import measure_page, told

SAME = 1e-9
RIGS = ("planetary", "helical_two_stage", "drum_motor", "wind_turbine") if ALL else ("planetary",)
#: Pictures of pages in the documentation: width and height [px], and what stands at the top.
SHOWN = {
    "planetary": (1400, 1500, "fields"),
    "helical_two_stage": (800, 1000, "h-losses"),
    "drum_motor": (360, 800, "h-warm"),
}


@pytest.fixture(scope="module")
def pages() -> dict[str, gh.Page]:
    return {rig: gh.page(rig) for rig in RIGS}


def test_the_module_gives_the_steady_states_and_warm_ups_of_the_commands(pages: dict[str, gh.Page]) -> None:
    pytest.importorskip("wasmtime", reason="wasmtime runs the module: pip install wasmtime")
    for rig, page in pages.items():
        found = measure_page(rig, page)
        assert found["points"] > 100
        assert max(found["steady"], found["warmup"]) < SAME
        assert found["bytes"] < 1_000_000 and found["drag_s"] < found["first_s"]


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


def test_a_report_links_the_page_from_where_it_stands(pages: dict[str, gh.Page], tmp_path: Path) -> None:
    report = tmp_path / "reports" / "report.html"
    report.parent.mkdir()
    report.write_text("<html><body>\n<h1>Found</h1></body></html>")
    pages["planetary"].save(tmp_path / "the page.html", report=report)
    assert '<body>\n<p><a href="../the%20page.html">The machine computes' in report.read_text()


def test_a_rating_comes_with_the_page(gearheat, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    command = ("rating", "drum_motor", "--limit", "oil.T=70 degC", "--grid", "2x2", "--live", tmp_path / "live.html")
    assert gearheat(*command).code == 0
    html = (tmp_path / "live.html").read_text(encoding="utf-8")
    assert json.loads(re.search(r'id="data">(.*?)</script>', html, re.DOTALL)[1])["limit"] == 343.15  # type: ignore[index]


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


def test_a_page_that_would_be_too_large_is_refused_and_the_old_one_stays(gearheat, monkeypatch, tmp_path) -> None:  # type: ignore[no-untyped-def]
    monkeypatch.setattr("gearheat.tools.page.page.LARGEST", 150_000)
    (tmp_path / "page.html").write_text("old")
    answer = gearheat("page", "planetary", "-o", tmp_path / "page.html")
    assert answer.code == 2
    assert re.search(r"planetary: a page has 0\.\d+ MB(.|\n)* its \d+ parameters(.|\n)*gearheat export", answer.err)
    assert (tmp_path / "page.html").read_text() == "old"


#: Opens a page at three widths, moves a slider, and writes what it sees into itself.
HARNESS = """<body><script>
const seen = {};
const wait = (frame, then) =>
  frame.contentDocument?.body?.dataset.ready ? then() : setTimeout(() => wait(frame, then), 50);
for (const width of [360, 800, 1400]) {
  const frame = document.createElement("iframe");
  frame.width = width; frame.height = 900; frame.src = "page.html#ROOM=30";
  document.body.append(frame);
  frame.onload = () => wait(frame, () => {
    const page = frame.contentDocument, oil = () => Number(page.querySelector('[data-name="OIL"]').dataset.si);
    const slider = page.querySelector('[id="f-TORQUE"]').parentElement.querySelector("[type=range]");
    const flow = () => page.querySelector("#flows path").getAttribute("d"), first = flow();
    const own = { overflow: page.documentElement.scrollWidth - width, before: oil() };
    own.status = page.getElementById("status").textContent;
    slider.value = Math.abs(slider.min) < Math.abs(slider.max) ? slider.min : slider.max;
    slider.dispatchEvent(new Event("input"));
    Object.assign(own, { after: oil(), moved: flow() !== first, bands: page.querySelectorAll("#flows path").length,
      drag: page.body.dataset.drag, plots: page.querySelectorAll(".u-over").length,
      cut: [...page.querySelectorAll("svg text")].filter((text) => {
        const own = text.getBoundingClientRect(), all = text.closest("svg").getBoundingClientRect();
        return own.left < all.left || own.right > all.right;
      }).map((text) => text.textContent),
      cells: page.querySelectorAll("#map rect").length, link: frame.contentWindow.location.hash,
      unlabelled: [...page.querySelectorAll("input")].filter((i) => !i.labels.length && !i.ariaLabel).length });
    seen[width] = own;
    if (Object.keys(seen).length === 3) document.body.textContent = JSON.stringify(seen);
  });
}
</script></body>"""


#: Opens pages that cannot compute, and writes what each says into itself.
REFUSALS = """<body><script>
const names = NAMES, said = {};
for (const name of names) {
  const frame = document.createElement("iframe");
  frame.src = name;
  document.body.append(frame);
  const look = () => {
    const status = frame.contentDocument?.getElementById("status");
    if (status?.className !== "wrong") return setTimeout(look, 50);
    said[name] = status.textContent;
    if (Object.keys(said).length === names.length) document.body.textContent = JSON.stringify(said);
  };
  look();
}
</script></body>"""


def seen_in(page: Path) -> dict:
    """What a page has written into itself."""
    options = ["--headless=new", "--no-sandbox", "--disable-gpu", "--allow-file-access-from-files"]
    options += [f"--user-data-dir={page.parent / 'profile'}", "--virtual-time-budget=20000", "--dump-dom"]
    command = [CHROMIUM, *options, page.as_uri()]
    dom = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True).stdout
    return json.loads(re.search(r"\{.*\}", dom)[0])  # type: ignore[index]


@pytest.mark.skipif(not CHROMIUM, reason="no browser")
def test_a_browser_that_refuses_the_module_says_why(pages: dict[str, gh.Page], tmp_path: Path) -> None:
    html = pages["planetary"].html
    (module,) = told(pages["planetary"])["modules"]
    other = base64.b64encode(gzip.compress(b"\0asm\2\0\0\0")).decode()
    middle = len(module) // 2
    made = {
        "off.html": html.replace("<body>", "<body><script>delete globalThis.WebAssembly</script>"),
        "refused.html": html.replace(module, other),
        "damaged.html": html.replace(module, module[:middle] + module[middle + 4 :]),
        "cut.html": html.replace('"modules"', ""),
    }
    for name, text in made.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "all.html").write_text(REFUSALS.replace("NAMES", json.dumps(list(made))))
    said = seen_in(tmp_path / "all.html")
    assert "this browser has no WebAssembly. It takes Chromium 91" in said["off.html"]
    assert re.search(r"this browser refuses the module \(.*version.*\)", said["refused.html"])
    assert all("the file is damaged on its way. Copy it again" in said[name] for name in ("damaged.html", "cut.html"))


@pytest.mark.parametrize("rig", RIGS)
@pytest.mark.skipif(not CHROMIUM, reason="no browser")
def test_in_a_browser_a_slider_moves_the_numbers_and_nothing_overflows(
    pages: dict[str, gh.Page], rig: str, tmp_path: Path
) -> None:
    pages[rig].save(tmp_path / "page.html")
    machine = told(pages[rig])["machines"][0]
    oil, (_, torque, room) = machine["leading"][0], [field["name"] for field in machine["fields"][:3]]
    harness = HARNESS.replace("OIL", oil).replace("TORQUE", torque).replace("ROOM", room)
    (tmp_path / "all.html").write_text(harness)
    seen = seen_in(tmp_path / "all.html")
    hot = gh.steady(rig, {room: "30 degC"})
    flows = [*machine["losses"].values(), *([name] for name in machine["heat"])]
    bands = sum(any(hot[name] for name in names) for names in flows)
    for width in ("360", "800", "1400"):
        one = seen[width]
        assert one["overflow"] <= 0, width
        assert one["before"] == pytest.approx(hot[oil], rel=SAME)
        assert one["after"] < one["before"] - (10 if rig == "planetary" else 1)
        assert (one["plots"], one["unlabelled"], one["cut"]) == (1, 0, [])
        assert ("is above the limit of 95 degC" in one["status"]) == (hot[oil] > 368.15)
        assert one["cells"] > 441
        assert one["moved"] and one["bands"] == bands
        assert f"{room}=30" in one["link"] and f"{torque}=" in one["link"]


@pytest.mark.skipif(
    not CHROMIUM or os.environ.get("SNAPSHOTS") != "write", reason="pictures are written anew on demand"
)
@pytest.mark.parametrize("rig", SHOWN)
def test_pictures_of_pages_for_the_documentation(rig: str, tmp_path: Path) -> None:
    (width, height, top), page = SHOWN[rig], tmp_path / "page.html"
    gh.page(rig).save(page)
    with Browser(tmp_path / "profile") as browser:
        browser.wide(width, height)
        browser.open(page.as_uri())
        browser.wait("document.body?.dataset.ready")
        browser.js(f"document.getElementById('{top}').scrollIntoView()")
        browser.show(f"page_{width}.png")
