"""Implicit equations without a solution: every call that needs one says which equation, and changes nothing."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gearheat.fmu.batch import Batch, Status
from gearheat.fmu.export import export
from gearheat.model.core.flat import FlatModel
from gearheat.model.errors import SolveError
from gearheat.model.run.design import design
from gearheat.model.run.schedule import join_phases
from gearheat.model.run.simulate import simulate
from gearheat.model.run.steady import steady
from gearheat.scenarios.load import load

#: A friction at which the mesh locks itself.
LOCKED = 300.0
EQUATION = "stage_1: mesh loss"


@pytest.fixture(scope="module")
def flat() -> FlatModel:
    return load("helical_two_stage").spec.flat()


@pytest.fixture
def one(flat: FlatModel, tmp_path: Path, opened: Callable[..., Any]) -> Any:
    return opened(export(flat, tmp_path / "m.fmu"))


def test_runs_name_the_equation(flat: FlatModel) -> None:
    values = {"stage_1.k_mu": LOCKED}
    with pytest.raises(SolveError, match=f'"{EQUATION}" has no solution'):
        steady(flat, values)
    with pytest.raises(SolveError, match=f'simulate: at 0 s the equation "{EQUATION}" has no solution'):
        simulate(flat, join_phases([(60.0, {})]), values=values)
    with pytest.raises(SolveError):
        design(flat, ["cooling.A"], {"oil.T": 330.0}, values)


def test_rows_that_lock_say_so(flat: FlatModel) -> None:
    batch = Batch(flat)
    rows = batch.warmup(join_phases([(60.0, {})]), *batch.vectors({"stage_1.k_mu": np.array([1.0, LOCKED])}))
    assert rows.status.tolist() == [Status.OK, Status.NO_SOLUTION]
    rows = batch.steady(*batch.vectors({"stage_1.k_mu": np.array([1.0, LOCKED])}))
    assert rows.status.tolist() == [Status.OK, Status.NO_SOLUTION]


def test_the_fmu_does_not_start(one: Any) -> None:
    status, text = one.refused(lambda: one.start(stage_1__k_mu=LOCKED))
    assert status == 3 and f'"{EQUATION}" has no solution' in text


def test_the_fmu_refuses_the_step_and_is_as_before(one: Any) -> None:
    one.start()
    one.fmu.doStep(0.0, 60.0)
    before, free = one.get("oil.T", "stage_1.tau_loss"), one.get("stage_1.k_mu")[0]
    one.set(stage_1__k_mu=LOCKED)
    status, text = one.refused(lambda: one.fmu.doStep(60.0, 60.0))
    assert status == 2 and f'"{EQUATION}" has no solution at its begin' in text
    status, text = one.refused(lambda: one.fmu.doStep(60.0, 60.0))
    assert status == 3 and EQUATION in text  # the same step again
    for call in (
        lambda: one.get("stage_1.tau_loss"),
        lambda: one.fmu.getDirectionalDerivative([one.refs["stage_1.P_loss"]], [one.refs["input.w"]], [1.0]),
    ):
        status, text = one.refused(call)
        assert status == 2 and EQUATION in text
    one.set(stage_1__k_mu=free)
    assert one.get("oil.T", "stage_1.tau_loss") == before
    one.fmu.doStep(60.0, 60.0)
