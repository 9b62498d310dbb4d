"""Measured tables and cards that cannot be: refused with the row, or warned of; and causes that no table can show."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from ...model.units import text
from ..csv_cells import fold
from ..csv_table import raise_all
from .against_model import AT_REST, LEAST_TESTS, Oils, against_model, format_value, place
from .nominal import Nominal, efficiency, shaft_powers
from .placeholders import placeholders
from .sensors import ACCURACY, SI
from .table import Campaign, Sensor

#: Fewer rows than these say nothing about any cause.
LEAST_ROWS = 6
#: Readings of temperature below this are taken for another unit [K].
COLDEST = 213.15
#: Readings of temperature above this are taken for another unit [K].
HOTTEST = 473.15
#: A given speed or torque this many times the largest, or less than this part of the rig's, has another unit.
FAR = 50.0
#: Times a typical speed or torque of a reference from which that of the data is another unit's.
UNLIKE = 8.0
#: Efficiencies below this in most rows cannot be [1].
POOREST = 0.2
#: Efficiencies above this in most rows cannot be [1]: an instrument that errs raises them in one direction alone.
BEST = 1.0
#: The same in most rows of one direction: the zero of a transducer does more at part load, other units more yet.
BEST_OF_ONE = 1.25
#: Accuracies further than this factor from the usual ones are a slip.
ODD = 300.0
#: A torque that is estimated and not measured is known within this share at worst.
ESTIMATED = 0.35
#: Conditions to predict further out than this, relative to what was measured, are extrapolations.
OUTLYING = 0.25
#: Range of a given quantity, relative to its largest, below which there is but one of it.
ONE_VALUE = 0.1
#: Causes of a sensor that act over the running order.
ORDERED = ("drift", "step", "since", "random_walk")


def check(campaign: Campaign, nominal: Nominal, oils: Oils, *, points: bool = False) -> Campaign:
    """The campaign with warnings of what is odd about it.

    Args:
        campaign: as read
        nominal: its rig
        oils: name of each of its oils -> values by path
        points: whether it holds conditions without readings

    Raises:
        DataError: all that cannot be
    """
    problems = [
        *_accuracies(campaign, nominal),
        *_temperatures(campaign),
        *placeholders(campaign.name, campaign.sensors, campaign.values, campaign.lines),
        *_empty(campaign),
        *_contradictions(campaign),
        *_scales(campaign, nominal),
    ]
    if not points and not problems:
        problems += [*_find_repeated_columns(campaign), *against_model(campaign, nominal, oils)]
    if not points and not problems:
        problems += _balance(campaign, nominal)
    raise_all(problems, campaign.name)
    odd = (*_twice(campaign, same_test=False), *_below_zero(campaign), *(() if points else _gains(campaign, nominal)))
    return replace(campaign, warnings=(*campaign.warnings, *odd))


def too_small(campaign: Campaign) -> list[str]:
    """The problem of a table that is too small to say anything."""
    copies = len(_copies(campaign))
    if campaign.n - copies >= LEAST_ROWS and campaign.n_tests >= LEAST_TESTS:
        return []
    counted = f"{campaign.n} readings of {campaign.n_tests} tests" + f", {copies} of them copies," * bool(copies)
    return [
        f"{campaign.name}: {counted} are too few to say anything."
        f" Give at least {LEAST_ROWS} readings of {LEAST_TESTS} tests."
    ]


def same_as_reference(campaign: Campaign, reference: Campaign) -> list[str]:
    """The problem of a campaign that is its own reference.

    Args:
        campaign: readings of the machine
        reference: readings of it when healthy
    """
    shared = [s.name for s in campaign.sensors if s.name in reference.values]
    if campaign.n != reference.n or not shared:
        return []
    if all(np.array_equal(campaign.values[s], reference.values[s], equal_nan=True) for s in shared):
        return [f"{campaign.name}: its readings are those of the reference {reference.name}. Give another campaign."]
    return []


def beside_reference(campaign: Campaign, reference: Campaign) -> list[str]:
    """Warnings of what a campaign and its reference do not have alike.

    Args:
        campaign: readings of the machine
        reference: readings of it when healthy
    """
    return [*not_in_reference(campaign, reference), *unlike_reference(campaign, reference)]


def not_in_reference(campaign: Campaign, reference: Campaign) -> list[str]:
    """Warnings of what a campaign compares and its reference lacks.

    Args:
        campaign: readings of the machine
        reference: readings of it when healthy
    """
    return [
        f"{reference.name} lacks {sensor.column}, which {campaign.name} has: what it always is off by is not"
        " calibrated, and may be taken for a fault. Give a reference with it."
        for sensor in campaign.read
        if sensor.name not in reference.values
    ]


def unlike_reference(campaign: Campaign, reference: Campaign) -> list[str]:
    """Warnings of speeds and torques of quite another size than those of the reference.

    Args:
        campaign: readings of the machine
        reference: readings of it when healthy
    """
    found = []
    for s in (s for s in campaign.given if s.kind in ("speed", "torque") and s.name in reference.values):
        own, other = (float(np.nanmedian(np.abs(c.values[s.name]))) for c in (campaign, reference))
        if not 1 / UNLIKE <= own / (other or 1e-9) <= UNLIKE:
            found.append(
                f"{s.column} is about {format_value(s, own)} in {campaign.name}, {format_value(s, other)} in"
                f" {reference.name}. Check that the units of both are what they say."
            )
    return found


def outlying(campaign: Campaign, points: Campaign) -> list[str]:
    """Warnings of points to predict that are far outside of what was measured.

    Args:
        campaign: what was measured
        points: conditions whose readings are predicted
    """
    found = []
    for sensor in (s for s in campaign.given if s.kind in ("torque", "speed") and s.name in points.values):
        known, asked = np.abs(campaign.values[sensor.name]), np.abs(points.values[sensor.name])
        far = int(((asked > (1 + OUTLYING) * known.max()) | (asked < (1 - OUTLYING) * known.min())).sum())
        if far:
            low, high = (format_value(sensor, value) for value in (known.min(), known.max()))
            found.append(
                f"{points.name}: {sensor.column} of {far} points is far outside of {low} to {high}."
                " Their prediction is an extrapolation."
            )
    return found


def _accuracies(campaign: Campaign, nominal: Nominal) -> Iterator[str]:
    """Accuracies that no instrument has."""
    for sensor in campaign.sensors:
        usual = dict(zip(("repeat_sd", "offset_sd"), ACCURACY[sensor.kind], strict=True))
        unit, most = "K (difference)" if SI[sensor.kind] == "K" else SI[sensor.kind], 0.0
        if SI[sensor.kind] != "K":
            size = abs(nominal.value(sensor.reads)) or _size(campaign, sensor)
            usual = {key: part * size for key, part in usual.items()}
            most = ESTIMATED * size if sensor.kind == "torque" else 0.0
        for key, value in usual.items():
            stated = getattr(sensor, key)
            known = value / ODD <= stated <= max(value * ODD, most)
            if (stated == 0.0 and key == "offset_sd") or value == 0.0 or known:
                continue
            yield (
                f"{sensor.name}: {key} = {text(stated, unit, 3)} is no accuracy of such an instrument;"
                f" {text(value, unit, 2)} is usual. Check its unit in the card."
            )


def _size(campaign: Campaign, sensor: Sensor) -> float:
    values = np.abs(campaign.values[sensor.name])
    return float(np.nanmax(values)) if np.isfinite(values).any() else 0.0


def _temperatures(campaign: Campaign) -> Iterator[str]:
    """Temperatures in another unit than their column's name says."""
    for sensor in (s for s in campaign.sensors if SI[s.kind] == "K"):
        values = campaign.values[sensor.name]
        for row in np.flatnonzero((values > HOTTEST) | (values < COLDEST)):
            limit = f"above {HOTTEST - 273.15:g} degC" if values[row] > HOTTEST else f"below {COLDEST - 273.15:g} degC"
            yield (
                f"{place(campaign, row)}: {sensor.column} is {values[row] - 273.15:.4g} degC, {limit}."
                f" Check its unit, which is taken for {sensor.unit or 'K'}."
            )


