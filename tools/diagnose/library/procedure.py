"""How the campaign was run: readings taken early, and what changes with the days and the running order."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from ....model.laws.smooth import smooth_max
from .cause import Cause, Form, Num, Row, Theta, Values
from .entries import entry
from .forms import COURSES, Context, factors

#: What early readings are a share of where they are early by a time [s].
EARLY = 7200.0
#: Rounding of a pace near zero.
ROUND = 0.1
#: How much of the size each half has, by the form's name, and the forms' weights.
HALVES = {"": (1.0, 1.0, 0.6), "first half": (1.0, 0.0, 0.25), "later halves": (0.0, 1.0, 0.15)}


def causes(at: Context) -> Iterator[Cause]:
    """All causes of the family."""
    if "dwell" in at.ranges.known:
        yield not_stationary(at)
    if "order" in at.ranges.known:
        yield order(at)
        if daily := at.roles.daily if at.roles.cooling else ():
            day = Form(spread="test", values=factors(daily, "sd"))
            yield entry("procedure.day_scatter", at).with_forms([day])


def not_stationary(at: Context) -> Cause:
    """Readings taken too early: by a share of the dwell, by some minutes, or now more and now less."""

    def pace(first: float, later: float, minutes: bool) -> Callable[[Theta, Row], Num]:
        def of(theta: Theta, row: Row) -> Num:
            missing = theta["missing"] * (first * (1 - row.second) + later * row.second)
            left = 1 - (missing * EARLY / row.dwell if minutes else missing)
            return smooth_max(left, 0.0, ROUND) / smooth_max(1.0, 0.0, ROUND)

        return of

    return entry("procedure.not_stationary", at).with_forms(
        Form(", ".join(filter(None, (words, half))), w / 3, pace=pace(first, later, minutes), spread=spread)
        for words, minutes, spread in (("", False, ""), ("by minutes", True, ""), ("at random", False, "test"))
        for half, (first, later, w) in HALVES.items()
    )


def order(at: Context) -> Cause:
    """Something that changes steadily from the first test to the last."""
    known, roles = entry("procedure.order", at), at.roles
    teeth = roles.scaled(*roles.parts("teeth"))
    shafts = roles.scaled(*roles.parts("bearing"), *roles.parts("seal"))
    losses = (*teeth, *shafts) if shafts else ()
    targets = {"cooling": (roles.cooling, 0.4), "teeth": (teeth, 0.3), "all losses": (losses, 0.3)}
    targets = {name: (paths, weight) for name, (paths, weight) in targets.items() if paths}

    def changing(paths: Sequence[str], course: Callable[[Theta, Row], Num]) -> Callable[[Theta, Row], Values]:
        law = factors(paths, "change")
        return lambda t, row: law({**t, "change": t["change"] * (course(t, row) - t["zero"])}, row)

    total = sum(weight for _, weight in targets.values())
    return known.with_forms(
        Form(
            ", ".join(filter(None, (target, course.words))),
            weight * course.share / total,
            (*course.shapes, *known.shapes),
            values=changing(paths, course.at),
        )
        for target, (paths, weight) in targets.items()
        for course in COURSES
    )
