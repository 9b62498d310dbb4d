"""The equations of a rig at many points a call, with their Jacobians: what a filter over logs steps through."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np

from ...fmu.batch_library import load
from ...model.core.flat import FlatModel

_DRIVER = """
__attribute__((visibility("default")))
int many(long long n, const double** in, const long long* wide, double** out, const long long* high) {{
  const double* a[{arg}]; double* r[{res}]; casadi_int iw[{iw}]; double w[{w}];
  for (long long i = 0; i < n; i++) {{
    for (int k = 0; k < {n_in}; k++) a[k] = in[k] + i * wide[k];
    for (int k = 0; k < {n_out}; k++) r[k] = out[k] + i * high[k];
    if (all(a, r, iw, w, 0)) return 1;
  }}
  return 0;
}}
"""


class Many:
    """A function of vectors, evaluated at n points a call.

    Args:
        arguments: symbolic columns
        results: expressions; matrices of any shape

    Raises:
        FmuError: the compiler fails
    """

    def __init__(self, arguments: Sequence[Any], results: Sequence[Any]) -> None:
        dense = [ca.densify(ca.SX(r)) for r in results]
        function = ca.Function("all", list(arguments), dense, {"cse": True})
        generator = ca.CodeGenerator("many", {"with_header": False, "casadi_int": "long long int"})
        generator.add(function)
        sizes = {"arg": function.sz_arg(), "res": function.sz_res(), "iw": function.sz_iw(), "w": function.sz_w()}
        least = {name: max(size, 1) for name, size in sizes.items()}
        driver = _DRIVER.format(**least, n_in=len(arguments), n_out=len(dense))
        self._library = load(generator.dump() + driver)
        self._wide = np.array([a.numel() for a in arguments], dtype=np.int64)
        self._shapes = [r.shape for r in dense]
        self._high = np.array([a * b for a, b in self._shapes], dtype=np.int64)

    def __call__(self, *values: np.ndarray) -> list[np.ndarray]:
        """Results (n, rows, columns) at n points, columns of one as (n, rows).

        Args:
            values: one array (n, size) for each argument
        """
        n = len(values[0])
        given = [np.ascontiguousarray(v, dtype=float) for v in values]
        found = [np.empty((n, columns, rows)) for rows, columns in self._shapes]
        pointers = [(ctypes.c_void_p * len(arrays))(*(a.ctypes.data for a in arrays)) for arrays in (given, found)]
        wide, high = (ctypes.c_void_p(a.ctypes.data) for a in (self._wide, self._high))
        self._library.many(ctypes.c_longlong(n), pointers[0], wide, pointers[1], high)
        return [r[:, 0] if r.shape[1] == 1 else r.transpose(0, 2, 1) for r in found]


class Equations:
    """One rig: functions of unknowns w = (states, algebraic variables), inputs and parameters, a row each point.

    Args:
        flat: the model
        knobs: parameters that anything changes, the columns of `slopes`
        given: inputs that sensors give, further columns of `slopes`
        shown: states, outputs or inputs that sensors read

    Raises:
        FmuError: the compiler fails
    """

    def __init__(self, flat: FlatModel, knobs: Sequence[str], given: Sequence[str], shown: Sequence[str]) -> None:
        self.flat, self.knobs, self.given, self.shown = flat, tuple(knobs), tuple(given), tuple(shown)
        self.nx, self.nz = len(flat.states), len(flat.algebraic)
        self.p, self.u = flat.starts("parameter"), flat.starts("input")
        self.place = {q.name: i for i, q in enumerate(flat.parameters)}
        self.u_place = {q.name: i for i, q in enumerate(flat.inputs)}
        self.scale = np.array([q.nominal for q in (*flat.states, *flat.algebraic)])
        w, both = ca.vertcat(flat.x, flat.z), ca.vertcat(flat.ode, flat.residual)
        by = ca.vertcat(*(flat.p[self.place[k]] for k in knobs), *(flat.u[self.u_place[g]] for g in given))
        groups = {"state": flat.x, "input": flat.u, "output": flat.y}
        found = [flat.locate(path) for path in shown]
        y = ca.vertcat(*(groups[kind][i] for kind, i in found))
        arguments = [w, flat.u, flat.p]
        self.rates = Many(arguments, [both, ca.jacobian(both, w)])
        self.slopes = Many(arguments, [ca.jacobian(both, by)])
        self.readings = Many(arguments, [y])
        self.reading_slopes = Many(arguments, [y, ca.jacobian(y, w), ca.jacobian(y, by)])
