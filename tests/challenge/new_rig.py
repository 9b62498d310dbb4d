"""Campaigns on rigs of `gearheat new` with a fan on the input shaft: a part is set wrong, and its rig file is not told.

What is hidden is a value of a part, as a user would change it in the rig file; nothing of the diagnosis is used. Each
campaign has steady points in halls of three temperatures, with the noise and the fixed tolerances of the default card.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import gearheat
import numpy as np
from gearheat.model.machines.roles import Roles
from gearheat.model.units import from_si
from gearheat.scenarios.load import load
from gearheat.scenarios.measured.card import Card
from gearheat.scenarios.measured.nominal import Nominal
from gearheat.scenarios.measured.sensors import sensors_of
from gearheat.scenarios.measured.table import Sensor


@dataclass(frozen=True)
class Plate:
    """A name plate: stages, ratio, power [kW], speed [rpm]."""

    stages: int
    ratio: float
    power: float
    speed: float


#: Name plate of a campaign by its seed.
PLATES: Mapping[int, Plate] = {
    1: Plate(2, 12.56, 11.0, 1450.0),
    2: Plate(3, 24.6, 7.5, 1450.0),
    3: Plate(2, 9.0, 22.0, 1470.0),
}
#: What is hidden -> factors on a parameter of parts whose names hold a word.
FAULTS: Mapping[str, Sequence[tuple[str, str, float]]] = {
    "healthy": [("fan", "k_v", 1.0)],
    "rules of another book": [
        ("seal", "k_loss", 3.0),
        ("bearing", "k_loss", 1.5),
        ("churning", "k_loss", 3.0),
        ("stage_", "k_mu", 0.8),
        ("oil_wall", "A", 0.6),
        ("cooling", "A", 1.25),
    ],
    "fan dead": [("fan", "k_v", 0.0)],
    "fan at 40 %": [("fan", "k_v", 0.4)],
    "bearing": [("input_bearing_a", "k_loss", 3.0)],
    "teeth": [("stage_", "k_mu", 1.8)],
}
#: A fan whose air has 3.6 m/s at a motor's speed.
FAN = """
[part.fan]
type = "ShaftFan"
k_v = "0.024 m"
k = "1e-5 N.m.s2"
source = "assumed: a small radial fan under a cowl"
"""
#: Nets and sensors of the rig file -> the same with the fan and a torque transducer at the input.
CHANGES = {
    'air = ["room.air", "cooling.air"]': 'air = ["room.air", "fan.room"]\nblown = ["fan.air", "cooling.air"]',
    'input_shaft = ["input.flange", ': 'input_shaft = ["input.flange", "fan.shaft", ',
    'T_output_Nm = "output.tau"': 'T_output_Nm = "output.tau"\nT_input_Nm = "input.tau"',
    "# ---------------------------------------------------------------------------------------------- gears\n": FAN,
}
#: Shares of the speed and of the load of the name plate, and temperatures of the hall [degC].
SPEEDS = (0.4, 0.7, 1.0)
LOADS = (0.25, 0.6, 1.0)
ROOMS = (8.0, 18.0, 28.0)


def write_rig(folder: Path, seed: int) -> Path:
    """The rig file of a seed.

    Args:
        folder: where to write it
        seed: in `PLATES`
    """
    plate, path = PLATES[seed], folder / "mine.toml"
    stages = ",".join(["helical"] * plate.stages)
    power, speed = f"{plate.power:g} kW", f"{plate.speed:g} rpm"
    gearheat.new("mine", stages=stages, ratio=plate.ratio, power=power, speed=speed, out=path)
    text = path.read_text("utf-8")
    for old, new in CHANGES.items():
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    path.write_text(text, "utf-8")
    return path


def write_campaign(folder: Path, rig: Path, fault: str, seed: int) -> Path:
    """A table of steady readings of a rig with something hidden in it.

    Args:
        folder: where to write it
        rig: its file
        fault: in `FAULTS`
        seed: of the noise
    """
    scenario, rng = load(str(rig)), np.random.default_rng([35, seed])
    nominal, sensors = Nominal(scenario), sensors_of(scenario, Card())
    roles, names = Roles.of(scenario.spec), [p.name for p in scenario.spec.parts]
    paths = {f"{name}.{key}": factor for word, key, factor in FAULTS[fault] for name in names if word in name}
    wrong = {path: factor * float(roles.value(path)) for path, factor in paths.items() if path in nominal.flat.index}
    assert wrong, fault
    offsets = {s.name: s.offset_sd * rng.standard_normal() for s in sensors}
    columns: dict[str, list[float]] = {s.column: [] for s in sensors}
    points = [(n, load_, room) for room in ROOMS for n in SPEEDS for load_ in LOADS]
    for speed, share, room in [points[k] for k in rng.permutation(len(points))]:
        given = {"input.w": speed * nominal.value("input.w"), "output.load": share * nominal.value("output.load")}
        given["room.T"] = room + 273.15
        state = nominal.at(given | wrong)
        assert state is not None
        for s in sensors:
            value = state[s.reads] + offsets[s.name] + s.repeat_sd * rng.standard_normal()
            columns[s.column].append(round(as_shown(s, value), 3))
    lines = [",".join(columns), *(",".join(map(str, row)) for row in zip(*columns.values(), strict=True))]
    path = folder / f"{fault.split(maxsplit=1)[0]}.csv"
    path.write_text("\n".join(lines) + "\n", "utf-8")
    return path


def as_shown(sensor: Sensor, value: float) -> float:
    """A reading [SI] as the sensor's column shows it."""
    unit = {"torque": "N.m", "speed": "rad/s"}.get(sensor.kind, "K")
    return float(from_si(value * float(sensor.sign(np.array(1.0))), unit))
