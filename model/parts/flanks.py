"""The flanks of a mesh at work: curvature, speeds and contact ratios along the path of contact, in numbers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import cos, inf, pi, tan

from ..core.component import Component
from ..laws.gears import (
    addendum_contact_ratio,
    base_diameter,
    base_helix_angle,
    overlap_ratio,
    tip_diameter,
    transverse_base_pitch,
)
from ..laws.smooth import Num
from .gears import GearPair
from .planetary import PlanetarySet
from .teeth import ToothedPart

#: Thermal contact coefficient of case-hardened steel, root of 50 W/(m.K) times 3.8e6 J/(m3.K) [J/(m2.K.s0.5)].
STEEL = 13784.0
#: Share of a flank's way from the pitch point to its base circle that touches at most: undercut teeth end there [1].
INVOLUTE = 0.95


@dataclass(frozen=True)
class Flanks:
    """One mesh at an operating point, in SI; what belongs to an internal second gear is negative.

    Args:
        name: of the mesh
        z: numbers of teeth [1]
        alpha_t, alpha_wt, beta_b: transverse and working transverse pressure angle, base helix angle [rad]
        r_b: base radius of the first gear [m]
        eps: addendum contact ratios of both gears [1]
        eps_beta: overlap ratio [1]
        b, a_w: face width, centre distance [m]
        Ra: roughness of the flanks [m]
        E_eff: effective modulus, 2/E' of both gears [Pa]
        F_bt: force along the path of contact, in the transverse plane [N]
        w: speed of the first gear against the line of centres, not negative [rad/s]
        mu: friction coefficient of the mesh [1]
        B_M: thermal contact coefficient of the gears [J/(m2.K.s0.5)]
    """

    name: str
    z: tuple[float, float]
    alpha_t: float
    alpha_wt: float
    beta_b: float
    r_b: float
    eps: tuple[float, float]
    eps_beta: float
    b: float
    a_w: float
    Ra: float
    E_eff: float
    F_bt: float
    w: float
    mu: float
    B_M: float = STEEL

    @property
    def p_et(self) -> float:
        """Transverse base pitch [m]."""
        return 2 * pi * self.r_b / self.z[0]

    @property
    def path(self) -> float:
        """Length of the path of contact [m]."""
        return sum(self.eps) * self.p_et

    @property
    def rho_C(self) -> float:
        """Radius of curvature of the first gear at the pitch point, in the transverse plane [m]."""
        return self.r_b * tan(self.alpha_wt)

    @property
    def u(self) -> float:
        """Teeth ratio, negative for an internal second gear [1]."""
        return self.z[1] / self.z[0]

    @property
    def P(self) -> float:
        """Power through the mesh [W]."""
        return self.F_bt * self.r_b * self.w

    def at(self, g: float) -> tuple[float, float, float]:
        """Reduced radius normal to the teeth [m] and the speeds of both flanks through the contact [m/s].

        Args:
            g: distance from the begin of the path of contact, the tip of the second gear [m]
        """
        y = g - self.eps[1] * self.p_et
        rho_1, rho_2 = self.rho_C + y, self.u * self.rho_C - y
        R = rho_1 * rho_2 / (rho_1 + rho_2) / cos(self.beta_b)
        return R, self.w * rho_1, self.w * rho_2 / self.u


def flanks_of(part: Component, values: Mapping[str, float]) -> Iterator[Flanks]:
    """The flanks of each mesh of a part; none where it has no involute teeth.

    A planetary set tells contact ratios and no tips: those of unshifted gears stand in the ratio in which they share.

    Args:
        part: of any type
        values: its parameters and outputs at an operating point, by key, and speeds of its shafts, "sun.w", in SI
    """
    if isinstance(part, GearPair):
        mesh = _flanks(part, values, ("", ""), part.teeth(), part.addendum_ratios())
        yield replace(mesh, w=values["u_m"] / mesh.rho_C)
    elif isinstance(part, PlanetarySet):
        w = abs(values["sun.w"] - values["carrier.w"])
        for kind, z_a, z_b in (("sp", part.z_1, part.z_2), ("pr", part.z_2, -part.z_3)):
            tips = [_standard_addendum(part, z) for z in (z_a, z_b)]
            scale = getattr(part, f"eps_alpha_{kind}") / sum(tips)
            mesh = _flanks(part, values, (f".{kind}", f"_{kind}"), (z_a, z_b), [scale * tip for tip in tips])
            yield replace(mesh, w=w * values["z_1"] / mesh.z[0])


def _standard_addendum(part: ToothedPart, z: Num) -> Num:
    """Addendum contact ratio of a gear without profile shift [1]."""
    alpha_t, alpha_wt = part.working_angle()
    d, p_et = 2 * part.radius(z), transverse_base_pitch(part.m_n, part.beta, alpha_t)
    return addendum_contact_ratio(tip_diameter(d, part.m_n, 0.0), base_diameter(d, alpha_t), alpha_wt, p_et)


def _flanks(
    part: ToothedPart,
    values: Mapping[str, float],
    endings: tuple[str, str],
    teeth: tuple[Num, Num],
    addendum: Sequence[Num],
) -> Flanks:
    """Flanks at rest; what a name and the keys of force and friction end with tells which mesh of the part it is."""

    def number(expression: Num) -> float:
        return part.number_at(expression, values)

    alpha_t, alpha_wt = part.working_angle()
    z = number(teeth[0]), number(teeth[1])
    ends = [INVOLUTE * k / (2 * pi) * tan(number(alpha_wt)) if k > 0 else inf for k in z]
    return Flanks(
        name=part.name + endings[0],
        z=z,
        alpha_t=number(alpha_t),
        alpha_wt=number(alpha_wt),
        beta_b=number(base_helix_angle(part.alpha_n, part.beta)),
        r_b=number(base_diameter(part.radius(teeth[0]), alpha_t)),
        eps=(min(number(addendum[0]), ends[1]), min(number(addendum[1]), ends[0])),
        eps_beta=number(overlap_ratio(part.b, part.m_n, part.beta)),
        b=values["b"],
        a_w=values["a_w"],
        Ra=values["Ra"],
        E_eff=values["E"] / (1 - values["poisson"] ** 2),
        F_bt=values[f"F_t{endings[1]}"] / cos(number(alpha_t)),
        w=0.0,
        mu=values[f"mu{endings[1]}"],
    )
