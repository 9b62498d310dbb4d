"""Rig files of the tests: the shipped ones with a line changed, and what is wrong with them."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from gearheat.model.errors import ScenarioError
from gearheat.scenarios.load import RIGS, load

Problems = Callable[..., tuple[str, ...]]


@pytest.fixture
def problems(tmp_path: Path) -> Problems:
    """Loads a shipped rig with pieces of its text replaced; gives all problems found."""

    def load_changed(*changes: tuple[str, str], rig: str = "planetary") -> tuple[str, ...]:
        text = (RIGS / rig / "rig.toml").read_text(encoding="utf-8")
        for old, new in changes:
            assert old in text, old
            text = text.replace(old, new, 1)
        (tmp_path / "rig.toml").write_text(text, encoding="utf-8")
        shutil.copy(RIGS / "planetary" / "measured.csv", tmp_path)
        with pytest.raises(ScenarioError) as raised:
            load(tmp_path)
        return raised.value.problems

    return load_changed
