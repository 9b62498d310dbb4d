"""The network of a machine as a picture (SVG): what turns together, what has one temperature, and what lies between."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from html import escape

from ...model.core.component import Component
from ...model.core.connect import Assembly, nets
from ...model.core.declare import Port
from ...model.parts.ports import Flange, HeatPort, OilPort

#: Width of a column [px].
_COLUMN = 152.0
#: Width of a box in it [px].
_BOX = 128.0
#: Height of a line of text [px].
_LINE = 15.0
#: Space between boxes and at the edge [px].
_GAP = 16.0

#: Fill and stroke of the nets of a kind of port, in the order in which they are drawn.
_COLOURS = {Flange: ("#eaf1f8", "#2f6597"), OilPort: ("#f6f3e0", "#857400"), HeatPort: ("#fdf0e7", "#c65a1e")}


@dataclass(frozen=True)
class Box:
    """One box: a net with its title and members, or a part that lies between the nets `to`.

    `given` says that something is given there from outside: a shaft end, a room.
    """

    title: tuple[str, ...]
    members: tuple[str, ...]
    given: bool = False
    to: tuple[int, ...] = ()

    @property
    def height(self) -> float:
        """Height of the box."""
        return _LINE * (len(self.title) + len(self.members)) + 8


def network_svg(assembly: Assembly) -> str:
    """Shafts above, heat below, oil between; a net is a box with its parts, what connects nets lies between them."""
    drawn, top, width = [], 0.0, 0.0
    for kind, colours in _COLOURS.items():
        boxes = _boxes(assembly, kind)
        if not boxes:
            continue
        places, size = _place_boxes(boxes)
        drawn.append(f'<g transform="translate(0,{top:g})">{_draw_boxes(boxes, places, *colours)}</g>')
        top, width = top + size[1], max(width, size[0])
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {top:g}" width="{width:g}" role="img"'
    style = 'font-family="sans-serif" font-size="12" text-anchor="middle"'
    return f"{head} {style}>\n" + "\n".join(drawn) + "\n</svg>"


def _boxes(assembly: Assembly, kind: type[Port]) -> list[Box]:
    """The nets of one kind of port, then the parts between them."""
    groups = [net for net in nets(assembly) if isinstance(net[0], kind)]
    touched: dict[str, list[int]] = {}
    for i, net in enumerate(groups):
        for port in net:
            touched.setdefault(port.name.split(".")[0], []).append(i)
    parts = {part.name: part for part in assembly.parts}
    between = {name: tuple(dict.fromkeys(on)) for name, on in touched.items() if _joins(parts[name], on, kind)}
    boxes = []
    for net in groups:
        names = dict.fromkeys(port.name.split(".")[0] for port in net)
        title = tuple(n for n in names if n not in between and _rules(parts[n]))
        given = any(not parts[n].states for n in title)
        boxes.append(Box(title, tuple(n for n in names if n not in between and n not in title), given))
    return boxes + [Box((), (name,), to=on) for name, on in between.items()]


def _joins(part: Component, on: Iterable[int], kind: type[Port]) -> bool:
    """Whether a part lies between nets; what only heats two bodies by its friction belongs to both."""
    turns = any(isinstance(port, Flange) for port in part.ports.values())
    return len(set(on)) > 1 and not _rules(part) and not (kind is HeatPort and turns)


def _rules(part: Component) -> bool:
    """Whether a part gives its nets their name: it stores, or something is given there."""
    return bool(part.states or part.inputs)


def _layers(boxes: list[Box], near: list[set[int]]) -> list[int]:
    """Distance of every box from where something is given first, all nets of that name alike."""
    layers: dict[int, int] = {}
    for first in sorted(range(len(boxes)), key=lambda i: (not boxes[i].given, i)):
        if first in layers:
            continue
        queue = [i for i, box in enumerate(boxes) if i == first or (box.given and box.title == boxes[first].title)]
        layers |= dict.fromkeys(queue, 0)
        for i in queue:
            for j in sorted(near[i] - layers.keys()):
                layers[j] = layers[i] + 1
                queue.append(j)
    return [layers[i] for i in range(len(boxes))]


Places = Mapping[int, tuple[float, float]]


def _place_boxes(boxes: list[Box]) -> tuple[Places, tuple[float, float]]:
    """Centres of the boxes, column by column in the order of their neighbours, and the size of the whole."""
    near = [set(box.to) for box in boxes]
    for i, box in enumerate(boxes):
        for j in box.to:
            near[j].add(i)
    layers = _layers(boxes, near)
    columns = [[i for i, layer in enumerate(layers) if layer == k] for k in range(max(layers) + 1)]
    heights = [sum(boxes[i].height + _GAP for i in column) for column in columns]
    places: dict[int, tuple[float, float]] = {}

    def level(i: int) -> float:
        """Mean height of the neighbours that have their place."""
        above = [places[j][1] for j in near[i] if j in places]
        return sum(above) / len(above) if above else 0.0

    for k, column in enumerate(columns):
        y = (max(heights) - heights[k]) / 2 + _GAP / 2
        levels = {i: level(i) for i in column}
        for i in sorted(column, key=lambda i: (levels[i], i)):
            places[i] = (_COLUMN * (k + 0.5), y + boxes[i].height / 2)
            y += boxes[i].height + _GAP
    return places, (_COLUMN * len(columns), max(heights) + _GAP)


def _draw_boxes(boxes: list[Box], places: Places, fill: str, stroke: str) -> str:
    lines = [
        f'<line x1="{places[i][0]:g}" y1="{places[i][1]:g}" x2="{places[j][0]:g}" y2="{places[j][1]:g}" '
        f'stroke="{stroke}"/>'
        for i, box in enumerate(boxes)
        for j in box.to
    ]
    return "\n".join([*lines, *(_box(box, *places[i], fill, stroke) for i, box in enumerate(boxes))])


def _box(box: Box, x: float, y: float, fill: str, stroke: str) -> str:
    corner, paper = (8, "#ffffff") if box.to else (2, fill)
    texts = [f'<rect x="{x - _BOX / 2:g}" y="{y - box.height / 2:g}" width="{_BOX:g}" height="{box.height:g}" ']
    texts[0] += f'rx="{corner}" fill="{paper}" stroke="{stroke}"/>'
    for k, name in enumerate((*box.title, *box.members)):
        weight = ' font-weight="bold"' if name in box.title else ""
        texts.append(f'<text x="{x:g}" y="{y - box.height / 2 + _LINE * (k + 1):g}"{weight}>{escape(name)}</text>')
    return "".join(texts)
