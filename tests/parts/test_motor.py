"""A motor whose current tells its torque: both directions, either way of the power, cold and warm windings."""

from functools import cache

import pytest
from gearheat.model.core.connect import Assembly
from gearheat.model.core.flat import FlatModel
from gearheat.model.core.flatten import flatten
from gearheat.model.parts import PARTS
from gearheat.model.run.rows import evaluate_at

K_T, R_20, TAU_C, D = 0.1, 0.5, 0.02, 1e-4


@cache
def flat() -> FlatModel:
    parts = [PARTS["ShaftEnd"]("shaft", given=("w",)), PARTS["ShaftEnd"]("load", given=("tau",))]
    parts += [PARTS["ServoMotor"]("motor", k_T=K_T, R_20=R_20, tau_c=TAU_C, d=D)]
    parts += [PARTS["HeatCapacity"]("windings", C=20.0), PARTS["HeatCapacity"]("stator", C=60.0)]
    nets = [("shaft.flange", "load.flange"), ("shaft.reading", "motor.shaft")]
    nets += [("windings.heat", "motor.windings"), ("stator.heat", "motor.stator")]
    return flatten(Assembly("motor", "", tuple(parts), tuple(nets)))


@pytest.mark.parametrize("w", [-100.0, 100.0])
@pytest.mark.parametrize("tau", [-0.3, 0.3])
@pytest.mark.parametrize("T", [253.15, 293.15, 393.15])
def test_current_pays_for_torque_and_drag_and_heats_warm_windings_more(w: float, tau: float, T: float) -> None:
    model = flat()
    known = {"shaft.w": w, "load.tau": -tau}
    states = [T if q.name == "windings.T" else 300.0 for q in model.states]
    found = evaluate_at(model, states, [known.get(q.name, 0.0) for q in model.inputs], model.starts("parameter"))
    values = dict(zip([q.name for q in model.outputs], found["y"].tolist(), strict=True))
    drag = (TAU_C + D * abs(w)) * (1 if w > 0 else -1)
    current = (tau + drag) / K_T
    assert values["motor.i_q"] == pytest.approx(current, rel=1e-6)
    assert values["motor.P_loss_stator"] == pytest.approx(drag * w, rel=1e-6)
    assert values["motor.P_loss_windings"] == pytest.approx(R_20 * (1 + 0.00393 * (T - 293.15)) * current**2, rel=1e-6)
    assert values["motor.P_electric"] == pytest.approx(w * tau + values["motor.P_loss"], rel=1e-9)
