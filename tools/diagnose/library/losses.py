"""Losses that are larger or smaller than the model's: powers that brake a shaft and, all but one, heat the machine.

The ranges of the exponents are what the mechanisms span, not what one law says. A power over speed n, viscosity nu and
load: moving oil by inertia is n^3, by viscous drag n^2 nu, in practice n^1.2 to n^2.8 with little viscosity; a dry lip
is n, a lip on a film n^1.5 nu^0.5; rolling is (n nu)^0.6 n, dry sliding n; teeth with a constant friction coefficient
are n F, in elastohydrodynamic contact up to n^0.7 F^1.3, with shared load and changing contact up to F^2.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import casadi as ca

from ....model.machines.roles import Place
from .cause import Cause, Form, Row, Shape, Size, Small, Theta, Values
from .extras import Extras
from .forms import INNER_SHARE, Context, Regime, oil_share, scaled, weighed

NO_LOAD = "no-load oil loss: churning, windage and oil level differ only in how the oil is reached"
SHAFTS = "friction of shafts: preload and seal drag are the same torque to every steady instrument"
#: Share of the heat of teeth that goes into the oil: mean and spread.
TEETH = oil_share(0.8, 0.15)
#: The same of seal lips.
LIPS = oil_share(0.6, 0.25)
#: The same of oil mist.
MIST = oil_share(0.4, 0.25)
WET = Shape(
    "wet", "1", "relative change of the oil's conductance to the housing, over that of all losses", 0.0, 1.5, 0.3, 0.4
)
#: Shares of the forms of starved teeth: by exponents, below a film, above a speed.
STARVED = (0.5, 0.42, 0.08)


def causes(at: Context) -> Iterator[Cause]:
    """All causes of the family that the machine's parts allow.

    Args:
        at: machine, data and instruments
    """
    places = at.roles.places
    if wet := places["churning"]:
        yield from no_load(at, wet)
    if at.roles.bath:
        yield oil_viscosity(at)
    if bearings := places["bearing"]:
        yield bearing_preload(at, bearings)
    yield from rubbing(at)
    if seals := places["seal"]:
        yield seal_drag(at, seals)
    if teeth := places["teeth"]:
        yield mesh_friction(at, teeth)
        if at.both_ways:
            yield mesh_direction(at, teeth)
        yield film_starvation(at, teeth)
    yield from torque_only(at)


def no_load(at: Context, places: Sequence[Place]) -> Iterator[Cause]:
    """What moves oil and air."""
    if teeth := at.roles.places["teeth"]:  # what moves the oil keeps a share of the heat, and so does what the oil hits
        housing = [f"{name}.heat" for name in at.roles.outside] or [teeth[0].inner]
        places = [replace(place, inner=teeth[0].inner, outer=housing[0]) for place in places]
    churning: tuple[Shape, ...] = (
        Shape("a", "1", "exponent of the speed", 1.2, 2.8, 2.0, 0.45),
        Shape("b", "1", "exponent of the viscosity", 0.0, 0.35),
        TEETH,
        INNER_SHARE,
    )
    yield Cause(
        id="losses.churning",
        doc="A loss without load that grows with speed: what turns in the oil moves it.",
        size=at.power("loss", 0.085, 0.0, 1.2),
        forms=Extras("churning", at).losses(places, churning, at.regimes(("w", "T", "order"))),
        exposes="points at higher speed and little load; a coast-down without load",
        like=NO_LOAD,
        acts_on=at.first("speed"),
    )
    level: tuple[Shape, ...] = (
        Shape("a", "1", "exponent of the speed", 1.0, 2.5, 1.6, 0.4),
        Shape("b", "1", "exponent of the viscosity", 0.0, 0.6),
        TEETH,
        INNER_SHARE,
        *((WET,) if at.roles.wetted else ()),
    )
    yield Cause(
        id="losses.oil_level",
        doc="Oil level off its mark: a no-load loss that follows viscosity and, less, speed.",
        size=at.power("loss", 0.07, -0.15, 1.0),
        forms=tuple(_wetting(form, at) for form in Extras("level", at).losses(places[:1], level)),
        exposes="the same point at two oil levels",
        like=NO_LOAD,
        acts_on=at.first("speed"),
    )
    windage: tuple[Shape, ...] = (Shape("a", "1", "exponent of the speed", 2.4, 3.4, 2.9, 0.2), MIST, INNER_SHARE)
    yield Cause(
        id="losses.windage",
        doc="A loss without load, steep in speed and without viscosity: air and mist are moved.",
        size=at.power("loss", 0.057, 0.0, 1.0),
        forms=Extras("windage", at).losses(places[:1], windage, at.regimes(("w",))),
        exposes="points at higher speed and little load, at two oil levels",
        like=NO_LOAD,
        acts_on=at.first("speed"),
    )


def _wetting(form: Form, at: Context) -> Form:
    """A loss with an oil level that wets more of the housing, too, where oil and housing meet."""
    loss, paths = form.values, at.roles.scaled(*at.roles.wetted)
    if loss is None or not paths:
        return form

    def values(theta: Theta, row: Row) -> Values:
        more = ca.exp(theta["wet"] * theta["P_ref"] / at.ranges.loss)
        return {**loss(theta, row), **{path: row.base[path] * more for path in paths}}

    return replace(form, values=values)


def oil_viscosity(at: Context) -> Cause:
    """Another oil: what it wets need not follow its viscosity as the laws of the parts say."""
    baths = at.roles.having("bath") or (at.roles.bath,)

    def users(names: Sequence[str], *roles: str) -> tuple[str, ...]:
        places = [place for role in roles for place in at.roles.places[role]]
        fed = [place for place in places if at.roles.at(place.lubricant, "bath") in names]
        return at.roles.scaled(*(part for place in fed for part in place.parts))

    def form(names: Sequence[str], words: str = "") -> Form:
        beside = {"friction": users(names, "teeth"), "drag": users(names, "bearing", "seal")}
        beside["stir"] = at.roles.scaled(*at.roles.oil_side) if at.roles.bath in names else ()

        def thicker(theta: Theta, row: Row) -> Values:
            sides = {"nu_40": 1 - theta["slope"] / 2, "nu_100": 1 + theta["slope"] / 2}
            shares = {f"{bath}.{key}": side for bath in names for key, side in sides.items()}
            shares |= {path: theta[key] for key, paths in beside.items() for path in paths}
            return {path: row.base[path] * ca.exp(theta["ln_factor"] * share) for path, share in shares.items()}

        return Form(words, shapes=shapes, values=thicker)

    shapes = (
        Shape("slope", "1", "relative difference of that logarithm between 100 and 40 degC", -0.9, 0.9, 0.0, 0.4),
        Shape(
            "friction", "1", "exponent of the factor in the friction of teeth, beside their law", -0.5, 0.5, 0.0, 0.15
        ),
        Shape("drag", "1", "the same in the drag of bearings and seals in that oil", -0.5, 0.5, 0.0, 0.15),
        Shape("stir", "1", "exponent of the factor in the conductances of the oil", -0.5, 0.2, -0.1, 0.12),
    )
    return Cause(
        id="losses.oil_viscosity",
        doc="The oil is thicker or thinner than assumed; it acts on all that the oil wets.",
        size=Size("ln_factor", "1", "logarithm of the factor on the viscosity", 0.4, -1.6, 1.6),
        forms=weighed([form(baths)], [form((bath,), bath) for bath in baths]),
        exposes="a viscosity measurement of a sample; a warm-up from cold",
        acts_on=at.first("oil_temp"),
    )


def _rubbing(forms: Iterable[Form]) -> tuple[Form, ...]:
    """The same; those that set in at a speed, a load or a temperature only add: something begins to rub there."""
    onsets = tuple(Regime.WORDS.values())
    return tuple(replace(f, only_adds=f.regime.get("quantity", "").startswith(onsets)) for f in forms)


def rubbing(at: Context) -> Iterator[Cause]:
    """Parts whose whole friction is larger or smaller, whatever they carry."""
    factor, speed = Size("ln_factor", "1", "logarithm of the factor on the friction", 0.5, -1.5, 2.5), at.first("speed")
    doc = "Friction of bearings, with their load, is larger or smaller: dirt, wear, damage, another cage or clearance."
    exposes = "temperature or noise at the bearings; another load at one speed"
    yield from scaled(at, Cause("losses.bearing_friction", doc, factor, (), exposes, SHAFTS, speed), ("order",))
    doc = "The preload of a pair of bearings is not that set, or it settles."
    size = Size("ln_factor", "1", "logarithm of the factor on the preload", 0.5, -3.0, 2.5)
    exposes = "drag torque measured by hand; points at two temperatures of the shaft"
    yield from scaled(at, Cause("losses.pair_preload", doc, size, (), exposes, SHAFTS, speed), ("order",))
    doc, exposes = "A clutch or brake drags more or less where it is open.", "a run with the clutch or brake taken out"
    yield from scaled(at, Cause("losses.clutch_drag", doc, factor, (), exposes, acts_on=speed), ("order",))


def bearing_preload(at: Context, places: Sequence[Place]) -> Cause:
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
        size=at.power("loss of all bearings", 0.07, -0.2, 1.2),
        forms=_rubbing(
            Extras("preload", at).losses(places, shapes, at.regimes(("w", "tau", "T", "direction", "order")))
        ),
        exposes="drag torque measured by hand, temperature at the bearings",
        like=SHAFTS,
        acts_on=at.first("speed"),
    )


def seal_drag(at: Context, places: Sequence[Place]) -> Cause:
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
        size=at.power("loss of all seals", 0.057, -0.12, 1.0),
        forms=_rubbing(Extras("seal", at).losses(places, shapes, at.regimes(("w", "T", "direction", "order")))),
        exposes="drag torque measured by hand, temperature at the lips",
        like=SHAFTS,
        acts_on=at.first("speed"),
    )


def mesh_friction(at: Context, places: Sequence[Place]) -> Cause:
    """Teeth that rub otherwise."""
    shapes = (
        Shape("a", "1", "exponent of the speed", 0.35, 1.35, 0.85, 0.2),
        Shape("b", "1", "exponent of the viscosity", -0.4, 0.1, -0.05, 0.1),
        Shape("c", "1", "exponent of the load", 0.6, 2.1, 1.25, 0.35),
        TEETH,
    )
    return Cause(
        id="losses.mesh_friction",
        doc="A loss that grows with load: friction of the teeth, roughness, additives.",
        size=at.power("loss of all teeth", 0.07, -0.6, 1.2),
        forms=Extras("mesh", at).losses(places, shapes, at.regimes(("w", "tau", "T", "order"))),
        exposes="points at small and at large load, at one speed",
        acts_on=at.first("torque"),
    )


def mesh_direction(at: Context, places: Sequence[Place]) -> Cause:
    """Teeth that rub differently in the two directions of the power flow."""
    shapes = (
        Shape("a", "1", "exponent of the speed", 0.5, 1.4, 1.0, 0.18),
        Shape("c", "1", "exponent of the load", 0.4, 1.7, 1.1, 0.22),
        Shape("driven", "1", "share of the difference that the driven side has", 0.0, 1.0),
        TEETH,
    )

    def sides(theta: Theta, row: Row) -> Theta:
        return {**theta, "forward": theta["driven"] - 1.0, "backward": theta["driven"]}

    return Cause(
        id="losses.mesh_direction",
        doc="A loss under load in one direction of the power flow only.",
        size=at.power("loss where the shaft is driven less that where it drives", 0.07, -0.8, 0.8),
        forms=Extras("direction", at).losses(places, shapes, as_keys=sides),
        exposes="the halves of a test in reversed order",
        acts_on=at.first("torque"),
    )


def film_starvation(at: Context, places: Sequence[Place]) -> Cause:
    """Teeth whose film breaks down where it is hot or fast."""
    film = Shape("p", "1", "exponent of the film (speed times viscosity) by which it falls", 0.3, 2.3, 1.2, 0.6)
    shapes = (
        Shape("a", "1", "exponent of the speed at the same film", 0.5, 1.3, 0.9, 0.15),
        Shape("c", "1", "exponent of the load", 0.6, 2.1, 1.2, 0.3),
        TEETH,
    )

    def thin(theta: Theta, row: Row) -> Theta:
        return {**theta, "a": theta["a"] - theta["p"], "b": -theta["p"]}

    extras = Extras("starvation", at)
    made = [extras.loss(place, k, len(places)) for k, place in enumerate(places)]
    wet, varies = all(place.lubricant for place in places), at.ranges.varies
    kinds: list[Form] = []
    if wet:
        thinned = extras.losses(places, (film, *shapes), as_keys=thin)
        kinds += [replace(form, weight=STARVED[0] * form.weight) for form in thinned]
    if wet and varies("film"):
        kinds.append(replace(extras.with_parts(made, shapes, Regime("film", above=False)), weight=STARVED[1]))
    if varies("w") or not kinds:
        kinds.append(replace(extras.with_parts(made, shapes, Regime("w", above=True)), weight=STARVED[2]))
    total = sum(kind.weight for kind in kinds)
    return Cause(
        id="losses.film_starvation",
        doc="A loss under load that grows where films are thin: slow and hot, or so fast that they are starved.",
        size=at.power("loss where it acts", 0.085, 0.0, 1.5),
        forms=tuple(replace(kind, weight=kind.weight / total) for kind in kinds),
        exposes="points at high load and low viscosity, with and without fresh oil",
        acts_on=at.first("oil_temp"),
    )


def torque_only(at: Context) -> Iterator[Cause]:
    """Friction between a torque transducer and the machine."""
    if (
        not at.roles.room
        or not at.roles.ends
        or not any(s.kind in ("torque", "power") and s.role == "read" for s in at.sensors)
    ):
        return
    floor = f"{at.roles.room}.floor"
    place = Place("couplings", (), f"{at.roles.ends[0]}.flange", floor, floor, "")
    shapes = (
        Shape("a", "1", "exponent of the speed", 0.8, 2.5, 1.1, 0.4),
        Small("c", "1", "exponent of the load", 0.0, 1.3),
    )
    yield Cause(
        id="losses.torque_only",
        doc="A loss that the torques show and the machine does not feel as heat: couplings, bearings of the test rig.",
        size=at.power("loss", 0.12, -0.3, 1.0),
        forms=Extras("torque_only", at).losses([place], shapes, heats=floor),
        exposes="a run with the gearbox taken out; a transducer at the gearbox's shaft",
        acts_on=at.first("speed"),
    )
