"""A system of FMUs as one file of SSP 1.0: FMUs, their parameter sets, and what passes between them."""

from __future__ import annotations

from dataclasses import dataclass, replace

from ..model.core.flat import Quantity
from .description import tool
from .export import archive
from .fixed import xml
from .parameter_set import SSC
from .units import fmi_unit, unit, units_of

SSD = "http://ssp-standard.org/SSP1/SystemStructureDescription"

#: Description of the elements and what they pass to each other, without connectors of the system.
ELEMENTS = "Elements.ssd"

#: The annotation without which OMSimulator takes no system, and its master.
OMS = "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd"
OMS_MASTER = {"description": "oms-ma", "absoluteTolerance": 1e-6, "relativeTolerance": 1e-6}

#: An end of a connection: the element, None for the system itself, and the connector.
End = tuple[str | None, str]


@dataclass(frozen=True)
class Element:
    """An FMU of a system with what it takes from and gives to others.

    Attributes:
        values: parameter set (.ssv) of its parameters
    """

    name: str
    fmu: bytes
    inputs: tuple[Quantity, ...]
    outputs: tuple[Quantity, ...]
    parameters: tuple[Quantity, ...]
    values: bytes
    doc: str = ""

    @property
    def connectors(self) -> tuple[tuple[str, Quantity], ...]:
        """Kind and quantity of each."""
        kinds = (("input", self.inputs), ("output", self.outputs), ("parameter", self.parameters))
        return tuple((kind, q) for kind, quantities in kinds for q in quantities)


@dataclass(frozen=True)
class System:
    """FMUs that are coupled.

    Outputs stay those of the FMUs: some simulators know connections between elements alone.

    Attributes:
        inputs: of the system
        connections: from one end to the other; an end without an element is a connector of the system
        stop: of the default experiment [s]
        step: between two exchanges, for a master that has no other [s]
    """

    name: str
    doc: str
    elements: tuple[Element, ...]
    connections: tuple[tuple[End, End], ...]
    inputs: tuple[Quantity, ...]
    stop: float
    step: float

    @property
    def connectors(self) -> tuple[tuple[str, Quantity], ...]:
        """Kind and quantity of each."""
        return tuple(("input", q) for q in self.inputs)


def ssp(system: System) -> bytes:
    """The .ssp file of FMUs and their connections. The same system gives the same bytes.

    Beside its description stands one without connectors of the system, for masters that know elements alone.
    """
    held = {_source(element): element.fmu for element in system.elements}
    held |= {_source(element, ".ssv"): element.values for element in system.elements}
    inside = tuple((start, end) for start, end in system.connections if start[0] is not None)
    alone = structure(replace(system, inputs=(), connections=inside))
    return archive({"SystemStructure.ssd": structure(system), ELEMENTS: alone, **held})


def structure(system: System) -> bytes:
    """SystemStructure.ssd of FMUs and their connections."""
    spaces = {"xmlns:ssd": SSD, "xmlns:ssc": SSC, "version": "1.0", "name": system.name, "generationTool": tool()}
    keys = ("startElement", "startConnector", "endElement", "endConnector")
    return xml(
        "structure.ssd",
        root=spaces,
        system=system,
        connections=[dict(zip(keys, (*start, *end), strict=True)) for start, end in system.connections],
        source_of=_source,
        unit_of=_unit,
        kind="ssd",
        units=units_of([q for e in system.elements for _, q in e.connectors]),
        oms=OMS,
        master={**OMS_MASTER, "stepSize": system.step},
    )


def _source(element: Element, ending: str = ".fmu") -> str:
    return f"resources/{element.name}{ending}"


def _unit(q: Quantity) -> str | None:
    """The unit of a connector; one that is not understood has no place in the file."""
    known = unit(fmi_unit(q.unit))
    return known.name if known.exponents is not None else None
