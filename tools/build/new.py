"""A rig file from a name plate, that runs at once and says of every number how it came about."""

from __future__ import annotations

import json
import math
import re
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from ...model.errors import GearheatError, ScenarioError, suggestion
from ...model.run.steady import steady
from ...model.units import to_si
from ...scenarios.entries import catalogue
from ...scenarios.load import load as read_rig
from ..describe.rig import Rig
from ..show.console import writable, write
from ..solve.settings import flat_of
from ..solve.steady import SteadyState, conditions
from . import sizing
from .bearings import LIGHT
from .plausible import WARM, notes, usual
from .sizing import APART, GAP, OVERHANG, SIDE, Unit, unit, wanted_of
from .stages import FACE, K_BEVEL, K_STAR, KINDS, SLIM, T_WORM, WIDTH, Y_W, BevelStage, PlanetaryStage, Stage, WormStage

#: Density of steel [kg/m3].
STEEL = 7850.0
#: Density of cast iron [kg/m3].
IRON = 7200.0
#: Density of oil at which churning is stated [kg/m3].
OIL = 835.0
#: Diameter of a fan over the smaller side of the housing [1].
SWEEP = 0.8
#: Air along the walls over the speed of the fan's tips [1].
AIR = 0.12
#: Power of a fan over rho n3 D5 [1].
FAN = 3.0
#: How much warmer the oil is than the water or air of its cooler [K].
COOLED = 50.0
#: Iron of ribs and flanges over that of the walls [1].
RIBBED = 0.25
#: Height of a rib over its thickness [1].
RIBS = 2.5
#: What a unit stands on.
BASES = ("concrete", "steel", "flange", "free")
#: Bolts of a foot or flange.
BOLTS = 4
#: Diameter of a bolt over the wall's thickness [1].
BOLT = 1.5
#: Width of the two strips that a foot stands on over that of the housing [1].
STRIPS = 2 * 0.15
#: Inner over outer diameter of the ring on which a flange stands [1].
SPIGOT = 0.77
#: Thickness of a steel frame over that of the wall [1].
FRAME = 2.0
#: How far it reaches beyond foot or flange, at either end, over their length [1].
BEYOND = 0.5
#: How a foot or flange is held.
_BOLTED = f"{BOLTS} bolts {BOLT:g} times as thick as the walls, 0.2 mm of air beside them"
#: What the answer holds of a stage.
STAGE_KEYS = ("kind", "z_1", "z_2", "m_n", "beta", "b")
#: Kind of stage -> the size by which one is known.
SIZES = {"spur": "a", "helical": "a", "bevel": "d_e2", "worm": "a", "planetary": "a"}
#: Speed at which churning is stated, 200 rpm [rad/s].
CHURNED = 200 * math.pi / 30


@dataclass(frozen=True, eq=False, repr=False)
class NewRig(Rig):
    """A rig from a name plate.

    Attributes:
        sizes: the JSON object: stages, bearings, what it does at the name plate
        notes: what a user should know about it
    """

    sizes: Mapping[str, Any] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


