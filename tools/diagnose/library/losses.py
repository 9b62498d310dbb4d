"""Losses that are larger or smaller than the model's: powers that brake a shaft and, all but one, heat the machine."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

import casadi as ca

from ....model.machines.roles import Place
from .cause import Cause, Form, Num, Row, Theta, Values
from .entries import TABLE, entry, scaled
from .extras import Extras, Keys
from .forms import Context, Regime, beside_own_law, no_less, weighed

#: Shares of the forms of starved teeth: by exponents, below a film, above a speed.
STARVED = (0.5, 0.42, 0.08)
#: Share of the prior of an oil level that shows by what the oil wets, and what that form is called.
WETS = 0.4
CONTACT = "by what the oil wets"


def causes(at: Context) -> Iterator[Cause]:
    """All causes of the family that the machine's parts allow."""
    places = at.roles.places
    if wet := _stirring(at):
        yield _extra_or_factor(at, "losses.churning", wet)
        yield oil_level(at, wet[:1])
        yield extra_loss(at, "losses.windage", wet[:1])
    if at.roles.bath:
        yield oil_viscosity(at)
    if bearings := places["bearing"]:
        yield extra_loss(at, "losses.bearing_preload", bearings)
        yield _extra_or_factor(at, "losses.bearing_friction", bearings)
    for name in (name for name, said in TABLE.items() if said.get("of_parts")):
        yield from scaled(at, name)
    if seals := places["seal"]:
        yield _extra_or_factor(at, "losses.seal_drag", seals)
    if teeth := places["teeth"]:
        yield _extra_or_factor(at, "losses.mesh_friction", teeth)
        if at.both_ways:
            yield extra_loss(at, "losses.mesh_direction", teeth, _sides)
        yield film_starvation(at, teeth)
    yield from torque_only(at)


def extra_loss(at: Context, name: str, places: Sequence[Place], as_keys: Keys | None = None, heats: str = "") -> Cause:
    """A cause of the table that is an extra loss at some places; `as_keys` and `heats` as for `Extras.losses`."""
    known = entry(name, at)
    shapes = [s for s in known.shapes if s.name != "wet" or at.roles.wetted]
    forms = Extras(known.part, at).losses(places, shapes, known.regimes, as_keys, heats)
    if known.rubs:  # what sets in at a speed, a load or a temperature only adds: something begins to rub there
        onsets = tuple(Regime.WORDS.values())
        forms = tuple(replace(f, low=0.0) if f.regime.get("quantity", "").startswith(onsets) else f for f in forms)
    own = sum(at.ranges.powers.get(part, 0.0) for place in places for part in place.parts)
    return known.with_forms(no_less(forms, own) if own else forms)


def _extra_or_factor(at: Context, name: str, places: Sequence[Place]) -> Cause:
    """An extra loss of the table, or a factor on what the parts at some places lose by their own laws."""
    return beside_own_law(extra_loss(at, name, places), at, {place.name: place.parts for place in places})


def _stirring(at: Context) -> Sequence[Place]:
    """Places of what moves oil and air, which keeps a share of the heat, and so does what the oil hits."""
    places, teeth = at.roles.places["churning"], at.roles.places["teeth"]
    if not teeth:
        return places
    housing = [f"{name}.heat" for name in at.roles.outside] or [teeth[0].inner]
    return [replace(place, inner=teeth[0].inner, outer=housing[0]) for place in places]


def oil_level(at: Context, places: Sequence[Place]) -> Cause:
    """An oil level off its mark: a loss that wets more of the housing, too, or contact with a share of the stirring."""
    level, known, loss = extra_loss(at, "losses.oil_level", places), entry("oil_contact", at), at.ranges.loss
    walls = at.roles.scaled(*at.roles.wetted)
    inside = [path for path in at.roles.scaled(*at.roles.oil_side) if path not in walls]

    def stirred(theta: Theta, row: Row) -> Theta:
        return {**theta, "P_ref": theta["stir"] * loss * (ca.exp(theta["ln_factor"]) - 1)}

    def wetting(form: Form, exponents: Callable[[Theta], Mapping[str, Num]]) -> Form:
        def values(theta: Theta, row: Row) -> Values:
            own = form.values(theta, row) if form.values else {}
            return {**own, **{path: row.base[path] * ca.exp(e) for path, e in exponents(theta).items()}}

        return replace(form, values=values)

    def by_loss(theta: Theta) -> dict[str, Num]:
        return dict.fromkeys(walls, theta["wet"] * theta["P_ref"] / loss)

    def by_contact(theta: Theta) -> dict[str, Num]:
        e = theta["ln_factor"]
        return dict.fromkeys(walls, e) | dict.fromkeys(inside, theta["inside"] * e)

    if not walls:
        return level
    stirring = [replace(wetting(form, by_loss), weight=(1 - WETS) * form.weight) for form in level.forms]
    made = Extras(known.part, at).losses(places, known.shapes, as_keys=stirred)
    contact = [replace(wetting(form, by_contact), name=CONTACT, size=known.cause.size, weight=WETS) for form in made]
    return replace(level, forms=(*stirring, *contact))


def oil_viscosity(at: Context) -> Cause:
    """Another oil: what it wets need not follow its viscosity as the laws of the parts say."""
    known, baths = entry("losses.oil_viscosity", at), at.roles.having("bath") or (at.roles.bath,)

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

        return Form(words, shapes=known.shapes, values=thicker)

    return known.with_forms(weighed([form(baths)], [form((bath,), bath) for bath in baths]))


def _sides(theta: Theta, row: Row) -> Theta:
    """Shares of a difference between the directions of the power flow."""
    return {**theta, "forward": theta["driven"] - 1.0, "backward": theta["driven"]}


def film_starvation(at: Context, places: Sequence[Place]) -> Cause:
    """Teeth whose film breaks down where it is hot or fast."""
    known = entry("losses.film_starvation", at)
    shapes = known.shapes[1:]

    def thin(theta: Theta, row: Row) -> Theta:
        return {**theta, "a": theta["a"] - theta["p"], "b": -theta["p"]}

    extras = Extras(known.part, at)
    made = [extras.loss(place, k, len(places)) for k, place in enumerate(places)]
    wet, varies = all(place.lubricant for place in places), at.ranges.varies
    kinds: list[Form] = []
    if wet:
        thinned = extras.losses(places, known.shapes, as_keys=thin)
        kinds += [replace(form, weight=STARVED[0] * form.weight) for form in thinned]
    if wet and varies("film"):
        kinds.append(replace(extras.with_parts(made, shapes, Regime("film", above=False)), weight=STARVED[1]))
    if varies("w") or not kinds:
        kinds.append(replace(extras.with_parts(made, shapes, Regime("w", above=True)), weight=STARVED[2]))
    total = sum(kind.weight for kind in kinds)
    return known.with_forms(replace(kind, weight=kind.weight / total) for kind in kinds)


def torque_only(at: Context) -> Iterator[Cause]:
    """Friction between a torque transducer and the machine."""
    measured = any(s.kind in ("torque", "power", "current") and s.role == "read" for s in at.sensors)
    if measured and at.roles.room and at.roles.ends:
        floor = f"{at.roles.room}.floor"
        place = Place("couplings", (), f"{at.roles.ends[0]}.flange", floor, floor, "")
        yield extra_loss(at, "losses.torque_only", [place], heats=floor)
