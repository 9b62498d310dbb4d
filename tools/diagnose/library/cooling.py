"""Cooling that differs from the model's: at surfaces, through feet, between oil and bodies, by coolers and fans."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import casadi as ca

from ....model.laws.smooth import smooth_abs
from ....model.parts.free_form import step
from .cause import Cause, Form, Row, Theta, Values
from .entries import entry, scaled
from .extras import Extras
from .forms import SIDE, Context, Regime, beside_own_law, no_less, weighed

#: Change of relative humidity at which the size of its effect is stated [1].
HUMIDITY_SPAN = 0.15
#: The least range of a relative change of an emissivity [1].
BRIGHTER = 0.02
#: The least emissivity of a housing [1]: polished cast iron 0.21, galvanised sheet 0.23, oxidised aluminium 0.2 to 0.3
#: (tables of thermographic cameras).
SHINY = 0.2


def causes(at: Context) -> Iterator[Cause]:
    """All causes of the family that the machine's parts allow."""
    roles = at.roles
    air = [f"{name}.surface" for name in roles.surfaces]
    if air:
        yield _conducting(at, "cooling.air", air, roles.surfaces)
        yield from emissivity(at)
    if roles.room and (roles.foundation or air):
        ports = [roles.bodies_of(name)[0] for name in roles.foundation] or air[:1]
        yield _conducting(at, "cooling.foundation", ports, roles.foundation)
    if roles.contacts:
        yield contact(at)
    if roles.oil_side:
        yield oil_wall(at)
    if air and "humidity" in at.ranges.known:
        yield humidity(at, air)
    yield from scaled(at, "cooling.cooler", {name: roles.scaled(name) for name in roles.coolers})
    if roles.thermostats or roles.switches:
        yield thermostat(at)
    yield from fan(at)
    yield from scaled(at, "cooling.oil_flow")


def _conducting(at: Context, name: str, ports: Sequence[str], parts: Sequence[str]) -> Cause:
    """A cause of the table: an extra conductance from some ports to the room, or parts that conduct otherwise."""
    known, rise = entry(name, at), at.ranges.rise
    extras, bodies = Extras(known.part, at), [port.partition(".")[0] for port in ports]
    forms = extras.forms(extras.conductors(ports), bodies, known.shapes, known.regimes)
    cause = known.with_forms(no_less(forms, sum(at.ranges.powers.get(part, 0.0) for part in parts) / rise))
    return beside_own_law(cause, at, {part: (part,) for part in parts}, 1 / rise)


def emissivity(at: Context) -> Iterator[Cause]:
    """A surface that radiates differently: not more than a black one, nor less than bare metal."""
    paths = {name: [f"{name}.emissivity"] for name in at.roles.surfaces}
    brightest = max(float(at.roles.spec.part(name).values["emissivity"]) for name in paths)
    low, high = min(SHINY / brightest - 1, -BRIGHTER), max(1 / brightest - 1, BRIGHTER)
    size = replace(entry("cooling.emissivity", at).cause.size, low=low, high=high)
    yield from scaled(at, "cooling.emissivity", paths, lambda change: 1 + change, size=size)


def contact(at: Context) -> Cause:
    """A resistance between bodies, most likely next to the outer surface."""
    known, roles, ranges = entry("cooling.contact", at), at.roles, at.ranges
    outer = {p for name in (*roles.surfaces, *roles.foundation) for p in roles.nets.met_by(name)}

    def form(name: str, weight: float, limit: Regime | None) -> Form:
        G, paths = roles.conductance(name), roles.scaled(name)

        def changed(theta: Theta, row: Row) -> Values:
            R = theta["R"] * at.by_rise(row, theta, "e")
            R = R if limit is None else R * limit.gate(theta, row, ranges)
            return {path: row.base[path] / smooth_abs(1 + R * G, 0.05) * smooth_abs(1.0, 0.05) for path in paths}

        words = (name if len(roles.contacts) > 1 else "", limit.name if limit else "")
        more, told = (limit.shapes(ranges), limit.told) if limit else ((), {})
        return Form(", ".join(filter(None, words)), weight, (*known.shapes, *more), values=changed, regime=told)

    weights = [2.0 if outer & set(roles.nets.met_by(name)) else 1.0 for name in roles.contacts]
    stiffest = max(roles.conductance(name) for name in roles.contacts)
    size = known.cause.size
    return known.with_forms(
        (
            form(name, (SIDE if limit else 1 - SIDE * len(known.regimes)) * weight / sum(weights), limit)
            for name, weight in zip(roles.contacts, weights, strict=True)
            for limit in (None, *known.regimes)
        ),
        size=replace(size, low=-min(0.9 / stiffest, -size.low)),
    )


def oil_wall(at: Context) -> Cause:
    """Oil that gives its heat to bodies better or worse."""
    known, roles = entry("cooling.oil_wall", at), at.roles

    def form(names: Sequence[str], words: str = "") -> Form:
        paths = roles.scaled(*names)

        def changed(theta: Theta, row: Row) -> Values:
            log = theta["ln_factor"] * at.by_speed(row, theta, "c")
            return {path: row.base[path] * ca.exp(3 * ca.tanh(log / 3)) for path in paths}

        return Form(words, shapes=known.shapes if at.first("speed") else (), values=changed)

    groups = [names for names in dict.fromkeys((roles.wetted, roles.oil_side)) if names]
    together = [form(names, ", ".join(names) if k else "") for k, names in enumerate(groups)]
    single = [form((name,), name) for name in roles.oil_side if (name,) != roles.wetted]
    return known.with_forms(weighed(together, single))


def humidity(at: Context, ports: Sequence[str]) -> Cause:
    """Cooling that follows the humidity of the room."""
    known = entry("cooling.humidity", at)
    extras = Extras(known.part, at)

    def follows(theta: Theta, row: Row) -> Theta:
        return {**theta, "G_ref": theta["G_ref"] * (row.humidity - theta["neutral"]) / HUMIDITY_SPAN}

    return known.with_forms([extras.with_parts(extras.conductors(ports), known.shapes, as_keys=follows)])


def fan(at: Context) -> Iterator[Cause]:
    """A fan that turns slower, and takes less power, or one that is clogged, and takes as much for less air."""
    slower = at.roles.failing("cooling.fan")
    clogged = {part: {path: e for path, e in paths.items() if e == 1.0} for part, paths in slower.items()}
    ways = {"turning slower": slower, "clogged": clogged} if clogged != slower else {"": slower}
    forms = [
        replace(form, name=", ".join(filter(None, (form.name, words))), weight=form.weight / len(ways))
        for words, groups in ways.items()
        for cause in scaled(at, "cooling.fan", groups)
        for form in cause.forms
    ]
    if forms:
        yield entry("cooling.fan", at).with_forms(forms)


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

    names = tuple(keeps)
    forms = weighed([kept(names)], [kept((name,), name) for name in names])
    if opened:
        forms = tuple(replace(f, weight=0.7 * f.weight) for f in forms)
        forms += (Form("stuck part open, or part closed", 0.3, values=stuck),)
    return entry("cooling.thermostat", at).with_forms(forms)
