"""How steady outputs answer to parameters and inputs, exactly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import cast

import numpy as np

from ..core.flat import FlatModel
from ..errors import ScenarioError
from .point import point, problem_of
from .search import compiled
from .steady import equilibrium


def sensitivities(
    flat: FlatModel,
    outputs: Sequence[str],
    names: Sequence[str],
    values: Mapping[str, float],
    *,
    guess: Mapping[str, float] | None = None,
) -> np.ndarray:
    """d(output)/d(name) at a steady state, by the implicit function theorem.

    Args:
        flat: the model
        outputs: outputs and states, one row each
        names: parameters and inputs, one column each
        values: parameters and inputs by path (SI)
        guess: states to start from

    Raises:
        ScenarioError: unknown names, names of the wrong kind, values out of range
        SolveError: no steady state
    """
    problems = [problem_of(flat, name, ("output", "state"), "sensitivities") for name in outputs]
    problems += [problem_of(flat, name, ("parameter", "input"), "sensitivities") for name in names]
    if wrong := [problem for problem in problems if problem]:
        raise ScenarioError(wrong)
    here = point(flat, values, guess, who="sensitivities")
    at = equilibrium(flat, here, None, tuple(values), "sensitivities")
    n, m = len(at.w), len(outputs)
    _, slopes = compiled(flat, tuple(names), tuple(outputs))(at.x, at.z, here.u, here.p)
    jacobian = slopes.reshape(n + m, n + len(names))
    answer = np.linalg.solve(jacobian[:n, :n], -jacobian[:n, n:])
    return cast(np.ndarray, jacobian[n:, n:] + jacobian[n:, :n] @ answer)
