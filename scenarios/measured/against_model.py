"""Measured tables beside what the nominal model gives at the same conditions: other units and signs, no readings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from ...model.units import in_unit, text
from .nominal import Nominal
from .sensors import SI
from .table import Campaign, Sensor

#: Name of an oil -> values by path.
Oils = Mapping[str, Mapping[str, float]]

#: Fewer tests than these say nothing about any cause.
LEAST_TESTS = 3
#: Given conditions nearer than this part of their size are the same point.
SAME = 0.01
#: Readings that differ from the nominal model's by more than this factor.
TORQUE_FACTOR = 2.0
#: In most rows.
LOSS_FACTOR = 10.0
#: Have another unit or sign.
RISE_FACTOR = 5.0
#: A rise over the room below this [K] says nothing about a unit.
SMALL_RISE = 2.0
#: Nor does one that is nearer to the model's than this [K]: probes err so much.
PROBE_ERROR = 5.0
#: A machine slower than this share of its operating speed is at rest, and warm of what was before; rev/s that are taken
#: for rpm are 1/60.
AT_REST = 0.01
#: Rows that are held against the nominal model.
SAMPLED = 6
#: In a table of so many rows the largest jumps of what drives show whether the points were held,
HELD_ROWS = 50
JUMPS = 12
#: where the model's temperatures jump by this [K] on average, and the readings by this share of it.
JUMP_K = 1.5
FOLLOWED = 0.3
#: Readings that change from row to row by this share of what they do at random come one from another.
CREEPING = 0.3
#: A temperature this much further over the room than the model's, at most by `RISE_FACTOR`, may be in degF,
SLIP_FACTOR = 1.6
#: where it is nearer than this factor in degF.
SLIP_FITS = 1.4
#: A room below this is taken to be in degC [K].
WARM_ROOM = 311.15


def format_value(sensor: Sensor, value: float) -> str:
    """A value as messages show it.

    Args:
        sensor: what shows it
        value: in SI
    """
    return text(float(value), SI[sensor.kind], 4)


def place(campaign: Campaign, row: int | np.intp) -> str:
    """File and line of a row, for a message.

    Args:
        campaign: the table
        row: its row
    """
    return f"{campaign.name} line {campaign.lines[row]}"


def against_model(campaign: Campaign, nominal: Nominal, oils: Oils) -> Iterator[str]:
    """Torques and temperatures that are far from what the nominal model gives at the same conditions.

    Args:
        campaign: what was measured
        nominal: its rig
        oils: name of each of its oils -> values by path
    """
    turning = np.flatnonzero(_turns(campaign, nominal))
    rows = np.unique(turning[np.linspace(0, len(turning) - 1, min(SAMPLED, len(turning))).round().astype(int)])
    found = _states(campaign, nominal, oils, rows)
    for sensor in campaign.read if found else ():
        measured = campaign.values[sensor.name] * sensor.sign(campaign.direction)
        pairs = {
            row: (float(measured[row]), state[sensor.reads])
            for row, state in found.items()
            if np.isfinite(measured[row])
        }
        if pairs:
            yield from _constant(campaign, sensor, [model for _, model in pairs.values()])
        if pairs and sensor.kind == "torque":
            yield from _torque(campaign, nominal, sensor, pairs)
        elif pairs and sensor.kind.endswith("_temp"):
            yield from _rise(campaign, sensor, pairs)


def unheld(campaign: Campaign, nominal: Nominal, oils: Oils) -> Iterator[str]:
    """Rows in which nothing follows what drives the machine: samples of a log, whose steps nothing says.

    Args:
        campaign: what was measured, each row a test of its own
        nominal: its rig
        oils: name of each of its oils -> values by path
    """
    if campaign.n < HELD_ROWS:
        return
    jumps = np.zeros(campaign.n - 1)
    for sensor in campaign.given:
        values = np.abs(campaign.values[sensor.name])
        jumps = np.fmax(jumps, np.abs(np.diff(values)) / max(np.nanmax(values), 1e-9))
    after = np.sort(np.argsort(-jumps, kind="stable")[:JUMPS]) + 1
    states = _states(campaign, nominal, oils, np.unique([after - 1, after]))
    rows = np.array([k for k in after.tolist() if {k - 1, k} <= states.keys()], dtype=int)
    found: dict[str, tuple[bool, float, float]] = {}
    for sensor in (s for s in campaign.read if SI[s.kind] == "K"):
        values = campaign.values[sensor.name]
        read = values[rows] - values[rows - 1]
        model = np.array([states[k][sensor.reads] - states[k - 1][sensor.reads] for k in rows.tolist()])
        usual = float(np.mean(np.abs(model))) if len(rows) else 0.0
        if np.isfinite(read).all() and usual > JUMP_K:
            creeping = np.nanmean(np.diff(values) ** 2) < CREEPING * 2.0 * np.nanvar(values)
            warming = np.nanmax(values) - np.nanmin(values) > usual  # a probe of the room does not
            behind = bool(creeping and warming and read @ model < FOLLOWED * (model @ model))
            found[sensor.column] = (behind, float(np.mean(np.abs(read))), usual)
    if found and all(behind for behind, _, _ in found.values()):
        column, (_, moved, usual) = next(iter(found.items()))
        yield (
            f"{campaign.name} seems to be a log: at the largest jumps of what drives it {column} moves by {moved:.2g} K"
            f" from row to row, the steady state by {usual:.2g} K. Give it by --logs with a column of time, and as a"
            ' table the points that were held; or say that all rows are of steady states: protocol = "steady" in the'
            " card."
        )


def _states(campaign: Campaign, nominal: Nominal, oils: Oils, rows: np.ndarray) -> dict[int, Mapping[str, float]]:
    """Row -> values by path of the nominal model's steady state there, where it has one."""
    given = {s.reads: campaign.values[s.name] * s.sign(campaign.direction) for s in campaign.given}
    inputs = {int(row): {path: float(values[row]) for path, values in given.items()} for row in rows}
    found = {row: nominal.at({**oils.get(campaign.oil[campaign.test[row]], {}), **own}) for row, own in inputs.items()}
    return {row: state for row, state in found.items() if state is not None}


