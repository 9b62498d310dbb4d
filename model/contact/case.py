"""What a contact is: two surfaces, their speeds and load, and the oil between them. SI throughout."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, log

import numpy as np
from numpy.typing import NDArray

from ..errors import ScenarioError

Array = NDArray[np.float64]
#: Roelands: viscosity at the pole [Pa.s], so that ln(eta / ETA_POLE) is the printed ln(eta) + 9.67.
ETA_POLE = 6.31e-5


@dataclass(frozen=True)
class Lubricant:
    """The oil at the inlet's temperature.

    Args:
        eta_0: dynamic viscosity at ambient pressure [Pa.s]
        alpha_p: pressure-viscosity coefficient at ambient pressure [1/Pa]
        p_r: constant of Roelands' law [Pa]
        piezoviscous: "roelands", or "barus" for eta = eta_0 exp(alpha_p p)
        compressible: whether the density follows Dowson and Higginson; constant otherwise
        tau_eyring: shear stress at which the oil begins to thin, for friction [Pa]
    """

    eta_0: float
    alpha_p: float
    p_r: float = 1.96e8
    piezoviscous: str = "roelands"
    compressible: bool = True
    tau_eyring: float = 5e6

    def viscosity(self, p: Array) -> Array:
        """Dynamic viscosity [Pa.s] at a pressure [Pa]."""
        if self.piezoviscous == "barus":
            return np.asarray(self.eta_0 * np.exp(self.alpha_p * p))
        ln = log(self.eta_0 / ETA_POLE)
        return np.asarray(self.eta_0 * np.exp(ln * ((1 + p / self.p_r) ** (self.alpha_p * self.p_r / ln) - 1)))

    def viscosity_slope(self, p: Array) -> Array:
        """Relative slope of the viscosity, d(ln eta)/dp [1/Pa], at a pressure [Pa]."""
        if self.piezoviscous == "barus":
            return np.full_like(p, self.alpha_p)
        z = self.alpha_p * self.p_r / log(self.eta_0 / ETA_POLE)
        return np.asarray(self.alpha_p * (1 + p / self.p_r) ** (z - 1))

    def density(self, p: Array) -> Array:
        """Density over that at ambient pressure [1] at a pressure [Pa]."""
        return np.asarray(1 + 0.6e-9 * p / (1 + 1.7e-9 * p)) if self.compressible else np.ones_like(p)

    def density_slope(self, p: Array) -> Array:
        """Slope of the relative density [1/Pa] at a pressure [Pa]."""
        return np.asarray(0.6e-9 / (1 + 1.7e-9 * p) ** 2) if self.compressible else np.zeros_like(p)


@dataclass(frozen=True)
class Contact:
    """One contact at one moment.

    Rolling is along x. With `R_y` infinite and no `edge_radius` it is a line contact: all results hold per length of
    `length`. With an `edge_radius` it is a roller of finite length, straight (or crowned by `R_y`) between rounded
    ends. Otherwise it is an elliptical contact.

    Args:
        F: normal force [N]
        R_x: reduced radius along the direction of rolling [m]
        u_1: speed of the first surface through the contact [m/s]
        u_2: speed of the second surface through the contact [m/s]
        E_eff: effective modulus, 2/E_eff = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2 [Pa]
        lubricant: the oil
        R_y: reduced radius across the direction of rolling [m]
        length: of a line contact or a roller [m]
        edge_radius: of the rounded ends of a roller [m]; 0 for none
        mu_boundary: friction coefficient where the surfaces touch [1]

    Raises:
        ScenarioError: all values that make no contact at once
    """

    F: float
    R_x: float
    u_1: float
    u_2: float
    E_eff: float
    lubricant: Lubricant
    R_y: float = inf
    length: float = 1.0
    edge_radius: float = 0.0
    mu_boundary: float = 0.12

    def __post_init__(self) -> None:
        named = {"F": self.F, "R_x": self.R_x, "E_eff": self.E_eff, "R_y": self.R_y, "length": self.length}
        problems = [
            f"contact: {k} = {v:g} is out of range. Give a value above 0." for k, v in named.items() if not v > 0
        ]
        if problems:
            raise ScenarioError(problems)

    @property
    def u_m(self) -> float:
        """Mean entrainment speed [m/s]."""
        return (self.u_1 + self.u_2) / 2
