"""Export of a flat model as an FMU for ModelExchange and CoSimulation of FMI 2.0 or 3.0.

Any flat model will do: of a rig, of parts and nets, or written by hand like this capacitor behind a resistor, where
`Quantity` names, explains and bounds each number of the model:

    >>> import casadi as ca
    >>> from gearheat.fmu.export import export
    >>> from gearheat.model.core.flat import FlatModel, Quantity
    >>> v, u, R, C = (ca.SX.sym(name) for name in "vuRC")
    >>> i, none = (u - v) / R, ca.SX(0, 1)
    >>> rc = FlatModel(
    ...     name="rc",
    ...     doc="a capacitor charged through a resistor",
    ...     states=(Quantity("capacitor.v", "V", "voltage of the capacitor"),),
    ...     inputs=(Quantity("source.v", "V", "voltage of the source", start=5.0),),
    ...     parameters=(Quantity("R", "ohm", "resistance", start=2.0), Quantity("C", "F", "capacity", start=3.0)),
    ...     outputs=(Quantity("i", "A", "current"),),
    ...     x=v, u=u, p=ca.vertcat(R, C), ode=i / C, y=i,
    ...     supply=u * i - R * i**2, throughput=ca.fabs(u * i) + R * i**2, stored=C * v**2 / 2,
    ...     residual=none, residual_names=(), checks=(), checked=none, laws=(),
    ... )
    >>> export(rc, "rc.fmu", sources={"R": "data sheet of its maker, page 2"}).name
    'rc.fmu'
"""

from __future__ import annotations

import hashlib
import io
import os
import uuid
import zipfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from ..model.core.flat import FlatModel
from .compiling import QUICK, THOROUGH, Platform, Progress, binary, compile_all, platforms, store
from .described import remember
from .description import Owner, dependencies, description, identifier, terminals
from .documentation import About, PartText, documentation
from .equations import effective, equations
from .fixed import icon, xml
from .leading import Directions, Uncertain, leading
from .parameter_set import metadata, parameter_set
from .related import Related, relate
from .source import GUID_MARK, OF_LIBRARY, headers_of_3, source
from .variables import Choice, Table, drop_idle, start_choice, table

#: A check that was made and its result.
Check = tuple[str, str]

_PAGE = "documentation/index.html"


def export(
    flat: FlatModel,
    path: Path | str,
    *,
    platform: str = "host",
    start: Mapping[str, float] | None = None,
    sources: Mapping[str, str] | None = None,
    uncertainties: Mapping[str, float] | None = None,
    figures: Mapping[str, str] | None = None,
    parts: Sequence[PartText] = (),
    verify: Callable[[Path, str], Sequence[Check]] | None = None,
    owner: Owner = Owner(),
    with_sources: bool = True,
    fmi: int = 2,
    choices: Sequence[Choice] = (start_choice(),),
    audit: bool = True,
    uncertain: Uncertain | None = None,
    real_time: float | None = None,
    others: Related = Related(),
    progress: Progress = lambda done, share: None,
) -> Path:
    """Write a model as an FMU that serves co-simulation and model exchange; the same model gives the same bytes.

    It holds its solver and needs no library but that of C. Parameters are those with an effect (see `effective`).

    Args:
        flat: the model
        path: file to write, usually ending in .fmu; its folder is made if need be
        platform: of its binaries: "host", "all", or names as "linux64,win64" (FMI 3.0: "x86_64-linux,aarch64-darwin")
        start: start values (SI) of inputs, parameters and states that replace those of the model
        sources: parameter -> where its value is from: a citation, or "assumed: ...", "inferred: ...", "calibrated: ..."
        uncertainties: parameter -> standard uncertainty of its value, in the unit of the value
        figures, parts: for the documentation, title -> the model or a run of it as SVG, and what the model is made of
        verify: called with the finished file and its C source; the checks and results it gives are written into the
            documentation
        owner: author, version, licence and date that its owner gives
        with_sources, audit: whether it holds its C source, and two states that integrate the energy across the boundary
        fmi: version of the standard, 2 or 3
        choices: its enumerations: how a run begins, the oils; values of parameters that it does not have go
        uncertain: what makes standard deviations, which co-simulation alone has
        real_time: longest step of a solver that takes no more of them than a communication step asks for [s]
        others: further parameter sets, and a run that an importer can repeat
        progress: called with what is done, and the share of the compiling

    Raises:
        FmuError: a start value is wrong, nothing uncertain has an effect, the compiler or writing the file fails
    """
    path, chosen = Path(path), platforms(platform, fmi)
    kept, variables = _prepare_model(flat, dict(start or {}), choices, audit, uncertain.shown if uncertain else ())
    told_of: dict[str, Any] = {
        "owner": owner,
        "with_sources": with_sources,
        "uncertain": uncertain,
        "real_time": real_time,
    }
    code, told, directions = _code(kept, variables, fmi, **told_of)
    about = About(sources or {}, uncertainties or {}, figures or {}, parts, _idle(flat, kept), directions, with_sources)
    content = {
        "modelDescription.xml": told,
        _PAGE: documentation(kept, variables, about, fmi=fmi).encode(),
        **_extra(kept, variables, about, others),
        **(_of_fmi_3(flat.name, variables, with_sources) if fmi == 3 else {"model.png": icon()}),
        **({"sources/all.c": code.encode()} if with_sources else {})
        | _binaries(flat.name, code, chosen, fmi, progress),
    }
    _write_archive(path, content)
    if verify is not None:
        _write_archive(
            path, content | {_PAGE: documentation(kept, variables, about, verify(path, code), fmi=fmi).encode()}
        )
    return path


