"""A rig as a rating method sees it: what its parts declare, and speeds and loads at its operating point."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from ...model.core.component import Component, Equation, equation
from ...model.core.declare import Output, Port, list_declared
from ...model.errors import Problems
from ...model.laws.oil import density, kinematic_viscosity
from ...model.machines.spec import PartSpec, Spec
from ...model.parts.equivalent import CylindricalPair, pair_of
from ...model.parts.ports import AirPort, BearingLoad, Flange, HeatPort
from ...model.parts.shaft import Efficiency
from ...model.parts.thermal import PrescribedTemperature, Room
from ...model.run.steady import steady
from ...scenarios.scenario import Scenario
from ..solve.settings import flat_of
from ..solve.steady import conditions

#: Role of a part -> kind of its loss.
KINDS = {"teeth": "mesh", "churning": "churning", "bearing": "bearings", "seal": "seals"}
#: Depth to which a wheel dips unless given, in normal modules: twice the height of a tooth.
DIP = 4.5
#: How far a pitch radius may differ, relative, and still be that of the same gear.
SAME = 0.02
#: Depth of a gear that runs clear of the oil, over its diameter.
DRY = 1e-3

Parts = Mapping[str, Component]
Values = Mapping[str, float]


@dataclass(frozen=True)
class Mesh:
    """A gear pair at work: tangential force [N], speeds of its shafts [rad/s], depths to which its gears dip [m]."""

    name: str
    pair: CylindricalPair
    F_t: float
    w: tuple[float, float]
    dips: tuple[float, float]

    @property
    def v(self) -> float:
        """Speed at the reference diameter, where the force acts [m/s]."""
        return abs(self.w[0]) * self.pair.diameters[0] / 2


@dataclass(frozen=True)
class Turning:
    """A bearing or a contact seal at work: the part, its speed [rad/s], loads of a bearing from the gears [N]."""

    part: Component
    w: float
    F_r: float = 0.0
    F_a: float = 0.0


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
        surfaces: outer ones in the air
        oil: values of the bath
        T_oil: temperature of the oil that the model reaches [K]
        T_room: temperature of the room [K]
        P_in: power into the rig [W]; None where none passes through it
        ours: kind of loss -> part -> loss of the model [W]
        untreated: parts that no method treats
    """

    meshes: tuple[Mesh, ...]
    bearings: tuple[Turning, ...]
    seals: tuple[Turning, ...]
    surfaces: tuple[Component, ...]
    oil: Mapping[str, float]
    T_oil: float
    T_room: float
    P_in: float | None
    ours: Mapping[str, Mapping[str, float]]
    untreated: tuple[Untreated, ...]

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
    parts = {part.name: part for part in scenario.spec.assembly().parts}
    pairs = {name: pair for name, part in parts.items() if (pair := pair_of(part)) is not None}
    baths = [name for name, part in parts.items() if part.role == "bath"]
    rooms = scenario.spec.of_type(Room.__name__)
    surfaces = tuple(part for part in parts.values() if _is_surface(part))
    _check(scenario, pairs, {"oil bath": baths, "room": rooms, "surface with area and emissivity": surfaces}, dips)
    read = [n for n, p in parts.items() if n in pairs or p.role in ("bearing", "seal")]
    probed = replace(scenario, spec=_with_readings(scenario.spec, read))
    flat = flat_of(probed)
    at = {path: float(column[0]) for path, column in steady(flat, conditions(probed, flat)).columns.items()}
    dips = {**_read_dips(scenario, parts, pairs, at), **dips}
    meshes = tuple(_mesh(name, pair, at, dips) for name, pair in pairs.items())
    bearings = tuple(_bearing(part, at) for part in parts.values() if type(part).__name__ in bearing_types)
    seals = tuple(
        Turning(part, at[f"{reading(name, 'shaft')}.w"])
        for name, part in parts.items()
        if part.role == "seal" and "d_sh" in part.values
    )
    ends = scenario.spec.of_type("ShaftEnd")
    treated = {*pairs, *(t.part.name for t in (*bearings, *seals)), *(s.name for s in surfaces)}
    passes = scenario.spec.of_type(Efficiency.__name__)
    return Machine(
        meshes,
        bearings,
        seals,
        surfaces,
        oil=parts[baths[0]].values,
        T_oil=at[f"{baths[0]}.T"],
        T_room=at[f"{rooms[0]}.T"],
        P_in=sum(max(0.0, at[f"{end}.P"]) for end in ends) if passes else None,
        ours=_group_losses(parts, at),
        untreated=tuple(_list_untreated(scenario, parts, treated, at)),
    )


def _check(
    scenario: Scenario,
    pairs: Mapping[str, CylindricalPair],
    needed: Mapping[str, Sequence[object]],
    dips: Mapping[str, float],
) -> None:
    problems = Problems()
    if not pairs:
        teeth = [f"{p.name} ({p.type})" for p in scenario.spec.parts if scenario.spec.types[p.type].role == "teeth"]
        problems.append(
            f"{scenario.name}: the method treats external gear pairs and there is none. "
            f"Found {', '.join(teeth) or 'no teeth'}. Leave out --method."
        )
    for what, found in needed.items():
        if not found or (what == "oil bath" and len(found) > 1):
            number = f"has {len(found)}" if found else "has none"
            problems.append(f"{scenario.name}: the method needs one {what}, and the rig {number}. Leave out --method.")
    gears = [f"{name}.{gear}" for name in pairs for gear in ("pinion", "wheel")]
    problems += [
        f'--dip: there is no gear "{name}". Gears: {", ".join(gears)}.' for name in dips if pairs and name not in gears
    ]
    for name, pair in pairs.items():
        for gear, d in zip(("pinion", "wheel"), pair.diameters, strict=True):
            if (depth := dips.get(f"{name}.{gear}", 0.0)) > (tip := d + 2 * pair.m_n):
                problems.append(f"--dip: {name}.{gear} of {1e3 * tip:.4g} mm cannot dip {1e3 * depth:.4g} mm.")
    problems.check()


