"""Sizes of a gear unit from its name plate, by usual design rules: stages, shafts, bearings, housing.

Nothing here is measured or verified: the numbers are what a first draft would have, so that a rig runs before its
drawings are at hand. Every rule is told beside the number that it gives.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ..model.errors import ScenarioError
from ..model.units import si_of
from ..scenarios.entries import catalogue

#: Kinds of stages -> helix or spiral angle that is aimed at [rad], and the largest ratio of one stage; the least is 1.
KINDS = {"spur": 0.0, "helical": math.radians(14.0), "bevel": math.radians(35.0)}
LEAST, MOST = 1.0, {"spur": 8.0, "helical": 8.0, "bevel": 4.0}
#: Load intensity F_t / (b d_1) (u + 1)/u of case-hardened gears [Pa], face width over the pinion's diameter, and its
#: least number of teeth.
K_STAR, WIDTH, TEETH = 2.5e6, 0.8, 19
#: The same of case-hardened bevel gears [Pa] on their virtual gears, and face width over outer cone distance.
K_BEVEL, FACE = 2.0e6, 0.3
#: Teeth of a bevel pinion: largest ratio -> number.
BEVEL_TEETH = {1.5: 24, 2.5: 20, 3.5: 16, 4.0: 13}
#: Standard modules and centre distances (preferred numbers R 20) [mm].
MODULES = (0.5, 0.6, 0.8, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 16.0, 20.0)
R_20 = (1, 1.12, 1.25, 1.4, 1.6, 1.8, 2, 2.24, 2.5, 2.8, 3.15, 3.55, 4, 4.5, 5, 5.6, 6.3, 7.1, 8, 9)
CENTRES = tuple(m * 10**k for k in (1, 2) for m in R_20)
#: How far below the wanted centre distance a standard one may lie.
SHORT = 0.93
#: Pressure angle [rad], shear stress of shafts [Pa], wanted life of bearings [h].
ALPHA, SHEAR, LIFE = math.radians(20.0), 25e6, 20_000.0
#: From the middle of a bearing to a gear, and between gears [m].
SIDE, GAP = 0.020, 0.010
#: Distance of the bearings of a bevel pinion over how far its mid face overhangs.
OVERHANG = 2.5
#: Dynamic load ratings of the catalogue's deep groove ball bearings [N], from makers' tables, compared with no print.
RATINGS = {
    "SKF 6205": 14.8e3,
    "SKF 6206": 20.3e3,
    "SKF 6207": 27.0e3,
    "SKF 6208": 32.5e3,
    "SKF 6209": 35.1e3,
    "SKF 6210": 37.1e3,
    "SKF 6211": 46.2e3,
    "SKF 6212": 55.3e3,
    "SKF 6217": 87.1e3,
    "SKF 6305": 23.4e3,
    "SKF 6306": 29.6e3,
    "SKF 6308": 42.3e3,
    "SKF 6310": 65.0e3,
    "SKF 6312": 85.2e3,
}


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
        """Centre distance; of bevel gears how far the pinion reaches from the wheel's shaft."""
        return self.r_1 + self.r_2

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
    def a(self) -> float:
        """How far the pinion reaches from the wheel's shaft."""
        return self.d_e2 / 2

    @property
    def forces(self) -> tuple[Forces, Forces]:
        """As `BevelGearPair` has them."""
        F_t, tan, sin = self.T / self.r_1 / math.cos(self.beta), math.tan(ALPHA), math.sin(self.beta)
        c, s = math.cos(self.delta_1), math.sin(self.delta_1)
        out, across = F_t * (tan * s + sin * c), F_t * (tan * c - sin * s)
        return (self.T / self.r_1, across, out), (self.T / self.r_1, out, across)


@dataclass(frozen=True)
class Shaft:
    """A shaft: torque, speed [1/s], diameter, places of its gears and bearing b, both bearings with their lives [h]."""

    T: float
    n: float
    d: float
    places: tuple[float, ...]
    span: float
    bearings: tuple[str, str]
    lives: tuple[float, float]


