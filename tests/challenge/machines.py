"""Sheet "machines": gear units of `gearheat new` by random name plates, one to four faults of parts at once.

Nothing of the diagnosis is used. Stages, power, speed, oil, a fan, hall and points are drawn. Losses and heat paths of
the true machine differ from those of the rig file by a factor of each and a smooth random function of speed, load and
room. What is hidden is a factor on parameters of a type of part, heat from outside, or an error of an
instrument; it moves the readings by `LEAST` standard deviations of all that is uncertain or more, each fault beside the
others.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cached_property
from pathlib import Path
from typing import Any

import gearheat
import numpy as np
from gearheat.fmu.batch import Batch, Status
from gearheat.model.errors import ScenarioError
from gearheat.model.machines.roles import Roles
from gearheat.scenarios.load import load
from gearheat.scenarios.measured.card import Card
from gearheat.scenarios.measured.nominal import Nominal
from gearheat.scenarios.measured.sensors import sensors_of
from gearheat.scenarios.measured.table import Sensor
from gearheat.scenarios.scenario import Scenario
from scipy.linalg import block_diag

from .classes import classes_of
from .new_rig import CHANGES, as_shown

#: Kinds of cases.
KINDS = ("clean", "single", "several")
#: Stages of a unit, and lowest and highest ratio of each of them.
STAGES: Mapping[str, tuple[float, float]] = {
    "helical": (2.0, 4.5),
    "helical,helical": (2.5, 4.0),
    "helical,helical,helical": (2.5, 3.6),
    "bevel,helical": (2.0, 3.5),
    "planetary": (3.5, 8.0),
    "worm": (8.0, 30.0),
}
#: Powers of the name plate [kW], lowest and highest.
POWERS = (0.75, 45.0)
#: Speeds of four- and six-pole motors [rpm].
SPEEDS = (960.0, 1450.0)
OILS = ("ISO VG 150 mineral", "ISO VG 220 mineral", "ISO VG 320 mineral")
#: Standard deviation of a factor of the true machine over the rig file, which is known better than a name plate tells,
#: and of its course over its range, as a share of that [1].
UNEQUAL = 0.1
CURVED = 0.3
#: Parameters of losses and heat paths that differ so.
TRUE = ("*.k_loss", "*.k_mu", "cooling.A*", "foot.k_G", "oil_wall.A", "oil_gears_*.A")
#: Standard deviations by which what is hidden moves the readings, at least and at most.
LEAST, MOST = 5.0, 60.0
#: Share of the cases without a fault, and with one; others have two to four.
CLEAN, SINGLE = 0.28, 0.4
#: Where heat from outside goes, as a share of the loss at a point.
HEAT = "wall.Q_flow_external"
#: The oil stays below this [degC], and rises by so much at one point or more [K].
HOT = 120.0
WARM = 15.0
#: Size at which rivals are compared: logarithm of a factor, or one of the errors [K, share of the loss or reading].
SMALL = 0.3
#: Standard deviation of the hall's temperature before it is read [K].
ANY = 20.0

#: Values by path, or errors by sensor.
Change = Mapping[str, float]


@dataclass(frozen=True)
class Fault:
    """What may go wrong with parts of a type.

    Args:
        cause: its name
        pattern: of the parameters that are multiplied, or "sensor KIND" for an error of an instrument
        low, high: factor; error of an instrument [K, share of the typical reading], either sign
        one: whether a single one of several parts is meant, where chance says so
    """

    cause: str
    pattern: str
    low: float
    high: float
    one: bool = False


FAULTS: tuple[Fault, ...] = (
    Fault("cooling.fan", "fan.k_v", 0.0, 0.5),
    Fault("losses.bearing_friction", "*_bearing*.k_loss", 1.6, 5.0, one=True),
    Fault("losses.seal_drag", "*_seal.k_loss", 1.5, 5.0, one=True),
    Fault("losses.mesh_friction", "stage_*.k_mu", 1.4, 2.5, one=True),
    Fault("losses.churning", "churning_*.k_loss", 1.5, 6.0),
    Fault("losses.oil_viscosity", "oil.nu_*", 0.4, 2.5),
    Fault("cooling.air", "cooling.A*", 0.5, 0.8),
    Fault("cooling.foundation", "foot.k_G", 2.0, 6.0),
    Fault("cooling.oil_wall", "oil_wall.A", 0.2, 0.6),
    Fault("heat.external_source", HEAT, 0.1, 0.6),
    Fault("sensor.oil_temp.offset", "sensor oil_temp", 1.5, 6.0),
    Fault("sensor.wall_temp.offset", "sensor wall_temp", 1.5, 6.0),
    Fault("sensor.ambient.bias", "sensor ambient", 1.5, 6.0),
    Fault("sensor.torque.gain", "sensor torque", 0.03, 0.12),
)


class Machine:
    """A true machine on its bench."""

    curved = CURVED
    #: Readings of which an answer says by how much they have changed.
    asked = slice(None)

    def __init__(self, path: Path, rng: np.random.Generator) -> None:
        self.tell(path)
        scenario = load(str(path))
        self.nominal, self.sensors = Nominal(scenario), sensors_of(scenario, Card())
        self.batch = Batch(self.nominal.flat)
        roles = Roles.of(scenario.spec)
        names = [n for n in self.nominal.flat.index if "." in n]
        #: Why the true machine differs: path -> relative standard deviation; all of a reason deviate together.
        self.reasons = self.deviate(scenario, names)
        unequal = [n for reason in self.reasons for n in reason]
        faulty = [n for n in names if any(fnmatchcase(n, f.pattern) for f in FAULTS)]
        self.healthy = {n: 0.0 if n == HEAT else float(roles.value(n)) for n in (*unequal, *faulty)}
        self.unequal: dict[str, tuple[float, np.ndarray]] = {}
        for reason in self.reasons:
            level, slopes = rng.standard_normal(), self.curved * rng.standard_normal(3)
            self.unequal |= {n: (sd * level, sd * slopes) for n, sd in reason.items()}
        self.lay_out(rng)
        self.loss = self._loss()
        by = {s.name: k for k, s in enumerate(self.sensors)}
        #: Readings of the sound machine without noise (points, sensors).
        self.sound = self.read({}, {})
        if (self.sound[:, by["T_oil"]] - self.sound[:, by["T_amb"]]).max() < WARM:
            raise ArithmeticError("too cold")

    def tell(self, path: Path) -> None:
        """What the rig file says of how uncertain it is: nothing, so that the diagnosis takes what is usual."""
        lines = path.read_text("utf-8").partition("\n[uncertainties.")[0].splitlines(keepends=True)
        path.write_text("".join(line for line in lines if not line.startswith("uncertainties = ")), "utf-8")

    def deviate(self, scenario: Scenario, names: Sequence[str]) -> list[dict[str, float]]:
        """Why the true machine differs, of all names of its values."""
        return [{n: UNEQUAL} for n in names if any(fnmatchcase(n, t) for t in TRUE)]

    def lay_out(self, rng: np.random.Generator) -> None:
        """Draw what is run: points of speed, load and room."""
        room = rng.uniform(5.0, 15.0)
        speeds, loads = np.sort(rng.uniform(0.35, 1.0, 4)), np.sort(rng.uniform(0.2, 1.0, 4))
        rooms = room + np.array([0.0, rng.uniform(6.0, 16.0)])
        points = [(n, load_, T) for n in speeds for load_ in loads for T in rooms]
        kept = rng.permutation(len(points))[: int(rng.integers(20, 33))]
        self.points = [points[k] for k in kept]

    def _loss(self) -> float:
        state = self._states({}, self.points[:1])
        powers = [np.abs(state[f"{end}.w"] * state[f"{end}.tau"]) for end in ("input", "output")]
        return float(max(powers[0][0] - powers[1][0], 1.0))

    def _states(self, changed: Change, points: Sequence[tuple[float, float, float]]) -> Mapping[str, np.ndarray]:
        """Everything (points,); raises `ArithmeticError` where the machine cannot be run."""
        known = {n: v for n, v in self.nominal.scenario.operating_point.items() if n in self.nominal.flat.index}
        rows = []
        for n, load_, room in points:
            here = {"input.w": n * self.nominal.value("input.w"), "room.T": room + 273.15}
            course = _course((n, load_, room))
            true = {
                name: changed.get(name, self.healthy[name]) * float(np.exp(level + slopes @ course))
                for name, (level, slopes) in self.unequal.items()
            }
            here["output.load"] = load_ * self.nominal.value("output.load")
            rows.append(known | here | dict(changed) | true)
        given = {name: np.array([row[name] for row in rows]) for name in rows[0]}
        found = self.batch.steady(*self.batch.vectors(given))
        if (found.status != Status.OK).any():
            raise ArithmeticError("no steady state")
        if not (found["oil.T"] < HOT + 273.15).all():
            raise ArithmeticError("too hot")
        return given | {name: found[name] for name in found.columns}

    def read(
        self, changed: Change, errors: Change, points: Sequence[tuple[float, float, float]] | None = None
    ) -> np.ndarray:
        """Readings without noise (points, sensors)."""
        return self.wrong(self._states(changed, self.points if points is None else points), errors)

    def wrong(self, found: Mapping[str, np.ndarray], errors: Change) -> np.ndarray:
        """Readings of states, with errors by sensor."""
        true = np.array([found[s.reads] for s in self.sensors]).T
        scale = np.where([s.kind == "torque" for s in self.sensors], true, 1.0)
        return np.asarray(true + scale * np.array([errors.get(s.name, 0.0) for s in self.sensors]))

    @cached_property
    def root(self) -> np.ndarray:
        """Lower root of the covariance of all readings, in repeatabilities, to first order.

        The hall at each point is known by its thermometer alone; tolerances and what the rig file does not know are
        uncertain.
        """
        whole = np.array([*self.uncertain(), *self.unsteady()]).T
        return np.asarray(np.linalg.cholesky(np.eye(len(whole)) + whole @ whole.T))

    def uncertain(self) -> list[np.ndarray]:
        """What a standard deviation of each factor and of each instrument's tolerance does to all readings."""
        offsets = np.diag([s.offset_sd for s in self.sensors])
        return self.deviations() + [self.in_repeatabilities(np.tile(one, (len(self.sound), 1))) for one in offsets]

    def deviations(self) -> list[np.ndarray]:
        """What a standard deviation of each reason does to all readings, to first order."""
        return [e / SMALL for e in self.effects([(change, {}) for change in self.slightly()])]

    def slightly(self) -> list[Change]:
        """A small share of a standard deviation of each reason."""
        return [{n: np.exp(SMALL * sd) * self.healthy[n] for n, sd in reason.items()} for reason in self.reasons]

    def unsteady(self) -> list[np.ndarray]:
        """The same of the courses of the factors, and of the hall at each point."""
        sd = np.array([s.repeat_sd for s in self.sensors])
        factors = self.deviations()
        courses = np.repeat([_course(point) for point in self.points], len(sd), axis=0).T
        known = [self.curved * course * factor for factor in factors for course in courses]
        other = self.read({}, {}, [(n, load_, room + SMALL) for n, load_, room in self.points])
        return known + [ANY / SMALL * column for column in block_diag(*(other - self.sound) / sd)]

    def effects(self, changes: Sequence[tuple[Change, Change]]) -> list[np.ndarray]:
        """What values and errors do to all readings."""
        return [self.in_repeatabilities(self.read(*change) - self.sound) for change in changes]

    def in_repeatabilities(self, change: np.ndarray) -> np.ndarray:
        """A change of all readings (points, sensors) as a vector."""
        return np.asarray((change / [s.repeat_sd for s in self.sensors]).ravel())

    def size(self, change: np.ndarray) -> float:
        """How far a change of all readings (points, sensors) is from nothing [sigma]."""
        return float(np.linalg.norm(np.linalg.solve(self.root, self.in_repeatabilities(change))))

    def hides(self, change: np.ndarray) -> float | None:
        """How far a change of all readings is from nothing [sigma]; None if it is too little or too much to hide."""
        size = self.size(change)
        return size if LEAST <= size <= MOST else None

    def write(self, case: Path, table: np.ndarray) -> None:
        """Readings into the files of a case."""
        write_table(case / "DATA.csv", self.sensors, table)

    def distance(self, hidden: Sequence[tuple[Change, Change]], classes: Collection[str]) -> tuple[float, str]:
        """How far what is hidden is from a rival of any size in the place of one of its faults [sigma], and which.

        Args:
            hidden: values and errors of each fault
            classes: of the faults, none of which is a rival
        """
        units = [(fault.cause, k, unit) for fault in FAULTS for k, unit in enumerate(self.units(fault))]
        moved = self.effects([unit for _, _, unit in units])
        rivals = {f"{cause} {k}": (m, classes_of([cause])) for (cause, k, _), m in zip(units, moved, strict=True)}
        own = np.linalg.solve(self.root, np.array(self.effects(hidden)).T)
        nearest = np.inf, ""
        for k in range(len(hidden)):
            rest = np.delete(own, k, axis=1)
            for name, (column, kind) in rivals.items():
                if not kind & set(classes):
                    A = np.column_stack([rest, np.linalg.solve(self.root, column)])
                    left = own[:, k] - A @ np.linalg.lstsq(A, own[:, k], rcond=None)[0]
                    nearest = min(nearest, (float(np.linalg.norm(left)), name))
        return nearest

    def units(self, fault: Fault) -> Iterator[tuple[Change, Change]]:
        """A small one of a fault: of all its parts, then of each."""
        if fault.pattern.startswith("sensor "):
            yield from (({}, {s.name: SMALL}) for s in self.sensors if s.kind == fault.pattern.split()[1])
        elif fault.pattern == HEAT:
            yield {HEAT: SMALL * self.loss}, {}
        else:
            names = [n for n in self.healthy if fnmatchcase(n, fault.pattern)]
            for some in [names, *([[n] for n in names] if fault.one else [])] if names else []:
                yield {n: np.exp(-SMALL) * self.healthy[n] for n in some}, {}

    def draw(self, fault: Fault, rng: np.random.Generator) -> tuple[Change, Change] | None:
        """Values by path and errors by sensor of a fault; None where the machine has no such part."""
        size = float(np.exp(rng.uniform(np.log(max(fault.low, 1e-3)), np.log(fault.high))))
        if fault.pattern.startswith("sensor "):
            own = [s for s in self.sensors if s.kind == fault.pattern.split()[1]]
            return ({}, {str(rng.choice([s.name for s in own])): float(rng.choice([-1, 1])) * size}) if own else None
        names = [n for n in self.healthy if fnmatchcase(n, fault.pattern)]
        if fault.one and len(names) > 1 and rng.random() < 0.5:
            names = [str(rng.choice(names))]
        if not names:
            return None
        if fault.pattern == HEAT:
            return {names[0]: size * self.loss}, {}
        return {n: size * self.healthy[n] for n in names}, {}


