"""Campaigns of any rig with something wrong in it: simulated, read by noisy instruments and written as a user would.

The rig itself is uncertain: its parameters are drawn from what the bench's card says of them, days differ in cooling,
instruments have a tolerance each that is fixed over the campaign. None of it uses the diagnosis.
"""

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from functools import cache
from pathlib import Path

import numpy as np
from diagnose.hidden.benches import Bench, Test
from diagnose.hidden.effects import Columns, Effect
from gearheat.model.core.flat import FlatModel
from gearheat.model.core.flatten import flatten
from gearheat.model.machines.spec import assemble
from gearheat.model.run.result import Result
from gearheat.model.run.schedule import Schedule, stepped
from gearheat.model.run.simulate import simulate
from gearheat.model.run.steady import steady_table
from gearheat.scenarios.load import load

#: Rounds of the heat that depends on the temperatures it changes, and where they end [W].
ROUNDS, SETTLED = 25, 0.02
#: Correlation of what parts of one type lose over what their law says: its root.
COMMON = 0.8


@dataclass(frozen=True)
class Gross:
    """One reading that is wrong: row (from 0), sensor, and by how many repeat standard deviations."""

    row: int
    sensor: str
    by: float


@dataclass(frozen=True)
class Case:
    """A campaign in a folder, and what is wrong in it."""

    bench: Bench
    data: Path
    card: Path
    truth: Mapping[str, object]


@cache
def model(rig: str) -> FlatModel:
    """The flat model of a shipped rig."""
    return flatten(assemble(load(rig).spec))


def make(bench: Bench, effects: Sequence[Effect], seed: int, folder: Path, gross: Gross | None = None) -> Case:
    """Draw a campaign and write its table and its card.

    Args:
        bench: rig, instruments and points
        effects: what is wrong, none for a clean campaign
        seed: of all that is drawn
        folder: where to write
        gross: one reading that is wrong besides
    """
    rng = np.random.default_rng(seed)
    tests = bench.tests(rng)
    true = run(bench, tests, drawn_values(bench, len(tests), rng), effects)
    readings = read(bench, true, effects, rng)
    if gross is not None:
        readings[gross.sensor][gross.row] += gross.by * (g := bench.gauge(gross.sensor)).repeat_sd * g.scale
    folder.mkdir(parents=True, exist_ok=True)
    truth = {"causes": [e.cause for e in effects], "what": [e.what for e in effects], "seed": seed}
    case = Case(bench, folder / "data.csv", folder / "card.toml", truth | {"gross": gross and vars(gross)})
    write(case, tests, readings)
    return case


def drawn_values(bench: Bench, n: int, rng: np.random.Generator) -> list[dict[str, float]]:
    """Parameters of the true rig in each of n tests."""
    base = {q.name: q.start for q in model(bench.rig).parameters}
    spec, rig = load(bench.rig).spec, dict[str, float]()
    for key, sd in bench.prior_sd.items():
        kind, _, parameter = key.partition(".")
        paths = [path for part in spec.of_type(kind) if (path := f"{part}.{parameter}") in base]
        common = COMMON if len(paths) > 1 and parameter.startswith("k_") else 0.0  # one law that is off for all
        z = common * rng.standard_normal() + np.sqrt(1 - common**2) * rng.standard_normal(len(paths))
        rig |= {path: base[path] * float(np.exp(sd * deviation)) for path, deviation in zip(paths, z, strict=True)}
    rig = {path: min(v, 0.99) if path.endswith(".emissivity") else v for path, v in rig.items()}
    days = np.exp(bench.day_sd * rng.standard_normal(n))
    return [rig | {path: rig.get(path, base[path]) * float(day) for path in bench.day} for day in days]


def run(
    bench: Bench, tests: Sequence[Test], values: Sequence[Mapping[str, float]], effects: Sequence[Effect]
) -> dict[str, np.ndarray]:
    """What is true at the end of each point, by path (n rows), with "order", "direction" and "P_extra" [W].

    Args:
        bench: the rig and its protocol
        tests: the tests
        values: parameters of each test by path
        effects: what is wrong
    """
    flat = model(bench.rig)
    changed = [_changed(flat, v, effects) for v in values]
    if not bench.dwells:
        points = [t.inputs[0] | {"room.T": t.room[0]} | v for t, v in zip(tests, changed, strict=True)]
        columns = _settled(lambda heat: steady_table(flat, _with(points, heat)), effects)
        parts = [columns]
    else:
        parts = [_timed(bench, flat, t, v, effects) for t, v in zip(tests, changed, strict=True)]
    true = {name: np.concatenate([p[name] for p in parts]) for name in parts[0]}
    lengths = [len(t.direction) for t in tests]
    true["order"] = np.repeat(np.arange(len(tests)) / max(len(tests) - 1, 1), lengths)
    true["direction"] = np.concatenate([t.direction for t in tests]).astype(float)
    return true


def _changed(flat: FlatModel, values: Mapping[str, float], effects: Sequence[Effect]) -> dict[str, float]:
    """Parameters with the effects that change them. Raises ValueError for a pattern that meets none."""
    all_values = {q.name: q.start for q in flat.parameters} | dict(values)
    changed = dict(values)
    for effect in effects:
        for by, how in ((effect.factors, "factor"), (effect.added, "added")):
            for pattern, number in by.items():
                paths = [p for p in all_values if fnmatchcase(p, pattern)]
                if not paths:
                    raise ValueError(f"{effect.cause}: the rig has no parameter {pattern}.")
                for p in paths:
                    now = changed.get(p, all_values[p])
                    changed[p] = now * number if how == "factor" else now + number
    return changed


