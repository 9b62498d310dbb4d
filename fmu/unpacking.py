"""What is done with an FMU before its code runs: is it safe to unpack, and was it made here."""

from __future__ import annotations

import hashlib
import stat
import zipfile
from contextlib import suppress
from pathlib import Path, PurePosixPath, PureWindowsPath

from ..model.errors import FmuError
from .compiling import cache_folder, store

#: Bytes that an FMU may unpack to: far above any FMU known, far below what fills a disk.
MOST_BYTES = 1 << 30
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
    """Note that an FMU of this content was made here.

    Args:
        content: of the file
    """
    with suppress(FmuError):  # without a cache it is asked for `--trust`
        store(_note(hashlib.sha256(content).hexdigest()), b"")


def is_trusted(path: Path) -> bool:
    """Whether an FMU was made by gearheat on this machine.

    Args:
        path: of the FMU
    """
    with path.open("rb") as file:
        return _note(hashlib.file_digest(file, "sha256").hexdigest()).is_file()


def _note(digest: str) -> Path:
    return cache_folder() / "made" / digest
