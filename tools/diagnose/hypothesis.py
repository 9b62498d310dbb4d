"""A hypothesis: causes, what they were found to be, and where; lists of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..effects.cause import Theta
from .evidence import White
from .family import Family, form_of
from .problem import Linear
from .scatter import SCATTER

#: Where a fit begins: cause -> shares of its shapes, and size.
Start = Mapping[str, tuple[np.ndarray, float]]


@dataclass(frozen=True)
class Hypothesis:
    """A set of causes: log evidence with its prior, fitted parameters, and the families at their linearisation.

    `also` is where another first look would begin to fit it.
    """

    causes: tuple[str, ...]
    log_posterior: float
    theta: Mapping[str, Theta] = field(default_factory=dict)
    families: tuple[Family, ...] = ()
    linear: Linear | None = None
    also: tuple[Start, ...] = ()

    def scattered(self, null: Linear | None = None, sign: float = 1.0) -> Linear:
        """Its linearisation, `null` where it has none, with the scatter of its days in the covariance, or taken out."""
        linear = self.linear or null
        assert linear is not None
        return linear.with_days(self.theta[SCATTER]["sd"], sign) if SCATTER in self.theta else linear

    def parts(self, null: Linear) -> list[Family]:
        """Its families against what it leaves as scatter."""
        linear = self.scattered(null)
        white = White.of(linear.residual, linear.covariance)
        return [f.seen(white) for f in self.families]

    @property
    def begin(self) -> Start:
        """Where its fit begins: cause -> shares of the shapes, and size."""
        found = {}
        for f in self.families:
            theta = self.theta[f.cause.id]
            found[f.cause.id] = (f.shares[form_of(f, theta)], theta[f.cause.size.name])
        return found

    @property
    def effect(self) -> np.ndarray | float:
        """What its causes, as fitted, change in all readings (m); 0 without any."""
        found: np.ndarray | float = 0.0
        for f in self.families:
            theta = self.theta[f.cause.id]
            found = found + f.signatures[:, form_of(f, theta)] * theta[f.cause.size.name]
        return found


def better(some: Sequence[Hypothesis], others: Sequence[Hypothesis]) -> list[Hypothesis]:
    """The better of each hypothesis, single ones to be begun from both; no cause at all as the first list has it."""
    found, looks = distinct([*some, *others]), dict[frozenset[str], list[Hypothesis]]()
    for h in (*some, *others):
        looks.setdefault(frozenset(h.causes), []).append(h)

    def begun_from_both(h: Hypothesis) -> Hypothesis:
        if len(h.causes) != 1:
            return h
        return replace(h, also=tuple(other.begin for other in looks[frozenset(h.causes)] if other is not h))

    return [some[0], *(begun_from_both(h) for h in found if h.causes)]


def distinct(hypotheses: Sequence[Hypothesis]) -> list[Hypothesis]:
    """The best of all hypotheses of the same causes."""
    found: dict[frozenset[str], Hypothesis] = {}
    for h in hypotheses:
        causes = frozenset(h.causes)
        if causes not in found or h.log_posterior > found[causes].log_posterior:
            found[causes] = h
    return list(found.values())
