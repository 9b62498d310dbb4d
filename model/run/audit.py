"""What every result is judged by: outputs in their ranges, implicit equations that hold, energy that is conserved."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from ..core.flat import FlatModel
from ..units import text
from .result import Audit

#: Round-off allowed at the ends of a range, relative to value and nominal.
SLACK = 1e-9

#: Violation of the energy balance that is an error, over the throughput.
ENERGY = 1e-6
#: The same over the tolerance of an integration, where that is more: errors of its steps add up.
ENERGY_BY_TOLERANCE = 100.0

#: What an implicit equation may leave, in units of its variable's nominal.
LEFT = 1e-6


def out_of_range(flat: FlatModel, columns: Mapping[str, np.ndarray]) -> Iterator[str]:
    """What is wrong with the outputs that leave their declared range, the worst row of each, in words.

    Args:
        flat: the model
        columns: path of an output -> its values over the rows, SI
    """
    for q in flat.outputs:
        values = columns[q.name]
        slack = SLACK * (q.nominal + np.abs(values))
        excess = np.maximum(q.low - values, values - q.high)
        row = int(np.argmax(np.where(np.isnan(excess), np.inf, excess)))
        if excess[row] <= slack[row]:
            continue
        part = q.name.rpartition(".")[0]
        if q.refusal:
            at_worst = np.array([columns[o.name][row] for o in flat.outputs])
            yield f"{part}: {q.refusal.format(**words(flat, part, at_worst))}"
        else:
            yield str(q.problem(float(values[row])))


def words(flat: FlatModel, part: str, y: np.ndarray, digits: int = 6) -> dict[str, str]:
    """The outputs of a part as a person reads them, by key.

    Args:
        flat: the model
        part: path of the part
        y: all outputs of the model at one point, SI
        digits: significant digits to write
    """
    of_part = [(q, value) for q, value in zip(flat.outputs, y, strict=True) if q.name.rpartition(".")[0] == part]
    return {q.name.rpartition(".")[2]: text(float(value), q.unit, digits) for q, value in of_part}


def list_unsolved(implicit: Mapping[str, float]) -> Iterator[str]:
    """The implicit equations that do not hold, in words.

    Args:
        implicit: largest scaled residual of each equation
    """
    for name, residual in implicit.items():
        if not residual <= LEFT:
            yield f'the equation "{name}" leaves {residual:.2g} of its typical size. Check the values of that part.'


def imbalance(
    flat: FlatModel, evaluated: Mapping[str, np.ndarray], audit: Audit, tolerance: float = 0.0
) -> Iterator[str]:
    """What is wrong with the energy of a run, in words: the part that makes or loses most of it.

    Args:
        flat: the model
        evaluated: what `rows.evaluate` found
        audit: energy of the whole run
        tolerance: of the integration
    """
    if audit.residual <= max(ENERGY, ENERGY_BY_TOLERANCE * tolerance):
        return
    who = "no part makes or loses power, so the integration does: use a tighter tolerance"
    power = evaluated["imbalance"]
    if power.size:
        worst, row = np.unravel_index(int(np.nanargmax(np.abs(power))), power.shape)
        made = float(power[worst, row])
        if abs(made) > ENERGY * max(float(evaluated["throughput"][0, row]), 1e-3):
            does = "takes in" if made > 0 else "gives off"
            who = f"{flat.balanced[worst]} {does} {abs(made):.4g} W more than it accounts for"
    yield f"energy is not conserved: {audit.residual:.2g} of the throughput is missing; {who}."