def _course(point: tuple[float, float, float]) -> np.ndarray:
    """Along speed, load and room: what the factors of the true machine follow."""
    n, load_, room = point
    return np.sin(1.5 * np.array([2 * n - 1.35, 2 * load_ - 1.2, (room - 16.0) / 10.0]))


def _write_rig(path: Path, rng: np.random.Generator) -> str:
    """The rig file of a random name plate that `gearheat new` takes; returns what it is."""
    while True:
        stages = str(rng.choice(list(STAGES)))
        low, high = STAGES[stages]
        ratio = round(float(rng.uniform(low, high)) ** (stages.count(",") + 1), 2)
        power = f"{np.exp(rng.uniform(*np.log(POWERS))):.2f} kW"
        speed, oil, fan = f"{rng.choice(SPEEDS):g} rpm", str(rng.choice(OILS)), rng.random() < 0.5
        try:
            path.unlink(missing_ok=True)
            gearheat.new("machine", stages=stages, ratio=ratio, power=power, speed=speed, oil=oil, out=path)
        except ScenarioError:
            continue
        text = path.read_text("utf-8")
        for old, new in CHANGES.items():
            if text.count(old) == 1 and (fan or "T_input_Nm" in new):
                text = text.replace(old, new)
        path.write_text(text, "utf-8")
        return f"{stages} {ratio:g}, {power}, {speed}, {oil}{', fan' * fan}"


