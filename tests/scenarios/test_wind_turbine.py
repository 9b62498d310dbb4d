"""What the page of the wind turbine says of the raw data."""

import csv
import gzip

import numpy as np
import pytest
from gearheat.scenarios.shipped import RIGS


def cooler(machine: str) -> dict[bool, tuple[float, float]]:
    """Whether in 2016 -> least and largest median by stretch of how far the cooler cools while it works."""
    with gzip.open(RIGS / "wind_turbine" / f"{machine}.csv.gz", "rt", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))

    def column(name: str) -> np.ndarray:
        return np.array([float(row[name] or "nan") for row in rows])

    sump, inlet, nacelle = (column(f"T_{name}_C") for name in ("sump", "inlet", "nacelle"))
    stretch, late = column("segment"), np.array([row["time_utc"] >= "2016" for row in rows])
    works = (np.diff(sump, prepend=np.nan) < -0.3) & (sump > 54) & (column("n_hss_rpm") > 1500)
    found: dict[bool, list[float]] = {False: [], True: []}
    for number in np.unique(stretch):
        mine = works & (stretch == number)
        if mine.sum() > 20:
            found[bool(late[mine].any())].append(float(np.median((sump - inlet)[mine] / (sump - nacelle)[mine])))
    return {year: (min(medians), max(medians)) for year, medians in found.items()}


def test_all_coolers_lose_and_one_most() -> None:
    before, after = (cooler("R80711")[year] for year in (False, True))
    assert before == pytest.approx((0.20, 0.25), abs=0.006)
    assert after == pytest.approx((0.17, 0.20), abs=0.006)
    others = [cooler(machine) for machine in ("R80721", "R80736", "R80790")]
    assert min(o[False][0] for o in others) == pytest.approx(0.22, abs=0.006)
    assert max(o[False][1] for o in others) == pytest.approx(0.26, abs=0.006)
    assert min(o[True][0] for o in others) == pytest.approx(0.19, abs=0.006)
    assert max(o[True][1] for o in others) == pytest.approx(0.22, abs=0.006)
