"""Mixed elastohydrodynamic contacts solved on a grid (numpy and scipy, no CasADi): the source of film maps."""

from __future__ import annotations

from .case import Contact, Hertz, Lubricant, Texture, gaussian_texture, hertz
from .film import Film
from .line import solve_line
from .line_cycle import solve_line_cycle
from .point import solve
from .transient import solve_transient

__all__ = [
    "Contact",
    "Film",
    "Hertz",
    "Lubricant",
    "Texture",
    "gaussian_texture",
    "hertz",
    "solve",
    "solve_line",
    "solve_line_cycle",
    "solve_transient",
]
