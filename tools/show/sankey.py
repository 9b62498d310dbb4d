"""A Sankey diagram of heat paths: boxes for places, bands for the heat between them, as wide as it is much."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch, Rectangle
from matplotlib.path import Path as Outline

from ...model.units import text
from .drawing import COLOURS, empty, marks_on
from .heat_paths import Path
from .notes import PLURAL
from .picture import Mark, Picture

#: Width of a box [inch].
BOX = 1.4
#: Width of the bands between two columns of boxes [inch].
BETWEEN = 0.75
#: Height of a line of text [inch].
LINE = 0.17
#: Space between boxes, and around bands that pass a column [inch].
GAP = 0.1
#: Height of the largest heat flow [inch].
TALL = 3.2
#: Letters of a line in a box.
LETTERS = 19
#: Sources of one kind below this share of the whole heat are drawn as one.
SMALL = 0.12
#: Sweeps by which the boxes of a column are put in order.
SWEEPS = 6
#: Colours by what makes the heat.
KINDS = dict(zip(("teeth", "bearing", "seal", "churning", "motor", "clutch"), COLOURS, strict=False))
#: Colour of what already flows between bodies.
FLOWING = "#9aa5b1"
#: Colour of what makes heat otherwise.
OTHER = "#b08968"


@dataclass
class Place:
    """A box of the diagram [inch]: its column, the middle of its height, and how much heat passes [W].

    Its name is "" where a band passes the column.
    """

    name: str
    Q_flow: float
    column: int = 0
    y: float = 0.0


@dataclass(frozen=True)
class _Band:
    """Heat between two places in neighbouring columns, and its colour."""

    begins: Place
    ends: Place
    path: Path
    colour: str


def heat_picture(rig: str, paths: Sequence[Path], values: Mapping[str, float], kinds: Mapping[str, str]) -> Picture:
    """The heat of a steady state, and the same as a table.

    Args:
        rig: its name
        paths: the heat
        values: path -> value in SI, for the temperatures of places
        kinds: part -> its role, such as "bearing"
    """
    named = {name: f"{name}.T" for path in paths for name in (path.begins, path.ends)}
    temperatures = {name: text(values[key], "K", 3) for name, key in named.items() if key in values}
    title = f"{rig}: where the heat comes from and where it goes"
    rows = [(p.begins, p.ends, p.through, p.Q_flow) for p in sorted(paths, key=lambda p: -p.Q_flow)]
    note = "Heat flow rates of the steady state in W; bands are as wide as they are large, coloured by what makes them."
    figure, marks = sankey(paths, temperatures, title, kinds)
    return Picture(figure, title, note, ("from", "to", "through", "heat [W]"), rows, marks=marks)


def sankey(
    paths: Sequence[Path], temperatures: Mapping[str, str], title: str, kinds: Mapping[str, str]
) -> tuple[Figure, list[Mark]]:
    """The diagram, and what to say where.

    Args:
        paths: the heat
        temperatures: name of a place -> its temperature as it is written there
        title: above it
        kinds: part -> its role
    """
    paths, kinds = _grouped(paths, kinds)
    places = place_columns(paths)
    bands, columns = _route(places, paths, {name: _colour(kinds.get(name, "")) for name in places})
    scale = TALL / max((place.Q_flow for place in places.values()), default=1.0)
    height = _arrange(columns, bands, scale)
    width = len(columns) * (BOX + BETWEEN) - BETWEEN if columns else 3.0
    figure, (panel,) = empty(width + 0.2, height + 0.8, 1, 1)
    panel.set(xlim=(-0.05, width + 0.05), ylim=(height + 0.05, -0.05), title=title)
    panel.set_axis_off()
    found = _draw_bands(panel, bands, scale)
    sources = places.keys() - {path.ends for path in paths}
    for place in places.values():
        fill = _colour(kinds.get(place.name, "")) if place.name in sources else "#3c4653"
        _draw_place(panel, place, scale, temperatures.get(place.name), fill)
    shown = {kind: colour for kind, colour in KINDS.items() if kind in {kinds.get(name) for name in sources}}
    handles = [Rectangle((0, 0), 1, 1, color=colour, label=PLURAL.get(kind, kind)) for kind, colour in shown.items()]
    if handles:
        figure.legend(handles=handles, loc="outside lower center", ncols=len(handles), fontsize=9)
    if not places:
        panel.text(width / 2, height / 2, "no heat flows", ha="center", va="center", fontsize=9)
    return figure, marks_on(figure, [(panel, *told) for told in found])


def _colour(kind: str) -> str:
    return KINDS.get(kind, OTHER)


def _grouped(paths: Sequence[Path], kinds: Mapping[str, str]) -> tuple[list[Path], dict[str, str]]:
    """The paths with small sources of one kind as one place, and the kinds with it."""
    made = {p.begins: 0.0 for p in paths if p.begins not in {q.ends for q in paths}}
    for path in paths:
        if path.begins in made:
            made[path.begins] += path.Q_flow
    small = [name for name, Q in made.items() if kinds.get(name) and SMALL * sum(made.values()) > Q]
    called: dict[str, str] = {}
    for kind in dict.fromkeys(kinds[name] for name in small):
        alike = [name for name in small if kinds[name] == kind]
        others = any(kinds.get(name) == kind for name in made if name not in small)
        if len(alike) > 1:
            words = f"{len(alike)} {'other ' if others else ''}{PLURAL.get(kind, kind)}"
            called |= dict.fromkeys(alike, words)
    found: dict[tuple[str, str, str], Path] = {}
    for path in paths:
        one = replace(path, begins=called.get(path.begins, path.begins))
        key = (one.begins, one.ends, one.through)
        found[key] = replace(one, Q_flow=one.Q_flow + (found[key].Q_flow if key in found else 0.0))
    return list(found.values()), {**kinds, **{words: kinds[name] for name, words in called.items()}}


def place_columns(paths: Sequence[Path]) -> dict[str, Place]:
    """The places by name, each in a column behind all that it has its heat from; what gives none on comes last."""
    names = dict.fromkeys(name for path in paths for name in (path.begins, path.ends))
    given = {name: sum(p.Q_flow for p in paths if p.begins == name) for name in names}
    taken = {name: sum(p.Q_flow for p in paths if p.ends == name) for name in names}
    places = {name: Place(name, max(given[name], taken[name])) for name in names}
    for _ in range(len(names)):  # heat that goes round, as by a pump, would never end
        for path in paths:
            places[path.ends].column = max(places[path.ends].column, places[path.begins].column + 1)
        if all(places[path.ends].column > places[path.begins].column for path in paths):
            break
    used = sorted({place.column for place in places.values()})
    last = len(used) - 1
    for name, place in places.items():
        place.column = last if not given[name] else used.index(place.column)
    for name, place in places.items():  # a source stands beside what it heats first
        if not taken[name]:
            place.column = max(min(places[p.ends].column for p in paths if p.begins == name) - 1, 0)
    return places


def _route(
    places: Mapping[str, Place], paths: Sequence[Path], colours: Mapping[str, str]
) -> tuple[list[_Band], list[list[Place]]]:
    """The bands from column to column, and what stands in each column: boxes, and where bands pass."""
    columns: list[list[Place]] = [[] for _ in range(1 + max((p.column for p in places.values()), default=-1))]
    for place in places.values():
        columns[place.column].append(place)
    ends = {path.ends for path in paths}
    bands: list[_Band] = []
    for path in paths:
        begin, end = places[path.begins], places[path.ends]
        step = 1 if end.column > begin.column else -1
        colour = FLOWING if path.begins in ends else colours[path.begins]
        for k in range(begin.column + step, end.column + step, step):
            there = end if k == end.column else Place("", path.Q_flow, k)
            if there is not end:
                columns[k].append(there)
            bands.append(_Band(begin, there, path, colour))
            begin = there
    return bands, columns


def _arrange(columns: Sequence[list[Place]], bands: Sequence[_Band], scale: float) -> float:
    """Set the heights of all places: each column in the order of its neighbours, from both sides in turn.

    Returns:
        the height of the whole [inch]
    """
    tall = [sum(_room(place, scale) for place in column) for column in columns]
    whole = max(tall, default=GAP + 2 * LINE)
    near: dict[int, list[tuple[Place, float]]] = {id(place): [] for column in columns for place in column}
    for band in bands:
        near[id(band.begins)].append((band.ends, band.path.Q_flow))
        near[id(band.ends)].append((band.begins, band.path.Q_flow))

    def level(place: Place) -> float:
        return sum(p.y * Q for p, Q in near[id(place)]) / max(sum(Q for _, Q in near[id(place)]), 1e-300)

    for sweep in range(SWEEPS):
        for k, column in list(enumerate(columns))[:: 1 if sweep % 2 else -1]:
            if sweep:
                column.sort(key=level)
            y = (whole - tall[k]) / 2
            for place in column:
                room = _room(place, scale)
                place.y = y + room / 2
                y += room
    return whole


def _room(place: Place, scale: float) -> float:
    """Height that a place takes: that of its heat or of its words."""
    return max(scale * place.Q_flow, 2 * LINE if place.name else 0.0) + GAP


def _draw_place(panel: Axes, place: Place, scale: float, temperature: str | None, fill: str) -> None:
    tall, room = scale * place.Q_flow, _room(place, scale) - GAP
    x = (BOX + BETWEEN) * place.column
    panel.add_patch(Rectangle((x, place.y - room / 2), BOX, room, facecolor="#f4f5f7", edgecolor="none"))
    for edge in (x, x + BOX - 0.05):
        panel.add_patch(Rectangle((edge, place.y - tall / 2), 0.05, tall, color=fill, linewidth=0))
    name = place.name.replace("_", " ")
    name = name if len(name) <= LETTERS else f"{name[: LETTERS - 1]}…"
    words = f"{place.Q_flow:.3g} W" if place.Q_flow < 1000 else f"{place.Q_flow / 1000:.3g} kW"
    words = words if temperature is None else f"{words}, {temperature}".replace("degC", "°C")
    panel.text(x + BOX / 2, place.y, f"{name}\n{words}", va="center", ha="center", fontsize=8.5, zorder=3)


def _draw_bands(panel: Axes, bands: Sequence[_Band], scale: float) -> list[tuple[float, float, str]]:
    """Draw the bands, those of one box beside each other in the order of where they lead; their middles and words."""
    starts: dict[int, float] = {}
    ends: dict[int, float] = {}
    for side, other, found in (("begins", "ends", starts), ("ends", "begins", ends)):
        used: dict[int, float] = {}
        for i in sorted(range(len(bands)), key=lambda i: getattr(bands[i], other).y):
            place: Place = getattr(bands[i], side)
            found[i] = used.get(id(place), place.y - scale * place.Q_flow / 2)
            used[id(place)] = found[i] + scale * bands[i].path.Q_flow
    told = []
    for i, band in enumerate(bands):
        left, right = ((BOX + BETWEEN) * place.column for place in (band.begins, band.ends))
        left, start, end, wide = left + BOX, starts[i], ends[i], scale * band.path.Q_flow
        if not band.ends.name:
            panel.add_patch(Rectangle((right, end), BOX, wide, color=band.colour, alpha=0.45, linewidth=0))
        middle = (left + right) / 2
        corners = [
            (left, start), (middle, start), (middle, end), (right, end),
            (right, end + wide), (middle, end + wide), (middle, start + wide), (left, start + wide), (left, start),
        ]  # fmt: skip
        codes = [Outline.MOVETO, *[Outline.CURVE4] * 3, Outline.LINETO, *[Outline.CURVE4] * 3, Outline.CLOSEPOLY]
        panel.add_patch(PathPatch(Outline(corners, codes), color=band.colour, alpha=0.45, linewidth=0))
        path = band.path
        by = f" through {path.through}" if path.through else ""
        told.append((middle, (start + end + wide) / 2, f"{path.begins} → {path.ends}{by}: {path.Q_flow:.4g} W"))
    return told
