"""The rig with everything that may be wrong with it, compiled: slopes and Jacobians of its equations at many points."""

from __future__ import annotations

import ctypes
from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np

from ....fmu.batch_library import address
from ....model.core.flat import FlatModel
from ....model.core.flatten import flatten
from ....model.errors import FmuError
from ....model.machines.spec import Spec, assemble
from ....model.parts.free_form import EXTRA_PARTS
from ....scenarios.nuisances import Nuisance
from ..library.cause import Form
from .many import Compiled, library, record


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

    def rates(self, w: np.ndarray, u: np.ndarray, p: np.ndarray) -> list[np.ndarray]:
        """Rates of the states and residuals, and their Jacobian in w, at n points, a row each."""
        return self._many("rates", w, u, p)

    def slopes(self, w: np.ndarray, u: np.ndarray, p: np.ndarray) -> list[np.ndarray]:
        """Derivatives of rates and residuals by knobs and given inputs."""
        return self._many("slopes", w, u, p)

    def readings(self, w: np.ndarray, u: np.ndarray, p: np.ndarray) -> list[np.ndarray]:
        """What is shown."""
        return self._many("readings", w, u, p)

    def reading_slopes(self, w: np.ndarray, u: np.ndarray, p: np.ndarray) -> list[np.ndarray]:
        """What is shown, its derivatives in w, and by knobs and given inputs."""
        return [*self.readings(w, u, p), *self._many("reading_slopes", w, u, p)]

    def _many(self, name: str, *points: np.ndarray) -> list[np.ndarray]:
        given = [np.ascontiguousarray(v, dtype=float) for v in points]
        found = [np.empty((len(given[0]), len(row))) for _, row in self._compiled.patterns[name]]
        pairs = [(address(r), r.shape[1]) for r in (*found, np.empty((1, 0)))[:2]]
        places = [address(v) for v in given]
        record = ctypes.byref(self.record)
        if not library().many(record, self._compiled.place(name), len(given[0]), *places, *pairs[0], *pairs[1]):
            raise FmuError("there is not enough memory for the points. Give fewer at a time.")
        return self._compiled.dense(name, *found)

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
