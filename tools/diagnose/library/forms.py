"""What the families share: regimes such as "above a speed", and forms such as "all of them" and "one of them"."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import casadi as ca

from ....model.laws.smooth import smooth_abs
from ....model.machines.roles import Roles
from ....model.parts.free_form import step
from ....scenarios.measured.table import Sensor
from .cause import Form, Num, Ranges, Row, Shape, Size, Theta, Values

#: What changes values of the machine.
Changes = Callable[[Theta, Row], Values]

#: Share of a cause's prior of the forms that act in one of several parts only.
ONE_PLACE = 0.5
#: The same beside regimes.
BESIDE = 0.25
#: Of each side of a regime: as likely for every cause.
SIDE = 0.05
#: How gradually a form usually sets in at a threshold, over the range of its quantity.
USUAL = 0.04
#: Share of the middle speed below which what follows the speed no longer does.
SLOW = 0.05
#: No more places than these have forms of their own.
MOST_PLACES = 6
WIDTH = Shape("width", "1", "how gradually it sets in at the threshold, over the usual", 0.4, 3.0, 1.0, 0.75)
#: How gradually something sets in with the running order, which goes from 0 to 1.
ORDER_STEP = 0.02
PLACE = Shape("threshold", "1", "where in the running order: 0 first test, 1 last", 0.0, 1.0)
FROM_THEN = {"quantity": "order above", "shape": "threshold"}
INNER_SHARE = Shape("inner_share", "1", "share of the rest that goes to what turns", 0.0, 1.0, 0.5, 0.3)


def since(theta: Theta, row: Row) -> Num:
    """0 before and 1 after a place in the running order."""
    return step((row.order - theta["threshold"]) / ORDER_STEP)


@dataclass(frozen=True)
class Course:
    """A way of a change over the running order: words, share of the prior, its shape, and how far it is, 0 to 1."""

    words: str
    share: float
    shape: Shape
    at: Callable[[Theta, Row], Num]


COURSES = (
    Course(
        "",
        0.65,
        Shape("power", "1", "exponent of the running order", 0.3, 2.0, 0.9, 0.35),
        lambda theta, row: (row.order + 1e-9) ** theta["power"],
    ),
    Course(
        "settling",
        0.35,
        Shape("decay", "1", "share of the campaign in which it settles: running in", 0.05, 0.6),
        lambda theta, row: (1 - ca.exp(-row.order / theta["decay"])) / (1 - ca.exp(-1 / theta["decay"])),
    ),
)


def oil_share(mean: float, sd: float) -> Shape:
    """The share of a loss that heats the oil."""
    return Shape("oil_share", "1", "share of the heat that goes into the oil", 0.0, 1.0, mean, sd)


@dataclass(frozen=True)
class Regime:
    """One side of a quantity ("w", "tau", "T", "film"), one direction ("direction"), or from a test on ("order")."""

    quantity: str
    above: bool

    WORDS = {"w": "speed", "tau": "load", "T": "temperature", "film": "film"}

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
        unit = {"w": "rad/s", "tau": "N.m", "T": "K", "film": "m2/s2"}[self.quantity]
        low, high = ranges.low[self.quantity], ranges.high[self.quantity]
        threshold = Shape("threshold", unit, f"threshold of the {self.WORDS[self.quantity]}", low, high)
        return (threshold,) if self.quantity == "film" else (threshold, WIDTH)

    def share(self, theta: Theta, row: Row) -> Num:
        """How much of the size acts in a row."""
        return since(theta, row) if self.quantity == "order" else 1.0

    def by_rise(self, theta: Theta, row: Row, ranges: Ranges) -> Num:
        """How much of the size acts by the oil's temperature, told from its rise over a room as it usually is."""
        if self.quantity != "T":
            return 1.0
        oil, span = ranges.mid["T"] + row.rise - ranges.rise, ranges.high["T"] - ranges.low["T"]
        side = 1.0 if self.above else -1.0
        return step(side * (oil - theta["threshold"]) / (USUAL * span * theta["width"]))

    def limits(self, theta: Theta, ranges: Ranges) -> dict[str, Num]:
        """Values of an extra part by key."""
        if self.quantity == "order":
            return {}
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

    def power(self, doc: str, sd: float, low: float, high: float) -> Size:
        """A power [W] at the middle of the data.

        Args:
            doc: in words
            sd, low, high: in shares of the typical loss
        """
        P = self.ranges.loss
        return Size("P_ref", "W", f"{doc}, at the middle of the data", sd * P, low * P, high * P)

    def conductance(self, doc: str, sd: float, low: float, high: float) -> Size:
        """A conductance [W/K] at the typical temperature difference.

        Args:
            doc: in words
            sd, low, high: in shares of the typical conductance from oil to room
        """
        G = self.ranges.conductance
        return Size("G_ref", "W/K", doc, sd * G, low * G, high * G)

    def regimes(self, quantities: Iterable[str]) -> tuple[Regime, ...]:
        """Both sides of each quantity ("w", "tau", "T", "direction") that varies enough; from a test on ("order")."""
        least = {"w": 0.1, "tau": 0.1, "T": 5.0 / self.ranges.mid.get("T", 330.0)}
        known = {"direction": self.both_ways, "order": "order" in self.ranges.known}
        kept = [q for q in quantities if (known[q] if q in known else self.ranges.varies(q, least[q]))]
        return tuple(Regime(q, above) for q in kept for above in ((True, False) if q != "order" else (True,)))


def shared(
    together: Sequence[tuple[Sequence[str], Changes]],
    single: Sequence[tuple[Sequence[str], Changes]],
    shapes: tuple[Shape, ...] = (),
) -> tuple[Form, ...]:
    """Forms that change values of all parts of a kind, and of each of several.

    Args:
        together: groups of parts with what changes their values; the first has no name
        single: the same for each part
        shapes: of all forms
    """
    own = list(single) if 1 < len(single) <= MOST_PLACES else []
    general = (1 - ONE_PLACE if own else 1.0) / len(together)
    found = [Form(", ".join(p) if k else "", general, shapes, values=v) for k, (p, v) in enumerate(together)]
    found += [Form(", ".join(p), ONE_PLACE / len(own), shapes, values=v) for p, v in own]
    return tuple(found)
