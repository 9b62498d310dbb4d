"""Smooth corners: exact far away, never on the wrong side, with the slope they claim."""

import casadi as ca
import pytest
from gearheat.model.laws.smooth import (
    friction_sign,
    smooth_abs,
    smooth_cap,
    smooth_magnitude,
    smooth_max,
    smooth_min,
    smooth_power,
    smooth_sign,
    to_rpm,
)
from hypothesis import given, strategies as st

number = st.floats(-1e3, 1e3)
width = st.floats(1e-6, 1.0)


@given(number, width)
def test_sides(x: float, w: float) -> None:
    assert smooth_abs(x, w) >= abs(x)
    assert smooth_abs(x, w) >= w
    assert 0 <= smooth_magnitude(x, w) <= abs(x)
    assert -1 <= smooth_sign(x, w) <= 1
    assert x * smooth_sign(x, w) >= 0
    assert smooth_power(x, 0.6, w) >= 0


@given(number, number, width)
def test_max_and_min(a: float, b: float, w: float) -> None:
    slack = 1e-12 * (abs(a) + abs(b) + w)
    assert max(a, b) - slack <= smooth_max(a, b, w) <= max(a, b) + 0.5 * w + slack
    assert min(a, b) - 0.5 * w - slack <= smooth_min(a, b, w) <= min(a, b) + slack
    assert smooth_max(a, b, w) + smooth_min(a, b, w) == pytest.approx(a + b, abs=slack)


@given(number, width)
def test_even_and_odd(x: float, w: float) -> None:
    assert smooth_abs(-x, w) == smooth_abs(x, w)
    assert smooth_magnitude(-x, w) == smooth_magnitude(x, w)
    assert smooth_power(-x, 0.31, w) == smooth_power(x, 0.31, w)
    assert smooth_sign(-x, w) == -smooth_sign(x, w)


@pytest.mark.parametrize("x", [10.0, -10.0, 300.0])
def test_exact_to_one_in_a_million_at_nominal(x: float) -> None:
    """100 rpm is 10 rad/s; the default width is 0.01 rad/s."""
    assert smooth_abs(x) == pytest.approx(abs(x), rel=1e-6)
    assert smooth_magnitude(x) == pytest.approx(abs(x), rel=1e-6)
    assert smooth_sign(x) == pytest.approx(x / abs(x), rel=1e-6)
    assert smooth_power(x, 0.6) == pytest.approx(abs(x) ** 0.6, rel=1e-6)


def test_sign_is_the_slope_of_abs() -> None:
    x = ca.SX.sym("x")
    difference = ca.Function("d", [x], [ca.gradient(smooth_abs(x, 0.1), x) - smooth_sign(x, 0.1)])
    assert all(abs(float(difference(v))) < 1e-15 for v in (-3, -0.1, 0, 0.05, 2))


@pytest.mark.parametrize("exponent", [0.2, 0.54, 1.0, 1.28, 3.0, 5.0])
def test_power_is_flat_at_zero(exponent: float) -> None:
    x = ca.SX.sym("x")
    value = smooth_power(x, exponent, 0.1)
    f = ca.Function("f", [x], [value, ca.gradient(value, x)])
    assert [float(v) for v in f(0)] == [0.0, 0.0]


@given(st.floats(0.0, 1e12), st.floats(1e-3, 1e6), st.floats(1.0, 1e3))
def test_cap_rises_to_its_limit(x: float, limit: float, more: float) -> None:
    assert 0 <= smooth_cap(x, limit) <= min(x, limit) * (1 + 1e-12)
    assert smooth_cap(more * x, limit) >= smooth_cap(x, limit) * (1 - 1e-12)
    assert smooth_cap(0.1 * limit, limit) == pytest.approx(0.1 * limit, rel=1e-8)


@given(number)
def test_friction_opposes_and_holds(w: float) -> None:
    """Odd, never pushing; 0.99 of the full torque is there at 1.4 widths."""
    assert w * friction_sign(w) >= 0
    assert friction_sign(-w) == -friction_sign(w)
    assert abs(friction_sign(w)) <= 1 + 1e-12
    assert friction_sign(1.4 * 5e-5) > 0.99
    assert friction_sign(0.1) == pytest.approx(1.0, abs=1e-12)


def test_to_rpm() -> None:
    assert to_rpm(ca.pi) == pytest.approx(30)
