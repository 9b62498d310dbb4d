"""Sheet of a rig of one's own: from a name plate to a rig file, and the rule of every assumed value."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import gearheat as gh
from nicegui import ui

from .bench import Bench, digits, table

#: The name plate: option -> what it is, what stands there at first.
PLATE = {
    "stages": ("Stages from the input", "helical,helical"),
    "ratio": ("Ratio", "12.56"),
    "power": ("Power at the input", "7.5 kW"),
    "speed": ("Speed of the input", "1450 rpm"),
    "oil": ("Oil", "ISO VG 220 mineral"),
}
#: What a data sheet may say besides.
SHEET = {
    "centre_distance": "Centre distance of the last stage, 160 mm",
    "housing": "Housing, 800x370x430 mm",
    "oil_volume": "Oil in it, 20 l",
}
#: Columns of the assumed values: key of a line -> what it is.
HEADS = {"name": "name", "value": "value", "unit": "unit", "doc": "what it is", "source": "rule"}
#: Beginning of the source of a value that nobody gave.
ASSUMED = "assumed"


def new_sheet(bench: Bench) -> None:
    """A rig from its name plate, and what was assumed of it."""
    with ui.row().classes("items-end"):
        name = ui.input("Name", value="mine")
        plate = {key: ui.input(label, value=value) for key, (label, value) in PLATE.items()}
        sheet = {key: ui.input(label).classes("w-80") for key, label in SHEET.items()}
        fan, cooler = ui.checkbox("fan"), ui.checkbox("cooler")
        make = ui.button("Make")
    place = ui.column().classes("w-full")

    async def made() -> None:
        path = bench.folder / f"{name.value}.toml"
        texts = {key: str(field.value) for key, field in (plate | sheet).items() if field.value}
        chosen: dict[str, Any] = {"fan": bool(fan.value), "cooler": bool(cooler.value)}

        def job() -> tuple[gh.NewRig, gh.Description]:
            try:
                known: dict[str, Any] = {**texts, "ratio": float(texts.get("ratio", ""))}
            except ValueError:
                raise gh.GearheatError(f"--ratio {texts.get('ratio', '')!r} is no number.") from None
            return gh.new(str(name.value), **known, **chosen, out=path), gh.show(path)

        found = await bench.work(place, job)
        if found is None:
            return
        options = [word for key, text in texts.items() for word in (f"--{key.replace('_', '-')}", text)]
        bench.say("new", str(name.value), *options, *(f"--{key}" for key, on in chosen.items() if on), "-o", str(path))
        with place:
            _answer(bench, path, *found)

    make.on_click(made)


def _answer(bench: Bench, path: Path, rig: gh.NewRig, about: gh.Description) -> None:
    """What it does at the name plate, its drawing, and what was assumed."""
    sizes = rig.sizes
    ui.label(
        f"{sizes['file']}: i = {sizes['ratio']:.5g}, oil {sizes['oil_degC']:.1f} degC, loss {sizes['loss_W']:.0f} W,"
        f" efficiency {100 * sizes['efficiency']:.2f} %, {sizes['assumed']} values assumed"
    ).classes("text-lg")
    for note in rig.notes:
        ui.label(note)
    drawing = path.with_suffix(".svg")
    if about.save_picture(drawing):
        ui.image(bench.link(drawing)).classes("drawing w-full max-w-3xl")
    _assumed(bench, ui.column().classes("w-full"), path, about)


def _assumed(bench: Bench, place: Any, path: Path, about: gh.Description) -> None:
    """Assumed values, those that matter most first, and a line that puts another one in place of one."""
    effects = about.effects()
    leading = [row[0] for row in effects[2]] if effects else []
    lines = {line["name"]: line for line in about.found["parameters"] if line["source"].startswith(ASSUMED)}
    order = sorted(lines, key=lambda name: leading.index(name) if name in leading else len(leading))
    rows = [[{**lines[name], **(lines[name]["written"] or {})}[key] for key in HEADS] for name in order]
    texts = {name: f"{digits(value)} {unit or ''}".strip() for name, value, unit, *_ in rows}
    with place:
        with ui.row().classes("items-end change"):
            name = ui.select(list(texts), label="Change", with_input=True).classes("w-64")
            value, source = ui.input("to"), ui.input("source, such as a drawing").classes("w-80 source")
            name.on_value_change(lambda event: value.set_value(texts.get(event.value, "")))
            name.set_value(next(iter(texts), None))
            write = ui.button("Write")
        table("Assumed values, those that matter most first", list(HEADS.values()), rows).classes("assumed")
        below = ui.column()

    async def written() -> None:
        text, why = {str(name.value): str(value.value)}, str(source.value).strip()

        def job() -> gh.Description:
            if not why:
                raise gh.GearheatError("a value has a source. Say where it is from.")
            gh.load(path).with_(text, source=why).save(path)
            return gh.show(path)

        if (changed := await bench.work(below, job)) is not None:
            bench.say_line(f"gearheat.load({str(path)!r}).with_({text!r}, source={why!r}).save({str(path)!r})")
            place.clear()
            _assumed(bench, place, path, changed)

    write.on_click(written)
