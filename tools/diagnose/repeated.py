"""Scatter that repeated points show: tests with the same oil, speed and torque, day and mounting included."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...scenarios.measured import Campaign, Reading
from .card import Card

#: Points closer than this in speed and torque are the same; degrees of freedom below which nothing is said.
SAME, LEAST = 0.02, 3
#: A scatter that is this many times what the card states is worth a warning.
LARGER = 1.5


@dataclass(frozen=True)
class Repeated:
    """Standard deviations of one reading [K, K, N.m] by its repetitions, and their degrees of freedom."""

    T_oil: float
    T_wall: float
    loss: float
    freedom: int


def repeated(data: Campaign) -> Repeated | None:
    """What repeated points say: oil and wall over the room, loss torque at the carrier; None with too few of them."""
    groups: list[list[Reading]] = []
    for reading in data.readings:
        group = next((g for g in groups if _same(g[0], reading)), None)
        if group is None:
            groups.append([reading])
        else:
            group.append(reading)
    freedom = sum(len(g) - 1 for g in groups)
    if freedom < LEAST:
        return None
    inside = sum(((x := np.array([_values(r) for r in g])) - x.mean(axis=0)).T ** 2 @ np.ones(len(g)) for g in groups)
    oil, wall, loss = np.sqrt(np.asarray(inside) / freedom)
    return Repeated(float(oil), float(wall), float(loss), freedom)


def with_repeatability(card: Card, found: Repeated) -> Card:
    """The card with the repeatability of repeated points where it states a smaller one."""
    room, sun = card.channel("T_amb_C").repeat_sd, card.channel("T_sun_Nm").repeat_sd
    shown = {
        "T_oil_C": found.T_oil**2 - room**2,
        "T_oil2_C": found.T_oil**2 - room**2,
        "T_wall_C": found.T_wall**2 - room**2,
        "T_carrier_Nm": found.loss**2 - 16 * sun**2,
    }
    channels = dict(card.channels)
    for column, variance in shown.items():
        stated = card.channel(column)
        wider = max(stated.repeat_sd, float(np.sqrt(max(variance, 0.0))))
        channels[column] = stated.model_copy(update={"repeat_sd": wider})
    return card.model_copy(update={"channels": channels})


def scatter_warning(data: Campaign, card: Card) -> Sequence[str]:
    """Repeated points that scatter more than the card states."""
    found = repeated(data)
    if found is None:
        return ()
    oil = float(np.hypot(card.channel("T_oil_C").repeat_sd, card.channel("T_amb_C").repeat_sd))
    loss = float(np.hypot(card.channel("T_carrier_Nm").repeat_sd, 4 * card.channel("T_sun_Nm").repeat_sd))
    if found.T_oil < LARGER * oil and found.loss < LARGER * loss:
        return ()
    return (
        f"{data.name}: repeated points ({found.freedom} degrees of freedom) scatter by {found.T_oil:.2g} K in the oil"
        f" and {found.loss:.2g} N.m in the loss torque; the card states {oil:.2g} K and {loss:.2g} N.m."
        " --repeatability points takes what the points show.",
    )


def _same(a: Reading, b: Reading) -> bool:
    near = all(
        abs(a.values[c] - b.values[c]) <= SAME * max(abs(a.values[c]), 1e-9) for c in ("n_carrier_rpm", "T_carrier_Nm")
    )
    return near and a.oil == b.oil and a.direction == b.direction and a.test != b.test


def _values(reading: Reading) -> tuple[float, float, float]:
    v = reading.values
    return (
        v["T_oil_C"] - v["T_amb_C"],
        v["T_wall_C"] - v["T_amb_C"],
        abs(v["T_carrier_Nm"]) - 4 * abs(v["T_sun_Nm"]),
    )
