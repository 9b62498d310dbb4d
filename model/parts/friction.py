"""Whatever brakes a shaft: its power becomes heat in the two bodies it rubs between. Seals and plain bearings."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import ClassVar

from ..core.component import Component, Equation, equation
from ..core.declare import Choice, Output, Parameter
from ..laws.convection import R_AIR, SEA_LEVEL, air_properties
from ..laws.gap_seal import gap_torque
from ..laws.iso14179_1 import seal_torque
from ..laws.journal import film_torque, petrov_torque, solid_share
from ..laws.sealing import lip_conductance, lip_seal_torque, oil_seal_torque
from ..laws.smooth import Num, friction_sign, smooth_magnitude
from .ports import BearingLoad, Flange, HeatPort, Lubricant


class Friction(Component):
    """Base of bearings, seals and churning: a torque against the rotation, its heat shared by two bodies."""

    scale: ClassVar[tuple[str, ...]] = ("k_loss",)

    shaft = Flange(must_meet=True)
    inner = HeatPort()
    outer = HeatPort()

    count = Parameter("1", "number of equal pieces", above=0.0, whole=True)
    k_loss = Parameter("1", "factor on the friction torque, 1 for the law as it is", default=1.0, at_least=0.0)
    inner_share = Parameter("1", "share of the heat that goes to the inner body", at_least=0.0, at_most=1.0)
    tau_loss = Output("N.m", "friction torque of all pieces", nominal=1.0, at_least=0.0, guess=0.0)
    P_loss = Output("W", "friction power of all pieces", nominal=100.0, at_least=0.0)

    def torque(self) -> Num:
        """Friction torque of one piece [N.m], not negative."""
        raise AttributeError(f"{type(self).__name__} has no friction torque")

    def equations(self) -> Iterator[Equation]:
        """All friction becomes heat."""
        w = self.shaft.w
        yield equation("friction torque", self.tau_loss, self.count * self.k_loss * self.torque())
        yield equation("friction opposes rotation", self.shaft.tau, self.tau_loss * friction_sign(w))
        yield equation("friction power", self.P_loss, self.shaft.tau * w)
        yield equation("heat to the inner body", self.inner.Q_flow, -self.inner_share * self.P_loss)
        yield equation("heat to the outer body", self.outer.Q_flow, -(1 - self.inner_share) * self.P_loss)


#: Diameter under a seal over the bores of the bearings on its shaft: beyond, one of them has another unit [1].
SEAT = (0.2, 4.0)


class RadialSeal(Friction):
    """Base of radial lip seals: on a shaft that its bearings hold, too."""

    d_sh = Parameter("m", "diameter of the shaft under the lip", nominal=0.1, above=0.0)

    def clashes(self, met: Mapping[str, Sequence[Component]]) -> Iterator[str]:
        """A seat that is not of the size of the bearings' bores."""
        held = [part for part in met["shaft"] if part.role == "bearing" and "d" in part.values]
        bores = {part.name: part.values["d"] for part in held}
        d_sh = self.values["d_sh"]
        if bores and not SEAT[0] * min(bores.values()) <= d_sh <= SEAT[1] * max(bores.values()):
            name = max(bores, key=lambda bearing: bores[bearing])
            yield (
                f"{self.name} is on a shaft of d_sh = {1000 * d_sh:.4g} mm, and {name} on the same one has a bore of"
                f" {1000 * bores[name]:.4g} mm. Give {self.name} its own d_sh, or {name} its own bearing."
            )


class LipSeal(RadialSeal):
    """Radial lip seal: a torque that depends on the shaft's diameter alone.

    Laws for lip seals differ by more than three times at large shafts. Recommended is "square": the force of the lip on
    its circumference is the same at all sizes. From 33 mm on it lies between "linear", that of ISO/TR 14179-1 for
    nitrile rubber, and `OilLipSeal`, that of ISO/TR 14179-2.
    """

    role: ClassVar[str] = "seal"

    law = Choice(("square", "linear"), "how the torque grows with the diameter", default="square")
    c_sh = Parameter("N/m", "friction torque per square of the diameter, with square", nominal=50.0, at_least=0.0)
    c_d = Parameter("N", "friction torque per diameter, with linear: 2.429 N for nitrile rubber", at_least=0.0)

    def has(self, name: str) -> bool:
        """Each law has its constant."""
        return name != ("c_sh" if self.choices["law"] == "linear" else "c_d")

    def torque(self) -> Num:
        """Friction torque of one seal [N.m]."""
        return seal_torque(self.d_sh, self.c_d) if self.law == "linear" else lip_seal_torque(self.d_sh, self.c_sh)

    @classmethod
    def spread(cls) -> Iterable[Mapping[str, str]]:
        """Torques of one seal in oil of ISO VG 220 at 60 degC."""
        laws: Mapping[str, Callable[[float], Num]] = {
            'LipSeal, law = "square" (recommended)': lip_seal_torque,
            'LipSeal, law = "linear"': seal_torque,
            "OilLipSeal": lambda d: oil_seal_torque(333.15, 220e-6, d),
        }
        for name, torque in laws.items():
            yield {"law": name} | {f"{d} mm [N.m]": f"{float(torque(d / 1000)):.3g}" for d in (30, 55, 100)}


