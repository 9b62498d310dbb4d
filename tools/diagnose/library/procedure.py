"""How the campaign was run: readings taken early, and what changes with the days and the running order."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import casadi as ca

from ....model.laws.smooth import smooth_max
from ....model.machines.roles import Roles
from .cause import Cause, Form, Num, Row, Shape, Size, Theta, Values
from .cooling import DAYS
from .forms import COURSES, Context, factors

#: What early readings are a share of where they are early by a time [s].
EARLY = 7200.0
#: Rounding of a pace near zero.
ROUND = 0.1
#: Share of the form in which each test is early by a share of its own.
AT_RANDOM = 0.15
#: How much of the size each half has, by the form's name, and the forms' weights.
HALVES = {"": (1.0, 1.0, 0.6), "first half": (1.0, 0.0, 0.25), "later halves": (0.0, 1.0, 0.15)}


def causes(at: Context) -> Iterator[Cause]:
    """All causes of the family.

    Args:
        at: machine, data and instruments
    """
    if "dwell" in at.ranges.known:
        yield not_stationary()
    if "order" in at.ranges.known:
        yield order(at.roles)
        if at.roles.cooling:
            yield day_scatter(at.roles)


def _pace(missing: Num) -> Num:
    """Share of the dwell that took place, never below zero, one where nothing is missing."""
    return smooth_max(1 - missing, 0.0, ROUND) / smooth_max(1.0, 0.0, ROUND)


def not_stationary() -> Cause:
    """Readings taken too early: by a share of the dwell, by some minutes, or now more and now less."""

    def pace(first: float, later: float, minutes: bool) -> Callable[[Theta, Row], Num]:
        def of(theta: Theta, row: Row) -> Num:
            missing = theta["missing"] * (first * (1 - row.second) + later * row.second)
            return _pace(missing * EARLY / row.dwell if minutes else missing)

        return of

    forms = []
    for minutes, words in ((False, ""), (True, "by minutes")):
        for name, (first, later, weight) in HALVES.items():
            known = ", ".join(filter(None, (words, name)))
            forms.append(Form(known, (1 - AT_RANDOM) * weight / 2, pace=pace(first, later, minutes)))
    forms.append(Form("at random", AT_RANDOM, pace=pace(1.0, 1.0, False), spread="test"))
    return Cause(
        id="procedure.not_stationary",
        doc="Readings taken earlier than the protocol says, while the gearbox still warms.",
        size=Size("missing", "1", "share of the dwell that is missing; by minutes: of two hours", 0.3, 0.0, 0.95),
        forms=tuple(forms),
        exposes="a logged warm-up; a longer dwell",
        acts_on="order",
    )


def order(roles: Roles) -> Cause:
    """Something that changes steadily from the first test to the last."""
    teeth = roles.scaled(*roles.parts("teeth"))
    shafts = roles.scaled(*roles.parts("bearing"), *roles.parts("seal"))
    targets = {"cooling": (roles.cooling, 0.4), "teeth": (teeth, 0.3), "all losses": ((*teeth, *shafts), 0.3)}
    if not shafts:
        del targets["all losses"]
    kept = {name: (paths, weight) for name, (paths, weight) in targets.items() if paths}

    def changing(paths: Sequence[str], course: Callable[[Theta, Row], Num]) -> Callable[[Theta, Row], Values]:
        def values(theta: Theta, row: Row) -> Values:
            log = theta["change"] * (course(theta, row) - theta["zero"])
            return {path: row.base[path] * ca.exp(log) for path in paths}

        return values

    zero = Shape("zero", "1", "where the nominal holds: 0 before the change, 1 after", 0.0, 1.0)
    total = sum(weight for _, weight in kept.values())
    return Cause(
        id="procedure.order",
        doc="Cooling or losses that change over the campaign: dirt, season, running in, what stands around.",
        size=Size("change", "1", "logarithm of the factor from the first test to the last", 0.12, -1.5, 1.0),
        forms=tuple(
            Form(
                ", ".join(filter(None, (target, course.words))),
                weight * course.share / total,
                (*course.shapes, zero),
                values=changing(paths, course.at),
            )
            for target, (paths, weight) in kept.items()
            for course in COURSES
        ),
        exposes="the first point repeated at the end; tests in random order",
        acts_on="order",
    )


def day_scatter(roles: Roles) -> Cause:
    """Days that differ more than stated."""
    return Cause(
        id="procedure.day_scatter",
        doc="Cooling that differs from day to day more than the card states, without a pattern.",
        size=Size(
            "sd", "1", "relative standard deviation of the days' cooling beside what the card states", 0.05, 0.0, 0.6
        ),
        forms=(Form(spread="test", values=factors(roles.daily, "sd")),),
        exposes="the same point on several days; draught and neighbours logged",
        like=DAYS,
        acts_on="order",
    )
