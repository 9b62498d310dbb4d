"""Statics of shafts: what the tooth forces of gears make of the loads of two bearings."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

import casadi as ca

from ..core.component import SOUND, Component, Equation, Faults, Related, equation
from ..core.declare import Parameter
from ..laws.smooth import Num, smooth_abs
from .ports import BearingLoad, ToothForce
from .relations import require

#: Force below which the direction of a bearing load is blurred [N].
FORCE_WIDTH = 1.0


class ShaftSupport(Component):
    """Statics of a shaft with one gear on two bearings a and b.

    A positive axial force pushes the gear towards bearing a: of a bevel gear, the apex is on the side of bearing b.
    """

    faults: ClassVar[Faults] = SOUND

    mesh = ToothForce()
    load_a = BearingLoad()
    load_b = BearingLoad()

    span = Parameter("m", "distance of the bearings", nominal=0.1, above=0.0)
    x = Parameter("m", "position of the gear, from bearing a", nominal=0.1)
    r = Parameter("m", "radius at which the axial force of the gear acts", nominal=0.05, at_least=0.0)
    axial_share_a = Parameter("1", "share of the axial force that bearing a takes", at_least=0.0, at_most=1.0)

    def positions(self) -> dict[str, Num]:
        """Positions of the gears from bearing a, by key [m]."""
        return {"x": self.x}

    def relations(self) -> Iterator[Related]:
        """A gear sits between the bearings, or overhangs by no more than their distance."""
        for key, position in self.positions().items():
            yield require(self, "{key} fits span", position / self.span, -1.0, 2.0, key=key)

    def forces(self) -> tuple[list[tuple[Num, Num, Num, Num]], Num]:
        """Per gear: tangential and radial force [N], position [m], tilting moment [N.m]; and the axial force [N]."""
        mesh = self.mesh
        return [(mesh.F_t, -mesh.F_r, self.x, mesh.F_a * self.r)], mesh.F_a

    def equations(self) -> Iterator[Equation]:
        """Moments about bearing a give b, the rest is a's; each in two planes."""
        gears, F_a = self.forces()
        b = [sum(f[0] * f[2] for f in gears) / self.span, sum(f[1] * f[2] + f[3] for f in gears) / self.span]
        a = [sum(f[k] for f in gears) - b[k] for k in (0, 1)]
        F_axial = smooth_abs(F_a, FORCE_WIDTH)
        yield equation("bearing a radially", self.load_a.F_r, ca.sqrt(a[0] ** 2 + a[1] ** 2 + FORCE_WIDTH**2))
        yield equation("bearing b radially", self.load_b.F_r, ca.sqrt(b[0] ** 2 + b[1] ** 2 + FORCE_WIDTH**2))
        yield equation("bearing a axially", self.load_a.F_a, self.axial_share_a * F_axial)
        yield equation("bearing b axially", self.load_b.F_a, (1 - self.axial_share_a) * F_axial)


class TwoGearSupport(ShaftSupport):
    """Statics of an intermediate shaft: a driven wheel (`mesh`) and a driving pinion (`mesh_2`) of the same hand.

    The axial force of the wheel pushes towards bearing a, that of the pinion towards bearing b.
    """

    mesh_2 = ToothForce()

    x_2 = Parameter("m", "position of the second gear, from bearing a", nominal=0.1)
    r_2 = Parameter("m", "radius at which the axial force of the second gear acts", nominal=0.05, at_least=0.0)
    phi = Parameter("rad", "angle between the two lines of centres")

    def positions(self) -> dict[str, Num]:
        """Both gears."""
        return {"x": self.x, "x_2": self.x_2}

    def forces(self) -> tuple[list[tuple[Num, Num, Num, Num]], Num]:
        """The pinion's forces are turned into the wheel's planes; the axial forces oppose each other."""
        first, _ = super().forces()
        other, c, s = self.mesh_2, ca.cos(self.phi), ca.sin(self.phi)
        tangential, radial = -other.F_t * c - other.F_r * s, other.F_t * s - other.F_r * c
        second = (tangential, radial, self.x_2, -other.F_a * self.r_2 * c)
        return [*first, second], self.mesh.F_a - other.F_a
