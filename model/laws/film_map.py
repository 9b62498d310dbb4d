"""Film maps: films of solved contacts as a smooth law of load, speed and viscosity.

Contacts of one shape, material and oil are similar: film over radius follows from load over radius, speed over radius
and viscosity. So a map that was solved for one radius holds for all of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import log
from typing import Literal

import casadi as ca

from ..sources import law
from .smooth import Num, smooth_abs, smooth_max, smooth_min

#: How far beyond the map its law is used, in halves of the range.
BEYOND = 0.01
#: Over what its end is rounded, in halves of the range.
BLUR = 0.004
#: Rounding at standstill [m/s].
U_WIDTH = 1e-6
#: Rounding without load [N/m of a line contact, N of a point contact].
F_WIDTH = 1e-3


@dataclass(frozen=True)
class Fit:
    """A quantity as exp of a sum of products of Chebyshev polynomials, and its largest relative error at the points."""

    coefficients: tuple[float, ...]
    error: float


@dataclass(frozen=True)
class FilmMap:
    """The law of a film map.

    `ranges` holds lowest and highest load, speed and viscosity. The load of a line is a force per length over the
    radius [N/m2], that of an ellipse a force over the squared radius [N/m2]; the speed is the mean one over the
    radius [1/s]; the viscosity is dynamic [Pa.s]. Beyond them the law stays what it is at the edge.

    Args:
        name: of the file, as a rig file writes it
        file: its place
        shape: "line" or "ellipse"
        ranges: lowest and highest of the three variables
        degrees: degree of each of the three polynomials, a triple for each product
        central: central film over radius [1]
        minimum: minimum film over radius [1]
        E_eff: effective modulus of the contacts [Pa]
        R_ratio: R_y over R_x of an ellipse [1]; 0 of a line
    """

    name: str
    file: str
    shape: Literal["line", "ellipse"]
    ranges: tuple[tuple[float, float], ...]
    degrees: tuple[tuple[int, int, int], ...]
    central: Fit
    minimum: Fit
    E_eff: float
    R_ratio: float = 0.0

    def __str__(self) -> str:
        """As a rig file names it, with the place of the file."""
        return f"map:{self.file}"

    def films(self, eta_0: Num, u_sum: Num, F: Num, R: Num) -> tuple[Num, Num]:
        """Central and minimum film [m].

        Args:
            eta_0: dynamic viscosity at the inlet [Pa.s]
            u_sum: sum of the speeds of the two surfaces through the contact, either sign [m/s]
            F: normal load per length of a line, normal force of an ellipse, either sign [N/m or N]
            R: reduced radius along the direction of rolling [m]
        """
        z = self._places(eta_0, u_sum, F, R)
        return R * self._value(self.central, z), R * self._value(self.minimum, z)

    def _places(self, eta_0: Num, u_sum: Num, F: Num, R: Num) -> list[Num]:
        """The three variables, -1 to 1 over their ranges, held at the edges."""
        names = ("load", "speed", "eta_0")
        ranges = dict(zip(names, self.ranges, strict=True))

        @law(source="Gearheat", where=self.name, valid="contacts of the map", ranges=ranges, verified=False)
        def film_map(load: Num, speed: Num, eta_0: Num) -> list[Num]:
            values = (load, speed, eta_0)
            return [_find_place(v, *limits) for v, limits in zip(values, self.ranges, strict=True)]

        load = smooth_abs(F, F_WIDTH) / (R if self.shape == "line" else R * R)
        return film_map(load, smooth_abs(u_sum, U_WIDTH) / (2 * R), eta_0)

    def _value(self, fit: Fit, z: Sequence[Num]) -> Num:
        return ca.exp(sum(c * b for c, b in zip(fit.coefficients, products(z, self.degrees), strict=True)))


def _find_place(value: Num, low: float, high: float) -> Num:
    """Place of the logarithm of a value in a range, -1 to 1, and at the edge outside it; 0 in a range of one value."""
    if not high > low * (1 + 1e-9):
        return 0.0
    z = (2 * ca.log(value) - log(low) - log(high)) / log(high / low)
    return smooth_min(smooth_max(z, -1 - BEYOND, BLUR), 1 + BEYOND, BLUR)


def products(z: Sequence[Num], degrees: Sequence[tuple[int, int, int]]) -> list[Num]:
    """Products of Chebyshev polynomials of the three variables.

    Args:
        z: the variables, -1 to 1 [1]
        degrees: degree of each of the three polynomials, a triple for each product
    """
    highest = max((d for triple in degrees for d in triple), default=0)
    lines: list[list[Num]] = []
    for x in z:
        line = [1.0, x]
        for _ in range(2, highest + 1):
            line.append(2 * x * line[-1] - line[-2])
        lines.append(line)
    return [lines[0][i] * lines[1][j] * lines[2][k] for i, j, k in degrees]
