"""What a campaign cannot show: causes that need a column, a sensor or a variation that it does not have."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping

import numpy as np

from .table import Campaign

#: Range of a given quantity, relative to its largest, below which there is but one of it.
ONE_VALUE = 0.1
#: Causes of a sensor that act over the running order.
ORDERED = ("drift", "step", "since", "random_walk")


def invisible(campaign: Campaign, *, logged: bool = False) -> Mapping[str, str]:
    """Cause -> why these data cannot show it, or cannot tell it from another.

    Args:
        campaign: the readings
        logged: whether there are logs of the same rig, too
    """
    found: dict[str, str] = {}
    for cause, reason in (
        *_columns(campaign),
        *_sensors(campaign),
        *_ranges(campaign),
        *([] if logged else _times(campaign)),
    ):
        found.setdefault(cause, reason)
    return found


def _columns(campaign: Campaign) -> Iterator[tuple[str, str]]:
    kinds = sorted({s.kind for s in campaign.sensors})
    if np.isnan(campaign.humidity).all():
        yield "cooling.humidity", "no humidity_pct: it cannot be told from a scatter of the days"
    if not any(campaign.date):
        yield "procedure.day_scatter", "no date: each test counts as a day of its own"
    if (campaign.n_tests < campaign.n and len(set(campaign.order)) == 1) or campaign.n_tests == 1:
        yield "procedure.order", "all readings have the same order"
        yield from ((f"sensor.{kind}.{form}", "all readings have the same order") for kind in kinds for form in ORDERED)
    if len(set(np.sign(campaign.direction))) < 2:
        yield "losses.mesh_direction", "one direction only: there is nothing to compare it with"
        yield "sensor.torque.offset", "one direction only: it cannot be told from a loss that no load changes"
        yield from ((f"sensor.{kind}.by_direction", "one direction only") for kind in kinds)
    if len(set(campaign.mounting)) < 2:
        yield from (
            (f"sensor.{kind}.mounting", "one mounting only: it is part of the fixed tolerance") for kind in kinds
        )


def _sensors(campaign: Campaign) -> Iterator[tuple[str, str]]:
    places = Counter(s.reads for s in campaign.read if s.kind == "oil_temp")
    if max(places.values(), default=0) < 2:
        yield "sensor.oil_temp.position", "one oil probe: its place is harder to tell from its offset"
    if not any(s.kind in ("torque", "power") for s in campaign.read):
        yield "losses.torque_only", "no torque is read: losses are seen through temperatures only"
    if not any(s.kind == "wall_temp" for s in campaign.read):
        yield "cooling.oil_wall", "no wall temperature: it cannot be told from the cooling outside"
        yield "cooling.contact", "no wall temperature: it cannot be told from the cooling outside"


def _ranges(campaign: Campaign) -> Iterator[tuple[str, str]]:
    if _one_value(campaign, "speed"):
        reason = "one speed only: losses that grow with speed cannot be told from each other"
        yield from ((cause, reason) for cause in ("losses.churning", "losses.windage", "sensor.speed.gain"))
    if _one_value(campaign, "torque"):
        yield "sensor.torque.gain", "one torque only: it cannot be told from an offset"
        yield "losses.mesh_friction", "one torque only: it cannot be told from losses that no load changes"


def _one_value(campaign: Campaign, kind: str) -> bool:
    """Whether all given quantities of a kind stay where they are."""
    given = [np.abs(campaign.values[s.name]) for s in campaign.given if s.kind == kind]
    return bool(given) and all(np.ptp(values) <= ONE_VALUE * np.max(values) for values in given)


def _times(campaign: Campaign) -> Iterator[tuple[str, str]]:
    if campaign.steady:
        yield "thermal.mass", "steady states and no logs: no capacity acts"
        yield "procedure.not_stationary", "no dwell_min: all readings are taken for steady states"
    else:
        yield "thermal.mass", "no logs: seen only as far as the readings were not stationary"
