"""The drivers of a batch: the C sources over rows, loading what is compiled, calling it block by block on threads."""

from __future__ import annotations

import contextlib
import ctypes
import os
import platform as host
import tempfile
import threading
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

from ..model.core.flat import FlatModel, Quantity
from ..model.errors import FmuError
from . import emit, rosenbrock
from .compiling import QUICK, THOROUGH, binary, host_platform, why_not_loaded
from .equations import equations, full, hoist
from .fixed import wrapper
from .grid import Grid
from .source import define_macros, newton_constants
from .variables import table

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
#: Numbers of a vector without them, as wrapper/lanes.h has it.
LANES = 4
#: Rows of a batch side by side with any of them: two vectors at once do not wait for each other.
BESIDE = 8
#: So few rows leave most of those lanes empty: side by side in a vector of two they take half the time.
FEW = 2
#: Functions by name, source and how much they may be optimised, and what each source has had to do.
_LOADED: dict[tuple[str, str, tuple[str, ...]], Any] = {}
_WORK: Counter[str] = Counter()
#: Rows or steps up to which a source is compiled quickly: without optimising, each takes 15 microseconds longer.
LITTLE = 50_000
_LOCK = threading.Lock()
#: What a steady row holds behind the model's outputs: supply [W], throughput [W], law arguments outside their range,
#: largest residual of the implicit equations.
EXTRA = 4

#: Warm-ups choose their steps freely, which suits a method of higher order than that of an FMU with its short steps.
METHOD = rosenbrock.RODAS4


def driver(name: str, source: str, work: int) -> Any:
    """The C function of a source, compiled and loaded once in a process; anew, and optimised, when it has much to do.

    Args:
        name: of the function, a key of `_SIGNATURES`
        source: the whole C text
        work: rows or steps that it is about to do

    Raises:
        FmuError: the compiler fails, or what it made does not load
    """
    with _LOCK:
        _WORK[source] += work
        ways = (THOROUGH, QUICK) if _WORK[source] <= LITTLE else (THOROUGH,)
        if (name, source, ways) not in _LOADED:
            function = getattr(load(source, ways), name)
            function.argtypes, function.restype = _SIGNATURES[name], ctypes.c_int
            _LOADED[name, source, ways] = function
        return _LOADED[name, source, ways]


@cache
def widen(source: str, instructions: str, beside: int = 0) -> str:
    """A C text of wrapper/lanes.h made for processors with one of `WIDER`; as it is without any.

    Args:
        source: the C text
        instructions: a key of `WIDER`, or nothing
        beside: rows side by side, 2, 4 or 8; as many as a vector has numbers when not given
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


def load(source: str, ways: Sequence[str] = (THOROUGH,)) -> ctypes.CDLL:
    """The library of a C text, compiled once and kept.

    Args:
        source: the whole C text
        ways: how much it may be optimised, see `binary`

    Raises:
        FmuError: the compiler fails, or what it made does not load
    """
    platform = host_platform()
    handle, name = tempfile.mkstemp(suffix=platform.suffix)
    with os.fdopen(handle, "wb") as file:
        file.write(binary(source, platform, ways=ways))
    try:
        return ctypes.CDLL(name)
    except OSError as error:
        raise FmuError(f"the compiled code does not load: {why_not_loaded(error, Path(name).parent)}") from error
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
        driver("batch_relations", source, len(rows))(len(rows), address(rows), rows.shape[1], address(broken))
    return broken


@cache
def _pool(workers: int, process: int) -> ThreadPoolExecutor:
    """Threads that stay: a diagnosis shares out rows thousands of times. A process that was split off has its own."""
    return ThreadPoolExecutor(workers)


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
        done = list(_pool(workers, os.getpid()).map(lambda ends: block(*ends), blocks))
    if not all(done):
        raise FmuError("there is not enough memory for the rows. Give fewer at a time.")


def cores() -> int:
    """Cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def steady_source(flat: FlatModel) -> str:
    """The C text for steady states: rows side by side in lanes, and one by one what is unusual.

    The equations come in three stages, each computed when what it depends on changes: `fixed` (p) -> first part of c,
    `given` (u, p, first part) -> second part, and `rates`, `equations` (with the Jacobian's entries that are not zero),
    `algebra` (the implicit ones and their Jacobian in z) and `outputs` of (x, z, u, p, c).

    Raises:
        FmuError: an operation has no C text
    """
    outside = sum((ca.logic_or(flat.checked[i] < c.low, flat.checked[i] > c.high) for i, c in enumerate(flat.checks)))
    implicit = ca.mmax(ca.fabs(ca.SX(flat.residual))) if flat.residual_names else 0
    whole = ca.vertcat(flat.ode, flat.residual)
    jacobian = ca.jacobian(whole, ca.vertcat(flat.x, flat.z))
    places = jacobian.sparsity().get_triplet()
    inner = ca.densify(ca.jacobian(flat.residual, flat.z))
    y = ca.vertcat(flat.y, flat.supply, flat.throughput, outside, implicit)
    parts, given, c_values = hoist([whole, jacobian.nz[:], y, flat.residual, inner[:]], ca.vertcat(flat.u, flat.p))
    whole, entries, y, residual, inner = parts
    (c_values,), fixed, k_values = hoist([c_values], flat.p)
    place, names = [flat.x, flat.z, flat.u, flat.p, ca.vertcat(fixed, given)], list("xzupc")
    functions = [
        full("fixed", [flat.p], [k_values], ["p"], ["k"]),
        full("given", [flat.u, flat.p, fixed], [c_values], ["u", "p", "k"], ["c"]),
        full("rates", place, [whole], names, ["r"]),
        full("equations", place, [whole, entries], names, ["r", "entries"]),
        full("algebra", place, [residual, inner], names, ["r", "J"]),
        full("outputs", place, [y], names, ["y"]),
    ]
    nk = fixed.numel()
    sizes = {**_sizes(flat), "NYR": y.numel(), "NK": nk, "NC": nk + given.numel(), "NJ": entries.numel()}
    pattern = [
        _array("int", f"model_{name}", map(str, place)) for name, place in zip(("row", "column"), places, strict=True)
    ]
    beside = [emit.function(f, "lanes_", "lanes") for f in functions if f.name() not in ("fixed", "rates")]
    generated = [*_ranges(flat), *pattern, *map(emit.function, functions), *beside]
    return _text(sizes, ["batch.h", "lanes.h"], generated, ["newton.c", "batch_steady.c", "batch_straight.c"])