class OilLipSeal(RadialSeal):
    """Radial lip seal whose torque falls as its oil warms, and is higher in thicker oil.

    Its source takes the oil of the housing. With `warms = "lip"` it rubs at the temperature of its lip, which its own
    friction raises above that oil: the shaft carries the heat off as a fin does, from the other side of the seal none.
    """

    role: ClassVar[str] = "seal"

    lubricant = Lubricant()

    warms = Choice(("oil", "lip"), "whose temperature says how it rubs", default="oil")
    h = Parameter("W/(m2.K)", "heat transfer coefficient between shaft and oil", nominal=500.0, above=0.0)
    k = Parameter("W/(m.K)", "conductivity of the shaft", nominal=45.0, above=0.0)
    T_lip = Output("K", "temperature at which it rubs", nominal=350.0)
    nu_40 = Parameter("m2/s", "kinematic viscosity of the oil at 40 degC", nominal=1e-4, above=1e-6)

    def torque(self) -> Num:
        """Friction torque of one seal [N.m]."""
        return oil_seal_torque(self.T_lip, self.nu_40, self.d_sh)

    def has(self, name: str) -> bool:
        """What the shaft carries off counts where the lip is warmer than the oil."""
        return self.choices["warms"] == "lip" or name not in ("h", "k")

    def equations(self) -> Iterator[Equation]:
        """The temperature of the lip, then what every friction does."""
        rise = 0.0
        if self.warms == "lip":
            rise = self.P_loss / self.count / lip_conductance(self.d_sh, self.h, self.k)
        yield equation("temperature of the lip", self.T_lip, self.lubricant.T + rise)
        yield from super().equations()

    @classmethod
    def spread(cls) -> Iterable[Mapping[str, str]]:
        """Beside those of a lip seal."""
        return LipSeal.spread()


class LabyrinthSeal(Friction):
    """Seal that does not touch its shaft: air shears in its gaps, and oil where they stand full.

    Nothing leaks and no air flows through: neither oil nor heat leaves by the gaps.
    """

    role: ClassVar[str] = "seal"

    lubricant = Lubricant()

    d = Parameter("m", "diameter of the shaft in the gaps", nominal=0.1, above=0.0)
    gap = Parameter("m", "radial clearance of the gaps", nominal=3e-4, above=0.0)
    L = Parameter("m", "length of all gaps along the shaft", nominal=0.03, above=0.0)
    oil_share = Parameter("1", "share of this length that stands full of oil", default=0.0, at_least=0.0, at_most=1.0)

    def torque(self) -> Num:
        """Drag of the gaps of one seal [N.m]; the air is as warm as the outer body."""
        w, oil, r, gap = self.shaft.w, self.lubricant, self.d / 2, self.gap
        T = self.outer.T
        _, nu_air, _, _ = air_properties(T)
        air = gap_torque(w, SEA_LEVEL / (R_AIR * T), nu_air, r, gap, (1 - self.oil_share) * self.L)
        return air + gap_torque(w, oil.rho, oil.nu, r, gap, self.oil_share * self.L)


class PlainBearing(Friction):
    """Plain journal bearing full of oil: a film under load, mixed friction below its transition speed.

    The film has the temperature of the lubricant: in a fast bearing it is warmer, and its friction less.
    """

    role: ClassVar[str] = "bearing"

    load = BearingLoad()
    lubricant = Lubricant()

    r = Parameter("m", "radius of the journal", nominal=0.03, above=0.0)
    b = Parameter("m", "width of the bearing", nominal=0.05, above=0.0)
    psi = Parameter(
        "1", "relative clearance: of the diameters, over that of the journal", nominal=1e-3, above=0.0, below=0.1
    )
    F_r_0 = Parameter("N", "radial load of its own, e.g. a coupling", nominal=1000.0, at_least=0.0)
    mu_bl = Parameter("1", "friction of the solids in contact", nominal=0.1, at_least=0.0, at_most=1.0)
    C_trans = Parameter("1", "transition constant: 1 for a good surface, more for a better one", above=0.0)
    solid = Output("1", "share of the load that solids carry", nominal=0.1)

    def holds(self) -> int:
        """It carries no axial load."""
        return 0

    def torque(self) -> Num:
        """Friction of film and solids of one bearing [N.m]."""
        w, F_r = self.shaft.w, self.F_r_0 + self.load.F_r
        eta_oil = self.lubricant.nu * self.lubricant.rho
        size = self.r, self.b, self.psi
        film = film_torque(petrov_torque(w, eta_oil, *size), F_r, w, eta_oil, *size)
        return film + self.solid * self.mu_bl * smooth_magnitude(F_r, 1.0) * self.r

    def equations(self) -> Iterator[Equation]:
        """The share of solids, then what every friction does."""
        oil, F_r = self.lubricant, self.F_r_0 + self.load.F_r
        share = solid_share(self.shaft.w, F_r, oil.nu * oil.rho, self.r, self.b, self.C_trans)
        yield equation("solids in contact", self.solid, share)
        yield from super().equations()
