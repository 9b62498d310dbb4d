"""Cycloidal reducers alone: both directions of power, friction between its ends, geometry that is refused by name."""

import math
from itertools import pairwise

import pytest
from gearheat.model.core.connect import Assembly
from gearheat.model.core.flatten import flatten
from gearheat.model.errors import ScenarioError
from gearheat.model.laws.oil import density, kinematic_viscosity
from gearheat.model.parts import PARTS
from gearheat.model.run.rows import evaluate_at
from gearheat.scenarios.load import load

VALUES = {name: dict(load(name).spec.part("reducer").values) for name in ("cycloidal", "cycloidal_printed")}
KINDS = {"cycloidal": "CycloidalReducer", "cycloidal_printed": "MalhotraReducer"}


def reducer(rig: str, **values: float):
    return PARTS[KINDS[rig]]("reducer", **VALUES[rig] | values)


@pytest.fixture(scope="module")
def models() -> dict:
    """Each reducer with its oil between two shaft ends, by what is given at them."""
    found = {}
    for rig in VALUES:
        oil = PARTS["OilBath"]("oil", **load(rig).spec.part("oil").values)
        nets = [("input.flange", "reducer.input"), ("output.flange", "reducer.output"), ("oil.heat", "reducer.heat")]
        nets += [("oil.lubricant", "reducer.lubricant")] if rig == "cycloidal" else []
        for given in ("across", "input"):
            at_input, at_output = (("w",), ("tau",)) if given == "across" else (("w", "tau"), ())
            ends = PARTS["ShaftEnd"]("input", given=at_input), PARTS["ShaftEnd"]("output", given=at_output)
            found[rig, given] = flatten(Assembly(rig, "", (*ends, reducer(rig), oil), tuple(nets)))
    return found


def outputs(flat, T: float = 353.15, **inputs: float) -> dict[str, float]:
    u = [{k.replace("_", ".", 1): v for k, v in inputs.items()}.get(q.name, q.start) for q in flat.inputs]
    y = evaluate_at(flat, [T for _ in flat.states], u, flat.starts("parameter"))["y"]
    return dict(zip([q.name for q in flat.outputs], map(float, y), strict=True)) | dict(
        zip([q.name for q in flat.inputs], u, strict=True)
    )


def efficiency(y: dict[str, float]) -> float:
    powers = sorted((y["input.w"] * y["input.tau"], y["output.w"] * y["output.tau"]))
    return -powers[0] / powers[1]


W = 1420 * math.pi / 30


@pytest.mark.parametrize("rig", VALUES)
@pytest.mark.parametrize("w", [W, -W, 0.2 * W])
@pytest.mark.parametrize("tau", [-332.0, 332.0, -1.0, 1.0, -1e-3])
def test_power_goes_either_way(models: dict, rig: str, w: float, tau: float) -> None:
    """Loss in both directions, an efficiency between 0 and 1, and the same state found from the other shaft."""
    y = outputs(models[rig, "across"], input_w=w, output_tau=tau)
    assert y["output.w"] == pytest.approx(w / 13, rel=1e-12)
    assert y["reducer.P_loss"] > 0
    assert 0 < efficiency(y) < 1
    assert y["input.w"] * y["input.tau"] + y["output.w"] * tau == pytest.approx(y["reducer.P_loss"], rel=1e-9)
    back = outputs(models[rig, "input"], input_w=w, input_tau=y["input.tau"])
    assert back["output.tau"] == pytest.approx(tau, rel=1e-6)


@pytest.mark.parametrize("rig", VALUES)
def test_without_load_there_is_no_loss_and_at_rest_it_holds(models: dict, rig: str) -> None:
    y = outputs(models[rig, "across"], input_w=W, output_tau=0.0)
    assert y["reducer.P_loss"] == 0.0 and y["input.tau"] == 0.0
    y = outputs(models[rig, "across"], input_w=0.0, output_tau=-332.0)
    assert y["reducer.P_loss"] == 0.0
    assert y["input.tau"] == pytest.approx(332 / 13, rel=1e-12)


@pytest.mark.parametrize("rig", VALUES)
def test_loss_is_smooth_where_the_power_turns(models: dict, rig: str) -> None:
    """Through zero torque and through rest the loss has no jump: finer steps, smaller differences."""
    flat = models[rig, "across"]
    for key, size in (("output_tau", 1e-3), ("input_w", 1e-3)):
        for n in (10, 40):
            at = [size * (2 * i / n - 1) for i in range(n + 1)]
            loss = [outputs(flat, **{"input_w": W, "output_tau": -332.0, key: value})["reducer.P_loss"] for value in at]
            jump = max(abs(b - a) for a, b in pairwise(loss))
            assert jump <= 2.5 / n * max(loss), (key, n)


