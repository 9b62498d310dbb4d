"""What a diagnosis found, as plain data: what `--json` writes, the report shows and the extension applies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from ..effects.cause import Theta

#: The name of whatever the library lacks.
UNEXPLAINED = "model.unexplained"


@dataclass(frozen=True)
class Estimate:
    """A fitted parameter with its 95 % interval."""

    name: str
    value: float
    low: float
    high: float
    unit: str


@dataclass(frozen=True)
class Named:
    """A cause with its marginal probability, the smallest size these data would reveal, and its parameters.

    `p_split` and `q` are its certificate by the split of the tests (see split.py); None where it has none.
    """

    id: str
    probability: float
    detectable: float
    parameters: tuple[Estimate, ...] = ()
    regime: Mapping[str, tuple[float | None, float | None]] = field(default_factory=dict)
    p_split: float | None = None
    q: float | None = None


@dataclass(frozen=True)
class Joint:
    """A set of causes (none: nothing is wrong) with its probability and its fitted parameters."""

    causes: tuple[str, ...]
    probability: float
    theta: Mapping[str, Theta] = field(default_factory=dict)

    @property
    def outside(self) -> bool:
        """Whether it is that the library lacks the cause."""
        return self.causes == (UNEXPLAINED,)


@dataclass(frozen=True)
class Gain:
    """Errors on points that were held out, with the choice of causes repeated without them."""

    scheme: str
    channel: str
    rmse_before: float
    rmse_after: float
    ratio_ci90: tuple[float, float]
    noise_floor: float | None
    n: int
    #: what plain statistics leave on the same readings: name -> error
    rivals: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Experiment:
    """A proposed measurement, the causes it separates, their distance before and after in standard deviations."""

    id: str
    what: str
    separates: tuple[str, ...]
    before: float
    after: float


@dataclass(frozen=True)
class Findings:
    """The whole result. `nominal` and `extended` hold values by path of the calibrated models without and with it."""

    verdict: str
    alpha: float
    p_any: float
    p_omnibus: float
    p_adequacy: float
    draws: int
    hypotheses: tuple[Joint, ...]
    causes: tuple[Named, ...]
    confusable: tuple[tuple[str, ...], ...]
    impact: Mapping[str, tuple[float, float, float]]
    gain: Gain
    next_experiment: tuple[Experiment, ...]
    warnings: tuple[str, ...]
    nominal: Mapping[str, float]
    extended: Mapping[str, float]
    #: the same as `gain` where whole groups of tests were held out
    grouped: tuple[Gain, ...] = ()
    #: channel -> root mean square that the rig leaves when it is played over the data: calibrated, extended
    played: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    #: channel -> measured, nominal (calibrated without a cause), extended (with the top hypothesis, faults of the
    #: instruments and the procedure included), over the rows
    rows: Mapping[str, tuple[Any, Any, Any]] = field(default_factory=dict)
