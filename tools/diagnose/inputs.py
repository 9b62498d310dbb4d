"""All that a diagnosis reads: readings, card, series, reference and points, checked together before any work."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TypeVar

import numpy as np

from ...model.errors import DataError, GearheatError
from ...model.machines.spec import Spec
from ...scenarios.csv_table import Column
from ...scenarios.measured import POINTS, READINGS, Campaign, Protocol, Reading, read_measured
from ...scenarios.scenario import Scenario
from ..effects.taxonomy import CAUSES
from ..rigs import load
from . import card as cards
from .card import BY_ROOM, Card, read_card
from .card_checks import card_problems, card_warnings
from .data_checks import implausible, invisible_causes, outlying, small_reference, too_small
from .lubrication import known_oils, lubricated, oil_values, oil_warnings
from .memory import Memory
from .repeated import repeated, scatter_warning, with_repeatability
from .series import Series, read_series

T = TypeVar("T")


@dataclass(frozen=True)
class Request:
    """The files of a diagnosis, the rig they belong to, how many causes may act together, and whose repeatability
    counts: that of the "card", or what repeated "points" show where that is more."""

    data: Path
    rig: str = "planetary"
    card: Path | None = None
    series: Path | None = None
    reference: Path | None = None
    reference_series: Path | None = None
    predict: Path | None = None
    most: int = 2
    repeatability: str = "card"

    def files(self) -> dict[str, Path]:
        """The files that are read, by the name of their option."""
        given = {"DATA": self.data, "--card": self.card, "--series": self.series, "--reference": self.reference}
        given |= {"--reference-series": self.reference_series, "--predict": self.predict}
        return {name: path for name, path in given.items() if path is not None}


@dataclass(frozen=True)
class Inputs:
    """Everything a diagnosis starts from.

    Args:
        scenario: the rig, lubricated as the card says and driven by what its measured tables give
        card: accuracies, priors and protocol
        data: the campaign in which causes are sought; the start of its tests and its stops as the card states them
        oils: name of an oil in any of the tables -> its values by path
        reference, points: a healthy campaign of the same rig, and conditions to predict, if given
        series, reference_series: logged courses of the tests of `data` and of `reference`
        invisible: cause -> why these data cannot show it, or cannot tell it from another
        warnings: what the user should know of the files
        digest: hash of the rig and of all that was read
        most: causes that a hypothesis may hold
        memory: what an earlier, interrupted diagnosis of the same computed
    """

    scenario: Scenario
    card: Card
    data: Campaign
    oils: Mapping[str, Mapping[str, float]]
    reference: Campaign | None = None
    points: Campaign | None = None
    series: Series | None = None
    reference_series: Series | None = None
    invisible: Mapping[str, str] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    digest: str = ""
    most: int = 2
    memory: Memory = field(default_factory=Memory)

    @property
    def spec(self) -> Spec:
        """The machine."""
        return self.scenario.spec


def read_inputs(request: Request) -> Inputs:
    """Read and check all files of a diagnosis.

    Raises:
        DataError: all problems of all files at once
    """
    return _Reader(request).inputs()


class _Reader:
    """Reads one request, collecting problems all the way; nothing of it outlives the reading."""

    def __init__(self, request: Request) -> None:
        self.request = request
        self.problems: list[str] = []
        self.card = self.tried(lambda: read_card(request.card))
        self.problems += [] if self.card is None else card_problems(request.card, self.card)
        self.scenario = self.tried(lambda: rig_of(request.rig, self.card))
        tables = [path for path in (request.data, request.reference, request.predict) if path is not None]
        self.known, wrong = known_oils(tables, self.card)
        self.problems += wrong

    def tried(self, step: Callable[[], T]) -> T | None:
        """What a step gives; None, with its problems kept, where it fails."""
        try:
            return step()
        except GearheatError as error:
            self.problems += [p for p in error.problems if p not in self.problems]
            return None

    def campaign(self, path: Path | None, columns: Sequence[Column] = READINGS) -> Campaign | None:
        """A table with the protocol of the rig and the card."""
        if path is None:
            return None
        protocol = protocol_of(self.scenario, self.card)
        read = self.tried(lambda: read_measured(path, protocol, columns=columns, oils=self.known))
        if read is None:
            return None
        self.problems += implausible(read)
        return read if self.card is None else with_starts(read, self.card.run)

    def logged(self, path: Path | None, campaign: Campaign | None) -> Series | None:
        """A series of a campaign."""
        return None if path is None else self.tried(lambda: read_series(path, campaign))

    def inputs(self) -> Inputs:
        """All of the files, or all of their problems."""
        request = self.request
        data, reference = self.campaign(request.data), self.campaign(request.reference)
        points = self.campaign(request.predict, POINTS)
        series = self.logged(request.series, data)
        reference_series = self.logged(request.reference_series, reference)
        if request.reference_series is not None and request.reference is None:
            self.problems.append("--reference-series needs the readings of the same campaign. Give --reference, too.")
        if data is not None:
            self.problems += too_small(data)
        scenario, card = self.scenario, self.card
        if self.problems or scenario is None or card is None or data is None:
            raise DataError(self.problems)
        if request.repeatability == "points":
            if (shown := repeated(data)) is None:
                raise DataError(
                    f"{data.name}: no points were repeated that could show a repeatability. Take the card's."
                )
            card = with_repeatability(card, shown)
        used = sorted({r.oil for c in (data, reference, points) if c is not None for r in c.readings})
        found = Inputs(
            scenario=scenario,
            card=card,
            data=data,
            oils={name: oil_values(scenario, name, card) for name in used},
            reference=reference,
            points=points,
            series=series,
            reference_series=reference_series,
            invisible=invisible_causes(data, logged=series is not None),
            most=self.request.most,
            digest=_digest(request, scenario),
        )
        return replace(found, warnings=_warnings(request, found))


def rig_of(name: str, card: Card | None) -> Scenario:
    """The rig, lubricated as the card says and driven as its campaigns are.

    Raises:
        GearheatError: no such rig, or one that the causes or the card do not fit
    """
    scenario = load(name)
    if scenario.protocol is None:
        raise DataError(f"{scenario.name}: how its tests are run is not known. Give the rig file a table [campaign].")
    parts = {part.name for part in scenario.spec.parts}
    own = {part.name for cause in CAUSES.values() for part in cause.parts}
    ends = {port.partition(".")[0] for cause in CAUSES.values() for net in cause.connections for port in net}
    if missing := sorted(ends - own - parts):
        raise DataError(
            f"{scenario.name}: the causes act on parts that this rig does not have: {', '.join(missing)}."
            " Diagnose a rig with the layout of the planetary one."
        )
    if doubled := sorted(own & parts):
        raise DataError(f"{scenario.name}: part {', '.join(doubled)} has the name of a cause's part. Rename it.")
    spec = scenario.spec if card is None else lubricated(scenario.spec, card.lubrication)
    return replace(scenario, spec=spec).driven_by(scenario.protocol.inputs)


def protocol_of(scenario: Scenario | None, card: Card | None) -> Protocol | None:
    """The rig's protocol with the stop that the card states."""
    protocol = scenario.protocol if scenario else None
    if protocol is None or card is None or "stop_min" not in card.run.model_fields_set:
        return protocol
    return replace(protocol, stop=60.0 * card.run.stop_min)


