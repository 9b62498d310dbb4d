"""What a rating method needs of a rig at its operating point: gear pairs, bearings, seals, housing, oil."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from ...model.core.component import Component
from ...model.core.declare import Port, declared
from ...model.core.flat import FlatModel
from ...model.errors import ScenarioError
from ...model.laws.oil import density, kinematic_viscosity
from ...model.machines.spec import assemble
from ...model.parts.equivalent import CylindricalPair, pair_of
from ...model.parts.ports import AirPort, HeatPort
from ...model.run.result import Result
from ...model.run.steady import steady
from ...scenarios.scenario import Scenario
from ..points import conditions
from ..settings import flat_of
from .readings import reading, with_readings

#: Role of a part -> kind of its loss.
KINDS = {"teeth": "mesh", "churning": "churning", "bearing": "bearings", "seal": "seals"}
#: Depth to which a wheel dips unless given, in normal modules: twice the height of a tooth.
DIP = 4.5


@dataclass(frozen=True)
class Mesh:
    """A gear pair at work: tangential force [N], speeds of its shafts [rad/s], depths to which its gears dip [m]."""

    name: str
    pair: CylindricalPair
    F_t: float
    w: tuple[float, float]
    dips: tuple[float, float]

    @property
    def r_1(self) -> float:
        """Radius of the pinion at which the tangential force acts [m]."""
        return self.pair.pitches[0] / 2 if self.pair.r_1 is None else self.pair.r_1

    @property
    def v(self) -> float:
        """Speed of the pitch line [m/s]."""
        return abs(self.w[0]) * self.r_1

    @property
    def tips(self) -> tuple[float, float]:
        """Tip diameters of what dips [m]."""
        return self.pair.tips or self.pair.outsides


@dataclass(frozen=True)
class Bearing:
    """A bearing at work: part type and values, speed [rad/s], loads from the gears [N]."""

    name: str
    type: str
    values: Mapping[str, float]
    w: float
    F_r: float
    F_a: float


@dataclass(frozen=True)
class Seal:
    """A contact seal at work: number, shaft diameter [m], speed [rad/s]."""

    name: str
    count: float
    d_sh: float
    w: float


@dataclass(frozen=True)
class Surface:
    """An outer surface in the air: values of its part."""

    name: str
    values: Mapping[str, float]

    @property
    def height(self) -> float:
        """Height of the housing [m]."""
        return self.values.get("height", self.values.get("D", 0.0))


@dataclass(frozen=True)
class Untreated:
    """A part for which a method has no rule, and what it does in the model [W]."""

    part: str
    type: str
    why: str
    power: float


@dataclass(frozen=True)
class Machine:
    """A rig at its operating point.

    Args:
        oil: values of the bath
        T_oil: temperature of the oil that the model reaches [K]
        T_room: temperature of the room [K]
        air_speed: speed of the air along the housing [m/s]
        P_in: power into the rig [W]
        ours: kind of loss -> part -> loss of the model [W]
        untreated: parts that no method treats
    """

    meshes: tuple[Mesh, ...]
    bearings: tuple[Bearing, ...]
    seals: tuple[Seal, ...]
    surfaces: tuple[Surface, ...]
    oil: Mapping[str, float]
    T_oil: float
    T_room: float
    air_speed: float
    P_in: float
    ours: Mapping[str, Mapping[str, float]]
    untreated: tuple[Untreated, ...] = field(default=())

    def nu(self, T: float) -> float:
        """Kinematic viscosity of the oil [m2/s] at a temperature [K]."""
        return float(kinematic_viscosity(T, self.oil["nu_40"], self.oil["nu_100"]))

    def eta(self, T: float) -> float:
        """Dynamic viscosity of the oil [Pa.s] at a temperature [K]."""
        return self.nu(T) * float(density(T, self.oil["rho_15"], self.oil["alpha_T"]))

    def loaded(self, share: float) -> Machine:
        """The machine under a multiple of its load, its speeds the same."""
        return replace(
            self,
            P_in=share * self.P_in,
            meshes=tuple(replace(m, F_t=share * m.F_t) for m in self.meshes),
            bearings=tuple(replace(b, F_r=share * b.F_r, F_a=share * b.F_a) for b in self.bearings),
        )


def machine_of(scenario: Scenario, bearing_types: Sequence[str], dips: Mapping[str, float]) -> Machine:
    """The machine of a rig at its operating point.

    Args:
        scenario: the rig, with its values
        bearing_types: types of the bearings that the methods treat
        dips: depth to which gears dip by "part.pinion" or "part.wheel" [m]

    Raises:
        ScenarioError: the rig has no cylindrical gear pair, not one oil bath, or not the gears that `dips` names
    """
    parts = {part.name: part for part in assemble(scenario.spec).parts}
    pairs = {name: pair for name, part in parts.items() if (pair := pair_of(part)) is not None}
    baths = [part for part in parts.values() if part.role == "bath"]
    _check(scenario, pairs, baths, dips)
    busy = [name for name, part in parts.items() if name in pairs or part.role in ("bearing", "seal")]
    probed = replace(scenario, spec=with_readings(scenario.spec, busy))
    flat = flat_of(probed)
    result = steady(flat, conditions(probed, flat))

    def read(part: str, port: str, key: str) -> float:
        return float(result[f"{reading(part, port)}.{key}"][0])

    meshes = tuple(
        Mesh(
            name,
            pair,
            read(name, "force", "F_t"),
            (read(name, "pinion", "w"), read(name, "wheel", "w")),
            (dips.get(f"{name}.pinion", 0.0), dips.get(f"{name}.wheel", DIP * pair.m_n)),
        )
        for name, pair in pairs.items()
    )
    bearings = tuple(
        Bearing(
            p.name,
            type(p).__name__,
            p.values,
            read(p.name, "shaft", "w"),
            read(p.name, "load", "F_r"),
            read(p.name, "load", "F_a"),
        )
        for p in parts.values()
        if type(p).__name__ in bearing_types
    )
    seals = tuple(
        Seal(p.name, p.values["count"], p.values["d_sh"], read(p.name, "shaft", "w"))
        for p in parts.values()
        if p.role == "seal" and "d_sh" in p.values
    )
    surfaces = tuple(Surface(p.name, p.values) for p in parts.values() if _is_surface(p))
    treated = {part.name for part in (*meshes, *bearings, *seals, *surfaces)}
    room = scenario.spec.of_type("Room")[0]
    return Machine(
        meshes,
        bearings,
        seals,
        surfaces,
        baths[0].values,
        float(result[f"{baths[0].name}.T"][0]),
        *(flat.quantity(f"{room}.{key}").start for key in ("T", "air_speed")),
        P_in=_power(scenario, result),
        ours=_ours(parts, result),
        untreated=tuple(_untreated(scenario, parts, treated, flat, result)),
    )


def _check(
    scenario: Scenario, pairs: Mapping[str, CylindricalPair], baths: Sequence[Component], dips: Mapping[str, float]
) -> None:
    problems = []
    if not pairs:
        teeth = [f"{p.name} ({p.type})" for p in scenario.spec.parts if scenario.spec.types[p.type].role == "teeth"]
        problems.append(
            f"{scenario.name}: the method treats external gear pairs and there is none. "
            f"Found {', '.join(teeth) or 'no teeth'}. Leave out --method."
        )
    if len(baths) != 1:
        names = ", ".join(bath.name for bath in baths) or "none"
        problems.append(f"{scenario.name}: the method needs one oil bath. Found: {names}. Leave out --method.")
    if not scenario.spec.of_type("Room"):
        problems.append(f"{scenario.name}: the method needs a room and there is none. Leave out --method.")
    gears = [f"{name}.{gear}" for name in pairs for gear in ("pinion", "wheel")]
    problems += [
        f'--dip: there is no gear "{name}". Gears: {", ".join(gears)}.' for name in dips if pairs and name not in gears
    ]
    if problems:
        raise ScenarioError(problems)


def _is_surface(part: Component) -> bool:
    air = any(isinstance(port, AirPort) for port in declared(type(part), Port).values())
    return part.role == "surface" and air and {"A", "emissivity"} <= part.values.keys()


def _power(scenario: Scenario, result: Result) -> float:
    """Power that enters at the shaft ends [W]."""
    return sum(max(0.0, float(result[f"{end}.P"][0])) for end in scenario.spec.of_type("ShaftEnd"))


def _ours(parts: Mapping[str, Component], result: Result) -> dict[str, dict[str, float]]:
    found: dict[str, dict[str, float]] = {kind: {} for kind in (*KINDS.values(), "other")}
    for name, part in parts.items():
        if part.role and f"{name}.P_loss" in result.columns:
            found[KINDS.get(part.role, "other")][name] = float(result[f"{name}.P_loss"][0])
    return found


def _untreated(
    scenario: Scenario, parts: Mapping[str, Component], treated: set[str], flat: FlatModel, result: Result
) -> list[Untreated]:
    """Losses without a rule, and ways of heat to the room that are no surface."""
    found = []
    for name, part in parts.items():
        if name in treated or not part.role or part.role == "churning":
            continue
        if f"{name}.P_loss" in result.columns:
            power = float(result[f"{name}.P_loss"][0])
            found.append(Untreated(name, type(part).__name__, "its loss has no rule", power))
        elif _meets_room(scenario, name, part) and part.role != "room":
            power = float(result[f"{name}.Q_flow"][0]) if f"{name}.Q_flow" in result.columns else float("nan")
            found.append(Untreated(name, type(part).__name__, "its heat to the room has no rule", power))
        external = f"{name}.Q_flow_external"
        if external in (q.name for q in flat.inputs) and flat.quantity(external).start:
            power = -flat.quantity(external).start
            found.append(Untreated(name, type(part).__name__, "heat from outside has no rule", power))
    return found


def _meets_room(scenario: Scenario, name: str, part: Component) -> bool:
    """Whether a heat port of a part meets the room or another thing of given temperature."""
    ends = [*scenario.spec.of_type("Room"), *scenario.spec.of_type("PrescribedTemperature")]
    heat = {f"{name}.{key}" for key, port in declared(type(part), Port).items() if isinstance(port, HeatPort)}
    return any(
        heat & set(net) and any(path.rpartition(".")[0] in ends for path in net) for net in scenario.spec.connections
    )