def _mesh(name: str, pair: CylindricalPair, at: Values, dips: Mapping[str, float]) -> Mesh:
    pinion, wheel = (at[f"{reading(name, gear)}.w"] for gear in ("pinion", "wheel"))
    depths = dips.get(f"{name}.pinion", 0.0), dips.get(f"{name}.wheel", DIP * pair.m_n)
    return Mesh(name, pair, at[f"{name}.F_t"], (pinion, wheel), depths)


def _read_dips(scenario: Scenario, parts: Parts, pairs: Mapping[str, CylindricalPair], at: Values) -> dict[str, float]:
    """Depths of the gears for which a churning part on the same shaft, of the same pitch radius, knows its own [m].

    Such a part declares its pitch radius `r` and shows the depth `h` to which the pitch circle dips.
    """
    told = [p for n, p in parts.items() if p.role == "churning" and "r" in p.values and f"{n}.h" in at]
    found = {}
    for name, pair in pairs.items():
        for gear, d in zip(("pinion", "wheel"), pair.diameters, strict=True):
            shaft = {path for net in scenario.spec.connections if f"{name}.{gear}" in net for path in net}
            for part in told:
                if f"{part.name}.shaft" in shaft and abs(2 * part.values["r"] / d - 1) < SAME:
                    depth = at[f"{part.name}.h"]
                    found[f"{name}.{gear}"] = depth + pair.m_n if depth > DRY * d else 0.0
    return found


def _bearing(part: Component, at: Values) -> Turning:
    load = reading(part.name, "load")
    return Turning(part, at[f"{reading(part.name, 'shaft')}.w"], at[f"{load}.F_r"], at[f"{load}.F_a"])


def _is_surface(part: Component) -> bool:
    air = any(isinstance(port, AirPort) for port in list_declared(type(part), Port).values())
    return part.role == "surface" and air and {"A", "emissivity"} <= part.values.keys()


def _group_losses(parts: Parts, at: Values) -> dict[str, dict[str, float]]:
    found: dict[str, dict[str, float]] = {kind: {} for kind in (*KINDS.values(), "other")}
    for name, part in parts.items():
        if part.role and f"{name}.P_loss" in at:
            found[KINDS.get(part.role, "other")][name] = at[f"{name}.P_loss"]
    return found


def _list_untreated(scenario: Scenario, parts: Parts, treated: set[str], at: Values) -> Iterator[Untreated]:
    """Losses without a rule, and ways of heat that are no surface."""
    left = {name: p for name, p in parts.items() if name not in treated and p.role and p.role != "churning"}
    for name, part in left.items():
        kind = type(part).__name__
        if f"{name}.P_loss" in at:
            yield Untreated(name, kind, "its loss has no rule", at[f"{name}.P_loss"])
        elif f"{name}.Q_flow" in at and _leads_out(scenario, name, part):
            yield Untreated(name, kind, "its heat to the surroundings has no rule", at[f"{name}.Q_flow"])
        if outside := at.get(f"{name}.Q_flow_external", 0.0):
            yield Untreated(name, kind, "heat from outside has no rule", outside)


def _leads_out(scenario: Scenario, name: str, part: Component) -> bool:
    """Whether a heat port of a part meets a room, or another thing of given temperature, that it is not itself."""
    ends = scenario.spec.of_type(Room.__name__, PrescribedTemperature.__name__)
    heat = {f"{name}.{key}" for key, port in list_declared(type(part), Port).items() if isinstance(port, HeatPort)}
    met = {path.rpartition(".")[0] for net in scenario.spec.connections if heat & set(net) for path in net}
    return name not in ends and not met.isdisjoint(ends)


class FlangeReading(Component):
    """Speed of a shaft."""

    port = Flange()
    w = Output("rad/s", "angular velocity", nominal=10.0)

    def equations(self) -> Iterator[Equation]:
        """It takes no torque."""
        yield equation("speed read", self.w, self.port.w)
        yield equation("no torque", self.port.tau, 0.0)


class LoadReading(Component):
    """Load of a bearing."""

    port = BearingLoad()
    F_r = Output("N", "radial load", nominal=1000.0)
    F_a = Output("N", "axial load", nominal=1000.0)

    def equations(self) -> Iterator[Equation]:
        """Both loads."""
        yield equation("radial load read", self.F_r, self.port.F_r)
        yield equation("axial load read", self.F_a, self.port.F_a)


#: Port -> the part that reads it.
READINGS: Mapping[type[Port], type[Component]] = {
    Flange: FlangeReading,
    BearingLoad: LoadReading,
}


def _with_readings(spec: Spec, parts: Iterable[str]) -> Spec:
    """The spec with a reading at every shaft and load of some of its parts.

    The outputs of the readings are `reading(part, port)` and ".w", ".F_r" or ".F_a".
    """
    probes, nets = [], []
    for part in parts:
        for key, port in list_declared(spec.types[spec.part(part).type], Port).items():
            if (kind := READINGS.get(type(port))) is not None:
                probes.append(PartSpec(reading(part, key), kind.__name__))
                nets.append((f"{reading(part, key)}.port", f"{part}.{key}"))
    return spec.with_parts(probes, nets, {kind.__name__: kind for kind in READINGS.values()})


def reading(part: str, port: str) -> str:
    """Name of the reading at a port of a part."""
    return f"reading_{part}_{port}"
