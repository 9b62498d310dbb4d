"""What the families share: extra parts at places, regimes, and forms such as "one of them" and "above a speed"."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from ...model.laws.oil import kinematic_viscosity
from ...model.machines.spec import PartSpec
from .cause import Form, Num, Ranges, Row, Shape, Theta, Values
from .roles import Place, Roles

#: An extra part and what it meets.
Made = tuple[PartSpec, tuple[tuple[str, ...], ...]]
#: So far below everything that its side does not matter, and a film above every other.
NEVER, THICK = -1e9, 1e9
#: Share of a cause's prior of the form that acts everywhere, in all parts; places and regimes share the rest.
GENERAL = 0.5
#: How gradually a form usually sets in at a threshold, over the range of its quantity.
USUAL = 0.04
#: No more places than these have forms of their own.
MOST_PLACES = 6
#: Parameters of an extra loss that shapes of a form may hold.
KEYS = ("a", "b", "c", "e", "forward", "backward", "oil_share", "inner_share")
WIDTH = Shape("width", "1", "how gradually it sets in at the threshold, over the usual", 0.4, 3.0, 1.0, 0.75)
INNER_SHARE = Shape("inner_share", "1", "share of the rest that goes to what turns", 0.0, 1.0, 0.5, 0.3)


def oil_share(mean: float, sd: float) -> Shape:
    """The share of a loss that heats the oil."""
    return Shape("oil_share", "1", "share of the heat that goes into the oil", 0.0, 1.0, mean, sd)


@dataclass(frozen=True)
class Regime:
    """One side of a quantity ("w", "tau", "T", "film"), or one direction of the power flow ("direction")."""

    quantity: str
    above: bool

    WORDS = {"w": "speed", "tau": "load", "T": "temperature", "film": "film"}

    @property
    def name(self) -> str:
        """In words."""
        if self.quantity == "direction":
            return "driving only" if self.above else "driven only"
        return f"{'above' if self.above else 'below'} a {self.WORDS[self.quantity]}"

    def shapes(self, ranges: Ranges) -> tuple[Shape, ...]:
        """Threshold and width."""
        if self.quantity == "direction":
            return ()
        unit = {"w": "rad/s", "tau": "N.m", "T": "K", "film": "m2/s2"}[self.quantity]
        low, high = ranges.low[self.quantity], ranges.high[self.quantity]
        threshold = Shape("threshold", unit, f"threshold of the {self.WORDS[self.quantity]}", low, high)
        return (threshold,) if self.quantity == "film" else (threshold, WIDTH)

    def limits(self, theta: Theta, ranges: Ranges) -> dict[str, Num]:
        """Values of an extra part by key."""
        if self.quantity == "direction":
            return {"backward" if self.above else "forward": 0.0}
        if self.quantity == "film":
            return {"film_on": theta["threshold"]}
        width = USUAL * (ranges.high[self.quantity] - ranges.low[self.quantity])
        q = self.quantity
        return {
            f"{q}_on": theta["threshold"],
            f"{q}_side": 1.0 if self.above else -1.0,
            f"{q}_width": width * theta["width"],
        }

    @property
    def told(self) -> Mapping[str, str]:
        """For the words of the report."""
        if self.quantity == "direction":
            return {"quantity": self.name, "shape": ""}
        return {"quantity": f"{self.WORDS[self.quantity]} {'above' if self.above else 'below'}", "shape": "threshold"}


def regimes(quantities: Iterable[str], ranges: Ranges, directions: bool) -> tuple[Regime, ...]:
    """Both sides of each quantity that varies enough.

    Args:
        quantities: "w", "tau", "T", "direction"
        ranges: of the data
        directions: whether power flows both ways in the data
    """
    small = {"T": 5.0 / max(ranges.mid.get("T", 330.0), 1.0)}
    kept = [q for q in quantities if (directions if q == "direction" else ranges.varies(q, small.get(q, 0.1)))]
    return tuple(Regime(q, above) for q in kept for above in (True, False))


class Extras:
    """Makes the extra parts of one cause, and forms that use them.

    Args:
        kind: short name of the cause, which begins the names of its parts
        roles: of the machine
        ranges: of the data
    """

    def __init__(self, kind: str, roles: Roles, ranges: Ranges) -> None:
        self.kind, self.roles, self.ranges = kind, roles, ranges

    def open(self) -> dict[str, float]:
        """Values of an extra part that acts everywhere, and of which there is nothing."""
        r = self.ranges
        values = {"P_ref": 0.0, "w_ref": r.mid["w"], "tau_ref": r.mid["tau"], "a": 1.0, "c": 0.0}
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

    def heat(self, inner: str, outer: str) -> Made:
        """A heat source, and what it meets."""
        name, roles = f"extra_{self.kind}", self.roles
        nets = ((f"{name}.oil", roles.oil_heat), (f"{name}.inner", inner), (f"{name}.outer", outer))
        return PartSpec(name, "ExtraHeat", self.open()), (*nets, (f"{name}.reading", roles.reading))

    def conductor(self, port: str, number: int, of: int) -> Made:
        """A conductance from a body to the room, and what it meets."""
        name, room = self._name(number, of), self.roles.room_of(port)
        keys = ("w_ref", "tau_ref", "c", "forward", "backward", "T_on", "T_side", "T_width")
        values = {key: value for key, value in self.open().items() if key in keys}
        values |= {"G_ref": 0.0, "dT_ref": self.ranges.rise, "e": 0.0}
        nets = ((f"{name}.a", port), (f"{name}.b", f"{room}.floor"), (f"{name}.reading", self.roles.reading))
        return PartSpec(name, "ExtraConductor", values), nets

    def losses(
        self,
        places: Sequence[Place],
        shapes: Iterable[Shape],
        limits: Sequence[Regime] = (),
        weight: float = 1.0,
        as_keys: Callable[[Theta], Theta] = dict,
        heats: str = "",
    ) -> tuple[Form, ...]:
        """Losses: one form for all places, one for each of several, one for each regime; they share the weight.

        Args:
            places: where it may act
            shapes: of all forms; named as parameters of the extra part
            limits: regimes
            weight: of all forms together
            as_keys: size and shapes -> parameters of the extra part, where they are not the same
            heats: port that takes the oil's share of the heat, where it is not the oil
        """
        made = [self.loss(place, k, len(places), heats) for k, place in enumerate(places)]
        kept = tuple(s for s in shapes if s.name != "b" or all(place.lubricant for place in places))
        return self.forms(made, [place.name for place in places], kept, limits, weight, as_keys)

    def conductors(
        self, ports: Sequence[str], shapes: Iterable[Shape], limits: Sequence[Regime] = ()
    ) -> tuple[Form, ...]:
        """Conductances to the room: one form for all bodies, one for each of several, one for each regime.

        Args:
            ports: where heat leaves the bodies
            shapes: of all forms; named as parameters of the extra part
            limits: regimes
        """
        made = [self.conductor(port, k, len(ports)) for k, port in enumerate(ports)]
        return self.forms(made, [port.partition(".")[0] for port in ports], tuple(shapes), limits)

    def forms(
        self,
        made: Sequence[Made],
        names: Sequence[str],
        shapes: tuple[Shape, ...],
        limits: Sequence[Regime] = (),
        weight: float = 1.0,
        as_keys: Callable[[Theta], Theta] = dict,
    ) -> tuple[Form, ...]:
        """One form for all parts, one for each of several, one for each regime; they share the weight.

        Args:
            made: the parts
            names: of their places
            shapes: of all forms
            limits: regimes
            weight: of all forms together
            as_keys: size and shapes -> parameters of the extra part
        """
        single = list(zip(names, made, strict=True)) if 1 < len(made) <= MOST_PLACES else []
        rest = (1 - GENERAL) * weight / max(len(single) + len(limits), 1)
        general = Form(weight=GENERAL * weight if single or limits else weight, shapes=shapes)
        one = Form(weight=rest, shapes=shapes)
        found = [self._with_parts(general, made, None, as_keys)]
        found += [self._with_parts(replace(one, name=name), [part], None, as_keys) for name, part in single]
        found += [self._with_parts(one, made, limit, as_keys) for limit in limits]
        return tuple(found)

    def limited(self, places: Sequence[Place], shapes: Iterable[Shape], limit: Regime, weight: float) -> list[Form]:
        """One form for all places in a regime; none where its quantity hardly varies.

        Args:
            places: where it acts
            shapes: of the form
            limit: the regime
            weight: of the form
        """
        made = [self.loss(place, k, len(places)) for k, place in enumerate(places)]
        return [self._with_parts(Form(weight=weight, shapes=tuple(shapes)), made, limit, dict)]

    def _with_parts(
        self, form: Form, made: Sequence[Made], limit: Regime | None, as_keys: Callable[[Theta], Theta]
    ) -> Form:
        names = [part.name for part, _ in made]

        def values(theta: Theta, row: Row) -> Values:
            given = as_keys(theta)
            keys = {key: given[key] for key in KEYS if key in given}
            keys |= {size: given[size] / len(names) for size in ("P_ref", "G_ref") if size in given}
            if limit is not None:
                keys |= limit.limits(theta, self.ranges)
            return {f"{name}.{key}": value for name in names for key, value in keys.items()}

        return replace(
            form,
            name=limit.name if limit else form.name,
            shapes=(*form.shapes, *(limit.shapes(self.ranges) if limit else ())),
            parts=tuple(part for part, _ in made),
            connections=tuple(net for _, nets in made for net in nets),
            values=values,
            regime=limit.told if limit else {},
        )