def make(
    build: Callable[[Path, np.random.Generator], Machine],
    number: int,
    seed: int,
    k: int,
    folder: Path,
    kind: str | None = None,
) -> dict[str, Any]:
    """Write one case and return its truth.

    Args:
        build: a machine on its bench from a rig file
        number: of the sheet
        seed, k: of the challenge, and number of the case
        folder: for the files; made if need be
        kind: one of `KINDS`; drawn if left out
    """
    case, rng = folder / "case", np.random.default_rng([seed, number, k])
    case.mkdir(parents=True, exist_ok=True)
    share = rng.random()
    kind = kind or ("clean" if share < CLEAN else "single" if share < CLEAN + SINGLE else "several")
    while True:
        try:
            plate = _write_rig(case / "machine.toml", rng)
            machine = build(case / "machine.toml", rng)
            number_of = 0 if kind == "clean" else 1 if kind == "single" else int(rng.integers(2, 5))
            faults, hidden, shown, effects = _hide(machine, number_of, rng)
            near = machine.distance(hidden, classes_of(f.cause for f in faults)) if faults else None
        except ArithmeticError:
            continue
        break
    sd = np.array([s.repeat_sd for s in machine.sensors])
    offsets = np.array([s.offset_sd for s in machine.sensors]) * rng.standard_normal(len(sd))
    noisy = shown + offsets + sd * rng.standard_normal(shown.shape)
    machine.write(case, noisy)
    thermal = [i for i, s in enumerate(machine.sensors) if s.name in ("T_oil", "T_wall")]
    change = [f"{machine.sensors[i].name}_K" for i in thermal]
    truth = {
        "schema": "gearheat.truth/1",
        "seed": seed,
        "case": k,
        "kind": kind,
        "causes": [f.cause for f in faults],
        "answer": sorted(classes_of(f.cause for f in faults)),
        "effects": [{"cause": f.cause, "snr": round(e, 2)} for f, e in zip(faults, effects, strict=True)],
        "rival": {"distance": round(near[0], 2), "cause": near[1]} if near else None,
        "impact": dict(zip(change, (shown - machine.sound)[machine.asked, thermal].mean(axis=0).tolist(), strict=True)),
        "repeat_sd": dict(zip(change, sd[thermal].tolist(), strict=True)),
        "points": [],
        "rig": {"name": str(case / "machine.toml"), "plate": plate},
    }
    (folder / "TRUTH.json").write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")
    return truth


