"""Rigs, catalogues and part types: what there is, and a rig of your own."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import partial
from itertools import groupby
from pathlib import Path
from typing import Any

import gearheat as gh

from ..show import console
from ..show.endings import fitting
from ..show.notes import PLURAL, print_outside, print_stacked, print_unchecked


def new(
    name: str,
    stages: str,
    ratio: float,
    power: str,
    speed: str,
    oil: str = "ISO VG 220 mineral",
    bearings: str = "auto",
    fan: bool = False,
    cooler: bool = False,
    base: str | None = None,
    motor_heat: str | None = None,
    air_speed: str | None = None,
    centre_distance: str | None = None,
    housing: str | None = None,
    oil_volume: str | None = None,
    out: Path | None = None,
    json: str | None = None,
) -> None:
    """A rig of your own from a name plate: it runs at once, and tells the rule of every number."""
    path = out or Path(f"{name}.toml")
    chosen: dict[str, Any] = {"oil": oil, "bearings": bearings, "fan": fan, "cooler": cooler, "base": base}
    plate: dict[str, Any] = {"stages": stages, "ratio": ratio, "power": power, "speed": speed}
    sizes: dict[str, Any] = {"centre_distance": centre_distance, "housing": housing, "oil_volume": oil_volume}
    rig = gh.new(name, **plate, **chosen, **sizes, motor_heat=motor_heat, air_speed=air_speed, out=path)
    console.answer(rig.sizes, json, lambda: _print_new(rig.sizes))
    for note in rig.notes:
        console.note(note)


def list_(json: str | None = None) -> None:
    """The shipped rigs and catalogues."""
    held = gh.shipped()
    console.answer(held.as_dict(), json, lambda: _print_shipped(held))


def show(
    rig: str,
    errata: bool = False,
    everything: bool = False,
    plot: Path | None = None,
    json: str | None = None,
) -> None:
    """What a rig is made of, how it is driven, and which parameters matter most; --all for everything."""
    console.plottable(plot)
    about = gh.show(rig)
    if plot is not None:
        about.save_picture(plot)
        console.note(f"wrote {plot}")
    human = _print_errata if errata else partial(_print_rig, everything=everything)
    console.answer(about.as_dict(), json, lambda: human(about))


def parts(
    kind: str | None = None,
    json: str | None = None,
) -> None:
    """What a rig can be built of: part types, and all about one with an example."""
    types = gh.parts(kind)
    console.answer(types.as_dict(), json, lambda: _print_types(types) if kind is None else _print_type(types.found))


def schema(
    out: Path | None = None,
    json: str | None = None,
) -> None:
    """JSON schema of rig files: editors complete and check them with it."""
    fitting(out, "a schema")
    found = gh.schema()
    if out is None:
        console.answer(found, json or "-", lambda: None)
        return
    console.write(out, console.as_json(found))
    console.answer(found, json, lambda: _print_schema(out))


def _print_schema(out: Path) -> None:
    console.say(f'{out}: put "#:schema {out.name}" into the first line of a rig file beside it')


def _print_new(found: Mapping[str, Any]) -> None:
    print(f"{found['file']}: i = {found['ratio']:.5g}, {found['assumed']} values assumed, each with its rule")
    for k, s in enumerate(found["stages"], start=1):
        known = list(s)[-1]  # the size by which such a stage is known
        print(f"  stage {k}: {s['kind']} {s['z_1']}/{s['z_2']}", end=", ")
        print(f"module {1e3 * s['m_n']:.4g} mm, {known} {1e3 * s[known]:g} mm")
    print(f"  at the name plate: oil {found['oil_degC']:.1f} degC, loss {found['loss_W']:.0f} W,", end=" ")
    by = "flange" if found["base"] == "flange" else "foot"
    print(f"efficiency {100 * found['efficiency']:.2f} %, {100 * found['foot_share']:.0f} % of the heat by the {by}")
    losses = ", ".join(f"{PLURAL.get(kind, kind)} {P:.3g} W" for kind, P in found["losses_W"].items())
    print(f"  loss: {losses}")
    (low, high), (cold, warm), (least, most) = found["usual"].values()
    idle = 100 * found["no_load_W"] / found["loss_W"]
    print(f"  without load: {found['no_load_W']:.3g} W, {idle:.0f} % of the loss, usual {least:g} to {most:g} %")
    print(f"  usual of such units: efficiency {low:g} to {high:g} %, oil {cold:g} to {warm:g} degC")
    print(f"Next: put your numbers into the file, then `gearheat steady {found['file']}`.")


def _print_shipped(held: gh.Shipped) -> None:
    console.table(held.title, *held.table())
    for kind, entries in held.catalogues.items():
        rows = []
        alike_by = groupby(entries.items(), key=lambda e: (e[1].doc, e[1].checked, e[1].series))
        for (doc, checked, series), alike in alike_by:
            names = [name for name, _ in alike]
            if series:
                names = [f"{names[0]} ... {names[-1]} ({len(names)} sizes)"]
            rows += [(name, doc, checked) for name in names]
        console.table(f"Catalogue: {kind}", ("name", "what it is", "checked"), rows)


def _print_rig(about: gh.Description, everything: bool) -> None:
    """Print the rig: in short, or everything."""
    found = about.found
    console.say(f"{found['rig']}: {found['doc']}\n")
    if found["reproduces"]:
        console.say(f"Reproduces: {found['reproduces']}\n")
    if everything:
        _print_everything(found)
    else:
        _print_overview(about)
    print_outside(found["outside"])
    for problem in found["no_steady_state"]:
        console.say(f"no steady state at the operating point: {problem}")
    print_unchecked(found["unchecked"])
    if found["errata"]:
        console.say(f"{len(found['errata'])} corrections to the sources: gearheat show {found['rig']} --errata")


def _print_overview(about: gh.Description) -> None:
    """Print parts by type, inputs, states, main outputs and the parameters with the largest effect."""
    found, by_type = about.found, dict[str, list[str]]()
    for part in found["parts"]:
        by_type.setdefault(part["type"], []).append(part["name"])
    lines = [[kind, str(len(names)), ", ".join(names)] for kind, names in by_type.items()]
    console.table("Parts", ("type", "number", "names"), lines)
    head = ("name", "value", "unit", "doc", "source")
    given = [line for line in found["inputs"] if line["source"] != "default"]
    print_stacked("Inputs", head, [[line[key] for key in head] for line in given], 2)
    if others := [line["name"] for line in found["inputs"] if line not in given]:
        console.say(f"Inputs left at their defaults: {', '.join(others)}")
    console.say(f"States: {', '.join(line['name'] for line in found['states']) or 'none'}")
    named = about.main_outputs
    more = len(found["outputs"]) - len(named)
    console.say(f"Outputs: {', '.join([*named, f'{more} more'])}")
    if found["sensors"]:
        console.say(f"Sensors: {', '.join(found['sensors'])}")
    print()
    if (effects := about.effects()) is not None:
        print_stacked(*effects, 2)
    counts = [f"{len(found[key])} {key}" for key in ("parameters", "choices", "outputs", "laws")]
    console.say(f"{', '.join(counts)} with --all")


def _print_everything(found: Mapping[str, Any]) -> None:
    valued = ("name", "value", "unit", "doc")
    print_stacked("Parts", ("name", "type", "doc"), _rows(found["parts"], ("name", "type", "doc")), 1)
    known = ("name", "value", "kind", "uncertainty", "unit", "doc", "source")
    print_stacked("Parameters", known, _rows([{**p, **(p["written"] or {})} for p in found["parameters"]], known), 2)
    print_stacked("Choices", ("name", "value", "doc"), _rows(found["choices"], ("name", "value", "doc")), 1)
    print_stacked("Inputs", (*valued, "source"), _rows(found["inputs"], (*valued, "source")), 2)
    print_stacked("States (with start value)", valued, _rows(found["states"], valued), 1)
    print_stacked("Outputs", ("name", "unit", "doc"), _rows(found["outputs"], ("name", "unit", "doc")), 1)
    keys = ("law", "verified", "where", "valid", "source")
    print_stacked("Laws", keys, _rows(found["laws"], keys), 3)


def _print_errata(about: gh.Description) -> None:
    found = about.found
    if not found["errata"]:
        console.say(f"{found['rig']}: no corrections to its sources are known.")
        return
    rows = _rows(found["errata"], ("place", "says", "should_be", "evidence"))
    console.table(f"{found['rig']}: corrections to the sources", ("place", "says", "should be", "evidence"), rows)


def _rows(lines: Iterable[dict[str, Any]], keys: tuple[str, ...]) -> list[list[Any]]:
    return [[line[key] for key in keys] for line in lines]


def _print_types(types: gh.PartTypes) -> None:
    console.table(types.title, *types.table())
    console.say("gearheat parts TYPE tells all of one of them, with an example to copy.")


def _print_type(found: Mapping[str, Any]) -> None:
    console.say(f"{found['type']}: {found['doc']}\n")
    titles = {
        "ports": ("name", "type", "carries", "doc"),
        "parameters": ("name", "unit", "range", "default", "doc"),
        "choices": ("name", "options", "default", "doc"),
        "inputs": ("name", "unit", "range", "doc"),
        "states": ("name", "unit", "range", "doc"),
        "outputs": ("name", "unit", "doc"),
        "laws": ("law", "where", "valid", "source"),
    }
    for title, keys in titles.items():
        if lines := found[title]:
            console.table(title.capitalize(), keys, [[_cell(line[key]) for key in keys] for line in lines])
    if spread := found["spread"]:
        console.table("What laws give at the same sizes", tuple(spread[0]), [list(line.values()) for line in spread])
    console.say(f"Equations: {'; '.join(found['equations'])}\n")
    if found["entries"]:
        console.say(f"Catalogues that may give values: {', '.join(found['entries'])} (gearheat list)\n")
    origin = f"values of the rig {found['example_from']}" if found["example_from"] else "typical sizes"
    print(f"Example ({origin}):\n\n{found['example']}")


def _cell(value: Any) -> str:
    return ", ".join(value) if isinstance(value, list) else str(value)
