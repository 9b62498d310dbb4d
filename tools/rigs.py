"""Rigs as the commands load them: of parts of the physics, and of the fit terms that a diagnosis adds to a rig."""

from __future__ import annotations

from pathlib import Path

from ..diagnose.library.extra_parts import EXTRA_PARTS
from ..model.parts import PARTS
from ..scenarios import load as rig_files
from ..scenarios.scenario import Scenario


def load(name_or_path: str | Path) -> Scenario:
    """The scenario of a shipped rig or of a rig file, also of one that `gearheat diagnose --extended` has written.

    Args:
        name_or_path: a name of a shipped rig, a TOML file, or a folder with a `rig.toml`

    Raises:
        ScenarioError: everything wrong with the file at once
    """
    return rig_files.load(name_or_path, PARTS | EXTRA_PARTS)
