"""Parameter values of an FMU as an SSP 1.0 parameter set (.ssv) with units and sources, and their metadata (.srmd)."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from typing import Any

from ..model.core.flat import FlatModel, Quantity
from .description import tool
from .fixed import xml
from .units import fmi_unit, unit, units_of

SSV = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"
SSC = "http://ssp-standard.org/SSP1/SystemStructureCommon"

#: Name and namespace of the annotation that says where a value is from.
PROVENANCE = "org.gearheat.provenance"
PROVENANCE_SPACE = "urn:org.gearheat:provenance:1"

#: What stands before the colon of a source that is no citation.
_KINDS = ("assumed", "inferred", "calibrated")

SRMD = "http://ssp-standard.org/SSPTraceability1/SimulationResourceMetaData"
STC = "http://ssp-standard.org/SSPTraceability1/SSPTraceabilityCommon"


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
    spaces = {"xmlns:ssv": SSV, "xmlns:ssc": SSC, "version": "1.0"}
    return xml(
        "parameters.ssv",
        root={**spaces, "name": name, "description": doc, "generationTool": tool()},
        parameters=[(q, _value(q), _origin(q.name, sources or {}, uncertainties or {})) for q in chosen],
        provenance=PROVENANCE,
        kind="ssv",
        units=units_of(chosen),
    )


def kind_of(source: str) -> str:
    """Kind of a source: "assumed", "inferred", "calibrated" or "cited"."""
    kind = source.partition(":")[0].strip()
    return kind if kind in _KINDS else "cited"


def _value(q: Quantity) -> dict[str, Any]:
    """A value with its unit; one that is not understood has no place in the file, and its values go without."""
    if q.whole:
        return {"value": int(q.start)}
    known = unit(fmi_unit(q.unit))
    return {"value": float(q.start), "unit": known.name if known.exponents is not None else None}


def _origin(name: str, sources: Mapping[str, str], uncertainties: Mapping[str, float]) -> dict[str, Any]:
    """Where a value is from, and how uncertain it is."""
    source = sources.get(name)
    said: dict[str, Any] = {} if source is None else {"kind": kind_of(source), "source": source}
    if name in uncertainties:
        said["standardUncertainty"] = float(uncertainties[name])
    return {"xmlns": PROVENANCE_SPACE, **said} if said else {}


def metadata(
    flat: FlatModel, parameters: bytes, source: str, sources: Mapping[str, str], uncertainties: Mapping[str, float]
) -> bytes:
    """The text of a .srmd file: where values are from, how uncertain they are, and which laws use them.

    SRMD is the format of SSP Traceability for metadata of one file: classifications, each a list of keywords and texts.

    Args:
        flat: the model
        parameters: the parameter set that is told of
        source: where that set stands, relative to the file
        sources: parameter -> where its value is from
        uncertainties: parameter -> standard uncertainty of its value, in the unit of the value
    """
    told = {"version": "1.0.0", "name": flat.name, "description": flat.doc, "generationTool": tool()}
    checksum = hashlib.sha3_256(parameters).hexdigest().upper()
    spaces = {"xmlns:srmd": SRMD, "xmlns:stc": STC}
    about = {"data": source, "checksum": checksum, "checksumType": "SHA3-256"}
    named = {q.name: fmi_unit(q.unit) for q in flat.parameters}
    known = {name: value for name, value in uncertainties.items() if name in named}
    classifications = {
        "org.gearheat.source": {name: text for name, text in sources.items() if name in named},
        "org.gearheat.standard-uncertainty": {
            name: f"{value!r} {named[name]}".removesuffix(" 1") for name, value in known.items()
        },
        "org.gearheat.law": {
            law.name: f"{law.source}, {law.where}; valid for: {law.valid or 'not said'}; "
            f"{'' if law.verified else 'not '}compared with printed numbers"
            for law in flat.laws
        },
    }
    return xml("metadata.srmd", root={**spaces, **told, **about}, classifications=classifications)
