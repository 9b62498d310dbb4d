"""Losses that change the torque they depend on: solved inside the model, with what they leave kept in sight."""

import casadi as ca
import numpy as np
import pytest
from gearheat.model.core.flat import FlatModel
from scipy.optimize import brentq
from small_parts import gear


def at(flat: FlatModel, w: float, tau: float) -> tuple[dict[str, float], np.ndarray]:
    u = flat.starts("input")
    for name, value in (("drive.w", w), ("load.tau", tau)):
        u[flat.locate(name)[1]] = value
    values = flat.output_function(flat.starts("state"), u, flat.starts("parameter"))
    y = dict(zip([q.name for q in flat.outputs], np.array(values[0])[:, 0], strict=True))
    return y, np.array(values[1])[:, 0]


def loss_by_bisection(mu: float, w: float, tau: float, ratio: float = 3.0) -> float:
    """The loss torque of the gear from its equations by hand: tau at b is the load's, force the mean of both sides."""
    direction = w / np.sqrt(w**2 + 1e-4)

    def miss(tau_loss: float) -> float:
        tau_b = tau / ratio  # the load acts on b, so the gear feels it
        tau_a = tau_loss * direction - tau_b
        force = (tau_a - tau_b) / 2
        return tau_loss - mu * np.sqrt(force**2 + 1e-4) ** 0.8

    return brentq(miss, -1.0, 100.0, xtol=1e-14)


@pytest.mark.parametrize("mu", [0.0, 0.02, 0.1, 0.3])
@pytest.mark.parametrize(("w", "tau"), [(100.0, -30.0), (100.0, 30.0), (-50.0, -30.0), (100.0, -600.0), (0.5, 3.0)])
def test_loss_against_bisection(mu: float, w: float, tau: float) -> None:
    y, _ = at(gear(mu), w, tau)
    expected = loss_by_bisection(mu, w, tau)
    assert y["gear.P_loss"] == pytest.approx(expected * w**2 / np.sqrt(w**2 + 1e-4), rel=1e-7, abs=1e-9)


@pytest.mark.parametrize(("w", "tau"), [(100.0, -30.0), (0.0, -30.0), (100.0, 0.0), (0.0, 0.0), (-100.0, 500.0)])
def test_residual_is_small_and_named(w: float, tau: float) -> None:
    flat = gear(0.1)
    y, residual = at(flat, w, tau)
    assert flat.residual_names == ("gear: loss",)
    assert np.abs(residual).max() < 1e-8
    assert np.isfinite(list(y.values())).all()


def test_residual_tells_what_the_steps_left() -> None:
    """A loss twice the load is far from the loss-free start: what is wrong with it must show, and in size."""
    flat = gear(2.0)
    y, residual = at(flat, 100.0, -30.0)
    wrong = abs(y["gear.P_loss"] / 100.0 - loss_by_bisection(2.0, 100.0, -30.0))
    left = 10.0 * np.abs(residual).max()  # in N.m
    assert wrong > 1e-9
    assert 0.5 * left < wrong < 4 * left


def test_derivative_of_an_implicit_loss() -> None:
    flat = gear(0.1)
    h = 1e-4
    slope = (at(flat, 100.0, -30.0 + h)[0]["drive.tau"] - at(flat, 100.0, -30.0 - h)[0]["drive.tau"]) / (2 * h)
    i, j = flat.locate("drive.tau")[1], flat.locate("load.tau")[1]
    jacobian = ca.Function("j", [flat.x, flat.u, flat.p], [ca.jacobian(flat.y[i], flat.u[j])])
    u = flat.starts("input")
    u[flat.locate("drive.w")[1]], u[j] = 100.0, -30.0
    assert float(jacobian(flat.starts("state"), u, flat.starts("parameter"))) == pytest.approx(slope, rel=1e-6)
