"""What instruments show where the truth is known."""

from __future__ import annotations

import numpy as np
import pytest
from gearheat.scenarios.load import load
from gearheat.scenarios.measured.card import Card
from gearheat.tools.diagnose.answer.design import _of_check
from gearheat.tools.diagnose.answer.experiments import BATH, Check, planned_campaign
from gearheat.tools.diagnose.infer.problem import Acting
from gearheat.tools.diagnose.setting import Setting, setting


@pytest.fixture(scope="module")
def made() -> Setting:
    """The measured rig on its grid, with power flowing both ways."""
    scenario, card = load("planetary"), Card()
    return setting(scenario, card, planned_campaign(scenario, card, None))


def effects(made: Setting, cause: str, check: Check) -> np.ndarray:
    """Reading less truth (n,) at the usual size of a cause in the middle of its first form, over that size."""
    formula = next(f for f in made.formulas if f.cause.id == cause)
    found = _of_check(made.problem.data, check, [Acting(formula, np.zeros(formula.size))])
    return np.asarray(found[:, 0] / formula.extent.sd)


def test_a_bath_shows_no_cause_of_the_machine_s_temperatures(made: Setting) -> None:
    """All thermometers are in it, wherever they stand in the machine; nothing flows in either direction."""
    bath = Check("T_oil", BATH, 0.05)
    assert effects(made, "sensor.oil_temp.offset", bath) == pytest.approx(1.0)
    for cause in ("swapped", "position", "by_direction"):
        assert effects(made, f"sensor.oil_temp.{cause}", bath) == pytest.approx(0.0, abs=1e-9), cause


def test_a_thermometer_away_from_the_machine_shows_a_probe_that_the_machine_warms(made: Setting) -> None:
    room = Check("T_amb", (293.0,), 0.3, 0.1)
    assert effects(made, "sensor.ambient.heated", room) == pytest.approx(1.0, rel=0.2)
