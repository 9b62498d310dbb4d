"""The planetary gearbox as a whole: torques, power flow, both directions, every way of driving it."""

import math

import numpy as np
import pytest
from gearheat.model.errors import StructureError
from gearheat.model.run.rows import evaluate_at
from gearheat.scenarios.load import load
from hypothesis import given, settings, strategies as st

SPEC = load("planetary").spec
DRIVES = {
    "carrier": {"carrier": ("w", "tau")},
    "sun": {"sun": ("w", "tau")},
    "across": {"carrier": ("w",), "sun": ("tau",)},
    "torques": {"carrier": ("tau",), "sun": ("tau",)},
}
RPM = math.pi / 30
PARTS = ("gear_set.P_loss_sp", "gear_set.P_loss_pr", "carrier_bearing.P_loss", "sun_bearing.P_loss")
PARTS += ("planet_bearing.P_loss", "carrier_seal.P_loss", "sun_seal.P_loss", "churning.P_loss")
_flat: dict = {}


def flat_of(drive: str, power_flow: str = "successive"):
    if (drive, power_flow) not in _flat:
        spec = SPEC.with_values({"gear_set.power_flow": power_flow}).driven(DRIVES[drive])
        _flat[drive, power_flow] = spec.flat()
    return _flat[drive, power_flow]


def outputs(flat, T=350.0, w=None, parameters=None, **given_values) -> dict[str, float]:
    """Outputs at one temperature of all nodes and rotor speed w; shaft values as carrier_w=..."""
    values = {name.replace("_", ".", 1): value for name, value in given_values.items()}
    x = [T if q.unit == "K" else w for q in flat.states]
    u = [values.get(q.name, q.start) for q in flat.inputs]
    p = [(parameters or {}).get(q.name, q.start) for q in flat.parameters]
    found = evaluate_at(flat, x, u, p)
    assert np.abs(found["residual"]).max(initial=0.0) < 1e-9
    return dict(zip([q.name for q in flat.outputs], map(float, found["y"]), strict=True)) | values


@pytest.mark.parametrize("power_flow", ["successive", "ideal"])
@pytest.mark.parametrize("drive", ["carrier", "sun", "across"])
@settings(max_examples=25, deadline=None)
@given(w=st.floats(-60, 60), tau=st.floats(-3000, 3000), T=st.floats(270, 390))
def test_losses_are_power_in_less_power_out(drive: str, power_flow: str, w: float, tau: float, T: float) -> None:
    flat = flat_of(drive, power_flow)
    if power_flow == "ideal":  # meant for loads as in the source's campaign, not for a carrier without torque
        tau = math.copysign(max(abs(tau), 200.0), tau)
    names = {q.name: (w if q.name.endswith(".w") else tau) for q in flat.inputs if q.name.endswith((".w", ".tau"))}
    y = outputs(flat, T, **{k.replace(".", "_"): v for k, v in names.items()})
    parts = [y[name] for name in PARTS]
    throughput = max(abs(y["carrier.P"]), abs(y["sun.P"]), 1.0)
    assert abs(y["carrier.P"] + y["sun.P"] - sum(parts)) <= 1e-9 * throughput
    assert y["efficiency.P_loss"] == pytest.approx(sum(parts), abs=1e-9 * throughput)
    assert min(parts) >= 0.0
    assert y["sun.w"] == pytest.approx(4 * y["carrier.w"], rel=1e-12)


def test_torques_without_losses_are_as_the_teeth() -> None:
    nothing = {
        q.name: 0.0 for q in flat_of("carrier").parameters if q.name.rpartition(".")[2] in ("H_v_sp", "H_v_pr", "count")
    }
    y = outputs(flat_of("carrier"), carrier_w=26.0, carrier_tau=2500.0, parameters=nothing)
    assert y["sun.tau"] == pytest.approx(-2500.0 / 4, rel=1e-9)


@pytest.mark.parametrize("tau", [1549.5, 2709.3])
def test_ideal_power_flow_knows_no_direction(tau: float) -> None:
    flat = flat_of("carrier", "ideal")
    forward, back = (outputs(flat, carrier_w=26.2, carrier_tau=sign * tau) for sign in (1, -1))
    for name in PARTS:
        assert forward[name] == pytest.approx(back[name], rel=1e-9)


@pytest.mark.parametrize("tau", [1549.5, 2709.3])
def test_successive_power_flow_separates_multiplier_and_reducer(tau: float) -> None:
    """At the same torque of the carrier, the multiplier's meshes carry less than that, the reducer's carry more."""
    multiplier, reducer = (outputs(flat_of("carrier"), carrier_w=26.2, carrier_tau=sign * tau) for sign in (1, -1))
    ideal = outputs(flat_of("carrier", "ideal"), carrier_w=26.2, carrier_tau=tau)
    for name in ("gear_set.F_t_sp", "gear_set.F_t_pr", "gear_set.P_loss_sp", "gear_set.P_loss_pr"):
        assert multiplier[name] < ideal[name] < reducer[name]
    assert ideal["efficiency.P_loss"] == pytest.approx(multiplier["efficiency.P_loss"], rel=0.02)


@pytest.mark.parametrize(("w", "tau"), [(26.2, 2500.0), (26.2, -2500.0), (-10.5, 1600.0), (26.2, 5.0)])
def test_every_drive_gives_the_same_point(w: float, tau: float) -> None:
    at_carrier = outputs(flat_of("carrier"), carrier_w=w, carrier_tau=tau)
    at_sun = outputs(flat_of("sun"), sun_w=at_carrier["sun.w"], sun_tau=at_carrier["sun.tau"])
    across = outputs(flat_of("across"), carrier_w=w, sun_tau=at_carrier["sun.tau"])
    torques = outputs(flat_of("torques"), w=4 * w, carrier_tau=tau, sun_tau=at_carrier["sun.tau"])
    for name in (*PARTS, "carrier.tau", "efficiency.eta"):
        for other in (at_sun, across, torques):
            assert other[name] == pytest.approx(at_carrier[name], rel=1e-6, abs=1e-6)


def test_rotor_accelerates_by_what_is_left() -> None:
    flat = flat_of("torques")
    balanced = outputs(flat_of("carrier"), carrier_w=26.2, carrier_tau=2500.0)
    J = next(q.start for q in flat.parameters if q.name == "rotor.J")
    x = [350.0 if q.unit == "K" else 4 * 26.2 for q in flat.states]
    u = [{"carrier.tau": 2500.0, "sun.tau": balanced["sun.tau"] + 1.0}.get(q.name, q.start) for q in flat.inputs]
    rates = evaluate_at(flat, x, u, flat.starts("parameter"))["ode"]
    assert rates[[q.name for q in flat.states].index("rotor.w")] == pytest.approx(1.0 / J, rel=0.02)


def test_two_speeds_at_once_are_refused() -> None:
    with pytest.raises(StructureError, match=r"Too much is said in .*speed of the shaft"):
        SPEC.driven({"carrier": ("w",), "sun": ("w",)}).flat()


def test_nothing_given_is_refused() -> None:
    with pytest.raises(StructureError, match="Nothing determines"):
        SPEC.driven({"carrier": ("w",)}).flat()


@pytest.mark.parametrize("speed", [0.0, 1e-6, -26.2])
def test_finite_at_rest_and_without_load(speed: float) -> None:
    for tau in (0.0, 1e-9):
        y = outputs(flat_of("carrier"), carrier_w=speed, carrier_tau=tau)
        assert all(math.isfinite(v) for v in y.values())
