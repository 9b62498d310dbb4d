"""Newton's method for pressure and approach on one grid, with the set of nodes under pressure found on the way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from . import stencil
from .case import Array
from .grid import Grid
from .krylov import fgmres
from .multigrid import Cycle, Linear, linearise
from .reynolds import Reynolds


@dataclass(frozen=True)
class State:
    """Pressure (n, n) and approach, and how they were found.

    Args:
        p: pressure of the fluid [1]
        h_0: film at the origin without deformation [1]
        residuals: scaled residual before each step
        products: applications of the full operator
    """

    p: Array
    h_0: float
    residuals: tuple[float, ...] = ()
    products: int = 0


def newton(
    grid: Grid, reynolds: Reynolds, gap: Array, load: float, start: State, tolerance: float, steps: int
) -> State:
    import os

    verbose = os.environ.get("EHLV")
    p, h_0 = start.p.copy(), start.h_0
    inner = np.zeros(p.shape, dtype=bool)
    inner[1:-1, 1:-1] = True
    none = np.zeros_like(inner)
    cell = grid.hx * grid.hy
    norms: list[float] = []
    products = start.products
    for it in range(steps):
        h = h_0 + gap + grid.deformation(p)
        r = reynolds.residual(p, h)
        active = inner & ((p > 0) | (r > 0))
        linear = linearise(grid, reynolds, p, h, active, none)
        diag = np.abs(linear.by_p[stencil.CENTRE]) + np.abs(linear.by_h[stencil.CENTRE]) * grid.deformation.near[0, 0]
        scale = 1 / np.where(active, diag, 1.0)
        missing = load - cell * p.sum()
        lscale = grid.n / load
        b = np.append((-r * scale * active).ravel(), missing * lscale)
        norm = float(np.linalg.norm(b)) / grid.n
        norms.append(norm)
        if norm < tolerance:
            break
        cycle = Cycle(linear, reynolds, p, h)

        def apply(v: Array) -> Array:
            f = v[:-1].reshape(p.shape)
            return np.append((linear(f, v[-1]) * scale).ravel(), linear.load(f) * lscale)

        def pre(v: Array) -> Array:
            f, dh = cycle(v[:-1].reshape(p.shape) / scale, v[-1] / lscale)
            return np.append(f.ravel(), dh)

        x, k = fgmres(apply, pre, b, 1e-2, 30)
        products += k
        dp, dh0 = x[:-1].reshape(p.shape), x[-1]
        dh = grid.deformation(dp) + dh0
        with np.errstate(divide="ignore"):
            room = np.min(np.where(dh < 0, -0.8 * h / dh, np.inf))
        step = min(1.0, room)
        p = np.maximum(p + step * dp, 0.0)
        h_0 += step * dh0
        if verbose:
            print(
                f"  n={grid.n} it={it} res={norm:.2e} k={k} step={step:.2f} dpmax={np.abs(dp).max():.2e} hmin={h.min():.3e} pmax={p.max():.3f}"
            )
    return State(p, h_0, tuple(norms), products)
