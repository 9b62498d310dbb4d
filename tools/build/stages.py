"""Stages of a gear unit: what follows from their teeth, such as sizes and tooth forces."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from ...model.laws.worm import worm_base_friction, worm_mean_friction, worm_size_factor
from ...model.parts.gears import HelicalGearPair, InternalGearPair

#: Kinds of stages -> helix or spiral angle that is aimed at [rad], least and largest ratio of one stage.
KINDS = {"spur": 0.0, "helical": math.radians(14.0), "bevel": math.radians(35.0), "worm": 0.0, "planetary": 0.0}
LEAST = {"worm": 5.0, "planetary": 3.0}
MOST = {"spur": 8.0, "helical": 8.0, "bevel": 4.0, "worm": 100.0, "planetary": 10.0}
#: Material factor of the friction of a wheel of centrifugally cast bronze CuSn12Ni2 [1].
Y_W = 0.95
#: Number of planets.
PLANETS = 3
#: Drag coefficient of a planet, as a cylinder across a flow [1].
DRAG = 1.2
#: Radial length of a planet that dips, mean over a turn, over how far planets reach, where they dip by a third of that:
#: (acos(2/3) - 2/3 artanh(sqrt(5)/3)) / pi [1].
CROSSED = 0.0635
#: Efficiency of a stage with its bearings, for the load at the output [1].
STAGE = 0.985
#: Pressure angle [rad].
ALPHA = math.radians(20.0)

#: Tangential, radial and axial force [N].
Forces = tuple[float, float, float]


@dataclass(frozen=True)
class Stage:
    """A pair of gears; SI units, n in 1/s of the pinion, T its torque, x its place along the shafts."""

    kind: str
    z_1: int
    z_2: int
    m_n: float
    beta: float
    b: float
    T: float
    n: float
    x: float

    #: Wheels on the pinion.
    count: ClassVar[int] = 1
    #: Sense of rotation of what is driven, 1 for that of the pinion.
    turn: ClassVar[int] = -1
    #: Whether its shafts are beside each other.
    parallel: ClassVar[bool] = True

    @property
    def root(self) -> float:
        """Diameter that no seat on the pinion's shaft is above: that below its teeth."""
        return 2 * (self.r_1 - 1.25 * self.m_n)

    @property
    def u(self) -> float:
        """Ratio."""
        return self.z_2 / self.z_1

    @property
    def r_1(self) -> float:
        """Reference radius of the pinion, of bevel gears at mid face."""
        return self.m_n * self.z_1 / math.cos(self.beta) / 2

    @property
    def r_2(self) -> float:
        """Reference radius of the wheel."""
        return self.r_1 * self.u

    @property
    def a(self) -> float:
        """Centre distance."""
        return self.r_1 + self.r_2

    @property
    def along(self) -> float:
        """Length of the box that it takes."""
        return self.a

    @property
    def reach(self) -> float:
        """Radius of what moves the oil."""
        return self.r_2

    @property
    def speed(self) -> float:
        """Of what dips into the oil [m/s]: the pitch line, of a set of planets their reach."""
        return 2 * math.pi * self.n * self.r_1

    @property
    def intensity(self) -> float:
        """Load intensity F_t / (b d_1) (u + 1)/u [Pa]."""
        return self.T / (2 * self.b * self.r_1**2) * (self.u + 1) / self.u

    @property
    def swept(self) -> float:
        """Churning torque over half the oil's density and the square of the speed [m5], a torque coefficient of 1."""
        return self.b * self.reach**4

    @property
    def volume(self) -> float:
        """Of all gears, as full discs."""
        return math.pi * self.b * (self.r_1**2 + self.count * self.r_2**2)

    @property
    def inertia(self) -> float:
        """Of the gears seen at the pinion, over their density."""
        return math.pi / 2 * self.b * (self.r_1**4 + self.r_2**4 / self.u**2)

    @property
    def efficiency(self) -> float:
        """With its bearings."""
        return STAGE

    @property
    def forces(self) -> tuple[Forces, Forces]:
        """Tangential, radial and axial tooth force on pinion and wheel."""
        F_t = self.T / self.r_1
        found = F_t, F_t * math.tan(ALPHA) / math.cos(self.beta), F_t * math.tan(self.beta)
        return found, found


@dataclass(frozen=True)
class BevelStage(Stage):
    """Spiral bevel gears on shafts at a right angle, the spiral pushing the driving pinion away from the apex."""

    m_et: float

    parallel: ClassVar[bool] = False

    @property
    def root(self) -> float:
        """That at the pinion's outer end."""
        return self.m_et * (self.z_1 - 2.5)

    @property
    def delta_1(self) -> float:
        """Pitch angle of the pinion."""
        return math.atan2(1, self.u)

    @property
    def x_1(self) -> float:
        """Profile shift of the pinion."""
        return round(0.39 * (1 - 1 / self.u**2), 2)

    @property
    def d_e2(self) -> float:
        """Outer pitch diameter of the wheel."""
        return self.m_et * self.z_2

    @property
    def along(self) -> float:
        """How far the pinion is from the wheel's shaft at its outer end."""
        return self.d_e2 / 2

    @property
    def forces(self) -> tuple[Forces, Forces]:
        """As `BevelGearPair` has them."""
        F_t, tan, sin = self.T / self.r_1 / math.cos(self.beta), math.tan(ALPHA), math.sin(self.beta)
        c, s = math.cos(self.delta_1), math.sin(self.delta_1)
        out, across = F_t * (tan * s + sin * c), F_t * (tan * c - sin * s)
        return (self.T / self.r_1, across, out), (self.T / self.r_1, out, across)


