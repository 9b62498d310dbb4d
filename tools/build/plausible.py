"""What is plausible of a gear unit at its name plate, and what helps where it is not."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from ...model.files import tables
from . import sizing
from .allowed import LAST, last_ratio
from .bearings import BALLS, LIFE
from .rig_file import Around
from .shafts import gaps
from .sizing import Unit
from .teeth import MAKE

#: Name plates, the efficiencies that units of their kinds have, and what lowers a loss.
MACHINES: dict[str, Any] = tables("tools.build", "machines.toml")
#: Oil that seals and oil stand for long [degC].
WARM = (20.0, 100.0)
#: How much warmer than at the name plate a hall is for which makers rate units [K].
HALL = 20.0
#: Fastest motors of industrial units, and of electric axles [rpm].
FAST = 6000
AXLES = 20000
#: Fastest pitch line of gears that dip [m/s], mean diameter times speed of bearings in a bath [mm/min], and lips of NBR
#: and FKM [m/s]: usual limits.
DIPPING = 20.0
N_D = 1e6
LIPS = (15.0, 35.0)
#: How far the ratio may be from that of the name plate untold [1].
OFF = 0.003
#: How far the power that a unit takes may be from that of its name plate [1].
PLATE = 0.02
#: Power from which on worms are large ones, of centre distances about 200 mm [kW].
LARGE = 10.0
#: What the best of these lose, 9 % at i = 20 and 20 % at i = 60 in makers' lists, over the best of all others [1].
LESS = 0.62
#: Usual loads of a stage [Pa].
LOADED = {"worm": ("the wheel's torque over a3", 0.2e6, 1.3e6), "gears": ("K*", 1.0e6, 6.0e6)}
#: Area of a housing over that of the box around the gears, above which its unit may be wrong [1].
WIDE = 4.0
#: Efficiency below which standard sizes do not fit the power.
POOR = 0.4


def usual(stages: str | Sequence[str], kW: float, ratio: float) -> tuple[float, float]:
    """Efficiencies [%] of units of such stages, power and ratio."""
    kinds, known = stages.split(",") if isinstance(stages, str) else list(stages), MACHINES["efficiency"]
    if kinds[-1] == "worm":
        slow = last_ratio(kinds, ratio)
        ends = [float(most) for most in MACHINES["worm"]]
        low, high = (float(np.interp(slow, ends, side)) for side in zip(*MACHINES["worm"].values(), strict=True))
        high = high if kW < LARGE else 100 - LESS * (100 - high)
        if len(kinds) > 1:
            low, high = (end * fast / 100 for end, fast in zip((low, high), _of(known, len(kinds) - 1), strict=True))
    else:
        low, high = _of(known.get(kinds[0], known), len(kinds))
    return round(low if kW >= 1 else low - known["small"], 1), round(high, 1)


def _of(known: Mapping[str, Any], count: int) -> tuple[float, float]:
    """Efficiencies [%] of units of a number of stages; of more than any known one, those of its stages go on."""
    most = min(count, max(int(key) for key in known if key.isdigit()))
    low, high = (100 * (end / 100) ** (count / most) for end in known[str(most)])
    return low, high


def no_load(stages: str | Sequence[str], kW: float) -> tuple[float, float]:
    """Shares of the loss [%] that the page's units of such stages and power have without load."""
    last, known = (stages.split(",") if isinstance(stages, str) else stages)[-1], MACHINES["no_load"]
    low, high = known.get(last, known["gears"])
    return low, high if kW >= 1 else min(high + known["small"], 100)


def notes(
    made: Unit, sizes: Mapping[str, Any], speed: float, around: Around, losses: Mapping[str, float]
) -> Iterator[str]:
    """What a user should know about a unit, and what its largest loss asks for where it is hot or lossy.

    Args:
        made: the unit
        sizes: the JSON object of `gearheat new`
        speed: of the input [rad/s]
        around: what stands around it and cools it
        losses: of its parts [W]
    """
    if (rpm := round(30 / math.pi * speed)) > FAST:
        usual = f"motors of industrial units at most at {FAST:,} rpm, those of electric axles at {AXLES:,} rpm"
        yield f"the input turns at {rpm:,} rpm, and {usual}. Check --speed."
    if abs(off := made.ratio / made.asked - 1) > OFF:
        yield f"the ratio is {made.ratio:.4g}, {100 * off:+.1f} % from {made.asked:g}, as teeth are whole."
    yield from _too_fast(made, around)
    if made.centre:
        yield from _loaded(made)
    if made.area > WIDE * made.drawn:
        times = f"{made.area / made.drawn:.0f} times the {made.drawn:.3g} m2 of a box around the gears"
        yield f"--housing has {made.area:.3g} m2, {times}. Check its unit."
    height = sizing.height_of_axes(made)
    deepest = height - max(map(sizing.lowest, made.stages))
    if made.volume and (level := sizing.bath(made)["level"]) is not None and not deepest < level < height:
        yield (
            f"the oil stands at {1000 * level:.0f} mm, expected {1000 * deepest:.0f} mm, where the largest wheel dips,"
            f" to {1000 * height:.0f} mm, where the axes are. Change --oil-volume."
        )
    if (bare := sizes["without_fan"]) and bare["oil_degC"] + HALL < WARM[1]:
        housing = "" if around.boxed else ", or give the housing that has one by --housing"
        yield (
            f"it needs no fan: without one the oil is at {bare['oil_degC']:.1f} degC, the efficiency"
            f" {100 * bare['efficiency']:.2f} %. Leave out --fan, unless the unit has one{housing}."
        )
    yield from _lossy(made, sizes, around, losses)
    if sizes["outside"]:
        yield f"laws far outside their range have a tenth of the loss or more: {'; '.join(sizes['outside'])}."
    yield from _bearings(made)