def test_printed_efficiency_is_the_same_whichever_drives(models: dict) -> None:
    """1 - eta is the sum of the loss torques over the input torque at the rated point, at any load and speed."""
    flat = models["cycloidal_printed", "across"]
    y = outputs(flat, input_w=W, output_tau=-332.0)
    torques = sum(y[f"reducer.tau_loss_{i}"] for i in (1, 2, 3))
    eta = 1 - torques * W / 4000
    for w, tau in ((W, -332.0), (0.1 * W, -20.0), (W, 332.0), (-W, 50.0)):
        assert efficiency(outputs(flat, input_w=w, output_tau=tau)) == pytest.approx(eta, rel=1e-8)


def test_physical_powers_are_those_of_all_contacts(models: dict) -> None:
    """P_1 to P_3 written out, with both discs and the friction of the moment."""
    y = outputs(models["cycloidal", "across"], input_w=W, output_tau=-332.0)
    crank, w_out, mu = W + W / 13, W / 13, y["reducer.mu_s"]
    assert y["reducer.P_loss_bearing"] == pytest.approx(2 * 0.005 * y["reducer.F_E"] * 0.01875 * crank)
    assert y["reducer.P_loss_output"] == pytest.approx(2 * y["reducer.F_K"] * 0.004 * crank * (0.0045 + mu * 7 / 14))
    assert y["reducer.P_loss_ring"] == pytest.approx(2 * y["reducer.F_N"] * 0.079 * w_out * (0.0045 + mu * 8 / 14))
    kinds = ("bearing", "output", "ring")
    assert sum(y[f"reducer.P_loss_{kind}"] for kind in kinds) == pytest.approx(y["reducer.P_loss"], rel=1e-12)


def test_sliding_friction_is_the_printed_one_at_80_degC(models: dict) -> None:
    """The calibration: 0.05 at 80 degC, rated speed and torque; the efficiency there is 0.873."""
    y = outputs(models["cycloidal", "across"], input_w=W, output_tau=-332.0)
    assert y["reducer.mu_s"] == pytest.approx(0.05, abs=1e-5)
    assert efficiency(y) == pytest.approx(0.873, abs=5e-4)
    values = load("cycloidal").spec.part("oil").values
    nu = kinematic_viscosity(353.15, values["nu_40"], values["nu_100"])
    assert VALUES["cycloidal"]["eta_ref"] == pytest.approx(
        float(nu * density(353.15, values["rho_15"], values["alpha_T"])), rel=1e-3
    )


def test_friction_stays_between_its_ends_and_falls_with_the_film(models: dict) -> None:
    """From 150 to -40 degC, slow and fast: thicker oil, less friction, never less than that of a film."""
    for w, tau in ((W, -332.0), (2 * W, -33.0), (0.01 * W, -500.0), (0.0, -332.0)):
        mu = [
            outputs(models["cycloidal", "across"], T=273.15 + T, input_w=w, output_tau=tau)["reducer.mu_s"]
            for T in range(150, -41, -10)
        ]
        assert all(0.02 <= value <= 0.1 for value in mu)
        assert all(b <= a for a, b in pairwise(mu))
    assert mu[0] == 0.1  # at rest there is no film


@pytest.mark.parametrize(
    ("rig", "values", "words"),
    [
        ("cycloidal_printed", {"eta": 1.2}, "eta = 1.2 is out of range"),
        ("cycloidal_printed", {"eta": -0.1}, "eta = -0.1 is out of range"),
        ("cycloidal_printed", {"P_rated": 100.0}, "eta can be derived"),
        ("cycloidal", {"z_2": 2.0, "z_1": 1.0}, "z_2 = 2 is out of range. It must be at least 3"),
        ("cycloidal", {"z_2": 14.5, "z_1": 13.5}, "z_2 is whole"),
        ("cycloidal", {"u": 8.5}, "u is whole"),
        ("cycloidal", {"z_1": 12.0}, "z_2 is z_1 + 1"),
        ("cycloidal", {"e": 0.0065}, "e leaves the disc without cusps"),
        ("cycloidal", {"e": 0.006}, "the pins do not undercut the disc"),
        ("cycloidal", {"D_0": 0.039}, "neighbouring pins do not touch"),
        ("cycloidal", {"R_0": 0.0475 / 2}, "the holes lie outside the bearing"),
        ("cycloidal", {"R_0": 0.07}, "the holes lie within the disc"),
        ("cycloidal", {"d_0": 0.015}, "d_0 is below D_0"),
        ("cycloidal", {"mu_bl": 0.04}, "mu_ref is mixed friction"),
        ("cycloidal", {"mu_r1": 0.2}, "no self-locking"),
    ],
    ids=str,
)
def test_bad_values_are_refused_by_name(rig: str, values: dict, words: str) -> None:
    with pytest.raises(ScenarioError) as refused:
        reducer(rig, **values)
    assert words in str(refused.value)


def test_a_wall_as_thick_as_the_housing_is_refused() -> None:
    values = load("cycloidal").spec.part("housing").values
    with pytest.raises(ScenarioError, match="d leaves room inside"):
        PARTS["RoundHousing"]("housing", **values | {"d": 0.11})
