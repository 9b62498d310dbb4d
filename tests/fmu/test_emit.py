"""Scalar functions as C: every operation, compiled and called, gives CasADi's own value."""

import ctypes
import subprocess
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from fmu_in_c import gcc
from gearheat.fmu import emit
from gearheat.fmu.compiling import binary, host_platform
from gearheat.model.errors import FmuError
from gearheat.tools.bench.c_importer import Compiler


def test_every_operation_gives_the_same_number(tmp_path: Path) -> None:
    x = ca.SX.sym("x", 4)
    a, b, c, d = ca.vertsplit(x)
    e = ca.vertcat(
        *(a + b, a - b, a * b, a / b, -a, ca.exp(a), ca.log(b), b**a, b**2.5, ca.sqrt(b), a**2, 2 * a),
        *(ca.sin(a), ca.cos(a), ca.tan(a), ca.asin(d), ca.acos(d), ca.atan(a), a < b, a <= b, ca.eq(a, a * 1), a != b),
        *(ca.logic_not(c), ca.logic_and(a, c), ca.logic_or(c, b), ca.floor(b), ca.ceil(b), ca.fmod(b, a)),
        *(ca.fabs(-b), ca.sign(-b), ca.sign(c), ca.copysign(a, -b), ca.if_else(a < b, a, b), ca.if_else(a > b, a, b)),
        *(ca.erf(d), ca.fmin(a, b), ca.fmax(a, b), 1 / b, ca.sinh(a), ca.cosh(a), ca.tanh(a), ca.asinh(a)),
        *(ca.acosh(b), ca.atanh(d), ca.atan2(a, -b), ca.log1p(b), ca.expm1(d), ca.hypot(a, b)),
        *(a * -1.5, a + 1e-300, a * 0.1, ca.SX(np.inf), ca.SX(-np.inf), ca.SX(3)),
    )
    function = ca.Function("all", [x], [e], ["x"], ["y"])
    export = '__attribute__((visibility("default"))) void call(const double *x, double *y) { model_all(x, y); }\n'
    library = tmp_path / "all.so"
    library.write_bytes(binary("#include <math.h>\n" + emit.function(function) + export, host_platform()))
    values = np.array([0.7, 2.3, 0.0, 0.31])
    out = np.empty(e.shape[0])
    pointers = [v.ctypes.data_as(ctypes.c_void_p) for v in (values, out)]
    ctypes.CDLL(str(library)).call(*pointers)
    assert out == pytest.approx(np.array(function(values)).ravel(), rel=1e-15, abs=0)


def test_divisions_by_one_value_share_its_reciprocal() -> None:
    x = ca.SX.sym("x", 4)
    y = ca.vertcat(x[0] / x[1], x[2] / x[1], x[3] / x[2], ca.exp(x[0]) / x[1], x[1] / ca.exp(x[0]))
    text = emit.function(ca.Function("f", [x], [y], ["x"], ["y"]))
    assert text.count("=1/") == 1
    assert text.count("*r0;") == 3
    assert text.count("/") == 3


def test_an_operation_without_a_counterpart_is_named() -> None:
    x = ca.SX.sym("x")
    with pytest.raises(FmuError, match="CasADi operation"):
        emit.function(ca.Function("f", [x], [ca.erfinv(x)]))


@pytest.mark.parametrize("value", [0.1, -3.0, 1e300, 5e-324, 2.0, 1 / 3])
def test_numbers_read_back_as_themselves(value: float) -> None:
    assert float(emit.number(value).strip("()")) == value


def mixture(n: int) -> ca.Function:
    """n states, each moved by two others and a hub, with shared divisors and calls; two outputs of it."""
    x, p = ca.SX.sym("x", n), ca.SX.sym("p", 3)
    rate = [
        p[0] * (x[(7 * k) % n] - x[k]) / p[1] + ca.exp(-(x[k] ** 2)) * x[0] / (1 + x[(3 * k + 1) % n] ** 2)
        for k in range(n)
    ]
    y = ca.jtimes(ca.vertcat(*rate), x, ca.vertcat(*rate))
    return ca.Function("mixture", [x, p, ca.SX.sym("idle")], [y, ca.vertcat(*rate)], ["x", "p", "idle"], ["y", "dx"])


@pytest.mark.parametrize("piece", [1, 7, 250])
def test_pieces_compute_the_same_bits(piece: int, tmp_path: Path) -> None:
    n = 60
    f = mixture(n)
    whole, cut = emit.function(f, "whole_"), emit.function(f, "cut_", whole=0, piece=piece)
    assert "cut_mixture_1(" in cut
    assert "APART" not in whole
    calls = "".join(
        f'__attribute__((visibility("default"))) void {name}(const double *x, const double *p, double *y, double *dx)'
        f" {{ {name}_mixture(x, p, p, y, dx); }}\n"
        for name in ("whole", "cut")
    )
    library = tmp_path / "both.so"
    library.write_bytes(binary("#include <math.h>\n" + whole + cut + calls, host_platform()))
    random = np.random.default_rng(4)
    x, p, found = random.normal(size=n), random.uniform(1, 2, 3), {}
    for name in ("whole", "cut"):
        y, dx = np.full(n, np.nan), np.full(n, np.nan)
        getattr(ctypes.CDLL(str(library)), name)(*(v.ctypes.data_as(ctypes.c_void_p) for v in (x, p, y, dx)))
        found[name] = y.tobytes() + dx.tobytes()
        assert y == pytest.approx(np.array(f(x, p, 0.0)[0]).ravel(), rel=1e-12)
    assert found["cut"] == found["whole"]


def test_a_long_function_is_cut_into_pieces_of_bounded_length() -> None:
    f = mixture(4000)
    text = emit.function(f)
    bodies = [body.count(";") for body in text.split("static void ")[1:]]
    assert len(bodies) > f.n_instructions() / emit.PIECE
    assert max(bodies[:-1]) < 3 * emit.PIECE
    assert text.count(";") < 2 * f.n_instructions(), "what is handed from piece to piece stays in bounds"
    assert emit.function(mixture(100)).count("static void ") == 1


@pytest.mark.parametrize("tool", ["gcc", "clang"])
def test_pieces_give_no_warning(tool: str, tmp_path: Path) -> None:
    compiler = gcc() if tool == "gcc" else Compiler.zig()
    if compiler is None:
        pytest.skip("there is no gcc")
    used = (
        "void use(const double *x, double *y);\nvoid use(const double *x, double *y) {\n  mixture(x, x, x, y, y);\n}\n"
    )
    text = "#include <math.h>\n" + emit.function(mixture(20), "", whole=0, piece=9) + used
    (tmp_path / "all.c").write_text(text)
    options = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-c", "-o", str(tmp_path / "all.o"))
    done = subprocess.run(
        [*compiler.command, *options, str(tmp_path / "all.c")], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
