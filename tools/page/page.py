"""A rig as one HTML file that computes: its model as WebAssembly, with fields for what matters most."""

from __future__ import annotations

import base64
import gzip
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np
from markupsafe import Markup

from ...fmu.web import module, with_checks
from ...model.core.connect import nets
from ...model.core.flat import FlatModel, Quantity
from ...model.errors import DataError, Problems, ScenarioError, suggestion
from ...model.units import show_unit, to_si
from ...scenarios.csv_cells import numbers
from ...scenarios.csv_table import in_si, read_cells, scale, split_unit
from ...scenarios.given import RigLike, Settings, scenario_of
from ...scenarios.scenario import Scenario
from ..describe.description import show
from ..show.display import Answer
from ..show.pages import as_data, load_plot_library, page as render
from ..solve.maps import driving
from ..solve.settings import adjust, flat_of
from ..solve.steady import first_of, leading_outputs, loss_names

#: Parameters with a field, besides those that are asked for.
FIELDS = 8
#: A page larger than this is refused: mail and browsers would be slow with it [bytes].
LARGEST = 4_000_000
#: What a report says of the page.
LIVE = "The machine computes: sliders, heat flows, warm-up and map"
#: Ends of a slider as shares of a value [1].
SHARES = (0.5, 2.0)
#: Of a speed or a torque at a shaft end [1].
SHAFT_SHARES = (0.1, 1.5)
#: Ends of a slider about a temperature [K].
KELVINS = 30.0


@dataclass(frozen=True, eq=False, repr=False)
class Page(Answer):
    """A page of a rig.

    Attributes:
        html: the whole page
    """

    html: str = ""

    def save(self, path: str | Path, *, report: str | Path | None = None) -> Path:
        """Write the page.

        Args:
            path: .html
            report: HTML file of a report, which gets a link to the page

        Raises:
            DataError: it cannot be written
        """
        from ..show.console import write

        write(Path(path), self.html)
        if report is not None:
            text = Path(report).read_text(encoding="utf-8")
            place = quote(os.path.relpath(path, Path(report).parent).replace(os.sep, "/"))
            write(Path(report), text.replace("<body>", f'<body>\n<p><a href="{place}">{LIVE}</a></p>', 1))
        return Path(path)


def page(
    rig: RigLike,
    *,
    set: Settings = (),
    more: Sequence[str] = (),
    limit: str = "95 degC",
    data: str | Path | None = None,
    extended: Sequence[str | Path] = (),
) -> Page:
    """The machine in one self-contained HTML file, which computes steady states, warm-ups and maps in the browser.

    Args:
        rig: name, file or rig
        set: values by name: texts with units, quantities of pint, or numbers in SI
        more: parameters that get a field, besides those that matter most
        limit: temperature that the oil is to keep
        data: CSV of measured points, columns named as the model's quantities with units, "time [min]" of a warm-up
        extended: rig files of other states of the machine to switch to, such as those that `diagnose` writes

    Raises:
        GearheatError: all that is wrong with what is asked; the compiler fails; the page becomes too large

    Example:
        >>> import gearheat as gh
        >>> gh.page("planetary").save("planetary.html")  # doctest: +SKIP
    """
    scenarios = {"as given": adjust(scenario_of(rig), set)}
    scenarios |= {Path(file).stem: adjust(scenario_of(file), set) for file in extended}
    first = scenarios["as given"]
    measured = None if data is None else _measured(Path(data), flat_of(first))
    modules: dict[bytes, int] = {}
    machines = [_machine(label, scenario, more, modules) for label, scenario in scenarios.items()]
    shown = {
        "rig": first.name,
        "limit": to_si(limit, "K", name="--limit"),
        "machines": machines,
        "modules": [base64.b64encode(gzip.compress(one, 9, mtime=0)).decode() for one in modules],
        "measured": measured,
    }
    html = render(
        __package__,
        "page.html",
        title=first.name,
        doc=first.doc,
        data=as_data(shown),
        code=_text("page.js"),
        plots=load_plot_library(),
    )
    size = len(html.encode())
    if size > LARGEST:
        raise DataError(_too_large(shown, size))
    found = {
        "schema": "gearheat.page/1",
        "rig": first.name,
        "out": None,
        "bytes": size,
        "module_bytes": [len(one) for one in modules],
        "machines": list(scenarios),
        "fields": [field["name"] for field in machines[0]["fields"]],
        "measured_rows": len(measured["rows"]) if measured else 0,
    }
    rows = ("field", "unit"), [(field["name"], field["unit"]) for field in machines[0]["fields"]]
    return Page(found, html, heading=f"{first.name}: page of {size / 1000:.0f} kB", shown=rows)


def _too_large(shown: Mapping[str, Any], size: int) -> str:
    """What makes a page too large, and what can be left out."""
    parameters, held = len(shown["machines"][0]["parameters"]), sum(map(len, shown["modules"]))
    return (
        f"{shown['rig']}: a page has {size / 1e6:.2g} MB, mail and browsers bear {LARGEST / 1e6:.2g} MB at most."
        f" {held / 1e6:.2g} MB are the model with its {parameters} parameters, for each machine anew. Leave out some of"
        " --extended or --data; of a rig as large as that gearheat export writes an FMU."
    )


def _text(name: str) -> Markup:
    return Markup(files(__package__).joinpath("templates", name).read_text(encoding="utf-8"))


