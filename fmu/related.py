"""Files under extra/ of an FMU: what a receiver needs to judge its values, listed as FMI-LS-REF says.

FMI-LS-REF is the layered standard of FMI for files that belong to an FMU: a manifest in a folder of its own names each
with its role. An importer that does not know it passes it over.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET

FOLDER = "extra/org.fmi-standard.fmi-ls-ref"
PARAMETERS = f"{FOLDER}/parameters.ssv"
MANIFEST = f"{FOLDER}/fmi-ls-manifest.xml"

_MANIFEST = "http://fmi-standard.org/fmi-ls-manifest"
_IDENTITY = {
    "xmlns:fmi-ls": _MANIFEST,
    "fmi-ls:fmi-ls-name": "org.fmi-standard.fmi-ls-ref",
    "fmi-ls:fmi-ls-version": "1.0.0-alpha.1",
    "fmi-ls:fmi-ls-description": "Layered Standard providing information on related files included in an FMU.",
}
_RELATED = (
    (
        "application/x-ssp-parameter-set",
        "parameters.ssv",
        "parameter",
        "Start values of all parameters, with the source of each and its standard uncertainty where one is stated",
    ),
    (
        "text/html",
        "../../documentation/index.html",
        "document",
        "Purpose, variables, laws with their sources and validity, and how the FMU was verified",
    ),
)


def related(parameters: bytes) -> dict[str, bytes]:
    """Paths inside the FMU and content of the manifest and the files it lists.

    Args:
        parameters: the parameter set of the FMU's start values
    """
    root = ET.Element("fmiReferences", _IDENTITY)
    for mime, source, role, doc in _RELATED:
        ET.SubElement(root, "Related", {"type": mime, "source": source, "role": role, "description": doc})
    ET.indent(root)
    text = f'<?xml version="1.0" encoding="UTF-8"?>\n{ET.tostring(root, encoding="unicode")}\n'
    return {MANIFEST: text.encode(), PARAMETERS: parameters}
