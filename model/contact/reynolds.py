"""Reynolds' equation on a grid, second order in space, and what it becomes for small changes of pressure and film.

In units of the Hertz contact (x, y over a; p over p_h; h over a^2/R_x; t over a/u_m) it reads

    div(eps grad p) - s dm/dx - dm/dt = 0,    eps = kappa rho h^3 / (eta/eta_0),    m = rho (h - h_b) + h_b,

with kappa = p_h a^3 / (12 eta_0 u_m R_x^2) and s = 1 (0 at rest). The last molecules h_b of a film are bound to the
surfaces and as stiff as they are; without them m = rho h. The wedge is differenced upstream over three nodes, eps is
the mean of two neighbours (Venner and Lubrecht, Multilevel Methods in Lubrication, 2000, chapters 5 and 6).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from . import stencil
from .case import Array, Lubricant


@dataclass(frozen=True)
class Reynolds:
    """The equation on one grid at one moment.

    Args:
        lubricant: the oil
        p_unit: the unit of pressure [Pa]
        kappa: factor of the pressure flow [1]
        wedge: factor of the wedge [1]
        hx: distance of nodes along x [1]
        hy: distance of nodes along y [1]
        squeeze: factor of the present d(rho h)/dt, 0 in the steady state [1]
        past: what earlier moments add to d(rho h)/dt, (ny, nx) or 0
        bound: film of molecules bound to the surfaces, which is moved but not compressed [1]
        steep: whether the film may open from one node to the next across the rolling, at the ends of a roller: the
            mobility between such nodes is the harmonic mean, that of the two halves one after the other
    """

    lubricant: Lubricant
    p_unit: float
    kappa: float
    wedge: float
    hx: float
    hy: float
    squeeze: float = 0.0
    past: Array | float = 0.0
    bound: float = 0.0
    steep: bool = False

    def mass(self, p: Array, h: Array) -> Array:
        """Mass of the film over an area and the density at ambient pressure [1].

        Args:
            p: pressure [1]
            h: film [1]
        """
        return np.asarray(self.lubricant.density(p * self.p_unit) * (h - self.bound) + self.bound)

    def mobility(self, p: Array, h: Array) -> Array:
        """The factor eps of the pressure flow [1].

        Args:
            p: pressure of the fluid [1]
            h: film [1]
        """
        oil, si = self.lubricant, p * self.p_unit
        return np.asarray(self.kappa * oil.density(si) * h**3 * oil.eta_0 / oil.viscosity(si))

    def residual(self, p: Array, h: Array) -> Array:
        """What is left of the equation at the nodes within the border (ny, nx).

        Args:
            p: pressure of the fluid [1]
            h: film [1]
        """
        eps = self.mobility(p, h)
        mass = self.mass(p, h)
        flow_x = (eps[1:-1, 1:] + eps[1:-1, :-1]) * np.diff(p[1:-1], axis=1) / (2 * self.hx**2)
        flow_y = self._across(eps)[0][:, 1:-1] * np.diff(p[:, 1:-1], axis=0) / self.hy**2
        out = np.zeros_like(p)
        wedge = 1.5 * mass[1:-1, 1:-1] - 2 * mass[1:-1, :-2]
        wedge[:, 1:] += 0.5 * mass[1:-1, :-3]
        wedge[:, 0] = mass[1:-1, 1] - mass[1:-1, 0]
        out[1:-1, 1:-1] = np.diff(flow_x, axis=1) + np.diff(flow_y, axis=0) - self.wedge / self.hx * wedge
        if self.squeeze:
            out[1:-1, 1:-1] -= (self.squeeze * mass + self.past)[1:-1, 1:-1]
        return out

    def linear(self, p: Array, h: Array) -> tuple[Array, Array]:
        """Change of the residual with the pressure and with the film: two stencils.

        Args:
            p: pressure of the fluid [1]
            h: film [1]
        """
        oil, si = self.lubricant, p * self.p_unit
        eps, rho = self.mobility(p, h), oil.density(si)
        rho_p = oil.density_slope(si) * self.p_unit
        eps_p = eps * (rho_p / rho - oil.viscosity_slope(si) * self.p_unit)
        by_p, by_h = np.zeros((6, *p.shape)), np.zeros((6, *p.shape))
        self._pressure_flow(by_p, p, eps)
        self._mobility_change(by_p, p, eps, eps_p)
        self._mobility_change(by_h, p, eps, 3 * eps / h)
        self._mass_change(by_p, rho_p * (h - self.bound))
        self._mass_change(by_h, rho)
        for layer in (by_p, by_h):
            layer[:, [0, -1], :] = 0.0
            layer[:, :, [0, -1]] = 0.0
        return by_p, by_h

    def _pressure_flow(self, out: Array, p: Array, eps: Array) -> None:
        """Adds div(eps grad .)."""
        x = (eps[:, 1:] + eps[:, :-1]) / (2 * self.hx**2)
        y = self._across(eps)[0] / self.hy**2
        out[stencil.EAST, :, :-1] += x
        out[stencil.WEST, :, 1:] += x
        out[stencil.NORTH, :-1] += y
        out[stencil.SOUTH, 1:] += y
        out[stencil.CENTRE, :, 1:-1] -= x[:, 1:] + x[:, :-1]
        out[stencil.CENTRE, 1:-1] -= y[1:] + y[:-1]

    def _across(self, eps: Array) -> tuple[Array, Array, Array]:
        """Mobility between neighbours across the rolling, and its change with that of the lower and of the upper."""
        low, high = eps[:-1], eps[1:]
        if not self.steep:
            half = np.full_like(low, 0.5)
            return (low + high) / 2, half, half
        both = low + high + 1e-300
        return 2 * low * high / both, 2 * (high / both) ** 2, 2 * (low / both) ** 2

    def _mobility_change(self, out: Array, p: Array, eps: Array, slope: Array) -> None:
        """Adds div(slope . grad p)."""
        x = np.diff(p, axis=1) / (2 * self.hx**2)
        y = np.diff(p, axis=0) / self.hy**2
        _, low, high = self._across(eps)
        out[stencil.EAST, :, :-1] += slope[:, 1:] * x
        out[stencil.WEST, :, 1:] -= slope[:, :-1] * x
        out[stencil.CENTRE, :, 1:-1] += slope[:, 1:-1] * np.diff(x, axis=1)
        out[stencil.NORTH, :-1] += slope[1:] * high * y
        out[stencil.SOUTH, 1:] -= slope[:-1] * low * y
        out[stencil.CENTRE, 1:-1] += slope[1:-1] * ((low * y)[1:] - (high * y)[:-1])

    def _mass_change(self, out: Array, slope: Array) -> None:
        """Subtracts d(slope .)/dx and d(slope .)/dt."""
        rate = self.wedge / self.hx
        out[stencil.CENTRE] -= (1.5 * rate + self.squeeze) * slope
        out[stencil.WEST, :, 1:] += 2 * rate * slope[:, :-1]
        out[stencil.WEST_2, :, 2:] -= 0.5 * rate * slope[:, :-2]
        out[stencil.CENTRE, :, 1] += 0.5 * rate * slope[:, 1]
        out[stencil.WEST, :, 1] -= rate * slope[:, 0]
