"""Logs of ordinary gearboxes that the rig makes itself: how the filter is driven, where it begins, what it is told."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import gearheat as gh
import numpy as np
import pytest
from gearheat.model.errors import DataError
from gearheat.model.machines.roles import Roles
from gearheat.model.run.schedule import Schedule
from gearheat.model.run.simulate import simulate
from gearheat.scenarios.load import load
from gearheat.scenarios.measured.card import Card
from gearheat.scenarios.measured.logs import Log, read_log
from gearheat.scenarios.measured.nominal import drive_by
from gearheat.scenarios.measured.sensors import sensors_of
from gearheat.scenarios.measured.times import NUMBERS
from gearheat.scenarios.scenario import Scenario
from gearheat.tools.diagnose.infer.logs import filter_of, fleet, question
from gearheat.tools.diagnose.infer.walk import curves, independent
from gearheat.tools.diagnose.infer.weigh import weigh
from gearheat.tools.diagnose.library.knobs import knobs
from gearheat.tools.diagnose.logs import read_logs
from gearheat.tools.diagnose.model.logs import Passed, log_likelihood
from gearheat.tools.diagnose.model.windows import Duty, windows
from gearheat.tools.diagnose.request import Inputs, Request
from gearheat.tools.watch.judge import Judge

#: Nothing differs.
NONE: Mapping[str, float] = {}
#: Seeds of a healthy log, and of one of a bearing that binds, of a housing that is heated from outside.
BOUND: Mapping[int, Mapping[str, float]] = {1: NONE, 2: {"carrier_bearing.k_loss": 6.0}}
HOT: Mapping[int, Mapping[str, float]] = {1: NONE, 2: {"wall.Q_flow_external": 400.0}}
#: Samples, and time between them [s].
N, STEP = 720, 600.0


def record(
    path: Path, scenario: Scenario, seed: int, *only: str, thinner: float = 1.0, changed: Mapping[str, float] = NONE
) -> Path:
    """A log of a rig with some readings, all if none is named; the oil may be thinner than that of the rig.

    Args:
        path: of the file
        scenario: the rig
        seed: of inputs and noise
        only: readings, all if none is named
        thinner: by what factor the oil is thinner than that of the rig
        changed: values of the machine that the rig has otherwise, and heat that enters from outside
    """
    sensors = [s for s in sensors_of(scenario, Card()) if s.role == "given" or not only or s.name in only]
    driven, rng = drive_by(scenario, sensors), np.random.default_rng(seed)
    if thinner != 1.0:
        oil = driven.spec.part("oil").values
        driven = driven.with_values({f"oil.{key}": float(oil[key]) / thinner for key in ("nu_40", "nu_100")})
    inputs = {name: value for name, value in changed.items() if name.endswith("Q_flow_external")}
    flat = driven.with_values({name: value for name, value in changed.items() if name not in inputs}).spec.flat()
    point = {path: value for path, value in driven.operating_point.items() if path in flat.index}
    corners = 12 * STEP * np.arange(N // 12 + 1)
    changes = {s.reads: rng.uniform(0.0, 1.0, len(corners)) for s in sensors if s.role == "given"}
    given = {
        name: point[name] - 5.0 + 10.0 * share if name.endswith(".T") else point[name] * (0.6 + 0.4 * share)
        for name, share in changes.items()
    }
    times = STEP * np.arange(N)
    rest = {name: value for name, value in point.items() if name not in given} | inputs
    found = simulate(flat, Schedule(corners, given), values=rest, times=times)
    columns = {"time_s": times}
    for s in sensors:
        true = found[s.reads] if s.reads in found.columns else np.interp(times, corners, given[s.reads])
        shown = s.signs[0] * true + s.repeat_sd * rng.standard_normal(N)
        columns[s.column] = {"degC": shown - 273.15, "rpm": shown * 30 / np.pi}.get(s.unit, shown)
    np.savetxt(path, np.array([*columns.values()]).T, "%.8g", ",", header=",".join(columns), comments="")
    return path


def read(path: Path, scenario: Scenario) -> Log:
    return read_log(path, scenario, Card())


def test_bodies_begin_at_what_thermometers_show(tmp_path: Path) -> None:
    """Two thermometers of one oil, and a torque that is none."""
    scenario = load("planetary")
    log = read(record(tmp_path / "log.csv", scenario, 1, "T_oil", "T_oil2", "T_sun"), scenario)
    own = filter_of(scenario, log)
    data = windows([log], own.given, own.read)
    begun, *_ = own.start(data, np.zeros((len(data.read), len(own.read))))
    thermometers = data.read[:, 0, [own.read.index(name) for name in ("T_oil", "T_oil2")]]
    assert begun == pytest.approx(
        np.repeat(thermometers.mean(axis=1)[:, None], len(own.plant.flat.states), axis=1), abs=1.5
    )
    error = own.run(data, np.zeros((len(data.read), len(own.knobs))), slopes=False).error
    assert np.nanmax(np.abs(error[:, :, 0])) < 3.0


def test_a_rig_with_a_load_is_driven_by_the_torque_of_the_log(tmp_path: Path) -> None:
    mine = tmp_path / "mine.toml"
    gh.new("mine", stages="helical", ratio=3, power="5 kW", speed="1450 rpm", out=mine)
    scenario = load(mine)
    assert scenario.given["output"] == ("load",)
    now, past = (record(tmp_path / f"{seed}.csv", scenario, seed) for seed in (1, 2))
    assert "output.tau" in filter_of(scenario, read(now, scenario)).plant.u_place
    assert gh.diagnose(None, mine, logs=now, reference_logs=past, quick=True).verdict == "consistent"


def test_a_single_reading_that_many_bodies_move(tmp_path: Path) -> None:
    now, past = (record(tmp_path / f"{seed}.csv", load("actuator"), seed, "I_motor") for seed in (1, 2))
    assert gh.diagnose(None, "actuator", logs=now, reference_logs=past, quick=True).verdict == "consistent"


def test_a_log_of_few_samples_leaves_nothing_free(tmp_path: Path) -> None:
    path = record(tmp_path / "now.csv", load("helical_two_stage"), 1)
    path.write_text("".join(path.read_text().splitlines(keepends=True)[:9]))
    found = gh.diagnose(None, "helical_two_stage", logs=path, quick=True)
    assert found.verdict == "consistent" and found.test.p_adequacy is None


@pytest.mark.filterwarnings("error")
def test_a_log_that_reads_nothing_behind_its_first_samples_is_refused(tmp_path: Path) -> None:
    now = record(tmp_path / "now.csv", load("helical_two_stage"), 1)
    blanked(now, "T_oil_C", "T_wall_C", rows=slice(12, N))
    with pytest.raises(DataError, match=r"now\.csv: nothing is read behind the first samples"):
        gh.diagnose(None, "helical_two_stage", logs=now, quick=True)


@pytest.mark.filterwarnings("error")
def test_a_thermometer_of_a_few_samples_has_no_usual_value(tmp_path: Path) -> None:
    log = read(blanked(record(tmp_path / "log.csv", s := load("planetary"), 1), "T_oil_C", rows=slice(12, N)), s)
    data = windows([log], [x.name for x in log.given], [x.name for x in log.read])
    assert np.isfinite(Duty.of(data, log.given, log.read).at(data)).all()


def test_a_machine_whose_name_has_a_point_has_its_past(tmp_path: Path) -> None:
    """The past of A.2 was nobody's, and that of A.1 was also that of a machine A."""
    log = read(record(tmp_path / "log.csv", scenario := load("planetary"), 1, "T_oil"), scenario)
    past = [replace(log, name=name) for name in ("A.1.csv", "A.2.csv.gz")]
    judge = Judge(Inputs(Request("planetary"), scenario, Card(), None, None, None), (), past)
    judge._known[tuple(s.name for s in log.sensors)] = SimpleNamespace(of=lambda number: number), ()
    assert [judge.known(replace(log, name=name))[0] for name in ("A", "A.1", "A.2")] == [0, 1, 2]


