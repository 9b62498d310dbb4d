"""Where a flat model is evaluated: values by path become vectors, with every problem reported at once."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from ..core.flat import FlatModel
from ..errors import ScenarioError, suggestion

#: What each kind of quantity is called in a message.
WORDS = {"state": "a state", "input": "an input", "parameter": "a parameter", "output": "an output"}


@dataclass(frozen=True)
class Point:
    """States, inputs and parameters of a flat model, in the order of its quantities, SI."""

    x: np.ndarray
    u: np.ndarray
    p: np.ndarray


def point(
    flat: FlatModel,
    values: Mapping[str, float] | None = None,
    states: Mapping[str, float] | None = None,
    *,
    who: str,
    taken: Iterable[str] = (),
) -> Point:
    """Vectors from values by path; what is not named keeps the model's own value.

    Args:
        flat: the model
        values: parameters and constant inputs by path
        states: states by path
        who: the run that asks, for messages
        taken: inputs that are given elsewhere

    Raises:
        ScenarioError: all unknown names, names of the wrong kind, doubled and out-of-range values at once; all
            relations between parameters that do not hold
    """
    vectors = {kind: flat.starts(kind) for kind in ("state", "input", "parameter")}
    taken = set(taken)
    problems = []
    for group, allowed in ((values or {}, ("parameter", "input")), (states or {}, ("state",))):
        for name, value in group.items():
            if (problem := problem_of(flat, name, allowed, who, value)) is not None:
                problems.append(problem)
            elif name in taken:
                problems.append(f"{who}: {name} is given twice: by the duty and as a value. Take one away.")
            else:
                kind, i = flat.index[name]
                vectors[kind][i] = value
    problems = problems or [f"{who}: {told}" for told in flat.contradictions(vectors["parameter"]).values()]
    if problems:
        raise ScenarioError(problems)
    return Point(vectors["state"], vectors["input"], vectors["parameter"])


def problem_of(
    flat: FlatModel, name: str, allowed: tuple[str, ...], who: str, value: float | None = None
) -> str | None:
    """What is wrong with a name where certain kinds are allowed, or with its value; None if nothing is.

    Args:
        flat: the model
        name: path of a quantity
        allowed: kinds: "state", "input", "parameter", "output"
        who: who asks, for the message
        value: in SI; only the name is judged when None
    """
    if name not in flat.index:
        known = [n for n, (kind, _) in flat.index.items() if kind in allowed]
        return f'{who}: unknown name "{name}".{suggestion(name, known)}'
    kind, _ = flat.index[name]
    if name in flat.derived and kind not in allowed:
        return f"{who}: {follows(flat, name)}"
    if kind not in allowed:
        expected = " or ".join(WORDS[k] for k in allowed)
        joined = next((f" ({text})" for text in flat.joined if text.startswith(f"{name} ")), "")
        return f"{who}: {name} is {WORDS[kind]} of {flat.name}{joined}. Expected {expected}."
    if value is None:
        return None
    problem = flat.quantity(name).problem(value)
    return problem and f"{who}: {problem}"


def follows(flat: FlatModel, name: str) -> str:
    """What a user reads who sets a parameter that follows from others.

    Args:
        flat: the model
        name: path of a derived parameter
    """
    own = name.rpartition(".")[0] + "."
    known = ", ".join(path.removeprefix(own) for path in flat.derived[name])
    return f"{name} follows from {known}. Change these, or give {name} a value of its own in the rig file."
