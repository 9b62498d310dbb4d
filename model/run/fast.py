"""Calls of CasADi functions on numpy vectors, without the conversion that costs more than the function itself.

What is compiled of a model is compiled once.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import wraps
from typing import Any, Concatenate, ParamSpec, TypeVar
from weakref import WeakKeyDictionary

import casadi as ca
import numpy as np

from ..core.flat import FlatModel


class Fast:
    """A function of vectors, by expressions.

    Args:
        name: for CasADi
        arguments: symbolic columns
        results: expressions; each comes back as a new dense array, columns as vectors
    """

    def __init__(self, name: str, arguments: Sequence[Any], results: Sequence[Any]) -> None:
        dense = [ca.densify(r) for r in results]
        self._function = ca.Function(name, list(arguments), dense, {"cse": True})
        self._buffer, self._evaluate = self._function.buffer()
        self._arguments = [np.zeros(a.numel()) for a in arguments]
        self._results = [np.zeros(r.shape, order="F") for r in dense]
        for i, array in enumerate(self._arguments):
            self._buffer.set_arg(i, array.data)
        # CasADi wants the memory of a matrix as a flat view
        self._flat = [array.reshape(-1, order="F") for array in self._results]
        for i, array in enumerate(self._flat):
            self._buffer.set_res(i, array.data)

    def __call__(self, *values: np.ndarray) -> list[np.ndarray]:
        """Results at some values."""
        for array, value in zip(self._arguments, values, strict=True):
            array[:] = value
        self._evaluate()
        return [r[:, 0].copy() if r.shape[1] == 1 else r.copy() for r in self._results]


Made = TypeVar("Made")
Arguments = ParamSpec("Arguments")


def once(make: Callable[Concatenate[FlatModel, Arguments], Made]) -> Callable[Concatenate[FlatModel, Arguments], Made]:
    """What is compiled of a model, made once per model and further arguments, and gone with the model."""
    made: WeakKeyDictionary[FlatModel, dict[Any, Made]] = WeakKeyDictionary()

    def kept(flat: FlatModel, /, *arguments: Arguments.args, **named: Arguments.kwargs) -> Made:
        own = made.setdefault(flat, {})
        key = (arguments, tuple(named.items()))
        if key not in own:
            own[key] = make(flat, *arguments, **named)
        return own[key]

    return wraps(make)(kept)