@dataclass(frozen=True)
class Unit:
    """A gear unit: stages, shafts, and the box around them."""

    stages: tuple[Stage, ...]
    shafts: tuple[Shaft, ...]
    wall: float
    length: float
    width: float
    height: float

    @property
    def ratio(self) -> float:
        """Of all stages."""
        return math.prod(s.u for s in self.stages)

    @property
    def area(self) -> float:
        """Of the box."""
        return 2 * (self.length * self.width + self.length * self.height + self.width * self.height)


def unit(kinds: Sequence[str], ratio: float, power: float, speed: float) -> Unit:
    """A gear unit for a name plate.

    Args:
        kinds: of the stages, from the input on, keys of `KINDS`
        ratio: speed of the input over that of the output
        power: at the input [W]
        speed: of the input [rad/s]

    Raises:
        ScenarioError: unknown kinds, or more than so many stages of so much can do
    """
    _check(kinds, ratio, power, speed)
    T, n, x = power / speed, speed / (2 * math.pi), SIDE
    found: list[Stage] = []
    left = ratio
    for k, kind in enumerate(kinds):
        make = _bevel if kind == "bevel" else _cylindrical
        made = make(kind, _share(left, kinds[k:]), T, n, x)
        found.append(made)
        T, n, x, left = T * made.u, n / made.u, x + made.b + GAP, left / made.u
    span = x - GAP + SIDE
    shafts = tuple(_shaft(found, k, span) for k in range(len(found) + 1))
    wall = max(0.008, 0.025 * found[-1].a + 0.003)
    tips = [(s.r_1 + s.m_n, s.r_2 + s.m_n) for s in found]
    ahead = shafts[0].span if isinstance(found[0], BevelStage) else tips[0][0]
    return Unit(
        tuple(found),
        shafts,
        wall,
        length=sum(s.a for s in found) + ahead + tips[-1][1] + 0.040 + 2 * wall,
        width=span + 0.090,
        height=2 * max(max(pair) for pair in tips) + 0.080 + 2 * wall,
    )


def _check(kinds: Sequence[str], ratio: float, power: float, speed: float) -> None:
    problems = [f'there is no stage "{k}". Stages: {", ".join(KINDS)}.' for k in kinds if k not in KINDS]
    if not kinds:
        problems.append("no stage is given. Name them from the input on, for example helical,helical.")
    if "bevel" in kinds[1:]:
        problems.append("a bevel stage comes first: here its pinion is on the input shaft.")
    if not (power > 0 and speed > 0):
        problems.append("power and speed must be above 0.")
    most = math.prod(MOST.get(kind, MOST["helical"]) for kind in kinds) ** (1 / max(len(kinds), 1))
    if kinds and not LEAST <= ratio ** (1 / len(kinds)) <= most:
        needed = max(1, math.ceil(math.log(max(ratio, 1.01)) / math.log(most)))
        problems.append(
            f"a ratio of {ratio:g} in {len(kinds)} stages is {ratio ** (1 / len(kinds)):.3g} each, expected {LEAST:g}"
            f" to {most:.3g}. Give {needed} stages or more."
        )
    if problems:
        raise ScenarioError(problems)


def _share(ratio: float, kinds: Sequence[str]) -> float:
    """Ratio of the next stage: the first ones have more, so that all wheels are of like size."""
    stages = len(kinds)
    share = {1: ratio, 2: 0.8 * ratio ** (2 / 3), 3: 0.6 * ratio ** (4 / 7)}.get(stages, ratio ** (1 / stages))
    low, high = ratio / math.prod(MOST[kind] for kind in kinds[1:]), ratio / LEAST ** (stages - 1)
    return float(min(max(share, low, LEAST), high, MOST[kinds[0]]))


