"""What must agree between runs, on eight rigs: units, order, mirrors, pieces of duties, FMU, sweep and map, tables."""

from __future__ import annotations

import math
import re
import shutil
from collections.abc import Callable, Iterable, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

import gearheat as gh
import numpy as np
import pytest
from fmpy.validation import validate_fmu
from gearheat.fmu.batch import Batch
from gearheat.fmu.play import Played, Player
from gearheat.model.core.flat import FlatModel
from gearheat.model.run.result import Result
from gearheat.model.run.schedule import Schedule
from gearheat.model.run.search import sensitivities
from gearheat.model.run.simulate import simulate
from gearheat.model.run.steady import steady
from gearheat.model.units import to_si
from gearheat.scenarios.load import load
from gearheat.scenarios.measured.study import Measured, read_study
from gearheat.scenarios.scenario import Scenario
from gearheat.scenarios.shipped import RIGS
from made_tables import made, written

NEW = "new"
NAMES = (
    *("planetary", "helical_two_stage", "cycloidal", "rv_stage", "harmonic", "drum_motor_planetary", "wind_turbine"),
    NEW,
)
#: Of numbers that follow from the same equations, relative to their size and to their nominal.
SAME = 1e-9
#: Of what solvers with an error of their own give [K].
NEAR = 2e-3
HOUR = 3600.0
TIMES = HOUR * np.array([0.25, 0.7, 1.2, 2.0])
#: Unit -> another one, and a number of the second that is 1 and 0 of the first.
UNITS = {
    "mm": ("m", 1e-3, 0.0),
    "um": ("nm", 1e3, 0.0),
    "m2": ("cm2", 1e4, 0.0),
    "mm2/s": ("m2/s", 1e-6, 0.0),
    "l": ("cm3", 1e3, 0.0),
    "deg": ("rad", math.pi / 180, 0.0),
    "rpm": ("rad/s", math.pi / 30, 0.0),
    "N": ("kN", 1e-3, 0.0),
    "N.m": ("kN.m", 1e-3, 0.0),
    "kg.m2": ("g.m2", 1e3, 0.0),
    "GPa": ("MPa", 1e3, 0.0),
    "W/K": ("kW/K", 1e-3, 0.0),
    "J/K": ("kJ/K", 1e-3, 0.0),
    "kW": ("W", 1e3, 0.0),
    "degC": ("K", 1.0, 273.15),
}
Change = Callable[[str], str]


