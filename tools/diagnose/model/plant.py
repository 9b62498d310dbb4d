"""The rig with everything that may be wrong with it, compiled: slopes and Jacobians of its equations at many points.

CasADi functions are compiled to C for some rows side by side; records hold numbers and arrays as C reads them.
"""

from __future__ import annotations

import ctypes
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from importlib.resources import files
from itertools import islice
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

from ....fmu import emit
from ....fmu.batch_library import address, instructions, load, widen
from ....fmu.equations import hoist
from ....model.core.flat import FlatModel
from ....model.core.flatten import flatten
from ....model.machines.spec import PartSpec, Spec, assemble
from ....model.parts.free_form import EXTRA_PARTS

#: Parts that are added to a rig, and what they meet.
Added = tuple[Sequence[PartSpec], Sequence[tuple[str, ...]]]
#: Of a sparse matrix: where its columns begin (columns + 1), and the row of each entry.
Pattern = tuple[np.ndarray, np.ndarray]


def superset(spec: Spec, additions: Iterable[Added]) -> Spec:
    """The rig with all additions, neutral."""
    known = {part.name for part in spec.parts}
    for parts, nets in additions:
        if added := {part.name for part in parts} - known:
            joined = [net for net in nets if any(port.partition(".")[0] in added for port in net)]
            spec = spec.with_parts([part for part in parts if part.name in added], joined, EXTRA_PARTS)
            known |= added
    return spec


class Plant:
    """One rig, compiled.

    Args:
        flat: the superset
        knobs: parameters that anything changes, the columns of `slopes`
        given: inputs that sensors give, further columns of `slopes`
        shown: states, outputs or inputs that sensors read
        tried: the knobs that sizes of causes change, the only columns beside setting 0 of a march

    Raises:
        FmuError: the compiler fails
    """

    def __init__(
        self,
        flat: FlatModel,
        knobs: Sequence[str],
        given: Sequence[str],
        shown: Sequence[str],
        tried: Sequence[str] = (),
    ) -> None:
        self.flat, self.knobs, self.given, self.shown = flat, tuple(knobs), tuple(given), tuple(shown)
        self.tried = tuple(tried)
        self.p = flat.starts("parameter")
        self.place = {q.name: i for i, q in enumerate(flat.parameters)}
        self.u_place = {q.name: i for i, q in enumerate(flat.inputs)}
        self.u = flat.starts("input")
        w, both = ca.vertcat(flat.x, flat.z), ca.densify(ca.vertcat(flat.ode, flat.residual))
        by = ca.vertcat(*(flat.p[self.place[k]] for k in knobs), *(flat.u[self.u_place[g]] for g in given))
        sizes = ca.vertcat(*(flat.p[self.place[k]] for k in tried)) if tried else ca.SX(0, 1)
        groups = {"state": flat.x, "input": flat.u, "output": flat.y}
        found = [flat.locate(path) for path in shown]
        y = ca.densify(ca.vertcat(*(groups[kind][i] for kind, i in found)))
        results = {
            "rates": [both, ca.jacobian(both, w)],
            "slopes": [ca.jacobian(both, by)],
            "readings": [y],
            "reading_slopes": [ca.jacobian(y, w), ca.jacobian(y, by)],
            "trials": [ca.jacobian(both, sizes), ca.jacobian(y, sizes)],
        }
        self.record = self._record(*_compiled([w, flat.u, flat.p], results))

    def _record(self, sizes: Mapping[str, int], patterns_of: Sequence[Sequence[Pattern]]) -> Any:
        """The plant as the march through its runs knows it."""
        unknowns = (*self.flat.states, *self.flat.algebraic)
        (_, rates), (slopes,), (_,), shown, trials = patterns_of
        patterns = [entries for pattern in (rates, slopes, *shown, *trials) for entries in pattern]
        return record(
            nx=len(self.flat.states),
            nw=len(unknowns),
            nu=len(self.u),
            np=len(self.p),
            knobs=len(self.knobs),
            given=len(self.given),
            shown=len(self.shown),
            tried=len(self.tried),
            most=max(len(entries) for entries in patterns),
            **sizes,
            **{f"pattern{k}": entries for k, entries in enumerate(patterns)},
            scale=np.array([q.nominal for q in unknowns]),
            guess=self.flat.starts("algebraic"),
            thermal=np.array([float(q.unit == "K") for q in unknowns]),
        )


