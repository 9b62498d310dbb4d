"""Films of one contact over load, speed and temperature in a table, and the law fitted to it."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import replace
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from ...model.contact import Contact, Lubricant, solve
from ...model.errors import Problems, ScenarioError, SolveError
from ...model.laws.film import asperity_share, mixed_friction
from ...model.laws.film_line import line_film_central
from ...model.laws.film_point import point_film_central
from ...model.units import from_si, show_unit
from ...scenarios.film_map import COLUMNS, FAILED, OK, read_film_map
from ...scenarios.load import load
from ..show.columns import rows_text
from ..show.console import counting, note, writable, write
from ..show.display import Answer
from ..show.picture import Picture
from ..solve.settings import adjust
from ..solve.sweep_rows import Store, work_file
from .case import AXES, MapCase, from_file, from_rig

#: Points along load, speed and temperature.
POINTS = {"F": 6, "u_m": 6, "T": 4}
#: Nodes of a line contact.
NODES_LINE = 201
#: Nodes along a side of an elliptical contact.
NODES_SIDE = 129
#: Numbers kept of each point: films, friction, share on asperities, pressure, and whether there is a solution.
KEPT = ("h_c", "h_min", "mu_fluid", "share", "p_max", "found")
#: Status of a point without a film.
LOST = 0.0
#: Status of a point with a film.
FOUND = 1.0
#: Status of a point whose grid is too coarse.
COARSE = 2.0
#: Largest error of a film on a grid, relative; above it the grid is too coarse.
ROUGHEST = 0.1
#: Fewest nodes along a side of an elliptical contact.
FINER = 65
#: What the table and a person are told of a point without a film.
WRONG = {LOST: (FAILED, "no film found"), COARSE: ("coarse", "the grid is too coarse; give more --nodes")}


class FilmTable(Answer):
    """Films of a contact over load, speed and temperature, and the law fitted to them; the table is what is varied."""


def film(
    rig: str | Path,
    out: str | Path,
    *,
    part: str | None = None,
    vary: Sequence[str] = (),
    grid: str | None = None,
    nodes: int | None = None,
    plot: str | Path | None = None,
    set: Sequence[str] = (),
) -> FilmTable:
    """Solve a lubricated contact over load, speed and temperature; fit the film law that parts can use.

    What an earlier run has not finished is solved, the table is written, and the law is fitted to it.

    Args:
        rig: name of a shipped rig, rig file, or TOML file of one contact
        out: CSV file to write
        part: part of the rig whose contact it is
        vary: ranges of F, u_m or T, such as "F=100..2000 N"
        grid: points along each axis that is varied, such as "6x6x4"
        nodes: of the contact solver, along a side
        plot: picture to write, .png or .svg
        set: texts "NAME=VALUE"

    Raises:
        GearheatError: all that is wrong with what is asked

    Example:
        >>> import gearheat as gh
        >>> gh.film("planetary", "film.csv", part="gear_set")  # doctest: +SKIP
    """
    out, drawn = Path(out), None if plot is None else Path(plot)
    writable(out, drawn)
    Problems(
        f"{option} {path}: unknown kind of file. Its name must end in {' or '.join(kinds)}."
        for option, path, kinds in (("-o", out, (".csv",)), ("--plot", drawn, (".png", ".svg")))
        if path is not None and path.suffix not in kinds
    ).check()
    case = case_of(rig, part, vary, set)
    points = _grid_of(case, grid)
    count = nodes or (NODES_LINE if _is_line(case.contact) else NODES_SIDE)
    if not _is_line(case.contact) and (count < FINER or (count - 1) & (count - 2)):
        raise ScenarioError(
            f"--nodes {count}: give 2^k + 1, at least {FINER}: a film is compared with that on half of them."
        )
    kept = _solve_points(case, points, count, out)
    write(out, _table_of(case, points, kept))
    wrong = [(p, k[-1]) for p, k in zip(points, kept, strict=True) if k[-1] != FOUND]
    failed = [f"{_name_point(case, point)}: {WRONG[status][1]}" for point, status in wrong]
    fitted = read_film_map(out)
    if drawn is not None:
        from ..show.drawing import write_picture

        write_picture(drawn, _picture(case, points, kept))
    law, units = fitted.law, {name: quantity.unit for name, quantity in AXES.items()}
    found: dict[str, Any] = {
        "schema": "gearheat.film/1",
        "case": case.name,
        "part": case.part,
        "out": str(out),
        "shape": law.shape,
        "contacts": fitted.points + fitted.failed,
        "failed": failed,
        "varied": {
            a.name: {
                "low": from_si(a.first, units[a.name]),
                "high": from_si(a.second, units[a.name]),
                "unit": show_unit(units[a.name]),
            }
            for a in case.axes
        },
        "terms": len(law.degrees),
        "fit": {
            k: {"largest": f.error, "rms": fitted.rms[k]} for k, f in (("h_c", law.central), ("h_min", law.minimum))
        },
        "plot": None if drawn is None else str(drawn),
    }
    of = f"{case.name}: {case.part}" if case.part else case.name
    heading = f"{of}: {found['contacts']} {law.shape} contacts"
    varied = [(name, *ends.values()) for name, ends in found["varied"].items()]
    return FilmTable(found, heading=heading, shown=(("varied", "low", "high", "unit"), varied))


def case_of(
    rig: str | Path, part: str | None = None, vary: Sequence[str] = (), assignments: Sequence[str] = ()
) -> MapCase:
    """The contact of a case file, or of a part of a rig.

    Args:
        rig: name of a shipped rig, rig file, or TOML file of one contact
        part: part of the rig whose contact it is
        vary: ranges such as "F=100..2000 N"
        assignments: texts "NAME=VALUE"

    Raises:
        GearheatError: all that is wrong with it
    """
    path = Path(rig)
    if path.suffix == ".toml" and path.is_file() and "[contact]" in path.read_text(encoding="utf-8", errors="replace"):
        if part is not None or assignments:
            raise ScenarioError(f"{path.name}: --part and --set belong to a rig. Leave them out.")
        return from_file(path, vary)
    return from_rig(adjust(load(rig), assignments), part, vary)


def _grid_of(case: MapCase, written: str | None) -> np.ndarray:
    """Load, speed and temperature of each point (n, 3): equal ratios of load and speed, equal steps of temperature."""
    names = [axis.name for axis in case.axes]
    counts = [POINTS[name] for name in names]
    if written is not None:
        cells = written.lower().split("x")
        if len(cells) != len(names) or not all(c.strip().isdecimal() and int(c) > 1 for c in cells):
            raise ScenarioError(
                f"--grid {written}: does not fit {', '.join(names)}. "
                f'Write {len(names)} whole numbers above 1, for example "{"x".join(map(str, counts))}".'
            )
        counts = [int(c) for c in cells]
    spaced = {
        a.name: (np.linspace if a.name == "T" else np.geomspace)(a.first, a.second, n)
        for a, n in zip(case.axes, counts, strict=True)
    }
    lines = [spaced.get(name, np.array([case.fixed.get(name, 0.0)])) for name in AXES]
    return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, len(lines))


def contact_at(case: MapCase, point: np.ndarray) -> Contact:
    """The contact at a point of the map.

    Args:
        case: the contact and its oil
        point: load [N], mean speed [m/s], temperature [K]
    """
    F, u_m, T = (float(v) for v in point)
    eta_0, alpha_p = case.oil(T)
    oil: Lubricant = replace(case.contact.lubricant, eta_0=eta_0, alpha_p=alpha_p)
    slide = case.slide_roll / 2
    return replace(case.contact, F=F, u_1=u_m * (1 + slide), u_2=u_m * (1 - slide), lubricant=oil)


def _solve_points(case: MapCase, points: np.ndarray, nodes: int, out: Path) -> np.ndarray:
    """What is kept of each point (n, KEPT): a run that was interrupted goes on from the points it has finished."""
    contacts = [contact_at(case, point) for point in points]
    key = hashlib.sha256(repr((contacts, nodes)).encode()).hexdigest()
    with Store(work_file(out), key, len(KEPT)) as store:
        left = [i for i in range(len(points)) if i not in store.places]
        if len(left) < len(points):
            note(f"{len(points) - len(left)} of {len(points)} contacts were solved before: {store.path}")
        with counting("contacts", len(points), len(points) - len(left)) as advance:
            for i in left:
                store.put(i, np.array([_solution(contacts[i], nodes)]))
                advance(1)
        found = np.concatenate([store.get(i) for i in range(len(points))])
        store.remove()
    return found


def _solution(contact: Contact, nodes: int) -> list[float]:
    """What is kept of one contact; zeros where no film is found."""
    try:
        film = solve(contact, n=nodes)
    except SolveError:
        return [0.0] * len(KEPT)
    found = FOUND if film.h_c > 0 and film.h_min > 0 else LOST
    if found == FOUND and not _is_line(contact) and _error(contact, nodes, film.h_c) > ROUGHEST:
        found = COARSE
    return [film.h_c, film.h_min, film.mu, film.asperity_share, float(film.p.max()), found]


def _is_line(contact: Contact) -> bool:
    return not isfinite(contact.R_y) and contact.edge_radius == 0


def _error(contact: Contact, nodes: int, h_c: float) -> float:
    """Error of a central film, from that on every other node: of second order, a third of their difference [1]."""
    try:
        return abs(h_c - solve(contact, n=(nodes + 1) // 2).h_c) / (3 * h_c)
    except SolveError:
        return 1.0


def _table_of(case: MapCase, points: np.ndarray, kept: np.ndarray) -> str:
    """The map as CSV: points (n, 3) and what was kept of each (n, KEPT)."""
    rows, c = list[list[float | str | None]](), case.contact
    across = c.R_y if isfinite(c.R_y) else None
    constant = (c.R_x, across, c.length, c.E_eff, case.slide_roll, case.sigma, case.mu_boundary)
    for (F, u_m, T), (h_c, h_min, mu_fluid, share, p_max, found) in zip(points, kept, strict=True):
        eta_0, alpha_p = case.oil(float(T))
        films: tuple[float | None, ...] = (None,) * 2
        rest: tuple[float | None, ...] = (None,) * 5
        formula = formula_of(contact_at(case, np.array([F, u_m, T])))
        if found == FOUND:
            Lambda = h_c / case.sigma if case.sigma else None
            carried = float(asperity_share(Lambda)) if Lambda is not None else share
            rough = Lambda is not None and case.mu_boundary is not None
            mu = float(mixed_friction(Lambda, mu_fluid, case.mu_boundary)) if rough else None
            films, rest = (h_c, h_min), (mu_fluid, Lambda, carried, mu, p_max)
        status = OK if found == FOUND else WRONG[found][0]
        rows.append([F, u_m, T - 273.15, eta_0, alpha_p, *films, formula, *rest, status, *constant])
    return rows_text((column.name for column in COLUMNS), rows)


def formula_of(contact: Contact) -> float:
    """Central film by the formula for such contacts [m]: Moes for lines, Nijenbanning, Venner and Moes for ellipses."""
    oil, u_sum = contact.lubricant, 2 * contact.u_m
    if not isfinite(contact.R_y):
        load = contact.F / contact.length
        return float(line_film_central(oil.eta_0, u_sum, oil.alpha_p, load, contact.R_x, contact.E_eff))
    shape = (contact.R_x, contact.R_y, contact.E_eff)
    return float(point_film_central(oil.eta_0, u_sum, oil.alpha_p, contact.F, *shape))


def _name_point(case: MapCase, point: np.ndarray) -> str:
    """A point in words."""
    words = [
        f"{name} = {from_si(float(v), AXES[name].unit):.4g} {show_unit(AXES[name].unit)}"
        for name, v in zip(AXES, point, strict=True)
        if name in {axis.name for axis in case.axes}
    ]
    return ", ".join(words)


def _picture(case: MapCase, points: np.ndarray, kept: np.ndarray) -> Picture:
    """Central film over speed at each load, a panel for each temperature."""
    from ..show.drawing import COLOURS, empty

    temperatures, loads = np.unique(points[:, 2]), np.unique(points[:, 0])
    figure, panels = empty(3.2 * len(temperatures) + 0.8, 3.6, 1, len(temperatures), sharey=True)
    for panel, T in zip(panels, temperatures, strict=True):
        for k, F in enumerate(loads):
            here = (points[:, 2] == T) & (points[:, 0] == F) & (kept[:, -1] == FOUND)
            label = f"{F:.3g} N" if panel is panels[0] else None
            panel.loglog(points[here, 1], 1e6 * kept[here, 0], "o-", ms=3, color=COLOURS[k % len(COLOURS)], label=label)
            panel.loglog(points[here, 1], 1e6 * kept[here, 1], ":", color=COLOURS[k % len(COLOURS)])
        panel.set_title(f"{T - 273.15:.0f} degC")
        panel.set_xlabel("mean speed [m/s]")
    panels[0].set_ylabel("film [um]: central, minimum dotted")
    panels[0].legend()
    title = f"{case.name} {case.part}".strip()
    figure.suptitle(title)
    return Picture(figure, title)
