"""The rig with everything that may be wrong with it, compiled: slopes and Jacobians of its equations at many points.

CasADi functions are compiled to C for some rows side by side; records hold numbers and arrays as C reads them.
"""

from __future__ import annotations

import ctypes
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

from ....fmu import emit
from ....fmu.batch_library import address, instructions, load, widen
from ....model.core.flat import FlatModel
from ....model.core.flatten import flatten
from ....model.machines.spec import Spec, assemble
from ....model.parts.free_form import EXTRA_PARTS
from ....scenarios.nuisances import Nuisance
from ..library.cause import Form


def superset(spec: Spec, forms: Iterable[Form | Nuisance]) -> Spec:
    """The rig with the parts of all forms, neutral."""
    known = {part.name for part in spec.parts}
    for form in forms:
        added = [part for part in form.parts if part.name not in known]
        if added:
            own = {part.name for part in added}
            nets = [net for net in form.connections if any(port.partition(".")[0] in own for port in net)]
            spec = spec.with_parts(added, nets, EXTRA_PARTS)
            known |= own
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
        self.nx, self.nz = len(flat.states), len(flat.algebraic)
        self.p = flat.starts("parameter")
        self.place = {q.name: i for i, q in enumerate(flat.parameters)}
        self.u_place = {q.name: i for i, q in enumerate(flat.inputs)}
        self.u = flat.starts("input")
        self.scale = np.array([q.nominal for q in (*flat.states, *flat.algebraic)])
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
        self._compiled = Compiled([w, flat.u, flat.p], results)
        self.record = self._record(self._compiled)

    def _record(self, compiled: Compiled) -> Any:
        """The plant as the march through its runs knows it."""
        unknowns = (*self.flat.states, *self.flat.algebraic)
        (_, rates), (slopes,), (_,), shown, trials = compiled.patterns.values()
        patterns = [entries for pattern in (rates, slopes, *shown, *trials) for entries in pattern]
        return record(
            nx=self.nx,
            nw=self.nx + self.nz,
            nu=len(self.u),
            np=len(self.p),
            knobs=len(self.knobs),
            given=len(self.given),
            shown=len(self.shown),
            tried=len(self.tried),
            most=max(len(entries) for entries in patterns),
            **{name: compiled.place(name) for name in compiled.patterns},
            **{f"pattern{k}": entries for k, entries in enumerate(patterns)},
            scale=self.scale,
            guess=self.flat.starts("algebraic"),
            thermal=np.array([float(q.unit == "K") for q in unknowns]),
        )

    @staticmethod
    def of(
        spec: Spec,
        forms: Iterable[Form | Nuisance],
        knobs: Sequence[str],
        given: Sequence[str],
        shown: Sequence[str],
        tried: Sequence[str] = (),
    ) -> Plant:
        """The superset of a rig and some forms.

        Args:
            spec: the rig, driven as the campaign drives it
            forms: what may act in it, and nuisances that need parts
            knobs, given, shown, tried: see the class

        Raises:
            GearheatError: the superset has no sound equations
        """
        flat, own = flatten(assemble(superset(spec, forms))), {part.name for part in spec.parts}
        added = {q.name for q in flat.parameters if q.name.partition(".")[0] not in own}
        return Plant(_settled(flat, added - set(knobs)), knobs, given, shown, tried)


def _settled(flat: FlatModel, fixed: Collection[str]) -> FlatModel:
    """The model with parameters that nothing changes: 0 and 1 are numbers in it, and equal ones of a name are one."""
    first: dict[tuple[str, float], Any] = {}
    old, new = [], []
    for symbol, q in zip(ca.vertsplit(flat.p), flat.parameters, strict=True):
        if q.name in fixed:
            old.append(symbol)
            value = abs(q.start)
            new.append(
                ca.SX(q.start)
                if value in (0.0, 1.0)
                else first.setdefault((q.name.rpartition(".")[2], q.start), symbol)
            )
    parts = [flat.ode, flat.residual, flat.y]
    ode, residual, y = ca.substitute(parts, [ca.vertcat(*old)], [ca.vertcat(*new)]) if old else parts
    return replace(flat, ode=ode, residual=residual, y=y)


class Compiled:
    """Functions of the same symbolic columns in one library; their results hold the entries of sparse matrices only.

    Args:
        arguments: symbolic columns
        results: name of a function -> one or two expressions

    Raises:
        FmuError: the compiler fails
    """

    def __init__(self, arguments: Sequence[Any], results: Mapping[str, Sequence[Any]]) -> None:
        #: Of each function and result: where its columns begin (columns + 1), and the row of each entry.
        self.patterns = {name: [_pattern(r) for r in found] for name, found in results.items()}
        names, texts = [f"i{k}" for k in range(len(arguments))], []
        for name, found in results.items():
            outputs = [ca.SX(r).nz[:] for r in found] + [ca.SX(0, 1)] * (2 - len(found))
            function = ca.Function(name, list(arguments), outputs, names, ["first", "second"], {"cse": True})
            texts.append(emit.function(function, "lanes_", "lanes"))
            texts.append(f'__attribute__((visibility("default"))) void *const place_{name} = (void *)lanes_{name};')
        self._library = _loaded("\n".join(texts))

    def place(self, name: str) -> int:
        """Where a function lies in memory."""
        return ctypes.c_void_p.in_dll(self._library, f"place_{name}").value or 0


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
    """A structure of C with these fields, which keeps its arrays alive.

    Args:
        values: whole numbers, addresses among them, and arrays of eight bytes a number
    """
    kept = {name: v if isinstance(v, int) else np.ascontiguousarray(v) for name, v in values.items()}
    fields = [(name, ctypes.c_int64 if isinstance(v, int) else ctypes.c_void_p) for name, v in kept.items()]
    made = type("Record", (ctypes.Structure,), {"_fields_": fields})()
    for name, v in kept.items():
        setattr(made, name, v if isinstance(v, int) else address(v))
    made.arrays = tuple(kept.values())
    return made


def _pattern(matrix: Any) -> tuple[np.ndarray, np.ndarray]:
    sparsity = ca.SX(matrix).sparsity()
    return np.array(sparsity.colind(), dtype=np.int64), np.array(sparsity.row(), dtype=np.int64)
