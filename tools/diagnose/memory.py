"""What a long diagnosis has already computed, kept on disk until it is done: an interrupted one goes on from there."""

from __future__ import annotations

import hashlib
import io
import sqlite3
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from ...fmu.compiling import cache_folder

#: Files of diagnoses that nobody went on with are removed after so many days.
DAYS = 14


class Memory:
    """Arrays by what they were computed from; `made` were kept now, `reused` earlier. Without a file it keeps nothing.

    Args:
        path: file to keep them in, made if need be; a file that cannot be used is done without
    """

    def __init__(self, path: Path | None = None) -> None:
        self.path, self.reused, self.made = path, 0, 0
        self._own: set[str] = set()
        self._base: sqlite3.Connection | None = None
        if path is None:
            return
        with suppress(sqlite3.Error, OSError):
            path.parent.mkdir(parents=True, exist_ok=True)
            self._base = sqlite3.connect(path, timeout=10.0, isolation_level=None)
            self._base.execute("PRAGMA synchronous = OFF")
            self._base.execute("CREATE TABLE IF NOT EXISTS kept (key TEXT PRIMARY KEY, arrays BLOB)")

    def kept(self, what: Any, compute: Callable[[], Mapping[str, np.ndarray]]) -> dict[str, np.ndarray]:
        """The arrays that were computed from the same, or else those computed now.

        Args:
            what: all that the arrays depend on: numbers, texts, arrays, and sequences and mappings of them
            compute: makes the arrays
        """
        if self._base is None:
            return dict(compute())
        key = fingerprint(what)
        with suppress(sqlite3.Error, ValueError, OSError, EOFError):
            row = self._base.execute("SELECT arrays FROM kept WHERE key = ?", (key,)).fetchone()
            if row is not None:
                with np.load(io.BytesIO(row[0]), allow_pickle=False) as arrays:
                    found = {name: arrays[name] for name in arrays.files}
                self.reused += key not in self._own
                return found
        made = dict(compute())
        text = io.BytesIO()
        np.savez(text, allow_pickle=False, **made)
        with suppress(sqlite3.Error):
            self._base.execute("INSERT OR REPLACE INTO kept VALUES (?, ?)", (key, text.getvalue()))
            self.made += 1
            self._own.add(key)
        return made

    def forget(self) -> None:
        """Close and remove the file: the work is done."""
        if self._base is not None:
            self._base.close()
            self._base = None
        if self.path is not None:
            with suppress(OSError):
                self.path.unlink(missing_ok=True)


def memory_of(digest: str, *settings: float) -> Memory:
    """The memory of one diagnosis in the user's cache folder; another version of the program has another.

    Args:
        digest: hash of its inputs
        settings: numbers that it depends on as well
    """
    folder = cache_folder() / "diagnose"
    with suppress(OSError):
        for old in folder.glob("*.kept"):
            if time.time() - old.stat().st_mtime > DAYS * 86400.0:
                old.unlink(missing_ok=True)
    return Memory(folder / f"{fingerprint((digest, _program(), settings))[:32]}.kept")


def fingerprint(what: Any) -> str:
    """Hash of numbers, texts, arrays, and sequences and mappings of them."""
    digest = hashlib.sha256()
    _feed(digest, what)
    return digest.hexdigest()


def _feed(digest: Any, what: Any) -> None:
    if isinstance(what, np.ndarray):
        digest.update(f"array {what.dtype} {what.shape} ".encode() + np.ascontiguousarray(what).tobytes())
    elif isinstance(what, Mapping):
        digest.update(f"mapping {len(what)} ".encode())
        for key in sorted(what):
            _feed(digest, key)
            _feed(digest, what[key])
    elif isinstance(what, Sequence) and not isinstance(what, str | bytes):
        digest.update(f"sequence {len(what)} ".encode())
        for item in what:
            _feed(digest, item)
    else:
        digest.update(f"{type(what).__name__} {what!r} ".encode())


@cache
def _program() -> str:
    """Hash of the program's own files."""
    digest = hashlib.sha256()
    for package in ("model", "fmu", "scenarios", "tools"):
        root = Path(str(files(f"gearheat.{package}").joinpath("")))
        for path in sorted(p for p in root.rglob("*") if p.suffix in (".py", ".toml", ".c", ".h")):
            digest.update(path.relative_to(root).as_posix().encode() + path.read_bytes())
    return digest.hexdigest()
