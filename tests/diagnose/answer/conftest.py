"""A small campaign of a helical gearbox as its model gives it, with noise, and with an oil thermometer that is off."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from gearheat.model.parts import PARTS
from gearheat.model.parts.free_form import EXTRA_PARTS
from gearheat.scenarios.load import load
from gearheat.scenarios.measured.card import Card
from gearheat.scenarios.measured.table import Campaign
from gearheat.tools.diagnose.answer.experiments import planned_campaign
from gearheat.tools.diagnose.infer.found import Found
from gearheat.tools.diagnose.infer.weigh import weigh
from gearheat.tools.diagnose.setting import Setting, setting

#: What may be wrong in these tests, and by how much the oil thermometer is.
CAUSES = ("sensor.oil_temp.offset", "cooling.air", "losses.churning", "sensor.oil_temp.drift")
OFFSET = 3.0


def noisy(campaign: Campaign, offset: float, seed: int) -> Campaign:
    """Readings with the scatter that their sensors state, the oil's off by something [K]."""
    rng = np.random.default_rng(seed)
    values = {
        s.name: campaign.values[s.name] + rng.normal(0.0, s.repeat_sd, campaign.n) * (s.role == "read")
        for s in campaign.sensors
    }
    oil = next(s.name for s in campaign.sensors if s.kind == "oil_temp")
    return replace(campaign, values=values | {oil: values[oil] + offset})


def _made(offset: float) -> tuple[Setting, Found]:
    scenario, card = load("helical_two_stage", PARTS | EXTRA_PARTS), Card()
    made = setting(scenario, card, noisy(planned_campaign(scenario, card, None), offset, 3))
    formulas = [f for f in made.formulas if f.cause.id in CAUSES and f.form.name == ""]
    return made, weigh(made.problem, formulas)


@pytest.fixture(scope="session")
def wrong() -> tuple[Setting, Found]:
    """A search in data whose oil thermometer is off."""
    return _made(OFFSET)


@pytest.fixture(scope="session")
def clean() -> tuple[Setting, Found]:
    """A search in data with nothing but noise."""
    return _made(0.0)
