"""Arithmetic in lanes: accurate, right at the ends of the range, and the same with every set of instructions."""

import ctypes
from collections.abc import Callable
from importlib.resources import files

import casadi as ca
import numpy as np
import pytest
from gearheat.fmu import emit
from gearheat.fmu.batch_library import address, load, processor, widen

SETS = ("", *sorted(processor()))
TAKES = {"exp": 1, "log": 1, "tanh": 1, "pow": 2, "fmin": 2, "fmax": 2}

Call = Callable[..., np.ndarray]


def library(text: str, names: list[str], instructions: str) -> ctypes.CDLL:
    """Functions f of (lanes *in, lanes *out) over arrays [row][number], LANES rows at a time."""
    wrapper = files("gearheat.fmu") / "wrapper"
    head = [(wrapper / name).read_text(encoding="utf-8") for name in ("batch.h", "lanes.h")]
    runs = [
        f"BATCH_EXPORT void run_{name}(int64_t n, int64_t n_in, int64_t n_out, const double *in, double *out)\n"
        "{ int64_t k; int i, j; for (k = 0; k < n; k += LANES) { lanes a[99], y[99]; memset(a, 0, sizeof a);\n"
        "  for (j = 0; j < LANES && k + j < n; j++) for (i = 0; i < n_in; i++) a[i][j] = in[(k + j) * n_in + i];\n"
        f"  {name}(a, y);\n"
        "  for (j = 0; j < LANES && k + j < n; j++) for (i = 0; i < n_out; i++) out[(k + j) * n_out + i] = y[i][j]; } }"
        for name in names
    ]
    return load(widen("\n".join([*head, text, *runs]), instructions))


def call(made: ctypes.CDLL, name: str, rows: np.ndarray, n_out: int = 1) -> np.ndarray:
    rows = np.ascontiguousarray(rows, dtype=float)
    out = np.empty((len(rows), n_out))
    counts = [ctypes.c_int64(n) for n in (len(rows), rows.shape[1], n_out)]
    getattr(made, f"run_{name}")(*counts, ctypes.c_void_p(address(rows)), ctypes.c_void_p(address(out)))
    return out


@pytest.fixture(scope="module", params=SETS, ids=[name or "baseline" for name in SETS])
def lanes(request: pytest.FixtureRequest) -> Call:
    arguments = {1: "a[0]", 2: "a[0], a[1]"}
    text = "\n".join(
        f"static void of_{f}(const lanes *a, lanes *y) {{ y[0] = lanes_{f}({arguments[n]}); }}"
        for f, n in TAKES.items()
    )
    made = library(text, [f"of_{f}" for f in TAKES], request.param)
    return lambda f, *columns: call(made, f"of_{f}", np.stack(np.broadcast_arrays(*columns), axis=-1))[:, 0]


def ulps(found: np.ndarray, exact: np.ndarray) -> float:
    """Largest distance, in the last digit; exact in more digits than a double."""
    return float(np.max(np.abs(found - exact) / np.spacing(np.abs(exact.astype(float)))))


def spread(low: float, high: float, n: int = 40_001) -> np.ndarray:
    return np.random.default_rng(2).uniform(low, high, n)


LONG = np.finfo(np.longdouble).eps < 1e-18


@pytest.mark.skipif(not LONG, reason="no longer floating-point numbers to compare with")
def test_errors_are_a_few_of_the_last_digit(lanes: Call) -> None:
    for a in (spread(-708.0, 709.7), spread(-1.0, 1.0), spread(-1e-9, 1e-9)):
        assert ulps(lanes("exp", a), np.exp(a.astype(np.longdouble))) < 2.0
    for a in (10 ** spread(-307.0, 308.0), spread(0.5, 2.0), 1 + spread(-1e-6, 1e-6)):
        assert ulps(lanes("log", a), np.log(a.astype(np.longdouble))) < 1.0
    for a in (spread(-25.0, 25.0), spread(-1.0, 1.0), 10 ** spread(-300.0, 0.0)):
        exact = np.tanh(a.astype(np.longdouble))
        assert ulps(lanes("tanh", a), exact) < 3.0
        assert np.abs(lanes("tanh", a) - exact).max() < 4e-16


