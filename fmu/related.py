"""Files under extra/ of an FMU: what a receiver needs to judge its values, listed as FMI-LS-REF says.

FMI-LS-REF is the layered standard of FMI for files that belong to an FMU: a manifest in a folder of its own names each
with its role. An importer that does not know it passes it over. Experiments are in the format of the harmonized
specification of the Modelica Association, metadata in SRMD of SSP Traceability. Beside an FMU stands a reference result
in the form of the FMI cross-check: NAME_in.csv, NAME_ref.csv, NAME_ref.opt.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from .compiling import store
from .fixed import xml
from .grid import Inputs, grid
from .play import play

FOLDER = "extra/org.fmi-standard.fmi-ls-ref"
PARAMETERS = f"{FOLDER}/parameters.ssv"
MANIFEST = f"{FOLDER}/fmi-ls-manifest.xml"

_SET = "application/x-ssp-parameter-set"

_VALUES = "Start values of all parameters, with the source of each and its standard uncertainty where one is stated"
_ORIGIN = "Sources and standard uncertainties of the parameters, and the laws with their sources and validity"
_PAGE = "Purpose, variables, laws with their sources and validity, and how the FMU was verified"
#: Tolerance the reference is computed with.
TOLERANCE = 1e-8


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


def write_reference(
    fmu: Path | str,
    inputs: Inputs,
    stop: float,
    step: float,
    *,
    folder: Path | None = None,
) -> tuple[Path, Path, Path]:
    """Play an FMU at a tight tolerance and write inputs, result and options beside it, for whoever imports it.

    Args:
        fmu: the FMU to play
        inputs: name -> (times [s], values), linear between the points, a time given twice is a jump
        stop: end [s]; the run begins at 0
        step: time between the rows of the result [s]
        folder: where to write; beside the FMU when not given

    Returns:
        the three files

    Raises:
        FmuError: the FMU or the inputs are refused, or a file cannot be written
    """
    fmu = Path(fmu)
    played = play(fmu, inputs, stop, step, tolerance=TOLERANCE)
    options = {
        "StartTime": 0.0,
        "StopTime": float(stop),
        "StepSize": float(step),
        "RelTol": TOLERANCE,
        "OutputIntervalLength": float(step),
    }
    texts = {
        "_in.csv": stimuli(inputs, stop),
        "_ref.csv": _csv(played.names, played.time, played.values),
        "_ref.opt": "".join(f"{name}, {value!r}\n" for name, value in options.items()),
    }
    files = {ending: (folder or fmu.parent) / f"{fmu.stem}{ending}" for ending in texts}
    for ending, text in texts.items():
        store(files[ending], text.encode())
    return files["_in.csv"], files["_ref.csv"], files["_ref.opt"]


def stimuli(inputs: Inputs, stop: float) -> str:
    """Inputs over time as CSV, both sides of every jump.

    Args:
        inputs: name -> (times [s], values), linear between the points, a time given twice is a jump
        stop: end [s]
    """
    return _csv(*_points(inputs, stop))


def results(names: Sequence[str], time: np.ndarray, values: np.ndarray) -> str:
    """Results over time as CSV, to nine digits, which do not differ from one machine to another.

    Args:
        names: of the columns
        time: of the rows [s]
        values: one row a time, one column a name, SI
    """
    return _csv(names, time, values, "{:.9g}")


def _points(inputs: Inputs, stop: float) -> tuple[tuple[str, ...], np.ndarray, np.ndarray]:
    """All inputs on their common points, both sides of every jump."""
    pieces = grid(inputs, 0.0, stop, stop, None)
    ends = pieces.value + pieces.slope * np.diff(pieces.time)[:, None]
    time = np.repeat(pieces.time, 2)[1:-1]
    values = np.stack([pieces.value, ends], axis=1).reshape(len(time), -1)
    same = np.append(False, (np.diff(time) == 0) & np.isclose(values[1:], values[:-1], rtol=1e-12, atol=0).all(axis=1))
    return pieces.names, time[~same], values[~same]


def _csv(names: Sequence[str], time: np.ndarray, values: np.ndarray, form: str = "{!r}") -> str:
    head = ",".join(f'"{name}"' for name in ("time", *names))
    rows = [",".join(form.format(float(v)) for v in (t, *row)) for t, row in zip(time, values, strict=True)]
    return "\n".join([head, *rows]) + "\n"
