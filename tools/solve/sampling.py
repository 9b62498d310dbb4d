"""What a sweep varies, as a user writes it, and the values of its rows: a grid, a Latin hypercube, or chance.

carrier.tau=500..2700 N.m       uniform between two values
carrier.tau=500,900,2700 N.m    these values
cooling.A~normal(0.8, 0.05) m2  normal with mean and standard deviation
uncertainty                     all that is uncertain: by its file, and groups of parameters by what parts are
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ...fmu.leading import Uncertain, Uncertainty
from ...fmu.variables import Variable
from ...model.core.flat import FlatModel, Quantity
from ...model.errors import Problems, ScenarioError
from ...model.machines.roles import Roles
from ...model.units import from_si, show_unit, to_si
from ...scenarios.nuisances import nuisances
from ...scenarios.scenario import Scenario
from ...scenarios.values import in_range
from .steady import leading_outputs

#: Rows of the largest sweep that is not taken for a slip of the keyboard.
MOST_ROWS = 100_000_000

_UNIFORM = re.compile(r"\s*([^=~\s]+)\s*=\s*(.+?)\s*\.\.\s*(.+?)\s*")
_NORMAL = re.compile(r"\s*([^=~\s]+)\s*~\s*normal\(\s*([^,()]+?)\s*,\s*([^,()]+?)\s*\)\s*(.*?)\s*")
_BARE = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
#: Stands on the command line for all uncertain parameters of a rig.
UNCERTAINTY = "uncertainty"


@dataclass(frozen=True)
class Written:
    """One quantity that is varied, as written: a name, two numbers and a unit, or all values."""

    name: str
    kind: Literal["uniform", "normal", "values"]
    first: str
    second: str
    values: tuple[str, ...] = ()


@dataclass(frozen=True)
class Axis:
    """One quantity that is varied (SI): uniform from `first` to `second`, or normal with that mean and deviation.

    Of a lognormal one they are the median and, in its unit, what one standard deviation of the logarithm changes it by.
    Of given values they are the least and the largest.
    """

    name: str
    kind: Literal["uniform", "normal", "lognormal", "values"]
    first: float
    second: float
    values: tuple[float, ...] = ()

    def at(self, share: np.ndarray) -> np.ndarray:
        """Values below which the shares (0 ... 1) of all values lie; of given values, in their order."""
        if self.kind == "values":
            place = np.minimum(share * len(self.values), len(self.values) - 1).astype(int)
            return np.asarray(np.array(self.values)[place])
        if self.kind == "uniform":
            return np.asarray(self.first + share * (self.second - self.first))
        from scipy.special import ndtri

        change = self.second * ndtri(share)
        if self.kind == "lognormal":
            return np.asarray(self.first * np.exp(change / self.first))
        return np.asarray(self.first + change)


def read(texts: Sequence[str]) -> tuple[Written, ...]:
    """What is varied.

    Raises:
        ScenarioError: all texts that cannot be read, and names given twice
    """
    found: list[Written] = []
    problems = Problems()
    for text in texts:
        if (match := _NORMAL.fullmatch(text)) is not None:
            name, mean, deviation, unit = match.groups()
            found.append(Written(name, "normal", f"{mean} {unit}".strip(), f"{deviation} {unit}".strip()))
        elif (match := _UNIFORM.fullmatch(text)) is not None:
            name, low, high = match.groups()
            unit = re.sub(_BARE, "", high, count=1).strip()
            low = f"{low} {unit}".strip() if _BARE.fullmatch(low) else low
            found.append(Written(name, "uniform", low, high))
        elif lists(text):
            name, _, written = (part.strip() for part in text.partition("="))
            values = [part.strip() for part in written.split(",") if part.strip()]
            unit = re.sub(_BARE, "", values[-1], count=1).strip()
            values = [f"{value} {unit}".strip() if _BARE.fullmatch(value) else value for value in values]
            found.append(Written(name, "values", values[0], values[-1], tuple(values)))
        else:
            problems.append(
                f'--vary "{text}" is no range. Write NAME=LOW..HIGH with a unit, for example "room.T=10..35 degC",\n'
                'or NAME~normal(MEAN, DEVIATION), for example "cooling.A~normal(0.8, 0.05) m2".'
            )
    names = [w.name for w in found]
    problems += [f'--vary: "{n}" is varied twice. Give it once.' for n in dict.fromkeys(names) if names.count(n) > 1]
    if not texts:
        problems.append('--vary is missing. Say what is varied, for example --vary "room.T=10..35 degC".')
    problems.check()
    return tuple(found)


def lists(text: str) -> bool:
    """Whether a text gives values one by one: NAME=VALUE,VALUE."""
    name, equals, values = text.partition("=")
    return bool(
        name.strip() and equals and "," in values and values.strip(" ,") and ".." not in values and "~" not in name
    )


def axes(written: Sequence[Written], known: Mapping[str, Quantity]) -> tuple[Axis, ...]:
    """The axes of a sweep in SI.

    Args:
        written: what is varied
        known: the quantity of every name

    Raises:
        ScenarioError: wrong units, values out of range, ranges that are none
    """
    found: list[Axis] = []
    problems = Problems()
    for w in written:
        with problems:
            found.append(_axis(w, known[w.name]))
    problems.check()
    return tuple(found)


def _axis(w: Written, quantity: Quantity) -> Axis:
    where = f"--vary {w.name}"
    if w.kind == "values":
        for text in w.values:
            in_range("--vary ", text, quantity)
        values = tuple(to_si(text, quantity.unit, name=where) for text in w.values)
        if len(set(values)) < len(values):
            raise ScenarioError(f"{where}: a value is there twice. Give each once.")
        return Axis(w.name, w.kind, min(values), max(values), values)
    first = to_si(w.first, quantity.unit, name=where)
    second = to_si(w.second, quantity.unit, name=where)
    if w.kind == "normal":
        second -= to_si(f"0 {w.second.partition(' ')[2]}".strip(), quantity.unit, name=where)  # a difference
        if not second > 0:
            raise ScenarioError(f"{where}: the deviation {w.second} is not above 0. Give a larger one.")
    elif not second > first:
        raise ScenarioError(f"{where}: {w.first} is not below {w.second}. Write LOW..HIGH.")
    for text in (w.first,) if w.kind == "normal" else (w.first, w.second):
        in_range("--vary ", text, quantity)
    return Axis(w.name, w.kind, first, second)


def draw_sample(axes: Sequence[Axis], rows: int, method: str, seed: int) -> np.ndarray:
    """Values of a random sample, the same for the same seed (rows, axes).

    Args:
        method: "lhs" (Latin hypercube: each axis is cut into as many slices as there are rows, one row in each) or
            "monte-carlo"

    Raises:
        ScenarioError: the number of rows or the seed is out of range
    """
    _check(rows, "--sample")
    if seed < 0:
        raise ScenarioError(f"--seed {seed} is negative. Give 0 or more.")
    random = np.random.default_rng(seed)
    if method == "lhs":
        from scipy.stats import qmc

        shares = qmc.LatinHypercube(len(axes), seed=random).random(rows)
    else:
        shares = random.random((rows, len(axes)))
    shares = np.clip(shares, np.finfo(float).tiny, 1.0 - np.finfo(float).epsneg)  # 0 and 1 have no normal value
    return np.column_stack([axis.at(shares[:, k]) for k, axis in enumerate(axes)])


def lay_grid(axes: Sequence[Axis], text: str) -> np.ndarray:
    """Values of a grid such as "20x10" (rows, axes), the last axis running fastest.

    A uniform axis goes from end to end, a normal one through the middles of slices of equal probability; given values
    are taken as they are, and need no number.

    Raises:
        ScenarioError: no grid, or not one number per axis
    """
    written = re.split(r"\s*[xX*]\s*", text.strip()) if text else []
    told = [int(n) for n in written if n.isdecimal()]
    if len(told) != len(written) or min(told, default=1) < 1:
        raise ScenarioError(f'--grid "{text}" is no grid. Write whole numbers above 0, for example 20x10.')
    ranges = [axis.name for axis in axes if axis.kind != "values"]
    if len(told) != len(ranges):
        names = ", ".join(ranges) or "none: their values are given"
        raise ScenarioError(f"--grid {text}: {len(told)} numbers for {len(ranges)} ranges ({names}). Give one each.")
    left = iter(told)
    counts = [len(axis.values) or next(left) for axis in axes]
    _check(int(np.prod([float(n) for n in counts])), "--grid")
    lines = [
        axis.at(np.linspace(0.0, 1.0, n) if axis.kind == "uniform" and n > 1 else (np.arange(n) + 0.5) / n)
        for axis, n in zip(axes, counts, strict=True)
    ]
    return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, len(axes))


def _check(rows: int, option: str) -> None:
    if not 1 <= rows <= MOST_ROWS:
        raise ScenarioError(f"{option}: {rows} rows. Give at least 1 and at most {MOST_ROWS}.")


def describe_axis(axis: Axis, quantity: Quantity) -> dict[str, object]:
    """An axis for a summary, in the unit shown to a person."""
    if axis.kind == "values":
        shown = [float(from_si(value, quantity.unit)) for value in axis.values]
        return {"kind": axis.kind, "values": shown, "unit": show_unit(quantity.unit)}
    first = from_si(axis.first, quantity.unit)
    second = from_si(axis.second, quantity.unit)
    if axis.kind != "uniform":
        second -= from_si(0.0, quantity.unit)
    words = {"uniform": ("low", "high"), "normal": ("mean", "deviation"), "lognormal": ("median", "deviation")}[
        axis.kind
    ]
    return {"kind": axis.kind, words[0]: first, words[1]: second, "unit": show_unit(quantity.unit)}


def reasons(scenario: Scenario, flat: FlatModel, given: Collection[str] = ()) -> tuple[Uncertainty, ...]:
    """Why results of a rig are uncertain, each reason independent of the others.

    A value with an uncertainty in the rig file stands for itself, values that it states as uncertain together stand
    together. All others differ by groups, as in a diagnosis before it has seen data.

    Args:
        scenario: the rig
        flat: its model
        given: paths of values that are certain, as they are given otherwise

    Raises:
        ScenarioError: nothing is uncertain
    """
    alone = {path: {path: sd} for path, sd in scenario.uncertainties.items() if sd > 0}
    stated = {path for path, sd in scenario.standard_uncertainties.items() if sd > 0}
    values = {q.name: q.start for q in (*flat.parameters, *flat.states) if q.name not in given}
    found = []
    for name, changes in (*alone.items(), *scenario.joint_uncertainties.items()):
        if known := {path: change for path, change in changes.items() if path in values}:
            found.append(Uncertainty(name, known))
    for group in nuisances(Roles.of(scenario.spec), {}, {}):
        paths = {path: share for path, share in group.paths.items() if path in values and path not in stated}
        changes = {path: share * group.sd * values[path] for path, share in paths.items()}
        if any(changes.values()):
            found.append(Uncertainty(group.name, changes))
    if not found:
        raise ScenarioError(
            f"{scenario.name}: no parameter of this rig is uncertain. State an uncertainty in a part,\n"
            'for example uncertainties = { G = "0.19 W/K" }.'
        )
    return tuple(found)


def shares(found: Sequence[Uncertainty]) -> tuple[Axis, ...]:
    """One standard normal number for each reason."""
    return tuple(Axis(reason.name, "normal", 0.0, 1.0) for reason in found)


def draw_values(
    found: Sequence[Uncertainty], flat: FlatModel, sizes: np.ndarray
) -> tuple[tuple[Axis, ...], np.ndarray]:
    """Values of all uncertain parameters, none beyond the range of its parameter.

    Their logarithms are normal, as in a diagnosis before it has seen data; a parameter that is zero is normal itself.

    Args:
        found: the reasons
        flat: the model
        sizes: of each reason in standard deviations (rows, reasons)

    Returns:
        an axis of each parameter, with its standard deviation, and the values (rows, parameters)
    """
    paths = list(dict.fromkeys(path for reason in found for path in reason.changes))
    changes = np.array([[reason.changes.get(path, 0.0) for path in paths] for reason in found])
    quantities = [flat.quantity(path) for path in paths]
    starts = np.array([q.start for q in quantities])
    scale = np.where(starts, starts, 1.0)
    moved = sizes @ (changes / scale)
    values = scale * np.where(starts, np.exp(moved), moved)
    ends = [Variable(0, "parameter", q).bounds for q in quantities]
    deviations = np.hypot.reduce(changes, axis=0)
    axes = tuple(
        Axis(q.name, "lognormal" if q.start else "normal", q.start, float(sd))
        for q, sd in zip(quantities, deviations, strict=True)
    )
    return axes, np.clip(values, *np.array(ends).T)


def collect_uncertain(scenario: Scenario, flat: FlatModel) -> Uncertain:
    """What an FMU of a rig needs for its standard deviations: of temperatures, and of the loss and the efficiency.

    Args:
        scenario: the rig
        flat: its model

    Raises:
        ScenarioError: nothing is uncertain
    """
    shown = [q.name for q in flat.states] + leading_outputs(scenario)
    return Uncertain(reasons(scenario, flat), tuple(dict.fromkeys(name for name in shown if name in flat.index)))
