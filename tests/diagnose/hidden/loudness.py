"""How loud an effect is: its signature in noise units, with everything that the card leaves open fitted as well."""

import csv
from collections.abc import Mapping, Sequence
from functools import cache

import numpy as np
from diagnose.hidden.benches import BENCHES, Bench, Gauge, Test
from diagnose.hidden.effects import Columns, Effect
from diagnose.hidden.maker import Case, model, run, truth_of
from gearheat.scenarios.load import load

#: Step of a parameter's logarithm, and of an instrument's reading in its tolerance.
STEP = 0.03


def signal_to_noise(bench: Bench, effects: Sequence[Effect], seed: int = 0) -> float:
    """Norm of the whitened change of all readings, uncertain parameters, tolerances and days marginalised.

    Args:
        bench: the rig, with the points that `seed` draws
        effects: what is wrong
    """
    tests = _tests(bench.name, seed)
    none: list[Mapping[str, float]] = [{}] * len(tests)
    shown = _readings(bench, tests, none, effects)
    change = _flat(bench, shown) - _flat(bench, _readings(bench, _as_shown(bench, tests, shown), none, []))
    return float(np.sqrt(change @ np.linalg.solve(covariance(bench.name, seed), change)))


@cache
def covariance(name: str, seed: int) -> np.ndarray:
    """Covariance of all readings of a campaign that is clean: what is read, sensor by sensor, rows within."""
    bench, tests = BENCHES[name], _tests(name, seed)
    none: list[Mapping[str, float]] = [{}] * len(tests)
    base = _flat(bench, _readings(bench, tests, none, []))
    read = [g for g in bench.gauges if not g.given]
    n = len(base) // len(read)
    repeats = np.concatenate([np.full(n, (g.scale * g.repeat_sd) ** 2) for g in read])
    V = np.diag(repeats)
    for k, g in enumerate(read):
        block = np.s_[k * n : (k + 1) * n]
        V[block, block] += (g.scale * g.offset_sd) ** 2
    rows = np.tile(np.arange(n), len(read))
    for g in (g for g in bench.gauges if g.given):  # what was truly there differs from what is shown
        slope = (_flat(bench, _readings(bench, [_moved(t, g) for t in tests], none, [])) - base) / STEP
        V += np.outer(slope, slope)
        V += np.outer(slope, slope) * (rows[:, None] == rows) * (g.repeat_sd / g.offset_sd) ** 2
    for path, sd in _uncertain(bench).items():
        slope = _slope(bench, tests, {path}, base)
        V += sd**2 * np.outer(slope, slope)
    slope = _slope(bench, tests, set(bench.day), base)
    test = np.tile(np.repeat(np.arange(len(tests)), [len(t.direction) for t in tests]), len(read))
    return V + bench.day_sd**2 * np.outer(slope, slope) * (test[:, None] == test)


@cache
def _tests(name: str, seed: int) -> list[Test]:
    return BENCHES[name].tests(np.random.default_rng(seed))


def _uncertain(bench: Bench) -> dict[str, float]:
    """Parameter -> standard deviation of its logarithm."""
    spec, known = load(bench.rig).spec, {q.name for q in model(bench.rig).parameters}
    split = [(*key.partition(".")[::2], sd) for key, sd in bench.prior_sd.items()]
    return {p: sd for kind, key, sd in split for part in spec.of_type(kind) if (p := f"{part}.{key}") in known}


def _slope(bench: Bench, tests: Sequence[Test], paths: set[str], base: np.ndarray) -> np.ndarray:
    start = {q.name: q.start for q in model(bench.rig).parameters}
    values = [{p: start[p] * float(np.exp(STEP)) for p in paths}] * len(tests)
    return (_flat(bench, _readings(bench, tests, values, [])) - base) / STEP


def _moved(test: Test, gauge: Gauge) -> Test:
    path, by = gauge.reads, gauge.scale * gauge.offset_sd * STEP
    if path == "room.T":
        return Test(test.inputs, tuple(T + by for T in test.room), test.direction)
    return Test(tuple({**i, path: i[path] + by * np.sign(i[path])} for i in test.inputs), test.room, test.direction)


def _readings(
    bench: Bench, tests: Sequence[Test], values: Sequence[Mapping[str, float]], effects: Sequence[Effect]
) -> dict[str, np.ndarray]:
    true = run(bench, tests, values, effects)
    shown = truth_of(bench, true)
    for effect in effects:
        if effect.shown:
            shown |= effect.shown(shown, true)
    return shown


def _as_shown(bench: Bench, tests: Sequence[Test], shown: Columns) -> list[Test]:
    """The tests at the inputs that the instruments show."""
    found, row = list[Test](), 0
    for test in tests:
        inputs, room = [dict(i) for i in test.inputs], list(test.room)
        for k in range(len(room)):
            for g in (g for g in bench.gauges if g.given):
                if g.reads == "room.T":
                    room[k] = float(shown[g.name][row])
                else:
                    sign = np.sign(inputs[k][g.reads]) if g.magnitude else 1.0
                    inputs[k][g.reads] = float(sign * shown[g.name][row])
            row += 1
        found.append(Test(tuple(inputs), tuple(room), test.direction))
    return found


def _flat(bench: Bench, readings: Mapping[str, np.ndarray]) -> np.ndarray:
    return np.concatenate([readings[g.name] for g in bench.gauges if not g.given])


def chi_square(bench: Bench, case: Case, seed: int) -> float:
    """Squared deviation of a campaign from the rig file's model, over what a clean one is expected to have.

    Args:
        bench: the rig
        case: the campaign that `seed` draws
        seed: of the campaign
    """
    with case.data.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    shown = {g.name: np.array([float(r[g.column]) for r in rows]) * g.scale + g.zero for g in bench.gauges}
    tests = _tests(bench.name, seed)
    expected = _readings(bench, _as_shown(bench, tests, shown), [{}] * len(tests), [])
    change = _flat(bench, shown) - _flat(bench, expected)
    return float(change @ np.linalg.solve(covariance(bench.name, seed), change)) / len(change)
