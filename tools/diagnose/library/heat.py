"""Heat that no shaft brings."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ....model.machines.roles import Roles
from .cause import Cause, Mostly, Shape, Small
from .extras import Extras
from .forms import Context, weighed

#: A machine stands below this share of its typical speed, with as gradual a change.
STANDS = 0.05


def causes(at: Context) -> Iterator[Cause]:
    """All causes of the family.

    Args:
        at: machine, data and instruments
    """
    yield external_source(at)
    if "logs" in at.ranges.known:
        yield parked(at)


def bodies(roles: Roles) -> tuple[str, tuple[str, ...]]:
    """Heat ports of a body that turns and of those of the housing, the oil's where there is none."""
    teeth = [place.inner for place in roles.places["teeth"]]
    inside = next(iter([*teeth, *(f"{name}.heat" for name in roles.inside)]), roles.oil_heat)
    return inside, tuple(f"{name}.heat" for name in roles.outside) or (roles.oil_heat,)


def external_source(at: Context) -> Cause:
    """Heat that comes from beside the machine, into one body of the housing or by the shaft."""
    extras = Extras("source", at)
    inside, outside = bodies(at.roles)
    shapes = (
        Mostly("a", "1", "exponent of the speed", 0.0, 2.2),
        Mostly("c", "1", "exponent of the load: of a motor's heat, the square of its current", 0.0, 2.0),
        Small("oil_share", "1", "share of the heat that goes into the oil", 0.0, 0.5),
        Small("inner_share", "1", "share of the rest that enters by the shaft", 0.0, 1.0),
    )
    made = [extras.heat(inside, port, k, len(outside)) for k, port in enumerate(outside)]
    alone = [extras.with_parts([part], shapes) for part in made]
    sides = [extras.with_parts(made[-1:], shapes, x) for x in at.regimes(("w", "tau", "room", "direction", "order"))]
    names = [port.partition(".")[0] if len(outside) > 1 else "" for port in outside]
    return Cause(
        id="heat.external_source",
        doc="Heat from a motor, a neighbour or the sun: it warms, and no torque shows it.",
        size=at.power("heat flow rate", 0.085, -0.3, 1.2),
        forms=weighed([replace(f, name=n) for f, n in zip(alone, names, strict=True)], sides=sides),
        exposes="temperatures with the gearbox at rest and its neighbours running",
        acts_on=at.first("speed"),
    )


def parked(at: Context) -> Cause:
    """Heat while the machine stands."""
    extras = Extras("parked", at)
    inside, outside = bodies(at.roles)
    part, nets = extras.heat(inside, outside[-1], 0, 1)
    w = STANDS * at.ranges.mid["w"]
    part = replace(part, values={**part.values, "a": 0.0, "w_on": w, "w_side": -1.0, "w_width": w / 3})
    shapes = (Shape("oil_share", "1", "share of the heat that goes into the oil", 0.0, 1.0, 0.5, 0.4),)
    return Cause(
        id="heat.parked",
        doc="Heat while the machine stands: a heater, a pump, a neighbour that runs.",
        size=at.power("heat flow rate at standstill", 0.085, -0.2, 0.7),
        forms=(extras.with_parts([(part, nets)], shapes),),
        exposes="a logged standstill of some hours",
    )