def with_starts(campaign: Campaign, run: cards.Protocol) -> Campaign:
    """The campaign with the start of each test as the card states it, where the table does not."""
    if run.T_start_minus_amb_K == 0.0 and run.ambient_start_minus_reading_K == 0.0:
        return campaign
    first = {test.halves[0].point for test in campaign.tests()}

    def started(reading: Reading) -> Reading:
        if reading.point not in first:
            return replace(reading, values={**reading.values, "T_amb_start_C": np.nan, "T_start_C": np.nan})
        room = reading.values["T_amb_C"] + run.ambient_start_minus_reading_K
        room = reading.values["T_amb_start_C"] if reading.given("T_amb_start_C") else room
        values = {**reading.values, "T_amb_start_C": room}
        if not reading.given("T_start_C"):
            values |= {"T_start_C": room + run.T_start_minus_amb_K, BY_ROOM: 1.0}
        return replace(reading, values=values)

    return replace(campaign, readings=tuple(started(reading) for reading in campaign.readings))


def _warnings(request: Request, inputs: Inputs) -> tuple[str, ...]:
    """All warnings of all files, each once."""
    found = [w for c in (inputs.data, inputs.reference, inputs.points) if c is not None for w in c.warnings]
    found += [w for s in (inputs.series, inputs.reference_series) if s is not None for w in s.warnings]
    found += scatter_warning(inputs.data, inputs.card)
    found += card_warnings(request.card, inputs.card) + oil_warnings(inputs.oils, inputs.card)
    found += small_reference(inputs.reference) + outlying(inputs.data, inputs.points)
    found += [f"{cause}: {reason}." for cause, reason in inputs.invisible.items()]
    return tuple(dict.fromkeys(found))


def _digest(request: Request, scenario: Scenario) -> str:
    """Hash of the rig and of the bytes of all files, by what they are for."""
    digest = hashlib.sha256(repr((scenario.spec, scenario.protocol)).encode())
    for name, path in request.files().items():
        digest.update(name.encode() + hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()