def test_a_watch_goes_on_without_a_thermometer(tmp_path: Path) -> None:
    now = blanked(record(tmp_path / "now.csv", load("planetary"), 1, "T_oil", "T_wall"), "T_oil_C", rows=slice(230, N))
    told = [set(event["readings"]) for event in gh.watch("planetary", now, once=True) if event["event"] == "window"]
    assert told == [{"T_oil", "T_wall"}, {"T_wall"}]


def test_a_torque_is_no_temperature_of_the_duty(own_unit: Path, tmp_path: Path) -> None:
    log = read(record(tmp_path / "log.csv", scenario := load(own_unit), 1, "T_input"), scenario)
    data = windows([log], [s.name for s in log.given], ["T_input"])
    duty = Duty.of(data, log.given, log.read)
    assert len(duty.usual) == 2 and duty.at(data).shape == (len(data.time), 3)


def test_a_torque_is_told_with_the_sign_of_its_column(tmp_path: Path) -> None:
    """That of the sun is a magnitude, and below zero to the model; more friction leaves less of it."""
    scenario = load("planetary")
    past, now = (record(tmp_path / f"{k}.csv", scenario, k, "T_oil", "T_sun", changed=ch) for k, ch in BOUND.items())
    found = gh.diagnose(None, "planetary", logs=now, reference_logs=past, quick=True)
    shown = found.rows.channels["T_sun"]
    assert min(v for v in (*shown.measured, *shown.nominal, *shown.extended) if v is not None) > 400
    assert found.impact["T_oil_K"].value > 0 > found.impact["T_sun_Nm"].value
    now.write_text("\n".join(now.read_text().splitlines()[:61]) + "\n")
    told = next(e for e in gh.watch("planetary", now, once=True, every=60) if e["event"] == "window")
    sun = told["readings"]["T_sun"]
    assert 400 < sun["low"] < sun["predicted"] < sun["high"] and sun["measured"] > 400


