"""Duties: pieces, stretches between jumps, phases, and what is refused."""

import numpy as np
import pytest
from gearheat.model.errors import DataError
from gearheat.model.run.schedule import Schedule, join_phases


def duty(time: list[float], **values: list[float]) -> Schedule:
    return Schedule(np.array(time), {name: np.array(column) for name, column in values.items()})


def test_phases_keep_what_they_do_not_name() -> None:
    schedule = join_phases([(60.0, {"w": 1.0, "T": 300.0}), (30.0, {"w": (2.0, 4.0)}), (10.0, {"tau": 5.0})])
    assert schedule.time.tolist() == [0.0, 60.0, 60.0, 90.0, 90.0, 100.0]
    assert schedule.values["w"].tolist() == [1.0, 1.0, 2.0, 4.0, 4.0, 4.0]
    assert schedule.values["T"].tolist() == [300.0] * 6
    assert schedule.values["tau"].tolist() == [5.0] * 6


def test_stretches_lie_between_jumps() -> None:
    schedule = duty([0.0, 10.0, 10.0, 10.0, 20.0], w=[0.0, 1.0, 7.0, 2.0, 3.0])
    assert [schedule.values["w"][s].tolist() for s in schedule.stretches()] == [[0.0, 1.0], [2.0, 3.0]]


def test_stretches_hold_kinks_together() -> None:
    schedule = duty([0.0, 10.0, 20.0, 20.0, 30.0, 30.0], w=[0.0, 1.0, 0.0, 5.0, 5.0, 6.0])
    assert [schedule.time[s].tolist() for s in schedule.stretches()] == [[0.0, 10.0, 20.0], [20.0, 30.0]]


@pytest.mark.parametrize(
    ("time", "values", "text"),
    [
        ([0.0], [1.0], "at least two points"),
        ([0.0, 2.0, 1.0], [1.0, 1.0, 1.0], r"Time goes back \(1 s after 2 s\)"),
        ([0.0, 1.0], [1.0], "1 values for 2 times"),
        ([0.0, 1.0], [1.0, float("nan")], "at 1 s is not finite"),
    ],
)
def test_refused(time: list[float], values: list[float], text: str) -> None:
    with pytest.raises(DataError, match=text):
        duty(time, w=values)
