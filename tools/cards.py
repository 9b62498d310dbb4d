"""The command `card`: a card of a rig's campaigns with every key, its default and what it means."""

from __future__ import annotations

from pathlib import Path

from ..diagnose.campaign.write import as_json, as_toml, default_card
from ..diagnose.library.nuisances import nuisances
from ..diagnose.library.roles import Roles
from ..model.errors import ScenarioError
from ..model.files import flows
from ..scenarios.scenario import Scenario
from . import console
from .rigs import load


def command(rig: str, out: Path | None, json: str | None) -> None:
    """Write the card as TOML or JSON; TOML to stdout where no file is named."""
    if out is not None and out.suffix not in (".toml", ".json") and not flows(out):
        raise ScenarioError(f"-o {out}: unknown kind of file. Its name must end in .toml or .json.")
    scenario = load(rig)
    card = default_card(scenario, usual_priors(scenario))
    if out is not None:
        console.write(out, console.as_json(as_json(card)) if out.suffix == ".json" else as_toml(card))
        console.note(f"wrote {out}")
    if json is not None or out is None:
        console.answer(as_json(card), json, lambda: print(as_toml(card), end=""))


def usual_priors(scenario: Scenario) -> dict[str, float]:
    """Relative standard deviation by part type and parameter, and of single parts that differ from their type's.

    Args:
        scenario: the rig, whose stated uncertainties count
    """
    kinds = {part.name: part.type for part in scenario.spec.parts}
    own: dict[str, float] = {}
    for nuisance in nuisances(Roles.of(scenario.spec), {}, scenario.uncertainties):
        for path, exponent in nuisance.paths.items():
            if exponent > 0:
                own.setdefault(path, float(f"{nuisance.sd * exponent:.4g}"))
    found: dict[str, float] = {}
    for path, sd in own.items():
        part, _, key = path.rpartition(".")
        if found.setdefault(f"{kinds[part]}.{key}", sd) != sd:
            found[path] = sd
    return found
