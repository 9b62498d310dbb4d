"""Runs over time: a rig through a duty, and the time series that a rig or its FMU gives."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from ...fmu.batch import Batch
from ...fmu.variables import GIVEN, ROOM, START, STEADY, start_choice
from ...model.core.flat import FlatModel, Quantity
from ...model.errors import Problems, ScenarioError, suggestion
from ...model.run.point import Point
from ...model.run.schedule import Schedule
from ...model.run.simulate import OUTPUT_STEP, Through, simulate as integrate
from ...model.run.steady import steady
from ...model.units import SHOWN, from_si, in_unit, show_unit, text
from ...scenarios.duty import duty_names, read_duty
from ...scenarios.frames import Table, path_of, rows_told
from ...scenarios.given import RigLike, Settings, assignments_of, in_seconds, scenario_of
from ...scenarios.scenario import Scenario
from ..show.columns import titled
from ..show.console import note
from ..show.display import Columns, optional
from ..show.picture import Picture
from .settings import adjust, find_unchecked, flat_of, refuse_given
from .steady import SteadyState, far_from, kilowatts, loss_names, outside_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes


#: Rows of a duty beyond which it runs through compiled code: to compile takes as long as so many restarts of IDAS.
LONG = 5_000
#: Rows of a result above which it has more time between them where nothing is asked for.
MOST = 20_000
#: Rows up to which more are calculated than shown, for means over the duty.
ENOUGH = 10_000
#: Part of a step by which round-off moves a row.
ROUND_OFF = 1e-6
#: Times between rows to choose from [s].
STEPS = (
    OUTPUT_STEP,
    *(60.0 * n for n in (2, 5, 10, 15, 30)),
    *(3600.0 * n for n in (1, 2, 3, 6, 12, 24, 48, 120, 240)),
)
#: Tolerance of the compiled code, with which it is 5e-6 K from IDAS (planetary rig, load and speed by the minute).
TOLERANCE = 1e-6

#: A duty: a CSV file, or a DataFrame whose column names have units, "time [min]" first or as its index.
Duty = Table


@dataclass(frozen=True, eq=False, repr=False)
class TimeSeries(Columns):
    """Temperatures, speeds, torques and losses over time.

    Attributes:
        name: of the rig and the duty
        time: of the rows [s]; a time given twice is a jump
        columns: path -> values in SI
        units: SI unit of each column
        about: what else the JSON object says, before and behind the summary of the series
        headlines: power, efficiency, losses and temperatures at the end, in words
    """

    name: str
    time: np.ndarray
    columns: Mapping[str, np.ndarray]
    units: Mapping[str, str]
    about: tuple[Mapping[str, Any], Mapping[str, Any]] = ({}, {})
    headlines: Sequence[str] = ()

    def __getitem__(self, name: str) -> np.ndarray:
        """A column in SI. Raises ScenarioError with suggestions for an unknown name."""
        if name not in self.columns:
            raise ScenarioError(f'{self.name}: there is no column "{name}".{suggestion(name, self.columns)}')
        return self.columns[name]

    def __iter__(self) -> Iterator[str]:
        """Paths of its columns."""
        return iter(self.columns)

    def __len__(self) -> int:
        """Number of its rows."""
        return len(self.time)

    def to(self, name: str, unit: str) -> np.ndarray:
        """A column in a unit.

        Args:
            name: path, such as "oil.T"
            unit: such as "degC"

        Raises:
            ScenarioError: the unit does not fit
        """
        return in_unit(self[name], unit, self.units[name])

    @property
    def title(self) -> str:
        """Name, rows and length."""
        return f"{self.name}: {len(self.time)} rows to {self.time[-1]:g} s"

    def table(self) -> tuple[Sequence[str], Sequence[Sequence[Any]]]:
        """First and last value of each column, states first."""
        ends = [(n, self.units[n], float(c[0]), float(c[-1])) for n, c in self.columns.items()]
        rows = [(n, from_si(first, unit), from_si(last, unit), show_unit(unit)) for n, unit, first, last in ends]
        return ("name", "first", "last", "unit"), rows

    def as_dict(self) -> dict[str, Any]:
        """How long the series is, and where it ends, in the units shown to a person."""
        return {
            **self.about[0],
            "rows": len(self.time),
            "stop_s": float(self.time[-1]),
            "final": {name: from_si(float(column[-1]), self.units[name]) for name, column in self.columns.items()},
            "units": {name: show_unit(self.units[name]) for name in self.columns},
            **self.about[1],
        }

    def to_pandas(self) -> Any:
        """A DataFrame over time [s], columns as the CSV file has them.

        Raises:
            DataError: pandas is not installed
        """
        return optional("pandas").DataFrame(self.titled()).set_index("time [s]")

    def to_xarray(self) -> Any:
        """A Dataset over time [s] in SI, units as attributes.

        Raises:
            DataError: xarray is not installed
        """
        xarray = optional("xarray")
        held = {name: ("time", column, {"units": self.units[name]}) for name, column in self.columns.items()}
        return xarray.Dataset(held, coords={"time": ("time", self.time, {"units": "s"})})

    def titled(self) -> Mapping[str, np.ndarray]:
        """Time [s] and columns in the units shown to a person, by their titles."""
        return {"time [s]": self.time, **titled(self.columns, self.units)}

    @classmethod
    def load(cls, path: str | Path) -> TimeSeries:
        """A series that `save` has written.

        Args:
            path: CSV file, units in the header

        Raises:
            DataError: it cannot be read
        """
        from ...scenarios.csv_table import in_si, read_cells, split_unit

        header, rows = read_cells(Path(path))
        numbers = np.array([[float(text) for text in cells] for _, cells in rows])
        names, units = zip(*map(split_unit, header), strict=True)
        si = [SHOWN.get(unit, unit or "1") for unit in units]
        kinds = zip(names, units, si, strict=True)
        columns = {name: in_si(numbers[:, k], unit, kind, name=name) for k, (name, unit, kind) in enumerate(kinds)}
        return cls(Path(path).stem, columns.pop(names[0]), columns, dict(zip(names, si, strict=True)))

    def drawing(self) -> Picture:
        """The temperatures as a picture that a page can zoom."""
        from ..show.fields import courses

        return courses(self.name, self.time, self.columns, self.units)

    def plot(self, *names: str, axes: Axes | None = None) -> Axes:
        """Draw columns over time, in the units shown to a person.

        Args:
            names: of the columns; all temperatures if none is given
            axes: where to draw; new ones if None
        """
        from ..show.drawing import axes_or_new

        panel = axes_or_new(axes)
        drawn = names or [name for name in self.columns if self.units[name] == "K"]
        for name in drawn:
            panel.plot(self.time / 60, from_si(self[name], self.units[name]), label=name)
        units = dict.fromkeys(show_unit(self.units[name]) for name in drawn)
        panel.set(title=self.name, xlabel="time [min]", ylabel=", ".join(units))
        panel.legend()
        return panel


@contextmanager
def duty_file(duty: Duty) -> Iterator[Path]:
    """The file of a duty, a DataFrame's too; within it problems tell rows of the DataFrame."""
    with rows_told():
        yield path_of(duty, duty=True, name="duty")