def relations_source(flat: FlatModel) -> str:
    """The C text that judges rows of parameters; nothing where the model has no relations.

    Raises:
        FmuError: an operation has no C text
    """
    if not flat.relations:
        return ""
    limits = {"low": [r.low for r in flat.relations], "high": [r.high for r in flat.relations]}
    ends = [
        f"static const double model_relation_{end}[] = {{{', '.join(map(emit.number, numbers))}}};"
        for end, numbers in limits.items()
    ]
    above = [f"#define N_RELATIONS {len(flat.relations)}", wrapper("batch.h")]
    return "\n".join([*above, *ends, emit.function(flat.relation_function), wrapper("batch_relations.c")])


def warmup_source(flat: FlatModel, most_steps: int) -> str:
    """The C text for warm-ups: the equations of the FMU with its audit, and its solver.

    Args:
        flat: the model
        most_steps: steps after which it gives up between two points of the schedule or the output

    Raises:
        FmuError: an operation has no C text, or the stored energy depends on an input
    """
    model = equations(flat)
    x_new, z_new, error, slope, h = rosenbrock.step(model.ode, model.residual, model.x, model.z, model.u, METHOD)
    inner = ca.densify(ca.jacobian(model.residual, model.z))
    parts, c, c_values = hoist([x_new, z_new, error[:-1], model.y, model.ode, model.residual, inner[:]], model.p)
    x_new, z_new, error, y, ode, residual, inner = parts
    place, names = [model.x, model.z, model.u, model.p, c], list("xzupc")
    inputs, names_in = [model.x, model.z, model.u, slope, model.p, c, h], ["x", "z", "u", "slope", "p", "c", "h"]
    step = full("step", inputs, [x_new, z_new, error], names_in, ["x_new", "z_new", "error"])
    functions = [
        emit.function(full("constants", [model.p], [c_values], ["p"], ["c"])),
        emit.function(step, "lanes_", "lanes"),
        emit.function(full("algebra", place, [residual, inner], names, ["r", "J"])),
        emit.function(full("outputs", place, [y, ode], names, ["y", "dx"])),
    ]
    sizes = {**_sizes(flat), "NX": ode.numel(), "NY": y.numel(), "NC": c.numel()}
    sizes |= {"ORDER": METHOD.order, "MAX_STEPS": most_steps}
    drivers = ["newton.c", "batch_instance.h", "trial.c", "batch_warmup.c"]
    return _text(sizes, ["batch.h", "lanes.h"], [*_ranges(flat), *functions], drivers)


def _sizes(flat: FlatModel) -> dict[str, int]:
    return {
        "N": len(flat.states),
        "NZ": len(flat.algebraic),
        "NU": len(flat.inputs),
        "NP": len(flat.parameters),
        "N_OUTPUTS": len(flat.outputs),
    }


def _text(sizes: Mapping[str, Any], above: Sequence[str], generated: Sequence[str], below: Sequence[str]) -> str:
    """Sizes, the fixed text above the generated tables and functions, these, and the fixed text below them."""
    return "\n".join(
        [define_macros({**sizes, **newton_constants()}), *map(wrapper, above), *generated, *map(wrapper, below)]
    )


def _ranges(flat: FlatModel) -> list[str]:
    """Nominals and ranges of the states, those of the audit included, and of the inputs; algebraic variables."""
    variables = table(flat)
    rows = [*variables.of("state"), *variables.of("input")]
    columns = {
        "nominal": [v.quantity.nominal for v in rows],
        "low": [v.bounds[0] for v in rows],
        "high": [v.bounds[1] for v in rows],
        "z_start": [q.start for q in flat.algebraic],
        "z_nominal": [q.nominal for q in flat.algebraic],
    }
    return [_array("double", f"model_{name}", map(emit.number, column)) for name, column in columns.items()]


def _array(kind: str, name: str, values: Iterable[str]) -> str:
    return f"static const {kind} {name}[] = {{{', '.join([*values, '0'])}}};  /* 0: never empty */"
