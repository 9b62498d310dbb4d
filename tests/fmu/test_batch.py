"""Batches of rows: equal to single runs, whatever rows stand beside them and however many threads share the work."""

import pickle
from collections import Counter
from pathlib import Path
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest
from gearheat.fmu import batch_library, compiling
from gearheat.fmu.batch import Batch, Rows, Status
from gearheat.fmu.batch_library import processor
from gearheat.model.core.flat import FlatModel, Quantity
from gearheat.model.errors import FmuError, ScenarioError, SolveError
from gearheat.model.run.schedule import Schedule, join_phases
from gearheat.model.run.simulate import simulate
from gearheat.model.run.steady import steady
from small_parts import Battery, Ground, Resistor, brake, gear, model, motor


def well() -> FlatModel:
    """A particle in a double well: balances near -1, 0 (unstable) and 1 for a small push, one for a large push."""
    x, u, p = ca.SX.sym("x"), ca.SX.sym("u"), ca.SX.sym("p")
    force = u + p * x - x**3
    return FlatModel(
        name="well",
        doc="a particle in a double well",
        states=(Quantity("particle.x", "m", "position", start=-2.0),),
        inputs=(Quantity("push.F", "N", "push", low=-10.0, high=10.0),),
        parameters=(Quantity("hill.h", "N/m", "height of the hill", start=1.0),),
        outputs=(Quantity("hill.F", "N", "force of the hill"),),
        x=x,
        u=u,
        p=p,
        ode=force,
        y=p * x,
        residual=ca.SX(0, 1),
        residual_names=(),
        supply=force,
        throughput=ca.fabs(force),
        stored=x,
        checks=(),
        checked=ca.SX(0, 1),
        laws=(),
    )


def spread(n: int, **ranges: tuple[float, float]) -> dict[str, np.ndarray]:
    """Values by path (dots written as __), the same in every run."""
    random = np.random.default_rng(1)
    return {name.replace("__", "."): random.uniform(low, high, n) for name, (low, high) in ranges.items()}


def same(a: Rows, b: Rows, rows: slice = slice(None)) -> bool:
    names = ("x", "y", "status", "iterations", "supplied", "gained", "throughput", "outside")
    return all(getattr(a, n)[rows].tobytes() == getattr(b, n).tobytes() for n in names)


@pytest.fixture(scope="module")
def heat(models: SimpleNamespace) -> Batch:
    return Batch(models.heat)


@pytest.mark.parametrize(
    ("flat", "values", "states"),
    [
        (brake(), {"drive__w": (-300, 300), "room__T": (250, 350), "foot__G": (2, 9)}, {"oil__T": (200, 900)}),
        (brake(thinning=-0.02), {"drive__w": (0, 60)}, {}),
        (motor(), {"drive__tau": (-10, 10), "load__tau": (-3, 3)}, {"rotor__w": (-30, 30)}),
        (gear(), {"drive__w": (-300, 300), "load__tau": (-50, 50), "gear__mu": (0, 0.1)}, {}),
        (well(), {"push__F": (-0.6, 0.6), "hill__h": (-1, 2)}, {"particle__x": (-3, 3)}),
    ],
    ids=["brake", "runaway", "motor", "gear", "well"],
)
def test_a_row_is_the_steady_state_of_the_model(
    flat: FlatModel, values: dict[str, tuple[float, float]], states: dict[str, tuple[float, float]]
) -> None:
    """Also which of several balances it is, and whether there is one at all."""
    given = spread(40, **values, **states)
    starts = {name.replace("__", ".") for name in states}
    batch = Batch(flat)
    rows = batch.steady(*batch.vectors(given))
    solved = 0
    for k in range(40):
        here = {name: float(column[k]) for name, column in given.items()}
        try:
            point = steady(
                flat,
                {n: v for n, v in here.items() if n not in starts},
                guess={n: v for n, v in here.items() if n in starts},
            )
        except SolveError:
            assert rows.status[k] in (Status.NO_EQUILIBRIUM, Status.UNSTABLE)
            assert np.isnan(rows.x[k]).all()
            continue
        solved += 1
        assert rows.status[k] == Status.OK
        assert rows.residual[k] < 1e-9
        for q in flat.states:
            assert rows[q.name][k] == pytest.approx(point[q.name][0], abs=1e-9 * q.nominal)
        for q in flat.outputs:
            assert rows[q.name][k] == pytest.approx(point[q.name][0], rel=1e-8, abs=1e-8)
    assert solved > 10


