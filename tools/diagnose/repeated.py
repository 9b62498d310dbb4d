"""Scatter that repeated points show: tests with the same oil, speed and torque, day and mounting included."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...scenarios.measured import Campaign, Reading
from ..compare import noise_floor, repeats
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
    firsts: list[Reading] = []
    rows = []
    for reading in data.readings:
        first = next((f for f in firsts if _same(f, reading)), reading)
        if first is reading:
            firsts.append(reading)
        rows.append(_row(reading, first))
    freedom = sum(len(group) - 1 for group in repeats(rows))
    if freedom < LEAST:
        return None
    floor = noise_floor(rows)
    return Repeated(floor["T_oil_K"], floor["T_wall_K"], floor["loss_Nm"], freedom)


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


def _row(reading: Reading, first: Reading) -> dict[str, Any]:
    """A reading as a row of a comparison, at the point of the first reading that it repeats."""
    v = reading.values
    measured = {f"{column}_meas": v[column] for column in ("T_oil_C", "T_wall_C")}
    measured["loss_Nm_meas"] = abs(v["T_carrier_Nm"]) - 4 * abs(v["T_sun_Nm"])
    point = {"n_set_rpm": first.values["n_carrier_rpm"], "T_set_Nm": first.values["T_carrier_Nm"]}
    belongs = {"test": reading.test, "oil": reading.oil, "direction": reading.direction, "T_amb_C": v["T_amb_C"]}
    return {**belongs, **point, **measured}