def test_what_a_cause_changes_is_told_whatever_the_holes_of_the_log(tmp_path: Path) -> None:
    """Runs with the cause and without begin as warm as was read, and part in more than the two hours of a stretch."""
    scenario = load("helical_two_stage")
    ways = {"past": (2, NONE), "sound": (1, NONE), "now": (1, {"wall.Q_flow_external": 80.0})}
    past, sound, now = (record(tmp_path / f"{k}.csv", scenario, n, changed=ch) for k, (n, ch) in ways.items())
    true = np.mean(read(now, scenario).values["T_oil"] - read(sound, scenario).values["T_oil"])
    for path in (past, now):
        head, *rows = path.read_text().splitlines()
        cut = [f"{row},{k // 12}\n" for k, row in enumerate(rows)]
        path.write_text("".join([f"{head},segment\n", *cut]))
    found = gh.diagnose(None, "helical_two_stage", logs=now, reference_logs=past, quick=True)
    assert found.impact["T_oil_K"].value == pytest.approx(true, rel=0.15)


def test_what_is_shown_without_healthy_logs_is_of_the_filter_that_suits_them(tmp_path: Path, monkeypatch) -> None:
    def suited(own, *_) -> None:
        own.moments, own.parts = True, 2

    monkeypatch.setattr("gearheat.tools.diagnose.infer.logs.suit", suited)
    log = read(record(tmp_path / "log.csv", scenario := load("planetary"), 1, "T_oil"), scenario)
    known = fleet(scenario, (), (), log)
    question(known, [log])
    assert known.filter.moments and known.filter.parts == 2


def test_healthy_logs_without_dates_are_drawn_before_those_in_question(tmp_path: Path) -> None:
    now, past = (record(tmp_path / f"{k}.csv", load("helical_two_stage"), k, "T_oil") for k in (1, 2))
    days = np.array(
        gh.diagnose(None, "helical_two_stage", logs=now, reference_logs=past).rows.quantities["time"].values
    )
    assert (days < 0).sum() == (days >= 0).sum() == len(days) / 2
    assert days[days >= 0].min() == 0 and days[days < 0].max() == pytest.approx(-14.0, abs=0.5)


