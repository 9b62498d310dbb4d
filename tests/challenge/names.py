"""`python -m tests.challenge names`: campaigns of real machines with a known truth, and drawn ones, in one table.

Beside the diagnosis stand three rivals: one node whose conductance may change, a normal-behaviour model with a lag
whose residuals raise an alarm, and a regression for each of the two stages. The page is made from the result.
"""

from __future__ import annotations

import json
import os
import textwrap
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any

import jinja2
import numpy as np
import typer
from gearheat.model.errors import GearheatError
from gearheat.scenarios.measured.adapter import Columns, adapter, write_csv
from gearheat.scenarios.shipped import RIGS
from gearheat.tools.diagnose.api import diagnose
from gearheat.tools.show import console

from . import practice
from .rivals import rivals

HERE = Path(__file__).parent
#: What the page is made from, and the page.
STORED, PAGE = HERE / "names.json", HERE.parents[1] / "tools" / "docs" / "pages" / "trust" / "names.md"
#: Probability that the answers of a set have together.
LEVEL = 0.9
#: Columns of the page.
WIDTH = 120
#: Readings of a tenth of the healthy stage: every tenth reading, or a stretch of them, in which pump and valve differ.
CHUNKS = 12
#: Conductance of the cooler at 3 % over the healthy one by the makers' cooling power, TS3 and the room.
SHARE = 0.33


@dataclass(frozen=True)
class Campaign:
    """A campaign: asked and reference as tables, and what is true.

    Args:
        name, machine: of the campaign and of what it was taken on
        truth: causes that were there; None where nobody knows
        share: known factor of the first cause
        channel, given: column that the rivals predict, and those from which
        options: of `diagnose`
    """

    name: str
    machine: str
    truth: tuple[str, ...] | None
    asked: Columns
    reference: Columns
    channel: str
    given: tuple[str, ...]
    rig: str
    options: Mapping[str, Any]
    siblings: tuple[Columns, ...] = ()
    share: float | None = None


def campaigns(folder: Path | None = None) -> Iterator[Campaign]:
    """All campaigns.

    Args:
        folder: with further drawn ones and their keys
    """
    yield from hydraulic()
    known = adapter("wind_turbine")
    for case in known.cases(RIGS / "wind_turbine"):
        parts = (case.asked, case.reference)
        given = ("n_hss_rpm", "T_hss_Nm", "T_nacelle_C")
        card = {"card": known.table["card"], "quick": True}
        yield Campaign(case.name, "wind turbine", None, *parts, "T_sump_C", given, "wind_turbine", card, case.siblings)
    for place in (HERE / "practice_cases", *([folder] if folder else [])):
        yield from drawn(place)


