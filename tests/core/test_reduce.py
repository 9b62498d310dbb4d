"""Rigid couplings are fewer states: against one equivalent inertia, one sum of capacities, and the closed form."""

import math
from itertools import permutations

import pytest
from gearheat.model.core.connect import Assembly
from gearheat.model.core.flat import FlatModel
from gearheat.model.core.flatten import flatten
from gearheat.model.errors import ScenarioError, StructureError
from gearheat.model.parts import PARTS
from gearheat.model.run.rows import evaluate_at
from gearheat.model.run.schedule import join_phases
from gearheat.model.run.simulate import simulate
from gearheat.model.run.steady import steady
from small_parts import Ambient, Body, Conductor, Flywheel, Speed, model

OIL = dict(nu_40=3.2438e-4, nu_100=3.527e-5, rho_15=859.0, alpha_T=-5.6e-4, s_p=7.382, t_p=0.1335, X_L=0.666)
TEETH = dict(z_1=36.0, z_2=72.0, m_n=0.002, alpha_n=math.radians(20), beta=math.radians(10), b=0.042, a_w=0.1097)
TEETH |= dict(Ra=6e-7, line_load="F_bn/l", E=2.06e11, poisson=0.3)
SET = TEETH | dict(z_2=36.0, a_w=0.073035, N=3.0, z_3=108.0, eps_alpha_sp=1.666, eps_alpha_pr=1.883)
SET |= dict(H_v_sp=0.168, H_v_pr=0.062, n_axial_carrier=1.0, n_axial_sun=3.0, s_planet=0.021)


def part(kind: str, name: str, **values):
    return PARTS[kind](name, **values)


def gearbox(k_mu: float, *inertias, J_1: float = 0.2, J_2: float = 3.0) -> FlatModel:
    """A gear pair that warms its oil, torques given on both sides, with an inertia on each shaft named."""
    masses = {"rotor": ("pinion", J_1), "mill": ("wheel", J_2)}
    parts = [part("ShaftEnd", end, given=("tau",)) for end in ("input", "output")]
    parts += [part("HelicalGearPair", "gear", **TEETH, x_1=0.0, x_2=0.0, k_mu=k_mu)]
    parts += [part("Inertia", name, J=masses[name][1]) for name in inertias]
    parts += [
        part("OilBath", "oil", **OIL, V=1e-3, c_p=2000.0),
        part("ThermalConductor", "foot", G=5.0),
        part("Room", "room"),
    ]
    nets = [("input.flange", "gear.pinion", *(f"{n}.flange" for n in inertias if masses[n][0] == "pinion"))]
    nets += [("output.flange", "gear.wheel", *(f"{n}.flange" for n in inertias if masses[n][0] == "wheel"))]
    nets += [("oil.heat", "gear.gears", "foot.a"), ("foot.b", "room.floor"), ("oil.lubricant", "gear.lubricant")]
    return flatten(Assembly("gearbox", "two shafts", tuple(parts), tuple(nets)))


def rates(flat: FlatModel, states: dict[str, float], inputs: dict[str, float]) -> dict[str, float]:
    x = [states.get(q.name, q.start) for q in flat.states]
    u = [inputs.get(q.name, q.start) for q in flat.inputs]
    found = evaluate_at(flat, x, u, flat.starts("parameter"))
    ode, y = found["ode"], found["y"]
    return dict(zip([q.name for q in (*flat.states, *flat.outputs)], [*ode, *y], strict=True))


def test_two_inertias_through_a_gear_are_one() -> None:
    flat = gearbox(0.0, "rotor", "mill")
    assert [q.name for q in flat.states] == ["rotor.w", "oil.T"]
    assert flat.joined == ("mill.w follows rotor.w",)
    found = rates(flat, {"rotor.w": 20.0, "oil.T": 330.0}, {"input.tau": 30.0, "output.tau": -40.0})
    assert found["rotor.w"] == pytest.approx((30.0 + 40.0 / 2) / (0.2 + 3.0 / 2**2), rel=1e-10)
    assert found["mill.w"] == pytest.approx(-10.0, rel=1e-14)
    one = gearbox(0.0, "rotor", J_1=0.2 + 3.0 / 4)
    assert one.joined == ()
    same = rates(one, {"rotor.w": 20.0, "oil.T": 330.0}, {"input.tau": 30.0, "output.tau": -40.0})
    assert found["rotor.w"] == pytest.approx(same["rotor.w"], rel=1e-10)


def test_what_was_joined_stays_visible_and_says_so() -> None:
    flat = gearbox(1.0, "rotor", "mill")
    told = flat.quantity("mill.w")
    assert flat.locate("mill.w")[0] == "output"
    assert told.doc == "angular velocity; mill.w follows rotor.w"
    assert told.unit == "rad/s"
    with pytest.raises(ScenarioError, match=r"mill\.w is an output .*mill\.w follows rotor\.w"):
        simulate(flat, join_phases([(1.0, {"input.tau": 1.0})]), start={"mill.w": 1.0})


def test_a_lossy_run_of_two_inertias_conserves_energy() -> None:
    flat = gearbox(1.0, "rotor", "mill")
    run = simulate(
        flat, join_phases([(5.0, {"input.tau": 50.0, "output.tau": 20.0})]), start={"rotor.w": 30.0}, times=range(6)
    )
    assert run["mill.w"] == pytest.approx(-run["rotor.w"] / 2, rel=1e-12)
    assert run["rotor.w"][-1] > run["rotor.w"][0]
    assert run.audit.residual < 1e-6