def simulate(rig: RigLike, duty: Duty, set: Settings = (), *, every: Any = None) -> TimeSeries:
    """Temperatures and losses over a duty; temperatures that are not set start at the room's.

    Args:
        rig: name, file or rig
        duty: CSV file with time and inputs, units in the header, or a DataFrame with the same column names
        set: values by name: texts with units, quantities of pint, or numbers in SI; "start": "steady" or "room" says
            how the run begins, as in an FMU
        every: time between two rows, such as "10 min"; 1 min if None, more where the duty has above 20,000 of them

    Raises:
        GearheatError: all that is wrong with the rig, the duty or what is set; the run fails; its rows take more memory
            than there is

    Example:
        >>> import gearheat as gh
        >>> run = gh.simulate("planetary", "duty.csv")  # doctest: +SKIP
        >>> run.plot("oil.T", "wall.T")  # doctest: +SKIP
    """
    with duty_file(duty) as path:
        usual = scenario_of(rig)
        how, assignments = split_start(assignments_of(set, usual.settable))
        refuse_given(assignments, named := duty_names(path), path.name)
        scenario = adjust(usual, assignments, named=named)
        flat = flat_of(scenario)
        schedule = read_duty(path, flat)
    through = compiled(flat, schedule) if len(schedule.time) > LONG else None
    begin, step = first_states(scenario, flat, schedule, how), output_step(schedule, every)
    result = integrate(flat, schedule, start=begin, through=through, every=step / finer(schedule, step))
    warm, lost = {name: result[name] for name in flat.bodies}, loss_names(scenario, result.columns).values()
    whole = sum((result[name] for own in lost for name in own), np.zeros(len(result.index)))
    before = {"schema": "gearheat.simulate/1", "rig": scenario.name, "out": None, "plot": None}
    shown = rows_shown(result.index, schedule, step)
    columns = {key: column[shown] for key, column in result.columns.items()}
    into = columns.get(f"{scenario.drives}.P", np.zeros(0))
    behind = {
        "backward": int((into < 0).sum()),
        "far": far_in(path.name, schedule, usual.operating_point),
        "energy_residual": result.audit.residual,
        "outside": outside_of(result),
        "laws": list(result.laws),
        "unchecked": find_unchecked(scenario, flat),
    }
    name = f"{scenario.name}, {path.stem}"
    last = replace(result, columns={key: column[-1:] for key, column in result.columns.items()})
    end = SteadyState(scenario, flat, last, backward=False)
    given = {*schedule.values, *(text.partition("=")[0].strip() for text in assignments)}
    said = [
        *held_over((q for q in flat.inputs if q.name not in given), "at the operating point"),
        *over_the_duty(result.index, warm, whole),
        *(["at the end: " + ", ".join(end.flows)] if end.flows else []),
        *end.headlines,
    ]
    return TimeSeries(name, result.index[shown], columns, result.units, (before, behind), said)


