"""Parameter values of an FMU as an SSP 1.0 parameter set (.ssv): values with units, each with its source."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from ..model.core.flat import Quantity
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
