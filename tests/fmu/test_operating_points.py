"""A table of operating points of every shipped rig: cold to hot, rest to twice the speed, all directions and drives.
Parts that no shipped rig has are asked by themselves, between sources on all of their ports.

Each point either converges in Python, FMU and batch alike, with its audit, no negative loss and an efficiency between 0
and 1, or is refused by all of them, with a name. Nothing fails in silence.

A rig with two shaft ends has one of its four drives, the next rig another; all with GEARHEAT_TESTS=all.
"""

from collections.abc import Callable, Iterator
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from for_each import one_of_each, thin
from gearheat.fmu.batch import Batch, Status
from gearheat.fmu.export import export
from gearheat.model.core.flat import FlatModel, Quantity
from gearheat.model.errors import SolveError
from gearheat.model.machines.spec import Spec
from gearheat.model.parts import PARTS
from gearheat.model.run.result import LEFT, out_of_range
from gearheat.model.run.rows import evaluate
from gearheat.model.run.schedule import join_phases
from gearheat.model.run.steady import steady
from gearheat.scenarios.load import list_rigs, load
from one_part import between_sources, oil_at

TEMPERATURES = (-40.0, -20.0, 20.0, 80.0, 150.0)
SPEEDS = (-2.0, -1.0, 0.0, 0.1, 1.0, 2.0)
TORQUES = (-1.5, -0.2, 0.0, 1.0, 1.5)
#: Agreement of Python, FMU and batch, relative to value and nominal.
SAME = 1e-6
Point = dict[str, float]


def drives(spec: Spec) -> dict[str, dict[str, tuple[str, ...]]]:
    """All ways to give speeds and torques at the shaft ends of a machine."""
    first, *others = spec.of_type("ShaftEnd")
    if not others:
        return {"speed": {first: ("w",)}, "torque": {first: ("tau",)}}
    (second,) = others
    both = {f"drive {end}": {end: ("w", "tau")} for end in (first, second)}
    return both | {"across": {first: ("w",), second: ("tau",)}, "torques": {first: ("tau",), second: ("tau",)}}


def structures() -> Iterator[str]:
    """The rigs, those that differ from another in numbers only left out."""
    seen = []
    for rig in list_rigs():
        spec = load(rig).spec
        structure = (spec.connections, [part.type for part in spec.parts])
        if structure not in seen:
            seen.append(structure)
            yield rig


RIGS = tuple(structures())
EVERY = [(rig, drive) for rig in RIGS for drive in drives(load(rig).spec)]


def chosen(without: tuple[str, ...] = ()) -> list[tuple[str, str]]:
    """Rigs with all of their drives, or, with two shaft ends, with one of them in turn.

    Args:
        without: drives that are left out
    """
    many = {rig for rig, _ in EVERY if sum(rig == other for other, _ in EVERY) > 2}
    left = [case for case in EVERY if case[1] not in without]
    return one_of_each(left, lambda case: case[0] if case[0] in many else case)


CASES = chosen()
#: Parts that no shipped rig has.
ALONE = sorted(set(PARTS) - {part.type for rig in list_rigs() for part in load(rig).spec.parts})


@cache
def model(rig: str, drive: str) -> FlatModel:
    spec = load(rig).spec
    return spec.driven(drives(spec)[drive]).flat()


@cache
def usual(rig: str) -> Point:
    """Speeds and torques of the shafts where the rig works."""
    scenario = load(rig)
    result = steady(scenario.spec.flat(), scenario.operating_point)
    names = [f"{end}.{key}" for end in scenario.spec.of_type("ShaftEnd") for key in ("w", "tau")]
    return {name: float(result[name][0]) for name in names}


def points(rig: str, drive: str) -> tuple[np.ndarray, np.ndarray]:
    """States and inputs, a column per point: every body and the room at one temperature."""
    flat, own = model(rig, drive), usual(rig)
    first_speed = next(iter(own))
    table = []
    for T, w, tau in product(TEMPERATURES, SPEEDS, TORQUES):
        if not any(q.name.endswith(".tau") for q in flat.inputs if q.name in own) and tau != 1.0:
            continue
        x = [T + 273.15 if q.unit == "K" else w * own[first_speed] for q in flat.states]
        factor = {"rad/s": w, "N.m": tau}
        u = [own[q.name] * factor[q.unit] if q.name in own else q.start for q in flat.inputs]
        room = flat.locate("room.T")[1] if "room.T" in flat.index else None
        if room is not None:
            u[room] = T + 273.15
        table.append((x, u))
    x, u = (np.array(columns).T for columns in zip(*table, strict=True))
    return x, u


def points_of_a_part(flat: FlatModel) -> tuple[np.ndarray, np.ndarray]:
    """States and inputs of a part alone, a column per point: heat flows up and down, oil is that of its temperature."""
    table = []
    for T, w, tau in product(TEMPERATURES, SPEEDS, TORQUES):
        oil = oil_at(T + 273.15)
        by_unit = {"rad/s": 50.0 * w, "N.m": 100.0 * tau, "kg/s": 0.1 * w}

        def value(q: Quantity, k: int, T: float = T, oil: Point = oil, by_unit: Point = by_unit) -> float:
            if q.unit == "K":
                return T + 273.15 + 5.0 * (k % 3)
            if q.name == "outlet.m_flow":  # what flows into a sump leaves it
                return -by_unit[q.unit]
            return max(q.low, oil.get(q.name.rpartition(".")[2], by_unit.get(q.unit, q.nominal)))

        table.append([[value(q, k) for k, q in enumerate(group)] for group in (flat.states, flat.inputs)])
    x, u = (np.array(columns).reshape(len(table), -1).T for columns in zip(*table, strict=True))
    return x, u


