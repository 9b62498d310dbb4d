"""Gear pairs as rating methods see them: two external cylindrical gears, for bevel gears the equivalent ones."""

from __future__ import annotations

from dataclasses import dataclass

from ..core.component import Component
from ..laws.gears import (
    addendum_contact_ratio,
    base_diameter,
    base_helix_angle,
    curvature_radius,
    reduced_radius,
    reference_diameter,
    tip_diameter,
    transverse_base_pitch,
    transverse_pressure_angle,
    working_pressure_angle,
)
from .gears import GearPair

#: Parameters that tell the teeth of a pair but for their numbers.
KEYS = ("m_n", "alpha_n", "beta", "b", "a_w", "x_1", "x_2", "Ra")


@dataclass(frozen=True)
class CylindricalPair:
    """Geometry of two external cylindrical gears in numbers [SI].

    Args:
        z_1, z_2: numbers of teeth, of equivalent gears not whole [1]
        m_n: normal module [m]
        alpha_n: normal pressure angle [rad]
        beta: helix angle at the reference cylinder [rad]
        b: face width [m]
        a_w: working centre distance [m]
        x_1, x_2: profile shifts [1]
        Ra: roughness of the flanks [m]
        diameters: reference diameters of the real gears, of bevel gears at mid face [m]
    """

    z_1: float
    z_2: float
    m_n: float
    alpha_n: float
    beta: float
    b: float
    a_w: float
    x_1: float
    x_2: float
    Ra: float
    diameters: tuple[float, float]

    @property
    def u(self) -> float:
        """Teeth ratio [1]."""
        return self.z_2 / self.z_1

    @property
    def alpha_t(self) -> float:
        """Transverse pressure angle [rad]."""
        return float(transverse_pressure_angle(self.alpha_n, self.beta))

    @property
    def alpha_wt(self) -> float:
        """Working transverse pressure angle [rad]."""
        return float(working_pressure_angle(self.alpha_t, sum(self.references) / 2, self.a_w))

    @property
    def beta_b(self) -> float:
        """Helix angle at the base cylinder [rad]."""
        return float(base_helix_angle(self.alpha_n, self.beta))

    @property
    def references(self) -> tuple[float, float]:
        """Reference diameters [m]."""
        d_1, d_2 = (float(reference_diameter(self.m_n, z, self.beta)) for z in (self.z_1, self.z_2))
        return d_1, d_2

    @property
    def pitches(self) -> tuple[float, float]:
        """Pitch diameters [m]."""
        d_w1 = 2 * self.a_w / (self.u + 1)
        return d_w1, self.u * d_w1

    @property
    def outsides(self) -> tuple[float, float]:
        """Tip diameters of these gears [m]."""
        d_a1, d_a2 = (
            float(tip_diameter(d, self.m_n, x)) for d, x in zip(self.references, (self.x_1, self.x_2), strict=True)
        )
        return d_a1, d_a2

    @property
    def tips(self) -> tuple[float, float]:
        """Tip diameters of the real gears, which dip into the oil [m]."""
        d_1, d_2 = self.diameters
        return d_1 + 2 * self.m_n * (1 + self.x_1), d_2 + 2 * self.m_n * (1 + self.x_2)

    @property
    def contact_ratios(self) -> tuple[float, float]:
        """Addendum contact ratios of pinion and wheel [1]."""
        p_et = transverse_base_pitch(self.m_n, self.beta, self.alpha_t)
        bases = (base_diameter(d, self.alpha_t) for d in self.references)
        eps_1, eps_2 = (
            float(addendum_contact_ratio(d_a, d_b, self.alpha_wt, p_et))
            for d_a, d_b in zip(self.outsides, bases, strict=True)
        )
        return eps_1, eps_2

    @property
    def R(self) -> float:
        """Reduced radius of curvature at the pitch point [m]."""
        rho_1, rho_2 = (curvature_radius(base_diameter(d, self.alpha_t), self.alpha_wt) for d in self.references)
        return float(reduced_radius(rho_1, rho_2, self.beta_b))


def pair_of(part: Component) -> CylindricalPair | None:
    """The cylindrical gears that mesh as a pair does; None where it is no pair of external gears."""
    if not isinstance(part, GearPair):
        return None
    v = part.values
    z_1, z_2 = (part.number_at(z, v) for z in part.teeth())
    if z_1 < 0 or z_2 < 0:
        return None
    d_1, d_2 = (float(reference_diameter(v["m_n"], z, v["beta"])) for z in (v["z_1"], v["z_2"]))
    return CylindricalPair(z_1=z_1, z_2=z_2, diameters=(d_1, d_2), **{key: v[key] for key in KEYS})
