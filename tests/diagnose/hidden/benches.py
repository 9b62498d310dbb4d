"""Test benches: what is measured of a rig, with the user's own columns, over which points, and how far it is known.

Nothing here comes from the diagnosis; what a card says of a bench is what the campaigns are drawn with.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

RPM = np.pi / 30


@dataclass(frozen=True)
class Gauge:
    """An instrument: sensor of the rig, column of the user, what it reads, and its accuracy in the column's unit.

    Args:
        name: of the sensor in the rig file, or of the card's where the rig has none
        given: whether it drives the model
        own: whether the card has to declare it, as the rig has no such sensor
        magnitude: whether the column holds magnitudes
    """

    name: str
    column: str
    reads: str
    unit: str
    repeat_sd: float
    offset_sd: float
    given: bool = False
    own: bool = False
    magnitude: bool = False

    @property
    def scale(self) -> float:
        """SI over the column's unit."""
        return RPM if self.unit == "rpm" else 1.0

    @property
    def zero(self) -> float:
        """SI at zero of the column."""
        return 273.15 if self.unit == "degC" else 0.0


@dataclass(frozen=True)
class Test:
    """One test: inputs of its points [SI], the room's temperature at the end of each, and the directions."""

    __test__ = False

    inputs: tuple[Mapping[str, float], ...]
    room: tuple[float, ...]
    direction: tuple[int, ...]


@dataclass(frozen=True)
class Bench:
    """A rig on a bench.

    Args:
        name: of the bench
        rig: name of a shipped rig
        gauges: what is read
        tests: the tests that a random generator draws, in running order
        prior_sd: "Type.parameter" -> standard deviation of the logarithm of what parts of a type truly have
        day: parameters of a test's cooling that scatter from day to day
        day_sd: by so much
        brake: path of the shaft end whose torque shows a loss that the model does not have
        dwells: time of each point of a test [s]; none for steady states
        stop: time without load between them [s]
    """

    name: str
    rig: str
    gauges: tuple[Gauge, ...]
    tests: Callable[[np.random.Generator], list[Test]]
    prior_sd: Mapping[str, float]
    day: tuple[str, ...]
    brake: str
    day_sd: float = 0.01
    dwells: tuple[float, ...] = ()
    stop: float = 300.0

    def gauge(self, name: str) -> Gauge:
        """The instrument of a name."""
        return next(g for g in self.gauges if g.name == name)

    def card(self) -> str:
        """The card as a user writes it: TOML."""
        lines = ['schema = "gearheat.card/2"', f"day_cooling_sd = {self.day_sd}", "", "[columns]"]
        lines += [f'{g.name} = "{g.column}"' for g in self.gauges if not g.own]
        lines += ["", "[channels]"]
        lines += [f"{g.name} = {{ repeat_sd = {g.repeat_sd}, offset_sd = {g.offset_sd} }}" for g in self.gauges]
        lines += ["", "[prior_sd]"] + [f'"{key}" = {sd}' for key, sd in self.prior_sd.items()]
        for g in self.gauges:
            if g.own:
                lines += ["", f"[sensors.{g.name}]", f'column = "{g.column}"', f'reads = "{g.reads}"']
            elif g.magnitude and not self.dwells:
                lines += ["", f"[sensors.{g.name}]", "magnitude = true"]
        if self.dwells:
            minutes = [d / 60 for d in self.dwells]
            lines += ["", "[protocol]", f"dwell_min = {minutes}", f"stop_min = {self.stop / 60}"]
        return "\n".join(lines) + "\n"


def drawn(rng: np.random.Generator, speeds: list[float], torques: list[float], again: int) -> list[tuple[float, float]]:
    """Points (speed, torque) near every crossing of two lists, some of them twice, in random order."""
    points = [(w * rng.uniform(0.97, 1.03), tau * rng.uniform(0.96, 1.04)) for w in speeds for tau in torques]
    points += [points[k] for k in rng.choice(len(points), again, replace=False)]
    return [points[k] for k in rng.permutation(len(points))]


def rooms(rng: np.random.Generator, n: int) -> np.ndarray:
    """Temperatures of a room over n tests [K]: seasons and days."""
    return 273.15 + 21 + 5 * np.sin(np.linspace(0, 5, n) + rng.uniform(0, 6)) + rng.normal(0, 1.5, n)


def steady_points(
    w: str, tau: str, speeds: list[float], torques: list[float], again: int = 4
) -> Callable[[np.random.Generator], list[Test]]:
    """Steady points, one a test."""

    def tests(rng: np.random.Generator) -> list[Test]:
        points = drawn(rng, [RPM * n for n in speeds], torques, again)
        warm = rooms(rng, len(points))
        return [Test(({w: a, tau: b},), (float(T),), (1,)) for (a, b), T in zip(points, warm, strict=True)]

    return tests


def both_directions(
    w: str, tau: str, speeds: list[float], torques: list[float], again: int = 2
) -> Callable[[np.random.Generator], list[Test]]:
    """Tests of two dwells, one a direction."""

    def tests(rng: np.random.Generator) -> list[Test]:
        points = drawn(rng, [RPM * n for n in speeds], torques, again)
        warm = rooms(rng, len(points))
        late = warm + rng.normal(0.6, 0.5, len(points))
        return [
            Test(({w: a, tau: b}, {w: a, tau: -b}), (float(T), float(U)), (1, 2))
            for (a, b), T, U in zip(points, warm, late, strict=True)
        ]

    return tests