def _machine(label: str, scenario: Scenario, more: Sequence[str], modules: dict[bytes, int]) -> dict[str, Any]:
    """What the page knows of a machine; its module joins those that are there."""
    described = show(scenario)
    own = described.flat
    fields = _fields(scenario, own, _leading_parameters(described.effects(), own, more))
    compiled = module(with_checks(own))
    outputs = [q.name for q in own.outputs]
    leading = [name for name in leading_outputs(scenario) if name in own.index]
    values = [*(q.name for q in own.states), *outputs]
    rooms = [f"{room}.T" for room in scenario.spec.of_type("Room") if f"{room}.T" in own.index]
    return {
        "label": label,
        "module": modules.setdefault(compiled, len(modules)),
        "states": [_quantity(scenario, q) for q in own.states],
        "inputs": [_quantity(scenario, q) for q in own.inputs],
        "parameters": [_quantity(scenario, q) for q in own.parameters],
        "outputs": [_quantity(scenario, q) for q in own.outputs],
        "checks": [[f"{c.component}: {c.argument} of {c.law.name}", _end(c.low), _end(c.high)] for c in own.checks],
        "relations": [f"{r.component}: {r.name}. {r.remedy}" for r in own.relations],
        "fields": fields,
        "shown": leading + [name for name in first_of(scenario, own, values) if name not in leading],
        "leading": leading,
        "losses": loss_names(scenario, outputs),
        "heat": _ways_out(scenario, set(outputs)),
        "room": rooms[0] if rooms else None,
        "axes": _axes(scenario),
    }


def _axes(scenario: Scenario) -> list[str]:
    """Speed and torque of the map, none where they are not both given."""
    try:
        return list(driving(scenario))
    except ScenarioError:
        return []


def _end(value: float) -> float | None:
    """An end of a range as JSON has it, None for one that is open."""
    return float(value) if np.isfinite(value) else None


def _quantity(scenario: Scenario, q: Quantity) -> dict[str, Any]:
    """A quantity in SI, with the unit that is shown: SI = shown * factor + offset."""
    unit = scenario.units.get(q.name) or show_unit(q.unit)
    factor, offset = scale(unit, q.unit, name=q.name)
    return {
        "name": q.name,
        "doc": q.doc,
        "unit": "" if unit == "1" else unit,
        "factor": factor,
        "offset": offset,
        "start": float(q.start),
        "nominal": float(q.nominal),
        "low": _end(q.low),
        "high": _end(q.high),
        "open": [q.low_open, q.high_open],
        "whole": q.whole,
    }


def _leading_parameters(effects: Any, flat: FlatModel, more: Iterable[str]) -> list[str]:
    """Parameters that get a field: those asked for, then those that matter most.

    Raises:
        ScenarioError: what is asked for is no parameter
    """
    known = [q.name for q in flat.parameters]
    asked = list(dict.fromkeys(more))
    text = f"--with: {flat.name} has no parameter "
    Problems(f'{text}"{name}".{suggestion(name, known)}' for name in asked if name not in known).check()
    ranked = [row[0] for row in effects[2]] if effects else []
    return asked + [name for name in ranked if name in known and name not in asked][:FIELDS]


def _fields(scenario: Scenario, flat: FlatModel, parameters: Sequence[str]) -> list[dict[str, Any]]:
    """Fields with the ends of their sliders in SI: the inputs that the rig gives first, the other inputs last."""
    given = [q for q in flat.inputs if q.name in scenario.operating_point]
    rest = [q for q in flat.inputs if q.name not in scenario.operating_point]
    named = [flat.quantity(name) for name in parameters]
    groups = (("operating point", given), ("parameters that matter most", named), ("other inputs", rest))
    shafts = scenario.shaft_paths()
    return [
        {"name": q.name, "group": group, "unit": _quantity(scenario, q)["unit"], "ends": _ends(q, q.name in shafts)}
        for group, own in groups
        for q in own
    ]


def _ends(q: Quantity, shaft: bool) -> list[float]:
    """Ends of a slider, within the range of the quantity."""
    if q.unit == "K":
        low, high = q.start - KELVINS, q.start + KELVINS
    elif q.start == 0:
        low, high = (0.0, q.nominal) if q.low >= 0 else (-q.nominal, q.nominal)
    else:
        low, high = sorted(share * q.start for share in (SHAFT_SHARES if shaft else SHARES))
    return [float(max(low, q.low)), float(min(high, q.high))]


def _ways_out(scenario: Scenario, outputs: set[str]) -> list[str]:
    """Outputs that are the heat to the rooms, each way and kind by itself."""
    rooms = scenario.spec.of_type("Room")
    found: list[str] = []
    for net in nets(scenario.spec.assembly()):
        owners = [port.name.rpartition(".")[0] for port in net]
        if not any(owner in rooms for owner in owners):
            continue
        for owner in owners:
            kinds = sorted(name for name in outputs if name.startswith(f"{owner}.Q_flow_"))
            whole = [f"{owner}.Q_flow"] if f"{owner}.Q_flow" in outputs and owner not in rooms else []
            found += [name for name in kinds or whole if name not in found]
    return found


def _measured(path: Path, flat: FlatModel) -> dict[str, Any]:
    """Measured points in SI: names of the columns, and rows with None where nothing was read.

    Raises:
        DataError: a column that the model does not have, a unit that does not fit, a cell that is no number
    """
    header, rows = read_cells(path)
    units = {"time": "s"} | {q.name: q.unit for group in (flat.states, flat.inputs, flat.outputs) for q in group}
    columns, problems = {}, Problems()
    for place, head in enumerate(header):
        name, unit = split_unit(head)
        if name not in units:
            problems.append(f'{path.name}: the model has no "{name}".{suggestion(name, units)}')
            continue
        if (values := numbers([cells[place] for _, cells in rows])) is None:
            problems.append(f'{path.name}: a cell of "{head}" is no number.')
            continue
        with problems:
            columns[name] = in_si(values, unit, units[name], name=f"{path.name}: {head}")
    problems.check(DataError)
    points = zip(*columns.values(), strict=True)
    return {"names": list(columns), "rows": [[_end(value) for value in point] for point in points]}