def _hide(
    machine: Machine, n: int, rng: np.random.Generator
) -> tuple[list[Fault], list[tuple[Change, Change]], np.ndarray, list[float]]:
    """Faults of different classes, what they change, the readings, and by how many deviations each moves these."""
    changed, errors, faults, effects = dict[str, float](), dict[str, float](), list[Fault](), list[float]()
    hidden = list[tuple[Change, Change]]()
    shown = machine.sound
    for k in rng.permutation(len(FAULTS)):
        if len(faults) == n:
            break
        drawn = machine.draw(FAULTS[k], rng)
        if drawn is None or classes_of([FAULTS[k].cause]) & classes_of(f.cause for f in faults):
            continue
        moved = machine.read({**changed, **drawn[0]}, {**errors, **drawn[1]})
        effect = machine.hides(moved - shown)
        if effect is None:
            continue
        changed, errors, shown = {**changed, **drawn[0]}, {**errors, **drawn[1]}, moved
        faults.append(FAULTS[k])
        effects.append(effect)
        hidden.append(drawn)
    if len(faults) < n:
        raise ArithmeticError("too few faults show")
    return faults, hidden, shown, effects


def write_table(
    path: Path, sensors: Sequence[Sensor], table: np.ndarray, before: Sequence[Sequence[str]] | None = None
) -> None:
    """Readings as a table with the columns of the rig file, and a first column of its own if there is one."""
    shown = [[s.column for s in sensors]]
    shown += [[f"{as_shown(s, v):.4f}" for s, v in zip(sensors, row, strict=True)] for row in table]
    lines = [",".join([*first, *row]) for first, row in zip(before or [()] * len(shown), shown, strict=True)]
    path.write_text("\n".join(lines) + "\n", "utf-8")
