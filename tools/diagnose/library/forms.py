"""What the families share: regimes such as "above a speed", and forms such as "all of them" and "one of them"."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import casadi as ca

from ....model.laws.smooth import smooth_abs
from ....model.machines.roles import Roles
from ....model.parts.free_form import step
from ....scenarios.measured.table import Sensor
from .cause import Cause, Form, Num, Ranges, Row, Shape, Size, Theta, Values

#: Share of a cause's prior of the forms that act in one of several parts only.
ONE_PLACE = 0.5
#: The same beside regimes.
BESIDE = 0.25
#: Of each side of a regime: as likely for every cause.
SIDE = 0.05
#: Share of a cause's prior of the forms by which it is a factor on a law that the machine has.
OWN_LAW = 0.5
#: What they are called.
BY_LAW = "by its own law"
#: Share of what a law says that may be missing.
MOST_LESS = 0.95
#: How gradually a form usually sets in at a threshold, over the range of its quantity.
USUAL = 0.04
#: Share of the middle speed below which what follows the speed no longer does.
SLOW = 0.05
#: The same of the rise of the oil.
COOL = 0.02
#: Temperatures that range over less have no sides [K].
LEAST_SPAN = 5.0
#: No more places than these have forms of their own.
MOST_PLACES = 6
WIDTH = Shape("width", "1", "how gradually it sets in at the threshold, over the usual", 0.4, 5.0, 1.0, 1.25)
#: How gradually something sets in with the running order, which goes from 0 to 1.
ORDER_STEP = 0.02
PLACE = Shape("threshold", "1", "where in the running order: 0 first test, 1 last", 0.0, 1.0)
FROM_THEN = {"quantity": "order above", "shape": "threshold"}


def since(theta: Theta, row: Row) -> Num:
    """0 before and 1 after a place in the running order."""
    return step((row.order - theta["threshold"]) / ORDER_STEP)


@dataclass(frozen=True)
class Course:
    """A way of a change over the running order: words, share of the prior, its shapes, and how far it is, 0 to 1."""

    words: str
    share: float
    shapes: tuple[Shape, ...]
    at: Callable[[Theta, Row], Num]


COURSES = (
    Course(
        "",
        0.65,
        (Shape("power", "1", "exponent of the running order", 0.3, 2.0, 0.9, 0.35),),
        lambda theta, row: (row.order + 1e-9) ** theta["power"],
    ),
    Course(
        "settling",
        0.35,
        (Shape("decay", "1", "share of the campaign in which it settles: running in", 0.05, 0.6),),
        lambda theta, row: (1 - ca.exp(-row.order / theta["decay"])) / (1 - ca.exp(-1 / theta["decay"])),
    ),
)


@dataclass(frozen=True)
class Regime:
    """One side of a quantity ("w", "tau", "T", "film", "room"), one direction, or from a test on ("order").

    Args:
        quantity, above: what is limited, and to which side
        sensor: that shows it, where no part of the machine knows
        span: its range, where it is not that of its quantity in the data
    """

    quantity: str
    above: bool
    sensor: str = ""
    span: tuple[float, float] | None = None

    WORDS = {"w": "speed", "tau": "load", "T": "temperature", "film": "film", "room": "room temperature"}

    @property
    def name(self) -> str:
        """In words."""
        if self.quantity == "direction":
            return "driving only" if self.above else "driven only"
        if self.quantity == "order":
            return "from one test on"
        return f"{'above' if self.above else 'below'} a {self.WORDS[self.quantity]}"

    def shapes(self, ranges: Ranges) -> tuple[Shape, ...]:
        """Threshold and width."""
        if self.quantity in ("direction", "order"):
            return (PLACE,) if self.quantity == "order" else ()
        unit = {"w": "rad/s", "tau": "N.m", "film": "m2/s2"}.get(self.quantity, "K")
        low, high = self.bounds(ranges)
        threshold = Shape("threshold", unit, f"threshold of the {self.WORDS[self.quantity]}", low, high)
        return (threshold,) if self.quantity == "film" else (threshold, WIDTH)

    def bounds(self, ranges: Ranges) -> tuple[float, float]:
        """Range of its quantity in the data."""
        name = self.sensor or self.quantity
        return self.span or (ranges.low[name], ranges.high[name])

    def share(self, theta: Theta, row: Row, ranges: Ranges) -> Num:
        """How much of the size acts in a row, by what no part of the machine knows."""
        if self.quantity == "order":
            return since(theta, row)
        return self.beyond(row.sensors[self.sensor], theta, ranges) if self.quantity == "room" else 1.0

    def gate(self, theta: Theta, row: Row, ranges: Ranges) -> Num:
        """How much of the size acts in a row; the oil's temperature is told from its rise over a usual room."""
        if self.quantity == "T":
            return self.beyond(ranges.mid["T"] + row.rise - ranges.rise, theta, ranges)
        if self.quantity == "direction":
            return (1 + (row.direction if self.above else -row.direction)) / 2
        return self.share(theta, row, ranges)

    def beyond(self, value: Num, theta: Theta, ranges: Ranges) -> Num:
        """Whether the magnitude of a value lies on its side of the threshold, 0 to 1."""
        low, high = self.bounds(ranges)
        side = 1.0 if self.above else -1.0
        return step(side * (ca.fabs(value) - theta["threshold"]) / (USUAL * (high - low) * theta["width"]))

    def limits(self, theta: Theta, ranges: Ranges) -> dict[str, Num]:
        """Values of an extra part by key."""
        if self.quantity in ("order", "room"):
            return {}
        if self.quantity == "direction":
            return {"backward" if self.above else "forward": 0.0}
        if self.quantity == "film":
            return {"film_on": theta["threshold"]}
        q, side = self.quantity, 1.0 if self.above else -1.0
        width = USUAL * (ranges.high[q] - ranges.low[q]) * theta["width"]
        return {f"{q}_on": theta["threshold"], f"{q}_side": side, f"{q}_width": width}

    @property
    def told(self) -> Mapping[str, str]:
        """For the words of the report."""
        if self.quantity == "direction":
            return {"quantity": self.name, "shape": ""}
        if self.quantity == "order":
            return FROM_THEN
        return {"quantity": f"{self.WORDS[self.quantity]} {'above' if self.above else 'below'}", "shape": "threshold"}


