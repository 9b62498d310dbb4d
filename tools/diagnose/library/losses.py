"""Losses that are larger or smaller than the model's: powers that brake a shaft and, all but one, heat the machine.

The ranges of the exponents are what the mechanisms span, not what one law says. A power over speed n, viscosity nu and
load: moving oil by inertia is n^3, by viscous drag n^2 nu, in practice n^1.2 to n^2.8 with little viscosity; a dry lip
is n, a lip on a film n^1.5 nu^0.5; rolling is (n nu)^0.6 n, dry sliding n; teeth with a constant friction coefficient
are n F, in elastohydrodynamic contact up to n^0.7 F^1.3, with shared load and changing contact up to F^2.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import casadi as ca

from ..campaign.table import Sensor
from .cause import Cause, Form, Ranges, Row, Shape, Size, Theta, Values
from .forms import INNER_SHARE, Extras, Regime, oil_share, regimes
from .roles import Place, Roles

NO_LOAD = "no-load oil loss: churning, windage and oil level differ only in how the oil is reached"
SHAFTS = "friction of shafts: preload and seal drag are the same torque to every steady instrument"
TEETH, LIPS, MIST = oil_share(0.8, 0.15), oil_share(0.6, 0.25), oil_share(0.4, 0.25)
#: Shares of the forms of starved teeth: by exponents, below a film, above a speed.
STARVED = (0.5, 0.42, 0.08)


def causes(roles: Roles, ranges: Ranges, sensors: Sequence[Sensor]) -> Iterator[Cause]:
    """All causes of the family that the machine's parts allow.

    Args:
        roles: of the machine
        ranges: of the data
        sensors: of the campaign
    """
    both = any(s.signs[0] != s.signs[1] for s in sensors) or ranges.varies("direction")
    if wet := roles.places["churning"]:
        yield from no_load(wet, roles, ranges)
    if roles.bath:
        yield oil_viscosity(roles)
    if bearings := roles.places["bearing"]:
        yield bearing_preload(bearings, roles, ranges, both)
    if seals := roles.places["seal"]:
        yield seal_drag(seals, roles, ranges, both)
    if teeth := roles.places["teeth"]:
        yield from mesh(teeth, roles, ranges, both)
    yield from torque_only(roles, ranges, sensors)


def power(ranges: Ranges, doc: str, sd: float, low: float, high: float) -> Size:
    """A power [W] at the middle of the data.

    Args:
        ranges: of the data
        doc: in words
        sd, low, high: in shares of the typical loss
    """
    P = ranges.loss
    return Size("P_ref", "W", f"{doc}, at the middle of the data", sd * P, low * P, high * P)


def no_load(places: Sequence[Place], roles: Roles, ranges: Ranges) -> Iterator[Cause]:
    """What moves oil and air."""
    speed = Shape("a", "1", "exponent of the speed", 1.2, 2.8, 2.0, 0.45)
    shapes = (speed, Shape("b", "1", "exponent of the viscosity", 0.0, 0.35), TEETH)
    yield Cause(
        id="losses.churning",
        doc="A loss without load that grows with speed: what turns in the oil moves it.",
        size=power(ranges, "loss", 0.085, 0.0, 0.6),
        forms=Extras("churning", roles, ranges).losses(places, shapes, regimes(("w", "T"), ranges, False)),
        exposes="points at higher speed and little load; a coast-down without load",
        like=NO_LOAD,
        acts_on="w",
    )
    shapes = (
        Shape("a", "1", "exponent of the speed", 1.0, 2.5, 1.6, 0.4),
        Shape("b", "1", "exponent of the viscosity", 0.0, 0.6),
        TEETH,
    )
    yield Cause(
        id="losses.oil_level",
        doc="Oil level off its mark: a no-load loss that follows viscosity and, less, speed.",
        size=power(ranges, "loss", 0.07, -0.15, 0.6),
        forms=Extras("level", roles, ranges).losses(places[:1], shapes),
        exposes="the same point at two oil levels",
        like=NO_LOAD,
        acts_on="w",
    )
    shapes = (Shape("a", "1", "exponent of the speed", 2.6, 3.4, 3.0, 0.2), MIST)
    yield Cause(
        id="losses.windage",
        doc="A loss without load, steep in speed and without viscosity: air and mist are moved.",
        size=power(ranges, "loss", 0.057, 0.0, 0.6),
        forms=Extras("windage", roles, ranges).losses(places[:1], shapes, regimes(("w",), ranges, False)),
        exposes="points at higher speed and little load, at two oil levels",
        like=NO_LOAD,
        acts_on="w",
    )


def oil_viscosity(roles: Roles) -> Cause:
    """Another oil."""
    bath = roles.bath

    def values(theta: Theta, row: Row) -> Values:
        return {
            f"{bath}.{key}": row.base[f"{bath}.{key}"] * ca.exp(theta["ln_factor"] * (1 + side * theta["slope"] / 2))
            for key, side in (("nu_40", -1), ("nu_100", 1))
        }

    slope = Shape("slope", "1", "relative difference of that logarithm between 100 and 40 degC", -0.9, 0.9, 0.0, 0.4)
    return Cause(
        id="losses.oil_viscosity",
        doc="The oil is thicker or thinner than assumed; it acts on all that the oil lubricates.",
        size=Size("ln_factor", "1", "logarithm of the factor on the viscosity", 0.4, -1.6, 1.6),
        forms=(Form(shapes=(slope,), values=values),),
        exposes="a viscosity measurement of a sample; a warm-up from cold",
        acts_on="T",
    )


def bearing_preload(places: Sequence[Place], roles: Roles, ranges: Ranges, both: bool) -> Cause:
    """Bearings that carry more."""
    shapes = (
        Shape("a", "1", "exponent of the speed", 0.8, 1.6, 1.1, 0.18),
        Shape("b", "1", "exponent of the viscosity, as warmth loosens or tightens", -0.5, 0.6, 0.05, 0.22),
        Shape("c", "1", "exponent of the load", 0.0, 0.6, 0.0, 0.15),
        LIPS,
        INNER_SHARE,
    )
    return Cause(
        id="losses.bearing_preload",
        doc="A friction torque that hardly follows load: bearings preloaded more or less than assumed.",
        size=power(ranges, "loss of all bearings", 0.07, -0.2, 0.6),
        forms=Extras("preload", roles, ranges).losses(
            places, shapes, regimes(("w", "tau", "T", "direction"), ranges, both)
        ),
        exposes="drag torque measured by hand, temperature at the bearings",
        like=SHAFTS,
        acts_on="w",
    )


def seal_drag(places: Sequence[Place], roles: Roles, ranges: Ranges, both: bool) -> Cause:
    """Seals that brake more."""
    shapes = (
        Shape("a", "1", "exponent of the speed", 0.6, 1.6, 1.0, 0.2),
        Shape("b", "1", "exponent of the viscosity: none where the lip runs dry", 0.0, 0.5),
        LIPS,
        INNER_SHARE,
    )
    return Cause(
        id="losses.seal_drag",
        doc="A friction torque without load dependence: lips that press more, or run dry.",
        size=power(ranges, "loss of all seals", 0.057, -0.12, 0.45),
        forms=Extras("seal", roles, ranges).losses(places, shapes, regimes(("w", "T", "direction"), ranges, both)),
        exposes="drag torque measured by hand, temperature at the lips",
        like=SHAFTS,
        acts_on="w",
    )


def mesh(places: Sequence[Place], roles: Roles, ranges: Ranges, both: bool) -> Iterator[Cause]:
    """Teeth that rub otherwise."""
    shapes = (
        Shape("a", "1", "exponent of the speed", 0.35, 1.35, 0.85, 0.2),
        Shape("b", "1", "exponent of the viscosity", -0.4, 0.1, -0.05, 0.1),
        Shape("c", "1", "exponent of the load", 0.6, 2.1, 1.25, 0.35),
        TEETH,
    )
    yield Cause(
        id="losses.mesh_friction",
        doc="A loss that grows with load: friction of the teeth, roughness, additives.",
        size=power(ranges, "loss of all teeth", 0.07, -0.2, 0.6),
        forms=Extras("mesh", roles, ranges).losses(places, shapes, regimes(("w", "tau", "T"), ranges, False)),
        exposes="points at small and at large load, at one speed",
        acts_on="tau",
    )
    if both:
        yield mesh_direction(places, roles, ranges)
    yield film_starvation(places, roles, ranges)


def mesh_direction(places: Sequence[Place], roles: Roles, ranges: Ranges) -> Cause:
    """Teeth that rub differently in the two directions of the power flow."""
    shapes = (
        Shape("a", "1", "exponent of the speed", 0.5, 1.4, 1.0, 0.18),
        Shape("c", "1", "exponent of the load", 0.4, 1.7, 1.1, 0.22),
        Shape("driven", "1", "share of the difference that the driven side has", 0.0, 1.0),
        TEETH,
    )

    def sides(theta: Theta) -> Theta:
        return {**theta, "forward": theta["driven"] - 1.0, "backward": theta["driven"]}

    return Cause(
        id="losses.mesh_direction",
        doc="A loss under load in one direction of the power flow only.",
        size=power(ranges, "loss where the shaft is driven less that where it drives", 0.07, -0.45, 0.45),
        forms=Extras("direction", roles, ranges).losses(places, shapes, as_keys=sides),
        exposes="the halves of a test in reversed order",
        acts_on="direction",
    )


def film_starvation(places: Sequence[Place], roles: Roles, ranges: Ranges) -> Cause:
    """Teeth whose film breaks down where it is hot or fast."""
    film = Shape("p", "1", "exponent of the film (speed times viscosity) by which it falls", 0.3, 2.3, 1.2, 0.6)
    shapes = (
        Shape("a", "1", "exponent of the speed at the same film", 0.5, 1.3, 0.9, 0.15),
        Shape("c", "1", "exponent of the load", 0.6, 2.1, 1.2, 0.3),
        TEETH,
    )

    def thin(theta: Theta) -> Theta:
        return {**theta, "a": theta["a"] - theta["p"], "b": -theta["p"]}

    extras = Extras("starvation", roles, ranges)
    wet = all(place.lubricant for place in places)
    kinds: list[Form] = []
    if wet:
        kinds += extras.losses(places, (film, *shapes), weight=STARVED[0], as_keys=thin)
        kinds += extras.limited(places, shapes, Regime("film", above=False), STARVED[1])
    kinds += extras.limited(places, shapes, Regime("w", above=True), STARVED[2] if wet else 1.0)
    return Cause(
        id="losses.film_starvation",
        doc="A loss under load that grows where films are thin: slow and hot, or so fast that they are starved.",
        size=power(ranges, "loss where it acts", 0.085, 0.0, 0.9),
        forms=tuple(kinds),
        exposes="points at high load and low viscosity, with and without fresh oil",
        acts_on="film",
    )


def torque_only(roles: Roles, ranges: Ranges, sensors: Iterable[Sensor]) -> Iterator[Cause]:
    """Friction between a torque transducer and the machine."""
    if not roles.room or not roles.ends or not any(s.kind in ("torque", "power") for s in sensors):
        return
    floor = f"{roles.room}.floor"
    place = Place("couplings", (), f"{roles.ends[0]}.flange", floor, floor, "")
    shapes = (
        Shape("a", "1", "exponent of the speed", 0.8, 2.5, 1.1, 0.4),
        Shape("c", "1", "exponent of the load", 0.0, 1.3, 0.0, 0.5),
    )
    yield Cause(
        id="losses.torque_only",
        doc="A loss that the torques show and the machine does not feel as heat: couplings, bearings of the test rig.",
        size=power(ranges, "loss", 0.07, -0.2, 0.6),
        forms=Extras("torque_only", roles, ranges).losses([place], shapes, heats=floor),
        exposes="a run with the gearbox taken out; a transducer at the gearbox's shaft",
        acts_on="w",
    )
