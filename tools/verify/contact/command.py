"""The verification of the contact solver: table, figures, pages, all by one command that can be interrupted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ...show.console import folder, write
from ...show.display import Answer
from . import cycle as cycles, figures, lines, pages, steady, studies
from .rows import Found, Job, run

#: File of each figure.
FILES = {
    "Films": "films.svg",
    "Convergence": "convergence.svg",
    "Film and pressure": "shape.svg",
    "Moving dent": "dent.svg",
    "Cost": "cost.svg",
    "Mesh cycle": "cycle.svg",
}


class ContactVerification(Answer):
    """The contact solver beside published films, Hertz and measurements; the table has a row for each item."""


def verify_contact(out: str | Path, *, quick: bool = False, cycle: str | None = None) -> ContactVerification:
    """Check the contact solver and write pages and figures. An interrupted run goes on.

    Args:
        out: folder for pages, figures and kept results
        quick: a subset on coarse grids
        cycle: rig whose mesh cycle is solved as well

    Raises:
        GearheatError: the rig or the folder is wrong

    Example:
        >>> import gearheat as gh
        >>> gh.verify_contact("contact", quick=True)  # doctest: +SKIP
    """
    place = folder(Path(out))
    found = run([*jobs(quick), *(cycles.jobs(cycle) if cycle else [])], place)
    rows = pages.rows(found)
    drawn = draw(found, rows)
    for title, text in drawn.items():
        write(place / FILES[title], text)
    write(place / "verification.md", pages.markdown(rows, {title: FILES[title] for title in drawn}))
    write(place / "verification.html", pages.html(rows, drawn))
    write(place / "verification.csv", pages.as_csv(rows))
    shown = pages.SUMMARY, pages.summary(rows)
    return ContactVerification(
        {"schema": "gearheat.ehl/1", "rows": rows}, heading="The contact solver, verified", shown=shown
    )


def jobs(quick: bool) -> list[Job]:
    """All pieces of work, or of the quick subset on coarse grids."""
    parts = (*steady.jobs(quick), *lines.jobs(quick), *studies.jobs(quick), *studies.dent_jobs(quick))
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
        bands = {"ratio": cycles.LAMBDA_BAND, "share": cycles.SHARE_BAND}
        drawn["Mesh cycle"] = figures.cycle(next(iter(by_item["Mesh cycle"].values())), bands)
    return drawn
