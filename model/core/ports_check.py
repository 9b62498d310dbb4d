"""A look at the ports before and beside the equations: what meets nothing, and what has no level."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import casadi as ca
import numpy as np

from .component import Component, Equation
from .declare import Port
from .solve import Unknown, column


def open_ports(model: str, parts: Sequence[Component], nets: Sequence[Sequence[Port]]) -> list[str]:
    """Parts that are connected to nothing, and ports that have to meet another and do not.

    Which those are, the type of the port says (`must_meet`), or the part: a gear's flange may stay open, where no
    torque acts. A part that is the whole model has nothing to meet.

    Args:
        model: its name, for messages
        parts: the components
        nets: groups of ports that meet; a port alone is one as well
    """
    if len(parts) < 2:
        return []
    alone = {net[0].name for net in nets if len(net) == 1}
    return [problem for part in parts for problem in _open(model, part, alone)]


def _open(model: str, part: Component, alone: set[str]) -> Iterator[str]:
    names = [port.name for port in part.ports.values()]
    if names and alone.issuperset(names):
        yield (
            f"{model}: {part.name} ({type(part).__name__}) is connected to nothing. "
            f"Connect {' or '.join(names)}, or take {part.name} out."
        )
        return
    for port in part.ports.values():
        kind = type(port)
        if port.needed and port.name in alone:
            yield f"{model}: {port.name} is connected to nothing: {kind.missing}. Connect it to {kind.source}."


def floating(
    model: str,
    ports: Mapping[str, Port],
    rows: Sequence[Equation],
    unknowns: Sequence[Unknown],
    columns: Sequence[Sequence[int]],
) -> list[str]:
    """Groups of ports that are connected with each other but with nothing that gives their potentials a level.

    All temperatures of a group without storage and room could rise together and no equation would notice.

    Args:
        model: its name, for messages
        ports: path -> port
        rows: the equations
        unknowns: what they are solved for
        columns: for each equation the places of the unknowns in it
    """
    levels: dict[int, tuple[Port, str]] = {}
    for c, unknown in enumerate(unknowns):
        path, _, name = unknown.name.rpartition(".")
        if path in ports and name in type(ports[path]).levels:
            levels[c] = (ports[path], name)
    problems = []
    for group in _groups(levels, columns):
        inside = set(group)
        touching = [rows[r].residual for r, row in enumerate(columns) if inside.intersection(row)]
        z = column([unknowns[c].symbol for c in group])
        slope = ca.jtimes(column(touching), z, ca.SX.ones(*z.shape))
        if _zero(slope):
            port, name = levels[group[0]]
            names = [levels[c][0].name for c in group]
            more = f" and {len(names) - 3} more" if len(names) > 3 else ""
            what, remedy = type(port).potentials()[name].doc, type(port).levels[name]
            problems.append(
                f"{model}: nothing gives {', '.join(names[:3])}{more} a {what}: all of it could rise together. "
                f"Connect {remedy}."
            )
    return problems


def _groups(levels: dict[int, tuple[Port, str]], columns: Sequence[Sequence[int]]) -> list[list[int]]:
    """Potentials that equations link, without those groups of which an equation determines one by itself."""
    leader = {c: c for c in levels}

    def root(c: int) -> int:
        while leader[c] != c:
            leader[c] = leader[leader[c]]
            c = leader[c]
        return c

    held = []
    for row in columns:
        linked = [c for c in row if c in levels]
        if linked and len(row) == 1:
            held.append(linked[0])
        for c in linked[1:]:
            leader[root(c)] = root(linked[0])
    anchored = {root(c) for c in held}
    groups: dict[int, list[int]] = {}
    for c in levels:
        groups.setdefault(root(c), []).append(c)
    return [group for key, group in groups.items() if key not in anchored]


def _zero(slope: object) -> bool:
    """Whether an expression vanishes, at a few places drawn at random."""
    free = ca.symvar(slope)
    function = ca.Function("slope", [column(free)], [slope])
    random = np.random.default_rng(0)
    values = np.array([function(random.uniform(0.5, 1.5, len(free))).full().ravel() for _ in range(3)])
    size = np.abs(values[np.isfinite(values)]).max(initial=0.0)
    return bool(np.isfinite(values).all() and size <= 1e-12)