class Case:
    """A rig, and what the relations share of it: each is made once."""

    def __init__(self, name: str, folder: Path) -> None:
        self.name, self.folder = name, folder
        self.path = folder / name / "rig.toml"
        if name == NEW:
            self.path.parent.mkdir()
            gh.new("mine", stages="helical", ratio=4, power="7.5 kW", speed="1450 rpm", out=self.path)
        else:
            shutil.copytree(RIGS / name, self.path.parent)
        self.rig = gh.load(self.path)

    @property
    def scenario(self) -> Scenario:
        return self.rig.scenario

    @property
    def flat(self) -> FlatModel:
        return self.rig.flat

    @cached_property
    def inputs(self) -> dict[str, float]:
        return {q.name: q.start for q in self.flat.inputs}

    @cached_property
    def shaft(self) -> dict[str, float]:
        """Speeds and torques that are given."""
        return {n: v for n, v in self.inputs.items() if n.endswith((".w", ".tau", ".load"))}

    @cached_property
    def speed(self) -> str:
        return next(n for n in self.shaft if n.endswith(".w"))

    @cached_property
    def room(self) -> str:
        assert self.scenario.room
        return self.scenario.room

    @cached_property
    def bodies(self) -> list[str]:
        return [q.name for q in self.flat.states if q.unit == "K"]

    @cached_property
    def point(self) -> Result:
        """The steady state of the operating point."""
        return steady(self.flat, {})

    def changed(self, change: Change) -> Result:
        """The steady state of the rig file with its text changed."""
        text = self.path.read_text("utf-8")
        changed = change(text)
        assert changed != text
        path = self.path.with_name("changed.toml")
        path.write_bytes(changed.encode())
        return steady(load(path).spec.flat(), {})

    @cached_property
    def duty(self) -> Schedule:
        """Run in a room that warms up, stop, run backward with less."""
        share, warmer = np.array([1, 1, 0, 0, -0.7, -0.7]), np.array([0, 5, 5, 5, 5, 2])
        values = {n: np.full(len(share), v) for n, v in self.inputs.items()}
        values |= {n: v * (share if n == self.speed else np.abs(share)) for n, v in self.shaft.items()}
        values[self.room] = self.inputs[self.room] + warmer
        return Schedule(HOUR * np.array([0, 0.5, 0.5, 1, 1, 2]), values)

    @cached_property
    def start(self) -> dict[str, float]:
        return dict.fromkeys(self.bodies, self.inputs[self.room])

    def through(self, duty: Schedule, start: Mapping[str, float] | None = None, later: float = 0.0) -> np.ndarray:
        """Temperatures through a duty, from that of the room, at times that lie in its last nine tenths."""
        found = simulate(self.flat, duty, start=start or self.start, times=later + TIMES)
        return np.array([found[n] for n in self.bodies])

    @cached_property
    def run(self) -> np.ndarray:
        return self.through(self.duty)

    @cached_property
    def fmu(self) -> Path:
        gh.export(self.rig, self.folder / "rig.fmu", platform="host")
        return self.folder / "rig.fmu"

    @cached_property
    def player(self) -> Player:
        return Player(self.fmu)

    def played(self, step: float = 60.0, stop: float = 2 * HOUR, **options: Any) -> Played:
        inputs = {n: (self.duty.time, v) for n, v in self.duty.values.items()}
        return self.player.run(inputs, stop, step, **({"start": self.start} | options))

    @cached_property
    def batch(self) -> Batch:
        return Batch(self.flat)

    @cached_property
    def table(self) -> dict[str, list[float]]:
        """A measured table of its own steady states."""
        return made(self.scenario)

    def study(self, columns: Mapping[str, Iterable[object]], sep: str = ",") -> Measured:
        found = read_study(self.scenario, written(self.folder / "table.csv", columns, sep))
        assert found is not None
        return found


def same(case: Case, found: Mapping[str, float], expected: Mapping[str, float], within: float = SAME) -> None:
    """All numbers of one run are those of another."""
    groups = (case.flat.states, case.flat.inputs, case.flat.outputs)
    size = {q.name: q.nominal for group in groups for q in group}
    assert found.keys() == expected.keys()
    wrong = {
        name: (found[name], value)
        for name, value in expected.items()
        if not abs(found[name] - value) <= within * max(abs(value), 1e-3 * size.get(name, 1.0))
    }
    assert not wrong


def row(result: Result, k: int = 0) -> dict[str, float]:
    return {name: float(column[k]) for name, column in result.columns.items()}