def test_a_torque_driven_shaft_under_a_stiff_governor(heat: Batch, models: SimpleNamespace) -> None:
    given = spread(20, governor__w=(-300, 300), load__tau=(-50, 50), room__T=(260, 310))
    rows = heat.steady(*heat.vectors(given))
    assert (rows.status == Status.OK).all()
    for k in range(20):
        point = steady(models.heat, {name: float(column[k]) for name, column in given.items()})
        assert rows["oil.T"][k] == pytest.approx(point["oil.T"][0], abs=1e-8)
        assert rows["shaft.w"][k] == pytest.approx(point["shaft.w"][0], abs=1e-8)
        assert rows["gears.P_loss"][k] == pytest.approx(point["gears.P_loss"][0], rel=1e-9)
        assert rows.outside[k] == len(point.outside)
    assert set(rows.outside) == {0.0, 1.0}


def test_threads_and_neighbours_leave_the_bits_alone(heat: Batch, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("gearheat.fmu.batch.STEADY_BLOCK", 7)
    monkeypatch.setattr("gearheat.fmu.batch.WARMUP_BLOCK", 3)
    arrays = heat.vectors(spread(100, governor__w=(50, 300), load__tau=(-50, 50), housing__A=(0.2, 2)))
    alone = heat.steady(*arrays, threads=1)
    for threads in (2, 5):
        assert same(alone, heat.steady(*arrays, threads=threads))
    assert same(alone, heat.steady(*(a[31:45] if a.ndim == 2 else a for a in arrays)), slice(31, 45))
    duty = join_phases([(600.0, {"room.T": (290.0, 300.0)}), (600.0, {"room.T": 280.0})])
    few = tuple(a[:10] if a.ndim == 2 else a for a in arrays)
    alone = heat.warmup(duty, *few, times=[300.0, 1200.0], threads=1)
    assert same(alone, heat.warmup(duty, *few, times=[300.0, 1200.0], threads=3))
    assert same(alone, heat.warmup(duty, few[0][4:6], few[1][4:6], times=[300.0, 1200.0]), slice(4, 6))


def test_a_pickled_batch_gives_the_same_rows(heat: Batch) -> None:
    arrays = heat.vectors(spread(5, load__tau=(-50, 50)))
    assert same(heat.steady(*arrays), pickle.loads(pickle.dumps(heat)).steady(*arrays))


DUTY = join_phases(
    [
        (1800.0, {"load.tau": 20.0, "room.T": 293.15}),
        (900.0, {"load.tau": (20.0, 60.0)}),
        (1800.0, {"load.tau": 5.0, "room.T": (293.15, 283.15)}),
    ]
)


def test_a_warm_up_is_the_simulation_of_the_model(heat: Batch, models: SimpleNamespace) -> None:
    """At both sides of a jump, on ramps and between; the error follows the tolerance."""
    times = [0.0, 100.0, 1800.0, 2400.0, 2700.0, 2700.0, 2700.5, 4500.0]
    given = spread(4, governor__w=(50, 200), oil__b_0=(0.01, 0.03), oil__T=(280, 320))
    errors = []
    for tolerance in (1e-4, 1e-6):
        rows = heat.warmup(DUTY, *heat.vectors(given), times=times, tolerance=tolerance)
        assert rows.time is not None
        assert rows.time.tolist() == times
        assert (rows.status == Status.OK).all()
        worst = 0.0
        for k in range(4):
            here = {name: float(column[k]) for name, column in given.items()}
            start = {"oil.T": here.pop("oil.T")}
            run = simulate(models.heat, DUTY, values=here, start=start, times=times, tolerance=1e-11)
            for name in ("oil.T", "gears.T", "cover.T", "housing.T"):
                worst = max(worst, float(np.abs(rows[name][k] - run[name]).max()))
            assert rows["gears.P_loss"][k] == pytest.approx(run["gears.P_loss"], rel=1e-3)
            assert rows.supplied[k] == pytest.approx(run.audit.supplied, rel=1e-4)
        errors.append(worst)
        assert (rows.residual < 1e-9).all()
        assert (rows.iterations > 10).all()
    assert errors[0] < 2e-3
    assert errors[1] < 2e-5


def test_the_times_asked_for_hardly_change_a_warm_up(heat: Batch) -> None:
    end = heat.warmup(DUTY)
    assert end.x.shape == (1, 1, 5)
    fine = heat.warmup(DUTY, times=np.linspace(0.0, 4500.0, 91))
    assert np.abs(fine.x[0, -1] - end.x[0, 0]).max() < 2e-3


def test_rows_that_cannot_be_solved_leave_the_others_alone() -> None:
    batch = Batch(brake(thinning=-0.02))
    speeds = np.array([10.0, 100.0, np.nan, 20.0, 10.0])
    values = {"drive.w": speeds, "foot.G": np.array([5.0, 5.0, 5.0, -1.0, 5.0])}
    rows = batch.steady(*batch.vectors(values))
    assert rows.status[[0, 2, 3, 4]].tolist() == [Status.OK, Status.OUT_OF_RANGE, Status.OUT_OF_RANGE, Status.OK]
    assert rows.status[1] in (Status.NO_EQUILIBRIUM, Status.UNSTABLE)
    assert np.isnan(rows.x[1:4]).all()
    assert np.isnan(rows.y[1:4]).all()
    assert np.isnan(rows.residual[1:4]).all()
    assert rows.x[0].tobytes() == rows.x[4].tobytes()
    duty = join_phases([(1e6, {"room.T": 300.0})])
    warm = batch.warmup(duty, *batch.vectors(values), times=[10.0, 1e6])
    assert warm.status.tolist() == [Status.OK, Status.STOPPED, Status.OUT_OF_RANGE, Status.OUT_OF_RANGE, Status.OK]
    assert np.isnan(warm.x[1:4]).all()
    assert warm.x[0, 1] == pytest.approx(rows.x[0], abs=1e-2)


def crowd(n: int) -> dict[str, np.ndarray]:
    """Rows for a brake whose oil thins out: they take different numbers of steps, and some run away."""
    values = spread(n, drive__w=(5.0, 60.0), foot__G=(3.0, 8.0), oil__T=(260.0, 340.0))
    return values | {"drive.w": np.where(np.arange(n) % 5 == 2, 100.0, values["drive.w"])}


def test_a_row_alone_is_the_row_in_a_crowd() -> None:
    """Among rows that go on longer, end sooner, run away or cannot begin."""
    batch, n = Batch(brake(thinning=-0.02)), 37
    values = crowd(n)
    values["oil.T"][[0, 20]] = 1e5  # the oil has no viscosity any more: not a number, or at once out of range
    arrays = batch.vectors(values)
    duty, times = (
        join_phases([(3e3, {"room.T": 290.0}), (1e6, {"room.T": (290.0, 300.0)})]),
        [0.0, 10.0, 3e3, 3e3, 1.003e6],
    )
    rows = batch.warmup(duty, *arrays, times=times, threads=1)
    assert set(rows.status) > {Status.OK, Status.STOPPED}
    assert len(set(rows.iterations)) > 5
    for k in range(n):
        alone = batch.warmup(duty, *(a[k : k + 1] if a.ndim == 2 else a for a in arrays), times=times)
        assert same(rows, alone, slice(k, k + 1)), k
    shuffled = np.random.default_rng(3).permutation(n)
    mixed = batch.warmup(duty, *(a[shuffled] if a.ndim == 2 else a for a in arrays), times=times, threads=1)
    assert rows.x[shuffled].tobytes() == mixed.x.tobytes()
    assert rows.iterations[shuffled].tobytes() == mixed.iterations.tobytes()


def test_the_processor_leaves_the_bits_alone(heat: Batch, monkeypatch: pytest.MonkeyPatch) -> None:
    if not processor():
        pytest.skip("this processor has the basic instructions alone")
    arrays = heat.vectors(spread(30, governor__w=(50, 300), load__tau=(-50, 50), housing__A=(0.2, 2)))
    duty = join_phases([(600.0, {"room.T": (290.0, 300.0)}), (600.0, {"room.T": 280.0})])
    own, settled = heat.warmup(duty, *arrays, times=[300.0, 1200.0]), heat.steady(*arrays)
    for name in ("", *processor()):
        monkeypatch.setattr("gearheat.fmu.batch.instructions", lambda name=name: name)
        assert same(own, heat.warmup(duty, *arrays, times=[300.0, 1200.0]))
        assert same(settled, heat.steady(*arrays))


def test_what_is_compiled_quickly_and_what_is_optimised_give_the_same_bits(
    models: SimpleNamespace, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The optimised one takes over as soon as there is much to do."""
    batch, told = Batch(models.heat), list[str]()
    compiled = compiling._compile
    monkeypatch.setattr(
        compiling, "_compile", lambda files, target, way: told.append(way) or compiled(files, target, way)
    )
    monkeypatch.setattr(batch_library, "_LOADED", {})
    monkeypatch.setattr(batch_library, "_WORK", Counter())
    zig = compiling.cache_folder() / "zig"
    for kind in ("global", "local"):
        monkeypatch.setenv(f"ZIG_{kind.upper()}_CACHE_DIR", str(zig / kind))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    arrays = batch.vectors(spread(30, governor__w=(50, 300), load__tau=(-50, 50), housing__A=(0.2, 2)))
    quick, warm = batch.steady(*arrays), batch.warmup(DUTY, *arrays)
    assert told == ["-O0", "-O0"]
    monkeypatch.setattr(batch_library, "LITTLE", 59)
    assert same(quick, batch.steady(*arrays)) and same(warm, batch.warmup(DUTY, *arrays))
    assert told == ["-O0", "-O0", "-O2", "-O2"]


def test_a_start_where_the_model_has_no_value() -> None:
    batch = Batch(well())
    rows = batch.steady(*batch.vectors({"particle.x": np.array([1e200, 0.5])}))
    assert rows.status.tolist() == [Status.NOT_FINITE, Status.OK]
    rows = batch.warmup(join_phases([(1.0, {"push.F": 0.0})]), *batch.vectors({"particle.x": np.array([1e200, 0.5])}))
    assert rows.status.tolist() == [Status.NOT_FINITE, Status.OK]


def test_a_model_without_states() -> None:
    nets = [("battery.a", "resistor.a"), ("resistor.b", "battery.b", "ground.pin")]
    batch = Batch(model(Battery("battery"), Resistor("resistor", R=5.0), Ground("ground"), nets=nets))
    rows = batch.steady(*batch.vectors({"battery.V": np.array([10.0, 20.0])}))
    assert rows["resistor.P"].tolist() == [20.0, 80.0]
    warm = batch.warmup(join_phases([(1.0, {"battery.V": (0.0, 10.0)})]), times=[0.5, 1.0])
    assert warm["resistor.P"][0] == pytest.approx([5.0, 20.0])


def test_what_is_wrong_is_said_at_once(heat: Batch) -> None:
    with pytest.raises(ScenarioError) as caught:
        heat.vectors({"load.tua": 1.0, "oil.T": np.zeros(3), "room.T": np.zeros(4), "gears.P_loss": 1.0})
    assert len(caught.value.problems) == 3
    assert 'Did you mean "load.tau"?' in str(caught.value)
    with pytest.raises(ScenarioError) as caught:
        heat.steady(np.zeros((4, 2)), np.zeros((3, 8)), np.zeros((2, 5)))
    assert len(caught.value.problems) == 2
    duty = Schedule(np.array([0.0, 1.0]), {"room.T": np.array([-1.0, 300.0]), "romo.T": np.zeros(2)})
    with pytest.raises(ScenarioError) as caught:
        heat.warmup(duty, tolerance=0.0)
    assert len(caught.value.problems) == 3
    with pytest.raises(FmuError, match="output times"):
        heat.warmup(DUTY, times=[5000.0])
    with pytest.raises(ScenarioError, match=r'Did you mean "oil\.T"'):
        heat.steady()["oil.t"]
