"""An FMU that shall be played, also one that another tool has made: safe to unpack, made here or not, described."""

from __future__ import annotations

import hashlib
import math
import stat
import xml.etree.ElementTree as ET
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Any

import fmpy

from ..model.core.flat import Quantity
from ..model.errors import FmuError
from ..model.files import reading
from .compiling import cache_folder, store

#: Bytes that an FMU may unpack to: far above any FMU known, far below what fills a disk.
MOST_BYTES = 1 << 30
#: Folder of a module of WebAssembly with the functions of FMI 3.0.
MODULE = "wasm32-wasip1"
#: Files that an FMU may hold.
MOST_FILES = 10_000


def check(path: Path, file: zipfile.ZipFile) -> None:
    """Whether an FMU may be unpacked.

    Args:
        path: of the FMU, for messages
        file: its archive

    Raises:
        FmuError: entries that lead out of its folder, links, too many files or too much content, all at once
    """
    entries = file.infolist()
    problems = [
        f'{path}: holds "{entry.filename}", which {wrong}. No FMU needs that: ask its maker for another one.'
        for entry in entries
        if (wrong := _wrong(entry))
    ]
    if len(entries) > MOST_FILES:
        problems.append(f"{path}: holds {len(entries)} files. At most {MOST_FILES} are taken.")
    if (size := sum(entry.file_size for entry in entries)) > MOST_BYTES:
        problems.append(f"{path}: unpacks to {size / 2**20:.0f} MiB. At most {MOST_BYTES >> 20} MiB are taken.")
    if problems:
        raise FmuError(problems)


def _wrong(entry: zipfile.ZipInfo) -> str:
    """What an entry may not do, "" where it may be unpacked."""
    names = PurePosixPath(entry.filename), PureWindowsPath(entry.filename)
    if any(name.is_absolute() or name.drive or ".." in name.parts for name in names):
        return "lies outside of the FMU"
    return "is a link" if stat.S_ISLNK(entry.external_attr >> 16) else ""


def remember(content: bytes) -> None:
    """Note that an FMU of this content was made here."""
    with suppress(FmuError):  # without a cache it is asked for `--trust`
        store(_note(hashlib.sha256(content).hexdigest()), b"")


def is_trusted(path: Path) -> bool:
    """Whether an FMU was made by gearheat on this machine."""
    with path.open("rb") as file:
        return _note(hashlib.file_digest(file, "sha256").hexdigest()).is_file()


def _note(digest: str) -> Path:
    return cache_folder() / "made" / digest


@dataclass(frozen=True)
class Described:
    """What an FMU says of itself.

    Attributes:
        path: the file
        description: FMPy's reading of modelDescription.xml
        variables: the variables by name
        differences: names of the variables that are differences, which no offset of a unit must touch
        web: whether its module of WebAssembly is what runs here
    """

    path: Path
    description: Any
    variables: Mapping[str, Any]
    differences: frozenset[str]
    web: bool = False

    def quantities(self, *kinds: str) -> dict[str, Quantity]:
        """Variables that are real numbers, by name: "input", "start" (what may be set before the run), "output"."""
        found = {}
        for name, v in self.variables.items():
            own = {v.causality, "start"} if settable(v) else {v.causality}
            if is_real(v) and own & set(kinds):
                found[name] = self._quantity(v)
        return found

    def wholes(self) -> dict[str, dict[str, int]]:
        """Variables that take whole numbers before the run, by name, each with the numbers of its items."""
        found = {name: v.declaredType for name, v in self.variables.items() if is_whole(v) and settable(v)}
        return {name: {i.name: int(i.value) for i in (t.items if t else None) or ()} for name, t in found.items()}

    def _quantity(self, v: Any) -> Quantity:
        declared = v.declaredType
        unit = v.unit or (declared.unit if declared is not None else None) or "1"
        low, high = (_read_bound(v, declared, key, end) for key, end in (("min", -math.inf), ("max", math.inf)))
        mark = " (difference)" if unit == "K" and v.name in self.differences else ""
        return Quantity(v.name, f"{unit}{mark}", v.description or "", low=low, high=high)


def is_real(v: Any) -> bool:
    """Whether a variable is one real number."""
    return v.type in ("Real", "Float64") and not v.dimensions


