"""Numbers of teeth, modules and widths of the stages of a gear unit, for a ratio and a torque."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

from ...model.errors import ScenarioError
from .stages import KINDS, PLANETS, BevelStage, PlanetaryStage, Stage, WormStage

#: Load intensity F_t / (b d_1) (u + 1)/u of case-hardened gears [Pa].
K_STAR = 4.0e6
#: That of sun and planet [Pa] where the carrier has 1 kN.m: fitted to masses of planetary units of 80 N.m to 110 kN.m,
K_SUN = 3.5e6
#: as is the power of its torque by which makers load larger ones more.
GROWS = 0.15
#: Face width over the pinion's diameter [1].
WIDTH = 0.8
#: That of a sun at least, which a small load would have narrower [1].
NARROW = 0.35
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
STARTS = {6.5: 6, 10.0: 4, 28.0: 2, 100.0: 1}
#: Mean diameter of a worm over the centre distance [1].
SLIM = 0.4
#: Numbers of teeth of suns to choose from, and the most that is usual: the roots of more are thin for such loads.
SUNS = range(18, 61)
USUAL = 30
#: Least number of teeth of a planet.
LEAST_PLANET = 24
#: Standard modules and centre distances (preferred numbers R 20) [mm].
MODULES = (0.5, 0.6, 0.8, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 16.0, 20.0, 25.0, 32.0)
R_20 = (1, 1.12, 1.25, 1.4, 1.6, 1.8, 2, 2.24, 2.5, 2.8, 3.15, 3.55, 4, 4.5, 5, 5.6, 6.3, 7.1, 8, 9)
CENTRES = tuple(m * 10**k for k in (1, 2, 3) for m in R_20)
#: Usual helix angles [rad].
HELIX = (math.radians(8.0), math.radians(20.0))
#: How close to a ratio is close enough for a stage [1]: to torques at both ends, one that is off is a loss.
CLOSE = 0.0005
#: How far below the wanted centre distance a standard one may lie.
SHORT = 0.93


def _cylindrical(kind: str, u: float, T: float, n: float, a: float | None = None) -> Stage:
    """Gears for a torque at the pinion, by load intensity; whole teeth without a common factor."""
    d_1, aim = (2 * T * (u + 1) / (u * K_STAR * WIDTH)) ** (1 / 3), KINDS[kind]
    least = FEWEST * MODULES[0] / 1000 / math.cos(aim) * (1 + u) / 2
    if a is not None and a < least:
        said = f"{1000 * a:g} mm holds no gears of {MODULES[0]:g} mm modules with a ratio of {u:.3g}"
        raise ScenarioError(f"--centre-distance of {said}. Give {1000 * least:.3g} mm or more.")
    a = a or _standard(max(d_1 * (1 + u) / 2, least / SHORT))
    d_1 = 2 * a / (1 + u)
    fitting = [m / 1000 for m in MODULES if m <= 1000 * d_1 * math.cos(aim) / TEETH] or [MODULES[0] / 1000]
    m_n, z_1, z_2 = _numbers(u, [(m, total) for m in fitting[:-4:-1] for total in _sums(a, m, aim)])
    beta = math.acos((z_1 + z_2) * m_n / (2 * a)) if aim else 0.0
    b = round(1000 * WIDTH * m_n * z_1 / math.cos(beta)) / 1000
    return Stage(kind, z_1, z_2, m_n, beta, b, T, n, 0.0)


def _sums(a: float, m_n: float, aim: float) -> list[int]:
    """Sums of teeth that a centre distance holds by usual helix angles, or nearly by straight teeth; the best first."""
    wanted, sums = 2 * a * math.cos(aim) / m_n, [round(2 * a / m_n) + k for k in range(-2, 3)]
    if aim:
        least, most = (2 * a * math.cos(angle) / m_n for angle in HELIX[::-1])
        sums = list(range(math.ceil(least), math.floor(most) + 1)) or [math.ceil(2 * a / m_n) - 1]
    return sorted(sums, key=lambda total: abs(total - wanted))


def _numbers(u: float, sums: Sequence[tuple[float, int]]) -> tuple[float, int, int]:
    """Module, teeth of pinion and wheel: of the first module and sum that come close enough to the ratio."""
    found = []
    for rank, (m_n, total) in enumerate(sums):
        near = round(total / (1 + u))
        found += [(rank, m_n, z, total - z) for z in range(max(FEWEST, near - 2), near + 3)]
    return _first_close(u, found)


def _first_close(u: float, found: Sequence[tuple[int, float, int, int]]) -> tuple[float, int, int]:
    """Of ranks, modules and numbers of teeth: the first that come close enough, without a common factor if they can."""
    best = min(found, key=lambda one: (max(_off(one[2], one[3], u), CLOSE), one[0], _fault(one[2], one[3], u)))
    return best[1:]


def _bevel(kind: str, u: float, T: float, n: float, a: float | None = None) -> BevelStage:
    """Bevel gears by the load intensity of their virtual gears at mid face; outer diameter in steps of 5 mm."""
    slim = FACE / (1 - FACE / 2) / 2  # face width over mean diameter of the pinion and sqrt(u^2 + 1)
    d_m = (2 * T / (slim * u * K_BEVEL)) ** (1 / 3)
    usual = next(z for most, z in BEVEL_TEETH.items() if u <= most + 1e-9)
    tried = [(abs(k), 0.0, usual + k, round(u * (usual + k)) + j) for k in (0, 1, -1, 2, -2) for j in (-1, 0, 1)]
    _, z_1, z_2 = _first_close(u, tried)
    sin_1, sin_2 = (z / math.hypot(z_1, z_2) for z in (z_1, z_2))
    d_e = 0.005 * math.ceil(d_m * z_2 / z_1 / (1 - FACE / 2) / 0.005)
    b = math.floor(1000 * FACE * d_e / 2 / sin_2) / 1000
    m_et, beta = round(1e6 * d_e / z_2) / 1e6, KINDS[kind]
    m_n = (m_et - b * sin_1 / z_1) * math.cos(beta)
    return BevelStage(kind, z_1, z_2, m_n, beta, b, T, n, 0.0, m_et)


def _worm(kind: str, u: float, T: float, n: float, a: float | None = None) -> WormStage:
    """A worm and its wheel by the torque that makers rate a centre distance for."""
    z_1 = next(z for most, z in STARTS.items() if u <= most + 1e-9)
    z_2 = round(u * z_1)
    a = a or _standard((T * u / T_WORM) ** (1 / 3))
    m_x = round(2e4 * (2 - SLIM) * a / z_2) / 2e4  # in steps of 0.05 mm
    d_1 = 2 * a - m_x * z_2
    b = round(750 * d_1) / 1000
    return WormStage(kind, z_1, z_2, m_x, KINDS[kind], b, T, n, 0.0, d_1)


def _standard(a: float) -> float:
    """The standard centre distance for the one that is wanted [m]."""
    return min(c for c in CENTRES if c >= SHORT * 1000 * a) / 1000


def larger(a: float) -> float:
    """The next standard centre distance [m]."""
    return _standard(1.01 * a / SHORT)


def _fault(z_1: int, z_2: int, u: float) -> float:
    """How bad numbers of teeth are: off the ratio, or with a common factor."""
    return _off(z_1, z_2, u) + 0.02 * (math.gcd(z_1, z_2) > 1)


def _off(z_1: int, z_2: int, u: float) -> float:
    """How far the ratio of numbers of teeth is from that which is wanted."""
    return abs(z_2 / z_1 / u - 1)


def _planetary(kind: str, u: float, T: float, n: float, a: float | None = None) -> PlanetaryStage:
    """The smallest sun of standard modules for the load intensity of sun and planet; planets at equal angles."""
    part, load = max(u / 2 - 1, 0.5), load_of_sun(T * u)
    d_1 = (2 * T / PLANETS * (part + 1) / (part * load * WIDTH)) ** (1 / 3)
    module = {z: next(m for m in MODULES if m * z >= 1000 * d_1) / 1000 for z in SUNS}
    sizes = [(z, z_3) for z in SUNS for z_3 in range(z + 2 * LEAST_PLANET, 12 * z) if _fits(z, z_3)]

    def merit(size: tuple[int, int]) -> tuple[float, ...]:
        z_1, z_3 = size
        return max(_off(z_1, z_1 + z_3, u), CLOSE), max(z_1, USUAL), module[z_1] * z_1, z_1

    z_1, z_3 = min(sizes, key=merit)
    m_n = module[z_1]
    b = round(1000 * max(WIDTH * d_1**3 / (m_n * z_1) ** 2, NARROW * m_n * z_1)) / 1000
    return PlanetaryStage(kind, z_1, (z_3 - z_1) // 2, m_n, 0.0, b, T, n, 0.0, z_3)


def load_of_sun(T: float) -> float:
    """Load intensity of sun and planet [Pa] where the carrier has a torque [N.m]."""
    return K_SUN * math.pow(T / 1000, GROWS)


def _fits(z_1: int, z_3: int) -> bool:
    """Whether whole planets stand at equal angles."""
    return (z_3 - z_1) % 2 == 0 and (z_1 + z_3) % PLANETS == 0


#: Who makes a stage of a kind.
MAKE: Mapping[str, Callable[[str, float, float, float, float | None], Stage]] = {
    "spur": _cylindrical,
    "helical": _cylindrical,
    "bevel": _bevel,
    "worm": _worm,
    "planetary": _planetary,
}
