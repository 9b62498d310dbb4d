"""Names of files whose endings say another kind of file than is written."""

from __future__ import annotations

from pathlib import Path

from ...model.errors import DataError

#: Endings of names of files by what is written.
ENDINGS = {
    "a table": (".csv", ".txt", ".dat", ""),
    "an FMU": (".fmu", ".ssp", ".zip"),  # importers go by the ending
    "a system of FMUs": (".ssp", ".zip"),
    "a page": (".html", ".htm", ""),
    "a schema": (".json", ""),
    "JSON": (".json", ""),
    "a rig file": (".toml", ""),
}
#: Endings that tell another kind of file than these.
KNOWN = frozenset(
    [
        ".csv",
        ".txt",
        ".xlsx",
        ".ods",
        ".parquet",
        ".json",
        ".toml",
        ".fmu",
        ".ssp",
        ".html",
        ".svg",
        ".png",
        ".pdf",
        ".md",
        ".py",
        ".gz",
        ".zip",
    ]
)


def fitting(path: Path | None, kind: str, option: str = "-o") -> None:
    """Refuse a name that says another kind of file than is written, or none where one has to be said.

    Args:
        path: where it goes
        kind: what is written, a key of `ENDINGS`
        option: that names it

    Raises:
        DataError: its ending is that of something else
    """
    if path is None or (ending := path.suffix.lower()) in ENDINGS[kind]:
        return
    if ending in KNOWN or "" not in ENDINGS[kind]:
        other = f", and {ending} is something else" if ending else ""
        raise DataError(f"{option} {path}: {kind} is written{other}. Name it *{ENDINGS[kind][0]}.")
