"""The one table of an FMU's variables: it drives modelDescription.xml, the tables of the C code, and playing.

Choices are enumerations, each item of which gives parameters other values: what an importer chooses by name.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import casadi as ca
import numpy as np

from ..model.core.flat import FlatModel, Quantity
from ..model.errors import FmuError, suggestion
from ..model.run.point import follows

#: Name of the choice how a run begins.
START = "start"
#: Its item: at the start values of the states.
GIVEN = "given"
#: Its item: all temperatures as the room's.
ROOM = "room"
#: Its item: at the steady state of the initial inputs.
STEADY = "steady"
#: Audit state: integral of the power across the boundary [J].
SUPPLIED = "energy.supplied"
#: Audit state: integral of the sizes of these powers [J].
THROUGHPUT = "energy.throughput"
#: Audit output: energy of the states [J].
STORED = "energy.stored"
#: Audit output: violation of the balance of energy by the equations [W].
RESIDUAL = "energy.residual"
#: Audit output: number of law arguments outside the range of their source.
VALIDITY = "validity.count"
#: Audit output: what the implicit equations leave, in units of their typical size.
IMPLICIT = "implicit.residual"

#: Smallest number an end at zero leaves open: far below all sizes, and far from the denormal numbers that std::stod and
#: other readers of the description refuse.
LEAST = 1e-300

#: Kinds of variables in the order of their value references.
KINDS = ("state", "input", "output", "parameter", "derivative", "choice", "deviation")
_CALCULATED = ("output", "derivative", "deviation")
Group = tuple[Quantity, ...]


@dataclass(frozen=True)
class Item:
    """One item of a choice.

    Attributes:
        values: parameter -> its value (SI) with this item
    """

    name: str
    doc: str
    values: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Choice:
    """An enumeration. Its first item leaves all as exported.

    Attributes:
        fixed: whether it counts at the start alone
        room: of a choice how a run begins, the input or parameter with the temperature of the room; "" where none is
    """

    name: str
    doc: str
    items: tuple[Item, ...]
    fixed: bool = False
    room: str = ""

    @property
    def parameters(self) -> frozenset[str]:
        """The parameters that its items give values to."""
        return frozenset(name for item in self.items for name in item.values)


def start_choice(room: str | None = None) -> Choice:
    """How a run begins; `room` is the input or parameter with the temperature of the room, None where there is none."""
    given = Item(GIVEN, "the start values of the states")
    at_room = Item(ROOM, f"all temperatures as {room}, their start values do not count")
    steady = Item(STEADY, "the steady state at the initial inputs, looked for from the given states")
    doc = "how the run begins; it takes effect when initialization ends"
    return Choice(START, doc, (given, *([at_room] if room else []), steady), fixed=True, room=room or "")


def drop_idle(choices: Iterable[Choice], flat: FlatModel) -> Iterator[Choice]:
    """The choices without values of parameters that a model does not have; those of parameters left without any go.

    Args:
        choices: of the FMU
        flat: the model
    """
    known = {q.name for q in flat.parameters}
    for choice in choices:
        items = (
            Item(i.name, i.doc, {name: value for name, value in i.values.items() if name in known})
            for i in choice.items
        )
        kept = replace(choice, items=tuple(items))
        if kept.parameters or not choice.parameters:
            yield kept


@dataclass(frozen=True)
class Variable:
    """One scalar variable of an FMU; `reference` is its value reference and its position in the description.

    Attributes:
        kind: "state", "input", "output", "parameter", "derivative", "choice" or "deviation"
        state: value reference of the state a derivative belongs to
        choice: what an enumeration offers
        of: value reference of the state or output a standard deviation belongs to
    """

    reference: int
    kind: str
    quantity: Quantity
    state: int | None = None
    choice: Choice | None = None
    of: int | None = None

    @property
    def name(self) -> str:
        """Path of the variable, der(path) for a derivative."""
        return self.quantity.name

    @property
    def type(self) -> str:
        """Type in the sense of FMI 2.0: "Real", "Integer" or "Enumeration"."""
        if self.choice:
            return "Enumeration"
        return "Integer" if self.kind == "parameter" and self.quantity.whole else "Real"

    @property
    def causality(self) -> str:
        """Causality in the sense of FMI."""
        own = {"state": "output", "derivative": "local", "choice": "parameter", "deviation": "output"}
        return own.get(self.kind, self.kind)

    @property
    def variability(self) -> str:
        """Variability in the sense of FMI."""
        if self.causality != "parameter":
            return "continuous"
        fixed = self.choice.fixed if self.choice else self.quantity.whole
        return "fixed" if fixed else "tunable"

    @property
    def initial(self) -> str | None:
        """How the initial value is found; None for an input, where FMI forbids to say."""
        return "calculated" if self.kind in _CALCULATED else None if self.kind == "input" else "exact"

    @property
    def start(self) -> float | None:
        """Start value, None where the FMU calculates it."""
        return None if self.kind in _CALCULATED else self.quantity.start

    @property
    def bounds(self) -> tuple[float, float]:
        """Lowest and highest value allowed; an open end is the next number inside."""
        q = self.quantity
        low = _inside(q.low, 1.0) if q.low_open else q.low
        high = _inside(q.high, -1.0) if q.high_open else q.high
        return float(low), float(high)

    @property
    def range_text(self) -> str:
        """The values allowed, in words."""
        q, ends = self.quantity, []
        if math.isfinite(q.low):
            ends.append(f"{'above' if q.low_open else 'at least'} {q.low:g}")
        if math.isfinite(q.high):
            ends.append(f"{'below' if q.high_open else 'at most'} {q.high:g}")
        return " and ".join(ends) or "finite"


@dataclass(frozen=True)
class Table:
    """All variables of an FMU in the order of their value references, kind by kind as in `KINDS`.

    The two audit states stand behind the model's own, the audit outputs behind the model's own.

    Attributes:
        audit: whether there are audit states
    """

    variables: tuple[Variable, ...]
    audit: bool = True

    def of(self, kind: str) -> tuple[Variable, ...]:
        """The variables of one kind, in order."""
        return tuple(v for v in self.variables if v.kind == kind)

    def __iter__(self) -> Iterator[Variable]:
        return iter(self.variables)

    def first(self, kind: str) -> int:
        """Value reference of the first variable of a kind (of the following one when there is none)."""
        return sum(len(self.of(k)) for k in KINDS[: KINDS.index(kind)])


def table(
    flat: FlatModel,
    start: Mapping[str, float] | None = None,
    choices: Iterable[Choice] = (),
    deviating: Sequence[str] = (),
    *,
    audit: bool = True,
) -> Table:
    """The variables of the FMU of a flat model.

    Args:
        flat: the model
        start: start values (SI) that replace those of inputs, parameters and states
        choices: enumerations
        deviating: states and outputs that have a standard deviation
        audit: whether the energy across the boundary is integrated

    Raises:
        FmuError: a start value is unknown, not settable, or out of its range; a name appears twice; what shall have a
            standard deviation is neither a state nor an output
    """
    states, inputs, parameters, problems = _collect_starts(flat, dict(start or {}))
    states += _audit_states(flat) if audit else ()
    chosen = tuple(choices)
    parameters = tuple(replace(q, doc=_describe_choice(q, chosen)) for q in parameters)
    derivatives = tuple(_derivative(q) for q in states)
    variables: list[Variable] = []
    groups = {"state": states, "input": inputs, "output": _outputs(flat), "parameter": parameters}
    for kind, group in groups.items():
        variables += [Variable(len(variables) + i, kind, q) for i, q in enumerate(group)]
    variables += [Variable(len(variables) + i, "derivative", q, state=i) for i, q in enumerate(derivatives)]
    variables += [Variable(len(variables) + i, "choice", _of_choice(c), choice=c) for i, c in enumerate(chosen)]
    own = {q.name for q in (*flat.states, *flat.outputs)}
    known = {v.name: v for v in variables if v.name in own}
    found = [known[name] for name in deviating if name in known]
    missing = [name for name in deviating if name not in known]
    problems += [f"{flat.name}: {name} is no state and no output.{suggestion(name, known)}" for name in missing]
    variables += [_deviation(len(variables) + i, v) for i, v in enumerate(found)]
    twice = sorted(name for name, count in Counter(v.name for v in variables).items() if count > 1)
    problems += [f"{flat.name}: {problem}" for problem in _unfit(chosen, inputs, parameters)]
    problems += [f'{flat.name}: the name "{n}" appears twice.' for n in twice]
    if problems:
        raise FmuError(problems)
    return Table(tuple(variables), audit)


def _inside(end: float, direction: float) -> float:
    """The next number beside an open end."""
    return direction * LEAST if end == 0 else math.nextafter(end, direction * math.inf)


def _collect_starts(flat: FlatModel, start: dict[str, float]) -> tuple[Group, Group, Group, list[str]]:
    """States, inputs and parameters with their start values, and what is wrong with them."""
    groups = [flat.states, flat.inputs, flat.parameters]
    settable = {q.name for group in groups for q in group}
    problems = []
    for name in sorted(start.keys() - settable):
        what = "is calculated by the model" if name in flat.index else f"is unknown.{suggestion(name, settable)}"
        told = follows(flat, name) if name in flat.derived else f'"{name}" {what}'
        problems.append(f"{flat.name}: start value {told}")
    groups = [tuple(replace(q, start=tidy(float(start.get(q.name, q.start)))) for q in group) for group in groups]
    problems += [f"{flat.name}: start value {p}" for group in groups for q in group if (p := q.problem(q.start))]
    return groups[0], groups[1], groups[2], problems


def tidy(value: float) -> float:
    """A start value (SI) without the round-off of the conversion from its unit where that shows: 234.14999999999998."""
    rounded = float(f"{value:.15g}")
    return rounded if len(repr(rounded)) < len(repr(value)) - 2 else value


def _audit_states(flat: FlatModel) -> Group:
    """The two energies the export integrates beside the model; their scale is the energy of a nominal change."""
    slope = ca.Function("slope", [flat.x, flat.u, flat.p], [ca.jacobian(flat.stored, flat.x)])
    values = np.abs(slope(*(flat.starts(kind) for kind in ("state", "input", "parameter"))).full().ravel())
    scale = float(values @ np.array([q.nominal for q in flat.states])) if flat.states else 0.0
    scale = float(f"{scale:.2g}") if np.isfinite(scale) and scale > 0 else 1.0
    return (
        Quantity(SUPPLIED, "J", "energy that crossed the boundary inwards since the start", nominal=scale),
        Quantity(THROUGHPUT, "J", "sum of the magnitudes of all energies that crossed the boundary", nominal=scale),
    )


def _outputs(flat: FlatModel) -> Group:
    audit = [
        Quantity(STORED, "J", "energy stored in the states"),
        Quantity(RESIDUAL, "W", "power into the model less the rate of its stored energy; zero in a sound model"),
        Quantity(VALIDITY, "1", "number of law arguments outside the range their source gives", low=0.0),
    ]
    if flat.residual_names:
        audit.append(Quantity(IMPLICIT, "1", "largest scaled residual of the implicit equations", low=0.0))
    return (*(replace(q, doc=_doc(flat, q)) for q in flat.outputs), *audit)


def _doc(flat: FlatModel, q: Quantity) -> str:
    """What an output is; of a parameter that follows from others also from which."""
    own = q.name.rpartition(".")[0] + "."
    known = ", ".join(path.removeprefix(own) for path in flat.derived.get(q.name, ()))
    return f"{q.doc}, follows from {known}" if known else q.doc


def _describe_choice(q: Quantity, choices: Iterable[Choice]) -> str:
    """What a parameter is; of one that a choice gives values also which counts."""
    by = [c.name for c in choices if q.name in c.parameters]
    return f"{q.doc}; {by[0]} sets it unless it differs from its start value" if by else q.doc


def _unfit(choices: Iterable[Choice], inputs: Group, parameters: Group) -> Iterator[str]:
    """Values of items that are out of the range of their parameter, and rooms that no model knows."""
    known, given = {q.name: q for q in parameters}, {q.name for q in (*inputs, *parameters)}
    for choice in choices:
        if choice.room and choice.room not in given:
            yield f'{choice.name}: "{choice.room}" is no input and no parameter.{suggestion(choice.room, given)}'
        for item in choice.items:
            for name, value in item.values.items():
                if name in known and (problem := known[name].problem(value)):
                    yield f'{choice.name}, item "{item.name}": {problem}'


def _of_choice(choice: Choice) -> Quantity:
    """The number of the item that is chosen."""
    given = sorted(choice.parameters)
    doc = (
        f"{choice.doc}; sets {', '.join(given)}, but for those that differ from their start values"
        if given
        else choice.doc
    )
    return Quantity(choice.name, "1", doc, start=1.0, low=1.0, high=float(len(choice.items)), whole=True)


def _derivative(q: Quantity) -> Quantity:
    return Quantity(f"der({q.name})", per_second(q.unit), f"time derivative of {q.name}", nominal=q.nominal)


def _deviation(reference: int, of: Variable) -> Variable:
    q = of.quantity
    unit = f"{q.unit} (difference)" if q.unit == "K" else q.unit
    own = Quantity(f"{q.name}.sd", unit, f"standard deviation of {q.name}", nominal=0.01 * q.nominal, low=0.0)
    return Variable(reference, "deviation", own, of=of.reference)


def per_second(unit: str) -> str:
    """The unit of the time derivative of a quantity in `unit`."""
    unit = unit.removesuffix("(difference)").strip()
    if unit in ("J", "1"):
        return {"J": "W", "1": "1/s"}[unit]
    if unit.endswith("/s"):
        return f"{unit}2"
    return f"{unit}.s-1" if "/" in unit else f"{unit}/s"
