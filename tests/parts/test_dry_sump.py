"""Jets on gears, lips that rub at their own temperature, and windage in a mist."""

import math

import pytest
from gearheat.model.run.rows import evaluate_at
from gearheat.model.run.steady import steady
from gearheat.scenarios.load import load
from one_part import between_sources, oil_at

T_OIL = 353.15


def shown(flat, **inputs: float) -> dict[str, float]:
    """Outputs at given inputs, by the ends of their names; else oil at 80 degC and nothing that moves."""

    def value(q) -> float:
        named = [v for k, v in inputs.items() if q.name.endswith(k.replace("__", "."))]
        ours = oil_at(T_OIL).get(q.name.split(".")[-1], T_OIL if q.unit == "K" else 0.0)
        return named[0] if named else ours

    y = evaluate_at(flat, [], [value(q) for q in flat.inputs], flat.starts("parameter"))["y"]
    return dict(zip([q.name for q in flat.outputs], y.tolist(), strict=True))


def test_a_lip_warms_by_its_friction_and_rubs_less() -> None:
    flat, by_oil = between_sources("OilLipSeal", warms="lip", h=500.0, k=45.0), between_sources("OilLipSeal")
    found = [shown(flat, shaft__w=w) for w in (0.0, 10.0, 30.0, 100.0, 300.0)]
    lips, torques = ([y[f"part.{k}"] for y in found] for k in ("T_lip", "tau_loss"))
    assert lips == sorted(lips) and lips[0] == pytest.approx(T_OIL, abs=1e-6)
    assert torques == sorted(torques, reverse=True)
    assert torques[0] == pytest.approx(shown(by_oil, shaft__w=0.0)["part.tau_loss"], rel=1e-9)
    G = math.pi / 2 * 0.14 * math.sqrt(500 * 45 * 0.14)
    assert lips[3] - T_OIL == pytest.approx(found[3]["part.P_loss"] / 2 / G, rel=1e-6)  # two of them


def test_a_jet_takes_power_or_gives_it_and_no_more_heat_than_its_oil_can() -> None:
    flat = between_sources("GearJet", along=1.0)
    line = dict(a__p=2e5, a__h=2000.0 * 80, b__h=2000.0 * 80, wall__T=T_OIL + 40)
    fast, slow, back = (shown(flat, shaft__w=w, **line) for w in (1000.0, 50.0, -1000.0))
    m_flow = fast["part.m_flow"]
    v_jet = m_flow / (oil_at(T_OIL)["rho"] * 0.7 * math.pi / 4 * 4e-6)
    assert fast["part.P"] == pytest.approx(m_flow * 80.0 * (80.0 - v_jet), rel=1e-3)
    assert slow["part.P"] < 0 < fast["part.P"] < back["part.P"]
    assert -m_flow * 2000.0 * 40 < fast["part.Q_flow"] < slow["part.Q_flow"] < 0


def test_a_bearing_faster_than_makers_allow_says_so() -> None:
    scenario = load("helical_two_stage")
    flat = scenario.spec.flat()
    fast, slow = (steady(flat, {"input.w": n, "output.tau": -1.0}).outside for n in (2200.0, 150.0))
    assert {o.component for o in fast if o.argument == "w * d_m"} == {"input_bearing_a", "input_bearing_b"}
    assert not [o for o in slow if o.argument == "w * d_m"]
