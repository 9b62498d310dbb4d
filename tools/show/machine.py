"""A drawing of any machine: shafts, teeth, bearings, seals, motor, housing and oil, with a list of its parts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import count
from textwrap import wrap

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.patches import Ellipse, FancyBboxPatch, Polygon, Rectangle

from ...model.core.connect import Assembly, nets
from ...model.core.declare import Port
from ...model.parts.ports import HeatPort, ShaftReading
from .console import cell
from .drawing import empty, marks_on
from .heat_paths import place_names
from .picture import Picture
from .train import HALF, Mesh, Shaft, Train, lay_out

#: Length of a unit of the drawing [inch].
UNIT = 0.62
#: Width of the list [inch].
LIST = 3.3
#: Height of a line of the list [inch].
LINE = 0.17
#: Half the width of a face.
FACE = 0.3
#: Half the width of a shaft.
THICK = 0.06
#: Half the width of a bearing.
BEARING = 0.14
#: How far a shaft end stands out.
OUT = 0.75
#: Step from bearing to bearing.
NEXT = 0.4
#: Level of the oil where nothing says more, as a share of the housing.
LOW = 0.28
#: Letters of a line of the list, longer ones go on below.
LETTERS = 46
#: Length of a tooth of a bevel gear, as a share of its cone.
CONE = 0.35
#: Colour of gears without a temperature.
STEEL = "#a9bccf"
#: Colour of bearings, pins and seals without a temperature.
METAL = "#5f6b78"
#: Colour of oil without a temperature.
OIL = "#f2c14e"
#: Colour of outlines.
EDGE = "#333333"
#: Temperatures at the ends of the colours [K], spread at least so far [K].
SPREAD = 10.0


class _Drawing:
    """A panel with what is drawn on it so far: places of names, numbers and extent."""

    def __init__(self, panel: Axes, fills: Mapping[str, str], told: Mapping[str, str]) -> None:
        self.panel, self.fills, self.told = panel, fills, told
        self.numbers = count(1)
        self.numbered: dict[str, int] = {}
        self.corners: list[np.ndarray] = []
        self.outside: list[np.ndarray] = []
        self.marks: list[tuple[float, float, str]] = []

    def fill(self, part: str, usual: str) -> str:
        """Colour of a part: of its temperature, where temperatures are shown."""
        return self.fills.get(part, usual)

    def box(self, shaft: Shaft, s: float, half: float, r: float, part: str = "", fill: str = STEEL, z: int = 3) -> None:
        """A body of revolution in section; the housing is drawn around those that are above layer 1."""
        self.shape([shaft.point(s + a * half, b * r) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))], part, fill, z)

    def shape(self, corners: list[np.ndarray], part: str, fill: str = STEEL, z: int = 3) -> None:
        """A closed outline."""
        self.panel.add_patch(Polygon(corners, facecolor=self.fill(part, fill), edgecolor=EDGE, linewidth=0.8, zorder=z))
        (self.corners if z > 1 else self.outside).extend(corners)

    def number(self, part: str, at: np.ndarray) -> None:
        """The number of a part in the list, and what a page says there."""
        number = self.numbered.setdefault(part, next(self.numbers))
        circle = {"boxstyle": "circle,pad=0.18", "facecolor": "white", "edgecolor": EDGE, "linewidth": 0.6}
        self.panel.text(at[0], at[1], str(number), fontsize=7, ha="center", va="center", zorder=9, bbox=circle)
        self.marks.append((float(at[0]), float(at[1]), self.told[part]))


def machine_picture(
    assembly: Assembly,
    entries: Mapping[str, Mapping[str, str]],
    temperatures: Mapping[str, float],
    title: str,
    ends: Mapping[str, str],
) -> Picture:
    """The drawing.

    Args:
        assembly: the machine
        entries: part -> kind of catalogue -> name of the entry it was filled from
        temperatures: body -> temperature [K]; parts are coloured by them, none for a drawing without
        title: above it
        ends: shaft end -> what is said beside its name
    """
    train = lay_out(assembly)
    told = {part.name: _words(part.name, part.values, entries.get(part.name, {})) for part in assembly.parts}
    fills = _fills(assembly, temperatures)
    figure, (panel,) = empty(LIST, LIST, 1, 1)
    panel.set_aspect("equal")
    panel.set_axis_off()
    panel.set_title(title)
    drawing = _Drawing(panel, fills, told)
    roles, motors = {part.name: part.role for part in assembly.parts}, _motors(assembly)
    for mesh in train.meshes:
        _draw_mesh(drawing, mesh)
    for k, shaft in enumerate(train.shafts):
        _draw_shaft(drawing, shaft, roles, ends, motors, first=k == 0)
    _draw_housing(drawing, assembly, train)
    corners = np.array([*drawing.corners, *drawing.outside, (0.0, 0.0)])
    (x0, y0), (x1, y1) = corners.min(axis=0) - 0.7, corners.max(axis=0) + 0.7
    lines = _list_lines(drawing, assembly, temperatures)
    tall = max((y1 - y0) * UNIT, (len(lines) + 1) * LINE)
    figure.set_size_inches((x1 - x0) * UNIT + LIST, tall + 0.4)
    middle, half = (y0 + y1) / 2, tall / UNIT / 2
    panel.set(xlim=(x0, x1 + LIST / UNIT), ylim=(middle - half, middle + half))
    for k, (line, colour) in enumerate(lines):
        y = middle + half - (k + 0.5) * LINE / UNIT
        if colour:
            panel.add_patch(Rectangle((x1, y - 0.09), 0.25, 0.18, facecolor=colour, edgecolor=EDGE, linewidth=0.5))
        panel.text(x1 + 0.4, y, line, fontsize=8, va="center", ha="left")
    note = "Shafts in one plane, teeth in true ratios, the rest not to scale. Point at a number to read what it is."
    return Picture(figure, title, note, marks=marks_on(figure, [(panel, *told) for told in drawing.marks]))


#: Roles of parts that have a number even where nothing of them is drawn in place.
LISTED = ("teeth", "bearing", "seal", "motor", "fan", "pump", "bath", "grease", "surface")


def _words(name: str, values: Mapping[str, float], entries: Mapping[str, str]) -> str:
    """A part in words: its name, its catalogue entries, its teeth and module."""
    teeth = "/".join(f"{v:g}" for k, v in values.items() if k == "z" or k.startswith("z_"))
    module = next((f"module {1000 * values[k]:.3g} mm" for k in ("m_n", "m_x", "m") if k in values and teeth), "")
    said = [*(e for kind, e in entries.items() if kind != "material"), teeth, module]
    return ": ".join(filter(None, (name.replace("_", " "), ", ".join(filter(None, said)))))


def _fills(assembly: Assembly, temperatures: Mapping[str, float]) -> dict[str, str]:
    """Part -> colour by the temperature of the first body that it meets."""
    if not temperatures:
        return {}
    names = place_names(assembly)
    low, high = min(temperatures.values()), max(temperatures.values())
    colours = colormaps["YlOrRd"]

    def colour(T: float) -> str:
        r, g, b, _ = colours(0.1 + 0.75 * (T - low) / max(high - low, SPREAD))
        return f"#{int(255 * r):02x}{int(255 * g):02x}{int(255 * b):02x}"

    found = {body: colour(T) for body, T in temperatures.items()}
    for part in assembly.parts:
        met = (names.get(port.name, "") for port in _heat_ports(part.ports.values()))
        if (body := next((name for name in met if name in temperatures), "")) and part.name not in found:
            found[part.name] = found[body]
    return found


def _motors(assembly: Assembly) -> dict[str, str]:
    """Shaft end -> the motor on it."""
    found = {}
    for net in (net for net in nets(assembly) if isinstance(net[0], ShaftReading)):
        met = {part.role: part.name for part in assembly.parts if any(p.name.startswith(f"{part.name}.") for p in net)}
        if {"motor", "shaft_end"} <= met.keys():
            found[met["shaft_end"]] = met["motor"]
    return found


def _heat_ports(ports: Iterable[Port]) -> Iterator[Port]:
    return (port for port in ports if isinstance(port, HeatPort))


def _draw_mesh(d: _Drawing, mesh: Mesh) -> None:
    name = mesh.part.name
    if mesh.radii:
        _draw_pair(d, mesh)
        return
    shaft, _, s = mesh.shafts[0]
    if mesh.part.role == "clutch" or (mesh.part.role != "teeth" and not mesh.inner):
        for side in (-1, 1):
            d.box(shaft, s + 0.09 * side, 0.07, 0.42, name, METAL)
        d.number(name, shaft.point(s, -0.75))
        return
    _draw_set(d, mesh, shaft, s)


def _draw_pair(d: _Drawing, mesh: Mesh) -> None:
    """Two gears: cylinders, cones that share an apex, or a worm over its wheel."""
    name, (small, large), ((a, _, s), (b, _, t)) = mesh.part.name, mesh.radii, mesh.shafts
    if mesh.part.axes == "intersecting":
        for shaft, at, r, inwards in ((a, s, small, large), (b, t, large, -small)):
            shape = ((0.0, -r), (0.0, r), (CONE * inwards, (1 - CONE) * r), (CONE * inwards, (CONE - 1) * r))
            d.shape([shaft.point(at + x, y) for x, y in shape], name)
        d.number(name, b.point(t + 0.25, 0.75 * large))
    elif mesh.part.axes == "crossed":
        d.box(b, t, FACE, large, name)
        d.box(a, s, 2 * FACE, small, name, z=5)
        for k in range(-3, 4):
            ends = [a.point(s + 0.17 * k + x, y) for x, y in ((-0.06, -small), (0.06, small))]
            d.panel.plot(*zip(*ends, strict=True), color=EDGE, linewidth=0.7, zorder=6)
        d.number(name, b.point(t, 0.75 * large))
    else:
        d.box(a, s, FACE, small, name)
        d.box(b, t, FACE, large, name)
        d.number(name, b.point(t, -0.55 * large))


def _draw_set(d: _Drawing, mesh: Mesh, shaft: Shaft, s: float) -> None:
    """Teeth in line with their shafts: rings of teeth, what turns in them, and what is held."""
    name, half = mesh.part.name, HALF - 0.25
    names = " ".join(mesh.part.ports)
    if "planet" in mesh.part.ports:
        d.box(shaft, s, half, 0.4, name)
        for side in (-1, 1):
            for middle, r in ((0.85, 0.42), (1.45, 0.15)):
                lifted = shaft.beside(side * middle)
                d.box(lifted, s, half if r < 0.2 else half - 0.08, r, name)
            pin = shaft.beside(side * 0.85)
            d.box(pin, s + 0.1, half + 0.2, 0.07, fill=METAL, z=5)
        carrier = next((one for one, key, _ in mesh.shafts if key == "carrier"), None)
        side = 1 if carrier is None or carrier is not shaft else -1
        d.box(shaft, s + side * (half + 0.22), 0.07, 1.0, fill=METAL, z=2)
    else:
        for side in (-1, 1):
            ring = shaft.beside(side * 1.35)
            d.box(ring, s, half, 0.16, name)
        d.box(shaft, s, half - 0.05, 1.12, name)
        at = shaft.point(s)
        wide, high = (0.75, 1.9) if "wave" in names else (0.84, 0.84)
        oval = Ellipse(
            (at[0], at[1]), wide, high, facecolor="white", edgecolor=EDGE, linewidth=0.8, zorder=5, alpha=0.6
        )
        d.panel.add_patch(oval)
    for side in (-1, 1) if mesh.held else ():
        top = shaft.point(s, side * 1.62)
        d.panel.plot([top[0] - 0.35, top[0] + 0.35], [top[1]] * 2, color=EDGE, lw=1.2, zorder=4)
        for k in range(5):
            x = top[0] - 0.35 + 0.16 * k
            d.panel.plot([x, x + 0.1], [top[1], top[1] - side * 0.14], color=EDGE, lw=0.7, zorder=4)
    for k, part in enumerate(mesh.inner):
        d.number(part, shaft.point(s + 0.32, -0.85 + 0.4 * k))
    d.number(name, shaft.point(s - 0.3, 0.85))


def _draw_shaft(
    d: _Drawing,
    shaft: Shaft,
    roles: Mapping[str, str],
    ends: Mapping[str, str],
    motors: Mapping[str, str],
    *,
    first: bool,
) -> None:
    """A shaft with its bearings, its seals, and the ends that stand out of the housing."""
    d.box(shaft, (shaft.low + shaft.high) / 2, (shaft.high - shaft.low) / 2, THICK, fill="#c9d1da", z=2)
    free = [side for side in ("low", "high") if side not in shaft.closed]
    bearings = [name for name in shaft.parts if roles[name] == "bearing"]
    half = -(-len(bearings) // 2) if len(free) == 2 else len(bearings) * (free != ["high"])
    for k, name in enumerate(bearings):
        at = shaft.low + NEXT * k if k < half else shaft.high - NEXT * (len(bearings) - 1 - k)
        if not free:
            at = shaft.low + (shaft.high - shaft.low) * (k + 1) / (len(bearings) + 1)
        _draw_bearing(d, shaft, at, name)
    stand_out = [name for name in shaft.parts if roles[name] == "shaft_end"]
    seals = [name for name in shaft.parts if roles[name] == "seal"]
    sides = free if first else free[::-1]
    for k, (end, side) in enumerate(zip(stand_out, sides or ["high"], strict=False)):
        sign, edge = (-1, shaft.low) if side == "low" else (1, shaft.high)
        d.box(shaft, edge + sign * (OUT - 0.1) / 2, (OUT + 0.1) / 2, THICK, fill="#c9d1da", z=1)
        words = f"{end.replace('_', ' ')}\n{ends.get(end, '')}".strip()
        out = OUT
        if motor := motors.get(end):
            d.box(shaft, edge + sign * (OUT + 0.4), 0.4, 0.55, motor, z=1)
            d.number(motor, shaft.point(edge + sign * (OUT + 0.4)))
            out += 0.8
        place = shaft.point(edge + sign * (out + 0.2))
        across = "center" if not shaft.flat else "right" if sign < 0 else "left"
        d.panel.text(
            place[0], place[1], words, fontsize=8, va="center" if shaft.flat else "top", ha=across, linespacing=1.15
        )
        d.outside.append(shaft.point(edge + sign * (out + 1.1)))
        for name in seals[k :: len(stand_out)]:
            for b in (-1, 1):
                lip = ((0.25, THICK), (0.42, THICK), (0.42, 0.28))
                d.shape([shaft.point(edge + sign * x, b * y) for x, y in lip], name, METAL, z=1)
            d.number(name, shaft.point(edge + sign * 0.42, 0.52))


def _draw_bearing(d: _Drawing, shaft: Shaft, s: float, name: str) -> None:
    for side in (-1, 1):
        seat = shaft.beside(side * (THICK + BEARING))
        d.box(seat, s, BEARING, BEARING, name, "white", z=4)
        corners = [seat.point(s + a * BEARING, b * BEARING) for a, b in ((-1, -1), (1, 1), (-1, 1), (1, -1))]
        for one, two in (corners[:2], corners[2:]):
            d.panel.plot([one[0], two[0]], [one[1], two[1]], color=EDGE, linewidth=0.7, zorder=5)
    d.number(name, shaft.point(s, -(THICK + 2 * BEARING + 0.2)))


def _draw_housing(d: _Drawing, assembly: Assembly, train: Train) -> None:
    """Walls around all that turns inside; the oil where the shafts are seen from the side, as deep as a gear dips."""
    if not d.corners:
        return
    (x0, y0), (x1, y1) = np.min(d.corners, axis=0) - 0.2, np.max(d.corners, axis=0) + 0.2
    surface = next((part.name for part in assembly.parts if part.role == "surface"), "")
    paper = f"{d.fills[surface]}40" if surface in d.fills else "#f7f8fa"
    walls = FancyBboxPatch((x0, y0), x1 - x0, y1 - y0, "round,pad=0.12", facecolor=paper, edgecolor="#8894a2")
    walls.set(zorder=0, linewidth=2.5)
    d.panel.add_patch(walls)
    bath = next((part for part in assembly.parts if part.role == "bath"), None)
    if bath is None or not all(shaft.flat for shaft in train.shafts):
        return
    level = min(_level(assembly, train, bath.values.get("level")) or y0 + LOW * (y1 - y0), y1)
    colour = d.fill(bath.name, OIL)
    d.panel.add_patch(Rectangle((x0, y0), x1 - x0, level - y0, color=colour, alpha=0.35, zorder=1, linewidth=0))
    d.panel.plot([x0, x1], [level, level], color="#b8860b", lw=1, zorder=1)
    d.panel.plot([x0 + 0.15, x0 + 0.25, x0 + 0.35], [level + 0.14, level + 0.02, level + 0.14], color="#b8860b", lw=1)


def _level(assembly: Assembly, train: Train, level: float | None) -> float | None:
    """Height of the oil beside the lowest gear that dips, by its real radius and height; None where it is not known."""
    dips = {p.name: p.values for p in assembly.parts if {"r", "height"} <= p.values.keys()}
    drawn: list[tuple[float, float, Mapping[str, float]]] = []
    for mesh in train.meshes:
        for (shaft, _, _), r in zip(mesh.shafts, mesh.radii, strict=False):
            drawn += [(shaft.origin[1], r, dips[name]) for name in shaft.parts if name in dips]
    if level is None or not drawn:
        return None
    y, r, known = min(drawn, key=lambda one: (one[0], -one[1]))
    return float(y + r * (level - known["height"]) / known["r"])


def _list_lines(d: _Drawing, assembly: Assembly, temperatures: Mapping[str, float]) -> list[tuple[str, str]]:
    """The numbers with their parts, then oil, housing and the temperatures of bodies with their colours."""
    names = sorted(d.numbered, key=lambda name: d.numbered[name])
    lines = [(f"{d.numbered[name]}  {d.told[name]}", "") for name in names]
    for part in assembly.parts:
        if part.role in LISTED and part.name not in d.numbered:
            level = f", level {1000 * part.values['level']:.0f} mm" if "level" in part.values else ""
            volume = f", {cell(float(1000 * part.values['V']))} l" if "V" in part.values else ""
            area = f": {part.values['A']:.3g} m²" if part.role == "surface" and "A" in part.values else ""
            lines.append((f"–  {d.told[part.name]}{volume}{level}{area}", ""))
    lines += [(f"{body.replace('_', ' ')} {T - 273.15:.1f} °C", d.fills[body]) for body, T in temperatures.items()]
    wrapped = [(wrap(line, LETTERS, subsequent_indent="     "), colour) for line, colour in lines]
    return [(row, "" if k else colour) for rows, colour in wrapped for k, row in enumerate(rows)]


def end_words(ends: Sequence[str], values: Mapping[str, float]) -> dict[str, str]:
    """Speed and torque of each shaft end in words, as far as they are known."""
    found = {}
    for end in ends:
        w, tau = values.get(f"{end}.w"), values.get(f"{end}.tau")
        words = [] if w is None else [f"{cell(abs(float(w)) * 30 / np.pi)} rpm"]
        words += [] if tau is None else [f"{cell(abs(float(tau)))} N.m"]
        found[end] = "\n".join(words)
    return found
