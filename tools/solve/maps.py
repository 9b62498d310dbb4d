"""A rig over speed and torque, and its thermal power: what it carries continuously within a limit."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...model.errors import Problems, ScenarioError, SolveError, suggestion
from ...model.run.design import design
from ...model.units import SHOWN, from_si, show_unit, text
from ...scenarios.csv_table import in_si
from ...scenarios.given import RigLike, Settings, assignments_of, grid_text, listed, range_of, scenario_of, spell
from ...scenarios.measured.nominal import Nominal
from ...scenarios.scenario import Scenario, parse_assignments
from ...scenarios.values import in_range
from ..show.display import Columns, optional
from ..show.picture import Picture
from . import sampling
from .settings import adjust, flat_of, names_set
from .steady import RATED, baths, conditions, leading_outputs
from .sweep_plan import Request, plan_sweep
from .sweep_rows import local

#: Ranges where none is given, as shares of the operating point [1].
USUAL = (0.2, 1.2)
#: Torque up to which a rating is looked for, in those of the operating point.
MOST_LOAD = 20.0


def driving(scenario: Scenario) -> tuple[str, str]:
    """Paths of the speed and of the torque that are given.

    Raises:
        ScenarioError: one of them is not
    """
    given = [f"{end}.{quantity}" for end, quantities in scenario.given.items() for quantity in quantities]
    found = [next((path for path in given if path.endswith(keys)), "") for keys in (".w", (".tau", ".load"))]
    if not all(found):
        what = "speed" if not found[0] else "torque"
        raise ScenarioError(f"{scenario.name}: no {what} is given at a shaft end, see [drive] of the rig file.")
    return found[0], found[1]


def usual_range(scenario: Scenario, path: str) -> str:
    """A range about the value of the operating point, as it is written on the command line."""
    value = scenario.operating_point[path]
    low, high = (from_si(share * value, "rad/s" if path.endswith(".w") else "N.m") for share in USUAL)
    return f"{min(low, high):.6g}..{max(low, high):.6g} {'rpm' if path.endswith('.w') else 'N.m'}"


def _vary(scenario: Scenario, path: str, given: Any, option: str) -> str:
    """What a sweep varies: the range or the one value that an option gives, else the usual range.

    Raises:
        ScenarioError: it is neither; problems name the option
    """
    quantity = scenario.settable()[path]
    if given is None:
        return f"{path}={usual_range(scenario, path)}"
    if ".." not in given if isinstance(given, str) else not isinstance(given, Iterable):
        ends = [spell(given, quantity, option)]
    else:
        ends = [spell(end, quantity, option) for end in range_of(given, quantity, option)]
    for end in ends:
        in_range(f"{option} ", end, quantity)
    return f"{path}={'..'.join(ends) if ends[1:] else f'{ends[0]},'}"  # the comma makes it a list of one


def _grid(grid: str | Sequence[int], vary: Sequence[str]) -> str:
    """The grid as a sweep has it: what has one value needs no number."""
    counts = re.split(r"\s*[xX*]\s*", grid_text(grid).strip())
    if len(counts) != len(vary):
        return grid_text(grid)
    return "x".join(n for n, text in zip(counts, vary, strict=True) if ".." in text)


@dataclass(frozen=True, eq=False, repr=False)
class Map(Columns):
    """Outputs over speed and torque.

    Attributes:
        rig: its name
        columns: name -> values at all points (n,) in the units shown to a person, nan where there is no steady state;
            speed and torque first
        units: unit of each column
        point: speed and torque of the operating point
        limits: temperatures of oil baths up to which gear units are rated
    """

    rig: str
    columns: Mapping[str, np.ndarray]
    units: Mapping[str, str]
    point: Mapping[str, float]
    limits: Mapping[str, float]

    def __getitem__(self, name: str) -> np.ndarray:
        """A column in SI. Raises ScenarioError with suggestions for an unknown name."""
        if name not in self.columns:
            raise ScenarioError(f'{self.rig}: there is no column "{name}".{suggestion(name, self.columns)}')
        unit = self.units[name]
        return in_si(self.columns[name], unit, SHOWN.get(unit, unit), name=name)

    def __iter__(self) -> Iterator[str]:
        """Names of its columns."""
        return iter(self.columns)

    def __len__(self) -> int:
        """Number of its points."""
        return len(next(iter(self.columns.values())))

    @property
    def title(self) -> str:
        """The rig and the number of points."""
        return f"{self.rig}: map of {len(next(iter(self.columns.values())))} points"

    def titled(self) -> Mapping[str, np.ndarray]:
        """Columns of all points by their titles."""
        return {f"{name} [{self.units[name]}]": column for name, column in self.columns.items()}

    def table(self) -> tuple[Sequence[str], Sequence[Sequence[Any]]]:
        """Range of each column."""
        ends = [(n, np.nanmin(c), np.nanmax(c), self.units[n]) for n, c in self.columns.items()]
        return ("name", "low", "high", "unit"), [(n, float(low), float(high), unit) for n, low, high, unit in ends]

    def as_dict(self) -> dict[str, Any]:
        """Ranges, and how many points have no steady state."""
        columns = list(self.columns.values())
        return {
            "schema": "gearheat.map/1",
            "rig": self.rig,
            "out": None,
            "plot": None,
            "rows": len(columns[0]),
            "without_result": int(np.isnan(columns[2]).sum()),
            "ranges": {n: {"unit": unit, "low": low, "high": high} for n, low, high, unit in self.table()[1]},
        }

    def to_pandas(self) -> Any:
        """All points as a DataFrame.

        Raises:
            DataError: pandas is not installed
        """
        return optional("pandas").DataFrame(self.titled())

    def drawing(self) -> Picture:
        """A panel of contours for each output."""
        from ..show.fields import Field, fields

        known = self.columns.items()
        drawn = [Field(n, self.units[n], c, self.point.get(n), self.limits.get(n)) for n, c in known]
        return fields(f"{self.rig} over speed and load", drawn[:2], drawn[2:])


def map_outputs(
    rig: RigLike,
    *,
    speed: Any = None,
    torque: Any = None,
    grid: str | Sequence[int] = "21x21",
    output: str | Sequence[str] = (),
    set: Settings = (),
) -> Map:
    """Oil temperature, loss and efficiency over speed and torque.

    Args:
        rig: name, file or rig
        speed: range such as "300..1800 rpm" or ("300 rpm", "1800 rpm"), or one value; about the operating point if None
        torque: range such as "-600..-60 N.m", or one value; about the operating point if None
        grid: points, speeds x torques, such as "21x21" or (21, 21); one value takes no number
        output: outputs to map; oil temperature, losses and efficiencies if none is named
        set: values by name: texts with units, quantities of pint, or numbers in SI

    Raises:
        ScenarioError: all that is wrong with what is asked
        SolveError: no point has a steady state

    Example:
        >>> import gearheat as gh
        >>> gh.map("helical_two_stage", grid="5x5").save("map.csv")  # doctest: +SKIP
    """
    scenario = scenario_of(rig)
    paths = driving(scenario)
    ranges = zip(paths, (speed, torque), ("--speed", "--torque"), strict=True)
    vary = [_vary(scenario, path, given, option) for path, given, option in ranges]
    shows = list(dict.fromkeys(listed(output))) or leading_outputs(scenario)
    assignments = assignments_of(set, scenario.settable)
    plan = plan_sweep(Request(scenario, vary, None, grid=_grid(grid, vary), assignments=assignments, outputs=shows))
    rows = np.concatenate([found for _, found in sorted(local(plan.job, enumerate([plan.values]), 0))])
    rows[rows[:, len(shows)] != 0, : len(shows)] = np.nan
    if np.isnan(rows[:, : len(shows)]).all():
        raise SolveError(
            f"{plan.rig}: none of {len(rows)} points has a steady state. Run one of them with `gearheat steady` to see"
            " why, and choose other ranges."
        )
    names = [*paths, *shows]
    columns = [*plan.values.T, *rows[:, : len(shows)].T]
    found = {n: from_si(c, plan.flat.quantity(n).unit) for n, c in zip(names, columns, strict=True)}
    units = {n: plan.flat.quantity(n).unit for n in names}
    point = {n: float(from_si(scenario.operating_point[n], units[n])) for n in paths if n in scenario.operating_point}
    limits = {n: from_si(RATED, "K") for n in shows if n in {f"{bath}.T" for bath in baths(scenario)}}
    return Map(plan.rig, found, {n: show_unit(unit) for n, unit in units.items()}, point, limits)


@dataclass(frozen=True, eq=False, repr=False)
class Rating(Columns):
    """Thermal power over room temperature and speed.

    Attributes:
        rig: its name
        limit: what is kept
        columns: title -> values at all points (n,): room, speed, torque, power; nan where there is no result
        without_result: point -> why it has none
        end: shaft end whose power it is
        plate: its power at the operating point of the rig file [kW]
    """

    rig: str
    limit: str
    columns: Mapping[str, np.ndarray]
    without_result: Mapping[str, str]
    end: str
    plate: float

    @property
    def title(self) -> str:
        """The rig, the end and the limit."""
        return f"{self.rig}: thermal power at {self.end} [kW] at {self.limit}"

    @property
    def beyond(self) -> str:
        """How many points lie above what the rig file is for; empty where none does."""
        above, n = int((self.columns["power [kW]"] > self.plate).sum()), len(self.columns["power [kW]"])
        said = f"{above} of {n} points lie above the {self.plate:.4g} kW of the rig file, for which alone its teeth,"
        return f"{said} shafts and bearings are meant: thermal power is no mechanical rating" if above else ""

    def table(self) -> tuple[Sequence[str], Sequence[Sequence[Any]]]:
        """Power, rooms down and speeds across."""
        (room, *_), (T, w, _, power) = list(self.columns), self.columns.values()
        rooms, speeds = np.unique(T), np.unique(w)
        powers = power.reshape(len(rooms), len(speeds))
        head = (room, *(f"{one:.4g} rpm" for one in speeds))
        return head, [(float(one), *map(float, row)) for one, row in zip(rooms, powers, strict=True)]

    def as_dict(self) -> dict[str, Any]:
        """All points, and why some have no result."""
        rows = zip(*self.columns.values(), strict=True)
        return {
            "schema": "gearheat.rating/1",
            "rig": self.rig,
            "limit": self.limit,
            "end": self.end,
            "power_of_file_kW": self.plate,
            "out": None,
            "rows": [dict(zip(self.columns, map(float, row), strict=True)) for row in rows],
            "without_result": dict(self.without_result),
        }

    def titled(self) -> Mapping[str, np.ndarray]:
        """Columns of all points by their titles."""
        return self.columns


def rating(
    rig: RigLike,
    limit: str | Sequence[str] | Mapping[str, Any],
    *,
    room: Any = None,
    speed: Any = None,
    grid: str | Sequence[int] = "5x6",
    set: Settings = (),
) -> Rating:
    """Thermal power: the continuous power at which the oil just keeps a limit, over room temperature and speed.

    Args:
        rig: name, file or rig
        limit: what is kept, such as "oil.T=95 degC", "oil.T<95 degC" or {"oil.T": "95 degC"}
        room: range of the room temperature, such as "0..40 degC" or (273.15, 313.15), which it is if None, or one value
        speed: range of the speed, or one value; about the operating point if None
        grid: points, rooms x speeds, the operating point's own speed among them by default; one value takes no number
        set: values by name: texts with units, quantities of pint, or numbers in SI

    Raises:
        ScenarioError: all that is wrong with what is asked
        SolveError: no point has a result

    Example:
        >>> import gearheat as gh
        >>> gh.rating("helical_two_stage", "oil.T=95 degC", grid="2x2")  # doctest: +SKIP
    """
    scenario = scenario_of(rig)
    (driven, torque), place = driving(scenario), scenario.room
    if place is None:
        raise ScenarioError(f"{scenario.name}: has no room, so no heat leaves it.")
    vary = [
        _vary(scenario, place, "0..40 degC" if room is None else room, "--room"),
        _vary(scenario, driven, speed, "--speed"),
    ]
    ways, both = {place: "--room", driven: "--speed"}, names_set(set)
    Problems(f"{n} is set, and varied. Give its range by {way}." for n, way in ways.items() if n in both).check()
    setting = adjust(scenario, set, named=[place, driven])
    flat = flat_of(setting)
    limits = [re.sub("<=?", "=", text, count=1) for text in assignments_of(limit, scenario.readable)]
    if len(limits) != 1:
        raise ScenarioError(f"--limit: {len(limits)} are given. Rate for one at a time, and take the lower power.")
    written, aim = limits[0], parse_assignments(flat, limits)
    axes = sampling.axes(sampling.read(vary), {name: flat.quantity(name) for name in (place, driven)})
    values = sampling.lay_grid(axes, _grid(grid, vary))
    powers, torques = np.full(len(values), np.nan), np.full(len(values), np.nan)
    load = abs(scenario.operating_point[torque])
    side = -1.0 if scenario.operating_point[torque] < 0 else 1.0
    bounds = {torque: (0.0, MOST_LOAD * load) if side > 0 else (-MOST_LOAD * load, 0.0)}
    why: dict[str, str] = {}
    for k, (T, w) in enumerate(values):
        given = {**conditions(setting, flat), place: float(T), driven: float(w), torque: side * load}
        try:
            found = design(flat, [torque], aim, given, bounds=bounds)
        except SolveError as error:
            why[f"{text(float(T), 'K')}, {text(float(w), 'rad/s')}"] = error.problems[0].splitlines()[0]
            continue
        torques[k] = found.values[torque]
        powers[k] = abs(float(found.result[f"{torque.partition('.')[0]}.P"][0]))
    if np.isnan(powers).all():
        raise SolveError([f"{point}: {reason}" for point, reason in list(why.items())[:3]])
    columns = [*(from_si(values[:, k], unit) for k, unit in enumerate(("K", "rad/s"))), torques, powers / 1000]
    head = [f"{place} [degC]", f"{driven} [rpm]", f"{torque} [N.m]", "power [kW]"]
    end = torque.partition(".")[0]
    plate = abs(Nominal(setting).value(f"{end}.P")) / 1000
    return Rating(scenario.name, written, dict(zip(head, columns, strict=True)), why, end, plate)
