"""Stages of a gear unit, by usual design rules: numbers of teeth, modules, widths and tooth forces."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import ClassVar

from ...model.errors import ScenarioError
from ...model.laws.worm import worm_base_friction, worm_mean_friction, worm_size_factor
from ...model.parts.gears import HelicalGearPair, InternalGearPair

#: Kinds of stages -> helix or spiral angle that is aimed at [rad], least and largest ratio of one stage.
KINDS = {"spur": 0.0, "helical": math.radians(14.0), "bevel": math.radians(35.0), "worm": 0.0, "planetary": 0.0}
LEAST = {"worm": 7.0, "planetary": 3.0}
MOST = {"spur": 8.0, "helical": 8.0, "bevel": 4.0, "worm": 60.0, "planetary": 10.0}
#: Load intensity F_t / (b d_1) (u + 1)/u of case-hardened gears [Pa].
K_STAR = 2.5e6
#: Face width over the pinion's diameter [1].
WIDTH = 0.8
#: Least number of teeth of a pinion.
TEETH = 19
#: Of one for a load that hardly needs gears at all; fewer are undercut without profile shift.
FEWEST = 9
#: Load intensity of case-hardened bevel gears on their virtual gears [Pa].
K_BEVEL = 2.0e6
#: Face width of bevel gears over the outer cone distance [1].
FACE = 0.3
#: Teeth of a bevel pinion: largest ratio -> number.
BEVEL_TEETH = {1.5: 24, 2.5: 20, 3.5: 16, 4.0: 13}
#: Torque of a worm wheel over the cube of the centre distance, as makers rate units of bronze and steel [Pa].
T_WORM = 5.5e5
#: Largest ratio -> starts of a worm.
STARTS = {10.0: 4, 28.0: 2, 60.0: 1}
#: Mean diameter of a worm over the centre distance [1].
SLIM = 0.4
#: Material factor of the friction of a wheel of centrifugally cast bronze CuSn12Ni2 [1].
Y_W = 0.95
#: Number of planets.
PLANETS = 3
#: Drag coefficient of a planet, as a cylinder across a flow [1].
DRAG = 1.2
#: Radial length of a planet that dips, mean over a turn, over how far planets reach, where they dip by a third of that:
#: (acos(2/3) - 2/3 artanh(sqrt(5)/3)) / pi [1].
CROSSED = 0.0635
#: Numbers of teeth of suns to choose from.
SUNS = range(18, 61)
#: Least number of teeth of a planet.
LEAST_PLANET = 24
#: Standard modules and centre distances (preferred numbers R 20) [mm].
MODULES = (0.5, 0.6, 0.8, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 16.0, 20.0, 25.0, 32.0)
R_20 = (1, 1.12, 1.25, 1.4, 1.6, 1.8, 2, 2.24, 2.5, 2.8, 3.15, 3.55, 4, 4.5, 5, 5.6, 6.3, 7.1, 8, 9)
CENTRES = tuple(m * 10**k for k in (1, 2, 3) for m in R_20)
#: Centre distance at which the smallest bearings have room beside each other [mm].
ROOMY = 33.0
#: How far below the wanted centre distance a standard one may lie.
SHORT = 0.93
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


def _cylindrical(kind: str, u: float, T: float, n: float, x: float, a: float | None = None) -> Stage:
    """Gears for a torque at the pinion, by load intensity; whole teeth without a common factor."""
    d_1, aim = (2 * T * (u + 1) / (u * K_STAR * WIDTH)) ** (1 / 3), KINDS[kind]
    least = FEWEST * MODULES[0] / 1000 / math.cos(aim) * (1 + u) / 2
    if a is not None and a < least:
        said = f"{1000 * a:g} mm holds no gears of {MODULES[0]:g} mm modules with a ratio of {u:.3g}"
        raise ScenarioError(f"--centre-distance of {said}. Give {1000 * least:.3g} mm or more.")
    a = a or _standard(max(d_1 * (1 + u) / 2, least / SHORT, ROOMY / 1000 / SHORT))
    d_1 = 2 * a / (1 + u)
    m_n = max((m for m in MODULES if m <= 1000 * d_1 * math.cos(aim) / TEETH), default=MODULES[0]) / 1000
    teeth = round(2 * a * math.cos(aim) / m_n)
    near = round(teeth / (1 + u))
    z_1 = min(range(max(FEWEST, near - 2), near + 3), key=lambda z: _fault(z, teeth - z, u))
    if aim:
        while teeth * m_n >= 2 * a:
            teeth -= 1
    beta = math.acos(teeth * m_n / (2 * a)) if aim else 0.0
    b = round(1000 * WIDTH * m_n * z_1 / math.cos(beta)) / 1000
    return Stage(kind, z_1, teeth - z_1, m_n, beta, b, T, n, x + b / 2)


def _bevel(kind: str, u: float, T: float, n: float, x: float, a: float | None = None) -> BevelStage:
    """Bevel gears by the load intensity of their virtual gears at mid face; outer diameter in steps of 5 mm."""
    slim = FACE / (1 - FACE / 2) / 2  # face width over mean diameter of the pinion and sqrt(u^2 + 1)
    d_m = (2 * T / (slim * u * K_BEVEL)) ** (1 / 3)
    z_1 = next(z for most, z in BEVEL_TEETH.items() if u <= most + 1e-9)
    z_2 = min(range(round(u * z_1) - 1, round(u * z_1) + 2), key=lambda z: _fault(z_1, z, u))
    sin_1, sin_2 = (z / math.hypot(z_1, z_2) for z in (z_1, z_2))
    d_e = 0.005 * math.ceil(d_m * z_2 / z_1 / (1 - FACE / 2) / 0.005)
    b = math.floor(1000 * FACE * d_e / 2 / sin_2) / 1000
    m_et, beta = round(1e6 * d_e / z_2) / 1e6, KINDS[kind]
    m_n = (m_et - b * sin_1 / z_1) * math.cos(beta)
    return BevelStage(kind, z_1, z_2, m_n, beta, b, T, n, x + b / 2, m_et)


def _worm(kind: str, u: float, T: float, n: float, x: float, a: float | None = None) -> WormStage:
    """A worm and its wheel by the torque that makers rate a centre distance for."""
    z_1 = next(z for most, z in STARTS.items() if u <= most + 1e-9)
    z_2 = round(u * z_1)
    a = a or _standard((T * u / T_WORM) ** (1 / 3))
    m_x = round(2e4 * (2 - SLIM) * a / z_2) / 2e4  # in steps of 0.05 mm
    d_1 = 2 * a - m_x * z_2
    b = round(750 * d_1) / 1000
    return WormStage(kind, z_1, z_2, m_x, KINDS[kind], b, T, n, x + b / 2, d_1)


def _standard(a: float) -> float:
    """The standard centre distance for the one that is wanted [m]."""
    return min(c for c in CENTRES if c >= SHORT * 1000 * a) / 1000


def _fault(z_1: int, z_2: int, u: float) -> float:
    """How bad numbers of teeth are: off the ratio, or with a common factor."""
    return abs(z_2 / z_1 / u - 1) + 0.02 * (math.gcd(z_1, z_2) > 1)


def _planetary(kind: str, u: float, T: float, n: float, x: float, a: float | None = None) -> PlanetaryStage:
    """A sun of the next standard module, by the load intensity of sun and planet; planets at equal angles."""
    part = max(u / 2 - 1, 0.5)
    d_1 = (2 * T / PLANETS * (part + 1) / (part * K_STAR * WIDTH)) ** (1 / 3)
    sizes = [(z, z_3) for z in SUNS for z_3 in range(z + 2 * LEAST_PLANET, 12 * z, 1) if _fits(z, z_3)]
    z_1, z_3 = min(sizes, key=lambda size: (round(abs(1 + size[1] / size[0] - u) / u, 2), size[0]))
    m_n = next(m for m in MODULES if m * z_1 >= 1000 * d_1) / 1000
    b = max(round(1000 * min(WIDTH * m_n * z_1, WIDTH * d_1**3 / (m_n * z_1) ** 2)), 1) / 1000
    return PlanetaryStage(kind, z_1, (z_3 - z_1) // 2, m_n, 0.0, b, T, n, x + b / 2, z_3)


def _fits(z_1: int, z_3: int) -> bool:
    """Whether whole planets stand at equal angles."""
    return (z_3 - z_1) % 2 == 0 and (z_1 + z_3) % PLANETS == 0


#: Who makes a stage of a kind.
MAKE: Mapping[str, Callable[[str, float, float, float, float, float | None], Stage]] = {
    "spur": _cylindrical,
    "helical": _cylindrical,
    "bevel": _bevel,
    "worm": _worm,
    "planetary": _planetary,
}