def _empty(campaign: Campaign) -> Iterator[str]:
    """Columns of what is compared that hold no number."""
    for sensor in campaign.read:
        if campaign.n and not np.isfinite(campaign.values[sensor.name]).any():
            yield f"{campaign.name}: column {sensor.column} holds no number. Give what was read, or take it out."


def _contradictions(campaign: Campaign) -> Iterator[str]:
    """Readings that are there twice."""
    first: dict[int, int] = {}
    for row, point in enumerate(campaign.points):
        if (before := first.setdefault(int(point), row)) != row:
            yield (
                f"{place(campaign, row)}: point {point} is the number of line {campaign.lines[before]} too."
                " Give each reading its own."
            )
    yield from _twice(campaign, same_test=True)


def _twice(campaign: Campaign, *, same_test: bool) -> list[str]:
    """Rows whose numbers are all those of another one, of the same test or of an earlier one."""
    said, lines = "all readings are those of line {}. Keep one of them.", campaign.lines
    found = [
        (int(lines[row]), said.format(lines[before]))
        for row, before in _copies(campaign).items()
        if (campaign.test[before] == campaign.test[row]) == same_test
    ]
    return fold(campaign.name, found)


def _copies(campaign: Campaign) -> dict[int, int]:
    """Row of readings that are all those of an earlier row -> that row."""
    numbers = np.array([campaign.values[s.name] for s in campaign.sensors]).T
    read = np.any([np.isfinite(campaign.values[s.name]) for s in campaign.read], axis=0) if campaign.read else ()
    seen: dict[bytes, int] = {}
    rows = np.flatnonzero(read).tolist()
    first = {row: seen.setdefault(np.nan_to_num(numbers[row]).tobytes(), row) for row in rows}
    return {row: before for row, before in first.items() if before != row}


