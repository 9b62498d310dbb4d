"""The public interface: what the model gets wrong in measured data."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from .diagnosis import diagnosed
from .planning import planned
from .report.findings import Findings
from .report.plan import Plan
from .request import PlanRequest, Request, read, read_plan

File = str | Path
Files = File | Sequence[File] | None


def diagnose(
    data: File | None,
    rig: File,
    *,
    card: File | None = None,
    logs: Files = None,
    reference: File | None = None,
    reference_logs: Files = None,
    sibling_logs: Files = None,
    library: Files = None,
    predict: File | None = None,
    causes: int = 2,
    quick: bool = False,
    alpha: float = 0.05,
    seed: int = 0,
    series: File | None = None,
    reference_series: File | None = None,
    progress: Callable[[str, float], None] = lambda stage, share: None,
) -> Findings:
    """Compare measured data with the model of a rig, and name what explains the difference.

    Args:
        data: table of readings, one row each; None with logs only
        rig: name of a shipped rig, or path of a rig file
        card: accuracies, priors and protocol
        logs: tables of logged samples
        reference: readings of the same rig when it was healthy; `reference_logs` are its logs then
        sibling_logs: logs of other machines of its type
        library: files with further causes
        predict: points to predict
        causes: how many may act together
        quick: without gain on readings left out and without next experiments
        alpha: accepted rate of false alarms
        seed: of everything that is drawn
        series: logged courses of the tests of `data`, `reference_series` of those of `reference`
        progress: told of each stage and the share done

    Raises:
        GearheatError: all problems of files and options at once
    """
    request = Request(
        str(rig),
        _path(data),
        _paths(logs),
        _path(card),
        _path(reference),
        _paths(reference_logs),
        _paths(sibling_logs),
        _paths(library),
        _path(predict),
        causes=causes,
        quick=quick,
        alpha=alpha,
        seed=seed,
        series=_path(series),
        reference_series=_path(reference_series),
    )
    return diagnosed(read(request), progress)


def plan(
    rig: File,
    *,
    separate: Sequence[str] = (),
    card: File | None = None,
    points: File | None = None,
    library: Files = None,
    reference: bool = False,
    progress: Callable[[str, float], None] = lambda stage, share: None,
) -> Plan:
    """What a campaign will tell of every cause, and which experiments tell some causes apart; no data are needed.

    Args:
        rig: name of a shipped rig, or path of a rig file
        separate: causes to tell apart
        card: accuracies, priors and protocol
        points: table of conditions; a grid over the rig's range without it
        library: files with further causes
        reference: whether there is a healthy campaign of the same points as well
        progress: told of each stage and the share done

    Raises:
        GearheatError: all problems of files and options at once
    """
    request = PlanRequest(str(rig), ",".join(separate), _path(card), _path(points), _paths(library), reference)
    return planned(read_plan(request), progress)


def _path(file: File | None) -> Path | None:
    return None if file is None else Path(file)


def _paths(files: Files) -> tuple[Path, ...]:
    if files is None:
        return ()
    return tuple(Path(f) for f in ([files] if isinstance(files, str | Path) else files))
