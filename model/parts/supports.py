"""Statics of shafts: what the tooth forces of gears make of the loads of two bearings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import ClassVar

import casadi as ca

from ..core.component import SOUND, Component, Equation, Faults, Related, equation
from ..core.declare import Choice, Parameter
from ..laws.preload import axial_load_set_against
from ..laws.smooth import Num, smooth_abs
from .bearings import CylindricalRollerThrustBearing, RollingBearing, ThrustBallBearing
from .friction import PlainBearing
from .ports import BearingLoad, OwnThrust, ToothForce
from .relations import require

#: Force below which the direction of a bearing load is blurred [N].
FORCE_WIDTH = 1.0
#: Bearings that carry no radial force.
THRUST = (ThrustBallBearing, CylindricalRollerThrustBearing)
#: The arrangement in which a bearing holds the shaft by itself, both ways.
LOCATED = "one locates"


class ShaftSupport(Component):
    """Statics of a shaft with one gear on two bearings a and b.

    A positive axial force pushes the gear towards bearing a: of a bevel gear, the apex is on the side of bearing b.
    Tapered roller and angular contact ball bearings are set against each other, face to face (X: bearing a carries what
    pushes towards a) or back to back (O: bearing b does). Each carries what the shaft and the other one's own thrust
    push against it; places are those of the pressure centres.
    """

    faults: ClassVar[Faults] = SOUND

    mesh = ToothForce()
    load_a = BearingLoad()
    load_b = BearingLoad()
    thrust_a = OwnThrust("how bearing a pushes the shaft along")
    thrust_b = OwnThrust("how bearing b pushes the shaft along")

    arrangement = Choice(
        (LOCATED, "face-to-face", "back-to-back"),
        "what holds the shaft: bearings both ways by themselves, or two set against each other, X or O",
        default=LOCATED,
    )
    span = Parameter("m", "distance of the bearings", nominal=0.1, above=0.0)
    x = Parameter("m", "position of the gear, from bearing a", nominal=0.1)
    r = Parameter("m", "radius at which the axial force of the gear acts", nominal=0.05, at_least=0.0)
    axial_share_a = Parameter("1", "share of the axial force that bearing a takes", at_least=0.0, at_most=1.0)

    def has(self, name: str) -> bool:
        """Thrusts count where bearings are set against each other, the share of the axial force elsewhere."""
        counts = {"thrust_a": False, "thrust_b": False, "axial_share_a": True}
        return counts.get(name, True) if self.arrangement == LOCATED else name != "axial_share_a"

    def clashes(self, met: Mapping[str, Sequence[Component]]) -> Iterator[str]:
        """Bearings that cannot hold the shaft as they are arranged."""
        for end, other in ("ab", "ba"):
            bearings = [part for part in met[f"load_{end}"] if isinstance(part, RollingBearing | PlainBearing)]
            names = ", ".join(f"{part.name} ({type(part).__name__})" for part in bearings)
            ways = max((part.holds() for part in bearings), default=2)
            if bearings and all(isinstance(part, THRUST) for part in bearings):
                yield (
                    f"{self.name} has bearing {end} carry radial force, and {names} carries none. Connect a radial "
                    f"bearing to {self.name}.load_{end}, beside it or in its place."
                )
            share = self.values.get("axial_share_a", 0.5)
            if ways == 0 and (share if end == "a" else 1 - share) > 0:
                yield (
                    f"{self.name} has bearing {end} carry axial force, and {names} holds no shaft along its axis. Let "
                    f"bearing {other} locate (axial_share_a = {int(end == 'b')}), or take one that holds it."
                )
            if ways == 1 and self.arrangement == LOCATED:
                yield (
                    f"{names} pushes the shaft along under a radial load, and nothing is set against it. Give "
                    f'{self.name} arrangement = "face-to-face" or "back-to-back", with thrust_a and thrust_b connected.'
                )
            if strange := [part.name for part in met.get(f"thrust_{end}", ()) if part not in bearings]:
                yield (
                    f"{self.name}.load_{end} loads {names}, and {self.name}.thrust_{end} is that of "
                    f"{', '.join(strange)}: thrusts that point the same way. Connect both ports to one bearing."
                )

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
        yield equation("bearing a radially", self.load_a.F_r, ca.sqrt(a[0] ** 2 + a[1] ** 2 + FORCE_WIDTH**2))
        yield equation("bearing b radially", self.load_b.F_r, ca.sqrt(b[0] ** 2 + b[1] ** 2 + FORCE_WIDTH**2))
        if self.arrangement == LOCATED:
            F_axial = smooth_abs(F_a, FORCE_WIDTH)
            on_a, on_b = self.axial_share_a * F_axial, (1 - self.axial_share_a) * F_axial
        else:
            K_a = F_a if self.arrangement == "face-to-face" else -F_a
            on_a, on_b = (
                axial_load_set_against(0.0, pushed) for pushed in (self.thrust_b.F + K_a, self.thrust_a.F - K_a)
            )
        yield equation("bearing a axially", self.load_a.F_a, on_a)
        yield equation("bearing b axially", self.load_b.F_a, on_b)


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
