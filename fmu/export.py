"""Export of a flat model as an FMU for FMI 2.0 ModelExchange and CoSimulation."""

from __future__ import annotations

import hashlib
import io
import uuid
import zipfile
from collections.abc import Mapping
from pathlib import Path

from gearheat.model.core.flat import FlatModel

from .compiling import binary, platforms, store
from .description import dependencies, description, identifier
from .documentation import documentation
from .equations import equations
from .icon import icon
from .source import GUID_MARK, source
from .variables import table


def export(
    flat: FlatModel, path: Path | str, *, platform: str = "host", start: Mapping[str, float] | None = None
) -> Path:
    """Write the FMU of a model. The same model gives the same bytes.

    Args:
        flat: the model
        path: file to write, usually ending in .fmu
        platform: "host", "all", or names such as "linux64,win64" whose binaries the FMU shall hold
        start: start values (SI) of inputs, parameters and states that replace those of the model

    Returns:
        the path

    Raises:
        FmuError: a start value is wrong, the compiler fails, or the file cannot be written
    """
    chosen = platforms(platform)
    variables = table(flat, start)
    model = equations(flat)
    code = source(flat, model, variables)
    dependent = dependencies(model, variables)
    unnamed = description(flat, model, variables, GUID_MARK, dependent)
    guid = _guid(code.encode() + unnamed)
    code = code.replace(GUID_MARK, guid)
    content = {
        "modelDescription.xml": unnamed.replace(GUID_MARK.encode(), guid.encode()),
        "model.png": icon(),
        "documentation/index.html": documentation(flat, variables).encode(),
        "sources/all.c": code.encode(),
    }
    for p in chosen:
        content[f"binaries/{p.name}/{identifier(flat.name)}{p.suffix}"] = binary(code, p)
    path = Path(path)
    store(path, archive(content))
    return path


def _guid(content: bytes) -> str:
    return "{" + str(uuid.UUID(bytes=hashlib.sha256(content).digest()[:16])) + "}"


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
