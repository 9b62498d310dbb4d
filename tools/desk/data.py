"""Sheet of measured tables: what each column is, the card of that, diagnosis, report, measured against simulated."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import gearheat as gh
from nicegui import events, ui

from .bench import Bench, tell

#: What a column is that nothing reads.
UNUSED = "not used"
#: How often progress is shown [s].
TICK = 0.3
#: Endings of tables.
KINDS = ".csv,.txt"


@dataclass
class Table:
    """A table that was dropped into the folder, whose it is, and what was clicked of it."""

    path: Path
    rig: str
    columns: dict[str, str] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    magnitudes: dict[str, bool] = field(default_factory=dict)

    def card(self) -> gh.CardText:
        """The card with what was clicked, the rest guessed."""
        return gh.card(self.rig, self.path, columns=self.columns, units=self.units, magnitudes=self.magnitudes)

    def options(self) -> list[str]:
        """What was clicked, as options of the command."""
        signs = {name: "yes" if held else "no" for name, held in self.magnitudes.items()}
        pairs = {"--column": self.columns, "--unit": self.units, "--magnitude": signs}
        return [word for option, said in pairs.items() for k, v in said.items() for word in (option, f"{k}={v}")]

    def beside(self, ending: str) -> Path:
        """A file of the folder that is named as the table."""
        return self.path.with_name(f"{self.path.stem}{ending}")


def data_sheet(bench: Bench) -> None:
    """From a table to a diagnosis."""
    with ui.row().classes("items-center"):
        rig = bench.pick_rig(value="helical_two_stage")
        drop = ui.upload(label="Drop a table (CSV)", auto_upload=True).props(f'accept="{KINDS}" id="drop"')
    place = ui.column().classes("w-full")

    async def dropped(event: events.UploadEventArguments) -> None:
        path = bench.folder / Path(event.file.name).name
        path.write_bytes(await event.file.read())
        drop.reset()
        await look(Table(path, str(rig.value)))

    async def look(table: Table) -> None:
        found = await bench.work(place, table.card)
        if found is None:
            return
        with place:
            _columns(table, found, look)
            tell(found.problems)
            with ui.expansion("The card as TOML").classes("w-full"):
                ui.code(found.as_toml(), language="toml").classes("w-full")
            with ui.row().classes("items-center"):
                quick = ui.checkbox("quick: without readings left out and next experiments", value=True)
                start = ui.button("Diagnose").props("disable" if found.problems else "")
            below = ui.column().classes("w-full")
        start.on_click(lambda: _diagnose(bench, below, table, found, bool(quick.value)))

    drop.on_upload(dropped)


def _columns(table: Table, found: gh.CardText, look: Any) -> None:
    """A line a column: what it is, its unit, whether it holds magnitudes, its first cells; a click looks again."""
    header, *rows = found.cells
    card = found.as_dict()
    names = {path if path in found.columns else name: name for name, path in found.reads.items()}
    meant = {column: name for name, column in found.columns.items()}
    sensors = {sensor["reads"]: name for name, sensor in card["sensors"].items()}
    options = {UNUSED: UNUSED} | {name: f"{names.get(name, name)}: {what}" for name, what in found.reads.items()}

    async def means(column: str, name: str) -> None:
        table.columns |= {meant[column]: ""} if column in meant else {}
        table.columns |= {} if name == UNUSED else {name: column}
        await look(table)

    async def said(place: dict[str, Any], name: str, value: Any) -> None:
        place[name] = value
        await look(table)

    with ui.grid(columns="auto auto auto auto 1fr").classes("items-center w-full overflow-x-auto gap-x-4 gap-y-0"):
        for title in ("column", "is", "unit", "signs", "first rows"):
            ui.label(title).classes("text-bold")
        for k, column in enumerate(header):
            name = meant.get(column, UNUSED)
            ui.label(column)
            pick = ui.select(options, value=name, with_input=True).props("dense").classes("w-64")
            pick.on_value_change(lambda event, column=column: means(column, str(event.value)))
            unit = ui.input(value=card["units"].get(column, "")).props("dense").classes("w-20")
            unit.on("change", lambda event, column=column: said(table.units, column, str(event.args)))
            sensor = sensors.get(found.reads.get(name, ""), "")
            if sensor and card["units"].get(column) != "degC":
                held = ui.checkbox("magnitudes", value=bool(card["sensors"][sensor]["magnitude"])).props("dense")
                held.on_value_change(lambda event, sensor=sensor: said(table.magnitudes, sensor, bool(event.value)))
            else:
                ui.label("")
            ui.label("   ".join(row[k] for row in rows)).classes("font-mono whitespace-pre")


async def _diagnose(bench: Bench, place: Any, table: Table, found: gh.CardText, quick: bool) -> None:
    """Write the card, diagnose beside the page, and show the report and what is behind it."""
    card, report, extended = (table.beside(end) for end in (".card.toml", ".report.html", ".found.toml"))
    stage: dict[str, Any] = {"name": "reading", "share": 0.0, "stop": False}

    def tell(name: str, share: float) -> None:
        if stage["stop"]:
            raise gh.GearheatError("stopped.")
        stage.update(name=name, share=share)

    def job() -> gh.Diagnosis:
        found.save(card)
        outputs = gh.Outputs(report=report, extended=extended)
        made = gh.diagnose(table.path, table.rig, card=card, quick=quick, outputs=outputs, progress=tell)
        made.write(outputs)
        return made

    bench.say("card", table.rig, "--data", str(table.path), *table.options(), "-o", str(card))
    files = ["--report", str(report), "--extended", str(extended)]
    words = ["diagnose", str(table.path), "--rig", table.rig, "--card", str(card), *files]
    bench.say(*words, *(["--quick"] if quick else []))
    place.clear()
    with place:
        bar, inner = ui.row().classes("items-center"), ui.column().classes("w-full")
    with bar:
        shown = ui.label("")
        progress = ui.circular_progress(0.0, min=0.0, max=1.0, show_value=False)
        ui.button("Stop", on_click=lambda: stage.update(stop=True))
        ui.timer(TICK, lambda: (shown.set_text(str(stage["name"])), progress.set_value(float(stage["share"]))))
    made = await bench.work(inner, job)
    bar.delete()
    if made is None:
        return
    with inner:
        ui.label(made.title).classes("verdict text-lg")
        with ui.row(wrap=False).classes("w-full"):
            ui.element("iframe").props(f'src="{bench.link(report)}" id="report" title="report"')
            _against(made)


def _against(made: gh.Diagnosis) -> None:
    """Measured over simulated, sensor by sensor; a point tells its row."""
    rows = made.rows
    names = list(rows.channels)
    if not names:
        return

    def shown(name: str) -> dict[str, Any]:
        values, known = rows.channels[name], made.channel(name)
        unit = known.unit if known else ""
        models = {"as calibrated": values.nominal, "with what was found": values.extended or ()}
        points = {
            word: [[s, m, r] for s, m, r in zip(model, values.measured, rows.row, strict=False) if m is not None]
            for word, model in models.items()
        }
        tip = "p => `row ${p.data[2]}<br>simulated ${p.data[0].toPrecision(5)}<br>measured ${p.data[1].toPrecision(5)}`"
        return {
            "legend": {},
            "tooltip": {":formatter": tip},
            "xAxis": {"scale": True, "name": f"simulated [{unit}]", "nameLocation": "middle", "nameGap": 30},
            "yAxis": {"scale": True, "name": f"measured [{unit}]"},
            "series": [{"name": word, "type": "scatter", "data": data} for word, data in points.items() if data],
        }

    def draw() -> None:
        chart.options.clear()
        chart.options.update(shown(str(pick.value)))
        chart.update()

    with ui.column().classes("w-96"):
        pick = ui.select(names, value=names[0], label="Measured against simulated", on_change=draw).classes("w-full")
        chart = ui.echart(shown(names[0])).classes("h-96")
