"""Parameter values of an FMU as an SSP 1.0 parameter set (.ssv): values with units, each with its source."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping

from ..model.core.flat import Quantity
from . import units
from .description import tool

SSV = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"
SSC = "http://ssp-standard.org/SSP1/SystemStructureCommon"

#: Name and namespace of the annotation that says where a value is from.
PROVENANCE = "org.gearheat.provenance"
PROVENANCE_SPACE = "urn:org.gearheat:provenance:1"

#: What stands before the colon of a source that is no citation.
_KINDS = ("assumed", "inferred", "calibrated")


def parameter_set(
    name: str,
    quantities: Iterable[Quantity],
    *,
    doc: str = "",
    sources: Mapping[str, str] | None = None,
    uncertainties: Mapping[str, float] | None = None,
) -> bytes:
    """The text of an .ssv file.

    Args:
        name: name of the set
        quantities: the parameters, by the names the FMU gives them, with their values (SI) as start
        doc: what the set is
        sources: name -> where the value is from, a citation or "assumed: ...", "inferred: ...", "calibrated: ..."
        uncertainties: name -> standard uncertainty of the value, in the unit of the value
    """
    chosen = tuple(quantities)
    root = ET.Element(
        "ssv:ParameterSet",
        {"xmlns:ssv": SSV, "xmlns:ssc": SSC, "version": "1.0", "name": name, "description": doc},
        generationTool=tool(),
    )
    parameters = ET.SubElement(root, "ssv:Parameters")
    for q in chosen:
        _parameter(parameters, q, (sources or {}).get(q.name), (uncertainties or {}).get(q.name))
    define_units(root, "ssv:Units", chosen)
    ET.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ET.tostring(root, encoding="unicode")}\n'.encode()


def kind_of(source: str) -> str:
    """Kind of a source: "assumed", "inferred", "calibrated" or "cited"."""
    kind = source.partition(":")[0].strip()
    return kind if kind in _KINDS else "cited"


def _parameter(parent: ET.Element, q: Quantity, source: str | None, uncertainty: float | None) -> None:
    element = ET.SubElement(parent, "ssv:Parameter", name=q.name, description=q.doc)
    unit = units.fmi_unit(q.unit)
    if q.whole:
        ET.SubElement(element, "ssv:Integer", value=str(int(q.start)))
    else:
        known = {"unit": unit} if units.unit(unit).exponents is not None else {}
        ET.SubElement(element, "ssv:Real", {"value": repr(float(q.start)), **known})
    said = {} if source is None else {"kind": kind_of(source), "source": source}
    if uncertainty is not None:
        said["standardUncertainty"] = repr(float(uncertainty))
    if said:
        annotation = ET.SubElement(ET.SubElement(element, "ssv:Annotations"), "ssc:Annotation", type=PROVENANCE)
        ET.SubElement(annotation, "provenance", {"xmlns": PROVENANCE_SPACE, **said})


def define_units(root: ET.Element, tag: str, quantities: Iterable[Quantity]) -> None:
    """Add the units that values refer to; one that is not understood has no place here, and its values go without.

    Args:
        root: of the file
        tag: name of the element that holds units there
        quantities: what has units
    """
    defined = [units.unit(name) for name in sorted({units.fmi_unit(q.unit) for q in quantities})]
    known = [(unit, unit.exponents) for unit in defined if unit.exponents is not None]
    if not known:
        return
    parent = ET.SubElement(root, tag)
    for unit, exponents in known:
        base = {name: str(exponent) for name, exponent in exponents.items()}
        if unit.factor != 1:
            base["factor"] = repr(unit.factor)
        ET.SubElement(ET.SubElement(parent, "ssc:Unit", name=unit.name), "ssc:BaseUnit", base)
