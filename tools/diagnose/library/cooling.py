"""Cooling that differs from the model's: at surfaces, through feet, between oil and bodies, by coolers and fans."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import casadi as ca

from ....model.laws.smooth import smooth_abs
from ....model.machines.roles import Roles
from ....model.parts.free_form import step
from ....scenarios.measured.table import Sensor
from .cause import Cause, Form, Ranges, Row, Shape, Size, Theta, Values
from .extras import Extras
from .forms import SIDE, Context, Regime, shared

AIR = "moving air: a better coefficient and faster air are one answer"
DAYS = "day to day: humidity and other scatter of the days are one answer unless humidity is measured"
#: Change of relative humidity at which the size of its effect is stated [1].
HUMIDITY_SPAN = 0.15
#: A reference.
HUMIDITY = 0.5


def causes(roles: Roles, ranges: Ranges, sensors: Sequence[Sensor]) -> Iterator[Cause]:
    """All causes of the family that the machine's parts allow.

    Args:
        roles: of the machine
        ranges: of the data
        sensors: of the campaign
    """
    at = Context(roles, ranges, sensors)
    if roles.surfaces:
        yield air(at)
        yield emissivity(roles)
    if roles.room and (roles.foundation or roles.surfaces):
        yield foundation(at)
    if roles.contacts:
        yield contact(at)
    if roles.oil_side:
        yield oil_wall(at)
    if roles.surfaces and "humidity" in ranges.known:
        yield humidity(at)
    if roles.coolers:
        yield cooler(roles)
    if roles.thermostats or roles.switches:
        yield thermostat(roles, ranges)
    if roles.surfaces:
        yield fan(roles)


def factors(paths: Sequence[str], size: str) -> Callable[[Theta, Row], Values]:
    """Values times the exponential of the size.

    Args:
        paths: of the values
        size: its name
    """

    def values(theta: Theta, row: Row) -> Values:
        return {path: row.base[path] * ca.exp(theta[size]) for path in paths}

    return values


def each(roles: Roles, parts: Sequence[str], size: str) -> tuple[Form, ...]:
    """Factors on what all parts do together, and on what each of several does.

    Args:
        roles: of the machine
        parts: their names
        size: name of the factor's logarithm
    """
    return shared(
        [(parts, factors(roles.scaled(*parts), size))], [((p,), factors(roles.scaled(p), size)) for p in parts]
    )


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
        forms=Extras("air", at).conductors(ports, shapes, at.regimes(("T", "direction", "order"))),
        exposes="a fan switched on and off at one point; a cold room",
        like=AIR,
        acts_on="rise",
    )


def emissivity(roles: Roles) -> Cause:
    """A surface that radiates differently."""

    def values(names: Sequence[str]) -> Callable[[Theta, Row], Values]:
        paths = [f"{name}.emissivity" for name in names]
        return lambda theta, row: {path: row.base[path] * (1 + theta["factor"]) for path in paths}

    brightest = max(float(roles.spec.part(name).values["emissivity"]) for name in roles.surfaces)
    single = [((name,), values([name])) for name in roles.surfaces]
    return Cause(
        id="cooling.emissivity",
        doc="Another emissivity: bare metal instead of paint, dust, a shiny cover.",
        size=Size("factor", "1", "relative change of the emissivity", 0.35, -0.95, max(1 / brightest - 1, 0.02)),
        forms=shared([(roles.surfaces, values(roles.surfaces))], single),
        exposes="a cold room; a painted patch",
        acts_on="rise",
    )


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
            R = R if limit is None else R * limit.share(theta, row) * limit.by_rise(theta, row, ranges)
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

    def values(names: Sequence[str]) -> Callable[[Theta, Row], Values]:
        paths = roles.scaled(*names)

        def changed(theta: Theta, row: Row) -> Values:
            log = theta["ln_factor"] * at.by_speed(row, theta, "c")
            return {path: row.base[path] * ca.exp(3 * ca.tanh(log / 3)) for path in paths}

        return changed

    together = [(names, values(names)) for names in dict.fromkeys((roles.wetted, roles.oil_side)) if names]
    single = [((name,), values((name,))) for name in roles.oil_side if (name,) != roles.wetted]
    return Cause(
        id="cooling.oil_wall",
        doc="Another conductance between oil and bodies: level, foam, deposits.",
        size=Size("ln_factor", "1", "logarithm of the factor on the conductance", 0.5, -3.0, 2.2),
        forms=shared(together, single, shapes if speed else ()),
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


def cooler(roles: Roles) -> Cause:
    """A cooler that takes less or more."""
    return Cause(
        id="cooling.cooler",
        doc="Another conductance of a cooler: fouled on the air or the oil side, less flow.",
        size=Size("ln_factor", "1", "logarithm of the factor on the conductance", 0.4, -4.0, 1.5),
        forms=each(roles, roles.coolers, "ln_factor"),
        exposes="inlet and outlet temperatures of the cooler on both sides",
        acts_on="rise",
    )


def thermostat(roles: Roles, ranges: Ranges) -> Cause:
    """A thermostat that keeps another temperature, or is stuck."""
    keeps: dict[str, tuple[str, ...]] = {name: (f"{name}.dT",) for name in roles.thermostats}
    keeps |= {name: (f"{name}.T_open", f"{name}.T_close") for name in roles.switches}

    def values(names: Sequence[str]) -> Callable[[Theta, Row], Values]:
        return lambda theta, row: {path: row.base[path] + theta["dT"] for n in names for path in keeps[n]}

    opened = [name for name in roles.coolers if roles.nets.classes[name].role == "cooler"]

    def stuck(theta: Theta, row: Row) -> Values:
        share = -ca.tanh(theta["dT"] / ranges.rise)  # of the way that it stays open, or closed where it is negative
        whole = {name: row.base[f"{name}.G_open"] for name in opened}
        found = {f"{n}.G_closed": row.base[f"{n}.G_closed"] + G * share * step(share / 0.05) for n, G in whole.items()}
        left = 1 + 0.02 - smooth_abs(share, 0.02)
        return found | {f"{n}.G_open": G * left for n, G in whole.items()}

    span, names = ranges.rise, tuple(keeps)
    forms = shared([(names, values(names))], [((n,), values((n,))) for n in names])
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


def fan(roles: Roles) -> Cause:
    """Air that is faster or slower than stated."""
    return Cause(
        id="cooling.fan",
        doc="The air along the surfaces is faster or slower than stated: a fan that fails, ducts, a draught.",
        size=Size("ln_factor", "1", "logarithm of the factor on the speed of the air", 0.5, -4.0, 2.5),
        forms=(Form(values=factors([f"{room}.k_air" for room in roles.having("room")], "ln_factor")),),
        exposes="the speed of the air measured; the fan switched off at one point",
        like=AIR,
        acts_on="rise",
    )