@dataclass(frozen=True)
class WormStage(Stage):
    """A worm, as pinion, and its wheel; `m_n` is the axial module, `d_1` the mean diameter of the worm."""

    d_1: float

    parallel: ClassVar[bool] = False

    @property
    def root(self) -> float:
        """The mean one: threads run out into a shaft that is thicker than they are deep."""
        return self.d_1

    @property
    def r_1(self) -> float:
        """Mean radius of the worm."""
        return self.d_1 / 2

    @property
    def r_2(self) -> float:
        """Radius of the wheel."""
        return self.m_n * self.z_2 / 2

    @property
    def gamma(self) -> float:
        """Lead angle."""
        return math.atan(self.z_1 * self.m_n / self.d_1)

    @property
    def intensity(self) -> float:
        """The wheel's ideal torque over the cube of the centre distance [Pa]."""
        return self.T * self.u / self.a**3

    @property
    def mu(self) -> float:
        """Friction at the speed of the name plate, in mineral oil."""
        mu_0T = worm_base_friction(2 * math.pi * self.n * self.r_1 / math.cos(self.gamma), 1.0)
        return float(worm_mean_friction(mu_0T, worm_size_factor(self.a) * Y_W, ALPHA))

    @property
    def mesh(self) -> float:
        """Efficiency of the mesh."""
        cos, tan = math.cos(ALPHA), math.tan(self.gamma)
        return tan * (cos - self.mu * tan) / (cos * tan + self.mu)

    @property
    def efficiency(self) -> float:
        """With its bearings, which lose about what mesh and bearings of other stages do."""
        return STAGE * self.mesh

    @property
    def forces(self) -> tuple[Forces, Forces]:
        """What is tangential on one gear is axial on the other."""
        F_t1 = self.T / self.r_1
        F_t2 = self.T * self.mesh * self.u / self.r_2
        F_r = F_t2 * math.sin(ALPHA) / (math.cos(ALPHA) * math.cos(self.gamma) - self.mu * math.sin(self.gamma))
        return (F_t1, F_r, F_t2), (F_t2, F_r, F_t1)


@dataclass(frozen=True)
class PlanetaryStage(Stage):
    """Sun, three planets and a ring that is held; the sun drives the carrier. z_2 and r_2 are those of a planet."""

    z_3: int

    count: ClassVar[int] = PLANETS
    turn: ClassVar[int] = 1  # the carrier turns with the sun
    parallel: ClassVar[bool] = False

    @property
    def u(self) -> float:
        """Ratio of sun to carrier."""
        return 1 + self.z_3 / self.z_1

    @property
    def r_2(self) -> float:
        """Radius of a planet."""
        return self.m_n * self.z_2 / 2

    @property
    def along(self) -> float:
        """That of the planets' reach."""
        return self.reach

    @property
    def reach(self) -> float:
        """Of the planets round the axis."""
        return self.r_1 + 2 * self.r_2

    @property
    def speed(self) -> float:
        """Of the tips of the planets round the axis."""
        return 2 * math.pi * self.n / self.u * self.reach

    @property
    def swept(self) -> float:
        """Of planets that cross the bath with each turn of the carrier [m5]."""
        return self.count * DRAG * CROSSED * self.b * self.reach * self.a**3

    @property
    def inertia(self) -> float:
        """With planets that turn about their pins and go round with the carrier."""
        spin, orbit = self.z_1 / self.z_2 * (1 - 1 / self.u), self.a / self.u
        each = self.r_2**2 * (self.r_2**2 / 2 * spin**2 + orbit**2)
        return math.pi * self.b * (self.r_1**4 / 2 + self.count * each)

    @property
    def d_planet(self) -> float:
        """Mean diameter of the needles in a planet."""
        return self.r_2

    @property
    def ratios(self) -> dict[str, float]:
        """Contact ratios and tooth loss factors of the two kinds of meshes, as the pairs of gears have them."""
        size = {"m_n": self.m_n, "alpha_n": ALPHA, "beta": 0.0, "b": self.b, "a_w": self.a, "x_1": 0.0, "x_2": 0.0}
        size |= {"Ra": 1e-6, "k_mu": 1.0, "E": 2e11, "poisson": 0.3}
        outer = HelicalGearPair("sp", z_1=self.z_1, z_2=self.z_2, line_load="F_bn/l", **size).values
        inner = InternalGearPair("pr", z_1=self.z_2, z_2=self.z_3, line_load="F_bn/l", **size).values
        return {f"{key}_{mesh}": v[key] for mesh, v in (("sp", outer), ("pr", inner)) for key in ("eps_alpha", "H_v")}
