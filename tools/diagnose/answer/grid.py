"""A campaign before it is run: points of a table or a grid over the rig's range, with the readings the model gives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ....model.errors import DataError
from ....scenarios.measured.card import Card
from ....scenarios.measured.nominal import Nominal
from ....scenarios.measured.sensors import drive_by, sensors_of
from ....scenarios.measured.table import Campaign, Sensor
from ....scenarios.scenario import Scenario

#: Speeds and loads of the grid.
SPEEDS = (0.4, 0.6, 0.8, 1.0)
#: As shares of those at the operating point.
LOADS = (0.55, 0.7, 0.85, 1.0)
#: A change of the room along it [K].
ROOM = 4.0
#: Dwells where power flows both ways and no card says it [min].
DWELLS = (240.0, 90.0)


def planned_campaign(scenario: Scenario, card: Card, points: Campaign | None) -> Campaign:
    """Conditions with the readings of the rig as in its file.

    Args:
        scenario: the rig
        card: sensors and protocol
        points: conditions; a grid of 4 x 4 points without them

    Raises:
        DataError: the rig has no sensor, or cannot be run at any point
    """
    sensors = sensors_of(scenario, card)
    if not any(s.role == "read" for s in sensors):
        raise DataError(f"{scenario.name}: no sensor is compared. Declare one under [sensors] in the rig file.")
    nominal = Nominal(drive_by(scenario, sensors))
    campaign = _grid(scenario, card, sensors, nominal) if points is None else points
    read = tuple(s for s in sensors if s.role == "read" and s.name not in campaign.values)
    campaign = replace(campaign, sensors=(*campaign.sensors, *read))
    return _answered(campaign, nominal)


def _grid(scenario: Scenario, card: Card, sensors: tuple[Sensor, ...], nominal: Nominal) -> Campaign:
    """Speeds and loads in a mixed running order, both directions in each test where the rig's tests have them."""
    both, steady = scenario.protocol is not None, scenario.protocol is None
    directions = np.array([1.0, -1.0]) if both else np.zeros(1)
    rows, n = len(directions), len(SPEEDS) * len(LOADS)
    grid = [(a, b) for a in SPEEDS for b in LOADS]
    shares = {"speed": 0, "torque": 1, "power": 1}
    order = (np.arange(n) * 7) % n  # neighbours of the grid are no neighbours in time
    place = np.repeat([grid[k] for k in order], rows, axis=0)
    direction = np.tile(directions, n)
    values = {}
    for s in (s for s in sensors if s.role == "given"):
        full = nominal.value(s.reads) / s.sign(np.ones(1))[0]
        share = place[:, shares[s.kind]] if s.kind in shares else np.ones(n * rows)
        drift = ROOM * (np.arange(n * rows) / (n * rows) - 0.5) if s.kind == "ambient" else 0.0
        values[s.name] = full * share + drift
    minutes = card.protocol.dwell_min or list(DWELLS)
    dwell = [np.inf] if steady else [60.0 * minutes[min(k, len(minutes) - 1)] for k in range(rows)]
    stop = scenario.protocol.stop if scenario.protocol else 0.0
    nothing = np.full(n, np.nan)
    return Campaign(
        name=f"grid of {len(SPEEDS)} x {len(LOADS)} points",
        sensors=tuple(s for s in sensors if s.role == "given"),
        values=values,
        test=np.repeat(np.arange(n), rows),
        order=np.arange(1.0, n + 1),
        direction=direction,
        dwell=np.tile(dwell, n),
        stop=np.tile([0.0] + [stop] * (rows - 1), n),
        oil=("",) * n,
        mounting=("",) * n,
        T_start=nothing,
        room_start=nothing,
        humidity=nothing,
        date=("",) * n,
        lines=np.arange(n * rows) + 2,
        points=np.arange(n * rows) + 1,
    )


def _answered(campaign: Campaign, nominal: Nominal) -> Campaign:
    """The campaign with steady readings of the model where it has none."""
    missing = [s for s in campaign.read if s.name not in campaign.values]
    found = {s.name: np.full(campaign.n, np.nan) for s in missing}
    for row in range(campaign.n):
        signs = {s.name: float(s.sign(campaign.direction[row : row + 1])[0]) for s in campaign.sensors}
        at = nominal.at({s.reads: signs[s.name] * float(campaign.values[s.name][row]) for s in campaign.given})
        for s in missing:
            found[s.name][row] = signs[s.name] * at[s.reads] if at is not None else np.nan
    if missing and not any(np.isfinite(column).any() for column in found.values()):
        raise DataError(f"{campaign.name}: the rig has no steady state at any of the points. Give milder ones.")
    return replace(campaign, values={**campaign.values, **found})
