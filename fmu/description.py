"""modelDescription.xml of an FMU, from its table of variables and the sparsity of its equations."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import casadi as ca
import numpy as np

from ..model.core.flat import FlatModel
from ..model.errors import FmuError
from . import units
from .equations import Equations
from .fixed import tables, xml
from .variables import Choice, Table, Variable

#: Relative tolerance when the importer gives none: an error of one step is at most this times the nominal.
TOLERANCE = 1e-5
#: What an importer does when nothing is asked: four hours, most of a warm-up, in steps of a minute.
EXPERIMENT: Mapping[str, str] = tables("description")["experiment"]


def identifier(name: str) -> str:
    """A name as a C identifier, for the binary's file name."""
    cleaned = re.sub(r"\W", "_", name, flags=re.ASCII)
    return cleaned if re.match(r"[A-Za-z]", cleaned) else f"model_{cleaned}"


def tool() -> str:
    """Name and version of the tool that makes the FMU."""
    try:
        return f"gearheat {version('gearheat')}"
    except PackageNotFoundError:
        return "gearheat"


@dataclass(frozen=True)
class Owner:
    """What an FMU's owner says of it; nothing is told of what is empty.

    Attributes:
        author: name and organisation
        version: of the model
        licence: under which it is given away
        made: date and time in the form of XML, "2026-01-31T12:00:00Z"; with one, the same model gives other bytes

    Raises:
        FmuError: the date is none
    """

    author: str = ""
    version: str = ""
    licence: str = ""
    made: str = ""

    def __post_init__(self) -> None:
        if self.made and not _is_moment(self.made):
            raise FmuError(f'the date "{self.made}" is no date with a time. Write it as 2026-01-31T12:00:00Z.')

    @property
    def attributes(self) -> dict[str, str]:
        """The attributes of the description."""
        told = {"author": self.author, "version": self.version, "license": self.licence}
        return {name: text for name, text in {**told, "generationDateAndTime": self.made}.items() if text}


def _is_moment(text: str) -> bool:
    try:
        return datetime.fromisoformat(text).tzinfo is not None and "T" in text
    except ValueError:
        return False


@dataclass(frozen=True)
class Dependencies:
    """For each output, derivative: value references it depends on, among states and inputs, and among all knowns."""

    step: tuple[tuple[int, ...], ...]
    initial: tuple[tuple[int, ...], ...]


def dependencies(model: Equations, table: Table) -> Dependencies:
    """Exact dependencies of the outputs (behind the states) and then the derivatives, from the sparsity.

    Args:
        model: the equations, for their sparsity
        table: the variables, for their value references
    """
    unknowns = ca.vertcat(model.y, model.ode)
    by_z = _pattern(unknowns, model.z) @ _inverse(_pattern(model.residual, model.z))
    firsts = [table.first("state"), table.first("input"), table.first("parameter")]
    found: list[list[tuple[int, ...]]] = []
    for known, first in zip((model.x, model.u, model.p), firsts, strict=True):
        depends = _pattern(unknowns, known) + by_z @ _pattern(model.residual, known) > 0
        found.append([tuple(first + j for j in np.flatnonzero(row).tolist()) for row in depends])
    x, u, p = found
    step = tuple(tuple(sorted(a + b)) for a, b in zip(x, u, strict=True))
    p = [on + _find_choices(on, table) for on in p]
    return Dependencies(step, tuple(tuple(sorted(a + b)) for a, b in zip(step, p, strict=True)))


def _find_choices(parameters: Iterable[int], table: Table) -> tuple[int, ...]:
    """Value references of the choices that give values to any of some parameters."""
    names = {table.variables[r].name for r in parameters}
    return tuple(v.reference for v in table.of("choice") if v.choice and v.choice.parameters & names)


def _pattern(values: Any, known: Any) -> np.ndarray:
    """1 where a value depends on a symbol directly, else 0 (values, symbols)."""
    return np.array(ca.DM(ca.jacobian_sparsity(values, known), 1).full())


def _inverse(pattern: np.ndarray) -> np.ndarray:
    """Pattern of the inverse of a matrix with a full diagonal: what is reached along its entries."""
    reached = pattern
    for _ in range(len(pattern).bit_length()):
        reached = ((reached @ reached) > 0).astype(float)
    return reached


