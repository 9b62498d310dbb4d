"""Whether a cause does what a cause has to: forms that share its prior, formulas that change nothing at size zero."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from ....model.core.declare import Parameter, list_declared
from ....model.errors import suggestion
from ....model.machines.spec import Spec
from ....model.parts.free_form import EXTRA_PARTS
from ....scenarios.measured.table import Sensor
from .cause import Cause, Form, Ranges, Row, as_array

#: Accuracy to which a form has to leave things as they are at size zero, relative.
NEUTRAL = 1e-6


class _Known(dict[str, float]):
    """Values by name; one that is asked for and is not there is told by name."""

    def __init__(self, what: str, values: Mapping[str, float]) -> None:
        super().__init__(values)
        self.what = what

    def __missing__(self, name: str) -> float:
        raise KeyError(f'{self.what} "{name}" does not exist.{suggestion(name, self)}')


def problems(cause: Cause, spec: Spec, sensors: Sequence[Sensor], ranges: Ranges) -> list[str]:
    """What is wrong with a cause, all at once."""
    size = cause.size
    found = []
    if not size.low <= 0 <= size.high or size.low == size.high:
        found.append(
            f"size {size.name} goes from {size.low:g} to {size.high:g}. Zero, which is none, must lie between."
        )
    if not size.sd > 0:
        found.append(f"size {size.name} has the prior half width {size.sd:g}. Give one above 0.")
    total = sum(form.weight for form in cause.forms)
    if abs(total - 1) > NEUTRAL:
        found.append(f"the weights of its {len(cause.forms)} forms add up to {total:g}. Make it 1.")
    names = [form.name for form in cause.forms]
    if twice := {name for name in names if names.count(name) > 1}:
        found.append(f"several forms are named {', '.join(map(repr, sorted(twice)))}. Give each its own name.")
    stated = parameters(spec)
    for form in cause.forms:
        found += [f"form {form.name!r}: {problem}" for problem in _of_form(cause, form, spec, stated, sensors, ranges)]
    return [f"cause {cause.id}: {problem}" for problem in found]


def parameters(spec: Spec) -> dict[str, float]:
    """Path -> value of all parameters that a rig file states or that have a default."""
    values: dict[str, float] = {}
    for part in spec.parts:
        for key, d in list_declared(spec.types[part.type], Parameter).items():
            value = part.values.get(key, d.default)
            if isinstance(value, (int, float)):
                values[f"{part.name}.{key}"] = float(value)
    return values


def _of_form(
    cause: Cause, form: Form, spec: Spec, stated: Mapping[str, float], sensors: Sequence[Sensor], ranges: Ranges
) -> Iterator[str]:
    """What is wrong with a form: it cannot be evaluated, or acts at size zero."""
    wide = spec.with_parts(form.parts, form.connections, EXTRA_PARTS)
    if unknown := [part.type for part in form.parts if part.type not in wide.types]:
        yield f"there is no part type {', '.join(unknown)}.{suggestion(unknown[0], wide.types)}"
        return
    added = {f"{part.name}.{key}": value for part in form.parts for key, value in part.values.items()}
    base = _Known("parameter", {**stated, **added})
    shown = _Known("sensor", {s.name: ranges.mid.get(s.name, 300.0) for s in sensors})
    read = _Known("compared sensor", {s.name: shown[s.name] for s in sensors if s.role == "read"})
    theta = {cause.size_of(form).name: 0.0} | {shape.name: float(shape.at(0.0)) for shape in form.shapes}
    row = Row(base=base, sensors=shown, order=0.5, direction=1.0, rise=ranges.rise, dwell=7200.0)
    own = {part.name for part in form.parts}
    laws: list[tuple[Callable[..., Any] | None, tuple[Any, ...], Mapping[str, float]]] = [
        (form.values, (theta, row), base),
        (form.truth, (theta, row), shown),
        (form.shown, (theta, row, read), read),
        (form.pace, (theta, row), {"pace": 1.0}),
    ]
    if all(law is None for law, _, _ in laws):
        yield "it says nothing. Give it values, truth, shown or pace."
    for law, given, before in laws:
        if law is not None:
            yield from _neutral(partial(law, *given), before, own)


def _neutral(formula: Callable[[], Any], before: Mapping[str, float], own: set[str]) -> Iterator[str]:
    """What a formula changes at size zero, but for values of the parts that the form adds."""
    try:
        found = formula()
        for name, value in (found if isinstance(found, Mapping) else {"pace": found}).items():
            was = before[name]
            if name.partition(".")[0] in own:
                continue
            now = float(as_array(value, 1)[0])
            if not np.isclose(now, was, rtol=NEUTRAL, atol=NEUTRAL):
                yield f"{name} is {now:g} instead of {was:g} at size zero. Nothing may change there."
    except KeyError as error:
        yield str(error.args[0])
    except Exception as error:  # a user's formula may fail in any way
        yield f"its formula fails: {type(error).__name__}: {error}."
