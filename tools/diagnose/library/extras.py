"""Extra parts of a cause at the places where it may act, and the forms that use them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace

from ....model.laws.oil import kinematic_viscosity
from ....model.machines.roles import Place
from ....model.machines.spec import PartSpec
from ....scenarios.nuisances import Nuisance
from .cause import Form, Num, Row, Shape, Theta, Values
from .forms import Context, Regime, weighed

#: An extra part and what it meets.
Made = tuple[PartSpec, tuple[tuple[str, ...], ...]]
#: Size, shapes and row -> parameters of an extra part.
Keys = Callable[[Theta, Row], Mapping[str, Num]]
#: So far below everything that its side does not matter.
NEVER = -1e9
#: A film above every other.
THICK = 1e9
#: References of speed and torque are not below this [rad/s, N.m].
LEAST = 1e-3
#: Parameters of an extra part that shapes of a form may hold.
KEYS = ("a", "b", "c", "e", "forward", "backward", "oil_share", "inner_share")
#: Typical size of the uncertain friction in thin films, as a share of the typical loss [1].
THIN_FILMS = 0.057
#: Exponents of speed (a), viscosity (b) and load (c), typical of starved teeth, and the share of the heat in the oil.
EXPONENTS = {"a": -0.35, "b": -1.2, "c": 1.2, "oil_share": 0.8}


class Extras:
    """Makes the extra parts of one cause, by whose short name `kind` they are named, and forms that use them."""

    def __init__(self, kind: str, at: Context) -> None:
        self.kind, self.roles, self.ranges = kind, at.roles, at.ranges

    def open(self) -> dict[str, float]:
        """Values of an extra part that acts everywhere, and of which there is nothing."""
        w, tau = (max(self.ranges.mid[quantity], LEAST) for quantity in ("w", "tau"))
        values = {"P_ref": 0.0, "w_ref": w, "tau_ref": tau, "a": 1.0, "c": 0.0}
        values |= {"forward": 1.0, "backward": 1.0, "oil_share": 0.5, "inner_share": 0.5}
        for quantity in ("w", "tau", "T"):
            values |= {f"{quantity}_on": NEVER, f"{quantity}_side": 1.0, f"{quantity}_width": 1.0}
        return values

    def nu_ref(self, lubricant: str) -> float:
        """Viscosity of a lubricant at the middle of the data [m2/s]."""
        bath = self.roles.at(lubricant, "bath", "grease")
        if bath == self.roles.bath:
            return self.ranges.mid["nu"]
        values = self.roles.spec.part(bath).values
        return float(kinematic_viscosity(self.ranges.mid["T"], float(values["nu_40"]), float(values["nu_100"])))

    def _name(self, number: int, of: int) -> str:
        """Of one of several parts."""
        return f"extra_{self.kind}" + (f"_{number + 1}" if of > 1 else "")

    def loss(self, place: Place, number: int, of: int, heats: str = "") -> Made:
        """An extra loss at a place, and what it meets; `heats` is a port that takes the oil's share of the heat."""
        oil = heats or self.roles.oil_heat
        name = self._name(number, of)
        values, nets = self.open(), [(f"{name}.shaft", place.shaft), (f"{name}.reading", self.roles.reading)]
        nets += [(f"{name}.oil", oil), (f"{name}.inner", place.inner), (f"{name}.outer", place.outer)]
        if not place.lubricant:
            return PartSpec(name, "ExtraDryLoss", values), tuple(nets)
        values |= {"b": 0.0, "nu_ref": self.nu_ref(place.lubricant), "film_on": THICK}
        return PartSpec(name, "ExtraLoss", values), (*nets, (f"{name}.lubricant", place.lubricant))

    def heat(self, inner: str, outer: str, number: int, of: int) -> Made:
        """A heat source, and what it meets: the oil, and ports of two bodies that it heats beside it."""
        name, roles = self._name(number, of), self.roles
        nets = ((f"{name}.oil", roles.oil_heat), (f"{name}.inner", inner), (f"{name}.outer", outer))
        return PartSpec(name, "ExtraHeat", self.open()), (*nets, (f"{name}.reading", roles.reading))

    def conductors(self, ports: Sequence[str]) -> list[Made]:
        """Conductances from bodies to the room, and what they meet."""
        keys, made = ("w_ref", "tau_ref", "c", "forward", "backward", "T_on", "T_side", "T_width"), list[Made]()
        values = {key: value for key, value in self.open().items() if key in keys}
        values |= {"G_ref": 0.0, "dT_ref": self.ranges.rise, "e": 0.0}
        for k, port in enumerate(ports):
            name, room = self._name(k, len(ports)), self.roles.room_of(port)
            nets = ((f"{name}.a", port), (f"{name}.b", f"{room}.floor"), (f"{name}.reading", self.roles.reading))
            made.append((PartSpec(name, "ExtraConductor", values), nets))
        return made

    def losses(
        self,
        places: Sequence[Place],
        shapes: Iterable[Shape],
        limits: Sequence[Regime] = (),
        as_keys: Keys | None = None,
        heats: str = "",
    ) -> tuple[Form, ...]:
        """Losses: one form for all places, one for each of several, one for each regime.

        Args:
            places: where it may act
            shapes: of all forms; named as parameters of the extra part
            limits: regimes
            as_keys: gives the parameters of the extra part, where the shapes are not these
            heats: port that takes the oil's share of the heat, where it is not the oil
        """
        made = [self.loss(place, k, len(places), heats) for k, place in enumerate(places)]
        kept = [s for s in shapes if s.name != "b" or all(place.lubricant for place in places)]
        return self.forms(made, [place.name for place in places], kept, limits, as_keys)

    def forms(
        self,
        made: Sequence[Made],
        names: Sequence[str],
        shapes: Sequence[Shape],
        limits: Sequence[Regime] = (),
        as_keys: Keys | None = None,
    ) -> tuple[Form, ...]:
        """One form for all parts, one by name for each of several, one for each regime; arguments as of `losses`."""
        alone = [self.with_parts([part], shapes, None, as_keys) for part in made]
        single = [replace(form, name=name) for name, form in zip(names, alone, strict=True)]
        sides = [self.with_parts(made, shapes, limit, as_keys) for limit in limits]
        return weighed([self.with_parts(made, shapes, None, as_keys)], single, sides)

    def with_parts(
        self, made: Sequence[Made], shapes: Iterable[Shape], limit: Regime | None = None, as_keys: Keys | None = None
    ) -> Form:
        """One form in which some parts share the size, in a regime if there is one; arguments as of `losses`."""
        names = [part.name for part, _ in made]

        def values(theta: Theta, row: Row) -> Values:
            given = as_keys(theta, row) if as_keys else theta
            keys = {key: given[key] for key in KEYS if key in given}
            share = (1.0 if limit is None else limit.share(theta, row, self.ranges)) / len(names)
            keys |= {size: given[size] * share for size in ("P_ref", "G_ref") if size in given}
            if limit is not None:
                keys |= limit.limits(theta, self.ranges)
            return {f"{name}.{key}": value for name in names for key, value in keys.items()}

        return Form(
            name=limit.name if limit else "",
            shapes=(*shapes, *(limit.shapes(self.ranges) if limit else ())),
            parts=tuple(part for part, _ in made),
            connections=tuple(net for _, nets in made for net in nets),
            values=values,
            regime=limit.told if limit else {},
        )


def thin_film_friction(at: Context) -> Nuisance | None:
    """Uncertain growth of tooth friction in thin films; None for a machine without lubricated teeth.

    A cause that warms the oil takes the machine to films thinner than on any healthy day. The model's tooth friction is
    uncertain there, and without this nuisance its error would be taken for a second cause.
    """
    places = [place for place in at.roles.places["teeth"] if place.lubricant]
    if not places:
        return None
    extras = Extras("habit", at)
    made = [extras.loss(place, k, len(places)) for k, place in enumerate(places)]
    power = {"P_ref": THIN_FILMS * at.ranges.loss / len(places), "k": 1.0}
    parts = tuple(PartSpec(part.name, "ExtraHabit", {**part.values, **EXPONENTS, **power}) for part, _ in made)
    connections = tuple(net for _, nets in made for net in nets)
    paths = {f"{part.name}.k": 1.0 for part in parts}
    return Nuisance("thin films", paths, 0.0, 1.0, parts=parts, connections=connections)
