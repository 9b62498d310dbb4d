"""The film of a pad against a finite-difference solution of the Reynolds equation, and against closed forms."""

import math

import casadi as ca
import numpy as np
import pytest
from gearheat.model.laws import pad
from hypothesis import given, strategies as st
from scipy.sparse import diags_array, eye_array, kron
from scipy.sparse.linalg import spsolve


def load_on_grid(xi: float, a: float, nx: int, nz: int) -> float:
    """Load of the pad by finite differences of d/dx(h^3 dp/dx) + xi^2 h^3 d2p/dz2 = -1, h from a to 1, p = 0 around."""
    faces = a + (1 - a) * np.arange(nx) / nx + (1 - a) / (2 * nx)
    h = a + (1 - a) * np.arange(1, nx) / nx
    flow = faces**3 * nx**2
    along = diags_array([flow[1:-1], -(flow[:-1] + flow[1:]), flow[1:-1]], offsets=[-1, 0, 1])
    across = diags_array([1.0, -2.0, 1.0], offsets=[-1, 0, 1], shape=(nz - 1, nz - 1)) * (nz * xi) ** 2
    matrix = kron(along, eye_array(nz - 1)) + kron(diags_array(h**3), across)
    pressure = spsolve(matrix.tocsc(), -np.ones((nx - 1) * (nz - 1)))
    return float(pressure.sum()) / (nx * nz)


def load(xi: float, a: float) -> float:
    """The load of a vanishing mesh, from two meshes of second order."""
    coarse, fine = load_on_grid(xi, a, 40, 40), load_on_grid(xi, a, 80, 80)
    return fine + (fine - coarse) / 3


def wide(a: float) -> float:
    """The load of the same equation for an infinitely wide pad."""
    return pad.wedge_coefficient(a) / (6 * (a - 1)) if a != 1 else 1 / 12


def test_the_solution_by_differences_converges() -> None:
    loads = [load_on_grid(0.5, 2.2, n, n) for n in (20, 40, 80)]
    assert (loads[0] - loads[1]) / (loads[1] - loads[2]) == pytest.approx(4.0, rel=0.05)
    assert load(0.02, 2.2) / wide(2.2) == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize("a", [1.2, 1.5, 2.2, 3.0, 4.0])
@pytest.mark.parametrize("xi", [0.1, 0.3, 0.5, 1.0, 2.0, 5.0])
def test_side_leakage(xi: float, a: float) -> None:
    assert pad.side_leakage(xi, a) == pytest.approx(load(xi, a) / wide(a), rel=2e-3)


@pytest.mark.parametrize("xi", [0.1, 0.5, 1.0, 2.0, 5.0])
def test_squeeze_factor(xi: float) -> None:
    assert pad.squeeze_factor(xi) == pytest.approx(load(xi, 1.0) / wide(1.0), rel=1e-3)


@pytest.mark.parametrize("xi", [0.5, 0.7, 1.0, 1.3])
def test_the_closed_form_is_five_sixths_and_not_five_quarters(xi: float) -> None:
    """5/6/(1 + xi^2) is within 8 % near xi = 1; the printed 5/4 is above 1 for a wide pad, which no leakage can be."""
    assert 5 / 6 / (1 + xi**2) == pytest.approx(load(xi, 2.2) / wide(2.2), rel=0.08)
    assert 5 / 4 / (1 + 0.3**2) > 1 > pad.side_leakage(0.3, 2.2)


def test_short_and_wide_limits() -> None:
    """A short pad has its leakage from flow across alone: 3 (a^2 - 1)/(a^2 C_w xi^2)/12 of a plate's 1/xi^2."""
    a = 2.2
    short = (a**2 - 1) / (4 * a**2 * pad.wedge_coefficient(a))
    assert pad.side_leakage(1e4, a) / pad.squeeze_factor(1e4) == pytest.approx(short, rel=1e-3)
    assert pad.squeeze_factor(1e4) == pytest.approx(1e-8, rel=1e-3)
    assert pad.side_leakage(1e-4, a) == pytest.approx(1.0, rel=1e-3)


positive = st.floats(1e-30, 1e-3)


@given(st.floats(1e-2, 1e5), positive, positive)
def test_the_cubic_holds(F: float, A: float, C: float) -> None:
    h = pad.combined_film(F, A, C)
    assert F * h**3 - A * h - C == pytest.approx(0.0, abs=1e-10 * F * h**3)
    assert h >= (1 - 1e-12) * max(math.sqrt(A / F), (C / F) ** (1 / 3))
    assert h <= (1 + 1e-12) * (math.sqrt(A / F) + (C / F) ** (1 / 3))


def test_the_films_do_not_add() -> None:
    """With wedge and squeeze of equal strength the sum of both films is 51 % too thick."""
    assert 2 / pad.combined_film(1.0, 1.0, 1.0) == pytest.approx(1.51, abs=0.005)


def test_slope_of_the_film_is_that_of_the_cubic() -> None:
    A, C = ca.SX.sym("A"), ca.SX.sym("C")
    h = pad.combined_film(240.0, A, C)
    slope = ca.Function("slope", [A, C], [ca.jacobian(h, ca.vertcat(A, C)), h])
    for a, c in ((1e-12, 1e-19), (1e-12, 0.0), (0.0, 1e-19)):
        (to_A, to_C), film = slope(a, c)[0].full().ravel(), float(slope(a, c)[1])
        steep = 3 * 240.0 * film**2 - a
        assert (to_A, to_C) == pytest.approx((film / steep, 1 / steep), rel=1e-10)


def test_filling_a_cylinder() -> None:
    shares = [pad.fill_volume_share(beta) for beta in (0.0, 0.2, 0.5, 1.0, 2.0, 1e9)]
    assert shares == sorted(shares)
    assert (shares[0], shares[3], shares[5]) == pytest.approx((0.0, 0.5, 1.0), abs=1e-7)
    assert shares[2] + shares[4] == pytest.approx(1.0, abs=1e-12)