@pytest.mark.filterwarnings("error")
def test_thermometers_that_end(tmp_path: Path) -> None:
    """The last window has none."""
    path, ends = record(tmp_path / "now.csv", load("helical_two_stage"), 1), {"T_wall_C": 300, "T_oil_C": 470}
    head, *rows = [line.split(",") for line in path.read_text().splitlines()]
    for k, row in enumerate(rows):
        for name, end in ends.items():
            row[head.index(name)] = "" if k >= end else row[head.index(name)]
    path.write_text("".join(",".join(row) + "\n" for row in [head, *rows]))
    found = gh.diagnose(None, "helical_two_stage", logs=path, quick=True)
    assert found.verdict == "consistent"
    assert None in found.rows.channels["T_wall"].measured
    told = [event["event"] for event in gh.watch("helical_two_stage", path, once=True)]
    assert told.count("window") == 2 and "alarm" not in told


def blanked(path: Path, *gone: str, rows: slice) -> Path:
    """The log without some cells."""
    head, *table = [line.split(",") for line in path.read_text().splitlines()]
    for row in table[rows]:
        for name in gone:
            row[head.index(name)] = ""
    path.write_text("".join(",".join(row) + "\n" for row in [head, *table]))
    return path


@pytest.mark.parametrize("column", ["T_amb_C", "T_output_Nm"])
def test_rows_of_which_it_is_not_known_what_drives_the_rig_are_left_out(column: str, tmp_path: Path) -> None:
    """The room was at 0 K in windows without its temperature, and elsewhere at a straight line through the gap."""
    scenario = load("helical_two_stage")
    whole = read(record(tmp_path / "log.csv", scenario, 1), scenario)
    log = read(blanked(tmp_path / "log.csv", column, rows=slice(200, 650)), scenario)
    assert log.n == whole.n - 450 and log.stretch.tolist() == [0] * 200 + [1] * 70
    assert log.warnings[-1] == (
        f"log.csv: {column}, which drives the rig, is missing in 450 rows, first in lines 202 to 651."
        " These rows are left out."
    )
    judge = Judge(Inputs(Request("helical_two_stage"), scenario, Card(), None, None, None))
    head, *rows = [line.split(",") for line in (tmp_path / "log.csv").read_text().splitlines()[:221]]
    cells = [{name: float(cell) for name, cell in zip(head[1:], row[1:], strict=True) if cell} for row in rows]
    with pytest.raises(DataError, match=f"{column}, which drives the rig, is missing in 20 rows"):
        judge.answer("a", NUMBERS, [STEP * k for k in range(220)], cells)


