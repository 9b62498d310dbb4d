"""The directions in which uncertain parameters move the results most."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..model.core.flat import FlatModel
from ..model.errors import FmuError, SolveError
from ..model.run.algebra import algebra
from ..model.run.schedule import Schedule
from ..model.run.simulate import simulate
from .description import EXPERIMENT
from .equations import Equations
from .sensitivity import Sensitivities
from .variables import Table, Variable

#: Share by which a standard deviation may come out too small for the directions left out.
SHORTFALL = 0.01
#: Intervals of the run in which the directions are weighed, each longer than the one before by one factor.
_INTERVALS = 80
#: End of the first interval, as a share of the run: fast states settle early.
_FIRST = 1e-4
#: Digits of a direction: what follows is round-off, which differs between machines.
_DIGITS = 9


@dataclass(frozen=True)
class Uncertainty:
    """One reason why results are uncertain, independent of all others.

    Attributes:
        name: in words
        changes: path of a parameter, or of a state for its start -> what it changes by at one standard deviation (SI)
    """

    name: str
    changes: Mapping[str, float]


@dataclass(frozen=True)
class Uncertain:
    """What an FMU with standard deviations is asked for.

    Attributes:
        reasons: why results are uncertain
        shown: states and outputs that get a standard deviation
    """

    reasons: tuple[Uncertainty, ...]
    shown: tuple[str, ...]


@dataclass(frozen=True)
class Directions:
    """The leading directions of some uncertainties, independent of each other: one standard deviation along each.

    Attributes:
        parameters: change of the parameters along each direction (parameters, directions)
        states: change of the states' starts (states, directions)
        reasons: what they combine
        shortfall: share by which a standard deviation comes out too small for what is left out, at most, at any time of
            the default experiment; None where that run fails and nothing is left out
    """

    parameters: np.ndarray
    states: np.ndarray
    reasons: tuple[Uncertainty, ...]
    shortfall: float | None

    @property
    def count(self) -> int:
        """How many directions there are."""
        return int(self.parameters.shape[1])

    @property
    def moving(self) -> tuple[int, ...]:
        """Positions of the parameters that some direction moves."""
        return tuple(np.flatnonzero(self.parameters.any(axis=1)).tolist())


def locate_deviations(table: Table) -> tuple[int, ...]:
    """Positions, among the states and behind them the outputs, of what has a standard deviation.

    Args:
        table: the variables
    """
    states, inputs = len(table.of("state")), len(table.of("input"))
    places = [v.of for v in table.of("deviation") if v.of is not None]
    return tuple(place if place < states else place - inputs for place in places)


def leading(flat: FlatModel, model: Equations, table: Table, reasons: tuple[Uncertainty, ...]) -> Directions:
    """The fewest directions that show the standard deviations.

    The sensitivities to all uncertainties are integrated over the default experiment, at the inputs' start values.
    Their singular vectors are the directions; each deviation counts alike at each time.

    Args:
        flat: the model, with the parameters of the FMU
        model: its equations
        table: its variables with their start values
        reasons: what is uncertain

    Raises:
        FmuError: none of it moves a parameter or a state of the model
    """
    parameters, states = table.of("parameter"), table.of("state")[: len(flat.states)]
    known = {v.name for v in (*parameters, *states)}
    reasons = tuple(r for r in reasons if any(change and path in known for path, change in r.changes.items()))
    if not reasons:
        raise FmuError(f"{flat.name}: no parameter with an uncertainty has an effect: no standard deviations.")
    full = Directions(_changes(parameters, reasons), _changes(states, reasons), reasons, None)
    try:
        slopes = _slopes(flat, model, table, full)
    except SolveError:
        return full
    deviations = np.sqrt((slopes**2).sum(axis=2))  # (times, shown)
    scaled = slopes / np.maximum(deviations, 1e-300)[:, :, None]
    turned = np.linalg.svd(scaled.reshape(-1, full.count), full_matrices=False)[2].T
    short = 1 - np.sqrt(np.cumsum((scaled @ turned) ** 2, axis=2)[deviations > 0].min(axis=0))
    count = int(np.argmax(short <= SHORTFALL)) + 1
    kept = turned[:, :count]
    kept = kept * np.sign(kept[np.abs(kept).argmax(axis=0), range(count)])  # either sign would do
    return Directions(
        _round(full.parameters @ kept), _round(full.states @ kept), reasons, max(float(short[count - 1]), 0.0)
    )


def _changes(variables: Sequence[Variable], reasons: Sequence[Uncertainty]) -> np.ndarray:
    """Change of each variable for each reason (variables, reasons)."""
    changes = [[r.changes.get(v.name, 0.0) for r in reasons] for v in variables]
    return np.array(changes).reshape(len(variables), len(reasons))


def _round(matrix: np.ndarray) -> np.ndarray:
    return np.array([[float(f"{value:.{_DIGITS}g}") for value in row] for row in matrix]).reshape(matrix.shape)


def _slopes(flat: FlatModel, model: Equations, table: Table, full: Directions) -> np.ndarray:
    """What is shown along each direction over the default experiment (times, shown, directions)."""
    stop = float(EXPERIMENT["stopTime"])
    edges = np.append(0.0, stop * np.geomspace(_FIRST, 1.0, _INTERVALS))
    times = np.sort(np.append(edges, (edges[1:] + edges[:-1]) / 2))
    values = {v.name: v.start or 0.0 for kind in ("input", "parameter") for v in table.of(kind)}
    states = {v.name: v.start or 0.0 for v in table.of("state")[: len(flat.states)]}
    u, p = (np.array([v.start or 0.0 for v in table.of(kind)]) for kind in ("input", "parameter"))
    run = simulate(flat, Schedule(np.array([0.0, stop]), {}), start=states, values=values, times=times)
    x = np.array([run[name] for name in states])
    z = algebra(flat).solve_rows(x, np.tile(u[:, None], len(times)), np.tile(p[:, None], len(times)), None)
    x = np.vstack([x, np.zeros((2 * table.audit, len(times)))])
    linear = Sensitivities(model, full.count, full.moving, locate_deviations(table))
    c = model.constants(p)
    p_dot, s = full.parameters, full.states
    c_dot = np.hstack([model.constants_directional(p, column).full() for column in p_dot.T])
    rows = []
    for k, length in enumerate(np.diff(edges)):
        middle, end = 2 * k + 1, 2 * k + 2
        s = linear.move(x[:, middle], z[:, middle], u, p, c, p_dot, c_dot, length, s).full()
        rows.append(linear.slopes(x[:, end], z[:, end], u, p, c, p_dot, c_dot, s).full())
    return np.array(rows)
