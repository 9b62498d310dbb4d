"""Sheets of rigs that are there: the operating point by sliders, list, comparison, export."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import gearheat as gh
from nicegui import ui

from .bench import Bench, table

#: How often the setting of the sliders is read [s].
LOOK = 1.0


def map_sheet(bench: Bench) -> None:
    """The page that computes of a rig: sliders, limit line, heat flows, map; the desk reads its setting."""
    units: dict[str, str] = {}
    seen = {"rig": "", "hash": ""}
    with ui.row().classes("items-center"):
        rig = bench.pick_rig()
        limit = ui.input("Limit of the oil", value="95 degC")
        button = ui.button("Show")
    place = ui.column().classes("w-full")

    async def show() -> None:
        chosen, kept = str(rig.value), str(limit.value)
        made = await bench.work(place, lambda: gh.page(chosen, limit=kept))
        if made is None:
            return
        path = made.save(bench.folder / f"{Path(chosen).stem}.html")
        bench.say("page", chosen, "-o", str(path), "--limit", kept)
        units.clear()
        units.update((str(name), str(unit)) for name, unit in made.table()[1])
        seen.update(rig=chosen, hash="")
        with place:
            ui.element("iframe").props(f'src="{bench.link(path)}" id="map" title="{chosen}"')

    async def look() -> None:
        if not seen["rig"]:
            return
        there = await ui.run_javascript('document.getElementById("map")?.contentWindow.location.hash ?? ""')
        if there and there != seen["hash"]:
            seen["hash"] = there
            bench.say("steady", seen["rig"], *_settings(there, units))

    button.on_click(show)
    ui.timer(LOOK, look)


def _settings(link: str, units: dict[str, str]) -> list[str]:
    """Options of the command for the setting in a link of a page."""
    pairs = [unquote(part).split("=") for part in link.lstrip("#").split("&") if "=" in part and part[0] != "~"]
    texts = [f"{name}={value} {units[name]}".strip() for name, value in pairs if name in units]
    return [word for text in texts for word in ("--set", text)]


def rigs_sheet(bench: Bench) -> None:
    """List, comparison of two at their operating points, and export."""
    with ui.row().classes("items-center"):
        first, second = bench.pick_rig("Rig"), bench.pick_rig("Compare with", "helical_two_stage")
        compare = ui.button("Compare")
        fmu, page = ui.button("Export as FMU"), ui.button("Export as page")
    place = ui.column().classes("w-full")
    table(gh.shipped().title, *gh.shipped().table())

    async def beside() -> None:
        names = [str(first.value), str(second.value)]
        states = await bench.work(place, lambda: [gh.steady(name) for name in names])
        if states is None:
            return
        for name in names:
            bench.say("steady", name)
        with place:
            table("Steady states at the operating points", *_beside(names, states))

    def writes(command: str, ending: str, job: Callable[[str, Path], object]) -> Callable[[], Awaitable[None]]:
        async def made() -> None:
            name = str(first.value)
            path = bench.folder / f"{Path(name).stem}{ending}"
            if await bench.work(place, lambda: job(name, path)) is not None:
                bench.say(command, name, "-o", str(path))
                with place:
                    ui.link(str(path), bench.link(path), new_tab=True).classes("made")

        return made

    compare.on_click(beside)
    fmu.on_click(writes("export", ".fmu", gh.export))
    page.on_click(writes("page", ".html", lambda name, path: gh.page(name).save(path)))


def _beside(names: list[str], states: list[gh.SteadyState]) -> tuple[list[str], list[list[Any]]]:
    """Quantities of two steady states beside each other, each where its rig has it."""
    values = [{row[0]: row for row in state.rows(state.first)} for state in states]
    every = dict.fromkeys(name for own in values for name in own)
    rows: list[list[Any]] = [[name, *(own[name][1] if name in own else "" for own in values)] for name in every]
    told = {name: own[name] for own in reversed(values) for name in own}
    return ["name", *names, "unit", "meaning"], [[*row, *told[row[0]][2:]] for row in rows]
