"""CasADi functions compiled to C, for many points at once."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np

from ...fmu.batch_library import load

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
        self._call = self._library.many
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
        self._call(ctypes.c_longlong(n), pointers[0], _address(self._wide), pointers[1], _address(self._high))
        return [r[:, 0] if r.shape[1] == 1 else r.transpose(0, 2, 1) for r in found]


class Slow:
    """The same without a compiler.

    Args:
        arguments, results: as for `Many`
    """

    def __init__(self, arguments: Sequence[Any], results: Sequence[Any]) -> None:
        self._function = ca.Function("all", list(arguments), [ca.densify(ca.SX(r)) for r in results], {"cse": True})
        self._shapes = [r.shape for r in results]

    def __call__(self, *values: np.ndarray) -> list[np.ndarray]:
        """Results at n points, as those of `Many`."""
        n = len(values[0])
        found = [np.asarray(r) for r in self._function.call([ca.DM(v.T) for v in values])]
        whole = [r.reshape(rows, n, columns).swapaxes(0, 1) for r, (rows, columns) in zip(found, self._shapes, strict=True)]
        return [r[:, :, 0] if r.shape[2] == 1 else r for r in whole]


def _address(array: np.ndarray) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)