def hydraulic() -> Iterator[Campaign]:
    """Stages of the cooler by all, one and two thermometers; states of the leak; tenths of the healthy stage."""
    known = adapter("hydraulic")
    rows = known.read(RIGS / "hydraulic")
    card, given = known.table["card"], ("T_room_C",)

    def made(name: str, truth: tuple[str, ...], asked: Columns, reference: Columns, **more: Any) -> Campaign:
        channel = next(column for column in ("TS1_C", "TS3_C") if column in asked)
        options = {"card": card, "quick": more.pop("quick", True)}
        return Campaign(name, "hydraulic", truth, asked, reference, channel, given, "hydraulic", options, **more)

    for case in known.cases(RIGS / "hydraulic"):
        if case.name.startswith("leak"):
            yield made(case.name, ("losses.pump_leak",), case.asked, case.reference)
            continue
        truth, share = ("cooling.cooler",), SHARE if "3 %" in case.name else None
        yield made(case.name, truth, case.asked, case.reference, share=share, quick=False)
        for words, kept in (("TS1 alone", ("TS1_C",)), ("TS3 and TS4", ("TS3_C", "TS4_C"))):
            asked, reference = (
                {c: v for c, v in part.items() if c in ("point", "T_room_C", *kept)}
                for part in (case.asked, case.reference)
            )
            yield made(f"{case.name}, {words}", truth, asked, reference, share=share)
    healthy = {name: column[rows["cooler"] == 100] for name, column in rows.items()}
    pieces = _pieces(known.table["writes"], healthy)
    number = np.arange(10 * CHUNKS)
    for words, of in (("healthy tenth", number % 10), ("healthy stretch", number // CHUNKS)):
        for k in range(10):
            parts = [{name: column[keep] for name, column in pieces.items()} for keep in (of == k, of != k)]
            yield made(f"{words} {k + 1}", (), *map(_numbered, parts))


def _pieces(writes: Mapping[str, str], rows: Columns) -> Columns:
    """Means over ten times as many equal pieces as a tenth has readings."""
    pieces = np.array_split(np.arange(len(rows["time"])), 10 * CHUNKS)
    columns = {name: eval(text, {"__builtins__": {}}, dict(rows)) for name, text in writes.items()}
    return {name: np.array([np.mean(column[p]) for p in pieces]) for name, column in columns.items()}


def _numbered(columns: Columns) -> Columns:
    """With the numbers of the readings."""
    return {"point": np.arange(1.0, len(next(iter(columns.values()))) + 1), **columns}


def drawn(place: Path) -> Iterator[Campaign]:
    """Drawn campaigns of the planetary rig with their keys."""
    for folder in practice.folders(place):
        paths, key = practice.files(folder), json.loads((folder / "key.json").read_text(encoding="utf-8"))
        truth = tuple(key["truth"]) if key["kind"] != "unknown" else ("model.unexplained",)
        asked, reference = (_columns(paths[what]) for what in ("data", "reference"))
        given = ("n_carrier_rpm", "T_carrier_Nm", "T_amb_C")
        card = {"card": paths["card"].read_text(encoding="utf-8"), "quick": True}
        name, rig = "planetary, drawn", "planetary"
        yield Campaign(folder.name, name, truth, asked, reference, "T_oil_C", given, rig, card)


def _columns(path: Path) -> Columns:
    """A table of numbers and texts."""
    header, *rows = (line.split(",") for line in path.read_text(encoding="utf-8").splitlines())
    found = {}
    for name, cells in zip(header, zip(*rows, strict=True), strict=True):
        try:
            found[name] = np.array([float(cell) if cell else np.nan for cell in cells])
        except ValueError:
            found[name] = np.array(cells)
    return found


def judge(c: Campaign, seed: int = 0) -> dict[str, Any]:
    """Diagnose a campaign, and score what is named.

    Args:
        c: the campaign
        seed: of everything that is drawn
    """
    began = time.process_time()
    with TemporaryDirectory() as temporary:
        place = Path(temporary)
        card = place / ("card.json" if c.options["card"].lstrip().startswith("{") else "card.toml")
        card.write_text(c.options["card"], encoding="utf-8")
        paths = [place / f"{k}.csv" for k in range(2 + len(c.siblings))]
        for path, columns in zip(paths, (c.asked, c.reference, *c.siblings), strict=True):
            write_csv(path, columns)
        asked, reference, *siblings = paths
        more: dict[str, Any] = {"card": card, "quick": c.options["quick"], "seed": seed}
        if "point" in c.asked:
            given: dict[str, Any] = {"data": asked, "reference": reference}
        else:
            given = {"data": None, "logs": asked, "reference_logs": reference, "sibling_logs": siblings}
        try:
            found = diagnose(rig=c.rig, **given, **more).as_dict()
        except GearheatError:  # a year in which the machine stands
            found = {"verdict": "refused", "answers": [], "causes": [], "hypotheses": []}
    seconds = time.process_time() - began
    return score(c, found) | {"seconds": seconds, "rivals": rivals(c.asked, c.reference, c.channel, c.given)}


def score(c: Campaign, found: Mapping[str, Any]) -> dict[str, Any]:
    """What of a diagnosis is right.

    Args:
        c: the campaign
        found: the diagnosis as JSON has it
    """
    answers = [(a["probability"], sorted({names[0] for names in a["causes"]})) for a in found["answers"]]
    kept, total = [], 0.0
    for probability, names in answers:
        kept.append(names)
        total += probability
        if total >= LEVEL:
            break
    leading = answers[0][1] if found["verdict"] not in ("consistent", "refused") else []
    causes = {cause["id"]: cause for cause in found["causes"]}
    size = next(iter(causes[leading[0]]["parameters"]), None) if leading and leading[0] in causes else None
    gain = found.get("gain") or {}
    result = {
        "name": c.name,
        "machine": c.machine,
        "truth": None if c.truth is None else list(c.truth),
        "verdict": found["verdict"],
        "p_none": next((h["probability"] for h in found["hypotheses"] if not h["causes"]), 0.0),
        "answers": [{"causes": names, "probability": p} for p, names in answers],
        "set": len(kept),
        "leading": leading,
        "size": size,
        "since": causes[leading[0]].get("since", "") if leading and leading[0] in causes else "",
        "before": gain.get("rmse_before"),
        "after": gain.get("rmse_after"),
        "invisible": [one["cause"] if "cause" in one else one.get("id") for one in found.get("invisible", ())],
    }
    if c.truth is not None:
        result["first"] = set(c.truth) == set(leading)
        result["in_set"] = any(set(c.truth) <= set(names) for names in kept) if c.truth else not leading
        result["false"] = len(set(leading) - set(c.truth))
        result["share"] = c.share
    return result


def render(stored: Mapping[str, Any]) -> str:
    """The page.

    Args:
        stored: what `names` wrote
    """
    environment = jinja2.Environment(undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    template = environment.from_string((HERE / "names.md.jinja").read_text(encoding="utf-8"))
    by = {result["name"]: result for result in stored["results"]}
    tenths, stretches = ([f"healthy {words} {k}" for k in range(1, 11)] for words in ("tenth", "stretch"))
    case = adapter("hydraulic").cases(RIGS / "hydraulic", "cooler at 3 %")[0]
    rise = {name: float(np.mean(case.asked[name]) - np.mean(case.reference[name])) for name in ("TS1_C", "T_room_C")}
    rise["healthy"] = float(np.ptp(case.reference["TS1_C"]))
    known = {"tenths": tenths, "stretches": stretches, "rise": rise, "exp": np.exp}
    page = template.render(results=stored["results"], by=by, **known)
    return "\n\n".join(map(_wrapped, page.split("\n\n"))).strip() + "\n"


def _wrapped(text: str) -> str:
    """A paragraph of a page; tables stay as they are."""
    return text if "|" in text else textwrap.fill(" ".join(text.split()), WIDTH, break_long_words=False)


def draw(path: Path) -> None:
    """The readings of the hydraulic rig: both stages of the cooler in the order of time.

    Args:
        path: picture to write
    """
    from matplotlib.figure import Figure

    case = adapter("hydraulic").cases(RIGS / "hydraulic", "cooler at 3 %")[0]
    figure = Figure(figsize=(7, 3), layout="constrained")
    axes = figure.subplots()
    for name in ("TS1_C", "TS2_C", "TS3_C", "TS4_C", "T_room_C"):
        axes.plot(np.r_[case.asked[name], np.nan, case.reference[name]], "o-", ms=3, label=name.removesuffix("_C"))
    axes.set(xlabel="reading: cooler at 3 %, then at 100 %", ylabel="degC")
    axes.legend(loc="upper right", ncols=5, fontsize=8)
    figure.savefig(path, metadata={"Date": None})


def names(
    out: Annotated[Path, typer.Option("-o", "--out", help="JSON to write.")] = STORED,
    page: Annotated[Path, typer.Option(help="Page to write.")] = PAGE,
    only: Annotated[str, typer.Option(help="Only campaigns whose name begins so; nothing is written then.")] = "",
    folder: Annotated[Path | None, typer.Option("--practice", help="Folder of further drawn campaigns.")] = None,
    jobs: Annotated[int, typer.Option("-j", "--jobs", min=1, help="How many to run at once.")] = os.cpu_count() or 1,
    seed: Annotated[int, typer.Option(help="Of everything that is drawn.")] = 0,
) -> None:
    """Real machines with a known truth, and drawn ones: what the diagnosis names, beside three rivals."""
    todo = [c for c in campaigns(folder) if c.name.startswith(only)]
    run: Callable[[Campaign], dict[str, Any]] = partial(judge, seed=seed)
    results = []
    with ProcessPoolExecutor(jobs) as pool:
        for result in pool.map(run, todo):
            results.append(result)
            if not only:
                out.write_text(json.dumps({"seed": seed, "results": results}, indent=1, default=float) + "\n")
            shown = [f"{' + '.join(a['causes']) or 'nothing'} {a['probability']:.2f}" for a in result["answers"]]
            console.note(f"{len(results)}/{len(todo)} {result['name']}: {result['verdict']}: {', '.join(shown)}")
    stored = json.loads(json.dumps({"seed": seed, "results": results}, default=float))
    if not only:
        page.write_text(render(stored), encoding="utf-8")
        draw(page.with_suffix(".svg"))
