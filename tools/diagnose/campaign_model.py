"""A campaign under the superset model: what the tests show for many variants of the model at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np

from ...fmu.batch import Batch
from ...fmu.batch_library import cores
from ...model.core.flatten import flatten
from ...model.errors import SolveError
from ...model.machines.spec import Spec, assemble
from ...scenarios.measured import Campaign, Reading, Test, TestRun, schedule_of
from ..effects.cause import Readings, Rows
from .card import BY_ROOM
from .logged import Sampled, sampled
from .memory import Memory
from .series import Series
from .superset import as_read, superset

#: Of the solver's local error: what it leaves of a course is a few thousandths of a kelvin, far below any probe.
TOLERANCE = 1e-2
#: A course that takes more steps than this in a half runs away or chatters; a usual one takes ten.
MOST_STEPS = 600
#: Channel -> what the model says of it.
OUTPUTS = {"T_oil": "oil.T", "T_wall": "wall.T", "loss": "efficiency.tau_loss"}
#: Changed values of a variant: a number for all tests or an array of one per test.
Variant = Mapping[str, Any]


class Rig:
    """The compiled superset of a machine, for any campaign on it."""

    def __init__(self, spec: Spec) -> None:
        flat = as_read(flatten(assemble(superset(spec))))
        place = {q.name: i for i, q in enumerate(flat.outputs)}
        states = {q.name: i for i, q in enumerate(flat.states)}
        shown = [flat.x[states[o]] if o in states else flat.y[place[o]] for o in OUTPUTS.values()]
        outputs = tuple(replace(flat.outputs[0], name=channel) for channel in OUTPUTS)
        self.batch = Batch(replace(flat, outputs=outputs, y=ca.vertcat(*shown)), MOST_STEPS)
        self.base = {q.name: q.start for q in flat.parameters}
        self.inputs = flat.starts("input")
        self.n_states = len(flat.states)
        self.pool = ThreadPoolExecutor(cores()) if cores() > 1 else None
        self._home = np.array(list(self.base.values()))
        self._place = {name: i for i, name in enumerate(self.base)}

    def parameters(self, variants: Sequence[Variant], oils: Sequence[Mapping[str, float]]) -> np.ndarray:
        """Parameters (tests, variants, NP); what a variant makes of the rig's oil it makes of the test's oil."""
        p = np.tile(self._home, (len(oils), len(variants), 1))
        for v, values in enumerate(variants):
            for path, value in values.items():
                p[:, v, self._place[path]] = value  # a number for all tests, or one for each
        for test, oil in zip(p, oils, strict=True):
            for path, value in oil.items():
                test[:, self._place[path]] *= value / self.base[path]
        return p


class CampaignModel:
    """Tests of one campaign on one rig: `simulate` gives the true readings of variants of the model.

    Readings are those at the ends of the halves, test by test (`n` of them), then those at places of logged courses
    (`samples`), for which `rows` holds the conditions in the same order.

    Args:
        rig: the compiled superset
        campaign: readings or points, with their protocol
        oils: oil of a test -> its values by path
        memory: what an interrupted diagnosis already simulated
        span: first and last running order of the campaign to which the rows belong; its own where none is given
        series: logged courses
    """

    def __init__(
        self,
        rig: Rig,
        campaign: Campaign,
        oils: Mapping[str, Mapping[str, float]],
        memory: Memory | None = None,
        span: tuple[float, float] | None = None,
        series: Series | None = None,
    ) -> None:
        self.rig, self.campaign, self.memory = rig, campaign, memory or Memory()
        self.tests = campaign.tests()
        self.runs: list[TestRun] = [schedule_of(campaign, test) for test in self.tests]
        self.oils = [oils[test.oil] for test in self.tests]
        self.readings = [reading for test in self.tests for reading in test.halves]
        self.logged: list[list[Sampled]] = [
            sampled(series, test, _stop(run, test)) for run, test in zip(self.runs, self.tests, strict=True)
        ]
        ends = rows_of(self.readings, [len(test.halves) for test in self.tests], span)
        self.n, self.rows = len(self.readings), self._with_samples(ends)
        times = [self._times(k) for k in range(len(self.tests))]
        self._name = repr((campaign.readings, campaign.protocol, self.oils, times))
        batch = rig.batch
        self._duties = [
            (batch.prepared(run.schedule, own, TOLERANCE), ends, courses)
            for run, (own, ends, courses) in zip(self.runs, times, strict=True)
        ]

    @property
    def samples(self) -> int:
        """Number of places of logged courses."""
        return len(self.rows.test) - self.n

    def simulate(self, variants: Sequence[Variant]) -> list[Readings]:
        """True readings for each variant: channel -> (n + samples), NaN where a variant cannot be run.

        Raises:
            SolveError: the first variant cannot be run
        """

        def joined() -> dict[str, np.ndarray]:
            p = self.rig.parameters(variants, self.oils)
            every = self.rig.pool.map if self.rig.pool else map  # C lets go of the interpreter
            blocks = list(every(lambda k: self._test(k, variants, p[k]), range(len(self.tests))))
            whole = np.concatenate([b[0] for b in blocks] + [b[1] for b in blocks], axis=1)
            found = {channel: whole[:, :, i] for i, channel in enumerate(OUTPUTS)}
            return {**found, "T_oil2": found["T_oil"], "dwell": np.zeros_like(found["T_oil"])}

        whole = self.memory.kept((self._name, variants), joined)
        return [{c: whole[c][v] for c in whole} for v in range(len(variants))]

    def _test(self, k: int, variants: Sequence[Variant], p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Outputs at the ends of the halves, and at places of the course (variants, places, channels)."""
        start = np.repeat(self._start(variants, k), self.rig.n_states, axis=1)
        duty, ends, places = self._duties[k]
        rows = self.rig.batch.warmup(duty, self.rig.inputs, p, start, threads=1)
        if rows.status[0]:
            raise SolveError(f"test {self.tests[k].number}: the model cannot be run with {variants[0]}.")
        courses = [rows.y[:, :0], *(item.weights @ rows.y[:, which] for item, which in places)]
        return rows.y[:, ends], np.concatenate(courses, axis=1)

    def _start(self, variants: Sequence[Variant], k: int) -> np.ndarray:
        """Temperature at the start of a test (variants, 1): that of the room, where it was not measured itself."""
        first, T = self.tests[k].halves[0], self.runs[k].T_start
        if first.given("T_start_C") and BY_ROOM not in first.values:
            return np.full((len(variants), 1), T)
        bias = [values.get("read.room_bias", 0.0) for values in variants]
        return np.array([[T - float(b if np.ndim(b) == 0 else b[k])] for b in bias])

    def _times(self, k: int) -> tuple[np.ndarray, np.ndarray, list[tuple[Sampled, np.ndarray]]]:
        """Times of the readings of a test, and which of them are the ends of its halves and which those of courses.

        The end of a half is a time given twice: the row in front of the jump counts.
        """
        times: list[float] = []
        ends: list[int] = []
        courses: list[tuple[Sampled, np.ndarray]] = []
        for h, end in enumerate(self.runs[k].moments):
            dwell = self.tests[k].halves[h].si("dwell_min")
            for item in self.logged[k][h : h + 1]:
                if len(item.shares):
                    before = item.when[item.when < 1]
                    courses.append((item, len(times) + np.minimum(np.arange(len(item.when)), len(before))))
                    times += list(end - dwell * (1 - before))
            ends.append(len(times))
            times += [end, end]
        return np.array(times), np.array(ends, dtype=int), courses

    def _with_samples(self, ends: Rows) -> Rows:
        """The conditions of the ends, and behind them those of the places of logged courses: as at the end."""
        firsts = np.cumsum([0, *(len(test.halves) for test in self.tests)])
        items = [(firsts[k] + item.half, len(item.shares)) for k, own in enumerate(self.logged) for item in own]
        which = np.array([row for row, count in items for _ in range(count)], dtype=int)
        share = np.concatenate([ends.share, *(item.shares for own in self.logged for item in own)])
        rows = np.concatenate([np.arange(len(ends.test)), which])
        humidity = None if ends.humidity is None else ends.humidity[rows]
        names = ("test", "order", "direction", "w", "tau", "T_room", "rise")
        return Rows(**{name: getattr(ends, name)[rows] for name in names}, share=share, humidity=humidity)


