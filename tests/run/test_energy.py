"""Every run keeps its energy: nets of bodies, shafts and lossy gears under duties made by hypothesis."""

from dataclasses import dataclass

import pytest
from gearheat.model.core.component import Component
from gearheat.model.core.flat import FlatModel
from gearheat.model.errors import SolveError
from gearheat.model.run.schedule import Schedule, join_phases
from gearheat.model.run.simulate import simulate
from gearheat.model.run.steady import steady
from hypothesis import given, settings, strategies as st
from small_parts import Ambient, Body, Conductor, Flywheel, Friction, LossyGear, Radiation, Speed, Torque, model


@dataclass(frozen=True)
class Machine:
    """A shaft, driven by a speed or a torque, with frictions in some of a chain of bodies, and perhaps a gear."""

    capacities: tuple[float, ...]
    conductances: tuple[float, ...]
    frictions: tuple[tuple[int, float, float, float], ...]
    geared: bool
    speed_given: bool
    area: float

    def flat(self) -> FlatModel:
        parts: list[Component] = [Ambient("room"), Radiation("surface", A=self.area), Conductor("foot", G=1.0)]
        heat = [[f"body{k}.heat"] for k in range(len(self.capacities))]
        shaft = ["drive.shaft"]
        parts += [Body(f"body{k}", C=C) for k, C in enumerate(self.capacities)]
        for k, G in enumerate(self.conductances):
            parts.append(Conductor(f"g{k}", G=G))
            heat[k].append(f"g{k}.a")
            heat[k + 1].append(f"g{k}.b")
        for k, (body, tau_dry, d_40, thinning) in enumerate(self.frictions):
            parts.append(Friction(f"f{k}", tau_dry=tau_dry, d_40=d_40, thinning=thinning))
            heat[body % len(heat)].append(f"f{k}.heat")
            shaft.append(f"f{k}.shaft")
        parts.append(Speed("drive") if self.speed_given else Torque("drive"))
        if not self.speed_given:
            parts.append(Flywheel("rotor", J=0.2))
            shaft.append("rotor.shaft")
        nets = [tuple(shaft)]
        if self.geared:
            parts += [LossyGear("gear", ratio=-2.5, mu=0.04), Torque("load")]
            nets = [(*shaft, "gear.a"), ("gear.b", "load.shaft")]
            heat[0].append("gear.heat")
        heat[0] += ["surface.a", "foot.a"]
        nets += [tuple(h) for h in heat] + [("room.heat", "surface.b", "foot.b")]
        return model(*parts, nets=[n for n in nets if len(n) > 1])


def log_floats(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(0.0, 1.0).map(lambda s: low * (high / low) ** s)


@st.composite
def machines(draw: st.DrawFn) -> Machine:
    n = draw(st.integers(1, 4))
    friction = st.tuples(
        st.integers(0, 3), st.floats(0.5, 3.0), st.floats(0.05, 0.3), st.sampled_from([0.0, 0.002, 0.01])
    )
    return Machine(
        tuple(draw(st.lists(log_floats(50.0, 1e5), min_size=n, max_size=n))),
        tuple(draw(st.lists(log_floats(5.0, 500.0), min_size=n - 1, max_size=n - 1))),
        tuple(draw(st.lists(friction, min_size=1, max_size=3))),
        draw(st.booleans()),
        draw(st.booleans()),
        draw(st.floats(0.05, 1.0)),
    )


@st.composite
def duties(draw: st.DrawFn, machine: Machine) -> Schedule:
    value = st.floats(-150.0, 150.0) if machine.speed_given else st.floats(-8.0, 8.0)
    names = {"drive.w" if machine.speed_given else "drive.tau": value, "room.T": st.floats(270.0, 310.0)}
    if machine.geared:
        names["load.tau"] = st.floats(-20.0, 20.0) if machine.speed_given else st.floats(-2.0, 2.0)
    phases = []
    for _ in range(draw(st.integers(1, 4))):
        inputs = {name: draw(st.one_of(v, st.tuples(v, v))) for name, v in names.items()}
        phases.append((draw(log_floats(0.5, 7200.0)), inputs))
    return join_phases(phases)


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.data())
def test_every_run_keeps_its_energy(data: st.DataObject) -> None:
    machine = data.draw(machines())
    duty = data.draw(duties(machine))
    run = simulate(machine.flat(), duty)
    assert run.audit.residual < 1e-6
    assert max(run.implicit.values(), default=0.0) < 1e-6


@settings(max_examples=20, deadline=None, derandomize=True)
@given(st.data())
def test_steady_is_where_a_run_ends(data: st.DataObject) -> None:
    """And where a run ends nowhere, friction that thins under a constant torque, there is no steady state either."""
    machine = data.draw(machines())
    flat = machine.flat()
    values = {"room.T": 290.0}
    if machine.speed_given:
        values["drive.w"] = data.draw(st.floats(15.0, 120.0))
    else:
        values["drive.tau"] = data.draw(st.floats(1.0, 8.0))
    if machine.geared:
        values["load.tau"] = data.draw(st.floats(-2.0, 2.0))
    try:
        end = simulate(flat, join_phases([(1e8, values)]), times=[1e8])
    except SolveError:
        with pytest.raises(SolveError):
            steady(flat, values)
        return
    point = steady(flat, values)
    for q in flat.states:
        assert abs(point[q.name][0] - end[q.name][0]) < 1e-5 * q.nominal + 1e-6 * abs(end[q.name][0])
    assert point.audit.residual < 1e-9
