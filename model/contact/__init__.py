"""Mixed elastohydrodynamic contacts solved on a grid (numpy and scipy, no CasADi): the source of film maps."""

from __future__ import annotations

from .case import (
    Contact as Contact,
    Hertz as Hertz,
    Lubricant as Lubricant,
    Texture as Texture,
    gaussian_texture as gaussian_texture,
    hertz as hertz,
)
from .film import Film as Film
from .line import solve_line as solve_line
from .line_cycle import solve_line_cycle as solve_line_cycle
from .point import solve as solve
from .transient import solve_transient as solve_transient
