"""The export of a rig, as an FMU or as a system of FMUs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ...fmu.description import Owner
from ...scenarios.given import RigLike, Settings, assignments_of, scenario_of
from .fmu import Asked, Exported, export_rig
from .systems import export_system


def export(
    rig: RigLike,
    out: str | Path,
    *,
    fmi: int = 2,
    set: Settings = (),
    drive: str | None = None,
    given: str = "speed",
    platform: str = "host,win64",
    license: str = "",
    author: str = "",
    model_version: str = "",
    date: str = "",
    sources: bool = True,
    audit: bool = True,
    parameters_source: bool = True,
    extras: str | Path | None = None,
    uncertainty: bool = False,
    ssp: Sequence[str] = (),
) -> Exported:
    """Write a rig as an FMU for FMI 2.0 or 3.0, or as a system of FMUs.

    Args:
        rig: name, file or rig
        out: file to write, .fmu, or .ssp for a system
        fmi: version of the standard, 2 or 3
        set: values by name: texts with units, quantities of pint, or numbers in SI
        drive: shaft end that drives; the rig's own if None
        given: "speed": speed and torque of the driving shaft are inputs; "torque": the torques of all shaft ends are
        platform: "host", "all" or names such as "linux64,win64"
        license: licence under which it is given away
        author: who answers for it
        model_version: version of the model
        date: date and time, such as "2026-01-31T12:00:00Z"
        sources: with its C source
        audit: with two states that integrate the energy across the boundary
        parameters_source: telling where values are from
        extras: folder for parameter sets and a reference result
        uncertainty: with standard deviations, such as oil.T.sd
        ssp: parts of each FMU of a system, "NAME=PART,PART"; the rest is one FMU

    Raises:
        GearheatError: all that is wrong with what is asked

    Example:
        >>> import gearheat as gh
        >>> gh.export("planetary", "planetary.fmu", fmi=3)  # doctest: +SKIP
    """
    scenario = scenario_of(rig)
    asked = Asked(
        scenario,
        Path(out),
        assignments_of(set, scenario.settable),
        drive,
        given,
        platform,
        None if extras is None else Path(extras),
        owner=Owner(author, model_version, license, date),
        with_sources=sources,
        with_origins=parameters_source,
        fmi=fmi,
        audit=audit,
        uncertainty=uncertainty,
    )
    return export_system(ssp, asked) if ssp else export_rig(asked)