def _turns(campaign: Campaign, nominal: Nominal) -> np.ndarray:
    """Whether the machine turns in each row (n,), as far as its speeds are known."""
    speeds = [s for s in campaign.given if s.kind == "speed"]
    shares = [np.abs(campaign.values[s.name] / nominal.value(s.reads)) for s in speeds]
    return np.any([~(share < AT_REST) for share in shares], axis=0) if shares else np.ones(campaign.n, dtype=bool)


def _constant(campaign: Campaign, sensor: Sensor, model: Sequence[float]) -> Iterator[str]:
    """A sensor that shows the same in all rows where the model does not."""
    values = campaign.values[sensor.name]
    known = values[np.isfinite(values)]
    varies = np.ptp(np.abs(model)) > max(SMALL_RISE if SI[sensor.kind] == "K" else SAME * np.max(np.abs(model)), 1e-9)
    if len(known) > LEAST_TESTS and np.ptp(known) == 0.0 and varies:
        yield (
            f"{campaign.name}: {sensor.column} is {format_value(sensor, known[0])} in all {len(known)} rows."
            " Give what was read, or leave out the column."
        )


def _torque(
    campaign: Campaign, nominal: Nominal, sensor: Sensor, pairs: dict[int, tuple[float, float]]
) -> Iterator[str]:
    """A torque that is read far from the model's: another unit, another sign, or none at all."""
    ratios = {row: read / model for row, (read, model) in pairs.items() if abs(model) > 0}
    factor = TORQUE_FACTOR if len(nominal.ends) > 1 else LOSS_FACTOR
    odd = {row: ratio for row, ratio in ratios.items() if not 1 / factor <= ratio <= factor}
    if 2 * len(odd) < max(len(ratios), 1):
        return
    turned = [row for row, ratio in odd.items() if 1 / factor <= -ratio <= factor]
    sign = 2 * len(turned) >= len(odd)
    row = turned[0] if sign else next(row for row in odd if row not in turned)
    read, model = (format_value(sensor, value) for value in pairs[row])
    where = f"{place(campaign, row)}: {sensor.column} gives {read}, the model {model}"
    if not sign:
        yield f"{where}. Check its unit, which is taken for {sensor.unit}."
    elif len(turned) == len(ratios):
        given = "".join(f", or that of {s.column} is" for s in campaign.given if s.kind == "torque")
        yield f"{where}: its sign is the other one{given}. Turn it, or say magnitude = true of this sensor in the card."
    else:
        yield (
            f"{where}: its sign is the other one in {len(turned)} of {len(ratios)} rows, those of one direction. Write"
            " speeds and torques of both directions with the model's signs, torques positive into the gearbox; or"
            " torques without a sign, with signed speeds or a column direction (1, 2)."
        )


def _rise(campaign: Campaign, sensor: Sensor, pairs: dict[int, tuple[float, float]]) -> Iterator[str]:
    """A temperature over the room that is far from the model's: speed, torque or the temperature has another unit."""
    rooms = [s for s in campaign.given if s.kind == "ambient"]
    if not rooms:
        return
    room = campaign.values[rooms[0].name]
    rises = [(row, read - room[row], model - room[row]) for row, (read, model) in pairs.items()]
    ratios = [
        (read + np.clip(model - read, -PROBE_ERROR, PROBE_ERROR)) / model
        for _, read, model in rises
        if model > SMALL_RISE or read > RISE_FACTOR * SMALL_RISE
    ]
    middle = float(np.median(ratios)) if ratios else 1.0
    row, read, model = max(rises, key=lambda r: abs(r[1] - r[2]))
    where = f"{place(campaign, row)}: {sensor.column} is {read:.3g} K over the room, the model gives {model:.3g} K."
    short = not campaign.steady  # a reading may be far below the steady state
    below = float(np.quantile([read for _, read, _ in rises], 0.25))
    started = campaign.start_by_room < 0 or np.isfinite(campaign.T_start).any()
    if below < -PROBE_ERROR and not started and all(model > SMALL_RISE for _, _, model in rises):
        yield f"{where} Losses keep a machine warmer than its room: check {sensor.column} and {rooms[0].column}."
        return
    far = middle > RISE_FACTOR or not (short or middle >= 1 / RISE_FACTOR)
    if not far and middle <= SLIP_FACTOR:
        return
    alone = np.median([(in_unit(r + room[k], "degC") - 32) / 1.8 + 273.15 - room[k] for k, r, _ in rises])
    both = np.median([r for _, r, _ in rises]) / 1.8 if np.nanmedian(room) > WARM_ROOM else np.nan
    usual = np.median([m for _, _, m in rises])
    fits = any(usual / SLIP_FITS < rise < usual * SLIP_FITS for rise in (alone, both))
    degF = " In degF it would fit." if fits and middle > SLIP_FACTOR and sensor.unit == "degC" else ""
    if far:
        given = ", ".join(f"{s.column} ({s.unit})" for s in campaign.given)
        yield f"{where}{degF} Check its unit, which is taken for {sensor.unit}, and those of what drives it: {given}."
    elif degF:
        yield f"{where}{degF} Check its unit, which is taken for {sensor.unit}."