def new(
    name: str,
    *,
    stages: str | Sequence[str],
    ratio: float,
    power: str,
    speed: str,
    oil: str = "ISO VG 220 mineral",
    bearings: str = "auto",
    fan: bool = False,
    cooler: bool = False,
    base: str = "concrete",
    motor_heat: str | None = None,
    centre_distance: str | None = None,
    housing: str | None = None,
    oil_volume: str | None = None,
    out: str | Path | None = None,
) -> NewRig:
    """A rig of your own from a name plate: it runs at once, and says the rule of every number.

    Args:
        name: of the rig
        stages: from the input, such as "helical,helical"; bevel first; worm or planetary alone
        ratio: speed of the input over that of the output
        power: at the input, such as "7.5 kW"
        speed: of the input, such as "1450 rpm"
        oil: entry of the catalogue
        bearings: "ball", "roller" (tapered, face to face), or "auto": rollers on shafts where balls do not last
        fan: on the input shaft
        cooler: of the oil, for the losses at the name plate
        base: what its foot stands on, "concrete" or a "steel" frame; "flange" on a steel plate; "free" on rubber, or
            where it hangs on its shaft
        motor_heat: what comes by the flange of a motor that is bolted to it, such as "50 W"
        centre_distance: of the last stage, spur, helical or worm, such as "160 mm"; by load if None
        housing: length, width and height, such as "800x370x430 mm", or its area, such as "1.6 m2"; a box around the
            gears if None
        oil_volume: such as "20 l"; the level at which the smallest wheel dips if None
        out: file to write; none is left if None

    Raises:
        ScenarioError: all that is wrong with the name plate at once

    Example:
        >>> import gearheat as gh
        >>> mine = gh.new("mine", stages="helical,helical", ratio=12.56, power="7.5 kW", speed="1450 rpm")
        >>> mine.sizes["assumed"] > 0
        True
    """
    words = stages.split(",") if isinstance(stages, str) else stages
    kinds = [kind.strip() for kind in words if kind.strip()]
    wanted = wanted_of(centre_distance, housing, oil_volume)
    plate = to_si(power, "W", name="--power"), to_si(speed, "rad/s", name="--speed")
    made = unit(kinds, ratio, *plate, bearings, wanted)
    entry = _oil(oil)
    if base not in BASES:
        raise ScenarioError(f'nothing stands on "{base}".{suggestion(base, BASES)} Bases: {", ".join(BASES)}.')
    motor = None if motor_heat is None else to_si(motor_heat, "W", name="--motor-heat")
    if motor is not None and motor < 0:
        raise ScenarioError(f"--motor-heat = {motor_heat}: a motor gives heat, expected 0 W or more.")
    if not re.fullmatch(r"[\w.-]+", name):
        raise ScenarioError(f'"{name}" is no name. Take letters, digits, _, - and dots.')
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{name}.toml" if out is None else Path(out)
        writable(path)
        if path.exists():
            raise ScenarioError(f"{path}: is there already. Give another name, or take it away.")
        doc = f"{name}: {', '.join(kinds)}, i = {made.ratio:.4g}, {power} at {speed}, {entry}"
        boxed = housing is not None
        write(path, text(made, doc, speed, entry, base=base, fan=fan, cooler=cooler, motor=motor, boxed=boxed))
        try:
            scenario = read_rig(path)
            flat = flat_of(scenario)
            point = conditions(scenario, flat)
            rest = SteadyState(scenario, flat, steady(flat, point), backward=False)
            idle = steady(flat, point | {"output.load": 0.0})["efficiency.P_loss"]
        except GearheatError as error:
            path.unlink()
            why = error.problems[0]
            raise ScenarioError(f"{power} at {speed} gives no gearbox. Check --power and --speed. {why}") from None
    foot = rest["foot.Q_flow"] if base != "free" else 0.0
    sizes = {
        "schema": "gearheat.new/1",
        "file": str(path),
        "ratio": made.ratio,
        "stages": [{k: getattr(s, k) for k in (*STAGE_KEYS, SIZES[s.kind])} for s in made.stages],
        "bearings": [{"a": s.bearings[0], "b": s.bearings[1], "lives_h": s.lives} for s in made.shafts],
        "assumed": sum(source.startswith("assumed") for source in scenario.value_sources.values()),
        "oil_degC": rest["oil.T"] - 273.15,
        "loss_W": rest["efficiency.P_loss"],
        "no_load_W": float(idle[0]),
        "losses_W": rest.losses_by_kind(),
        "efficiency": rest["efficiency.eta"],
        "usual": {"efficiency_pct": usual(kinds, rest["input.P"] / 1000, ratio), "oil_degC": WARM},
        "base": base,
        "foot_share": foot / (rest["efficiency.P_loss"] + (motor or 0.0)),
    }
    return NewRig(scenario, sizes, tuple(notes(made, sizes, rest["input.w"])))


def _oil(name: str) -> str:
    """The catalogue's name of an oil; one of a class alone is taken for a mineral oil."""
    for known in (name, f"{name} mineral"):
        if known in catalogue("oil"):
            if "c_p" not in catalogue("oil")[known].values:
                raise ScenarioError(f'"{known}" is a grease. Name an oil. See `gearheat list`.')
            return known
    raise ScenarioError(f'there is no oil "{name}".{suggestion(name, catalogue("oil"))} See `gearheat list`.')