def test_a_steady_state_of_two_inertias() -> None:
    end, fan = part("ShaftEnd", "drive", given=("tau",)), part("FanLoad", "fan", k=0.1)
    rotors = part("Inertia", "one", J=1.0, w=3.0), part("Inertia", "two", J=2.0)
    flat = flatten(
        Assembly("fan", "", (end, *rotors, fan), (("drive.flange", "one.flange", "two.flange", "fan.flange"),))
    )
    found = steady(flat, {"drive.tau": 40.0})
    assert found["one.w"] == pytest.approx([20.0], rel=1e-6)
    assert found["two.w"] == pytest.approx([20.0], rel=1e-6)


def test_capacities_at_one_place_add_up() -> None:
    names = ("oil", "wall", "cover")
    parts = [Body(name, C=C) for name, C in zip(names, (100.0, 200.0, 400.0), strict=True)]
    parts += [Conductor("foot", G=7.0), Ambient("room")]
    nets = [("oil.heat", "wall.heat", "cover.heat", "foot.a"), ("foot.b", "room.heat")]
    flat = model(*parts, nets=nets)
    assert [q.name for q in flat.states] == ["oil.T"]
    assert sorted(flat.joined) == ["cover.T follows oil.T", "wall.T follows oil.T"]
    found = rates(flat, {"oil.T": 350.0}, {"room.T": 300.0, "wall.Q": 14.0})
    assert found["oil.T"] == pytest.approx((14.0 - 7.0 * 50.0) / 700.0, rel=1e-10)
    assert found["cover.T"] == 350.0


def planetary(*order: str) -> FlatModel:
    """Sun, carrier and ring, each with an inertia and a given torque; nothing is lost."""
    parts = [part("PlanetarySet", "set", **SET, k_mu=0.0)]
    nets = [("set.gears", "oil.heat"), ("set.lubricant", "oil.lubricant"), ("set.reading", "carrier.reading")]
    for name in order:
        parts += [part("ShaftEnd", name, given=("tau",)), part("Inertia", f"J_{name}", J=INERTIA[name])]
        nets += [(f"set.{name}", f"{name}.flange", f"J_{name}.flange")]
    parts += [part("OilBath", "oil", **OIL, V=1e-3, c_p=2000.0)]
    return flatten(Assembly("planetary", "", tuple(parts), tuple(nets)))


INERTIA = {"sun": 0.02, "carrier": 0.7, "ring": 0.3}


@pytest.mark.parametrize("order", list(permutations(INERTIA)), ids=" ".join)
def test_three_inertias_on_a_planetary_set_are_two(order: tuple[str, ...]) -> None:
    flat = planetary(*order)
    speeds = [q.name for q in flat.states if q.unit == "rad/s"]
    assert len(speeds) == 2
    assert flat.joined == (f"J_{order[2]}.w follows J_{order[0]}.w and J_{order[1]}.w",)
    i_0, T = 108.0 / 36.0, {"sun": 3.0, "carrier": -20.0, "ring": 11.0}
    share = {"sun": 1.0, "carrier": -(1 + i_0), "ring": i_0}  # of the torque that the set passes, and of the speeds
    passed = sum(share[k] * T[k] / INERTIA[k] for k in T) / sum(share[k] ** 2 / INERTIA[k] for k in T)
    expected = {k: (T[k] - share[k] * passed) / INERTIA[k] for k in T}
    w = {"sun": 50.0, "carrier": 20.0}
    w["ring"] = ((1 + i_0) * w["carrier"] - w["sun"]) / i_0
    states = {f"J_{k}.w": w[k] for k in w} | {"oil.T": 340.0}
    found = rates(flat, states, {f"{k}.tau": T[k] for k in T})
    for name in speeds:
        assert found[name] == pytest.approx(expected[name[2:-2]], rel=1e-10)
    assert found[f"J_{order[2]}.w"] == pytest.approx(w[order[2]], rel=1e-12)


def test_a_flywheel_at_a_given_speed_is_refused() -> None:
    with pytest.raises(StructureError, match=r"rotor\.w is a state, but tied rigidly to drive\.w, which is given"):
        model(Speed("drive"), Flywheel("rotor", J=1.0), nets=[("drive.shaft", "rotor.shaft")])


def test_the_state_whose_start_is_given_stays() -> None:
    nets = [("oil.heat", "wall.heat")]
    flat = model(Body("oil", C=1.0), Body("wall", C=2.0, T=350.0), nets=nets)
    assert [(q.name, q.start) for q in flat.states] == [("wall.T", 350.0)]
    both = model(Body("oil", C=1.0, T=350.0), Body("wall", C=2.0, T=350.0), nets=nets)
    assert [(q.name, q.start) for q in both.states] == [("oil.T", 350.0)]


def test_starts_that_contradict_each_other_are_refused() -> None:
    with pytest.raises(StructureError, match=r"wall\.T starts at 360 K, .*oil\.T = 350: that is 350 K") as caught:
        model(Body("oil", C=1.0, T=350.0), Body("wall", C=2.0, T=360.0), nets=[("oil.heat", "wall.heat")])
    assert "Give one of these starts only" in str(caught.value)
