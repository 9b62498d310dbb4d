"""CasADi functions compiled to C for some rows side by side, and records of numbers and arrays as C reads them."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

from ....fmu import emit
from ....fmu.batch_library import address, instructions, load, widen


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
        self.shapes = {name: [r.shape for r in found] for name, found in results.items()}
        names, texts = [f"i{k}" for k in range(len(arguments))], []
        for name, found in results.items():
            outputs = [ca.SX(r).nz[:] for r in found] + [ca.SX(0, 1)] * (2 - len(found))
            function = ca.Function(name, list(arguments), outputs, names, ["first", "second"], {"cse": True})
            texts.append(emit.function(function, "lanes_", "lanes"))
            texts.append(f'__attribute__((visibility("default"))) void *const place_{name} = (void *)lanes_{name};')
        self._library = _loaded("\n".join(texts))

    def dense(self, name: str, *entries: np.ndarray) -> list[np.ndarray]:
        """Results of a function as whole matrices (n, rows, columns), those of one column as (n, rows).

        Args:
            name: of the function
            entries: of each result (n, entries)
        """
        found = []
        for own, (begin, row), (rows, columns) in zip(entries, self.patterns[name], self.shapes[name], strict=True):
            whole = np.zeros((len(own), rows, columns))
            whole[:, row, np.repeat(np.arange(columns), np.diff(begin))] = own
            found.append(whole[:, :, 0] if columns == 1 else whole)
        return found

    def place(self, name: str) -> int:
        """Where a function lies in memory."""
        return ctypes.c_void_p.in_dll(self._library, f"place_{name}").value or 0


@cache
def library() -> ctypes.CDLL:
    """The march through runs, compiled."""
    found = _loaded((Path(__file__).parent / "march.c").read_text(encoding="utf-8"))
    pointer, count = ctypes.c_void_p, ctypes.c_int64
    found.march.argtypes = [*[pointer] * 3, *[count] * 2]
    found.many.argtypes = [*[pointer] * 2, count, *[pointer] * 4, count, pointer, count]
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