def _lossy(made: Unit, sizes: Mapping[str, Any], around: Around, losses: Mapping[str, float]) -> Iterator[str]:
    """A unit that is hot, or loses other than usual, and what its largest loss asks for."""
    if hot := sizes["oil_degC"] > WARM[1]:
        cooler = "" if around.cooler else f"--cooler (for {sizes['loss_W'] / 1000:.2g} kW), "
        ways = cooler if around.fan or around.cooler else f"--fan or {cooler}"
        yield f"the oil is above {WARM[1]:g} degC: such a unit needs {ways}fins, or a larger housing."
    eta, idle = 100 * sizes["efficiency"], 100 * sizes["no_load_W"] / sizes["loss_W"]
    (low, high), (least, most) = (sizes["usual"][key] for key in ("efficiency_pct", "no_load_pct"))
    if eta < 100 * POOR:
        yield "most of the power is lost: standard modules and bearings are too large for it."
    if abs(sizes["power_W"] / made.power - 1) > PLATE:
        yield (
            f"it takes {sizes['power_W']:.3g} W, not the {made.power:.3g} W of the name plate: without load it loses"
            f" {sizes['no_load_W']:.3g} W."
        )
    if not low <= eta <= high:
        yield f"the efficiency of {eta:.2f} % is {'below' if eta < low else 'above'} the usual {low:g} to {high:g} %."
    if round(idle) > most:
        yield f"without load it has {idle:.0f} % of the loss, above the usual {least:g} to {most:g} %."
    if hot or eta < low:
        kind, loss = next(iter(sizes["losses_W"].items()))
        share = loss / sum(sizes["losses_W"].values())
        yield f"the largest loss is that of {kind}, {100 * share:.0f} %: {_advise(made, kind, loss, losses)}."


def _advise(made: Unit, kind: str, loss: float, losses: Mapping[str, float]) -> str:
    """What lowers the loss of parts of a kind; of bearings no option that leaves them as they are, or rubs more."""
    if kind == "bearing":
        needles = sum(P for part, P in losses.items() if part.startswith("planet_bearing"))
        rollers = any(shaft.kinds != BALLS for shaft in made.shafts)
        kind = "needles" if needles > loss / 2 else "rollers" if rollers else kind
    elif kind == "teeth" and made.stages[-1].kind == LAST:
        kind = LAST
    return str(MACHINES["advice"][kind])


def _too_fast(made: Unit, around: Around) -> Iterator[str]:
    """What turns faster than a bath of oil, rolling bearings or lip seals can do."""
    if (v := max(stage.speed for stage in made.stages)) > DIPPING:
        yield (
            f"what dips into the oil moves at {v:.0f} m/s, and gears dip up to about {DIPPING:g} m/s: faster ones run"
            f" above the oil, which {'is' if around.cooler else '--cooler has'} sprayed on them. In the file a lower"
            " oil.level, with less oil.V, takes them out of it, and GearWindage is the drag of air with a mist of oil."
        )
    n_d = max(60e3 * s.n * (s.d + max(s.outer)) / 2 for s in made.shafts)
    if n_d > N_D:
        yield (
            f"rolling bearings turn at n d_m = {n_d:.2g} mm/min, and those in a bath of oil up to about {N_D:.0e}:"
            " faster shafts have plain bearings, or oil sprayed into rolling ones."
        )
    v = max(math.pi * s.n * s.d_seal for s in (made.shafts[0], made.shafts[-1]))
    if v > LIPS[0]:
        other = "" if v <= LIPS[1] else ", and no lip beyond: faster shafts have labyrinths"
        yield f"a lip seal rubs at {v:.0f} m/s: NBR stands about {LIPS[0]:g} m/s, FKM {LIPS[1]:g} m/s{other}."


def _loaded(made: Unit) -> Iterator[str]:
    """A last stage whose load does not suit the centre distance that is given."""
    s = made.stages[-1]
    named, low, high = LOADED.get(s.kind, LOADED["gears"])
    if not low < s.intensity < high:
        own = MAKE[s.kind](s.kind, s.u, s.T, s.n, None).a
        yield (
            f"--centre-distance: {named} is {s.intensity / 1e6:.3g} N/mm2, usual {low / 1e6:.2g} to {high / 1e6:.2g}:"
            f" the load asks for {1000 * own:.0f} mm."
        )


def _bearings(made: Unit) -> Iterator[str]:
    """Bearings that do not last or have no room."""
    for shaft in made.shafts:
        for bearing, life in zip(shaft.bearings, shaft.lives, strict=True):
            if life < LIFE:
                yield f"{bearing}: a life of {life:.0f} h only; the catalogue has no stronger one."
        if shaft.excess:
            larger = f"{1000 * shaft.excess:.0f} mm more than the pinion on their shaft is below its teeth"
            yield f"{' and '.join(dict.fromkeys(shaft.bearings))}: a bore of {1000 * shaft.d:.0f} mm, {larger}."
    if (gap := min(gaps(made.stages, made.shafts), default=0.0)) < 0:
        yield f"bearings beside each other overlap by {-1000 * gap:.0f} mm: they ask for a larger centre distance."