def is_whole(v: Any) -> bool:
    """Whether a variable is one whole number, or the number of an item."""
    return v.type in ("Integer", "Int32", "Enumeration") and not v.dimensions


def settable(v: Any) -> bool:
    """Whether a variable takes a start value."""
    return v.variability != "constant" and (v.causality == "input" or v.initial in ("exact", "approx"))


def describe(path: Path) -> Described:
    """The description of an FMU that this machine can play.

    Raises:
        FmuError: the file is no FMU for co-simulation of FMI 2.0 or 3.0, holds no binary for this machine, or what
            cannot be unpacked safely
    """
    try:
        with zipfile.ZipFile(reading(path)) as file:
            check(path, file)
            root = ET.fromstring(file.read("modelDescription.xml"))
            folders = {name.split("/")[1] for name in file.namelist() if name.startswith("binaries/")}
        version = root.get("fmiVersion", "")
        if version != "2.0" and not version.startswith("3."):
            raise FmuError(
                f"{path}: this FMU is for FMI {version}. Only co-simulation of FMI 2.0 and 3.0 can be played."
            )
        description = fmpy.read_model_description(str(path), validate=False)
        of_2 = version == "2.0"
        own, held = (fmpy.platform, fmpy.supported_platforms(str(path))) if of_2 else (fmpy.platform_tuple, folders)
        web = not of_2 and own not in held and MODULE in held
    except FmuError:
        raise
    except FileNotFoundError:
        raise FmuError(f"{path}: there is no such file.") from None
    except IsADirectoryError:
        raise FmuError(f"{path}: is a folder. Give an FMU.") from None
    except Exception as error:  # zip, XML and FMPy errors alike: the file is no FMU
        raise FmuError(f"{path}: this file is no FMU ({error}).") from error
    if problem := _unplayable(description, MODULE if web else own, sorted(held)):
        raise FmuError(f"{path}: {problem}")
    return Described(path, description, {v.name: v for v in description.modelVariables}, _differences(root), web)


def _unplayable(description: Any, here: str, held: Sequence[str]) -> str:
    """Why an FMU cannot be played on the platform `here`; "" if it can."""
    simulation = description.coSimulation
    if simulation is None:
        return "this FMU has no co-simulation. Only co-simulation of FMI 2.0 and 3.0 can be played."
    if simulation.needsExecutionTool:
        tool = description.generationTool or "the tool that made it"
        return f"this FMU runs only beside {tool}. Export it as one that stands alone."
    if here not in held:
        binaries = ", ".join(p for p in held if p != "c-code") or "no platform"
        own = (description.generationTool or "").startswith("gearheat")
        remedy = f"Export it with --platform {here}." if own else "Ask its maker for one."
        return f"this FMU holds binaries for {binaries}, none for this machine ({here}).\n{remedy}"
    return ""


def _differences(root: ET.Element) -> frozenset[str]:
    """Names of the variables that are marked as relative quantities, or whose type is; FMPy passes the mark over."""
    types = {t.get("name") for t, real in _reals(root, "TypeDefinitions", "SimpleType", "Float64Type") if _marks(real)}
    variables = _reals(root, "ModelVariables", "ScalarVariable", "Float64")
    return frozenset(str(v.get("name")) for v, r in variables if _marks(r) or r.get("declaredType") in types)


def _reals(root: ET.Element, group: str, of_2: str, of_3: str) -> Iterator[tuple[ET.Element, ET.Element]]:
    """Elements of a group that are real numbers, and the element with their attributes, which 2.0 puts inside."""
    for element in root.iterfind(f"{group}/{of_2}"):
        if (real := element.find("Real")) is not None:
            yield element, real
    for element in root.iterfind(f"{group}/{of_3}"):
        yield element, element


def _marks(real: ET.Element) -> bool:
    return real.get("relativeQuantity") in ("true", "1")


def _read_bound(v: Any, declared: Any, key: str, otherwise: float) -> float:
    """Lowest or highest value, of the variable or of its type."""
    texts = (getattr(v, key, None), getattr(declared, key, None))
    return float(next((text for text in texts if text is not None), otherwise))
