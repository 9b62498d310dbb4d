"""What a diagnosis found, as plain data: these models are the JSON schema `gearheat.diagnosis/2`.

Everything that the screen, the page and the JSON show is in here. Values stand in the unit beside them, temperatures in
degC, differences in K. Probabilities are of the posterior and come with their Monte-Carlo error.
"""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from .evidence import DataQuality, Estimate, Picture, ResidualMean, Rows, View
from .numbers import Interval, Model, Number, P, Probability

#: The name of whatever the library lacks.
UNEXPLAINED = "model.unexplained"
#: Distances of causes below this are none [standard deviations].
APART = 3.0
Verdict = Literal["consistent", "explained", "ambiguous", "unexplained"]


class Channel(Model):
    """A sensor, as the data and the card have it."""

    name: str = Field(description="stable name, the key of all tables by channel")
    column: str = Field(default="", description="column of the user's file")
    kind: str = Field(default="", description="kind of sensor, as a card names it")
    role: Literal["given", "read"] = "read"
    unit: str = Field(description="of its readings in this result: degC, N.m, rpm, W")
    repeat_sd: Number | None = Field(default=None, description="scatter from reading to reading by the card")
    offset_sd: Number | None = Field(default=None, description="fixed tolerance by the card")

    @property
    def difference(self) -> str:
        """Unit of a difference of its readings."""
        return "K" if self.unit == "degC" else self.unit


class About(Model):
    """What was diagnosed."""

    data: str = Field(default="", description="name of the data")
    rig: str = ""
    readings: int = 0
    tests: int = 0
    reference: str = Field(default="", description="name of the healthy campaign, empty without one")
    reference_readings: int = 0
    logs: tuple[str, ...] = ()
    log_rows: int = 0
    segments: int = 0
    seed: int = 0


class Alarm(Model):
    """Whether anything is wrong, and whether what is left after the best hypothesis is noise."""

    alpha: Number
    p_any: P = Field(
        description="share of campaigns without a fault whose odds against nothing are as large; 1e-6: at most that"
    )
    p_omnibus: P | None = Field(
        default=None, description="p of the readings under the calibrated model, no cause in mind"
    )
    p_adequacy: P | None = Field(description="p of what the top hypothesis leaves; near 1 is too good to be true")
    draws: int | None = None


class Impact(Model):
    """Mean change of something over the data points: with a cause less without it."""

    value: Number
    ci95: Interval
    single: Interval | None = Field(default=None, description="least and largest change at a data point")
    unit: str = ""
    what: str = Field(default="", description="what changes, in words: oil temperature, loss")


class FormShare(Model):
    """A form of a cause with its share of the cause's probability."""

    name: str
    share: Probability


class Cause(Model):
    """A cause with its marginal probability over all hypotheses, with and without a remainder."""

    id: str
    probability: Probability
    mc_error: Number = 0.0
    detectable: Number | None = Field(
        default=None, description="smallest size that would be found in 80 of 100 such campaigns; absent: none is seen"
    )
    parameters: tuple[Estimate, ...] = Field(default=(), description="the size first, then the shapes")
    regime: dict[str, tuple[Number | None, Number | None]] = Field(
        default={}, description="where it acts: column or quantity with unit -> above, below; absent = everywhere"
    )
    since: str = Field(default="", description="the test from which on it acts, with its date; empty = from the first")
    forms: tuple[FormShare, ...] = Field(
        default=(), description="most probable first; the name is empty for the general form"
    )
    impact: dict[str, Impact] = Field(default={}, description="its own part of the impact")
    doc: str = Field(default="", description="where it acts and what it does")
    exposes: str = Field(default="", description="the experiment that shows it directly")
    like: str = Field(default="", description="class of causes that count as one answer, and why")
    usual: Number | None = Field(default=None, description="prior standard deviation of its size")
    unit: str = Field(default="1", description="of its size")
    meaning: str = Field(default="", description="what its size is")


class Hypothesis(Model):
    """Causes that act together; none: nothing is wrong."""

    causes: tuple[str, ...]
    probability: Probability
    mc_error: Number = 0.0


class Answer(Model):
    """One answer that the verdict speaks of: all of `causes` together, each of them any one of a class."""

    causes: tuple[tuple[str, ...], ...] = Field(description="classes; members of a class cannot be told apart")
    probability: Probability
    mc_error: Number = 0.0


class RemainderChannel(Model):
    """What no cause explains in a channel."""

    channel: str
    rms: Number
    unit: str


class Remainder(Model):
    """That something acts which the library lacks: over the named causes, or alone."""

    probability: Probability
    mc_error: Number = 0.0
    channels: tuple[RemainderChannel, ...] = Field(default=(), description="largest against its noise first")


