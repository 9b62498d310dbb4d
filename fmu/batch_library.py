"""The compiled drivers of a batch: loading them, and calling them block by block on some threads."""

from __future__ import annotations

import contextlib
import ctypes
import os
import platform as host
import tempfile
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from ..model.core.flat import Quantity
from ..model.errors import FmuError
from .compiling import binary, host_platform
from .grid import Grid

#: Addresses and numbers of rows as the drivers take them.
_POINTER = ctypes.c_void_p
_COUNT = ctypes.c_int64  # batches may hold more rows than an int of C
#: Arguments of each driver.
_SIGNATURES = {
    "batch_steady": [_COUNT, *[_POINTER, _COUNT] * 3, *[_POINTER] * 5],
    "batch_relations": [_COUNT, _POINTER, _COUNT, _POINTER],
    "batch_warmup": [_COUNT, _POINTER, *[_POINTER, _COUNT] * 3, _COUNT, *[_POINTER] * 5],
}
#: Vector instructions beyond those every processor has -> numbers of a vector, the best first. They change how
#: fast a batch is, not one bit of it.
WIDER = {"avx512f": 8, "avx2": 4}
#: Rows of a batch side by side with any of them: two vectors at once do not wait for each other.
BESIDE = 8
_LOADED: dict[tuple[str, str], Any] = {}
_LOCK = threading.Lock()


def driver(name: str, source: str) -> Any:
    """The C function of a source, compiled and loaded once in a process.

    Args:
        name: of the function, a key of `_SIGNATURES`
        source: the whole C text

    Raises:
        FmuError: the compiler fails, or what it made does not load
    """
    with _LOCK:
        if (name, source) not in _LOADED:
            function = getattr(load(source), name)
            function.argtypes, function.restype = _SIGNATURES[name], ctypes.c_int
            _LOADED[name, source] = function
        return _LOADED[name, source]


@cache
def widen(source: str, instructions: str, beside: int = 0) -> str:
    """A C text of wrapper/lanes.h made for processors with one of `WIDER`; as it is without any.

    Args:
        source: the C text
        instructions: a key of `WIDER`, or nothing
        beside: rows side by side, 4 or 8; as many as a vector has numbers when not given
    """
    if not instructions:
        return source
    push = f'#pragma clang attribute push(__attribute__((target("{instructions}"))), apply_to=function)'
    return f"{push}\n#define LANES {beside or WIDER[instructions]}\n{source}\n#pragma clang attribute pop\n"


def instructions() -> str:
    """The best of `WIDER` this processor has; nothing where that is not known."""
    return next((name for name in WIDER if name in processor()), "")


@cache
def processor() -> frozenset[str]:
    """Which of `WIDER` this processor and its system have."""
    if host.machine().lower() not in ("x86_64", "amd64"):
        return frozenset()
    if host.system() == "Windows":
        numbers = {"avx2": 40, "avx512f": 41}  # PF_..._INSTRUCTIONS_AVAILABLE
        ask = ctypes.windll.kernel32.IsProcessorFeaturePresent  # type: ignore[attr-defined, unused-ignore]
        return frozenset(name for name, number in numbers.items() if ask(number))
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return frozenset()
    flags = next((line.split() for line in lines if line.startswith("flags")), [])
    return frozenset(WIDER) & frozenset(flags)


def load(source: str) -> ctypes.CDLL:
    """The library of a C text, compiled once and kept.

    Args:
        source: the whole C text

    Raises:
        FmuError: the compiler fails, or what it made does not load
    """
    platform = host_platform()
    handle, name = tempfile.mkstemp(suffix=platform.suffix)
    with os.fdopen(handle, "wb") as file:
        file.write(binary(source, platform))
    try:
        return ctypes.CDLL(name)
    except OSError as error:
        raise FmuError(f"the compiled code does not load: {error}") from error
    finally:
        with contextlib.suppress(OSError):  # Windows keeps a library that is in use
            Path(name).unlink()


class Duty(ctypes.Structure):
    """The duty of a warm-up as C knows it; holds its arrays alive."""

    _fields_ = [
        ("m", _COUNT),
        *((name, _POINTER) for name in ("length", "value", "slope", "scheduled", "before", "after")),
        ("tolerance", ctypes.c_double),
    ]

    def __init__(self, points: Grid, inputs: Sequence[Quantity], tolerance: float) -> None:
        place = {q.name: i for i, q in enumerate(inputs)}
        order = [place[name] for name in points.names]
        pieces = len(points.time) - 1
        value, slope = np.zeros((pieces, len(inputs))), np.zeros((pieces, len(inputs)))
        scheduled = np.zeros(len(inputs), dtype=np.int32)
        value[:, order], slope[:, order], scheduled[order] = points.value, points.slope, 1
        kept = [points.rows_before.astype(np.int32), points.rows_after.astype(np.int32)]
        self.arrays = [np.diff(points.time), value, slope, scheduled, *kept]
        super().__init__(pieces, *map(address, self.arrays), tolerance)


def address(array: np.ndarray) -> int:
    """Where the numbers of an array begin."""
    return int(array.ctypes.data)


def rows_from(vectors: Sequence[np.ndarray], first: int) -> list[int]:
    """Address and stride of each array from a row on; a vector serves all rows.

    Args:
        vectors: arrays of doubles, a row each or (n, width)
        first: number of the first row
    """
    pairs = [(v[first:] if v.ndim == 2 else v, v.shape[1] if v.ndim == 2 else 0) for v in vectors]
    return [number for array, stride in pairs for number in (address(array), stride)]


def broken_relations(source: str, p: np.ndarray) -> np.ndarray:
    """Place of the first relation that does not hold in each row, -1 where all do.

    Args:
        source: of `batch_source.relations_source`
        p: parameters (n, parameters), or a vector
    """
    rows = np.ascontiguousarray(np.atleast_2d(p), dtype=float)
    broken = np.full(len(rows), -1, dtype=np.int32)
    if source:
        driver("batch_relations", source)(len(rows), address(rows), rows.shape[1], address(broken))
    return broken


def share_rows(block: Callable[[int, int], int], n: int, size: int, threads: int) -> None:
    """Do n rows in blocks on some threads; ctypes lets go of the interpreter while C runs.

    Args:
        block: does the rows from the first to before the second number; 0 where memory runs out
        n: number of rows
        size: rows of a block, fewer where a thread would have none
        threads: 0 for one per core

    Raises:
        FmuError: memory runs out
    """
    workers = threads or cores()
    size = max(min(size, -(-n // workers)), 1)
    blocks = [(a, min(a + size, n)) for a in range(0, n, size)]
    workers = min(workers, max(len(blocks), 1))
    if workers == 1:
        done = [block(a, b) for a, b in blocks]
    else:
        with ThreadPoolExecutor(workers) as pool:
            done = list(pool.map(lambda ends: block(*ends), blocks))
    if not all(done):
        raise FmuError("there is not enough memory for the rows. Give fewer at a time.")


def cores() -> int:
    """Cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