HELICAL = Bench(
    "helical",
    "helical_two_stage",
    (
        Gauge("n_input", "Drehzahl [rpm]", "input.w", "rpm", 0.3, 0.3, given=True),
        Gauge("T_output", "Abtrieb [N.m]", "output.tau", "N.m", 0.3, 0.6, given=True, magnitude=True),
        Gauge("T_input", "Antrieb [N.m]", "input.tau", "N.m", 0.02, 0.04, own=True),
        Gauge("T_oil", "Ölsumpf [degC]", "oil.T", "degC", 0.15, 0.15),
        Gauge("T_wall", "Gehäuse [degC]", "wall.T", "degC", 0.15, 0.15),
        Gauge("T_amb", "Halle [degC]", "room.T", "degC", 0.15, 0.15, given=True),
    ),
    steady_points("input.w", "output.tau", [500, 900, 1200, 1500], [-100, -220, -340, -460, -590]),
    {
        "HelicalGearPair.k_mu": 0.10,
        "DeepGrooveBallBearing.k_loss": 0.12,
        "LipSeal.k_loss": 0.15,
        "Churning.k_loss": 0.20,
        "FinnedBoxCooling.A": 0.06,
        "FinnedBoxCooling.emissivity": 0.03,
        "ThermalConductor.G": 0.20,
    },
    ("cooling.A",),
    "input",
)

HARMONIC = Bench(
    "harmonic",
    "harmonic",
    (
        Gauge("n_wave_generator", "speed [rpm]", "wave_generator.w", "rpm", 0.5, 0.5, given=True),
        Gauge("T_output", "load [N.m]", "output.tau", "N.m", 0.2, 0.4, given=True),
        Gauge("T_wave_generator", "motor torque [N.m]", "wave_generator.tau", "N.m", 0.003, 0.006, own=True),
        Gauge("T_oil", "sump [degC]", "oil.T", "degC", 0.15, 0.15),
        Gauge("T_wall", "case [degC]", "housing.T", "degC", 0.15, 0.15),
        Gauge("T_amb", "lab [degC]", "room.T", "degC", 0.15, 0.15, given=True),
    ),
    steady_points("wave_generator.w", "output.tau", [400, 700, 1000, 1500], [30, 75, 120, 165, 210]),
    {
        "HarmonicMesh.mu_fluid": 0.10,
        "HarmonicMesh.mu_boundary": 0.10,
        "DeepGrooveBallBearing.k_loss": 0.12,
        "LipSeal.k_loss": 0.15,
        "Churning.k_loss": 0.20,
        "CylinderCooling.A": 0.06,
        "CylinderCooling.emissivity": 0.03,
        "ThermalConductor.G": 0.20,
    },
    ("cooling.A",),
    "wave_generator",
)

PLANETARY = Bench(
    "planetary",
    "planetary",
    (
        Gauge("n_carrier", "n_carrier_rpm", "carrier.w", "rpm", 0.2, 0.2, given=True),
        Gauge("T_carrier", "T_carrier_Nm", "carrier.tau", "N.m", 1.0, 3.0, given=True, magnitude=True),
        Gauge("T_sun", "T_sun_Nm", "sun.tau", "N.m", 0.25, 0.75, magnitude=True),
        Gauge("T_oil", "T_oil_C", "oil.T", "degC", 0.25, 0.2),
        Gauge("T_wall", "T_wall_C", "wall.T", "degC", 0.25, 0.2),
        Gauge("T_amb", "T_amb_C", "room.T", "degC", 0.25, 0.2, given=True),
    ),
    both_directions("carrier.w", "carrier.tau", [100, 150, 200, 250], [1600, 1950, 2300, 2650]),
    {
        "PlanetarySet.k_mu": 0.10,
        "TaperedRollerBearing.k_loss": 0.12,
        "DeepGrooveBallBearing.k_loss": 0.12,
        "NeedleBearing.k_loss": 0.12,
        "LipSeal.k_loss": 0.15,
        "CylinderCooling.A": 0.06,
        "CylinderCooling.emissivity": 0.03,
        "ThermalConductor.G": 0.20,
        "HeatCapacity.C": 0.10,
    },
    ("cooling.A", "foot.G"),
    "sun",
    day_sd=0.015,
    dwells=(14400.0, 5400.0),
)

#: Seals are a sixteenth of the losses: half as much again shows where loads are small, instruments are of laboratory
#: grade, and the drag of the sound seals is known.
FINE = replace(
    HELICAL,
    name="helical_fine",
    gauges=tuple(replace(g, repeat_sd=g.repeat_sd / 4, offset_sd=g.offset_sd / 4) for g in HELICAL.gauges),
    tests=steady_points("input.w", "output.tau", [300, 600, 1000, 1500], [-20, -80, -200, -400, -590]),
    prior_sd={**HELICAL.prior_sd, "LipSeal.k_loss": 0.05},
)

BENCHES = {bench.name: bench for bench in (HELICAL, FINE, HARMONIC, PLANETARY)}
