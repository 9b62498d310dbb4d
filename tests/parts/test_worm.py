"""Worm gears: which shaft drives, self-locking, and the oil."""

import math

import pytest
from gearheat.model.core.connect import Assembly
from gearheat.model.core.flat import FlatModel
from gearheat.model.core.flatten import flatten
from gearheat.model.errors import SolveError
from gearheat.model.parts import PARTS
from gearheat.model.run.rows import evaluate_at
from gearheat.model.run.schedule import join_phases
from gearheat.model.run.simulate import simulate

OIL = dict(nu_40=2.2e-4, nu_100=1.9e-5, rho_15=895.0, alpha_T=-6.2e-4, s_p=9.904, t_p=0.139, X_L=1.0)
STEEP = dict(z_1=4.0, z_2=41.0, m_x=4e-3, d_1=0.044, alpha_n=math.radians(20), k_mu=1.0)
FLAT = STEEP | dict(z_1=1.0, d_1=0.06)


def model(values: dict, rotor: bool = False, X_L: float = 1.0, wheel: str = "tau") -> FlatModel:
    """A worm in warm oil; of its wheel torque or speed is given, of the worm the other, or with a rotor its torque."""
    parts = [PARTS["WormPair"]("pair", **values), PARTS["ShaftEnd"]("b", given=(wheel,))]
    parts += [PARTS["OilBath"]("oil", V=1e-3, c_p=2000.0, T=333.15, **OIL | dict(X_L=X_L))]
    parts += [PARTS["ShaftEnd"]("a", given=("tau",) if rotor or wheel == "w" else ("w",))]
    shaft = ["a.flange", "pair.worm"]
    if rotor:
        parts += [PARTS["Inertia"]("rotor", J=0.01)]
        shaft.append("rotor.flange")
    nets = (tuple(shaft), ("b.flange", "pair.wheel"), ("oil.lubricant", "pair.lubricant"), ("oil.heat", "pair.gears"))
    return flatten(Assembly("worm", "", tuple(parts), nets))


def at_work(values: dict, w: float, tau: float, X_L: float = 1.0) -> dict[str, float]:
    """All outputs at a speed of the worm and a torque at the wheel."""
    flat = model(values, X_L=X_L)
    given = {"a.w": w, "b.tau": tau}
    u = [given.get(q.name, q.start) for q in flat.inputs]
    y = evaluate_at(flat, [q.start for q in flat.states], u, flat.starts("parameter"))["y"]
    return dict(zip([q.name for q in flat.outputs], y.tolist(), strict=True))


def efficiency(values: dict, mu: float, drive: int) -> float:
    """Of a screw with friction, by the textbook's formula; where the wheel drives with `drive` -1."""
    tan, cos = values["z_1"] * values["m_x"] / values["d_1"], math.cos(values["alpha_n"])
    eta = tan * (cos - drive * mu * tan) / (cos * tan + drive * mu)
    return eta if drive == 1 else 1 / eta


@pytest.mark.parametrize("w", [150.0, -150.0])
@pytest.mark.parametrize("values", [STEEP, FLAT], ids=["steep", "flat"])
def test_the_worm_drives_with_the_efficiency_of_a_screw(values, w):
    load = math.copysign(200.0, w)  # the wheel turns against the worm, so this brakes it
    found = at_work(values, w, load)
    assert found["a.P"] > 0 > found["b.P"]
    assert -found["b.P"] / found["a.P"] == pytest.approx(efficiency(values, found["pair.mu"], 1), rel=1e-4)


def test_a_wheel_drives_a_steep_worm_and_not_a_flat_one():
    steep, flat = at_work(STEEP, 150.0, -200.0), at_work(FLAT, 1.0, -200.0)
    assert steep["b.P"] > 0 > steep["a.P"]
    assert -steep["a.P"] / steep["b.P"] == pytest.approx(efficiency(STEEP, steep["pair.mu"], -1), rel=1e-4)
    assert steep["pair.locking"] < 1 < flat["pair.locking"]
    assert flat["b.P"] > 0  # the load helps,
    assert flat["a.P"] > 0  # and yet the worm has to be turned
    assert flat["pair.eta_mesh"] == pytest.approx(efficiency(FLAT, flat["pair.mu"], -1), rel=1e-6)


@pytest.mark.parametrize(("values", "held"), [(STEEP, False), (FLAT, True)], ids=["steep", "flat"])
def test_a_hanging_load_stays_or_falls(values, held):
    """A load at the wheel, no torque at the worm, two seconds."""
    flat = model(values, rotor=True)
    inputs = {q.name: q.start for q in flat.inputs} | {"a.tau": 0.0, "b.tau": -20.0}
    found = simulate(flat, join_phases([(2.0, inputs)]))
    assert (abs(found["rotor.w"][-1]) < 1e-4) == held


def test_friction_falls_with_speed_and_follows_the_oil():
    slow, fast, smooth = at_work(STEEP, 10.0, 200.0), at_work(STEEP, 300.0, 200.0), at_work(STEEP, 300.0, 200.0, 0.8)
    assert fast["pair.mu"] < 0.5 * slow["pair.mu"]
    assert smooth["pair.mu"] == pytest.approx(0.8 * fast["pair.mu"])


def test_friction_of_din_3996_is_an_angle_beside_the_lead_angle_and_less_in_large_worms():
    """The efficiency is tan(gamma)/tan(gamma + rho) with the product of the printed factors, here 0.0424 at 2 m/s."""
    flat, gamma = FLAT | dict(friction="DIN3996", b=0.05, Y_W=0.95), math.atan(4 / 60)
    w = 2.0 * math.cos(gamma) / 0.03
    found = at_work(flat, w, 200.0)
    h_star = 0.018 + 15 / (7.86 * 56) + 1 / 41 - 41 / 36300 + 50 / (370.4 * 4) - math.sqrt(29) / 213.9
    rho = math.atan(0.04243 * math.sqrt(100 / 112) * math.sqrt(0.07 / h_star) * 0.95)
    assert -found["b.P"] / found["a.P"] == pytest.approx(math.tan(gamma) / math.tan(gamma + rho), rel=1e-3)
    large = at_work(flat | dict(m_x=8e-3, d_1=0.12, b=0.1), w / 2, 1600.0)
    assert large["pair.mu"] == pytest.approx(found["pair.mu"] * math.sqrt(1 / 2), rel=1e-3)
    assert at_work(flat, w, 200.0, X_L=0.7)["pair.mu"] == pytest.approx(found["pair.mu"] * 0.02931 / 0.04243, rel=1e-3)


def test_a_worm_that_locks_says_so_where_nothing_turns_it():
    """A wheel that is to turn a worm against a torque: no torque does."""
    flat = model(FLAT, wheel="w")
    given = {"b.w": 0.1, "a.tau": 5.0}
    u = [given.get(q.name, q.start) for q in flat.inputs]
    with pytest.raises(SolveError, match=r"pair: self-locking, the wheel cannot drive: friction .* Let the worm drive"):
        evaluate_at(flat, [q.start for q in flat.states], u, flat.starts("parameter"))