@pytest.fixture(scope="module", params=NAMES)
def case(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Case:
    return Case(request.param, tmp_path_factory.mktemp(request.param))


# --- the rig file -------------------------------------------------------------------------------------------------


def blocks(text: str) -> list[str]:
    """What stands before the first table, and the tables."""
    return re.split(r"^(?=\[)(?=[^\n]*\]\s*(?:#[^\n]*)?$)", text, flags=re.MULTILINE)


def with_templates(text: str) -> str:
    """Every part as a template that one part uses."""
    parts = r"^\[part\.(\w+)\]\n((?:(?!\[)[^\n]*\n)*)"
    return re.sub(parts, r'[template.of_\1]\n\2\n[part.\1]\nuse = "of_\1"\n', text, flags=re.MULTILINE)


def in_other_units(text: str) -> str:
    def other(match: re.Match[str]) -> str:
        if match[2] not in UNITS:
            return match[0]
        unit, factor, zero = UNITS[match[2]]
        return f'"{float(match[1]) * factor + zero!r} {unit}"'

    return re.sub(r'"(-?[\d.]+(?:e[+-]?\d+)?) ([^" ]+)"', other, text)


CHANGES: dict[str, Change] = {
    "other units": in_other_units,
    "tables in another order": lambda text: "".join([blocks(text)[0] + "\n", *(b + "\n" for b in blocks(text)[:0:-1])]),
    "lines as on Windows": lambda text: "\ufeff" + text.replace("\n", "\r\n"),
}


@pytest.mark.parametrize("change", CHANGES)
def test_the_same_rig_file_otherwise_written(case: Case, change: str) -> None:
    same(case, row(case.changed(CHANGES[change])), row(case.point))


def test_written_and_read_again_with_and_without_templates(case: Case) -> None:
    path = case.rig.save(case.folder / "saved.toml")
    same(case, row(steady(load(path).spec.flat(), {})), row(case.point))
    text = path.read_text("utf-8")
    path.write_text(with_templates(text), encoding="utf-8")
    assert path.read_text("utf-8").count("use = ") == len(case.scenario.spec.parts)
    same(case, row(steady(load(path).spec.flat(), {})), row(case.point))


# --- values and drives --------------------------------------------------------------------------------------------


def test_values_are_the_same_however_they_are_given(case: Case) -> None:
    """For a run of the flat model, with a command, for a rig in Python."""
    moved = {q.name: 1.003 * q.start for q in case.flat.parameters if q.start and not q.problem(1.003 * q.start)}
    own = {q.name: q.start for q in case.flat.parameters}
    alone = [n for n, v in moved.items() if not case.flat.contradictions(np.array([*(own | {n: v}).values()]))]
    values = {n: moved[n] for n in alone[:: len(alone) // 8]}
    expected = row(steady(case.flat, values))
    assert expected != row(case.point)
    same(case, row(gh.steady(case.rig, values).result), expected)
    same(case, row(steady(case.rig.with_(values).flat, {})), expected)


def test_units_and_order_of_what_is_set(case: Case) -> None:
    T, w = case.inputs[case.room] + 3.0, 0.9 * case.inputs[case.speed]
    ways = [
        [f"{case.room}={T!r} K", f"{case.speed}={w!r} rad/s"],
        [f"{case.speed}={w * 30 / math.pi!r} rpm", f"{case.room}={T - 273.15!r} degC"],
        [f"{case.room}={(T - 273.15) * 1.8 + 32!r} degF", f"{case.speed}={w / 2 / math.pi!r} Hz"],
    ]
    for way in ways:
        found = case.rig.with_(way).scenario.operating_point
        assert found[case.room] == pytest.approx(T, rel=1e-12)
        assert found[case.speed] == pytest.approx(w, rel=1e-12)


def test_a_mirror_of_the_rig_loses_the_same(case: Case) -> None:
    turned = {n: v if n.endswith(".load") else -v for n, v in case.shaft.items()}
    found = row(steady(case.flat, turned))
    assert found[case.speed] == -case.inputs[case.speed]
    same(case, {n: abs(v) for n, v in found.items()}, {n: abs(v) for n, v in row(case.point).items()})


def test_either_shaft_may_be_given(case: Case) -> None:
    (end,) = {e for e in case.scenario.spec.of_type("ShaftEnd") if f"{e}.w" not in case.inputs}
    values = {f"{end}.{key}": float(case.point[f"{end}.{key}"][0]) for key in ("w", "tau")}
    found, expected = row(gh.steady(case.rig, values).result), row(case.point)
    expected.pop("output.load", None)
    same(case, {n: found[n] for n in expected}, expected, within=1e-7)


# --- steady states ------------------------------------------------------------------------------------------------


def test_one_steady_state_from_cold_and_from_hot(case: Case) -> None:
    for T in (250.0, 400.0):
        same(case, row(steady(case.flat, {}, guess=dict.fromkeys(case.bodies, T))), row(case.point), within=1e-7)


def test_a_run_stays_where_it_is_steady(case: Case) -> None:
    held = Schedule(np.array([0.0, 5 * HOUR]), {n: np.full(2, v) for n, v in case.inputs.items()})
    start = {q.name: float(case.point[q.name][0]) for q in case.flat.states}
    found = simulate(case.flat, held, start=start, times=[60.0, 5 * HOUR])
    for k in (0, 1):
        same(case, row(found, k), row(case.point), within=1e-7)


def test_heat_from_outside_leaves_through_the_room(case: Case) -> None:
    """With what the losses change by."""
    source = next(n for n in case.inputs if n.endswith(".Q_flow_external"))
    heated = steady(case.flat, {source: 20.0})
    takes = [f"{part}.Q_flow" for part in case.scenario.spec.of_type("Room", "PrescribedTemperature")]
    lost, out = (sum(heated[n][0] - case.point[n][0] for n in ns) for ns in (case.scenario.losses["P_total_W"], takes))
    assert out == pytest.approx(20.0 + lost, abs=1e-6)


def test_a_design_gives_its_target_back(case: Case) -> None:
    body = case.bodies[0]
    target = float(case.point[body][0]) + 2.0
    found = gh.design(case.rig, [case.room], {body: target})
    again = gh.steady(case.rig, {case.room: found[case.room]})
    assert again[body] == pytest.approx(target, abs=1e-4)
    assert found[case.room] != pytest.approx(case.inputs[case.room], abs=0.5)


def test_sensitivities_are_differences(case: Case) -> None:
    named = [case.room, case.speed]
    found = sensitivities(case.flat, [case.bodies[0]], named, {})
    for name, slope in zip(named, found[0], strict=True):
        step = 1e-4 * max(abs(case.inputs[name]), 1.0)
        low, high = (steady(case.flat, {name: case.inputs[name] + s})[case.bodies[0]][0] for s in (-step, step))
        assert slope == pytest.approx((high - low) / (2 * step), rel=1e-4)


# --- duties -------------------------------------------------------------------------------------------------------


def with_row(duty: Schedule, t: float) -> tuple[Schedule, int]:
    """A duty with a row more, on the line between two, and its place."""
    k = int(np.searchsorted(duty.time, t))
    at = {n: np.interp(t, duty.time[k - 1 : k + 1], v[k - 1 : k + 1]) for n, v in duty.values.items()}
    return Schedule(np.insert(duty.time, k, t), {n: np.insert(v, k, at[n]) for n, v in duty.values.items()}), k


def cut(duty: Schedule, rows: slice | np.ndarray) -> Schedule:
    return Schedule(duty.time[rows], {n: v[rows] for n, v in duty.values.items()})


def test_a_duty_in_two_pieces(case: Case) -> None:
    whole, k = with_row(case.duty, 0.2 * HOUR)
    first = simulate(case.flat, cut(whole, slice(k + 1)), start=case.start)
    between = {q.name: float(first[q.name][-1]) for q in case.flat.states}
    assert case.through(cut(whole, slice(k, None)), between) == pytest.approx(case.run, abs=NEAR)


def test_a_duty_at_another_time(case: Case) -> None:
    later = Schedule(case.duty.time + 7 * HOUR, case.duty.values)
    assert case.through(later, later=7 * HOUR) == pytest.approx(case.run, abs=NEAR)


def test_rows_that_say_nothing(case: Case) -> None:
    """On a line between two, and one that is there twice."""
    more, k = with_row(case.duty, 0.3 * HOUR)
    assert case.through(more) == pytest.approx(case.run, abs=NEAR)
    assert case.through(cut(more, np.r_[: k + 1, k : len(more.time)])) == pytest.approx(case.run, abs=NEAR)


def test_columns_of_a_duty_in_other_units_and_order(case: Case) -> None:
    units = {"rad/s": ("rpm", 30 / math.pi, 0.0), "K": ("degC", 1.0, -273.15), "N.m": ("kN.m", 1e-3, 0.0)}
    found = []
    for names, time in ((list(case.inputs), ("min", 60.0)), (list(case.inputs)[::-1], ("h", HOUR))):
        columns: dict[str, Iterable[object]] = {f"time [{time[0]}]": case.duty.time / time[1]}
        for q in (case.flat.quantity(n) for n in names):
            unit, factor, zero = units.get(q.unit, (q.unit, 1.0, 0.0)) if time[0] == "h" else (q.unit, 1.0, 0.0)
            columns[f"{q.name} [{unit}]"] = map(repr, (case.duty.values[q.name] * factor + zero).tolist())
        found.append(gh.simulate(case.rig, written(case.folder / "duty.csv", columns)))
    for name in case.bodies:
        assert found[1][name][-1] == pytest.approx(found[0][name][-1], abs=1e-6)
    assert [found[0][n][-1] for n in case.bodies] == pytest.approx(case.run[:, -1], abs=NEAR)


def test_an_input_that_stays_is_given_set_or_that_of_the_rig(case: Case) -> None:
    stays = next(n for n in case.inputs if n.endswith(".air_speed"))
    duty = Schedule(case.duty.time, {n: v for n, v in case.duty.values.items() if n != stays})
    assert case.through(duty) == pytest.approx(case.run, abs=1e-9)
    moved = simulate(case.flat, duty, values={stays: 2.0 + case.inputs[stays]}, start=case.start, times=TIMES)
    given = Schedule(duty.time, {**duty.values, stays: np.full(len(duty.time), 2.0 + case.inputs[stays])})
    assert np.array([moved[n] for n in case.bodies]) == pytest.approx(case.through(given), abs=1e-9)


# --- sweep, map, FMU ----------------------------------------------------------------------------------------------


def shares(case: Case) -> np.ndarray:
    return case.inputs[case.speed] * np.array([0.8, 0.9, 1.0])


def si(case: Case, name: str, value: float, unit: str) -> float:
    return to_si(f"{value!r} {unit}", case.flat.quantity(name).unit)


def test_rows_of_a_sweep_are_steady_states(case: Case) -> None:
    low, _, high = sorted(map(float, shares(case)))
    found = gh.sweep(case.rig, {case.speed: (low, high, 3)}, draw=True)
    assert found.rows is not None
    for k, w in enumerate((low, (low + high) / 2, high)):
        expected = row(steady(case.flat, {case.speed: w}))
        shown = dict(zip(found.plan.job.outputs, found.rows[k], strict=False))
        same(case, shown, {n: expected[n] for n in shown}, within=1e-6)


def test_rows_of_a_batch_know_nothing_of_each_other(case: Case) -> None:
    """In another order, on other threads, alone: the same bits."""
    u = np.tile(list(case.inputs.values()), (3, 1))
    u[:, list(case.inputs).index(case.speed)] = shares(case)
    whole = case.batch.steady(u, threads=1)
    for rows in ([2, 0, 1], [1]):
        found = case.batch.steady(u[rows], threads=2)
        assert found.x.tobytes() == whole.x[rows].tobytes()
        assert found.y.tobytes() == whole.y[rows].tobytes()


def test_a_point_of_a_map_is_a_steady_state(case: Case) -> None:
    found = gh.map(case.rig, grid="2x2", output=[case.bodies[0]])
    for k in range(4):
        at = {n: si(case, n, float(found.columns[n][k]), found.units[n]) for n in (*case.shaft, case.bodies[0])}
        T = at.pop(case.bodies[0])
        assert steady(case.flat, at)[case.bodies[0]][0] == pytest.approx(T, abs=1e-4)


def test_the_fmu_is_that_of_simulate(case: Case) -> None:
    played = case.played()
    assert validate_fmu(str(case.fmu)) == []
    ours = simulate(case.flat, case.duty, start=case.start, times=played.time[::10])
    for name in case.bodies:
        assert played[name][::10] == pytest.approx(ours[name], abs=NEAR), name


def test_the_fmu_from_the_start_again(case: Case) -> None:
    first = case.played()
    assert case.played().values.tobytes() == first.values.tobytes()


def test_the_fmu_in_steps_of_any_length(case: Case) -> None:
    short, long = case.played(step=30.0), case.played(step=900.0)
    for name in case.bodies:
        assert long[name][-1] == pytest.approx(short[name][-1], abs=NEAR)


def test_the_fmu_goes_on_where_another_ended(case: Case) -> None:
    first = case.played(stop=HOUR / 5)
    start = {q.name: first[q.name][-1] for q in case.flat.states}
    found = case.played(begin=HOUR / 5, start=start)
    for name in case.bodies:
        assert found[name][-1] == pytest.approx(case.played()[name][-1], abs=NEAR)


# --- measured tables ----------------------------------------------------------------------------------------------


def alike(case: Case, found: Measured, expected: Measured) -> None:
    """Two tables say the same, so that all that follows from them is the same."""
    one, other = found.campaign, expected.campaign
    assert one.names == other.names
    assert [(s.name, s.signs) for s in one.sensors] == [(s.name, s.signs) for s in other.sensors]
    for key in ("test", "order", "direction", "dwell", "stop"):
        assert np.array_equal(getattr(one, key), getattr(other, key)), key
    for name, values in other.values.items():
        assert one.values[name] == pytest.approx(values, rel=SAME), name


def test_a_table_in_other_units_columns_and_signs_between_cells(case: Case) -> None:
    units = {"C": ("degF", 1.8, 32.0), "rpm": ("rad/s", math.pi / 30, 0.0), "Nm": ("kN.m", 1e-3, 0.0)}
    changed: dict[str, Iterable[object]] = {}
    for name in [*case.table][::-1]:
        plain, _, ending = name.rpartition("_")
        unit, factor, zero = units[ending]
        changed[f"{plain} [{unit}]"] = [str(v * factor + zero).replace(".", ",") for v in case.table[name]]
    alike(case, case.study(changed, ";"), case.study(case.table))


def test_tests_stand_in_running_order_wherever_their_rows_are(case: Case) -> None:
    n = len(next(iter(case.table.values())))
    numbered = case.table | {"test": [*range(11, 11 + n)], "order": [*range(1, n + 1)]}
    mixed = np.random.default_rng(1).permutation(n)
    alike(case, case.study({c: [v[k] for k in mixed] for c, v in numbered.items()}), case.study(numbered))


def test_dates_that_are_later_and_rows_that_are_there_twice(case: Case) -> None:
    """Dates say what lies how far apart, not when; a reading that is there twice is told, and changes no other."""
    n = len(next(iter(case.table.values())))
    first, later = ([f"{year}-03-{day:02d}" for day in range(2, 2 + n)] for year in (2021, 2025))
    expected = case.study(case.table | {"date": first})
    alike(case, case.study(case.table | {"date": later}), expected)
    twice = case.study({c: [*v, *v] for c, v in case.table.items()}).campaign
    told = [w for w in twice.warnings if "all readings are those of line" in w]
    assert len(told) == n and set(twice.warnings) - set(told) == set(expected.campaign.warnings)
    for name, values in expected.campaign.values.items():
        assert twice.values[name].tolist() == [*values, *values]


def test_losses_at_a_reading_are_those_of_its_steady_state(case: Case) -> None:
    study = case.study(case.table)
    found = gh.losses(case.rig, data=case.folder / "table.csv", temperature="model")
    for k, lost in enumerate(found.as_dict()["rows"]):
        at = steady(study.scenario.spec.flat(), study.given(k))
        for column, paths in case.scenario.losses.items():
            assert lost[column] == pytest.approx(sum(float(at[p][0]) for p in paths), rel=1e-6, abs=1e-9), column
