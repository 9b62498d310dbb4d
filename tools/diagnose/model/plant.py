"""The rig with everything that may be wrong with it, compiled: slopes and Jacobians of its equations at many points."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from ...model.core.flat import FlatModel
from ...model.core.flatten import flatten
from ...model.machines.spec import Spec, assemble
from ..library.cause import Form, Nuisance
from ..library.extra_parts import EXTRA_PARTS
from .many import Many, Slow


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


@dataclass(frozen=True)
class Point:
    """Unknowns w = (states, algebraic variables), inputs and parameters at n points, a row each."""

    w: np.ndarray
    u: np.ndarray
    p: np.ndarray


class Plant:
    """One rig, compiled.

    Args:
        flat: the superset
        knobs: parameters that anything changes, the columns of `slopes`
        given: inputs that sensors give, further columns of `slopes`
        shown: states, outputs or inputs that sensors read
        compiled: whether its functions are compiled to C, which pays where they are used often
    """

    def __init__(
        self,
        flat: FlatModel,
        knobs: Sequence[str],
        given: Sequence[str],
        shown: Sequence[str],
        *,
        compiled: bool = True,
    ) -> None:
        self.flat, self.knobs, self.given, self.shown = flat, tuple(knobs), tuple(given), tuple(shown)
        self.nx, self.nz = len(flat.states), len(flat.algebraic)
        self.p = flat.starts("parameter")
        self.place = {q.name: i for i, q in enumerate(flat.parameters)}
        self.u_place = {q.name: i for i, q in enumerate(flat.inputs)}
        self.u = flat.starts("input")
        self.scale = np.array([q.nominal for q in (*flat.states, *flat.algebraic)])
        w, both = ca.vertcat(flat.x, flat.z), ca.vertcat(flat.ode, flat.residual)
        way, along = ca.SX.sym("way", len(knobs)), ca.SX(len(flat.parameters), 1)
        for i, knob in enumerate(knobs):
            along[self.place[knob]] = way[i]
        by = ca.vertcat(*(flat.p[self.place[k]] for k in knobs), *(flat.u[self.u_place[g]] for g in given))
        groups = {"state": flat.x, "input": flat.u, "output": flat.y}
        found = [flat.locate(path) for path in shown]
        y = ca.vertcat(*(groups[kind][i] for kind, i in found))
        arguments = [w, flat.u, flat.p]
        many = Many if compiled else Slow
        self.rates = many(arguments, [both, ca.jacobian(both, w)])
        self.slopes = many(arguments, [ca.jacobian(both, by)])
        self.readings = many(arguments, [y])
        self.reading_slopes = many(arguments, [y, ca.jacobian(y, w), ca.jacobian(y, by)])
        #: Slopes of rates and of readings along one direction of the knobs each.
        self.push = many([*arguments, way], [ca.jtimes(both, flat.p, along)])
        self.reading_push = many([*arguments, way], [ca.jtimes(y, flat.p, along)])

    @staticmethod
    def of(
        spec: Spec, forms: Iterable[Form | Nuisance], knobs: Sequence[str], given: Sequence[str], shown: Sequence[str]
    ) -> Plant:
        """The superset of a rig and some forms.

        Args:
            spec: the rig, driven as the campaign drives it
            forms: what may act in it, and nuisances that need parts
            knobs, given, shown: see the class

        Raises:
            GearheatError: the superset has no sound equations
        """
        return Plant(flatten(assemble(superset(spec, forms))), knobs, given, shown)
