"""Flexible GMRES: the correction of the multigrid cycle, made exact (Saad, SIAM J. Sci. Comput. 14, 1993)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .case import Array

Map = Callable[[Array], Array]


def fgmres(apply: Map, precondition: Map, b: Array, tolerance: float, steps: int) -> tuple[Array, int]:
    """Solves A x = b from x = 0; also how many products were needed.

    Args:
        apply: x -> A x
        precondition: r -> roughly A^-1 r
        b: right side (n,)
        tolerance: norm of the residual over that of b at which it stops
        steps: largest number of products
    """
    beta = float(np.linalg.norm(b))
    if beta == 0:
        return np.zeros_like(b), 0
    v, z = np.empty((steps + 1, b.size)), np.empty((steps, b.size))
    h = np.zeros((steps + 1, steps))
    v[0] = b / beta
    for k in range(steps):
        z[k] = precondition(v[k])
        w = apply(z[k])
        for _ in range(2):  # orthogonalised twice
            share = v[: k + 1] @ w
            h[: k + 1, k] += share
            w = w - share @ v[: k + 1]
        h[k + 1, k] = np.linalg.norm(w)
        rhs = np.zeros(k + 2)
        rhs[0] = beta
        y = np.linalg.lstsq(h[: k + 2, : k + 1], rhs, rcond=None)[0]
        left = float(np.linalg.norm(rhs - h[: k + 2, : k + 1] @ y))
        if left <= tolerance * beta or h[k + 1, k] <= 1e-14 * beta:
            break
        v[k + 1] = w / h[k + 1, k]
    return np.asarray(y @ z[: k + 1]), k + 1
