"""Prior probabilities of hypotheses: causes share that of one by how often they are met; more causes are rarer."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from ..library.cause import Cause

#: Prior odds of two causes against one.
TWO = 0.22
#: Of each further one.
MORE = 0.25
#: Of one more of the same kind of instrument.
SAME = 0.2
#: Prior odds of a remainder beside a hypothesis.
OUTSIDE = 0.06
#: Of one reading to be gross.
GROSS = 0.002


class Prior:
    """Of all hypotheses that hold some of the causes of a library."""

    def __init__(self, causes: Iterable[Cause]) -> None:
        families: dict[str, list[Cause]] = {}
        for cause in {c.id: c for c in causes}.values():
            families.setdefault(cause.family, []).append(cause)
        weight = {name: max(c.common for c in own) for name, own in families.items()}
        whole = sum(weight.values())
        #: Log share of the prior of one cause that each has: those of a class share that of its most common one.
        self.share: Mapping[str, float] = {
            c.id: float(np.log(weight[name] / whole * c.common / sum(o.common for o in own)))
            for name, own in families.items()
            for c in own
        }

    def __call__(self, causes: Iterable[str]) -> float:
        """Log prior odds of a hypothesis against those of one cause, all together 1."""
        names = list(causes)
        return float(sum(self.share[c] for c in names) + self.number(names))

    def number(self, causes: Sequence[str]) -> float:
        """The part of it that follows from how many causes act, and how many of them in one kind of instrument."""
        pairs = sum(self.further(k) for k in range(len(causes)))
        kinds = [kind(c) for c in causes if kind(c)]
        return float(pairs + (len(kinds) - len(set(kinds))) * np.log(SAME))

    @staticmethod
    def further(n: int) -> float:
        """Log prior odds of one cause more beside n."""
        return float(np.log((n + 1) * (TWO if n == 1 else MORE))) if n else 0.0


def kind(cause: str) -> str:
    """Kind of the instrument that a cause is an error of, "" for others."""
    return cause.rpartition(".")[0] if cause.startswith("sensor.") else ""
