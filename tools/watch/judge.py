"""What the samples of a machine say: the diagnosis of logs, asked of all that has come."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any

import numpy as np

from ...model.errors import DataError
from ...scenarios.measured.logs import Log, log_of
from ...scenarios.measured.times import BARE, NUMBERS
from ..diagnose.answer import channels
from ..diagnose.answer.findings import Cause
from ..diagnose.infer.logs import Fleet, fleet, question
from ..diagnose.logs import Logs, check, formulas_of, judged
from ..diagnose.model.formula import Formula
from ..diagnose.report.phrases import name_of
from ..diagnose.request import Inputs
from .expect import expect
from .sources import stem
from .store import Cells

#: Half of a band of 95 % [standard deviations].
BAND = 1.96
#: The least probability of a cause that is named.
NAMED = 0.05


@dataclass
class Judge:
    """Machines of one type, their healthy logs, and the answer to a log.

    Args:
        inputs: rig, card and options
        reference: healthy logs of the machine, where there is one
        siblings: a healthy log of each of several machines, which are named as their files
    """

    inputs: Inputs
    reference: Sequence[Log] = ()
    siblings: Sequence[Log] = ()
    _known: dict[tuple[str, ...], tuple[Fleet, tuple[Formula, ...]]] = field(default_factory=dict)

    def log(self, machine: str, kind: str, times: Sequence[float], rows: Sequence[Cells]) -> Log:
        """Samples as a log.

        Args:
            machine: whose they are
            kind: of times, see `parse_time`
            times: of them [s], rising
            rows: the samples

        Raises:
            DataError: they cannot be a log of the rig
        """
        names = dict.fromkeys(name for row in rows for name in row)
        columns: dict[str, Any] = {name: [row.get(name) for row in rows] for name in names}
        time = {NUMBERS: "time_s", BARE: "time"}.get(kind, "time_utc")
        columns[time] = times if kind in (NUMBERS, BARE) else [datetime.fromtimestamp(t, UTC) for t in times]
        card = self.inputs.card.model_copy(update={"columns": {**self.inputs.card.columns, "time": time}})
        return log_of(machine, columns, np.arange(2, len(rows) + 2), self.inputs.scenario, card)

    def known(self, log: Log) -> tuple[Fleet, tuple[Formula, ...]]:
        """What the healthy logs say of the machine of a log and its type, and what it can show; read once."""
        names = tuple(s.name for s in log.sensors)
        if names not in self._known:
            found = fleet(self.inputs.scenario, self.reference, self.siblings, log)
            self._known[names] = found, formulas_of(found, log)
        of = next((1 + k for k, s in enumerate(self.siblings) if stem(s.name) == log.name), 0)
        healthy, formulas = self._known[names]
        return healthy.of(of), formulas

    def answer(self, machine: str, kind: str, times: Sequence[float], rows: Sequence[Cells]) -> dict[str, Any]:
        """What samples say: what is read in their last window, and what has changed; as `log`."""
        log = self.log(machine, kind, times, rows)
        if log.lines[-1] <= len(rows):  # of the last samples it is not known what drove the rig
            raise DataError(log.warnings[-1:])
        data = Logs([log], self.reference, self.siblings)
        check(data)
        known, formulas = self.known(log)
        known = known.going_on(data.logs)
        asked = question(known, data.logs)
        found = judged(self.inputs, known, asked, data, formulas=formulas)
        last = expect(known, asked.windows.some(np.array([asked.windows.time.argmax()])))
        temperatures = {}
        for j in np.flatnonzero(np.isfinite(last.measured)):
            s = log.read[j]
            measured, predicted = (s.signs[0] * means[j] for means in (last.measured, last.predicted))
            values = {"measured": measured, "predicted": predicted}
            values |= {"low": predicted - BAND * last.sd[j], "high": predicted + BAND * last.sd[j]}
            temperatures[s.name] = {key: round(float(channels.in_unit(s, v)), 3) for key, v in values.items()}
        changed = 1 - found.findings.nothing
        causes = [_named(c) for c in found.findings.causes if c.probability > NAMED]
        return {
            "readings": temperatures,
            "changed": round(changed, 4),
            "p_any": round(found.decision.p_any, 4),
            "verdict": found.decision.verdict,
            "causes": causes,
        }


def _named(cause: Cause) -> dict[str, Any]:
    since = cause.since.partition("(")[2].rstrip(")") or cause.since
    return {"id": cause.id, "name": name_of(cause.id), "probability": round(cause.probability, 4), "since": since}
