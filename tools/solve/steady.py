"""Steady states: one operating point of a rig at rest with its surroundings."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...model.core.declare import Port, State, list_declared
from ...model.core.flat import FlatModel
from ...model.core.flatten import flatten
from ...model.machines.roles import takes_power
from ...model.run.result import Outside, Result
from ...model.run.steady import steady as solve
from ...model.units import from_si, show_unit, text
from ...scenarios.duty import other_torque
from ...scenarios.given import RigLike, Settings, scenario_of
from ...scenarios.scenario import Scenario
from ..show.console import note
from ..show.display import HEAD, Quantities
from ..show.heat_paths import heat_flows, heat_paths
from ..show.notes import PLURAL
from ..show.picture import Picture
from .settings import adjust, find_unchecked, flat_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Parts from which on the way to a steady state is told: some seconds.
LARGE = 500
#: Speed or torque over that of the rig file from which on it may be a slip [1].
FAR = 5.0
#: Share by which losses of the parts and between the shafts differ where both are told: that of a motor is inside.
APART = 0.01
#: Temperature of the oil up to which gear units are rated thermally [K].
RATED = 273.15 + 95.0
#: What it is.
END = "the 95 degC up to which ISO/TR 14179-1 rates gear units"


@dataclass(frozen=True, eq=False, repr=False)
class SteadyState(Quantities):
    """A rig at rest with its surroundings.

    Attributes:
        scenario: the rig as set
        flat: its model
        result: states, inputs and outputs in SI, with the power balance and the laws used
        backward: whether power leaves at the end that drives, or flows the other way than at the operating point where
            the rig file names no such end
        far: speeds and torques that are far above those of the rig file, in words
    """

    scenario: Scenario
    flat: FlatModel
    result: Result
    backward: bool
    far: tuple[str, ...] = ()

    def __getitem__(self, name: str) -> float:
        """Value of a state, input or output in SI. Raises ScenarioError with suggestions for an unknown name."""
        return float(self.result[name][0])

    def __iter__(self) -> Iterator[str]:
        """Paths of its values."""
        return iter(self.result)

    def losses(self) -> dict[str, float]:
        """Loss power of each part that has one [W]; of a part with several kinds their sum."""
        names = loss_names(self.scenario, self.result.columns)
        return {part: sum(self[name] for name in own) for part, own in names.items()}

    def power(self) -> dict[str, float]:
        """Power into the gearbox at each shaft end [W], below zero where it flows out; the largest first."""
        ends = [e for e in self.scenario.spec.of_type("ShaftEnd") if {f"{e}.w", f"{e}.tau"} <= set(self.result.columns)]
        each = {end: self[f"{end}.w"] * self[f"{end}.tau"] for end in ends}
        return dict(sorted(each.items(), key=lambda item: -item[1]))

    @property
    def flows(self) -> list[str]:
        """Which way power flows at each shaft end."""
        return [f"{kilowatts(P)} {'in' if P > 0 else 'out'} at {end}" for end, P in self.power().items()]

    @property
    def title(self) -> str:
        """The rig, what is shown of it, and which way power flows."""
        return ", ".join([f"{self.scenario.name}: steady state", *self.flows])

    def losses_by_kind(self) -> dict[str, float]:
        """Loss power by the role of the parts that have it [W], the largest first."""
        found = dict[str, float]()
        for part, loss in self.losses().items():
            kind = self.scenario.types[part].role or part
            found[kind] = found.get(kind, 0.0) + loss
        return dict(sorted(found.items(), key=lambda item: -item[1]))

    @property
    def headlines(self) -> list[str]:
        """Efficiency, losses by kind, the hottest body, and how far the oil is below the end of thermal ratings."""
        by_kind, meters = self.losses_by_kind(), self.scenario.spec.of_type("Efficiency")
        losses = ", ".join(f"{PLURAL.get(kind, kind)} {kilowatts(P)}" for kind, P in by_kind.items())
        whole, eta = sum(by_kind.values()), ""
        if meters and max(self.power().values(), default=0.0) > 0.0:  # at rest there is none
            between = self[f"{meters[0]}.P_loss"]
            apart = abs(between - whole) > APART * whole
            eta = f"efficiency {100 * self[f'{meters[0]}.eta']:.2f} %, "
            eta += f"{kilowatts(between)} between the shafts, in all " if apart else ""
        lines = [f"{eta}loss {kilowatts(whole)}: {losses}"] if by_kind else []
        warm = {name.removesuffix(".T"): self[name] for name in self.flat.bodies}
        if warm:
            hottest = max(warm, key=lambda body: warm[body])
            lines.append(f"hottest: {hottest} {text(warm[hottest], 'K', 3)}")
        for bath in (part for part in warm if self.scenario.types[part].role == "bath"):
            left = RATED - warm[bath]
            lines.append(
                f"{bath} {text(warm[bath], 'K', 3)}, {abs(left):.0f} K {'below' if left > 0 else 'above'} {END}"
            )
        return lines

    def called(self, part: str) -> str:
        """What a person calls a bearing or a seal, "bearing SKF 6310 at input"; "" where nothing names it."""
        role, spec = self.scenario.types[part].role, self.scenario.spec
        if role not in PLURAL:
            return ""
        nets = [net for net in spec.connections if f"{part}.shaft" in net]
        ends = [f"at {end}" for end in spec.of_type("ShaftEnd") if any(f"{end}.flange" in net for net in nets)]
        entry, values = self.scenario.entries.get(part, {}).get(role, ""), spec.part(part).values
        own = self.scenario.entry_values(part, entry) if entry else {}
        same = all(values.get(path.rpartition(".")[2]) == value for path, value in own.items())
        words = [entry] * bool(entry and same) + ends[:1]
        return " ".join([role, *words]) if words else ""

    def rows(self, names: Sequence[str]) -> list[tuple[str, float, str, str]]:
        """Rows of a table under `HEAD`; losses of bearings and seals by what a person calls these."""
        split = [(row, *row[0].rpartition(".")[::2]) for row in super().rows(names)]
        known = self.scenario.types
        return [
            (*row[:3], (key == "P_loss" and part in known and self.called(part)) or row[3]) for row, part, key in split
        ]

    @property
    def first(self) -> list[str]:
        """What a first answer holds."""
        return first_of(self.scenario, self.flat, self.result.columns)

    def table(self) -> tuple[Sequence[str], Sequence[Sequence[Any]]]:
        """The first answer."""
        return HEAD, self.rows(self.first)

    def as_dict(self) -> dict[str, Any]:
        """Values by path in the units shown to a person, and how far they can be trusted."""
        return {
            "schema": "gearheat.steady/1",
            "rig": self.scenario.name,
            "plot": None,
            "power_W": self.power(),
            "backward": self.backward,
            "far": list(self.far),
            "losses_W": self.losses_by_kind(),
            **point_of(self.flat, self.result),
            "unchecked": find_unchecked(self.scenario, self.flat),
        }

    def drawing(self) -> Picture:
        """Where the heat comes from and where it goes, as a Sankey diagram."""
        from ..show.sankey import heat_picture

        assembly = self.scenario.spec.assembly()
        with_flows = flatten(assembly, flows=heat_flows(assembly))
        guess = {q.name: self[q.name] for q in self.flat.states}
        there = solve(with_flows, conditions(self.scenario, with_flows), guess=guess)
        values = {name: float(column[0]) for name, column in there.columns.items()}
        kinds = {part.name: part.role for part in assembly.parts}
        return heat_picture(self.scenario.name, heat_paths(assembly, values), values, kinds)

    def plot(self, axes: Axes | None = None) -> Axes:
        """Draw the losses of the parts as bars.

        Args:
            axes: where to draw; new ones if None
        """
        from ..show.drawing import axes_or_new

        panel, losses = axes_or_new(axes), self.losses()
        panel.barh(list(losses), list(losses.values()))
        panel.invert_yaxis()
        panel.set(title=self.title, xlabel="loss [W]")
        return panel


def baths(scenario: Scenario) -> list[str]:
    """Parts that hold an oil with a temperature of its own."""
    return [name for name, kind in scenario.types.items() if kind.role == "bath" and "T" in list_declared(kind, State)]


def kilowatts(P: float) -> str:
    """The size of a power [W] in words."""
    return f"{abs(P) / 1000:.4g} kW" if abs(P) >= 1000 else f"{abs(P):.4g} W"


def steady(rig: RigLike, set: Settings = ()) -> SteadyState:
    """Temperatures and losses of a rig at rest with its surroundings.

    Args:
        rig: name, file or rig
        set: values by name: texts with units, quantities of pint, or numbers in SI

    Raises:
        ScenarioError: all that is wrong with the rig or with what is set
        SolveError: there is no steady state

    Example:
        >>> import gearheat as gh
        >>> hot = gh.steady("planetary", {"room.T": "35 degC"})
        >>> hot.to("oil.T", "degC") > 80
        True
    """
    usual = scenario_of(rig)
    scenario = adjust(usual, set)
    if large := len(scenario.spec.parts) > LARGE:
        note(f"{scenario.name}: equations of {len(scenario.spec.parts)} parts")
    flat = flat_of(scenario)
    if large:
        note(f"{scenario.name}: steady state of {len(flat.states)} states")
    found = solve(flat, conditions(scenario, flat))
    given = [f"{end}.{quantity}" for end, own in scenario.given.items() for quantity in own]
    before, now = ({path: at.operating_point.get(path, 0.0) for path in given} for at in (usual, scenario))
    if scenario.drives:
        backward = float(found[f"{scenario.drives}.P"][0]) < 0
    else:
        backward = len(given) == 2 and bool(np.prod(np.sign([*before.values(), *now.values()])) < 0)
    units = {path: flat.quantity(path).unit for path in given}
    far = far_from(usual.operating_point, now, units)
    return SteadyState(scenario, flat, found, backward, tuple(far.values()))


def far_from(
    usual: Mapping[str, float], now: Mapping[str, float], units: Mapping[str, str], where: str = "the rig file"
) -> dict[str, str]:
    """Path -> in words, of speeds, torques and loads that are far above the usual ones.

    Args:
        usual: what they are compared with (SI); a load with the torque of its end, a torque with the load
        now: what they are (SI)
        units: of them
        where: the usual ones are from
    """
    found = {}
    for path, value in now.items():
        base = usual.get(path) or usual.get(other_torque(path), 0.0)
        if base and units[path] in ("rad/s", "N.m") and (times := abs(value / base)) > FAR:
            shown = text(value, units[path]), text(base, units[path])
            found[path] = f"{path} = {shown[0]} is {times:.3g} times that of {where}, {shown[1]}"
    return found


def first_of(scenario: Scenario, flat: FlatModel, values: Iterable[str]) -> list[str]:
    """What a first answer holds of a point: states, what is given, shafts, losses, heat to rooms, efficiencies.

    Args:
        scenario: the rig as set
        flat: its model
        values: all names, in their order
    """
    names = {q.name for q in flat.states} | {*scenario.operating_point} | scenario.shaft_paths()
    names |= {f"{room}.Q_flow" for room in scenario.spec.of_type("Room")}
    names |= {q.name for q in flat.outputs if q.name.rpartition(".")[2].startswith(("P_loss", "eta"))}
    return [name for name in values if name in names]


def loss_names(scenario: Scenario, names: Iterable[str]) -> dict[str, list[str]]:
    """Part -> the names whose sum is its loss power: its whole loss, or its kinds where there is no whole.

    Args:
        scenario: the rig
        names: of all outputs
    """
    every, meters = dict.fromkeys(names), scenario.spec.of_type("Efficiency")
    found: dict[str, list[str]] = {}
    for name in every:
        part, _, key = name.rpartition(".")
        whole = f"{part}.P_loss" in every
        taken = key == "P" and takes_power(scenario.types[part])
        if part not in meters and (taken or key == "P_loss" or (key.startswith("P_loss_") and not whole)):
            found.setdefault(part, []).append(name)
    return found


def leading_outputs(scenario: Scenario) -> list[str]:
    """What a picture shows of a rig: the temperature of its oil, or of its first body; losses and efficiencies."""
    warm = [p for p in scenario.spec.parts if "T" in list_declared(scenario.spec.types[p.type], State)]
    warm.sort(key=lambda p: "lubricant" not in list_declared(scenario.spec.types[p.type], Port))
    meters = scenario.spec.of_type("Efficiency")
    return [*(f"{p.name}.T" for p in warm[:1]), *(f"{name}.{key}" for name in meters for key in ("P_loss", "eta"))]


def conditions(scenario: Scenario, flat: FlatModel) -> dict[str, float]:
    """The inputs that the scenario gives, as the model has them, to be named in messages."""
    return {q.name: q.start for q in flat.inputs if q.name in scenario.operating_point}


def point_of(flat: FlatModel, result: Result) -> dict[str, Any]:
    """A steady result as an object: values by path in the units shown to a person, and how far it can be trusted."""
    return {
        "values": {name: from_si(float(column[0]), result.units[name]) for name, column in result.columns.items()},
        "units": {name: show_unit(unit) for name, unit in result.units.items()},
        "inputs": [q.name for q in flat.inputs],
        "states": [q.name for q in flat.states],
        "energy_residual": result.audit.residual,
        "outside": outside_of(result),
        "laws": list(result.laws),
    }


def outside_of(result: Result) -> list[dict[str, Any]]:
    """The laws a result used outside their range."""
    return list_outside(result.outside, result.index)


def list_outside(found: Iterable[Outside], times: Sequence[float] | np.ndarray = (0.0,)) -> list[dict[str, Any]]:
    """Laws outside their range as results list them: a "warning" far from it, a "note" near it or at first only.

    Args:
        found: the laws
        times: of the rows [s]; what is outside in their first half only is so at first
    """
    half = len(times) // 2
    return [
        {
            "part": o.component,
            "law": o.law,
            "argument": o.argument,
            "range": [o.low, o.high],
            "met": [o.lowest, o.highest],
            "regime": o.regime,
            "level": "warning" if o.far and o.last >= half else "note",
            "until_s": float(times[o.last]) if o.last < half else None,
        }
        for o in found
    ]