def with_additions(spec: Spec, additions: Iterable[Added], knobs: Collection[str]) -> FlatModel:
    """The equations of a rig, driven as the campaign drives it, with what causes and nuisances add.

    Of the values of the additions that are no knobs, 0 and 1 are numbers in it, and equal ones of a name are one.

    Raises:
        GearheatError: the superset has no sound equations
    """
    flat, own = flatten(assemble(superset(spec, additions))), {part.name for part in spec.parts}
    fixed = {q.name for q in flat.parameters if q.name.partition(".")[0] not in own} - set(knobs)
    first: dict[tuple[str, float], Any] = {}
    pairs = [(symbol, q) for symbol, q in zip(ca.vertsplit(flat.p), flat.parameters, strict=True) if q.name in fixed]
    if not pairs:
        return flat
    new = [
        ca.SX(q.start) if abs(q.start) in (0.0, 1.0) else first.setdefault((q.name.rpartition(".")[2], q.start), symbol)
        for symbol, q in pairs
    ]
    old = ca.vertcat(*(symbol for symbol, _ in pairs))
    ode, residual, y = ca.substitute([flat.ode, flat.residual, flat.y], [old], [ca.vertcat(*new)])
    return replace(flat, ode=ode, residual=residual, y=y)


def _compiled(
    arguments: Sequence[Any], results: Mapping[str, Sequence[Any]]
) -> tuple[dict[str, int], list[list[Pattern]]]:
    """Functions of the same symbolic columns in one library; their results hold the entries of sparse matrices only.

    Args:
        arguments: symbolic columns, the parameters last
        results: name of a function -> one or two expressions

    Returns:
        how many constants follow from the parameters, and where each function lies in memory, theirs among them; of
        each its results' patterns

    Raises:
        FmuError: the compiler fails
    """
    entries = [ca.vec(ca.SX(r).nz[:]) for found in results.values() for r in found]
    cut, symbols, constants = hoist(entries, arguments[-1])
    every, names, texts, rest = {"constants": [constants]}, ["i0", "i1", "i2", "i3"], [], iter(cut)
    every |= {name: list(islice(rest, len(found))) for name, found in results.items()}
    for name, found in every.items():
        outputs = [*found, *[ca.SX(0, 1)] * (2 - len(found))]
        function = ca.Function(name, [*arguments, symbols], outputs, names, ["first", "second"], {"cse": True})
        texts.append(emit.function(function, "lanes_", "lanes"))
        texts.append(f'__attribute__((visibility("default"))) void *const place_{name} = (void *)lanes_{name};')
    made = _loaded("\n".join(texts))
    places = {name: ctypes.c_void_p.in_dll(made, f"place_{name}").value or 0 for name in every}
    return {"nc": symbols.numel(), **places}, [[_pattern(r) for r in found] for found in results.values()]


@cache
def library() -> ctypes.CDLL:
    """The march through runs and the filter of logs, compiled."""
    sources = (Path(__file__).parent / name for name in ("march.c", "follow.c"))
    found = _loaded("\n".join(source.read_text(encoding="utf-8") for source in sources))
    pointer, count = ctypes.c_void_p, ctypes.c_int64
    found.march.argtypes = found.follow.argtypes = [*[pointer] * 3, *[count] * 2]
    return found


def _loaded(text: str) -> ctypes.CDLL:
    """A library whose text works on some rows side by side."""
    above = [f"#include <{name}.h>" for name in ("math", "stdint", "stdlib", "string")]
    lanes = (files("gearheat.fmu") / "wrapper" / "lanes.h").read_text(encoding="utf-8")
    return load(widen("\n".join([*above, lanes, text]), instructions()))


def record(**values: int | np.ndarray) -> Any:
    """A structure of C with these fields in this order, which keeps its arrays alive.

    Args:
        values: whole numbers, addresses among them, and arrays of eight bytes a number
    """
    kept = [v if isinstance(v, int) else np.ascontiguousarray(v) for v in values.values()]
    made: Any = (ctypes.c_int64 * len(kept))(*(v if isinstance(v, int) else address(v) for v in kept))
    made.arrays = kept
    return made


def _pattern(matrix: Any) -> Pattern:
    sparsity = ca.SX(matrix).sparsity()
    return np.array(sparsity.colind(), dtype=np.int64), np.array(sparsity.row(), dtype=np.int64)
