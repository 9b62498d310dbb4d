"""The command `card`: a card of a rig's campaigns with every key, its default and what it means."""

from __future__ import annotations

from pathlib import Path

from ...model.errors import ScenarioError
from ...model.files import flows
from ...scenarios.load import load
from ...scenarios.measured.write import as_json, as_toml, default_card
from ..diagnose.library.nuisances import usual_priors
from ..show import console


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
