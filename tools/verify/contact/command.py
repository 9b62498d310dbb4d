"""The verification of the contact solver: table, figures, pages, all by one command that can be interrupted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ...show.console import answer, folder, table, write
from . import cycle, figures, lines, moving, pages, steady, store, studies
from .rows import Found, Job

#: File of each figure.
FILES = {
    "Films": "films.svg",
    "Convergence": "convergence.svg",
    "Film and pressure": "shape.svg",
    "Moving dent": "dent.svg",
    "Cost": "cost.svg",
    "Mesh cycle": "cycle.svg",
}


def command(out: Path, quick: bool, rig: str | None, json: str | None) -> None:
    """Verify the contact solver and write the pages.

    Args:
        out: folder for pages, figures and kept results
        quick: a subset on coarse grids
        rig: whose mesh cycle is solved as well
        json: where the rows go as JSON
    """
    found = store.run([*jobs(quick), *(cycle.jobs(rig) if rig else [])], folder(out))
    rows = pages.rows(found)
    drawn = draw(found, rows)
    for title, text in drawn.items():
        write(out / FILES[title], text)
    write(out / "verification.md", pages.markdown(rows, {title: FILES[title] for title in drawn}))
    write(out / "verification.html", pages.html(rows, drawn))
    write(out / "verification.csv", pages.as_csv(rows))
    result: dict[str, Any] = {"schema": "gearheat.ehl/1", "rows": rows}
    answer(result, json, lambda: table("The contact solver, verified", pages.SUMMARY, pages.summary(rows)))


def jobs(quick: bool) -> list[Job]:
    """All pieces of work, or the quick ones.

    Args:
        quick: a subset on coarse grids
    """
    parts = (*steady.jobs(quick), *lines.jobs(quick), *studies.jobs(quick), *moving.jobs(quick))
    items = list(dict.fromkeys(job.item for job in parts))
    wanted = [job for job in parts if job.quick or not quick]
    return sorted(wanted, key=lambda job: items.index(job.item))


def draw(found: Sequence[tuple[Job, Found]], rows: Sequence[Mapping[str, Any]]) -> dict[str, str]:
    """Title -> SVG text of every figure there are results for.

    Args:
        found: pieces of work and their results
        rows: the table
    """
    by_item = {item: {job.name: kept for job, kept in found if job.item == item} for item in {j.item for j, _ in found}}
    drawn = {"Films": figures.films(rows)}
    if "Convergence" in by_item:
        drawn["Convergence"] = figures.convergence(by_item["Convergence"])
    if "Shape" in by_item:
        drawn["Film and pressure"] = figures.shape(next(iter(by_item["Shape"].values())))
    if "Cost" in by_item:
        drawn["Cost"] = figures.cost(next(iter(by_item["Cost"].values())))
    if "Moving dent" in by_item:
        drawn["Moving dent"] = figures.dent(by_item["Moving dent"])
    if "Mesh cycle" in by_item:
        bands = {"ratio": cycle.LAMBDA_BAND, "share": cycle.SHARE_BAND}
        drawn["Mesh cycle"] = figures.cycle(next(iter(by_item["Mesh cycle"].values())), bands)
    return drawn
