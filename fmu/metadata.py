"""SRMD of an FMU's parameters: where values are from, how uncertain they are, and which laws use them.

SRMD is the format of SSP Traceability for metadata of one file: classifications, each a list of keywords with texts.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping

from ..model.core.flat import FlatModel
from .description import tool
from .fixed import xml
from .units import fmi_unit

SRMD = "http://ssp-standard.org/SSPTraceability1/SimulationResourceMetaData"
STC = "http://ssp-standard.org/SSPTraceability1/SSPTraceabilityCommon"


def metadata(
    flat: FlatModel, parameters: bytes, source: str, sources: Mapping[str, str], uncertainties: Mapping[str, float]
) -> bytes:
    """The text of a .srmd file.

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
