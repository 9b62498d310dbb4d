"""Linear operators on a grid with a few entries a node: an array (6, ny, nx), one layer for each of `OFFSETS`."""

from __future__ import annotations

import numpy as np

from .case import Array

#: Neighbours (along y, along x) in the order of the layers: itself, two upstream, one downstream, the two sides.
OFFSETS = ((0, 0), (0, -1), (0, -2), (0, 1), (-1, 0), (1, 0))
#: Layer of the node itself.
CENTRE = 0
#: Layer of the node upstream.
WEST = 1
#: Layer of the second node upstream.
WEST_2 = 2
#: Layer of the node downstream.
EAST = 3
#: Layer of the node at the side, before it.
SOUTH = 4
#: Layer of the node at the other side, behind it.
NORTH = 5


def apply(stencil: Array, f: Array) -> Array:
    """The operator times the field `f` of shape (ny, nx), which is 0 outside the grid.

    Args:
        stencil: layers of the operator (6, ny, nx)
        f: field (ny, nx)
    """
    out = stencil[CENTRE] * f
    out[:, 1:] += stencil[WEST, :, 1:] * f[:, :-1]
    out[:, 2:] += stencil[WEST_2, :, 2:] * f[:, :-2]
    out[:, :-1] += stencil[EAST, :, :-1] * f[:, 1:]
    out[1:] += stencil[SOUTH, 1:] * f[:-1]
    out[:-1] += stencil[NORTH, :-1] * f[1:]
    return np.asarray(out)
