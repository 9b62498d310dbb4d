"""An SX function of CasADi for many columns at once: compiled, some columns side by side."""

from __future__ import annotations

import ctypes
from typing import Any

import casadi as ca
import numpy as np
from gearheat.fmu import emit
from gearheat.fmu.batch_library import instructions, load, widen
from gearheat.fmu.fixed import wrapper

#: Around the function: columns lie beside each other, the last one fills what is left of the lanes.
DRIVER = """
__attribute__((visibility("default"))) void columns(int64_t m, const double *given, double *found)
{
    lanes in[ROWS_IN], out[ROWS_OUT];
    for (int64_t from = 0; from < m; from += LANES) {
        int64_t n = m - from < LANES ? m - from : LANES;
        for (int64_t i = 0; i < ROWS_IN; i++)
            for (int64_t l = 0; l < LANES; l++) in[i][l] = given[i * m + from + (l < n ? l : n - 1)];
        lanes_whole(in, out);
        for (int64_t i = 0; i < ROWS_OUT; i++)
            for (int64_t l = 0; l < n; l++) found[i * m + from + l] = out[i][l];
    }
}
"""


class Columns:
    """A function of dense vectors for any number of columns.

    Args:
        function: of CasADi, all of whose arguments and results are vectors

    Raises:
        FmuError: an operation has no C text, or the compiler fails
    """

    def __init__(self, function: Any) -> None:
        rows = [function.size1_in(i) for i in range(function.n_in())]
        self._ends = np.cumsum([function.size1_out(i) for i in range(function.n_out())])
        given = ca.SX.sym("given", sum(rows))
        found = ca.vertcat(*function.call(ca.vertsplit(given, np.cumsum([0, *rows]).tolist())))
        whole = ca.Function("whole", [given], [ca.densify(found)], ["given"], ["found"], {"cse": True})
        sizes = f"#define ROWS_IN {sum(rows)}\n#define ROWS_OUT {found.numel()}"
        above = ["#include <math.h>\n#include <stdint.h>", sizes, wrapper("lanes.h")]
        text = "\n".join([*above, emit.function(whole, "lanes_", "lanes"), DRIVER])
        self._run = load(widen(text, instructions(), 8)).columns
        self._run.argtypes, self._run.restype = [ctypes.c_int64, *[ctypes.c_void_p] * 2], None

    def __call__(self, *inputs: np.ndarray) -> list[np.ndarray]:
        """Outputs (rows, m) for inputs (rows, m)."""
        given = np.concatenate(inputs).astype(float)
        found = np.empty((self._ends[-1], given.shape[1]))
        self._run(given.shape[1], given.ctypes.data, found.ctypes.data)
        return np.split(found, self._ends[:-1])
