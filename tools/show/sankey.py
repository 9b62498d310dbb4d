"""A Sankey diagram of heat paths: bars for places, bands for the heat between them, as wide as it is much."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch, Rectangle
from matplotlib.path import Path as Outline

from ...model.units import text
from .drawing import COLOURS, empty
from .heat_paths import Path
from .picture import Picture

#: Width of a column [inch].
COLUMN = 1.75
#: Width of a bar [inch].
BAR = 0.12
#: Height of a line of text [inch].
LINE = 0.18
#: Space between places [inch].
GAP = 0.12
#: Height of the largest heat flow [inch].
TALL = 3.2
#: Colours of the bands: words stand on them, so no black.
BANDS = COLOURS[:-1]


@dataclass
class Place:
    """A bar of the diagram [inch]: its column, the middle of its height, and how much heat passes [W]."""

    name: str
    Q_flow: float
    column: int = 0
    y: float = 0.0


def heat_picture(rig: str, paths: Sequence[Path], values: Mapping[str, float]) -> Picture:
    """The heat of a steady state, and the same as a table.

    Args:
        rig: its name
        paths: the heat
        values: path -> value in SI, for the temperatures of places
    """
    named = {name: f"{name}.T" for path in paths for name in (path.begins, path.ends)}
    temperatures = {name: text(values[key], "K", 4) for name, key in named.items() if key in values}
    title = f"{rig}: where the heat comes from and where it goes"
    rows = [(p.begins, p.ends, p.through, p.Q_flow) for p in sorted(paths, key=lambda p: -p.Q_flow)]
    note = "Heat flow rates of the steady state in W; bands are as wide as they are large."
    return Picture(sankey(paths, temperatures, title), title, note, ("from", "to", "through", "heat [W]"), rows)


def sankey(paths: Sequence[Path], temperatures: Mapping[str, str], title: str) -> Figure:
    """The diagram.

    Args:
        paths: the heat
        temperatures: name of a place -> its temperature as it is written there
        title: above it
    """
    places = place_columns(paths)
    scale = TALL / max((place.Q_flow for place in places.values()), default=1.0)
    height = _arrange(list(places.values()), paths, scale)
    last = max((place.column for place in places.values()), default=1)
    width = COLUMN * (last + 1)
    figure, (panel,) = empty(width, height + 0.5, 1, 1)
    panel.set(xlim=(0, width), ylim=(height, -0.1), title=title)
    panel.set_axis_off()
    bands = {name: BANDS[i % len(BANDS)] for i, name in enumerate(places)}
    _draw_paths(panel, places, paths, scale, bands)
    for place in places.values():
        _draw_place(panel, place, scale, temperatures.get(place.name))
    if not places:
        panel.text(width / 2, height / 2, "no heat flows", ha="center", va="center", fontsize=9)
    return figure


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


def _arrange(places: Sequence[Place], paths: Sequence[Path], scale: float) -> float:
    """Set the heights of all places, column by column in the order of what they have their heat from.

    Returns:
        the height of the whole [inch]
    """
    columns: dict[int, list[Place]] = {}
    for place in places:
        columns.setdefault(place.column, []).append(place)
    known = {place.name: place for place in places}
    tall = {k: sum(_room(place, scale) for place in column) for k, column in columns.items()}
    whole = max(tall.values(), default=GAP + 2 * LINE)
    for k in sorted(columns):

        def level(place: Place) -> float:
            feeds = [(known[p.begins].y, p.Q_flow) for p in paths if p.ends == place.name]
            return sum(y * Q for y, Q in feeds) / max(sum(Q for _, Q in feeds), 1e-300)

        y = (whole - tall[k]) / 2
        for place in sorted(columns[k], key=level):
            room = _room(place, scale)
            place.y = y + room / 2
            y += room
    return whole


def _room(place: Place, scale: float) -> float:
    """Height that a place takes: that of its heat or of its words."""
    return max(scale * place.Q_flow, 2 * LINE) + GAP


def _draw_place(panel: Axes, place: Place, scale: float, temperature: str | None) -> None:
    tall = scale * place.Q_flow
    x = COLUMN * place.column
    panel.add_patch(Rectangle((x, place.y - tall / 2), BAR, tall, color="#333333", linewidth=0))
    words = f"{place.Q_flow:.4g} W" if temperature is None else f"{place.Q_flow:.4g} W, {temperature}"
    panel.text(x + BAR + 0.05, place.y, f"{place.name}\n{words}", va="center", ha="left", fontsize=9, zorder=3)


def _draw_paths(
    panel: Axes, places: Mapping[str, Place], paths: Sequence[Path], scale: float, bands: Mapping[str, str]
) -> None:
    """The bands, those of one bar beside each other in the order of where they lead."""
    leaving = {name: place.y - scale * place.Q_flow / 2 for name, place in places.items()}
    arriving = dict(leaving)
    starts, ends = {}, {}
    for i in sorted(range(len(paths)), key=lambda i: places[paths[i].ends].y):
        starts[i] = leaving[paths[i].begins]
        leaving[paths[i].begins] += scale * paths[i].Q_flow
    for i in sorted(range(len(paths)), key=lambda i: places[paths[i].begins].y):
        ends[i] = arriving[paths[i].ends]
        arriving[paths[i].ends] += scale * paths[i].Q_flow
    for i, path in enumerate(paths):
        left, right = COLUMN * places[path.begins].column + BAR, COLUMN * places[path.ends].column
        middle, wide = (left + right) / 2, scale * path.Q_flow
        over, under = (starts[i], ends[i]), (starts[i] + wide, ends[i] + wide)
        corners = [
            (left, over[0]), (middle, over[0]), (middle, over[1]), (right, over[1]),
            (right, under[1]), (middle, under[1]), (middle, under[0]), (left, under[0]), (left, over[0]),
        ]  # fmt: skip
        codes = [Outline.MOVETO, *[Outline.CURVE4] * 3, Outline.LINETO, *[Outline.CURVE4] * 3, Outline.CLOSEPOLY]
        panel.add_patch(PathPatch(Outline(corners, codes), color=bands[path.begins], alpha=0.35, linewidth=0))
