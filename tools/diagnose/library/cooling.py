"""Cooling that differs from the model's: at surfaces, through feet, between oil and bodies, by coolers and fans."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import casadi as ca

from ....model.laws.smooth import smooth_abs
from ....model.parts.free_form import step
from .cause import Cause, Form, Row, Shape, Size, Theta, Values
from .extras import Extras
from .forms import SIDE, Context, Regime, linear, scaled, weighed

AIR = "moving air: a better coefficient and faster air are one answer"
DAYS = "day to day: humidity and other scatter of the days are one answer unless humidity is measured"
#: Change of relative humidity at which the size of its effect is stated [1].
HUMIDITY_SPAN = 0.15
#: A reference.
HUMIDITY = 0.5


def causes(at: Context) -> Iterator[Cause]:
    """All causes of the family that the machine's parts allow.

    Args:
        at: machine, data and instruments
    """
    roles = at.roles
    if roles.surfaces:
        yield air(at)
        yield from emissivity(at)
    if roles.room and (roles.foundation or roles.surfaces):
        yield foundation(at)
    if roles.contacts:
        yield contact(at)
    if roles.oil_side:
        yield oil_wall(at)
    if roles.surfaces and "humidity" in at.ranges.known:
        yield humidity(at)
    doc = "Another conductance of a cooler: fouled on the air or the oil side, less flow."
    size = Size("ln_factor", "1", "logarithm of the factor on the conductance", 0.4, -4.0, 1.5)
    exposes = "inlet and outlet temperatures of the cooler on both sides"
    cause = Cause("cooling.cooler", doc, size, (), exposes, acts_on="rise")
    yield from scaled(at, cause, ("room", "order"), {name: roles.scaled(name) for name in roles.coolers})
    if roles.thermostats or roles.switches:
        yield thermostat(at)
    doc = "A fan moves less or more air than stated: it stands still, slips, is dirty, or blows beside the housing."
    size = Size("ln_factor", "1", "logarithm of the factor on the flow; -3 and less: it stands", 0.8, -4.0, 1.5)
    exposes = "the speed of the air measured; the fan switched off at one point"
    cause = Cause("cooling.fan", doc, size, (), exposes, AIR, "rise")
    yield from scaled(at, cause, ("T", "room", "direction", "order"))
    doc = "Less or more oil circulates: a pump that is worn, a filter that is clogged, a nozzle that is blocked."
    size = Size("ln_factor", "1", "logarithm of the factor on the flow", 0.5, -3.0, 1.5)
    exposes = "the pressure behind the pump and the filter"
    cause = Cause("cooling.oil_flow", doc, size, (), exposes, acts_on="rise")
    yield from scaled(at, cause, ("T", "order"))


def air(at: Context) -> Cause:
    """More or less convection."""
    shapes = (
        Shape("e", "1", "exponent of the temperature difference", -0.5, 0.5, 0.05, 0.2),
        Shape("c", "1", "exponent of the speed: a fan on the shaft", -0.2, 1.0, 0.0, 0.2),
    )
    ports = [f"{name}.surface" for name in at.roles.surfaces]
    return Cause(
        id="cooling.air",
        doc="More or less convection: draught, a cover, a fan.",
        size=at.conductance("conductance to the air more than assumed", 0.14, -0.45, 1.15),
        forms=Extras("air", at).conductors(ports, shapes, at.regimes(("T", "room", "direction", "order"))),
        exposes="a fan switched on and off at one point; a cold room",
        like=AIR,
        acts_on="rise",
    )


def emissivity(at: Context) -> Iterator[Cause]:
    """A surface that radiates differently."""
    surfaces = at.roles.surfaces
    brightest = max(float(at.roles.spec.part(name).values["emissivity"]) for name in surfaces)
    doc = "Another emissivity: bare metal instead of paint, dust, a shiny cover."
    size = Size("factor", "1", "relative change of the emissivity", 0.35, -0.95, max(1 / brightest - 1, 0.02))
    cause = Cause("cooling.emissivity", doc, size, (), "a cold room; a painted patch", acts_on="rise")
    yield from scaled(at, cause, groups={name: [f"{name}.emissivity"] for name in surfaces}, law=linear)


def foundation(at: Context) -> Cause:
    """Feet and shafts that conduct more or less."""
    roles = at.roles
    ports = [roles.bodies_of(name)[0] for name in roles.foundation] or [f"{roles.surfaces[0]}.surface"]
    shapes = (Shape("e", "1", "exponent of the temperature difference", -0.35, 0.35, 0.0, 0.15),)
    return Cause(
        id="cooling.foundation",
        doc="Another conductance of feet and shafts to the foundation.",
        size=at.conductance("conductance more than assumed", 0.14, -0.6, 1.15),
        forms=Extras("foundation", at).conductors(ports, shapes, at.regimes(("order",))),
        exposes="transients in a cold room; the temperature of the foundation",
        acts_on="rise",
    )


def contact(at: Context) -> Cause:
    """A resistance between bodies, most likely next to the outer surface."""
    roles, ranges, limits = at.roles, at.ranges, at.regimes(("T", "order"))
    outer = {p for name in (*roles.surfaces, *roles.foundation) for p in roles.nets.met_by(name)}
    shape = Shape("e", "1", "change of its logarithm by as much rise more", -2.0, 1.2, 0.0, 0.8)

    def form(name: str, weight: float, limit: Regime | None) -> Form:
        G, paths = roles.conductance(name), roles.scaled(name)

        def changed(theta: Theta, row: Row) -> Values:
            R = theta["R"] * ca.exp(theta["e"] * (row.rise / ranges.rise - 1))
            R = R if limit is None else R * limit.gate(theta, row, ranges)
            return {path: row.base[path] / smooth_abs(1 + R * G, 0.05) * smooth_abs(1.0, 0.05) for path in paths}

        words = (name if len(roles.contacts) > 1 else "", limit.name if limit else "")
        more, told = (limit.shapes(ranges), limit.told) if limit else ((), {})
        return Form(", ".join(filter(None, words)), weight, (shape, *more), values=changed, regime=told)

    weights = [2.0 if outer & set(roles.nets.met_by(name)) else 1.0 for name in roles.contacts]
    stiffest = max(roles.conductance(name) for name in roles.contacts)
    return Cause(
        id="cooling.contact",
        doc="A gap, gasket or loose seat between bodies.",
        size=Size(
            "R",
            "K/W",
            "resistance more than assumed, at the typical rise",
            0.1 / ranges.conductance,
            -min(0.9 / stiffest, 0.05 / ranges.conductance),
            4.0 / ranges.conductance,
        ),
        forms=tuple(
            form(name, (SIDE if limit else 1 - SIDE * len(limits)) * weight / sum(weights), limit)
            for name, weight in zip(roles.contacts, weights, strict=True)
            for limit in (None, *limits)
        ),
        exposes="transients; a second probe on the outer surface",
        acts_on="rise",
    )


def oil_wall(at: Context) -> Cause:
    """Oil that gives its heat to bodies better or worse."""
    roles, speed = at.roles, at.first("speed")
    shapes = (Shape("c", "1", "exponent of the speed in that logarithm", -0.8, 0.8, 0.0, 0.3),)

    def form(names: Sequence[str], words: str = "") -> Form:
        paths = roles.scaled(*names)

        def changed(theta: Theta, row: Row) -> Values:
            log = theta["ln_factor"] * at.by_speed(row, theta, "c")
            return {path: row.base[path] * ca.exp(3 * ca.tanh(log / 3)) for path in paths}

        return Form(words, shapes=shapes if speed else (), values=changed)

    groups = [names for names in dict.fromkeys((roles.wetted, roles.oil_side)) if names]
    together = [form(names, ", ".join(names) if k else "") for k, names in enumerate(groups)]
    single = [form((name,), name) for name in roles.oil_side if (name,) != roles.wetted]
    return Cause(
        id="cooling.oil_wall",
        doc="Another conductance between oil and bodies: level, foam, deposits.",
        size=Size("ln_factor", "1", "logarithm of the factor on the conductance", 0.5, -3.0, 2.2),
        forms=weighed(together, single),
        exposes="transients; a second probe in the wall",
        acts_on=speed,
    )


def humidity(at: Context) -> Cause:
    """Cooling that follows the humidity of the room."""
    extras = Extras("humidity", at)

    def follows(theta: Theta, row: Row) -> Theta:
        return {**theta, "G_ref": theta["G_ref"] * (row.humidity - theta["neutral"]) / HUMIDITY_SPAN}

    shapes = (Shape("neutral", "1", "humidity at which the nominal holds", 0.2, 0.8, HUMIDITY, 0.08),)
    ports = [f"{name}.surface" for name in at.roles.surfaces]
    made = [extras.conductor(port, k, len(ports)) for k, port in enumerate(ports)]
    return Cause(
        id="cooling.humidity",
        doc="Cooling that changes from day to day with the humidity of the room.",
        size=at.conductance("change of the conductance for 15 % of humidity", 0.03, -0.25, 0.25),
        forms=(extras.with_parts(made, shapes, as_keys=follows),),
        exposes="humidity logged in every test, two days with the same point",
        like=DAYS,
        acts_on="humidity",
    )


def thermostat(at: Context) -> Cause:
    """A thermostat that keeps another temperature, or is stuck."""
    roles, ranges = at.roles, at.ranges
    keeps: dict[str, tuple[str, ...]] = {name: (f"{name}.dT",) for name in roles.thermostats}
    keeps |= {name: (f"{name}.T_open", f"{name}.T_close") for name in roles.switches}

    def kept(names: Sequence[str], words: str = "") -> Form:
        paths = [path for name in names for path in keeps[name]]
        return Form(words, values=lambda theta, row: {path: row.base[path] + theta["dT"] for path in paths})

    opened = [name for name in roles.coolers if roles.nets.classes[name].role == "cooler"]

    def stuck(theta: Theta, row: Row) -> Values:
        share = -ca.tanh(theta["dT"] / ranges.rise)  # of the way that it stays open, or closed where it is negative
        whole = {name: row.base[f"{name}.G_open"] for name in opened}
        found = {f"{n}.G_closed": row.base[f"{n}.G_closed"] + G * share * step(share / 0.05) for n, G in whole.items()}
        left = 1 + 0.02 - smooth_abs(share, 0.02)
        return found | {f"{n}.G_open": G * left for n, G in whole.items()}

    span, names = ranges.rise, tuple(keeps)
    forms = weighed([kept(names)], [kept((name,), name) for name in names])
    if opened:
        forms = tuple(replace(f, weight=0.7 * f.weight) for f in forms)
        forms += (Form("stuck part open, or part closed", 0.3, values=stuck),)
    return Cause(
        id="cooling.thermostat",
        doc="A thermostat that keeps a higher or lower temperature than it is set to, or is stuck.",
        size=Size("dT", "K", "temperature kept less that set", 0.1 * span, -0.8 * span, 0.8 * span),
        forms=forms,
        exposes="a probe where the thermostat measures; the set point moved",
    )