def description(
    flat: FlatModel,
    model: Equations,
    table: Table,
    guid: str,
    dependent: Dependencies | None = None,
    *,
    owner: Owner = Owner(),
    with_sources: bool = True,
    fmi: int = 2,
) -> bytes:
    """modelDescription.xml.

    Args:
        flat: the model, for its name and meaning
        model: its equations
        table: its variables
        guid: unique identification, "" while it is still to be computed
        dependent: the result of `dependencies`, computed when not given
        owner: what its owner says of it
        with_sources: whether the FMU holds its sources
        fmi: version of the standard, 2 or 3
    """
    dependent = dependent or dependencies(model, table)
    first = 1 if fmi == 2 else 0  # variables are told by their number in 2.0, by their reference in 3.0
    key, identification = ("index", "guid") if fmi == 2 else ("valueReference", "instantiationToken")

    def unknown(variable: Variable, on: Iterable[int]) -> dict[str, Any]:
        return {key: variable.reference + first, "dependencies": " ".join(str(r + first) for r in on)}

    named = {"fmiVersion": f"{fmi}.0", "modelName": flat.name, identification: guid, **origin(flat)}
    step = unknowns(table, dependent.step)
    outputs = [(v, (v.reference,)) for v in table.of("state")] + [(v, on) for v, on in step if v.kind != "derivative"]
    structure = {
        "Outputs": outputs,
        "Derivatives": [(v, on) for v, on in step if v.kind == "derivative"],
        "InitialUnknowns": unknowns(table, dependent.initial),
    }
    return xml(
        f"fmi{fmi}.xml",
        root={**named, **({"numberOfEventIndicators": "0"} if fmi == 2 else {}), **owner.attributes},
        with_sources=with_sources,
        variables=[(v.type, identity(v), values(v, first)) for v in table],
        structure={name: [unknown(v, on) for v, on in group] for name, group in structure.items()},
        **_circumstances(flat, table, fmi),
    )


def origin(flat: FlatModel) -> dict[str, str]:
    """The attributes that say what the model is and where its description is from."""
    told = {"description": "; ".join(filter(None, (flat.doc, *flat.joined))), "generationTool": tool()}
    return told | {"variableNamingConvention": "structured"}


def _circumstances(flat: FlatModel, table: Table, fmi: int) -> dict[str, Any]:
    """What every description tells beside its variables: interfaces, units, types, log categories, an experiment.

    With standard deviations there is no model exchange: their sensitivities move with the solver inside.
    """
    own = tables("description")[f"fmi{fmi}"]
    kinds = {} if table.of("deviation") else {"ModelExchange": own["model_exchange"]}
    told = {"modelIdentifier": identifier(flat.name), **own["capabilities"]}
    real = [v.quantity for v in table if v.type == "Real"]
    also = ("s",) if fmi == 3 else ()
    return {
        "interfaces": {kind: told | more for kind, more in (kinds | {"CoSimulation": own["co_simulation"]}).items()},
        "units": units.units_of(real, *also),
        "types": [type_of(unit) for unit in sorted({*also, *(q.unit for q in real)} & units.QUANTITIES.keys())],
        "choices": {type_name(v.choice): _items(v.choice) for v in table if v.choice},
        "log_categories": tables("description")["log_categories"],
        "experiment": {**EXPERIMENT, "tolerance": TOLERANCE},
    }


def type_name(choice: Choice) -> str:
    """Name of the type of a choice, which no variable may have."""
    return f"{choice.name}.Choice"


def _items(choice: Choice) -> list[dict[str, Any]]:
    return [{"name": item.name, "value": k, "description": item.doc} for k, item in enumerate(choice.items, 1)]


def type_of(unit: str) -> dict[str, str]:
    """The attributes of the type of variables of a unit."""
    quantity = units.QUANTITIES[unit]
    told = {"name": quantity, "quantity": quantity, "unit": units.fmi_unit(unit)}
    return told | ({"relativeQuantity": "true"} if units.is_difference(unit) else {})


def identity(variable: Variable) -> dict[str, str]:
    """The attributes that say what a variable is."""
    told = {
        "name": variable.name,
        "valueReference": str(variable.reference),
        "description": _meaning(variable),
        "causality": variable.causality,
        "variability": variable.variability,
    }
    return told | ({"initial": variable.initial} if variable.initial else {})