def told(flat: FlatModel, x: np.ndarray, u: np.ndarray) -> tuple[np.ndarray | None, str]:
    """Outputs at a point and no problem, or none and what Python says of it."""
    p = flat.starts("parameter")
    try:
        found = evaluate(flat, x[:, None], u[:, None], p)
    except SolveError as error:
        return None, str(error)
    y = found["y"][:, 0]
    columns = {q.name: np.array([v]) for q, v in zip(flat.outputs, y, strict=True)}
    if problems := list(out_of_range(flat, columns)):
        return None, "\n".join(problems)
    if not np.isfinite(np.concatenate([y, found["ode"][:, 0]])).all():
        return None, ""
    assert np.abs(found["residual"]).max(initial=0.0) <= LEFT
    inside = [abs(v) for q, v in zip(flat.outputs, y, strict=True) if q.unit == "W"]  # from masses that slow down
    throughput = max(float(found["throughput"][0, 0]), 1.0, *inside)
    assert np.abs(found["imbalance"]).max() <= 1e-6 * throughput
    return y, ""


def negative(flat: FlatModel, y: np.ndarray) -> Iterator[str]:
    """Losses below zero and efficiencies beyond their ends, unless masses turn and take part."""
    turning = any(q.unit == "rad/s" for q in flat.states)
    for q, value in zip(flat.outputs, y, strict=True):
        key = q.name.rpartition(".")[2]
        loss = key.startswith(("P_loss", "tau_loss")) and not q.name.startswith("efficiency.")
        if (loss and value < -1e-9) or (key == "eta" and not turning and not -1e-9 <= value <= 1 + 1e-9):
            yield f"{q.name} = {value}"


def agree(flat: FlatModel, one: np.ndarray, other: np.ndarray) -> bool:
    nominal = np.array([q.nominal for q in flat.outputs])
    return bool((np.abs(one - other) <= SAME * (nominal + np.abs(one))).all())


@pytest.mark.parametrize(("rig", "drive"), thin(CASES))
def test_every_point_converges_alike_or_is_refused_by_name(
    rig: str, drive: str, tmp_path: Path, opened: Callable[..., Any]
) -> None:
    alike(model(rig, drive), *points(rig, drive), tmp_path, opened)


@pytest.mark.parametrize("kind", thin(ALONE))
def test_every_point_of_a_part_that_no_rig_has(kind: str, tmp_path: Path, opened: Callable[..., Any]) -> None:
    flat = between_sources(kind)
    alike(flat, *points_of_a_part(flat), tmp_path, opened)


def alike(flat: FlatModel, x: np.ndarray, u: np.ndarray, folder: Path, opened: Callable[..., Any]) -> None:
    """Python, FMU and batch agree at each point, or all refuse it."""
    n = x.shape[1]
    one = opened(export(flat, folder / "m.fmu"))
    refs = [one.refs[q.name] for q in (*flat.states, *flat.inputs)]
    outputs = [one.refs[q.name] for q in flat.outputs]
    rows = Batch(flat).warmup(join_phases([(1e-9, {})]), u.T.copy(), None, x.T.copy(), times=[0.0])
    answered = 0
    for k in range(n):
        y, problem = told(flat, x[:, k], u[:, k])
        one.fmu.reset()
        one.fmu.setReal(refs, [*x[:, k], *u[:, k]])
        where = dict(zip([q.name for q in (*flat.states, *flat.inputs)], [*x[:, k], *u[:, k]], strict=True))
        if y is None:
            status, text = one.refused(one.start)
            assert status == 3 and problem and any(q.name.partition(".")[0] in problem for q in flat.outputs), where
            assert any(q.name.partition(".")[0] in text for q in flat.outputs), (where, text)
            assert rows.status[k] != Status.OK, where
            continue
        answered += 1
        assert list(negative(flat, y)) == [], where
        one.start()
        assert agree(flat, y, np.array(one.fmu.getReal(outputs))), where
        assert rows.status[k] == Status.OK and agree(flat, y, rows.y[k, 0]), where
    assert n >= 25 and answered > 0.9 * n


@pytest.mark.parametrize("rig", RIGS)
def test_the_table_is_large_enough(rig: str) -> None:
    assert sum(points(rig, drive)[0].shape[1] for name, drive in CASES if name == rig) >= 60


@pytest.mark.parametrize(("rig", "drive"), thin(chosen(without=("torque", "torques")), 1))
def test_steady_states_of_python_and_batch_are_the_same(rig: str, drive: str) -> None:
    """Where the machine settles in a cold and in a hot room; what one refuses the other refuses, and says where."""
    flat = model(rig, drive)
    x, u = points(rig, drive)
    x, u = x[:, ::7], u[:, ::7]
    rows = Batch(flat).steady(u.T.copy(), None, x.T.copy())
    names = [q.name for q in flat.inputs]
    for k in range(x.shape[1]):
        values = dict(zip(names, u[:, k], strict=True))
        guess = {q.name: v for q, v in zip(flat.states, x[:, k], strict=True)}
        try:
            found = steady(flat, values, guess=guess)
        except SolveError as error:
            assert rows.status[k] != Status.OK, (values, str(error))
            continue
        assert rows.status[k] == Status.OK, values
        y = np.array([found[q.name][0] for q in flat.outputs])
        assert agree(flat, y, rows.y[k]), values
        assert list(negative(flat, y)) == [], values
