"""Film maps as files: a table of solved contacts, read strictly and fitted by a smooth law. Same table, same law."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np

from ..model.errors import DataError
from ..model.files import tables
from ..model.laws.film_map import FilmMap, Fit, products
from .csv_table import Column, Table, parse, raise_all

#: How a rig file says that a film comes from a map.
PREFIX = "map:"
#: Highest sum of the degrees of the three polynomials; less where there are fewer contacts than terms.
DEGREE = 4

#: Fewest contacts of a map.
FEWEST = 4

#: The columns of a map. Values of the contact itself are the same in all rows.
COLUMNS = tuple(Column(name, **about) for name, about in tables("scenarios", "film_map.toml").items())
#: Columns of what a contact is, which do not change over a map.
CONSTANT = ("R_x [m]", "R_y [m]", "length [m]", "E_eff [Pa]", "slide_roll [1]")
#: Status of a row with a film.
OK = "ok"
#: Status of a row for which no film was found.
FAILED = "failed"


@dataclass(frozen=True)
class FittedMap:
    """A law and the points it was fitted to: how many, how many without a film, and its mean square errors."""

    law: FilmMap
    points: int
    failed: int
    rms: dict[str, float]


def read_film_map(path: Path, name: str = "") -> FittedMap:
    """The law of the map in a file.

    Args:
        path: the CSV file
        name: as a rig file writes it; the file's own if empty

    Raises:
        DataError: all that is wrong with the file at once; too few contacts
    """
    table, problems = parse(path, COLUMNS)
    rows = _find_solved(table, problems)
    raise_all(problems, path.name)
    if not rows:
        raise DataError(f"{path.name}: 0 contacts with a film. Solve other loads, speeds or temperatures.")
    values = {c: np.array(table.columns[c], dtype=float)[rows] for c in table.columns if c != "status"}
    for column in CONSTANT:
        held = values.get(column, np.array([np.nan]))
        if len(distinct(held)) > 1:
            problems.append(
                f"{path.name}: {column} changes from {held.min():g} to {held.max():g}. A map is of one contact: "
                "make one file for each."
            )
    raise_all(problems, path.name)
    R = float(values["R_x [m]"][0])
    across = float(values["R_y [m]"][0]) if "R_y [m]" in values else np.nan
    line = bool(np.isnan(across))
    area = float(values["length [m]"][0]) * R if line else R**2
    points = np.column_stack([values["F [N]"] / area, values["u_m [m/s]"] / R, values["eta_0 [Pa.s]"]])
    ranges = tuple((float(column.min()), float(column.max())) for column in points.T)
    levels = [len(distinct(column)) for column in points.T]
    degrees = next((d for n in range(DEGREE, 0, -1) if len(d := _degrees(levels, n)) <= len(points)), ())
    if len(points) < FEWEST or len(degrees) < 2:
        raise DataError(
            f"{name or path.name}: {len(points)} contacts with a film are too few for a law. "
            f"Solve at least {FEWEST} loads, speeds or temperatures."
        )
    z = np.column_stack([_place(column, *limits) for column, limits in zip(points.T, ranges, strict=True)])
    basis = np.column_stack([np.broadcast_to(b, len(z)) for b in products(list(z.T), degrees)])
    rms: dict[str, float] = {}

    def fit(key: str) -> Fit:
        wanted = np.log(values[f"{key} [m]"] / R)
        coefficients = np.linalg.lstsq(basis, wanted, rcond=None)[0]
        error = np.expm1(basis @ coefficients - wanted)
        rms[key] = float(np.sqrt(np.mean(error**2)))
        return Fit(tuple(float(c) for c in coefficients), float(np.abs(error).max()))

    law = FilmMap(
        name=name or path.name,
        file=str(path.resolve()),
        shape="line" if line else "ellipse",
        ranges=ranges,
        degrees=degrees,
        central=fit("h_c"),
        minimum=fit("h_min"),
        E_eff=float(values["E_eff [Pa]"][0]),
        R_ratio=0.0 if line else across / R,
    )
    return FittedMap(law, len(points), len(table.lines) - len(rows), rms)


def distinct(values: np.ndarray) -> np.ndarray:
    """Values that differ by more than what is lost in writing them; none for a column that is empty."""
    known = np.unique(values[~np.isnan(values)])
    return known[np.append(True, np.diff(known) > 1e-6 * np.abs(known[1:]))] if len(known) else known


def _find_solved(table: Table, problems: list[str]) -> list[int]:
    """Rows that hold a film; a row that says so and does not is a problem."""
    if any(column not in table.columns for column in ("status", "h_c [m]", "h_min [m]")):
        problems += [
            f'{table.name} line 1: column "{c}" is missing. Make the map with `gearheat film`.'
            for c in ("h_c [m]", "h_min [m]")
            if c not in table.columns
        ]
        return []
    rows = []
    for i, status in enumerate(table.columns["status"]):
        if status != OK:
            continue
        films = {c: table.columns[c][i] for c in ("h_c [m]", "h_min [m]")}
        bad = [c for c, film in films.items() if not (film is None or film > 0)]  # of None was told already
        problems += [f'{table.place(i)}: {c} has no film, but status is "{OK}".' for c in bad]
        rows += [] if bad else [i]
    return rows


def _degrees(levels: Sequence[int], highest: int) -> tuple[tuple[int, int, int], ...]:
    """Degrees of the three polynomials of each product that so many values of each variable determine."""
    ranges = (range(min(n, highest + 1)) for n in levels)
    return tuple((i, j, k) for i, j, k in product(*ranges) if i + j + k <= highest)


def _place(line: np.ndarray, low: float, high: float) -> np.ndarray:
    """Places of the logarithms of values in their range, -1 to 1."""
    if not high > low * (1 + 1e-9):
        return np.zeros(len(line))
    return np.asarray((2 * np.log(line) - np.log(low) - np.log(high)) / np.log(high / low))


def find_map(text: str, folder: Path) -> FilmMap:
    """The law that a rig file names.

    Args:
        text: "map:FILE", the file beside the rig file or with a place of its own
        folder: of the rig file

    Raises:
        DataError: all that is wrong with the file
    """
    written = text.removeprefix(PREFIX).strip()
    return read_film_map(folder / written, f"{PREFIX}{written}").law


def names_map(value: object) -> bool:
    """Whether a value of a rig file names a film map."""
    return isinstance(value, str) and value.startswith(PREFIX)