def test_a_slow_input_is_held_between_its_samples(tmp_path: Path) -> None:
    """Also in windows without any: a stretch of a few rows has none, and the room was at 0 K there."""
    scenario = load("helical_two_stage")
    blanked(record(tmp_path / "log.csv", scenario, 1), "T_amb_C", rows=slice(1, 11))
    for k in range(1, 60):
        blanked(tmp_path / "log.csv", "T_amb_C", rows=slice(12 * k + 1, 12 * k + 11))
    log = read(tmp_path / "log.csv", scenario)
    assert log.n == N and not [text for text in log.warnings if "left out" in text]
    own = filter_of(scenario, log)
    data = windows([replace(log, stretch=np.arange(N) // 5)], own.given, own.read)
    room = data.given[:, :, own.given.index("T_amb")]
    assert room[data.there].min() > 273


def test_a_channel_of_every_second_sample_counts_where_others_were_read_at_moments(tmp_path: Path) -> None:
    """No two of its neighbours have a mean, so that it told nothing."""
    scenario = load("helical_two_stage")
    log = read(blanked(record(tmp_path / "log.csv", scenario, 1), "T_oil_C", rows=slice(0, N, 2)), scenario)
    own = filter_of(scenario, log)
    own.moments, data = True, windows([log], own.given, own.read)
    error = own.run(data, np.zeros((len(data.time), len(own.knobs))), slopes=False).error
    assert len(set(np.isfinite(error).sum(axis=(0, 1)))) == 1


def test_what_is_not_read_has_no_error(tmp_path: Path) -> None:
    scenario = load("helical_two_stage")
    log = read(record(tmp_path / "log.csv", scenario, 1), scenario)
    log.values["T_oil"][::3] = np.nan
    own = filter_of(scenario, log)
    data = windows([log], own.given, own.read)
    passed = own.run(data, np.zeros((len(data.time), len(own.knobs))), slopes=False)
    known = (data.counts & (data.piece == 0))[:, :, None] & np.isfinite(data.read)
    error = np.where(known, data.read - passed.shown, 0.0).sum(axis=1) / known.sum(axis=1)
    assert known.sum(axis=1)[0, 0] < known.sum(axis=1)[0, 1]
    np.testing.assert_allclose(passed.error[:, 0], error)


@pytest.mark.filterwarnings("error")
def test_errors_that_are_always_the_same_have_a_share() -> None:
    error = np.full((2, 36, 1), 50.0)
    none = np.zeros((2, 1))
    assert np.isfinite(independent(Passed(none, none[:, :, None], error, np.ones_like(error), error)))


def test_another_oil_is_named(tmp_path: Path) -> None:
    scenario = load("cycloidal")
    past = record(tmp_path / "past.csv", scenario, 1)
    now = record(tmp_path / "now.csv", scenario, 2, thinner=1.7)
    found = gh.diagnose(None, "cycloidal", logs=now, reference_logs=past, quick=True)
    assert found.answers[0].causes == (("losses.oil_viscosity",),)
    assert found.verdict == "explained"


@pytest.mark.filterwarnings("error")
def test_windows_shorter_than_the_memory_of_errors() -> None:
    error = np.random.default_rng(1).standard_normal((2, 36, 1))
    error[:, :18] = np.nan
    none = np.zeros((2, 1))
    passed = Passed(none, none[:, :, None], error, np.ones_like(error), error)
    assert 0.1 < independent(passed) <= 1.5
    assert independent(replace(passed, error=np.where(np.isfinite(error), 1e-3 * error, error))) > 0


def test_a_replay_of_a_log_of_some_hours(tmp_path: Path) -> None:
    """It tells errors as far ahead as the log is long enough for, and draws thermometers alone."""
    path = record(tmp_path / "log.csv", load("planetary"), 1)
    (short := tmp_path / "short.csv").write_text("\n".join(path.read_text().splitlines()[:60]) + "\n")
    first, second = gh.replay("planetary", path, logs=[short]).logs
    assert [len(log.ahead["rig"]["T_oil"]) for log in (first, second)] == [5, 2]
    assert set(second.shown) == {"T_oil", "T_oil2", "T_wall"} and "T_sun" in second.free["rig"]


@pytest.fixture(scope="module")
def own_unit(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A unit of `gearheat new` with a torque transducer at either end."""
    path = tmp_path_factory.mktemp("own") / "mine.toml"
    gh.new("mine", stages="helical,helical", ratio=12, power="11 kW", speed="1450 rpm", out=path)
    shown = 'T_output_Nm = "output.tau"'
    assert path.read_text("utf-8").count(shown) == 1
    path.write_text(path.read_text("utf-8").replace(shown, f'{shown}\nT_input_Nm = "input.tau"'), "utf-8")
    return path


@pytest.mark.parametrize("zero", [0.0, 0.4])
def test_a_bearing_whose_friction_the_rig_file_leaves_at_its_default_is_named(
    own_unit: Path, tmp_path: Path, zero: float
) -> None:
    """Whatever the input torque's transducer shows without a torque [N.m]: it does so in the healthy log, too."""
    scenario = load(own_unit)
    assert "k_loss" not in scenario.spec.part("input_bearing_a").values
    past = record(tmp_path / "past.csv", scenario, 1)
    now = record(tmp_path / "now.csv", scenario, 2, changed={"input_bearing_a.k_loss": 4.0})
    for path in (past, now):
        names, table = path.read_text().splitlines()[0].split(","), np.loadtxt(path, delimiter=",", skiprows=1)
        table[:, names.index("T_input_Nm")] += zero
        np.savetxt(path, table, "%.8g", ",", header=",".join(names), comments="")
    found = gh.diagnose(None, own_unit, logs=now, reference_logs=past, quick=True)
    assert found.answers[0].causes == (("losses.bearing_preload",),)
    assert found.causes[0].parameters[0].value == pytest.approx(np.log(4.0), abs=0.3)
    assert [w for w in found.warnings if "have no dates" in w]


def test_heat_from_outside_is_named(own_unit: Path, tmp_path: Path) -> None:
    scenario = load(own_unit)
    past = record(tmp_path / "past.csv", scenario, 1)
    now = record(tmp_path / "now.csv", scenario, 2, changed={"wall.Q_flow_external": 80.0})
    found = gh.diagnose(None, own_unit, logs=now, reference_logs=past, quick=True)
    assert found.answers[0].causes == (("heat.external_source",),)
    heat = next(cause for cause in found.causes if cause.id == "heat.external_source")
    assert heat.parameters[0].value == pytest.approx(80.0, rel=0.2)


def test_what_cannot_differ_is_no_knob(own_unit: Path) -> None:
    """A torque without a zero error, by the card, and heat where the rig has no loss to compare it with."""
    roles = Roles.of((scenario := load(own_unit)).spec)
    sensors = [replace(s, offset_sd=0.0) for s in sensors_of(scenario, Card())]
    assert all(k.sd > 0 for k in knobs(roles, sensors, np.nan))
    assert len(knobs(roles, sensors, np.nan)) < len(knobs(roles, sensors, 100.0))


def test_what_factors_do_curves(own_unit: Path, tmp_path: Path) -> None:
    """A loss heats in proportion to its factor, and what lies before a conductance to one over it."""
    log = read(record(tmp_path / "log.csv", scenario := load(own_unit), 1), scenario)
    own = filter_of(scenario, log)
    bent, names = curves(own, windows([log], own.given, own.read)), [k.name for k in own.knobs]
    z = np.zeros((2, len(own.knobs)))
    loss, oil_wall, gain = (names.index(n) for n in ("input_bearing_a: loss", "oil_wall: conductance", "n_input: gain"))
    z[:, [loss, oil_wall, gain]] = np.log([[0.5] * 3, [4.0] * 3])
    does, slope = bent.at(z)
    assert does[:, loss] == pytest.approx([-0.5, 3.0], rel=0.15)  # it warms the oil besides, which thins it
    assert slope[:, loss] == pytest.approx([0.5, 4.0], rel=0.3)
    assert does[:, oil_wall] == pytest.approx([-1.0, 0.75], rel=0.2)
    assert does[:, gain] == pytest.approx(z[:, gain])
    np.testing.assert_allclose(bent.back(does), z, atol=0.01)
    about = bent.about(does[1])
    np.testing.assert_allclose(about.at(z - about.base)[0], does - does[1], atol=0.02)


def test_steps_of_a_sample_follow_what_is_fast(own_unit: Path, tmp_path: Path) -> None:
    """A stage of ten minutes is too long for what settles in some; more of them come nearer to the courses."""
    log = read(record(tmp_path / "log.csv", scenario := load(own_unit), 1), scenario)
    own = filter_of(scenario, log)
    data = windows([log], own.given, own.read, 0)
    at = np.zeros((len(data.read), len(own.knobs)))
    shown = {}
    for own.parts in (1, 4, 16):
        shown[own.parts] = own.run(data, at).shown
    far, near = (float(np.nanmax(np.abs(shown[k] - shown[16])[:, :, 0])) for k in (1, 4))
    assert near < 0.3 * far


@pytest.mark.parametrize(("moments", "parts"), [(False, 1), (False, 3), (True, 2)])
def test_slopes_are_those_of_the_likelihood(own_unit: Path, tmp_path: Path, moments: bool, parts: int) -> None:
    log = read(record(tmp_path / "log.csv", scenario := load(own_unit), 1), scenario)
    own = filter_of(scenario, log)
    own.moments, own.parts, sd = moments, parts, np.array([k.sd for k in own.knobs])
    data = windows([log], own.given, own.read)
    at = np.tile(0.3 * sd * np.random.default_rng(3).standard_normal(len(sd)), (len(data.read), 1))

    def likelihood(z: np.ndarray) -> float:
        return log_likelihood(own.run(data, z, slopes=False))

    names = [k.name for k in own.knobs]
    slope = own.run(data, at).slope.sum(axis=0)
    for name in ("stage_1: friction", "cooling: conductance", "T_output: gain", "T_input: gain", "n_input: gain"):
        k = names.index(name)
        step = 1e-3 * sd[k] * np.eye(len(sd))[k]
        by_hand = (likelihood(at + step) - likelihood(at - step)) / (2e-3 * sd[k])
        assert slope[k] == pytest.approx(by_hand, rel=0.05), name


def test_what_scatters_by_much_counts(own_unit: Path, tmp_path: Path) -> None:
    """A torque of large numbers, to which a standard deviation of a missing temperature was a small one."""
    log = read(record(tmp_path / "log.csv", scenario := load(own_unit), 1), scenario)
    names = [s.name for s in log.sensors if s.role == "read"]
    log = replace(log, sensors=tuple(replace(s, repeat_sd=40.0) if s.name == "T_input" else s for s in log.sensors))
    own = filter_of(scenario, log)
    data, k = windows([log], own.given, own.read), [knob.name for knob in own.knobs].index("T_input: gain")
    told = own.run(data, np.zeros((len(data.time), len(own.knobs)))).curvature[:, k, k].sum()
    shown = np.where(data.piece[:, :, None] >= 0, data.read, 0.0)[:, :, names.index("T_input")]
    pieces = data.piece.max(axis=1) + 1
    assert told == pytest.approx(
        float((shown.sum(axis=1) / data.counts.sum(axis=1)) ** 2 @ pieces / (3 * 40) ** 2), rel=0.5
    )


def test_a_lone_sample_says_of_its_thermometer_what_the_likelihood_says(tmp_path: Path) -> None:
    """The states begin at what is read, whatever its offset, which a sample between two holes seemed to tell."""
    log = read(record(tmp_path / "log.csv", scenario := load("helical_two_stage"), 1), scenario)
    log = replace(log.rows(np.arange(N) < 60), stretch=np.arange(60))
    own = filter_of(scenario, log)
    data, k = windows([log], own.given, own.read), [knob.name for knob in own.knobs].index("T_oil: offset")
    at = np.zeros((60, len(own.knobs)))
    step = 1e-3 * np.eye(len(own.knobs))[k]
    ends = [log_likelihood(own.run(data, at + side * step, slopes=False)) for side in (1, -1)]
    assert own.run(data, at).slope[:, k].sum() == pytest.approx((ends[0] - ends[1]) / 2e-3, rel=0.02)


def test_logs_without_dates_follow_one_another(tmp_path: Path) -> None:
    """Samples of several, which all begin at nought, were one span of time."""
    scenario = load("planetary")
    paths = tuple(record(tmp_path / f"{k}.csv", scenario, k, "T_oil") for k in (1, 2))
    request = Request("planetary", logs=paths, reference_logs=paths[::-1], sibling_logs=paths)
    found = read_logs(Inputs(request, scenario, Card(), None, None, None))
    for logs in (found.logs, found.reference):
        assert np.concatenate([log.time for log in logs]).tolist() == (STEP * np.arange(2 * N)).tolist()
    assert [log.time[0] for log in found.siblings] == [0.0, 0.0]


@pytest.mark.parametrize(("rows", "folds"), [(100, 2), (30, 0)])
def test_folds_of_logs_are_as_many_as_spans_and_look_for_as_many_causes(
    rows: int, folds: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    past, now = (record(tmp_path / f"{k}.csv", load("planetary"), k, "T_oil", changed=ch) for k, ch in HOT.items())
    now.write_text("\n".join(now.read_text().splitlines()[: rows + 1]) + "\n")
    asked: list[int] = []

    def weighed(problem, formulas, options, *more):
        asked.append(options.most)
        return weigh(problem, formulas, options, *more)

    monkeypatch.setattr("gearheat.tools.diagnose.logs.weigh", weighed)
    found = gh.diagnose(None, "planetary", logs=now, reference_logs=past, causes=1)
    assert found.verdict != "consistent" and asked == [1] * (1 + folds)
    assert (found.gain.folds if found.gain else 0) == folds
