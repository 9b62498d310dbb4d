"""Files under extra/ of an FMU: what a receiver needs to judge its values, listed as FMI-LS-REF says.

FMI-LS-REF is the layered standard of FMI for files that belong to an FMU: a manifest in a folder of its own names each
with its role. An importer that does not know it passes it over. Experiments are in the format of the harmonized
specification of the Modelica Association, metadata in SRMD of SSP Traceability.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from .fixed import xml

FOLDER = "extra/org.fmi-standard.fmi-ls-ref"
PARAMETERS = f"{FOLDER}/parameters.ssv"
MANIFEST = f"{FOLDER}/fmi-ls-manifest.xml"

_SET = "application/x-ssp-parameter-set"


@dataclass(frozen=True)
class Experiment:
    """A run that an importer can repeat: what the inputs are over time, and what comes out.

    Attributes:
        stop: end of the run, which begins at 0 [s]
        step: communication step [s]
        tolerance: relative, of the FMU's solver
        stimuli: the inputs as CSV
        results: the outputs as CSV
    """

    name: str
    doc: str
    stop: float
    step: float
    tolerance: float
    stimuli: str
    results: str


@dataclass(frozen=True)
class Related:
    """What goes with an FMU beside its own parameters.

    Attributes:
        sets: name -> parameter set (.ssv) of some of the parameters, an oil for example
        experiment: a run to repeat
    """

    sets: Mapping[str, bytes] = field(default_factory=dict)
    experiment: Experiment | None = None


def relate(parameters: bytes, metadata: bytes, others: Related = Related()) -> dict[str, bytes]:
    """Paths inside the FMU and content of the manifest and the files it lists.

    Args:
        parameters: the parameter set of the FMU's start values
        metadata: SRMD of that set
        others: what goes with it besides
    """
    entries: list[tuple[dict[str, str], str]] = []
    files: dict[str, bytes] = {}

    def add(source: str, content: bytes, kind: str, role: str, doc: str, label: str = "") -> None:
        files[f"{FOLDER}/{source}"] = content
        entries.append(({"type": kind, "source": source, "role": role, "description": doc}, label))

    add("parameters.ssv", parameters, _SET, "parameter", _VALUES)
    for name, content in others.sets.items():
        doc, source = f"Values of {name} in place of the start values", f"sets/{name.replace(' ', '_')}.ssv"
        add(source, content, _SET, "parameter", doc, f"variant:{name}")
    if (run := others.experiment) is not None:
        told = xml("experiments.exp", run=run)
        add("experiments.exp", told, "application/x-ma-hs-experiments", "experiment/smoke-test", run.doc)
        add("reference_in.csv", run.stimuli.encode(), "text/csv", "other", "Inputs of the experiment over time, SI")
        add("reference_ref.csv", run.results.encode(), "text/csv", "result", "Results of the experiment, SI")
    add("parameters.srmd", metadata, "application/x-srmd-meta-data", "meta-data", _ORIGIN)
    page = {"type": "text/html", "source": "../../documentation/index.html", "role": "document", "description": _PAGE}
    return {MANIFEST: xml("manifest.xml", entries=[*entries, (page, "")]), **files}


_VALUES = "Start values of all parameters, with the source of each and its standard uncertainty where one is stated"
_ORIGIN = "Sources and standard uncertainties of the parameters, and the laws with their sources and validity"
_PAGE = "Purpose, variables, laws with their sources and validity, and how the FMU was verified"
