"""Bevel gears: at mid face they mesh as two cylindrical gears on the back cones do."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import ClassVar

import casadi as ca

from ..core.component import Equation, Related, equation
from ..core.declare import Choice, Output, Parameter
from ..laws.bevel import bevel_axial_force, bevel_radial_force, mean_diameter, pitch_angle, virtual_teeth
from ..laws.smooth import Num, smooth_sign
from .gears import GearPair
from .ports import ToothForce
from .relations import require

#: Largest pitch angle [rad]: the virtual gear of a flat crown wheel has no end.
FLAT = 1.53
#: Face width over cone distance beyond which mid face no longer stands for the whole tooth.
WIDEST = 0.4


class BevelGearPair(GearPair):
    """Two bevel gears on shafts that intersect: spiral, or straight with beta = 0.

    Friction, film and loss are those of the virtual cylindrical gears at mid face. Seen from their backs the gears turn
    in opposite directions. An axial force is positive away from the apex; a support takes it as one towards its
    bearing a.
    """

    axes: ClassVar[str] = "intersecting"

    pinion_force = ToothForce()
    wheel_force = ToothForce()

    spiral = Choice(
        ("away", "towards"),
        "where the spiral pushes the pinion that drives forwards: away from the apex (concave flank) or towards it",
        default="away",
    )
    shaft_angle = Parameter("rad", "angle between the shafts", default=math.pi / 2, above=0.0, below=3.1)
    m_et = Parameter("m", "transverse module at the outer end", nominal=1e-3, above=0.0)
    m_n = Parameter("m", "normal module at mid face", nominal=1e-3, above=0.0, derived=lambda p: p.mean_module())
    beta = Parameter("rad", "spiral angle at mid face, 0 for straight teeth", at_least=0.0, below=1.2)
    x_1 = Parameter("1", "profile shift of the pinion at mid face")
    x_2 = Parameter("1", "profile shift of the wheel, that of the pinion with the other sign", derived=lambda p: -p.x_1)
    a_w = Parameter(
        "m",
        "centre distance of the virtual cylindrical gears",
        nominal=0.1,
        above=0.0,
        derived=lambda p: p.radius(sum(p.teeth())),
    )

    F_a_1 = Output("N", "axial force on the pinion, positive away from the apex", nominal=1000.0)
    F_a_2 = Output("N", "axial force on the wheel, positive away from the apex", nominal=1000.0)

    def cones(self) -> tuple[Num, Num]:
        """Pitch angles of pinion and wheel [rad]."""
        delta_1 = pitch_angle(self.z_2 / self.z_1, self.shaft_angle)
        return delta_1, self.shaft_angle - delta_1

    def teeth(self) -> tuple[Num, Num]:
        """Of the virtual cylindrical gears."""
        delta_1, delta_2 = self.cones()
        return virtual_teeth(self.z_1, delta_1), virtual_teeth(self.z_2, delta_2)

    def mean_module(self) -> Num:
        """Normal module at mid face, from the outer one [m]."""
        d_m = mean_diameter(self.m_et * self.z_2, self.b, self.cones()[1])
        return d_m / self.z_2 * ca.cos(self.beta)

    def relations(self) -> Iterator[Related]:
        """Two cones with teeth of one size, and a face that is not too wide."""
        yield from super().relations()
        delta_2 = self.cones()[1]
        yield require(self, "the wheel is a cone", delta_2, 0.0, FLAT)
        yield require(self, "m_et fits m_n", self.mean_module() / self.m_n, 0.99, 1.01)
        yield require(self, "b fits the cones", 2 * self.b * ca.sin(delta_2) / (self.m_et * self.z_2), 0.0, WIDEST)

    def equations(self) -> Iterator[Equation]:
        """Each gear has forces of its own; the torque decides which flanks bear, and so where the spiral pushes."""
        yield from super().equations()
        away = smooth_sign(self.pinion.tau, self.tau_width) * (1 if self.spiral == "away" else -1)
        ways = ((self.pinion_force, self.F_a_1, away), (self.wheel_force, self.F_a_2, -away))
        for name, delta, (force, F_a, k) in zip(("pinion", "wheel"), self.cones(), ways, strict=True):
            radial = bevel_radial_force(self.F_t, self.alpha_n, self.beta, delta, k)
            axial = bevel_axial_force(self.F_t, self.alpha_n, self.beta, delta, k)
            yield equation(f"tangential force on the {name}", force.F_t, self.F_t)
            yield equation(f"radial force on the {name}", force.F_r, radial)
            yield equation(f"axial force on the {name}", F_a, axial)
            yield equation(f"axial force on the {name} told", force.F_a, F_a)
