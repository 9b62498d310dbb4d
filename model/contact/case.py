"""What a contact is: two surfaces, their speeds and load, the oil between them, its size when dry. SI throughout."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import inf, log, pi, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates, spline_filter
from scipy.optimize import brentq
from scipy.special import ellipe, ellipkm1

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


@dataclass(frozen=True)
class Hertz:
    """Dry elastic contact of smooth bodies, the scale of every film (Johnson, Contact Mechanics, 4.2 and appendix 3).

    Half axes [m] along x and y, peak pressure [Pa] and approach [m]; of a line, `b` and `approach` are infinite.
    """

    a: float
    b: float
    p_max: float
    approach: float


def hertz(contact: Contact) -> Hertz:
    """The dry contact; of a line or a roller with rounded ends, that of the line with the same load per length."""
    if contact.R_y == inf or contact.edge_radius > 0:
        load = contact.F / contact.length
        a = sqrt(8 * load * contact.R_x / (pi * contact.E_eff))
        return Hertz(a, inf, 2 * load / (pi * a), inf)
    long, short = max(contact.R_x, contact.R_y), min(contact.R_x, contact.R_y)
    m = _modulus(long / short)  # squared ratio of the short to the long half axis
    first, second = float(ellipkm1(m)), float(ellipe(1 - m))
    e_star, curvature = contact.E_eff / 2, (1 / long + 1 / short) / 2
    small = (3 * contact.F * second * sqrt(m) / (2 * pi * e_star * curvature)) ** (1 / 3)
    large = small / sqrt(m)
    p_max = 3 * contact.F / (2 * pi * small * large)
    a, b = (small, large) if contact.R_y >= contact.R_x else (large, small)
    return Hertz(a, b, p_max, p_max * small * first / e_star)


def _modulus(ratio: float) -> float:
    """Square of the ratio of the half axes, short over long, for a ratio of the radii, long over short."""
    if ratio < 1 + 1e-6:
        return 1.0

    def defect(m: float) -> float:
        first, second = float(ellipkm1(m)), float(ellipe(1 - m))
        return (second / m - first) / (first - second) - ratio

    return float(brentq(defect, 0.1 / ratio**2, 1 - 1e-9, xtol=1e-15))


@dataclass(frozen=True)
class Texture:
    """A surface from heights on a grid, repeated in both directions; a cubic spline between them.

    Args:
        heights: height at the points (along x, along y), positive out of the body [m]
        spacing: distance of the points along x and along y [m]
    """

    heights: Array
    spacing: tuple[float, float]

    @cached_property
    def _spline(self) -> Array:
        """Coefficients of the spline."""
        return np.asarray(spline_filter(self.heights, order=3, mode="grid-wrap"))

    def __call__(self, x: Array, y: Array) -> Array:
        """Height [m] at places.

        Args:
            x: along the direction of rolling [m]
            y: across it [m]
        """
        at = np.stack([x / self.spacing[0], y / self.spacing[1]])
        return np.asarray(map_coordinates(self._spline, at, order=3, mode="grid-wrap", prefilter=False))


def gaussian_texture(
    sigma: float, length_x: float, length_y: float, *, n: int = 128, spacing: float, seed: int = 0
) -> Texture:
    """A random surface with a Gaussian distribution of heights and a Gaussian autocorrelation.

    White noise is filtered in the plane of wave numbers (Hu and Tonder, Int. J. Mach. Tools Manuf. 32, 1992).

    Args:
        sigma: root mean square height [m]
        length_x: along which the autocorrelation along x falls to 1/e [m]
        length_y: the same across [m]
        n: points along a side [1]
        spacing: distance of the points [m]
        seed: of the random numbers

    Raises:
        ScenarioError: the points do not resolve the surface
    """
    if min(length_x, length_y) < spacing:
        raise ScenarioError(
            f"texture: correlation lengths {length_x:g} and {length_y:g} m are below the spacing {spacing:g} m. "
            "Give a smaller spacing."
        )
    k = 2 * np.pi * np.fft.fftfreq(n, spacing)
    spectrum = np.exp(-((k[:, None] * length_x) ** 2 + (k[None, :] * length_y) ** 2) / 8)
    noise = np.fft.fft2(np.random.default_rng(seed).standard_normal((n, n)))
    heights = np.fft.ifft2(noise * spectrum).real
    heights -= heights.mean()
    return Texture(heights * (sigma / heights.std()), (spacing, spacing))
