"""Results: columns, readings between rows, the audit's measure."""

import numpy as np
import pytest
from gearheat.model.errors import ScenarioError
from gearheat.model.run.result import Audit, Result


def result() -> Result:
    columns = {"oil.T": np.array([300.0, 310.0, 305.0])}
    return Result("m", "transient", np.array([0.0, 60.0, 120.0]), columns, {"oil.T": "K"}, Audit(1.0, 1.0, 2.0))


def test_reading_between_rows() -> None:
    assert result().at(90.0) == {"oil.T": 307.5}


def test_unknown_columns() -> None:
    with pytest.raises(ScenarioError, match=r'no "oil.t". Did you mean "oil.T"'):
        result()["oil.t"]


@pytest.mark.parametrize(
    ("audit", "residual"),
    [
        (Audit(10.0, 9.0, 100.0), 0.01),
        (Audit(10.0, 9.0, 100.0, held=1e3), 0.01),
        (Audit(0.0, 1.0, 0.0, held=1e6), 1e-3),  # closed: relative to a thousandth of what it holds
        (Audit(1e-9, 0.0, 0.0), 1e-6),  # at rest: relative to a milliwatt
    ],
)
def test_residual_of_the_audit(audit: Audit, residual: float) -> None:
    assert audit.residual == pytest.approx(residual)