def finer(schedule: Schedule, step: float, least: float = 0.0) -> int:
    """Rows to calculate for each that is shown, so that means over a duty follow its own rows, within `ENOUGH`.

    Args:
        schedule: the duty
        step: time between two rows that are shown [s]
        least: the shortest time between two rows [s]
    """
    gaps = np.diff(schedule.time)
    least = max(float(np.median(gaps[gaps > 0])), (schedule.stop - schedule.start) / ENOUGH, least)
    return max(int(step / least), 1)


def rows_shown(time: np.ndarray, schedule: Schedule, step: float) -> np.ndarray:
    """Which rows (n,) are a step apart, at a jump or the last one."""
    place = (time - schedule.start) / step
    at_jump = np.isin(time, schedule.time[schedule.jumps])
    return np.asarray((np.abs(place - place.round()) < ROUND_OFF) | at_jump | (time == time[-1]))


def far_in(name: str, schedule: Schedule, usual: Mapping[str, float], where: str = "the rig file") -> list[str]:
    """Speeds and torques of a duty that are far above the usual ones, in words: of each the largest.

    Args:
        name: of the duty
        schedule: its values
        usual: what they are compared with (SI)
        where: that is from
    """
    rows = {path: int(np.abs(values).argmax()) for path, values in schedule.values.items()}
    units = {path: "rad/s" if path.endswith(".w") else "N.m" for path in rows if path.endswith((".w", ".tau", ".load"))}
    found = far_from(usual, {path: float(schedule.values[path][rows[path]]) for path in units}, units, where)
    return [f"{name}, row {rows[path] + 1}: {words}" for path, words in found.items()]


def held_over(inputs: Iterable[Quantity], where: str) -> list[str]:
    """Speeds and torques that a duty does not give, in words.

    Args:
        inputs: that neither the duty nor the user gives, with their values
        where: these are from, "in the FMU"
    """
    held = [f"{q.name} = {text(q.start, q.unit)}" for q in inputs if q.unit in ("rad/s", "N.m")]
    return [f"not in the duty, so constant as {where}: {', '.join(held)}"] if held else []