@pytest.mark.skipif(not LONG, reason="no longer floating-point numbers to compare with")
@pytest.mark.parametrize(("decades", "most"), [(3, 100), (30, 10), (300, 1)])
def test_a_power_keeps_its_digits_far_from_one(lanes: Call, decades: int, most: float) -> None:
    a, b = 10 ** spread(-decades, decades), spread(-most, most)[::-1]
    exact = a.astype(np.longdouble) ** b
    assert np.abs(lanes("pow", a, b) / exact - 1).max() < 1e-14


def test_the_ends_of_the_range(lanes: Call) -> None:
    inf, nan = np.inf, np.nan
    special = [0.0, -0.0, 1.0, -1.0, 5e-324, 1e-310, 2.2250738585072014e-308, 1.7976931348623157e308, inf, -inf, nan]
    a = np.array([*special, 0.5, 3.0, -2.0, -2.5, 709.0, 710.0, -709.0, -740.0, -800.0, 1e300])
    with np.errstate(all="ignore"):
        for name, f in (("exp", np.exp), ("log", np.log), ("tanh", np.tanh)):
            assert lanes(name, a) == pytest.approx(f(a), rel=1e-15, nan_ok=True, abs=0.0), name
        assert np.signbit(lanes("tanh", np.array([-0.0])))[0]
        for b in [*special, 2.0, 3.0, -3.0, 0.25, -1.5, 1e10]:
            assert lanes("pow", a, b) == pytest.approx(np.power(a, b), rel=1e-14, nan_ok=True, abs=0.0), b
            for name, f in (("fmin", np.fmin), ("fmax", np.fmax)):
                assert np.array_equal(lanes(name, a, b), f(a, b), equal_nan=True)


def every_operation() -> ca.Function:
    x, y, t = (ca.SX.sym(name) for name in "xyt")
    unary = (ca.exp, ca.log, ca.sqrt, ca.sin, ca.cos, ca.tan, ca.atan, ca.floor, ca.ceil, ca.fabs, ca.sign, ca.erf)
    unary += (ca.sinh, ca.cosh, ca.tanh, ca.asinh, ca.log1p, ca.expm1)
    narrow = (ca.asin, ca.acos, ca.atanh)
    binary = (ca.fmod, ca.copysign, ca.fmin, ca.fmax, ca.atan2, ca.hypot, ca.constpow)
    logic = [x < y, x <= y, x == y, x != y, ca.logic_not(x), ca.logic_and(x, y), ca.logic_or(x, y)]
    rest = [ca.if_else(x < y, x, y), -x, 1 / x, 2 * x, x * x, x**y, x**-1.3, x / y, 3.25 - x, ca.acosh(1 + x)]
    values = [f(x) for f in unary] + [f(t) for f in narrow] + [f(x, y) for f in binary] + logic + rest
    return ca.Function("all_operations", [ca.vertcat(x, y, t)], [ca.densify(ca.vertcat(*values))], ["a"], ["y"])


@pytest.mark.parametrize("instructions", SETS)
def test_every_operation_in_lanes_is_that_of_casadi(instructions: str) -> None:
    f = every_operation()
    made = library(emit.function(f, "lanes_", "lanes"), ["lanes_all_operations"], instructions)
    rows = np.column_stack([spread(0.01, 5.0, 43), np.round(spread(1.0, 5.0, 43)), spread(-0.99, 0.99, 43)])
    rows[:9, 0] = rows[:9, 1]
    rows[9:12, 0] = 0.0
    found = call(made, "lanes_all_operations", rows, f.numel_out(0))
    assert found == pytest.approx(np.array([f(row).full()[:, 0] for row in rows]), rel=4e-15, abs=1e-300, nan_ok=True)


def test_every_set_of_instructions_gives_the_same_bits() -> None:
    """Also every number of rows side by side."""
    if len(SETS) == 1:
        pytest.skip("this processor has the basic instructions alone")
    f = every_operation()
    text = emit.function(f, "lanes_", "lanes")
    rows = np.column_stack([10 ** spread(-5.0, 2.0, 9999), spread(-3.0, 3.0, 9999), spread(-1.0, 1.0, 9999)])
    bits = {
        call(library(text, ["lanes_all_operations"], s), "lanes_all_operations", rows, f.numel_out(0)).tobytes()
        for s in SETS
    }
    assert len(bits) == 1