def values(variable: Variable, first: int = 0) -> dict[str, Any]:
    """The attributes that say which values a variable takes: unit, range, typical size, start value, its integral.

    Args:
        variable: of the table
        first: number of the first variable
    """
    q = variable.quantity
    if variable.choice:
        return {"declaredType": type_name(variable.choice), "start": str(int(q.start))}
    if variable.type == "Integer":
        ends = (("min", math.ceil, variable.bounds[0]), ("max", math.floor, variable.bounds[1]))
        return {key: str(whole(end)) for key, whole, end in ends if math.isfinite(end)} | {"start": str(int(q.start))}
    unit = units.fmi_unit(q.unit)
    told: dict[str, Any] = {"declaredType": units.QUANTITIES[q.unit]} if q.unit in units.QUANTITIES else {}
    told["unit"] = unit
    if units.is_difference(q.unit):
        told["relativeQuantity"] = "true"
    elif (shown := units.unit(unit).display(abs(variable.start or q.nominal))) is not None:
        told["displayUnit"] = shown.name
    low, high = variable.bounds
    told |= {key: repr(value) for key, value in (("min", low), ("max", high)) if math.isfinite(value)}
    if math.isfinite(q.nominal) and q.nominal > 0:
        told["nominal"] = repr(float(q.nominal))
    if variable.start is not None:
        told["start"] = repr(float(variable.start))
    return told if variable.state is None else told | {"derivative": variable.state + first}


def _meaning(variable: Variable) -> str:
    """What a variable is, and of which part: no two variables of a machine are described alike."""
    part, dot, _ = variable.name.rpartition(".")
    doc = variable.quantity.doc  # of a derivative and of a standard deviation it names the part
    return doc if not dot or variable.kind in ("derivative", "deviation") else f"{part}: {doc}"


def unknowns(table: Table, dependent: Sequence[tuple[int, ...]]) -> list[tuple[Variable, tuple[int, ...]]]:
    """Outputs, derivatives and standard deviations with the value references they depend on, in their order.

    The standard deviation of an output depends on what the output does, that of a state on the past alone.

    Args:
        table: the variables
        dependent: of each output and derivative
    """
    own = (*table.of("output"), *table.of("derivative"))
    on = {v.reference: references for v, references in zip(own, dependent, strict=True)}
    deviations = [(v, on.get(v.of, ()) if v.of is not None else ()) for v in table.of("deviation")]
    return [*((v, on[v.reference]) for v in own), *deviations]


@dataclass(frozen=True)
class _Terminal:
    """Two variables that are connected together: a potential and a flow with the names they have in any terminal.

    Terminals follow from names and units: `P.w` with `P.tau` is a shaft end, whose torque counts into the model; a
    temperature `P.T` with the heat flow rate `P.Q_flow_external` that may be given a heat port, and so is a given
    temperature with the heat flow rate `P.Q_flow` that follows, which counts out of the model.

    Attributes:
        kind: name of the kind of terminal, for importers that connect like with like
        inflow: whether the flow counts into the model
    """

    name: str
    kind: str
    doc: str
    potential: str
    flow: str
    members: tuple[str, str]
    inflow: bool


def terminals(table: Table) -> bytes:
    """terminalsAndIcons.xml of an FMU for FMI 3.0: which of its variables belong together where two FMUs are joined."""
    return xml("terminals.xml", terminals=list(_list_terminals(table)))


def _list_terminals(table: Table) -> Iterator[_Terminal]:
    """The terminals in the order of their potentials."""
    known = {(v.name, v.quantity.unit): v for v in table if v.kind in ("state", "input", "output")}
    for (name, unit), v in known.items():
        path, _, last = name.rpartition(".")
        if (last, unit) == ("w", "rad/s") and (tau := known.get((f"{path}.tau", "N.m"))):
            yield _Terminal(path, "org.gearheat.Flange", "shaft end", name, tau.name, ("w", "tau"), True)
        if (last, unit) == ("T", "K"):
            given, follows = (known.get((f"{path}.{flow}", "W")) for flow in ("Q_flow_external", "Q_flow"))
            flow = follows if v.kind == "input" else given
            if flow is not None:
                names, inflow = ("T", "Q_flow"), v.kind != "input"
                yield _Terminal(path, "org.gearheat.HeatPort", "heat port", name, flow.name, names, inflow)
