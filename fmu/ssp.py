"""A system of FMUs as one file of SSP 1.0: the FMUs, and SystemStructure.ssd that says who passes what to whom."""

from __future__ import annotations

from dataclasses import dataclass

from ..model.core.flat import Quantity
from .description import tool
from .export import archive
from .fixed import xml
from .parameter_set import SSC
from .units import fmi_unit, units_of

SSD = "http://ssp-standard.org/SSP1/SystemStructureDescription"

#: An end of a connection: the element, None for the system itself, and the connector.
End = tuple[str | None, str]


@dataclass(frozen=True)
class Element:
    """An FMU of a system with what it takes from and gives to others."""

    name: str
    fmu: bytes
    inputs: tuple[Quantity, ...]
    outputs: tuple[Quantity, ...]
    doc: str = ""


@dataclass(frozen=True)
class System:
    """FMUs that are coupled.

    Outputs stay those of the FMUs: some simulators know connections between elements alone.

    Attributes:
        inputs: of the system
        connections: from one end to the other; an end without an element is a connector of the system
        stop: of the default experiment [s]
    """

    name: str
    doc: str
    elements: tuple[Element, ...]
    connections: tuple[tuple[End, End], ...]
    inputs: tuple[Quantity, ...]
    stop: float


def ssp(system: System) -> bytes:
    """The .ssp file of FMUs and their connections. The same system gives the same bytes."""
    fmus = {_source(element): element.fmu for element in system.elements}
    return archive({"SystemStructure.ssd": structure(system), **fmus})


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
        unit_of=fmi_unit,
        kind="ssd",
        units=units_of([q for e in system.elements for q in (*e.inputs, *e.outputs)]),
    )


def _source(element: Element) -> str:
    return f"resources/{element.name}.fmu"
