"""Logged courses of tests: which samples belong to which reading, what a curve makes of them, and what is refused."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import pytest
from gearheat.model.errors import DataError
from gearheat.scenarios.measured.card import Card
from gearheat.scenarios.measured.series import read_samples, series_of
from gearheat.scenarios.measured.table import PLACES, Campaign, Series
from made_tables import written

Columns = Mapping[str, Sequence[object]]


def logged(test: int = 1, first: float = 240.0, every: float = 5.0) -> dict[str, list[object]]:
    """A test of 240 and 90 min with a stop of 5 min, the first dwell cut off early; both warm in the same way."""
    found: dict[str, list[object]] = {key: [] for key in ("test", "time_s", "direction", "T_oil_C", "T_wall_C")}
    for direction, begin, dwell in ((1, 0.0, first), (2, first + 5.0, 90.0)):
        for minute in np.arange(0.0, dwell + 1e-9, every):
            row = (
                test,
                60 * (begin + minute),
                direction,
                50 - 25 * np.exp(-minute / 60),
                40 - 15 * np.exp(-minute / 60),
            )
            for column, value in zip(found.values(), row, strict=True):
                column.append(value)
    return found


@pytest.fixture
def series(rig, tmp_path) -> Callable[[Campaign, Columns], Series]:
    def reader(campaign: Campaign, columns: Columns) -> Series:
        return series_of(read_samples(written(tmp_path / "S.csv", columns), rig("planetary"), Card()), campaign)

    return reader


def test_courses_are_those_of_a_curve_through_the_samples_of_each_dwell(read, planetary, series) -> None:
    campaign = read("planetary", planetary)
    found = series(campaign, logged())
    assert [(c.row, c.sensor) for c in found.courses] == [(r, s) for r in (0, 1) for s in ("T_oil", "T_wall")]
    assert found.dwell[:2] == pytest.approx(campaign.dwell[:2]) and np.isnan(found.dwell[2:]).all()
    for course in found.courses:
        minute = np.array(PLACES) * (240 if course.row == 0 else 90)
        top, rise = (50, 25) if course.sensor == "T_oil" else (40, 15)
        known = minute >= 5.0 if course.row else minute >= 0.0
        assert course.values[known] == pytest.approx(273.15 + top - rise * np.exp(-minute / 60)[known], abs=0.1)
        variance = np.diag(course.scatter)[known]
        assert (variance > 0.01).all() and (variance < 1.0).all()
    assert "were not logged" in found.warnings[0]


def test_scatter_is_that_of_drawn_samples(read, planetary, series) -> None:
    campaign, rng, columns = read("planetary", planetary), np.random.default_rng(1), logged()
    drawn, courses = [], []
    for _ in range(200):
        noise = {"T_oil_C": list(20 + rng.standard_normal(len(columns["test"])))}
        courses = series(campaign, columns | noise).courses
        drawn.append(courses[0].values)
    assert np.cov(np.array(drawn).T) == pytest.approx(courses[0].scatter, abs=0.06)


def test_a_log_with_holes_does_not_cut_dwells_short(read, planetary, series) -> None:
    """The first two samples of a test are missing, the last one of its first dwell, and some between."""
    campaign, whole = read("planetary", planetary), logged()
    at = np.array(whole["time_s"], dtype=float) / 60
    kept = ~np.isin(at, [0.0, 5.0, 60.0, 65.0, 70.0, 240.0])
    found = series(
        campaign, {name: [v for v, k in zip(column, kept, strict=True) if k] for name, column in whole.items()}
    )
    assert found.dwell[:2] == pytest.approx(campaign.dwell[:2])


def test_behind_a_dwell_that_was_cut_off_no_course_is_compared(read, planetary, series) -> None:
    campaign = read("planetary", planetary)
    found = series(campaign, logged(first=170.0))
    assert found.dwell[:2] / campaign.dwell[:2] == pytest.approx([170 / 240, 1.0])
    assert {c.row for c in found.courses} == {0}
    assert np.isnan(found.courses[0].values).tolist() == [place > 170 / 240 for place in PLACES]


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"test": 99}, "no test 99"),
        ({"direction": None}, "Add the column point"),
        ({"time_s": 10.0}, "time goes back in test 1"),
        ({"T_oil_C": None, "T_wall_C": None}, "no thermometer to compare"),
        ({"time_s": None}, '"time_s"'),
        ({"T_oil_C": "warm"}, 'T_oil_C = "warm"'),
    ],
)
def test_what_cannot_be_is_refused(read, planetary, series, changes, told) -> None:
    columns = logged()
    for name, value in changes.items():
        if value is None:
            del columns[name]
        else:
            columns[name][-1] = value
    with pytest.raises(DataError) as error:
        series(read("planetary", planetary), columns)
    assert any(told in problem for problem in error.value.problems)


def test_steady_states_have_no_courses(read, planetary, series) -> None:
    steady = {key: column for key, column in planetary.items() if key != "dwell_min"}
    with pytest.raises(DataError, match="dwell_min"):
        series(read("planetary", steady), logged())


def test_numbers_of_readings_name_the_dwell_of_any_rig(read, planetary, series) -> None:
    columns = logged()
    columns["point"] = [1 if d == 1 else 2 for d in columns["direction"]]
    expected = series(read("planetary", planetary), columns)
    del columns["direction"]
    found = series(read("planetary", planetary), columns)
    assert [c.values.tolist() for c in found.courses] == [c.values.tolist() for c in expected.courses]
