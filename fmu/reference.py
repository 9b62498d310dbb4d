"""A reference result beside an FMU, in the form of the FMI cross-check: NAME_in.csv, NAME_ref.csv, NAME_ref.opt."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from .compiling import store
from .grid import Inputs, grid
from .play import play

#: Tolerance the reference is computed with.
TOLERANCE = 1e-8


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
