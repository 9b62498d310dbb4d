"""Scalar functions as C: every operation, compiled and called, gives CasADi's own value."""

import ctypes
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from gearheat.fmu import emit
from gearheat.fmu.compiling import binary, host_platform
from gearheat.model.errors import FmuError


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
