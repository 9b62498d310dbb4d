"""A campaign under the superset model: readings of all tests for many variants of the model at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ...fmu.batch import Batch
from ...model.core.flatten import flatten
from ...model.errors import SolveError
from ...model.machines.spec import Spec, assemble
from ...scenarios.measured import Campaign, Reading, TestRun, schedule_of
from ..effects.cause import Readings, Rows
from .memory import Memory
from .superset import as_read, superset

#: Share of the dwell before its end at which a second sample is taken, for readings that were not stationary.
EARLY = 0.15
#: Of the solver's local error: 1e-4 of 10 K, far below any probe.
TOLERANCE = 1e-4
#: Channel -> what the model says of it.
OUTPUTS = {"T_oil": "oil.T", "T_wall": "wall.T", "loss": "efficiency.tau_loss"}


class Rig:
    """The compiled superset of a machine, for any campaign on it."""

    def __init__(self, spec: Spec) -> None:
        flat = as_read(flatten(assemble(superset(spec))))
        self.batch = Batch(flat)
        self.base = {q.name: q.start for q in flat.parameters}
        self.inputs = flat.starts("input")
        self.n_states = len(flat.states)
        self._place = {name: i for i, name in enumerate(self.base)}

    def parameters(self, values: Mapping[str, float]) -> np.ndarray:
        """The parameter vector with values replaced."""
        vector = np.array(list(self.base.values()))
        for path, value in values.items():
            vector[self._place[path]] = value
        return vector


class CampaignModel:
    """Tests of one campaign on one rig: `simulate` gives the true readings of variants of the model.

    Args:
        rig: the compiled superset
        campaign: readings or points, with their protocol
        oils: oil of a test -> its values by path
        memory: what an interrupted diagnosis already simulated
        span: first and last running order of the campaign to which the rows belong; its own where none is given
    """

    def __init__(
        self,
        rig: Rig,
        campaign: Campaign,
        oils: Mapping[str, Mapping[str, float]],
        memory: Memory | None = None,
        span: tuple[float, float] | None = None,
    ) -> None:
        self.rig, self.campaign, self.memory = rig, campaign, memory or Memory()
        self.tests = campaign.tests()
        self.runs: list[TestRun] = [schedule_of(campaign, test) for test in self.tests]
        self.oils = [oils[test.oil] for test in self.tests]
        self.readings = [reading for test in self.tests for reading in test.halves]
        self.rows = rows_of(self.readings, [len(test.halves) for test in self.tests], span)

    def simulate(self, variants: Sequence[Mapping[str, Any]]) -> list[Readings]:
        """True readings for each variant.

        Args:
            variants: changed values by path, a number for all tests or an array of one per test

        Returns:
            per variant channel -> readings (n rows), with `<channel>_rate`, their change per dwell at its end; NaN
            where a variant cannot be run

        Raises:
            SolveError: the first variant cannot be run
        """

        def joined() -> dict[str, np.ndarray]:
            blocks = [self._test(k, variants) for k in range(len(self.tests))]
            return {c: np.concatenate([b[c] for b in blocks], axis=1) for c in blocks[0]}

        key = (repr((self.campaign.readings, self.campaign.protocol, self.oils)), variants)
        whole = self.memory.kept(key, joined)
        return [{c: whole[c][v] for c in whole} for v in range(len(variants))]

    def _test(self, k: int, variants: Sequence[Mapping[str, Any]]) -> dict[str, np.ndarray]:
        run, oil = self.runs[k], self.oils[k]

        def chosen(values: Mapping[str, Any]) -> dict[str, float]:
            """Values of this test; what a variant makes of the rig's oil it makes of the test's oil."""
            found = {path: float(v if np.ndim(v) == 0 else v[k]) for path, v in values.items()}
            changed = {path: oil[path] * found[path] / self.rig.base[path] for path in found.keys() & oil.keys()}
            return {**oil, **found, **changed}

        p = np.stack([self.rig.parameters(chosen(values)) for values in variants])
        dwell = [reading.values["dwell_min"] * 60.0 for reading in self.tests[k].halves]
        ends = zip(run.moments, dwell, strict=True)
        times = [t for end, length in ends for t in (end - EARLY * length, end, end)]  # twice: both sides of a jump
        start = np.full(self.rig.n_states, run.T_start)
        rows = self.rig.batch.warmup(run.schedule, self.rig.inputs, p, start, times=times, tolerance=TOLERANCE)
        if rows.status[0]:
            raise SolveError(f"test {self.tests[k].number}: the model cannot be run with {variants[0]}.")
        found = {}
        for channel, path in OUTPUTS.items():
            values = rows[path].reshape(len(variants), -1, 3)
            found[channel] = values[:, :, 1]
            found[f"{channel}_rate"] = (values[:, :, 1] - values[:, :, 0]) / EARLY
        return found


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
        humidity=humidity if np.isfinite(humidity).all() else None,
    )
