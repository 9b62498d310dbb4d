"""The command `plan`: a rig and some causes in, experiments that would tell them apart out."""

from __future__ import annotations

from pathlib import Path

from ...model.errors import DataError, GearheatError
from ..console import answer, file_of, note, writable, write
from .plan_inputs import PlanInputs, PlanRequest, read_plan

#: Kinds of pictures by the ending of their file's name.
PICTURES = {".png": "png", ".svg": "svg"}


def command(request: PlanRequest, json: str | None, out: Path | None) -> None:
    """Read, plan, write.

    Args:
        request: rig, causes and files
        json: file of the JSON object, "-" for stdout
        out: picture to write

    Raises:
        GearheatError: all problems of files and options at once, before any work
    """
    inputs = _checked(request, json, out)
    from .plan import planned
    from .plan_output import as_object, picture, show

    plan = planned(inputs, note)
    if out is not None:
        write(out, picture(plan, PICTURES[out.suffix.lower()]))
    answer(as_object(plan), json, lambda: show(plan))


def _checked(request: PlanRequest, json: str | None, out: Path | None) -> PlanInputs:
    problems: list[str] = []
    inputs = None
    try:
        inputs = read_plan(request)
    except GearheatError as error:
        problems += error.problems
    if out is not None and out.suffix.lower() not in PICTURES:
        problems.append(f"--out {out}: is no picture that can be drawn. Give a name that ends in .png or .svg.")
    files = {"--card": request.card, "--points": request.points, "--json": file_of(json), "--out": out}
    taken: dict[Path, str] = {}
    for name, path in files.items():
        if path is not None and (other := taken.setdefault(path.resolve(), name)) != name:
            problems.append(f"{name} {path}: is the file of {other}, too. Give each its own.")
    try:
        writable(file_of(json), out)
    except GearheatError as error:
        problems += error.problems
    if problems or inputs is None:
        raise DataError(problems)
    return inputs
