"""A rig file from a name plate, that runs at once and says of every number how it came about."""

from __future__ import annotations

import re
import reprlib
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

from ...model.core.flat import FlatModel
from ...model.errors import GearheatError, Problems, ScenarioError, SolveError, suggestion
from ...model.run.result import Result
from ...model.run.steady import steady
from ...model.units import to_si
from ...scenarios.entries import catalogue
from ...scenarios.given import spell
from ...scenarios.load import load as read_rig
from ..describe.rig import Rig
from ..show.console import writable, write
from ..show.endings import fitting
from ..solve.settings import flat_of
from ..solve.steady import SteadyState, conditions, outside_of
from .allowed import IN_LINE, check
from .data_sheet import Wanted, mains, spell_all, thousands, wanted_of, watts_of
from .plausible import PLATE, WARM, no_load, notes, usual
from .rig_file import CONCRETE, FLANGED, Around, Losses, around_of, lost, text
from .sizing import Unit, unit

#: What the answer holds of a stage.
STAGE_KEYS = ("kind", "z_1", "z_2", "m_n", "beta", "b")
#: Times that a rig is solved, each for the cooler and the load of the losses before.
PASSES = 3
#: Least share of the loss of a part, of which it is told that its laws are outside their range [1].
MATTERS = 0.1
#: What name plates call an oil beside its class (DIN 51502, makers) -> its base, None for a word that tells none.
BASES = {"iso": None, "vg": None, "clp": None, "mineral": "mineral", "min": "mineral", "pao": "PAO", "hc": "PAO"}
BASES |= {"shc": "PAO", "pag": "PAG", "pg": "PAG", "ester": "ester", "e": "ester"}
#: Kind of stage -> the size by which one is known.
SIZES = {"spur": "a", "helical": "a", "bevel": "d_e2", "worm": "a", "planetary": "a"}


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
    power: Any,
    speed: Any,
    oil: str = "ISO VG 220 mineral",
    bearings: str = "auto",
    fan: bool = False,
    cooler: bool = False,
    base: str | None = None,
    motor_heat: Any = None,
    air_speed: Any = None,
    centre_distance: Any = None,
    housing: Any = None,
    oil_volume: Any = None,
    out: str | Path | None = None,
) -> NewRig:
    """A rig of your own from a name plate: it runs at once, and says the rule of every number.

    Args:
        name: of the rig
        stages: from the input, such as "helical,helical"; bevel first, worm last, planetary
            ones behind all others, the other way round where the ratio is below 1
        ratio: speed of the input over that of the output; below 1 the input is the slow shaft
        power: at the input, such as "7.5 kW"; like all that has a unit a text, a number in SI or a quantity of pint
        speed: of the input, such as "1450 rpm"
        oil: entry of the catalogue, or what a name plate has, such as "CLP PG 460"
        bearings: "ball", "roller" (tapered, face to face), or "auto": rollers on shafts where balls do not last
            or have no room
        fan: on the fast shaft
        cooler: of the oil, for the losses at the name plate
        base: what its foot stands on, "concrete" or a "steel" frame; "flange" on a steel plate; "free" on rubber, or
            where it hangs on its shaft; "concrete" if None, "flange" with planetary stages
        motor_heat: what comes by the flange of a motor that is bolted to it, such as "50 W"
        air_speed: along the housing, such as "1 m/s"; 0.3 m/s if None, beside a motor that is bolted to it 1.25 m/s
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
    sizes = {"--motor-heat": motor_heat, "--air-speed": air_speed, "--centre-distance": centre_distance}
    sizes |= {"--housing": housing, "--oil-volume": oil_volume, "--base": base}
    plate = {"name": name, "--power": power, "--speed": speed, "--oil": oil, "--bearings": bearings}
    texts = spell_all(plate | {option: size for option, size in sizes.items() if size is not None})
    power, speed, problems = texts["--power"], texts["--speed"], Problems()
    kinds, ratio = _kinds(stages), _number(ratio)
    watts = problems.of(lambda: watts_of(power))
    w = problems.of(lambda: to_si(speed, "rad/s", name="--speed"))
    drive = 1.0 if watts is None else watts, 100.0 if w is None else w  # what is wrong else is told, too
    wanted = problems.of(lambda: wanted_of(*map(texts.get, ("--centre-distance", "--housing", "--oil-volume"))))
    problems.of(lambda: check(kinds, ratio, *drive, bearings, wanted or Wanted()))
    entry = problems.of(lambda: _oil(oil))
    stands = FLANGED if IN_LINE in kinds else CONCRETE
    motor, air = map(texts.get, ("--motor-heat", "--air-speed"))
    around = problems.of(lambda: around_of(texts.get("--base", stands), fan, cooler, motor, air, housing is not None))
    if not re.fullmatch(r"[\w.-]+", name):
        problems.append(f'"{name}" is no name. Take letters, digits, _, - and dots.')
    made = None if problems else problems.of(partial(unit, kinds, ratio, *drive, bearings, wanted or Wanted()))
    doubts = *thousands(texts), *mains(speed)
    if made is None or entry is None or around is None:
        raise ScenarioError([*problems, *doubts])
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{name}.toml" if out is None else Path(out)
        fitting(path, "a rig file")
        writable(path)
        if path.exists():
            raise ScenarioError(f"{path}: is there already. Give another name, or take it away.")
        doc = f"{name}: {', '.join(kinds)}, i = {made.ratio:.4g}, {power} at {speed}, {entry}"
        try:
            rig = _solved(path, made, around, partial(text, made, doc, speed, entry, around))
            return replace(rig, notes=(*doubts, *rig.notes))
        except BaseException as error:
            path.unlink(missing_ok=True)
            if not isinstance(error, GearheatError):
                raise
            why = error.problems[0]
            ways = "Check --power and --speed"
            if isinstance(error, SolveError) and not cooler:
                ways += ", or give it --cooler"
            raise ScenarioError(f"{power} at {speed} gives no gearbox. {ways}. {why}") from None


def _kinds(stages: Any) -> list[str]:
    """Kinds of stages from a text, or from one of each stage."""
    words = stages.split(",") if isinstance(stages, str) else stages
    if not isinstance(words, Sequence) or not all(isinstance(word, str) for word in words):
        found = reprlib.repr(stages)
        raise ScenarioError(f'--stages = {found} is no text. Name them from the input on, such as "helical,helical".')
    return [word.strip().lower() for word in words if word.strip()]


def _number(ratio: Any) -> float:
    """A ratio that may be a text, or a quantity of pint."""
    return ratio if isinstance(ratio, int | float) else to_si(spell(ratio, name="--ratio"), "1", name="--ratio")


def _solved(path: Path, made: Unit, around: Around, drawn: Callable[[Losses], str]) -> NewRig:
    """The rig that is written to a file, and what it does at its name plate.

    Args:
        path: of the file
        made: the unit
        around: what stands around it
        drawn: gives the text of the file for what is lost at the name plate
    """
    losses = lost(made)
    for _ in range(PASSES):
        write(path, drawn(losses))
        scenario = read_rig(path)
        flat = flat_of(scenario)
        point = conditions(scenario, flat)
        rest = SteadyState(scenario, flat, result := steady(flat, point), backward=False)
        loss, off = rest["efficiency.P_loss"], abs(rest["input.P"] / made.power - 1)
        solved = losses.solved or off > PLATE
        if not (solved or around.cooler):
            break
        losses = Losses(rest["efficiency.eta"], loss, True) if solved else replace(losses, P=loss)
    idle = steady(flat, point | {"output.load": 0.0})["efficiency.P_loss"]
    kinds = [s.kind for s in made.stages]
    foot = rest["foot.Q_flow"] if around.base != "free" else 0.0
    sizes = {
        "schema": "gearheat.new/1",
        "file": str(path),
        "ratio": made.ratio,
        "stages": [
            {k: getattr(s, k) for k in (*STAGE_KEYS, SIZES[s.kind])}
            for s in made.stages[:: -1 if made.increases else 1]
        ],
        "bearings": [{"a": s.bearings[0], "b": s.bearings[1], "lives_h": s.lives} for s in made.shafts],
        "assumed": sum(source.startswith("assumed") for source in scenario.value_sources.values()),
        "oil_degC": rest["oil.T"] - 273.15,
        "power_W": rest["input.P"],
        "loss_W": loss,
        "no_load_W": float(idle[0]),
        "losses_W": rest.losses_by_kind(),
        "efficiency": rest["efficiency.eta"],
        "outside": list(dict.fromkeys(_outside(result))),
        "without_fan": _without_fan(flat, point) if around.fan else None,
        "usual": {
            "efficiency_pct": usual(kinds, kW := rest["input.P"] / 1000, made.asked),
            "oil_degC": WARM,
            "no_load_pct": no_load(kinds, kW),
        },
        "base": around.base,
        "foot_share": foot / (loss + (around.motor or 0.0)),
    }
    return NewRig(scenario, sizes, tuple(notes(made, sizes, rest["input.w"], around, rest.losses())))


def _outside(result: Result) -> Iterator[str]:
    """Laws far outside their range in parts that have no small share of the loss."""
    for law in outside_of(result):
        loss = f"{law['part']}.P_loss"
        if law["level"] == "warning" and loss in result and result[loss][0] > MATTERS * result["efficiency.P_loss"][0]:
            low, high = law["range"]
            yield f"{law['part']}: {law['law']}, {law['argument']} = {law['met'][1]:.4g} (valid {low:g} to {high:g})"


def _without_fan(flat: FlatModel, point: Mapping[str, float]) -> dict[str, float] | None:
    """Oil and efficiency at the name plate if the fan neither took power nor moved air, None where nothing holds it."""
    try:
        still = steady(flat, {**point, "fan.k": 0.0, "fan.k_v": 0.0})
    except SolveError:
        return None
    return {"oil_degC": float(still["oil.T"][0]) - 273.15, "efficiency": float(still["efficiency.eta"][0])}


def _oil(name: str) -> str:
    """The catalogue's name of an oil, by the words and the class of a name plate; one without a base is mineral."""
    words, known = re.findall(r"[^\W\d]+|\d+", name.lower()), name
    bases = {BASES[word] for word in words if word in BASES} - {None} or {"mineral"}
    classes = [word for word in words if word.isdigit()]
    if name not in catalogue("oil") and len(words) > 1 and len(classes) == len(bases) == 1:
        known = f"ISO VG {classes[0]} {bases.pop()}" if {*words} <= {*BASES, *classes} else name
    if known not in catalogue("oil"):
        raise ScenarioError(f'there is no oil "{name}".{suggestion(name, catalogue("oil"))} See `gearheat list`.')
    if "c_p" not in catalogue("oil")[known].values:
        raise ScenarioError(f'"{known}" is a grease. Name an oil. See `gearheat list`.')
    return known
