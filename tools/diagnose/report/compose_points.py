"""From what a search found to points: those that were repeated, and what instruments will show at others."""

from __future__ import annotations

import numpy as np

from ....scenarios.measured.repeats import Repeat as Repeated
from ....scenarios.measured.repeats import repeats, scatters
from ....scenarios.measured.table import Campaign
from ..answer import predict
from ..infer.found import Found
from ..setting import Setting
from . import channels
from .findings import Prediction
from .quality import Repeat, RepeatedPoint


def repeated(campaign: Campaign) -> tuple[RepeatedPoint, ...]:
    """Points that were measured in several tests, each sensor in running order, as deviations from the point's mean."""
    groups = repeats(campaign)
    stated = {s.sensor: s.stated for s in scatters(campaign, groups)}
    both = bool((campaign.direction < 0).any())
    told = []
    for group in groups:
        tests = [int(np.flatnonzero(campaign.order == order)[0]) for order in group.order]
        for sensor in campaign.read:
            unit, total, difference = channels.difference(sensor, 1.0), group.total[sensor.name], group.difference
            sums, apart = (unit * (v - np.nanmean(v)) for v in (total, difference[sensor.name]))
            told.append(
                RepeatedPoint(
                    condition=condition(campaign, group),
                    channel=sensor.name,
                    unit=channels.unit_of_difference(sensor),
                    repeats=tuple(
                        Repeat(test=k + 1, order=float(order), date=campaign.date[k], sum=a, difference=b)
                        for k, order, a, b in zip(tests, group.order, _known(sums), _known(apart, both), strict=True)
                    ),
                    sd=float(np.nanstd(sums, ddof=1)),
                    card=unit * stated[sensor.name] / (2**0.5 if both else 1.0),
                )
            )
    return tuple(told)


def _known(values: np.ndarray, at_all: bool = True) -> list[float | None]:
    """Numbers, None for those that there are not."""
    return [float(v) if at_all and np.isfinite(v) else None for v in values]


def condition(campaign: Campaign, point: Repeated) -> str:
    """What drives a point, in words."""
    said = [point.oil] if point.oil else []
    for name, value in point.conditions.items():
        sensor = campaign.sensor(name)
        said.append(f"{float(channels.in_unit(sensor, np.array(value))):.0f} {channels.unit(sensor)}")
    return ", ".join(said)


def predictions(setting: Setting, found: Found, points: Campaign) -> tuple[Prediction, ...]:
    """What the instruments will show at points, where the machine can be run.

    Args:
        setting: the rig
        found: the search
        points: their conditions
    """
    read = found.problem.data.read
    tables = [
        [channels.in_unit(s, row) for s, row in zip(read, table, strict=True)]
        for table in predict.predictions(setting, found, points)
    ]
    told = []
    for row in range(points.n):
        both = [{s.name: float(line[row]) for s, line in zip(read, t, strict=True)} for t in tables]
        stated = points.points[row] > 0  # else a row that a test lacks
        if stated and all(np.isfinite(v) for values in both for v in values.values()):
            told.append(Prediction(point=str(int(points.points[row])), nominal=both[0], extended=both[1]))
    return tuple(told)
