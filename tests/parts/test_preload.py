"""Bearings set against each other: preload by temperature, loads by preload, friction by loads."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from gearheat.model.core.flat import FlatModel
from gearheat.model.laws.preload import preloaded_axial_load
from gearheat.model.machines.spec import PartSpec
from gearheat.model.run.rows import evaluate_at
from gearheat.model.run.steady import steady
from gearheat.scenarios.load import load
from scipy.optimize import brentq

RIG = "helical_two_stage"
PAIR = {"contact": "balls", "F_set": 500.0, "T_set": 293.15, "k": 5e7, "d_m": 0.0775, "alpha": 0.45}
PAIR |= {"span": 0.2, "alpha_s": 1.2e-5, "alpha_h": 1.2e-5}


@cache
def with_pair(arrangement: str) -> FlatModel:
    """The rig, the bearings of its output shaft set against each other."""
    spec = load(RIG).spec
    apart = {f"output_bearing_{k}.load" for k in "ab"}
    nets = [tuple(port for port in net if port not in apart) for net in spec.connections]
    nets = [(*net, net[0].replace("output_support.load", "pair.support")) if len(net) == 1 else net for net in nets]
    spec = replace(spec, connections=tuple(nets))
    pair = PartSpec("pair", "PreloadedPair", PAIR | {"arrangement": arrangement})
    joined = [(f"pair.{port}_{k}", f"output_bearing_{k}.{port}") for port in ("load", "thrust") for k in "ab"]
    joined += [("pair.inner", "shafts.heat"), ("pair.outer", "wall.heat")]
    return spec.with_parts((pair,), tuple(joined)).flat()


def at(arrangement: str, shafts: float, wall: float, **values: float) -> dict[str, float]:
    """All outputs of the pair and its bearings at 150 rad/s, oil at 60 degC, shafts and wall at temperatures."""
    flat = with_pair(arrangement)
    x = np.array([{"shafts.T": shafts, "wall.T": wall}.get(q.name, 333.15) for q in flat.states])
    u = np.array([{"input.w": 150.0, "output.tau": -590.0, "room.T": 293.15}.get(q.name, 0.0) for q in flat.inputs])
    p = flat.starts("parameter")
    for key, value in values.items():
        p[flat.locate(f"pair.{key}")[1]] = value
    found = evaluate_at(flat, x, u, p)
    assert np.abs(found["imbalance"]).max() <= 1e-9 * float(found["throughput"][0])
    return dict(zip([q.name for q in flat.outputs], found["y"].tolist(), strict=True))


def friction(y: dict[str, float]) -> float:
    return y["output_bearing_a.P_loss"] + y["output_bearing_b.P_loss"]


def test_a_warm_shaft_tightens_face_to_face_and_loosens_a_wide_pair_back_to_back() -> None:
    for arrangement, direction in (("face-to-face", 1), ("back-to-back", -1)):
        cold, warm, hot = (at(arrangement, 333.15 + dT, 333.15) for dT in (0.0, 1.0, 2.0))
        assert cold["pair.F_0"] == pytest.approx(500.0, rel=1e-6)
        assert direction * (warm["pair.F_0"] - cold["pair.F_0"]) > 10.0
        assert direction * (hot["pair.F_0"] - warm["pair.F_0"]) > 10.0
        assert direction * (friction(warm) - friction(cold)) > 0.0
        assert direction * (friction(hot) - friction(warm)) > 0.0


def test_a_housing_of_light_alloy_loosens_a_pair_face_to_face_where_all_is_warm() -> None:
    assert at("face-to-face", 353.15, 353.15, alpha_h=2.3e-5)["pair.F_0"] < 1e-2
    assert at("face-to-face", 243.15, 243.15, alpha_h=2.3e-5)["pair.F_0"] > 5000.0


def test_clearance_leaves_the_loads_of_the_shaft() -> None:
    """No preload: the friction is that of the rig without the pair."""
    loose = at("face-to-face", 293.15, 343.15)
    assert 0.0 <= loose["pair.F_0"] < 1e-2
    flat = load(RIG).spec.flat()
    x = np.array([{"shafts.T": 293.15, "wall.T": 343.15}.get(q.name, 333.15) for q in flat.states])
    u = np.array([{"input.w": 150.0, "output.tau": -590.0, "room.T": 293.15}.get(q.name, 0.0) for q in flat.inputs])
    plain = evaluate_at(flat, x, u, flat.starts("parameter"))["y"]
    assert friction(loose) == pytest.approx(
        friction(dict(zip([q.name for q in flat.outputs], plain, strict=True))), rel=1e-3
    )


def test_it_settles() -> None:
    flat, scenario = with_pair("back-to-back"), load(RIG)
    found = steady(flat, scenario.operating_point)
    assert found.audit.residual < 1e-9
    assert found["pair.F_0"][0] >= 0.0


@pytest.mark.parametrize(("n", "error"), [(1.5, 0.13), (10 / 9, 0.03)])
def test_loads_balance_and_are_close_to_those_of_the_contacts(n: float, error: float) -> None:
    """F_0 (1 + x)^n on one side, F_0 (1 - x)^n on the other until it lifts off; in shares of the preload."""
    for K in np.linspace(0.0, 4.0, 17):
        one, other = preloaded_axial_load(1e3, 1e3 * K, 0.0, n), preloaded_axial_load(1e3, 0.0, 1e3 * K, n)
        assert one - other == pytest.approx(1e3 * K, abs=1.0)
        if 2**n > K:
            x = brentq(lambda x, K=K: (1 + x) ** n - (1 - x) ** n - K, 0.0, 1.0)
            assert abs(other / 1e3 - (1 - x) ** n) < error
        else:
            assert other < 1.0
