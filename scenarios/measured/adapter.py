"""Campaigns that others published, as they can be downloaded: a table says how their files become tables of a rig.

A table of `scenarios/campaigns` names files and columns, says what a rig's columns are in terms of them, which rows
count, and which of them are one case with its healthy reference. Nothing is downloaded, and no file is changed.
"""

from __future__ import annotations

import csv
import gzip
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import IO, Any

import numpy as np

from ...model.errors import DataError, Problems, ScenarioError, suggestion
from ...model.files import reading
from ..csv_table import raise_all
from ..document import read_toml
from ..shipped import ROOT

#: Folder of the tables.
FOLDER = ROOT / "campaigns"
#: What is no reading.
EMPTY = ("", "nan", "null", "none")
#: Columns that are no numbers.
TEXTS = ("time", "machine")

Columns = dict[str, np.ndarray]


@dataclass(frozen=True)
class Case:
    """What is asked of a campaign.

    Args:
        name: of the case
        asked: rows in question
        reference: the same machine's when healthy; empty where none is known, and the rig file says what is healthy
        siblings: healthy rows of other machines of its type
    """

    name: str
    asked: Columns
    reference: Columns
    siblings: tuple[Columns, ...] = ()


@dataclass(frozen=True)
class Adapter:
    """A table of `scenarios/campaigns` by its name."""

    name: str
    table: Mapping[str, Any]

    @property
    def logs(self) -> bool:
        """Whether its rows are samples of logs, and no readings of settled states."""
        return "readings" not in self.table

    @property
    def rig(self) -> str | Path:
        """Name of the shipped rig, or the rig file that stands beside the table."""
        rig = str(self.table["rig"])
        return FOLDER / rig if rig.endswith(".toml") else rig

    def cases(self, folder: Path, only: str = "") -> list[Case]:
        """The cases of a folder with the downloaded files.

        Args:
            folder: with the files, at any depth
            only: name of one case

        Raises:
            DataError: files or columns are missing, or no row is left, all at once
        """
        rows = self.read(folder)
        found = [case for entry in self.table["cases"] for case in self._cases(entry, rows)]
        kept = [case for case in found if only in ("", case.name)]
        if not kept:
            names = ", ".join(case.name for case in found)
            raise DataError(f"{self.name}: there is no case {only!r} in {folder}. Cases: {names or 'none'}.")
        return kept

    def read(self, folder: Path) -> Columns:
        """All rows that count, by the short names of the table.

        Args:
            folder: with the files, at any depth

        Raises:
            DataError: files or columns are missing, all at once
        """
        problems = Problems()
        paths = list(self._files(folder, problems))
        parts = [part for path in paths if (part := self._rows(path, problems)) is not None]
        raise_all(problems, str(folder))
        rows = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
        rows |= {name: _value(text, rows) for name, text in self.table.get("derives", {}).items()}
        order = np.lexsort([rows[name] for name in ("time", "machine") if name in rows])
        return _where(self.table.get("keep", ""), {name: column[order] for name, column in rows.items()})

    def written(self, rows: Columns, entry: Mapping[str, Any]) -> Columns:
        """Rows as the rig's tables have them.

        Args:
            rows: by the short names of the table
            entry: the case; it may have columns and a grouping of its own
        """
        writes = {**self.table["writes"], **entry.get("writes", {})}
        columns = {name: _value(text, rows) for name, text in writes.items()}
        if self.logs:
            return {("time_s" if rows["time"].dtype.kind == "f" else "time_utc"): rows["time"], **columns}
        return _means(columns, rows, {**self.table["readings"], **entry.get("readings", {})})

    def _files(self, folder: Path, problems: Problems) -> Iterator[Path]:
        low, high = self.table["size_MB"]
        for pattern in self.table["files"]:
            found = sorted({path for one in pattern.split(" or ") for path in folder.rglob(one)})
            if not found:
                problems.append(f"{folder}: there is no file {pattern}. {self.table['get']}")
                continue
            if not low <= (size := sum(path.stat().st_size for path in found) / 1e6) <= high:
                problems.append(
                    f"{folder}: the files {pattern} have {size:.3g} MB together, expected {low:g} to {high:g}."
                    " Unpack all of them, and nothing else."
                )
            yield from found

    def _rows(self, path: Path, problems: Problems) -> Columns | None:
        """What the table reads of a file, None where columns are missing."""
        reads: Mapping[str, str] = self.table["reads"]
        with _open(path) as file:
            reader, header = self._header(file)
            meant = {h.strip(): k for k, h in enumerate(header)}
            missing = [column for column in reads.values() if column not in meant]
            for column in missing:
                close = suggestion(column, meant.keys() - set(reads.values()))
                problems.append(f'{path.name}: there is no column "{column}", which is expected.{close}')
            if missing:
                return None
            cells = [[row[meant[column]] for column in reads.values()] for row in reader if len(row) == len(header)]
        if not cells:
            problems.append(f"{path.name}: holds no row of {len(header)} cells.")
            return None
        columns = dict(zip(reads, zip(*cells, strict=True), strict=True))
        found = {name: _column(name, column, path.name, problems) for name, column in columns.items()}
        if match := re.search(self.table.get("minutes", "$^"), path.name):  # a file a minute: its mean
            found = {name: np.atleast_1d(np.nanmean(column)) for name, column in found.items()}
            found["time"] = np.array([60.0 * int(match[1])])
        if match := re.search(self.table.get("machine", "$^"), path.as_posix()):
            found["machine"] = np.full(_length(found), match[1])
        return found

    def _header(self, file: IO[str]) -> tuple[Iterator[list[str]], list[str]]:
        """The rows under the names of the columns, and these: given, in the first line or in the last comment."""
        in_comment = self.table.get("names_in") == "comment"
        last, first = "", file.readline()
        while first.startswith("#"):
            last, first = first, file.readline()
        line = last.lstrip("# ") if in_comment else first
        delimiter = ";" if line.count(";") > line.count(",") else ","
        names = self.table.get("columns") or next(csv.reader([line], delimiter=delimiter))
        ahead = [first] if in_comment or "columns" in self.table else []
        rows = csv.reader(_chain(ahead, file), delimiter=delimiter)
        return ([cell.replace(",", ".") for cell in row] if delimiter == ";" else row for row in rows), list(names)

    def _cases(self, entry: Mapping[str, Any], rows: Columns) -> Iterator[Case]:
        """One case of an entry, or one for all that its columns `each` hold; {0} in it is the first of these."""
        names = entry.get("each", "").split()
        for values in sorted(set(zip(*(rows[name].tolist() for name in names), strict=True))) if names else [()]:
            conditions = ("asked", "reference", "siblings")  # values as literals: no text of a file is code
            said = {key: entry[key].format(*map(repr, values)) for key in conditions if key in entry}
            asked, reference = _where(said["asked"], rows), _where(said.get("reference", "False"), rows)
            if not _length(asked) or ("reference" in said and not _length(reference)):
                continue
            healthy = _where(said["siblings"], rows) if "siblings" in said else None
            others = sorted(set(healthy["machine"]) - set(asked["machine"])) if healthy else []
            parts = [asked, reference, *(_where(f"machine == {str(m)!r}", healthy or {}) for m in others)]
            first, second, *rest = (self.written(part, entry) if _length(part) else {} for part in parts)
            yield Case(entry["name"].format(*values), first, second, tuple(rest))


