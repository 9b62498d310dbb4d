"""A system of FMUs as one file of SSP 1.0: the FMUs, and SystemStructure.ssd that says who passes what to whom."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from ..model.core.flat import Quantity
from .description import tool, xml
from .export import archive
from .parameter_set import SSC, define_units
from .units import fmi_unit

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
    """The .ssp file of a system. The same system gives the same bytes.

    Args:
        system: the FMUs and their connections
    """
    fmus = {_source(element): element.fmu for element in system.elements}
    return archive({"SystemStructure.ssd": structure(system), **fmus})


def structure(system: System) -> bytes:
    """SystemStructure.ssd.

    Args:
        system: the FMUs and their connections
    """
    spaces = {"xmlns:ssd": SSD, "xmlns:ssc": SSC, "version": "1.0", "name": system.name, "generationTool": tool()}
    root = ET.Element("ssd:SystemStructureDescription", spaces)
    top = ET.SubElement(root, "ssd:System", name=system.name, description=system.doc)
    if system.inputs:
        _connectors(top, system.inputs, ())
    elements = ET.SubElement(top, "ssd:Elements")
    for element in system.elements:
        told = {"name": element.name, "description": element.doc, "source": _source(element)}
        kind = {"type": "application/x-fmu-sharedlibrary", "implementation": "CoSimulation"}
        _connectors(ET.SubElement(elements, "ssd:Component", {**told, **kind}), element.inputs, element.outputs)
    connections = ET.SubElement(top, "ssd:Connections")
    for start, end in system.connections:
        ends = {"startElement": start[0], "startConnector": start[1], "endElement": end[0], "endConnector": end[1]}
        ET.SubElement(connections, "ssd:Connection", {key: text for key, text in ends.items() if text is not None})
    define_units(root, "ssd:Units", [q for e in system.elements for q in (*e.inputs, *e.outputs)])
    ET.SubElement(root, "ssd:DefaultExperiment", startTime="0.0", stopTime=repr(system.stop))
    return xml(root)


def _connectors(parent: ET.Element, inputs: Sequence[Quantity], outputs: Iterable[Quantity]) -> None:
    connectors = ET.SubElement(parent, "ssd:Connectors")
    for kind, quantities in (("input", inputs), ("output", outputs)):
        for q in quantities:
            connector = ET.SubElement(connectors, "ssd:Connector", name=q.name, kind=kind, description=q.doc)
            ET.SubElement(connector, "ssc:Real", unit=fmi_unit(q.unit))


def _source(element: Element) -> str:
    return f"resources/{element.name}.fmu"