def _below_zero(campaign: Campaign) -> Iterator[str]:
    """Magnitudes that are a little below zero."""
    for sensor in (s for s in campaign.sensors if s.signs != (1.0, 1.0)):
        values = campaign.values[sensor.name]
        if len(rows := np.flatnonzero(values < 0)):
            yield (
                f"{place(campaign, rows[0])}: {sensor.column} holds magnitudes and is below zero, in {len(rows)} of"
                f" {campaign.n} rows, by {format_value(sensor, -np.nanmin(values))} at most. It is taken as it is, for"
                " an error of its zero."
            )


def _scales(campaign: Campaign, nominal: Nominal) -> Iterator[str]:
    """Given speeds and torques of another order than the rig's operating point."""
    driven = [s for s in campaign.given if s.kind in ("torque", "speed", "power") and abs(nominal.value(s.reads)) > 0]
    share = {s: _size(campaign, s) / abs(nominal.value(s.reads)) for s in driven}
    speed = next((s for s in driven if s.kind == "speed"), None)
    if speed and share[speed] < AT_REST and all(one < 1 / FAR for one in share.values()):
        yield (
            f"{campaign.name}: the machine stands still, {speed.column} is at most"
            f" {format_value(speed, _size(campaign, speed))}, the rig runs at"
            f" {format_value(speed, abs(nominal.value(speed.reads)))}. Give what is read of a machine that runs, or"
            f" check its unit, which is taken for {speed.unit}."
        )
        return
    for sensor in driven:
        if 1 / FAR <= share[sensor] <= FAR:
            continue
        row = int(np.nanargmax(np.abs(campaign.values[sensor.name])))
        yield (
            f"{place(campaign, row)}: {sensor.column} is at most {format_value(sensor, _size(campaign, sensor))}, the"
            f" rig runs at {format_value(sensor, abs(nominal.value(sensor.reads)))}. Check its unit, which is taken for"
            f" {sensor.unit}."
        )


def _find_repeated_columns(campaign: Campaign) -> Iterator[str]:
    """Columns that hold the same numbers."""
    for k, sensor in enumerate(campaign.sensors):
        for other in campaign.sensors[:k]:
            if campaign.n > LEAST_TESTS and np.array_equal(campaign.values[sensor.name], campaign.values[other.name]):
                yield (
                    f"{campaign.name}: {sensor.column} holds the numbers of {other.column}."
                    " Give what each sensor read, or leave out one of the columns."
                )


def _efficiencies(campaign: Campaign, nominal: Nominal) -> tuple[np.ndarray, str]:
    """That of each row (n,), NaN where a shaft's power is not known, and the columns of the torques."""
    powers = shaft_powers(campaign, nominal)
    eta = efficiency(powers) if powers is not None and len(powers) > 1 else np.full(campaign.n, np.nan)
    return eta, ", ".join(s.column for s in campaign.sensors if s.kind == "torque")


def _gains(campaign: Campaign, nominal: Nominal) -> Iterator[str]:
    """Efficiencies above 1 in most rows, as far as an instrument that errs explains them."""
    eta, torques = _efficiencies(campaign, nominal)
    odd = eta > BEST
    if odd.sum() * 2 > np.isfinite(eta).sum():
        yield (
            f"{place(campaign, odd.argmax())}: the torques give an efficiency of {eta[odd][0]:.4g}, and of more than"
            f" {BEST:g} in {odd.sum()} of {campaign.n} rows. No gearbox has it: one of {torques} is taken to err."
        )


def _balance(campaign: Campaign, nominal: Nominal) -> Iterator[str]:
    """Efficiencies that cannot be, in most rows."""
    eta, torques = _efficiencies(campaign, nominal)
    directions = np.unique(campaign.direction)
    limits = [(BEST_OF_ONE, campaign.direction == way) for way in directions]
    if len(directions) > 1:
        limits.insert(0, (BEST, np.ones(campaign.n, dtype=bool)))
    for best, rows in limits:
        odd = rows & ((eta > best) | (eta < POOREST))
        if odd.sum() * 2 > (rows & np.isfinite(eta)).sum():
            break
    else:
        return
    row = int(np.flatnonzero(odd)[0])
    yield (
        f"{place(campaign, row)}: the torques give an efficiency of {eta[row]:.3g}, and of more than {best:g} or less"
        f" than {POOREST:g} in {odd.sum()} of {rows.sum()} rows. Check units and signs of {torques}."
    )


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
