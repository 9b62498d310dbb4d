"""Files that are whole or not there at all, and never written over what a command reads; tables that packages ship."""

from __future__ import annotations

import errno
import os
import re
import shutil
import sys
import tempfile
import time
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from glob import escape
from importlib.resources import files
from pathlib import Path
from typing import Any

#: [s].
DAY = 86400.0
#: Files of this process that are not yet in their place.
_UNFINISHED: set[str] = set()
#: Names that systems give the streams of a process.
_STREAMS = {"/dev/stdout": 1, "/dev/stderr": 2}
_DESCRIPTOR = re.compile(r"/(?:dev|proc/self)/fd/(\d+)")

#: Whether the command has read a file, by device and number, or made it; none outside a command.
_KNOWN: ContextVar[dict[tuple[int, int], bool] | None] = ContextVar("_KNOWN", default=None)


def tables(package: str, *path: str) -> dict[str, Any]:
    """The tables of a TOML file that a package ships.

    Args:
        package: below `gearheat`
        path: of the file in it
    """
    return tomllib.loads(files(f"gearheat.{package}").joinpath(*path).read_text(encoding="utf-8"))


@contextmanager
def keep_inputs() -> Iterator[None]:
    """Within the block, what `reading` is told of cannot be written over."""
    token = _KNOWN.set({})
    try:
        yield
    finally:
        _KNOWN.reset(token)


def reading(path: Path) -> Path:
    """The path of a file that is about to be read."""
    _note(path, read=True)
    return path


def _note(path: Path, *, read: bool) -> None:
    """A file as read or made by the command, whichever came first."""
    known = _KNOWN.get()
    if known is not None and path.is_file():
        known.setdefault(_identity(path), read)


def place(path: Path) -> Path:
    """Where output that is called `path` goes: the file behind a link, never one that the command reads.

    Raises:
        IsADirectoryError: it is a folder
        FileExistsError: the command reads it
    """
    path = Path(os.path.realpath(path)) if path.is_symlink() and _descriptor(path) is None else path
    if path.is_dir():
        raise IsADirectoryError(errno.EISDIR, "it is a folder")
    if path.is_file() and (_KNOWN.get() or {}).get(_identity(path)):
        raise FileExistsError(errno.EEXIST, "it is read by this command")
    return path


def flows(path: Path) -> bool:
    """Whether what is written there goes through: a pipe, a device, a stream of this process wherever it leads."""
    return _descriptor(path) is not None or (path.exists() and not path.is_file())


def _descriptor(path: Path) -> int | None:
    found = _DESCRIPTOR.fullmatch(name := str(path))
    return int(found[1]) if found else _STREAMS.get(name)


def _identity(path: Path) -> tuple[int, int]:
    found = path.stat()
    return found.st_dev, found.st_ino


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A file beside a place, to be written within the block: it moves there at the end, and is removed after an error.

    What a pipe or a device is given, such as /dev/stdout, goes through it.

    Args:
        path: the place; its folder exists

    Raises:
        OSError: the folder cannot be written to, or the command reads that file
    """
    path = place(path)
    through = flows(path)
    if not through:
        _collect(path)
    handle, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=None if through else path.parent)
    os.close(handle)
    _UNFINISHED.add(name)
    _note(Path(name), read=False)
    try:
        yield Path(name)
        if through:
            sys.stdout.flush()
            stream = _descriptor(path)  # opened by its name, a file behind it would begin anew
            with open(name, "rb") as whole, open(path if stream is None else os.dup(stream), "wb") as end:
                shutil.copyfileobj(whole, end)
            return
        mask = os.umask(0)  # the only way to ask for it
        os.umask(mask)
        os.chmod(name, 0o666 & ~mask)
        os.replace(name, path)
    finally:
        Path(name).unlink(missing_ok=True)
        _UNFINISHED.discard(name)


def remove_unfinished() -> None:
    """Remove the files of this process that are not yet in their place: it ends at once."""
    for name in tuple(_UNFINISHED):
        with suppress(OSError):
            os.unlink(name)


def _collect(path: Path) -> None:
    """Remove what processes that were killed more than a day ago have left beside a place."""
    for left in path.parent.glob(f".{escape(path.name)}.????????"):
        with suppress(OSError):
            if left.is_file() and time.time() - left.stat().st_mtime > DAY:
                left.unlink()
