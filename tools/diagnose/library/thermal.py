"""Heat that no shaft brings, and heat that is stored or appears elsewhere than assumed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import casadi as ca
import numpy as np

from ....model.machines.roles import Roles
from ....model.machines.spec import PartSpec
from ....model.parts.free_form import step
from .cause import Cause, Form, Num, Row, Shape, Theta, Values
from .entries import entry
from .extras import Extras
from .forms import Context, factors, weighed

#: A body gives no more than this share of its capacity.
LEFT = 0.95


def causes(at: Context) -> Iterator[Cause]:
    """All causes of heat that is stored or appears elsewhere."""
    if at.roles.inside or at.roles.outside:
        yield mass(at)
    known = entry("thermal.split", at)
    if forms := [*capacity_moved(at.roles), *heat_moved(at.roles), *losses_moved(at, known.shapes)]:
        yield known.with_forms(replace(f, weight=1 / len(forms)) for f in forms)


def mass(at: Context) -> Cause:
    """Other capacities."""
    roles = at.roles
    groups = {"": (*roles.inside, *roles.outside), "housing": roles.outside, "what turns": roles.inside}
    groups = {name: parts for name, parts in groups.items() if parts}
    if len(groups) == 2:  # one of the groups is all there is
        groups = {"": groups[""]}
    weights = {"": 0.6 if len(groups) > 1 else 1.0, "housing": 0.25, "what turns": 0.15}
    return entry("thermal.mass", at).with_forms(
        Form(name, weights[name], values=factors(roles.scaled(*parts), "ln_factor")) for name, parts in groups.items()
    )


def capacity_moved(roles: Roles) -> Iterator[Form]:
    """Capacity of the housing to what turns."""
    inside, outside = roles.scaled(*roles.inside), roles.scaled(*roles.outside)
    if not inside or not outside:
        return

    def values(theta: Theta, row: Row) -> Values:
        within, around = (sum(row.base[path] for path in paths) for paths in (inside, outside))
        wanted = theta["shift"] * (within + around)
        most = LEFT * (within + (around - within) * step(wanted / (0.05 * within)))  # of the side that gives
        moved = wanted * (1 + (wanted / most) ** 8) ** (-1 / 8)
        up, down = 1 + moved / within, 1 - moved / around
        return {p: row.base[p] * up for p in inside} | {p: row.base[p] * down for p in outside}

    yield Form("capacity", values=values)


def heat_moved(roles: Roles) -> Iterator[Form]:
    """Heat of bearings and seals from the outer body to the inner."""
    places = [p for role in ("bearing", "seal") for p in roles.places[role]]
    paths = [f"{n}.inner_share" for p in places if not roles.nets.meet(p.inner, p.outer) for n in p.parts]
    if not paths:
        return
    stated = {path: float(roles.value(path)) for path in paths}

    def values(theta: Theta, row: Row) -> Values:
        return {path: row.base[path] + _shifted(stated[path], theta["shift"]) for path in paths}

    yield Form("heat of bearings and seals", values=values)


def _shifted(share: float, shift: Num) -> Num:
    """What a share between 0 and 1 gains by a shift, which it follows with slope one in its middle."""
    s = float(np.clip(share, 0.02, 0.98))
    at = float(np.log(s / (1 - s)))
    return 1 / (1 + ca.exp(-(at + 4 * shift))) - s


def losses_moved(at: Context, shapes: tuple[Shape, ...]) -> Iterator[Form]:
    """Heat of all losses from the housing or the oil to what turns, or from the oil to the housing; shapes of each."""
    roles = at.roles
    inside, outside = bodies(roles)
    if not 1 <= len(roles.ends) <= 2:
        return
    for name, part, a, b in (
        ("heat of all losses, from the housing", "extra_move_housing", outside[0], inside),
        ("heat of all losses, from the oil", "extra_move_oil", roles.oil_heat, inside),
        ("heat of all losses, from the oil to the housing", "extra_move_out", roles.oil_heat, outside[0]),
    ):
        if not roles.nets.meet(a, b):
            yield _move(at, name, part, (a, b), shapes)


def _move(at: Context, name: str, part: str, ports: tuple[str, str], shapes: tuple[Shape, ...]) -> Form:
    """A share of the loss taken from the first port to the second."""
    readings = [at.roles.reading_of(end) for end in at.roles.ends]
    kind = "HeatMove" if len(readings) == 1 else "HeatMoveOfTwo"
    nets = [(f"{part}.a", ports[0]), (f"{part}.b", ports[1])]
    nets += [(f"{part}.{key}", reading) for key, reading in zip(("first", "second"), readings, strict=False)]

    def values(theta: Theta, row: Row) -> Values:
        return {f"{part}.share": theta["shift"] * at.by_speed(row, theta, "a")}

    shapes = shapes if at.first("speed") else ()
    return Form(name, 1.0, shapes, (PartSpec(part, kind, {"share": 0.0}),), tuple(nets), values)


def bodies(roles: Roles) -> tuple[str, tuple[str, ...]]:
    """Heat ports of a body that turns and of those of the housing, the oil's where there is none."""
    teeth = [place.inner for place in roles.places["teeth"]]
    inside = next(iter([*teeth, *(f"{name}.heat" for name in roles.inside)]), roles.oil_heat)
    return inside, tuple(f"{name}.heat" for name in roles.outside) or (roles.oil_heat,)


def heat_causes(at: Context) -> Iterator[Cause]:
    """Heat that comes from beside the machine, into one body of the housing or by the shaft."""
    known, (inside, outside) = entry("heat.external_source", at), bodies(at.roles)
    extras = Extras(known.part, at)
    made = [extras.heat(inside, port, k, len(outside)) for k, port in enumerate(outside)]
    alone = [extras.with_parts([part], known.shapes) for part in made]
    sides = [extras.with_parts(made[-1:], known.shapes, limit) for limit in known.regimes]
    names = [port.partition(".")[0] if len(outside) > 1 else "" for port in outside]
    yield known.with_forms(weighed([replace(f, name=n) for f, n in zip(alone, names, strict=True)], sides=sides))