def text(
    made: Unit,
    doc: str,
    speed: str,
    oil: str,
    *,
    base: str,
    fan: bool,
    cooler: bool,
    motor: float | None,
    boxed: bool = False,
) -> str:
    """The rig file of a unit.

    Args:
        made: its sizes
        doc: what it is
        speed: of the input, as it is written
        oil: entry of the catalogue
        base: one of `BASES`
        fan: whether one is on the input shaft
        cooler: whether the oil has one
        motor: heat that comes by the flange of a motor [W], None without one
        boxed: whether the housing is that of a data sheet
    """
    n, efficiency = len(made.stages), math.prod(s.efficiency for s in made.stages)
    worm = isinstance(made.stages[0], WormStage)
    names = ["input", *(f"middle_{k}" if n > 2 else "middle" for k in range(1, n)), "output"]
    values = {
        "doc": doc,
        "speed": speed,
        "efficiency": efficiency,
        "load": made.stages[0].T * made.ratio * efficiency,
        "oil": oil,
        "bath": sizing.bath(made),
        "splash": sizing.splash(made) | {"r": "stage_1.r_1" if worm else _reach(made.stages[0], 0)},
        "below": sizing.BELOW,
        "reached": 100 * sizing.REACHED,
        "side": SIDE,
        "gap": GAP,
        "overhang": OVERHANG,
        "apart": APART,
        "own_load": 0.0 if made.shafts[0].places else LIGHT,
        "stages": [_stage(made, k) for k in range(n)],
        "shafts": [_shaft(made, names, k) for k in range(n + 1)],
        "seals": [{"name": f"{names[k]}_seal", "d": made.shafts[k].d_seal} for k in (0, -1)],
        "fan": _fan(made) if fan else None,
        "cooled": COOLED,
        "cooler": _cooler(made, efficiency) if cooler else None,
        "foot": _foot(made, base),
        "motor": motor,
        "boxed": boxed,
        **_bodies(made),
    }
    templates = Environment(loader=PackageLoader("gearheat.tools.build", "templates"), undefined=StrictUndefined)
    templates.filters |= {"json": json.dumps, "at": _at}
    return templates.get_template("new_rig.toml").render(values, num=_num, mm=_mm).strip() + "\n"


def _at(parts: Iterable[str], *ports: str) -> list[str]:
    """Ports, or outputs, of several parts."""
    return [f"{part}.{port}" for part in parts for port in ports]


def _num(value: float) -> str:
    return f"{value:.4g}"


def _mm(value: float) -> str:
    return f"{1000 * value:.6g}"


def _stage(made: Unit, k: int) -> dict[str, Any]:
    s = made.stages[k]
    if isinstance(s, BevelStage):
        rule = f"F_t/(b d_v1) (u_v + 1)/u_v of {K_BEVEL / 1e6:g} N/mm2 at mid face, d_e2 of {_mm(s.d_e2)} mm"
        shape: dict[str, Any] = {"type": "BevelGearPair", "m_et": s.m_et, "x_1": s.x_1, "width": FACE}
    elif isinstance(s, PlanetaryStage):
        rule = f"F_t/(b d_1) (u + 1)/u of {K_STAR / 1e6:g} N/mm2 of sun and planet, standard module, straight teeth"
        shape = {"type": "PlanetarySet", "N": s.count, "z_3": s.z_3, "m_n": s.m_n, "a": s.a, "width": WIDTH}
        shape |= {"s_planet": s.b / 2, "d_planet": s.d_planet, "driver": "sun", "driven": "carrier"} | s.ratios
    elif isinstance(s, WormStage):
        rule = f"wheel's torque over a3 of {T_WORM / 1e6:g} N/mm2 as makers rate them, standard a = {_mm(s.a)} mm"
        shape = {"type": "WormPair", "m_x": s.m_n, "d_1": s.d_1, "Y_W": Y_W, "width": SLIM, "driver": "worm"}
    else:
        twist = f"beta for a = {_mm(s.a)} mm" if KINDS[s.kind] else "a follows from the teeth"
        rule = f"F_t/(b d_1) (u + 1)/u of {K_STAR / 1e6:g} N/mm2, standard module and centre distance, {twist}"
        shape = {"type": "HelicalGearPair", "m_n": s.m_n, "a": s.a, "width": WIDTH}
    c = 0.5 * OIL * CHURNED**3 * s.b * s.reach**4
    shape |= {"z_1": s.z_1, "z_2": s.z_2, "b": s.b, "beta": f"{math.degrees(s.beta):.6f}", "rule": rule, "c": c}
    found = {"name": f"stage_{k + 1}", "churning": f"churning_{k + 1}", "wetting": f"oil_gears_{k + 1}"}
    found |= {"driver": "pinion", "driven": "wheel"}
    return (
        found
        | shape
        | {"r": _reach(s, k), "height": sizing.height_of_axes(made), "A_wet": sizing.compute_wetted_area(s)}
    )


def _reach(s: Stage, k: int) -> str:
    """Radius of what moves the oil: that of the wheel, or how far planets reach."""
    return f"{_mm(s.reach)} mm" if isinstance(s, PlanetaryStage) else f"stage_{k + 1}.r_2"