def adapter(name: str) -> Adapter:
    """The table of a campaign.

    Args:
        name: of the campaign

    Raises:
        ScenarioError: there is none of that name
    """
    known = tables()
    if name not in known:
        close = suggestion(name, known) or f" Campaigns: {', '.join(known)}."
        raise ScenarioError(f'campaign: there is no campaign "{name}".{close}')
    return Adapter(name, known[name])


@cache
def tables() -> Mapping[str, Mapping[str, Any]]:
    """All tables by name."""
    return {path.stem: read_toml(path) for path in sorted(FOLDER.glob("*.toml"))}


def write_csv(path: Path, columns: Columns) -> None:
    """Rows as a table that commands read; rows in which a number is missing keep an empty cell.

    Args:
        path: the file
        columns: by name
    """
    with path.open("w", encoding="utf-8", newline="") as file:
        out = csv.writer(file)
        out.writerow(columns)
        out.writerows(zip(*([_cell(v) for v in column] for column in columns.values()), strict=True))


def _cell(value: Any) -> str:
    if isinstance(value, str):
        return value
    return f"{value:.6g}" if math.isfinite(value) else ""


def _chain(ahead: Sequence[str], file: IO[str]) -> Iterator[str]:
    yield from ahead
    yield from file


def _open(path: Path) -> IO[str]:
    opened = gzip.open if reading(path).suffix == ".gz" else open
    return opened(path, "rt", encoding="utf-8-sig", newline="")


def _column(name: str, cells: Sequence[str], file: str, problems: Problems) -> np.ndarray:
    """Cells as texts or numbers, NaN where one is empty."""
    if name in TEXTS and not all(map(_is_number, cells)):
        return np.array(cells)
    try:
        return np.array([math.nan if c.strip().lower() in EMPTY else float(c) for c in cells])
    except ValueError as error:
        problems.append(f"{file}: a cell of column {name} is no number ({error}).")
        return np.full(len(cells), np.nan)


def _is_number(cell: str) -> bool:
    try:
        return math.isfinite(float(cell))
    except ValueError:
        return False


def _value(text: str, rows: Columns) -> np.ndarray:
    """An expression of a table over its rows."""
    with np.errstate(all="ignore"):
        found = np.asarray(eval(text, {"__builtins__": {}}, dict(rows)))
    return np.broadcast_to(found, _length(rows))


def _length(rows: Columns) -> int:
    return len(next(iter(rows.values())))


def _where(text: str, rows: Columns) -> Columns:
    """The rows in which an expression of a table is true, all where it is empty."""
    if not text:
        return rows
    keep = _value(text, rows).astype(bool)
    return {name: column[keep] for name, column in rows.items()}


def _means(columns: Columns, rows: Columns, said: Mapping[str, Any]) -> Columns:
    """Means over the stretches in which all columns of `by` stay, with at least `least` rows each behind `skip`."""
    key = np.stack([rows[name] for name in said["by"]])
    cuts = np.flatnonzero(np.any(key[:, 1:] != key[:, :-1], axis=0)) + 1
    settled = (g[said.get("skip", 0) :] for g in np.split(np.arange(key.shape[1]), cuts))
    groups = [g for g in settled if len(g) >= said["least"]]
    means = {name: np.array([np.nanmean(column[g]) for g in groups]) for name, column in columns.items()}
    return {"point": np.arange(1.0, len(groups) + 1), **means}