def _idle(flat: FlatModel, kept: FlatModel) -> tuple[str, ...]:
    held = {q.name for q in kept.parameters}
    return tuple(q.name for q in flat.parameters if q.name not in held)


def _binaries(name: str, code: str, chosen: Sequence[Platform], fmi: int, progress: Progress) -> dict[str, bytes]:
    headers, built = (headers_of_3(), OF_LIBRARY + code) if fmi == 3 else ({}, code)
    ways = (QUICK if os.environ.get("GEARHEAT_COMPILE") == "quick" else THOROUGH,)
    made = compile_all(lambda platform: binary(built, platform, headers=headers, ways=ways), chosen, progress)
    return {f"binaries/{p.name}/{identifier(name)}{p.suffix}": made[p.name] for p in chosen}


def _of_fmi_3(name: str, variables: Table, with_sources: bool) -> dict[str, bytes]:
    """The files that FMI 3.0 has besides, or in another place."""
    built = {"sources/buildDescription.xml": xml("build.xml", identifier=identifier(name))} if with_sources else {}
    return {
        "terminalsAndIcons/terminalsAndIcons.xml": terminals(variables),
        "terminalsAndIcons/icon.png": icon(),
    } | built


def _write_archive(path: Path, content: Mapping[str, bytes]) -> None:
    written = archive(content)
    store(path, written)
    remember(written)


def _prepare_model(
    flat: FlatModel, start: Mapping[str, float], choices: Iterable[Choice], audit: bool, deviating: Sequence[str]
) -> tuple[FlatModel, Table]:
    """The model without idle parameters, and its variables with their start values."""
    table(flat, start, deviating=deviating)  # tells all that is wrong, also with parameters that are idle
    kept = effective(flat, start)
    known = {q.name for q in (*kept.states, *kept.inputs, *kept.parameters)}
    own = {name: value for name, value in start.items() if name in known}
    return kept, table(kept, own, drop_idle(choices, kept), deviating, audit=audit)


def _code(
    flat: FlatModel,
    variables: Table,
    fmi: int,
    *,
    owner: Owner,
    with_sources: bool,
    uncertain: Uncertain | None,
    real_time: float | None,
) -> tuple[str, bytes, Directions | None]:
    """The C source and the description, with the identification that follows from both; directions of deviations."""
    model = equations(flat, variables.audit)
    directions = None if uncertain is None else leading(flat, model, variables, uncertain)
    if uncertain is not None and directions is not None:
        uncertain.tell(directions)
    code, dependent = source(flat, model, variables, fmi, directions, real_time), dependencies(model, variables)
    without_guid = description(
        flat, model, variables, GUID_MARK, dependent, owner=owner, with_sources=with_sources, fmi=fmi
    )
    digest = hashlib.sha256(code.encode() + without_guid).digest()
    guid = f"{{{uuid.UUID(bytes=digest[:16])}}}"
    return code.replace(GUID_MARK, guid), without_guid.replace(GUID_MARK.encode(), guid.encode()), directions


def _extra(flat: FlatModel, variables: Table, about: About, others: Related) -> dict[str, bytes]:
    """What a receiver needs to judge the values."""
    parameters = [v.quantity for v in variables.of("parameter")]
    doc, sources, sd = f"start values of {flat.name}", about.sources, about.uncertainties
    values = parameter_set(flat.name, parameters, doc=doc, sources=sources, uncertainties=sd)
    return relate(values, metadata(flat, values, "parameters.ssv", sources, sd), others)


def archive(content: Mapping[str, bytes]) -> bytes:
    """A zip file of the given files, with the same bytes for the same content."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as file:
        for name in sorted(content, key=lambda n: (n != "modelDescription.xml", n)):
            entry = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
            entry.create_system = 3
            entry.external_attr = 0o644 << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            file.writestr(entry, content[name])
    return buffer.getvalue()