def _shaft(made: Unit, names: Sequence[str], k: int) -> dict[str, Any]:
    s = made.shafts[k]
    radii = [f"stage_{k}.r_2"] * (k > 0) + [f"stage_{k + 1}.r_1"] * (k < len(made.stages))
    places = [
        {
            "name": f"{names[k]}_bearing_{end}",
            "path": f"{names[k]}_path_{end}",
            "bearing": bearing,
            "life": _num(life),
            "dips": sizing.stands_in_oil(made, bearing),
            "use": f"{s.kind}_bearing",
        }
        for end, bearing, life in zip("ab", s.bearings, s.lives, strict=True)
    ]
    gears = [{"x": x, "r": r} for x, r in zip(s.places, radii, strict=False)]
    support = ("", "ShaftSupport", "TwoGearSupport")[len(gears)]
    return {
        "name": names[k],
        "support": support,
        "gears": gears,
        "span": s.span,
        "bearings": places,
        "kind": s.kind,
        "d": s.d,
        "d_torsion": s.d_torsion,
    }


def _fan(made: Unit) -> dict[str, float]:
    """A fan as wide as a cowl on the smaller side of the housing holds: air along the walls, and its torque."""
    D = SWEEP * min(made.width, made.height)
    return {"D": D, "k_v": AIR * D / 2, "k": FAN * 1.2 * D**5 / (2 * math.pi) ** 3, "share": AIR}


def _cooler(made: Unit, efficiency: float) -> float:
    """Conductance of a cooler that takes all that is lost at the name plate [W/K]."""
    return (1 - efficiency) * made.stages[0].T * 2 * math.pi * made.stages[0].n / COOLED


def _foot(made: Unit, base: str) -> dict[str, Any] | None:
    """Foot of a unit, two strips along the housing, or its flange, and what they stand on."""
    if base == "free":
        return None
    if base == "flange":
        D, wide = min(made.length, made.height), 1 + 2 * BEYOND
        rule = f"a ring of {_mm(round(D, 3))} mm, the smaller side of the housing, {SPIGOT:g} of it inside, {_BOLTED}"
        return {
            "base": base,
            "A": math.pi / 4 * (1 - SPIGOT**2) * D**2,
            "count": BOLTS,
            "d": BOLT * made.wall,
            "A_frame": 2 * math.pi / 4 * (wide**2 - 1) * D**2,
            "t_frame": FRAME * made.wall,
            "L_frame": BEYOND * D,
            "rule": f"{rule}; a steel plate {FRAME:g} times as thick as the walls, {wide:g} times as wide, in air",
        }
    outline, beyond = made.length * made.width, BEYOND * made.length
    on = {
        "concrete": "heat spreads below its outline into a concrete floor",
        "steel": f"a steel frame {FRAME:g} times as thick as the walls, {1 + 2 * BEYOND:g} times as long, in air",
    }
    rule = f"two strips of {STRIPS / 2:g} of the housing's width, {_BOLTED}"
    return {
        "base": base,
        "A": STRIPS * outline,
        "count": BOLTS,
        "d": BOLT * made.wall,
        "outline": outline,
        "A_frame": 2 * 2 * beyond * made.width,
        "t_frame": FRAME * made.wall,
        "L_frame": beyond,
        "rule": f"{rule}; {on[base]}",
    }


def _bodies(made: Unit) -> dict[str, float]:
    """Capacities, conductances and the box."""
    slow = [math.prod(t.u for t in made.stages[:k]) for k in range(len(made.stages))]
    seats = [(made.shafts[k + 1].d, s.b) for k, s in enumerate(made.stages)]
    shafts = sum(STEEL * math.pi / 4 * s.d**2 * (s.span + 0.1) for s in made.shafts)
    mass = (1 + RIBBED) * IRON * made.area * made.wall
    return {
        "inertia": sum(STEEL * s.inertia / i**2 for s, i in zip(made.stages, slow, strict=True)),
        "C_gears": 470 * STEEL * sum(s.volume for s in made.stages),
        "C_shafts": 470 * shafts,
        "mass": mass,
        "C_half": 500 * mass / 2,
        "wall": made.wall,
        "G_seats": 4000 * sum(math.pi * d * b for d, b in seats),
        "A_fins": 2 * RIBBED * made.area,
        "fin_height": RIBS * made.wall,
        "ribs": RIBS,
        "area": made.area,
        "length": made.length,
        "width_box": made.width,
        "height": made.height,
        "share": made.length * made.width / made.area,
    }
