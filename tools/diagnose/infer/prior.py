"""Prior probabilities of hypotheses: causes share that of one by how often they are met; more causes are rarer."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

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


class Prior:
    """Of all hypotheses that hold some of these causes.

    Args:
        causes: all of the library
    """

    def __init__(self, causes: Iterable[Cause]) -> None:
        self.causes: Mapping[str, Cause] = {c.id: c for c in causes}
        families: dict[str, list[Cause]] = {}
        for cause in self.causes.values():
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
        orders = float(np.prod(np.arange(1, len(names) + 1)))
        pairs = sum(np.log(TWO if k == 1 else MORE) for k in range(1, len(names)))
        kinds = [c.rpartition(".")[0] for c in names if c.startswith("sensor.")]
        same = (len(kinds) - len(set(kinds))) * np.log(SAME)
        return float(sum(self.share[c] for c in names) + pairs + same + np.log(orders))