def _cylindrical(kind: str, u: float, T: float, n: float, x: float) -> Stage:
    """Gears for a torque at the pinion, by load intensity; whole teeth without a common factor."""
    d_1 = (2 * T * (u + 1) / (u * K_STAR * WIDTH)) ** (1 / 3)
    wanted = 1000 * d_1 * (1 + u) / 2
    a = min((c for c in CENTRES if c >= SHORT * wanted), default=0.0) / 1000
    if not a:
        raise ScenarioError(f"a stage for {T:g} N.m at its pinion needs {wanted:.0f} mm between its shafts, too much.")
    d_1 = 2 * a / (1 + u)
    aim = KINDS[kind]
    m_n = max((m for m in MODULES if m <= 1000 * d_1 * math.cos(aim) / TEETH), default=MODULES[0]) / 1000
    teeth = round(2 * a * math.cos(aim) / m_n)
    near = round(teeth / (1 + u))
    z_1 = min(range(max(8, near - 2), near + 3), key=lambda z: _fault(z, teeth - z, u))
    if aim:
        while teeth * m_n >= 2 * a:
            teeth -= 1
    beta = math.acos(teeth * m_n / (2 * a)) if aim else 0.0
    b = round(1000 * WIDTH * m_n * z_1 / math.cos(beta)) / 1000
    return Stage(kind, z_1, teeth - z_1, m_n, beta, b, T, n, x + b / 2)


def _bevel(kind: str, u: float, T: float, n: float, x: float) -> BevelStage:
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


def _fault(z_1: int, z_2: int, u: float) -> float:
    """How bad numbers of teeth are: off the ratio, or with a common factor."""
    return abs(z_2 / z_1 / u - 1) + 0.02 * (math.gcd(z_1, z_2) > 1)


def _shaft(stages: Sequence[Stage], k: int, span: float) -> Shaft:
    """The shaft behind k stages: its diameter by torsion, its bearings by bore and life."""
    before, behind = stages[k - 1 : k] if k else (), stages[k : k + 1]
    T = behind[0].T if behind else before[0].T * before[0].u
    n = behind[0].n if behind else before[0].n / before[0].u
    d = (16 * T / (math.pi * SHEAR)) ** (1 / 3)
    gears = [(s.forces[1], s.x, s.r_2) for s in before] + [(s.forces[0], s.x, s.r_1) for s in behind]
    if k == 0 and isinstance(stages[0], BevelStage):  # the pinion overhangs bearing b, where the apex is
        beyond = SIDE + stages[0].b / 2
        span = OVERHANG * beyond
        gears = [(stages[0].forces[0], span + beyond, stages[0].r_1)]
    axial = abs(sum((1 if i else -1) * F[2] for i, (F, _, _) in enumerate(gears)))
    planes = [(F[0], (1 if i else -1) * F[1], x, F[2] * r) for i, (F, x, r) in enumerate(gears)]
    far = [sum(p[0] * p[2] for p in planes) / span, sum(p[1] * p[2] + p[3] for p in planes) / span]
    near = [sum(p[i] for p in planes) - far[i] for i in (0, 1)]
    chosen = [_bearing(d, math.hypot(*F), F_a, n) for F, F_a in ((near, axial), (far, 0.0))]
    bore = max(si_of(catalogue("bearing")[name].values["d"]) for name, _ in chosen)
    (a, life_a), (b, life_b) = chosen
    return Shaft(T, n, bore, tuple(x for _, x, _ in gears), span, (a, b), (life_a, life_b))


def _bearing(d: float, F_r: float, F_a: float, n: float) -> tuple[str, float]:
    """The smallest bearing of the catalogue with a bore and the wanted life, else the strongest; and its life [h]."""
    P = max(F_r, 0.56 * F_r + 1.6 * F_a)
    sizes = {name: [si_of(catalogue("bearing")[name].values[key]) for key in ("D", "d")] for name in RATINGS}
    fitting = [name for name in RATINGS if sizes[name][1] >= 0.999 * d]
    if not fitting:
        raise ScenarioError(f"a shaft of {1000 * d:.0f} mm: no ball bearing of the catalogue has such a bore.")
    lives = {name: 1e6 / (3600 * n) * (RATINGS[name] / P) ** 3 for name in fitting}
    lasting = [name for name in fitting if lives[name] >= LIFE]
    name = min(lasting, key=sizes.__getitem__) if lasting else max(fitting, key=lives.__getitem__)
    return name, lives[name]
