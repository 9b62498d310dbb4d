"""No result leaves a run that makes energy, leaves an implicit equation open, or shows a value out of its range."""

from collections.abc import Iterator

import numpy as np
import pytest
from gearheat.model.core.component import Component, Equation, equation
from gearheat.model.core.declare import Input, Output
from gearheat.model.errors import SolveError
from gearheat.model.run.result import list_unsolved
from gearheat.model.run.schedule import join_phases
from gearheat.model.run.simulate import simulate
from gearheat.model.run.steady import steady
from small_parts import Ambient, Body, Conductor, Friction, Speed, model


class Cheat(Friction):
    """Friction whose heat is more than its power."""

    def equations(self) -> Iterator[Equation]:
        for e in super().equations():
            yield e if e.name != "becomes heat" else equation(e.name, self.heat.Q_flow, -1.01 * self.P_loss)


class Negative(Component):
    """A loss that its equation lets become negative."""

    u = Input("W", "what it is made of")
    P_loss = Output("W", "loss", nominal=1.0, at_least=0.0)

    def equations(self) -> Iterator[Equation]:
        yield equation("loss", self.P_loss, self.u)


def bench(kind: type[Component]) -> tuple:
    parts = (Speed("drive"), kind("bearing", tau_dry=1.0, d_40=0.1, thinning=0.0), Body("oil", C=1000.0))
    more = (Conductor("foot", G=2.0), Ambient("room"))
    nets = [("drive.shaft", "bearing.shaft"), ("bearing.heat", "oil.heat", "foot.a"), ("foot.b", "room.heat")]
    return model(*parts, *more, nets=nets)


def test_a_part_that_makes_energy_is_named() -> None:
    flat, message = bench(Cheat), r"energy is not conserved: 0\.00\d+ of the throughput.*bearing gives off"
    with pytest.raises(SolveError, match=message):
        steady(flat, {"drive.w": 10.0})
    with pytest.raises(SolveError, match=message):
        simulate(flat, join_phases([(3600.0, {"drive.w": 10.0})]))


def test_a_sound_model_passes() -> None:
    assert steady(bench(Friction), {"drive.w": 10.0}).audit.residual < 1e-12


def test_a_negative_loss_is_named() -> None:
    flat = model(Negative("seal"), nets=[])
    assert steady(flat, {"seal.u": -1e-12})["seal.P_loss"][0] == -1e-12  # round-off
    with pytest.raises(SolveError, match=r"seal\.P_loss = -0\.001 W is out of range. It must be at least 0 W"):
        steady(flat, {"seal.u": -1e-3})


def test_an_open_equation_is_named() -> None:
    assert list(list_unsolved({"gear: loss": 1e-9})) == []
    (told,) = list_unsolved({"gear: loss": float("nan"), "bearing: torque": 1e-8})
    assert '"gear: loss" leaves nan' in told


def test_a_state_that_is_joined_is_in_the_balance() -> None:
    """Two bodies at one place: what one of them gains is in the other's equation."""
    parts = (Body("one", C=100.0), Body("two", C=300.0), Conductor("foot", G=2.0), Ambient("room"))
    flat = model(*parts, nets=[("one.heat", "two.heat", "foot.a"), ("foot.b", "room.heat")])
    run = simulate(flat, join_phases([(600.0, {"one.Q": 50.0})]))
    assert run.audit.residual < 1e-7
    assert np.isfinite(run["one.T"]).all()
