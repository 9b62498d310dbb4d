"""No net makes or loses energy: what the states gain crosses the boundary, whatever the parts and their state."""

from collections.abc import Iterator

import casadi as ca
import numpy as np
import pytest
from gearheat.model.core.component import Equation, equation
from gearheat.model.core.flat import FlatModel
from gearheat.model.run.algebra import algebra
from hypothesis import given, settings, strategies as st
from small_parts import Body, Friction, Speed, brake, gear, model, motor, rc, rl

MODELS = {"rc": rc(), "rl": rl(), "motor": motor(), "brake": brake(), "gear": gear()}


def gain(flat: FlatModel) -> ca.Function:
    """(x, z, u, p) -> gain of stored energy, supply, throughput."""
    change = ca.jacobian(flat.stored, flat.x) @ flat.ode
    return ca.Function("gain", flat.point, [change, flat.supply, flat.throughput])


GAINS = {name: gain(flat) for name, flat in MODELS.items()}


@pytest.mark.parametrize("name", MODELS)
@settings(max_examples=40, deadline=None, derandomize=True)
@given(seed=st.integers(0, 10**9))
def test_supply_is_gain(name: str, seed: int) -> None:
    flat, random = MODELS[name], np.random.default_rng(seed)
    x = [q.start + q.nominal * random.normal() for q in flat.states]
    u = [q.start + 10 * q.nominal * random.normal() for q in flat.inputs]
    p = [q.start * np.exp(0.5 * random.normal()) for q in flat.parameters]
    z = algebra(flat).solve(*map(np.array, (x, u, p)))
    gained, supply, throughput = map(float, GAINS[name](x, z, u, p))
    assert abs(gained - supply) <= 1e-11 * throughput + 1e-12


def test_the_audit_sees_a_part_that_makes_energy() -> None:
    """A friction whose heat is not its power must show."""

    class Cheat(Friction):
        def equations(self) -> Iterator[Equation]:
            for e in super().equations():
                yield e if e.name != "becomes heat" else equation(e.name, self.heat.Q_flow, -1.01 * self.P_loss)

    parts = (Speed("drive"), Cheat("bearing", tau_dry=1.0, d_40=0.1, thinning=0.0), Body("oil", C=10.0))
    flat = model(*parts, nets=[("drive.shaft", "bearing.shaft"), ("bearing.heat", "oil.heat")])
    u = flat.starts("input")
    u[flat.locate("drive.w")[1]] = 10.0
    gained, supply, throughput = map(float, gain(flat)(flat.starts("state"), [], u, flat.starts("parameter")))
    assert abs(gained - supply) == pytest.approx(0.01 * throughput, rel=1e-6)
