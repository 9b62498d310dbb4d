"""Every command reads a rig with the fit terms of a diagnosis; the floors below know nothing of them."""

import dataclasses
import json
from pathlib import Path

import pytest
from gearheat.model.errors import ScenarioError
from gearheat.model.machines.spec import PartSpec
from gearheat.model.parts import PARTS
from gearheat.model.parts.free_form import EXTRA_PARTS
from gearheat.scenarios import load as rig_files
from gearheat.scenarios.load import load
from gearheat.scenarios.write import rig_text
from gearheat.tools.solve.settings import adjust, flat_of

#: 40 W at 20 rad/s, everywhere.
VALUES = {"P_ref": 40.0, "w_ref": 20.0, "tau_ref": 1500.0, "a": 1.0, "c": 0.0, "forward": 1.0, "backward": 1.0}
VALUES |= {"oil_share": 0.5, "inner_share": 0.5}
REGIME = {f"{q}_{key}": -1e9 if key == "on" else 1.0 for q in ("w", "tau", "T") for key in ("on", "side", "width")}
NETS = (
    ("oil.heat", "extra_churning.oil"),
    ("oil.heat", "extra_churning.inner"),
    ("wall.heat", "extra_churning.outer"),
    ("carrier.reading", "extra_churning.reading"),
)


@pytest.fixture
def extended(tmp_path: Path) -> Path:
    """The planetary rig with 40 W of a cause in it, as a file."""
    scenario = load("planetary")
    spec = scenario.spec.with_parts([PartSpec("extra_churning", "ExtraHeat", VALUES | REGIME)], NETS)
    (path := tmp_path / "extended.toml").write_text(rig_text(dataclasses.replace(scenario, spec=spec)), "utf-8")
    return path


def test_the_physics_knows_no_fit_terms(extended: Path) -> None:
    assert not PARTS.keys() & EXTRA_PARTS.keys()
    with pytest.raises(ScenarioError, match='no part type "ExtraHeat"'):
        rig_files.load(extended, PARTS)


def test_a_rig_with_fit_terms_loads_and_can_be_set(extended: Path) -> None:
    scenario = adjust(load(extended), ["extra_churning.P_ref=30 W"])
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
