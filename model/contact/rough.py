"""Rough surfaces: heights over the plane, measured or drawn, smooth between their points and periodic."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.ndimage import map_coordinates, spline_filter

from ..errors import ScenarioError
from .case import Array


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
