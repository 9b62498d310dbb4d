"""The symbolic elimination: right against numpy, near-linear in what it does, and clear about what has no solution."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest
from gearheat.model.core.eliminate import Factors, Singular, typical_sizes
from hypothesis import given, settings, strategies as st


def solved(values: np.ndarray, right: np.ndarray, *, pivoting: bool) -> np.ndarray:
    pattern = ca.sparsify(ca.DM(values)).sparsity()
    matrix, b = ca.SX.sym("a", pattern), ca.SX.sym("b", *right.shape)
    sizes = [float(values[i, j]) for i, j in zip(*pattern.get_triplet(), strict=True)] if pivoting else None
    x = ca.Function("solve", [matrix, b], [Factors(matrix, sizes).solve(b)])(ca.DM(values)[pattern], right)
    return np.array(x)


def sparse(rng: np.random.Generator, n: int, share: float = 0.3) -> np.ndarray:
    return np.where(rng.random((n, n)) < share, rng.normal(size=(n, n)), 0.0)


@pytest.mark.parametrize("n", [1, 2, 7, 12, 40])
def test_diagonal_pivots_against_numpy(n: int) -> None:
    rng = np.random.default_rng(n)
    values, right = sparse(rng, n, min(0.3, 3 / n)) + 5 * np.eye(n), rng.normal(size=(n, 1))
    assert solved(values, right, pivoting=False) == pytest.approx(np.linalg.solve(values, right), rel=1e-12, abs=1e-14)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.integers(0, 10_000), st.integers(1, 25), st.floats(0.0, 6.0))
def test_pivots_where_they_are_needed_against_numpy(seed: int, n: int, decades: float) -> None:
    """No diagonal to rely on, entries over many decades: a permuted diagonal of any size, and entries anywhere."""
    rng = np.random.default_rng(seed)
    values = sparse(rng, n, min(0.5, 2 / n)) * 10 ** rng.uniform(-decades, 0, (n, n))
    values[np.arange(n), rng.permutation(n)] += 10 ** rng.uniform(-decades / 2, 0, n)
    right = rng.normal(size=(n, 2))
    x = solved(values, right, pivoting=True)
    error = np.abs(values @ x - right).max()
    assert error <= 1e-9 * max(1.0, np.abs(values).max() * np.abs(x).max())


def test_a_zero_on_the_diagonal_and_a_tiny_pivot() -> None:
    rings = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 2.0], [3.0, 0.0, 0.0]])
    assert solved(rings, np.ones((3, 1)), pivoting=True).ravel() == pytest.approx([1 / 3, 1, 1 / 2])
    tiny = np.array([[1e-17, 1.0], [1.0, 1.0]])
    assert solved(tiny, np.array([[1.0], [2.0]]), pivoting=True).ravel() == pytest.approx([1, 1], rel=1e-15)


def test_rows_that_say_the_same_are_told() -> None:
    values = np.array([[2.0, 0.0, 0.0, 0.0], [0.0, 1.0, -1.0, 0.0], [0.0, -1.0, 0.0, 1.0], [0.0, 0.0, 1.0, -1.0]])
    with pytest.raises(Singular) as found:
        solved(values * 0.1, np.ones((4, 1)), pivoting=True)
    assert len(found.value.rows) == 1
    assert set(found.value.rows) | set(found.value.columns) <= {1, 2, 3}


def test_an_empty_row_is_told() -> None:
    with pytest.raises(Singular) as found:
        Factors(ca.sparsify(ca.SX([[1.0, 2.0], [0.0, 0.0]])), [1.0, 2.0])
    assert found.value.rows == (1,)


def test_sizes_are_typical_values_and_one_where_there_is_none() -> None:
    a, b = ca.SX.sym("a"), ca.SX.sym("b")
    matrix = ca.vertcat(ca.horzcat(a * b, 0), ca.horzcat(3, ca.log(a - 2)))
    assert typical_sizes(ca.sparsify(matrix), {a.element_hash(): 2.0}) == [2.0, 3.0, 1.0]


def chain(n: int) -> ca.SX:
    return ca.SX.sym("a", ca.Sparsity.diag(n) + ca.Sparsity.band(n, 1) + ca.Sparsity.band(n, -1))


def star(n: int) -> ca.SX:
    rows, columns = [0] * n + list(range(n)), list(range(n)) + [0] * n
    return ca.SX.sym("a", ca.Sparsity.triplet(n, n, rows, columns) + ca.Sparsity.diag(n))


def grid(n: int) -> ca.SX:
    side = round(n**0.5)
    one, line = ca.Sparsity.diag(side), ca.Sparsity.diag(side) + ca.Sparsity.band(side, 1) + ca.Sparsity.band(side, -1)
    return ca.SX.sym("a", ca.kron(ca.DM(line), ca.DM(one)).sparsity() + ca.kron(ca.DM(one), ca.DM(line)).sparsity())


@pytest.mark.parametrize("pivoting", [False, True])
@pytest.mark.parametrize(("net", "n", "power"), [(chain, 256, 1.02), (star, 256, 1.02), (grid, 100, 1.7)])
def test_operations_grow_nearly_as_the_size(net: Callable[[int], ca.SX], n: int, power: float, pivoting: bool) -> None:
    """Chains and stars have an order without fill; on a grid the best known order makes n^1.5 in the limit."""

    def operations(n: int) -> int:
        matrix = net(n)
        diagonal = [4.0 if i == j else -1.0 for i, j in zip(*matrix.sparsity().get_triplet(), strict=True)]
        return Factors(matrix, diagonal if pivoting else None).operations

    assert operations(4 * n) / operations(n) < 4**power


def test_the_hub_of_a_star_is_eliminated_last() -> None:
    assert Factors(star(5)).operations == 4 * (1 + 2) + 4 * 2 + 1


def test_the_same_matrix_gives_the_same_expressions() -> None:
    values = sparse(np.random.default_rng(3), 20) + np.eye(20)
    matrix = ca.SX.sym("a", ca.sparsify(ca.DM(values)).sparsity())
    assert str(Factors(matrix).solve(ca.SX.ones(20))) == str(Factors(matrix).solve(ca.SX.ones(20)))