def _stop(run: TestRun, test: Test) -> float:
    """Time between the halves of a test [s]."""
    dwells = [half.si("dwell_min") for half in test.halves]
    return (run.moments[-1] - sum(dwells)) / max(len(dwells) - 1, 1)


def _rise(reading: Reading) -> float:
    """Oil over room as measured [K]; at points to predict a typical value for their power."""
    if reading.given("T_oil_C"):
        return reading.values["T_oil_C"] - reading.values["T_amb_C"]
    return float(0.2 * reading.values["n_carrier_rpm"] * (reading.values["T_carrier_Nm"] / 2000) ** 0.5)


def rows_of(readings: Sequence[Any], halves: Sequence[int], span: tuple[float, float] | None = None) -> Rows:
    """What instruments' faults depend on, from the readings of the tests in running order."""
    test = np.repeat(np.arange(len(halves)), halves)
    order = np.array([reading.order for reading in readings], dtype=float)
    first, last = span or (float(order.min()), float(order.max()))
    humidity = np.array([reading.values.get("humidity_pct", np.nan) for reading in readings])
    return Rows(
        test=test,
        order=(order - first) / max(last - first, 1.0),
        direction=np.where(np.array([r.direction for r in readings]) == 1, 1.0, -1.0),
        w=np.array([reading.si("n_carrier_rpm") for reading in readings]),
        tau=np.array([reading.values["T_carrier_Nm"] for reading in readings]),
        T_room=np.array([reading.si("T_amb_C") for reading in readings]),
        rise=np.array([_rise(reading) for reading in readings]),
        share=np.ones(len(readings)),
        humidity=humidity if np.isfinite(humidity).all() else None,
    )