@dataclass(frozen=True)
class Context:
    """What the causes of a family are made for: roles of the machine, ranges of the data, sensors of the campaign."""

    roles: Roles
    ranges: Ranges
    sensors: Sequence[Sensor]

    @property
    def both_ways(self) -> bool:
        """Whether power flows both ways in the data."""
        return any(s.signs[0] != s.signs[1] for s in self.sensors) or self.ranges.varies("direction")

    def first(self, kind: str) -> str:
        """Name of the first sensor of a kind, those that drive the model first; "" without any."""
        own = [s for s in self.sensors if s.kind == kind]
        return next((s.name for s in sorted(own, key=lambda s: s.role != "given")), "")

    def by_speed(self, row: Row, theta: Theta, exponent: str) -> Num:
        """Speed over its middle to an exponent, a shape by its name; 1 where no speed is measured."""
        name = self.first("speed")
        if not name:
            return 1.0
        ratio = row.sensors[name] / max(self.ranges.mid.get(name, 1.0), 1e-9)
        return ca.exp(theta[exponent] * ca.log(smooth_abs(ratio, SLOW)))

    def by_rise(self, row: Row, theta: Theta, exponent: str) -> Num:
        """Rise of the oil over the usual one to an exponent, a shape by its name."""
        return ca.exp(theta[exponent] * ca.log(smooth_abs(row.rise / self.ranges.rise, COOL)))

    def power(self, doc: str, sd: float, low: float, high: float) -> Size:
        """A power [W] at the middle of the data; `sd`, `low` and `high` are shares of the typical loss."""
        P = self.ranges.loss
        return Size("P_ref", "W", f"{doc}, at the middle of the data", sd * P, low * P, high * P)

    def regimes(self, quantities: Iterable[str]) -> tuple[Regime, ...]:
        """Both sides of each quantity (as those of `Regime`) that varies enough; from a test on ("order")."""
        room, ranges = self.first("ambient"), self.ranges
        known = {"direction": self.both_ways, "order": "order" in ranges.known}
        known["room"] = bool(room) and ranges.varies(room, LEAST_SPAN / ranges.mid[room])
        known |= {q: ranges.varies(q) for q in ("w", "tau")}
        known["T"] = ranges.varies("T", LEAST_SPAN / ranges.mid.get("T", 330.0))
        sides = {"order": (True,)}
        kept = [(q, above) for q in quantities if known[q] for above in sides.get(q, (True, False))]
        return tuple(Regime(q, above, room if q == "room" else "") for q, above in kept)


def weighed(general: Sequence[Form], single: Sequence[Form] = (), sides: Sequence[Form] = ()) -> tuple[Form, ...]:
    """Forms with their shares of a cause's prior: some for all parts, one for each of several, one for each regime."""
    kept = single if 1 < len(single) <= MOST_PLACES else ()
    places = (BESIDE if sides else ONE_PLACE) if kept else 0.0
    limited = SIDE * len(sides)
    groups = ((general, 1 - places - limited), (kept, places), (sides, limited))
    return tuple(replace(form, weight=share / len(forms)) for forms, share in groups for form in forms)


#: Paths of values, with the exponents of a factor where not all of them are 1.
Paths = Iterable[str] | Mapping[str, float]


def factors(paths: Paths, size: str, law: Callable[[Num], Num] = ca.exp) -> Callable[[Theta, Row], Values]:
    """Values times the factor that a law gives for a size by its name."""
    exponents = paths if isinstance(paths, Mapping) else dict.fromkeys(paths, 1.0)
    return lambda theta, row: {path: row.base[path] * law(e * theta[size]) for path, e in exponents.items()}


def no_less(forms: Iterable[Form], there: float) -> tuple[Form, ...]:
    """Forms that take no more than is there, a size of the cause."""
    return tuple(replace(f, low=max(f.low, -MOST_LESS * there)) for f in forms)


def beside_own_law(cause: Cause, at: Context, places: Mapping[str, Sequence[str]], per: float = 1.0) -> Cause:
    """The cause with forms by which it is a factor on what the machine's parts do by their own laws.

    Args:
        cause: with its other forms
        at: what it is made for
        places: parts at each place
        per: size of the cause that is one watt of theirs, at the middle of the data
    """
    powers = {name: per * sum(at.ranges.powers.get(part, 0.0) for part in parts) for name, parts in places.items()}
    paths = {name: at.roles.scaled(*places[name]) for name, power in powers.items() if power > 0}

    def form(names: Iterable[str], words: str) -> Form:
        own, power = [path for name in names for path in paths[name]], sum(powers[name] for name in names)
        return Form(words, values=factors(own, cause.size.name, lambda size: 1 + size / power), low=-MOST_LESS * power)

    if not any(paths.values()):
        return cause
    law = weighed([form(paths, BY_LAW)], [form((name,), f"{name}, {BY_LAW}") for name in paths])
    groups = ((1 - OWN_LAW, cause.forms), (OWN_LAW, law))
    return replace(cause, forms=tuple(replace(f, weight=s * f.weight) for s, forms in groups for f in forms))