class Gain(Model):
    """Errors on readings that were held out, with everything repeated without them."""

    class Both(Model):
        """By what lasts, and with what is another in each test or mounting as well: zeros, fillings, remainders."""

        without: Number
        with_: Number = Field(alias="with")

    scheme: str = Field(description="leave-one-operating-point, -speed, -load or -oil; leave-out-tests or -spans")
    channel: str
    unit: str
    n: int
    rmse_before: Number = Field(description="by what lasts: the same as before.without")
    rmse_after: Number = Field(description="the same as after.without")
    before: Both | None = Field(default=None, description="calibrated, no cause")
    after: Both | None = Field(
        default=None, description="all sets of causes, chosen and weighed without them, averaged"
    )
    leading: Both | None = Field(default=None, description="with the likeliest set alone, fitted exactly")
    ratio_ci90: Interval | None = Field(
        default=None, description="of rmse_after / rmse_before, tests drawn with replacement"
    )
    noise_floor: Number | None = None
    rivals: dict[str, Number] = Field(default={}, description="plain statistics on the same folds")
    chosen: dict[str, int] = Field(default={}, description="cause -> folds that chose it")
    folds: int | None = None


class Played(Model):
    """Root mean square that the rig leaves of the data it was fitted to, with faults of instruments as found."""

    rms_calibrated: Number
    rms_extended: Number
    unit: str = ""


class Experiment(Model):
    """A proposed measurement; distances in standard deviations."""

    id: str
    what: str = ""
    separates: tuple[str, ...]
    separation_before: Number
    separation_after: Number


class CauseSet(Model):
    """Causes that these data cannot tell apart whatever the noise of the day; distances in standard deviations."""

    causes: tuple[str, ...]
    distance: Number = Field(description="of the first from the nearest other, all forms free")
    reason: str = ""


class Isolability(Model):
    """What this design says of a cause of usual size, before any data."""

    cause: str
    visible: Number = Field(description="distance from no cause")
    nearest: str = ""
    distance: Number | None = Field(default=None, description="from the nearest other cause, all forms free")


class Calibrated(Model):
    """A value of the rig as in its file, as calibrated, and as calibrated with the top hypothesis."""

    path: str
    unit: str
    file: Number | None = None
    nominal: Number
    extended: Number | None = None


class Invisible(Model):
    """A cause that these data cannot show at all."""

    cause: str
    reason: str = Field(description="what is missing: no column humidity_pct")


class Prediction(Model):
    """What the instruments will show at a point: channel -> value, calibrated without a cause and extended."""

    point: str
    nominal: dict[str, Number]
    extended: dict[str, Number]


class Said(Model):
    """The first screen, in sentences."""

    stands_out: str = Field(default="", description="what the calibrated rig leaves, before any cause is named")
    verdict: str = ""
    do: str = ""
    size: str = ""
    sure: str = ""
    cannot_be: str = ""
    data: tuple[str, ...] = Field(
        default=(), description="what is to be known of the data and the rig, gross readings first"
    )


class Findings(Model):
    """Result of `gearheat diagnose`."""

    schema_: Literal["gearheat.diagnosis/2"] = Field(default="gearheat.diagnosis/2", alias="schema")
    verdict: Verdict = Field(
        description="consistent: nothing beyond the stated accuracies; explained: one answer > 0.9, whatever else "
        "acts; ambiguous: several are needed for 0.9; unexplained: an alarm, most probably outside the library"
    )
    says: Said = Said()
    about: About = About()
    test: Alarm
    hypotheses: tuple[Hypothesis, ...] = Field(description="no causes = nothing wrong; probabilities sum to <= 1")
    answers: tuple[Answer, ...] = Field(
        default=(), description="what the verdict names, most probable first; those of `ambiguous` reach 0.9 together"
    )
    causes: tuple[Cause, ...] = Field(description="marginal, most probable first")
    remainder: Remainder | None = None
    data_quality: DataQuality = DataQuality()
    residuals: tuple[ResidualMean, ...] = ()
    confusable: tuple[tuple[str, ...], ...] = Field(default=(), description="the causes of `sets`")
    sets: tuple[CauseSet, ...] = ()
    impact: dict[str, Impact] = Field(
        default={},
        description="mean change of the readings that the first answer causes: T_oil_K, T_wall_K, loss_Nm, heat_W",
    )
    gain: Gain | None = None
    gain_grouped: tuple[Gain, ...] = Field(default=(), description="the same by other schemes")
    played: dict[str, Played] = {}
    next_experiment: tuple[Experiment, ...] = ()
    isolability: tuple[Isolability, ...] = ()
    invisible: tuple[Invisible, ...] = ()
    views: tuple[View, ...] = ()
    channels: tuple[Channel, ...] = ()
    rows: Rows = Rows()
    pictures: tuple[Picture, ...] = ()
    calibrated: tuple[Calibrated, ...] = ()
    predictions: tuple[Prediction, ...] = ()
    extended_rig: str = Field(
        default="", description="rig file (TOML): calibrated, with the causes of the first answer"
    )
    warnings: tuple[str, ...] = ()

    @property
    def nothing(self) -> float:
        """Probability that nothing is wrong."""
        return sum(h.probability for h in self.hypotheses if not h.causes)

    @property
    def named(self) -> set[str]:
        """All causes of the answers."""
        return {c for a in self.answers for group in a.causes for c in group}

    def cause(self, id: str) -> Cause | None:
        """What is known of a cause."""
        return next((c for c in self.causes if c.id == id), None)

    def channel(self, name: str) -> Channel | None:
        """A channel by its name."""
        return next((c for c in self.channels if c.name == name), None)