def _with(points: Sequence[Mapping[str, float]], heat: Mapping[str, np.ndarray]) -> list[dict[str, float]]:
    return [
        {**point, **{f"{node}.Q_flow_external": float(q[k]) for node, q in heat.items()}}
        for k, point in enumerate(points)
    ]


def _settled(solve, effects: Sequence[Effect]) -> dict[str, np.ndarray]:
    """Columns of a run with the heat of the effects, which depends on what the run shows; and their power.

    Args:
        solve: node -> heat flow rate per row [W] -> result
        effects: what is wrong
    """
    result: Result = solve({})
    heat: dict[str, np.ndarray] = {}
    for _ in range(ROUNDS):
        wanted: dict[str, np.ndarray] = {}
        for effect in effects:
            for node, q in (effect.heat(result.columns) if effect.heat else {}).items():
                wanted[node] = wanted.get(node, 0.0) + q
        if all(np.abs(q - heat.get(node, 0.0)).max() < SETTLED for node, q in wanted.items()):
            break
        heat = wanted
        result = solve(heat)
    else:
        raise ValueError("the heat of the effects does not settle: they are too strong for this rig")
    extra = sum((e.brake(result.columns) for e in effects if e.brake), np.zeros(len(result.index)))
    return {**result.columns, "P_extra": extra, "index": result.index}


def _timed(
    bench: Bench, flat: FlatModel, test: Test, values: Mapping[str, float], effects: Sequence[Effect]
) -> dict[str, np.ndarray]:
    """The ends of the dwells of one test that starts at the room's temperature."""
    pace = next((e.pace for e in effects if e.pace), (1.0,) * len(bench.dwells))
    room, phases = test.room[0], []
    for k, (inputs, end, dwell) in enumerate(zip(test.inputs, test.room, bench.dwells, strict=True)):
        if k:
            after = room + (end - room) * bench.stop / (bench.stop + dwell)
            phases.append((bench.stop, dict.fromkeys(inputs, 0.0) | {"room.T": (room, after)}))
            room = after
        phases.append((dwell * pace[k], dict(inputs) | {"room.T": (room, end)}))
        room = end
    duty = stepped(phases)
    start = {q.name: test.room[0] for q in flat.states if q.unit == "K"}
    names = [*test.inputs[0], "room.T"]
    first = simulate(flat, duty, start=start, values=values, tolerance=1e-7)

    def solve(heat: Mapping[str, np.ndarray]) -> Result:
        if not heat:
            return first
        driven = {name: first[name] for name in names} | {f"{n}.Q_flow_external": q for n, q in heat.items()}
        schedule = Schedule(first.index, driven)
        return simulate(flat, schedule, start=start, values=values, times=first.index, tolerance=1e-7)

    columns = _settled(solve, effects)
    ends = np.cumsum([duration for duration, _ in phases])[::2]
    at = np.searchsorted(columns["index"], ends - 1e-6)
    return {name: np.asarray(column)[at] for name, column in columns.items()}


def truth_of(bench: Bench, true: Columns) -> dict[str, np.ndarray]:
    """True readings by sensor [SI], signs as in the columns; one shaft end feels the power that the model lacks."""
    extra = {f"{bench.brake}.tau": true["P_extra"] / true[f"{bench.brake}.w"]}
    found = {g.name: true[g.reads] + extra.get(g.reads, 0.0) for g in bench.gauges}
    return {g.name: np.abs(found[g.name]) if g.magnitude else found[g.name] for g in bench.gauges}


def read(bench: Bench, true: Columns, effects: Sequence[Effect], rng: np.random.Generator) -> dict[str, np.ndarray]:
    """What the instruments show by sensor [SI]."""
    shown = truth_of(bench, true)
    for effect in effects:
        if effect.shown:
            shown |= effect.shown(shown, true)
    for g in bench.gauges:
        noise = rng.standard_normal(len(shown[g.name]))
        shown[g.name] = shown[g.name] + g.scale * (g.offset_sd * rng.standard_normal() + g.repeat_sd * noise)
    return shown


def write(case: Case, tests: Sequence[Test], readings: Columns) -> None:
    """The table with the user's columns and the card."""
    bench, rows = case.bench, list[dict[str, object]]()
    for number, test in enumerate(tests, 1):
        for k, direction in enumerate(test.direction):
            row: dict[str, object] = {"point": len(rows) + 1, "test": number}
            if bench.dwells:
                row |= {"order": number, "direction": direction, "dwell_min": round(bench.dwells[k] / 60)}
            for g in bench.gauges:
                value = (readings[g.name][len(rows)] - g.zero) / g.scale
                row[g.column] = f"{value:.5g}"
            rows.append(row)
    with case.data.open("w", encoding="utf-8", newline="") as file:
        table = csv.DictWriter(file, list(rows[0]))
        table.writeheader()
        table.writerows(rows)
    case.card.write_text(bench.card(), encoding="utf-8")


def without_noise(bench: Bench) -> Bench:
    """The bench with perfect instruments."""
    return replace(bench, gauges=tuple(replace(g, repeat_sd=0.0, offset_sd=0.0) for g in bench.gauges))
