"""The rig file of a gear unit: its sizes, what stands around it, and the rule of every number."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from ...model.errors import Problems, ScenarioError, suggestion
from ...model.parts.joints import PRESSED
from ...model.units import to_si
from ...scenarios.ranges import RANGES
from . import sizing
from .bearings import LIGHT, PRELOAD
from .shafts import APART, OVERHANG
from .sizing import Unit
from .stages import DRAG, KINDS, Y_W, BevelStage, PlanetaryStage, WormStage
from .teeth import FACE, K_BEVEL, K_STAR, NARROW, SLIM, T_WORM, WIDTH, load_of_sun

#: Fastest air along a housing [m/s].
STORM = to_si(RANGES["m/s"]["air_speed"][1], "m/s")
#: Density of steel [kg/m3].
STEEL = 7850.0
#: Density [kg/m3], heat capacity [J/(kg.K)] and conductivity [W/(m.K)] of what housings are cast of.
CAST = {"cast iron": (7200.0, 500.0, 50.0), "aluminium": (2700.0, 900.0, 150.0)}
#: Centre distance below which makers cast housings of worms alone of aluminium [m].
SMALL = 0.1
#: Density of oil at which churning is stated [kg/m3].
OIL = 835.0
#: How much longer shafts are than the distance of their bearings, over their diameter [1].
ENDS = 2.0
#: Diameter of a fan over the geometric mean of width and height of the housing [1].
SWEEP = 0.6
#: Air along the walls over the speed of the fan's tips [1]. Thermal power of a 22 kW unit, three stages, is 1.08, 1.12,
#: 1.17 and 1.24 of that without it at 710, 900, 1120, 1400 rpm (air 1.25 m/s, 40 degC, oil 95 degC); a maker has 1.12,
#: 1.18, 1.25 and 1.32 for one fan on parallel shafts (Rossi, UT.D 123 rev. 3, table 7).
AIR = 0.15
#: Power of a fan over rho n3 D5 [1].
FAN = 3.0
#: How much warmer the oil is than the water or air of its cooler [K].
COOLED = 50.0
#: How much all of the loss warms cooled oil, half of which is sprayed on teeth, half on bearings, usual of coolers [K].
WARMED = 15.0
#: How much nearer it comes to the temperature of what it is sprayed on [1].
TAKEN = 0.5
#: Metal of ribs, fins and flanges, and what it is over that of the walls [1]; of worms fitted to makers' masses (NMRV).
RIBBED = {"gears": ("cast iron", 0.25), "worm": ("cast iron", 0.6), "small worm": ("aluminium", 1.45)}
#: Height of a rib over its thickness [1].
RIBS = 2.5
#: Speed of the air along a housing in a room with little draught [m/s].
DRAUGHT = 0.3
#: That for which a maker rates units with a motor that cools itself (Rossi, UTD.123.2019-10, 7.16) [m/s].
BLOWN = 1.25
#: What units stand on.
CONCRETE = "concrete"
#: And planetary ones.
FLANGED = "flange"
#: All.
BASES = (CONCRETE, "steel", FLANGED, "free")
#: Bolts of a foot or flange.
BOLTS = 4
#: Diameter of a bolt over the wall's thickness [1].
BOLT = 1.5
#: Share of a face that bolts press at most [1]: M6 to M16 press .12 to .19 of flanges of 120 to 350 mm (IEC 60072-1).
HELD = 0.15
#: Width of the two strips that a foot stands on over that of the housing [1].
STRIPS = 2 * 0.15
#: Inner over outer diameter of the ring on which a flange stands [1].
SPIGOT = 0.77
#: Thickness of a steel frame over that of the wall [1].
FRAME = 3.0
#: How far it reaches beyond foot or flange, at either end, over their length [1].
BEYOND = 0.75
#: Life of a bearing above which its figure says nothing [h].
ENDLESS = 1e6
#: Speed at which churning is stated, 200 rpm [rad/s].
CHURNED = 200 * math.pi / 30


@dataclass(frozen=True)
class Around:
    """What stands around a unit, and what cools it.

    Args:
        base: one of `BASES`
        fan: whether one is on the input shaft
        cooler: whether the oil has one
        motor: heat that comes by the flange of a motor [W], None without one
        air: speed of the air along the housing [m/s]
        boxed: whether the housing is that of a data sheet
    """

    base: str
    fan: bool
    cooler: bool
    motor: float | None
    air: float
    boxed: bool


def around_of(base: str, fan: bool, cooler: bool, heat: str | None, air: str | None, boxed: bool) -> Around:
    """What stands around a unit, from what is written."""
    problems, motor, draught = Problems(), None, DRAUGHT
    if base not in BASES:
        problems.append(f'nothing stands on "{base}".{suggestion(base, BASES)} Bases: {", ".join(BASES)}.')
    if heat is not None:
        motor, draught = problems.of(lambda: to_si(heat, "W", name="--motor-heat", usual=("W", "kW"))), BLOWN
    if motor is not None and motor < 0:
        problems.append(f"--motor-heat = {heat}: a motor gives heat, expected 0 W or more.")
    speed = draught if air is None else problems.of(lambda: to_si(air, "m/s", name="--air-speed"))
    if speed is not None and not 0 <= speed <= STORM:
        problems.append(f"--air-speed = {air}: expected 0 m/s to {STORM:g} m/s.")
    if problems or speed is None:
        raise ScenarioError(problems)
    return Around(base, fan, cooler, motor, speed, boxed)


@dataclass(frozen=True)
class Losses:
    """What a unit loses at the name plate.

    Args:
        eta: efficiency, by which the load follows [1]
        P: loss, which a cooler takes [W]
        solved: whether the efficiency is that of the rig, not that of its stages by a rule
    """

    eta: float
    P: float
    solved: bool = False


def lost(made: Unit) -> Losses:
    """What a unit loses by the efficiencies of its stages."""
    eta = math.prod(s.efficiency for s in made.stages)
    return Losses(eta, (1 - eta) * made.power)


def text(made: Unit, doc: str, speed: str, oil: str, around: Around, losses: Losses) -> str:
    """The rig file of a unit.

    Args:
        made: its sizes
        doc: what it is
        speed: of the input, as it is written
        oil: entry of the catalogue
        around: what stands around it and cools it
        losses: at the name plate
    """
    n = len(made.stages)
    worm = isinstance(made.stages[0], WormStage)
    names = ["input", *(f"middle_{k}" if n > 2 else "middle" for k in range(1, n)), "output"]
    names = names[:: -1 if made.increases else 1]
    values = {
        "doc": doc,
        "speed": speed,
        "slow": names[-1],
        "losses": losses,
        "load": made.stages[0].T * max(made.ratio, 1.0) * losses.eta,
        "oil": oil,
        "bath": sizing.bath(made),
        "splash": sizing.splash(made) | {"r": f"stage_{made.numbers[0]}.r_1" if worm else _reach(made, 0)},
        "below": made.below,
        "form": "cylinder in the " if made.shape < 1 else "",
        "holds": f", larger on all sides for {1e6 * sizing.SUMP:g} l of oil a kW"
        if made.below > sizing.BELOW * made.wall
        else "",
        "reached": 100 * sizing.REACHED,
        "side": sizing.side_of(made.stages),
        "gap": made.wall,
        "overhang": OVERHANG,
        "apart": APART,
        "ends": ENDS,
        "preload": PRELOAD,
        "own_load": 0.0 if all(s.places for s in made.shafts) else LIGHT,
        "stages": [_stage(made, k) for k in range(n)],
        "shafts": [_shaft(made, names, k) for k in range(n + 1)],
        "seals": [{"name": f"{names[k]}_seal", "d": made.shafts[k].d_seal} for k in (0, -1)],
        "fan": _fan(made) if around.fan else None,
        "cooled": COOLED,
        "cooler": losses.P / COOLED if around.cooler else None,
        "sprayed": TAKEN / 2 * losses.P / WARMED,
        "warmed": WARMED,
        "taken": TAKEN,
        "foot": _foot(made, around.base),
        "motor": around.motor,
        "air": around.air,
        "draught": "beside a motor that cools itself" if around.air >= BLOWN else "with little draught",
        "boxed": around.boxed,
        **compute_bodies(made),
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
        load = load_of_sun(s.T * s.u)
        rule = f"F_t/(b d_1) (u + 1)/u of sun and planet at most {load / 1e6:.3g} N/mm2, standard module, spur teeth"
        shape = {"type": "PlanetarySet", "N": s.count, "z_3": s.z_3, "m_n": s.m_n, "a": s.a, "width": NARROW}
        shape |= {"s_planet": s.b / 2, "d_planet": s.d_planet, "driver": "sun", "driven": "carrier"} | s.ratios
        shape |= {"needles": f"planet_bearing_{made.numbers[k]}", "drag": DRAG}
    elif isinstance(s, WormStage):
        rule = f"wheel's torque over a3 of {T_WORM / 1e6:g} N/mm2 as makers rate them, standard a = {_mm(s.a)} mm"
        shape = {"type": "WormPair", "m_x": s.m_n, "d_1": s.d_1, "Y_W": Y_W, "width": SLIM, "driver": "worm"}
        if made.centre:
            rule = f"a = {_mm(s.a)} mm of a data sheet: wheel's torque over a3 of {s.intensity / 1e6:.3g} N/mm2"
    else:
        twist = f"beta for a = {_mm(s.a)} mm" if KINDS[s.kind] else "a follows from the teeth"
        rule = f"F_t/(b d_1) (u + 1)/u of {K_STAR / 1e6:g} N/mm2, standard module and centre distance, {twist}"
        if made.centre and k == len(made.stages) - 1:
            rule = f"F_t/(b d_1) (u + 1)/u of {s.intensity / 1e6:.3g} N/mm2 by a = {_mm(s.a)} mm of a data sheet"
        shape = {"type": "HelicalGearPair", "m_n": s.m_n, "a": s.a, "width": WIDTH}
    own = made.numbers[k]
    found: dict[str, Any] = {"name": f"stage_{own}", "churning": f"churning_{own}", "wetting": f"oil_gears_{own}"}
    found |= {"driver": "pinion", "driven": "wheel", "needles": None} | shape
    found |= {"z_1": s.z_1, "z_2": s.z_2, "b": s.b, "beta": f"{math.degrees(s.beta):.6f}", "rule": rule}
    found |= {"c": 0.5 * OIL * CHURNED**3 * s.swept, "dips": sizing.dips(s), "r": _reach(made, k)}
    return found | {"height": sizing.height_of_axes(made), "A_wet": sizing.compute_wetted_area(s)}


def _reach(made: Unit, k: int) -> str:
    """Radius of what moves the oil: that of the wheel, or how far planets reach."""
    s = made.stages[k]
    return f"{_mm(s.reach)} mm" if isinstance(s, PlanetaryStage) else f"stage_{made.numbers[k]}.r_2"


def _shaft(made: Unit, names: Sequence[str], k: int) -> dict[str, Any]:
    s = made.shafts[k]
    radii = [f"stage_{own}.r_2" for own in made.numbers[:k][-1:]] + [
        f"stage_{own}.r_1" for own in made.numbers[k : k + 1]
    ]
    places = [
        {
            "name": f"{names[k]}_bearing_{end}",
            "path": f"{names[k]}_path_{end}",
            "bearing": bearing,
            "life": f"of {_num(life)} h" if life < ENDLESS else f"above {ENDLESS:.0e} h".replace("+0", ""),
            "dips": sizing.stands_in_oil(made, k, bearing),
            "kind": kind,
        }
        for end, bearing, life, kind in zip("ab", s.bearings, s.lives, s.kinds, strict=True)
    ]
    gears = [{"x": x, "r": r} for x, r in zip(s.places, radii, strict=False)]
    support = ("", "ShaftSupport", "TwoGearSupport")[len(gears)]
    return {
        "name": names[k],
        "support": support,
        "gears": gears,
        "span": s.span,
        "bearings": places,
        "kinds": s.kinds,
        "preload": s.preload,
        "d": s.d,
        "d_torsion": s.d_torsion,
        "carried": s.bore / s.d_torsion if s.bore > s.d_torsion else None,
    }


def _fan(made: Unit) -> dict[str, float]:
    """A fan that a cowl on the end of the housing holds: air along the walls, and its torque."""
    D = SWEEP * math.sqrt(made.width * made.height)
    return {"D": D, "k_v": AIR * D / 2, "k": FAN * 1.2 * D**5 / (2 * math.pi) ** 3, "share": AIR}


def _bolted(made: Unit, A: float) -> tuple[float, str]:
    """Diameter of the bolts [m] that hold a face [m2], and how it follows."""
    d, most = BOLT * made.wall, math.sqrt(HELD * A / (BOLTS * PRESSED))
    words = f"{BOLT:g} times as thick as the walls" if d < most else f"that press {HELD:g} of the face"
    return min(d, most), f"{BOLTS} bolts {words}, 0.2 mm of air beside them"


def _foot(made: Unit, base: str) -> dict[str, Any] | None:
    """Foot of a unit, two strips along the housing, or its flange, and what they stand on."""
    if base == "free":
        return None
    outline, D, wide = made.length * made.width, min(made.length, made.height), 1 + 2 * BEYOND
    A, A_frame, beyond = STRIPS * outline, 2 * 2 * BEYOND * outline, BEYOND * made.length
    if base == FLANGED:
        A, beyond = math.pi / 4 * (1 - SPIGOT**2) * D**2, BEYOND * D
        A_frame = 2 * math.pi / 4 * (wide**2 - 1) * D**2
    d, bolts = _bolted(made, A)
    strips, thick = f"two strips of {STRIPS / 2:g} of the housing's width", f"{FRAME:g} times as thick as the walls"
    ring = f"a ring of {_mm(round(D, 3))} mm, the smaller side of the housing, {SPIGOT:g} of it inside"
    on = {
        "concrete": f"{strips}, {bolts}; heat spreads below its outline into a concrete floor",
        "steel": f"{strips}, {bolts}; a steel frame {thick}, {wide:g} times as long, in air",
        "flange": f"{ring}, {bolts}; a steel plate {thick}, {wide:g} times as wide, in air",
    }
    found: dict[str, Any] = {"base": base, "A": A, "count": BOLTS, "d": d, "outline": outline, "rule": on[base]}
    return found | {"A_frame": A_frame, "t_frame": FRAME * made.wall, "L_frame": beyond}


def compute_bodies(made: Unit) -> dict[str, Any]:
    """Capacities, conductances and the box."""
    slow = [math.prod(t.u for t in made.stages[:k]) for k in range(len(made.stages))]
    seats = [(made.shafts[k + 1].d, s.b) for k, s in enumerate(made.stages)]
    shafts = sum(STEEL * math.pi / 4 * (s.d**2 * s.span + ENDS * s.d_torsion**3) for s in made.shafts)
    kind = sizing.kind_of_box(made.stages)
    metal, share = RIBBED["small worm" if kind == "worm" and made.stages[0].a < SMALL else kind]
    density, c, k = CAST[metal]
    mass = (1 + share) * density * made.area * made.wall
    return {
        "metal": metal,
        "k": k,
        "c": c,
        "ribbed": f"{share:g} of the walls' metal",
        "inertia": sum(STEEL * s.inertia / i**2 for s, i in zip(made.stages, slow, strict=True)),
        "C_gears": 470 * STEEL * sum(s.volume for s in made.stages),
        "C_shafts": 470 * shafts,
        "mass": mass,
        "C_half": c * mass / 2,
        "wall": made.wall,
        "G_seats": 4000 * sum(math.pi * d * b for d, b in seats),
        "A_fins": 2 * share * made.area,
        "fin_height": RIBS * made.wall,
        "ribs": RIBS,
        "area": made.area,
        "length": made.length,
        "width_box": made.width,
        "height": made.height,
        "share": made.length * made.width / made.area,
    }