def over_the_duty(time: np.ndarray, warm: Mapping[str, np.ndarray], loss: np.ndarray | None) -> list[str]:
    """Mean loss, and the hottest body, in words: the end of a duty may be one at rest.

    Args:
        time: of the rows [s]
        warm: name -> temperature [K]
        loss: power [W]
    """
    said = [] if loss is None else [f"mean loss {kilowatts(float(np.trapezoid(loss, time) / np.ptp(time)))}"]
    if warm:
        hottest = max(warm, key=lambda name: warm[name].max())
        T, body = warm[hottest], hottest.removesuffix(".T")
        when = f"after {(time[T.argmax()] - time[0]) / 60:.4g} min"
        said.append(f"hottest {body} {text(float(T.max()), 'K', 3)} {when}, at the end {text(float(T[-1]), 'K', 3)}")
    return [f"over the duty: {', '.join(said)}"] if said else []


def output_step(schedule: Schedule, every: Any, least: float = OUTPUT_STEP) -> float:
    """Time between two rows [s]: as asked, else the shortest usual one that does not give too many rows, told.

    Args:
        schedule: the duty
        every: text with a unit, number in SI, or None
        least: the shortest one [s]
    """
    if every is not None:
        if (asked := in_seconds(every, "--every")) <= 0:
            raise ScenarioError(f"--every {asked:g} s: a time between rows is above 0.")
        return asked
    length = schedule.stop - schedule.start
    step = next((step for step in (least, *STEPS) if step >= least and length / step <= MOST), length / MOST)
    if step > least:
        note(f"a row every {step / 60:g} min, as the duty lasts {length / 3600:.4g} h; --every says otherwise")
    return step


def compiled(flat: FlatModel, schedule: Schedule) -> Through:
    """A run through a duty by the solver of the FMU, with all expressions of the model as outputs."""
    parts = {name: ca.densify(ca.SX(getattr(flat, name))) for name in flat.function.name_out()}
    column = ca.vertcat(*parts.values())
    outputs = tuple(Quantity(f"row {k}", "1", "") for k in range(column.numel()))
    whole = replace(flat, y=column, outputs=outputs, derived={})

    def through(begin: Point, times: np.ndarray) -> tuple[np.ndarray, dict[str, np.ndarray], np.ndarray] | None:
        rows = Batch(whole).warmup(schedule, begin.u, begin.p, begin.x, times=times, tolerance=TOLERANCE)
        if rows.status[0]:
            return None
        ends = np.cumsum([part.numel() for part in parts.values()])[:-1]
        evaluated = dict(zip(parts, np.split(rows.y[0].T, ends), strict=True))
        return rows.x[0].T, evaluated, np.array([rows.supplied[0], rows.throughput[0]])

    return through


def split_start(assignments: Sequence[str]) -> tuple[str, list[str]]:
    """How a run begins, and the other assignments.

    Raises:
        ScenarioError: there is no such beginning
    """
    told = [text.partition("=")[2].strip() for text in assignments if text.partition("=")[0].strip() == START]
    items = [item.name for item in start_choice("room").items]
    Problems(
        f'{START} = "{how}" is not known. Choose one of: {", ".join(items)}.' for how in {*told} - {*items}
    ).check()
    return (told or [GIVEN])[-1], [text for text in assignments if text.partition("=")[0].strip() != START]


def first_states(scenario: Scenario, flat: FlatModel, schedule: Schedule, how: str) -> dict[str, float]:
    """States that a run begins with: as set, all at the room's temperature, or at rest with the first inputs."""
    first = first_temperatures(scenario, flat, schedule)
    if how == ROOM and first:
        return dict.fromkeys(flat.bodies, next(iter(first.values())))
    if how != STEADY:
        return first
    found = steady(flat, {name: float(values[0]) for name, values in schedule.values.items()}, guess=first)
    return {q.name: float(found[q.name][0]) for q in flat.states}


def first_temperatures(scenario: Scenario, flat: FlatModel, schedule: Schedule | None) -> dict[str, float]:
    """Start temperatures: as set, else that of the room at the beginning of the schedule, or at the operating point."""
    room = scenario.room
    if room is None:
        return {}
    given = schedule is not None and room in schedule.values
    T = float(schedule.values[room][0]) if schedule is not None and given else flat.quantity(room).start
    own = {f"{part.name}.{key}" for part in scenario.spec.parts for key in part.values}
    return {name: T for name in flat.bodies if name not in own}
