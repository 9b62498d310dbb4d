"""Every command reads a rig with the fit terms of a diagnosis; the floors below know nothing of them."""

import dataclasses
import json
from pathlib import Path

import pytest
from gearheat.model.errors import ScenarioError
from gearheat.model.parts import PARTS
from gearheat.scenarios import load as rig_files
from gearheat.scenarios.write import rig_text
from gearheat.tools.effects.parts import FIT_PARTS
from gearheat.tools.effects.taxonomy import CAUSES
from gearheat.tools.rigs import load
from gearheat.tools.settings import adjusted, flat_of

CAUSE = CAUSES["losses.churning"]


@pytest.fixture
def extended(tmp_path: Path) -> Path:
    """The planetary rig with 40 W of a cause in it, as a file."""
    scenario = load("planetary")
    theta = {CAUSE.size.name: 40.0} | CAUSE.forms(CAUSE.sample(1, 1)[0])[0]
    spec = CAUSE.added_to(scenario.spec, theta)
    (path := tmp_path / "extended.toml").write_text(rig_text(dataclasses.replace(scenario, spec=spec)), "utf-8")
    return path


def test_the_physics_knows_no_fit_terms(extended: Path) -> None:
    assert not PARTS.keys() & FIT_PARTS.keys()
    with pytest.raises(ScenarioError, match='no part type "ExtraLoss"'):
        rig_files.load(extended)


def test_a_rig_with_fit_terms_loads_and_can_be_set(extended: Path) -> None:
    scenario = adjusted(load(extended), ["extra_churning.P_ref=30 W"])
    assert scenario.spec.part("extra_churning").values["P_ref"] == 30.0
    assert "extra_churning.P" in flat_of(scenario).index


@pytest.mark.parametrize(
    "arguments", [("show",), ("steady",), ("design", "--free", "cooling.A", "--target", "oil.T=70 degC")]
)
def test_commands_read_a_rig_with_fit_terms(gearheat, extended: Path, arguments: tuple[str, ...]) -> None:
    command, *options = arguments
    answer = gearheat(command, str(extended), *options, "--json", "-")
    assert answer.code == 0, answer.err
    assert "extra_churning.P" in json.dumps(answer.json)
