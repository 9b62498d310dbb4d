"""What may be wrong with a card beyond its form: values that cannot be, names that nothing reads."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from ...model.errors import suggestion
from .card import DEFAULTS, PRIOR, Card, Oil, Protocol


def card_problems(path: Path | None, card: Card) -> list[str]:
    """Values that cannot be."""
    name = path.name if path else ""
    problems = [f"{name} prior_sd.{k} = {v:g} is not above 0." for k, v in card.prior_sd.items() if not v > 0]
    problems += [f"{name} protocol.dwell_min: {d:g} is not above 0." for d in card.run.dwell_min if not d > 0]
    if isinstance(card.oil, Oil) and card.oil.nu100 >= card.oil.nu40:
        problems.append(f"{name} oil: nu100 is not below nu40. An oil gets thinner as it warms up.")
    if isinstance(card.oil, Oil) and card.oil.nu40 < 1.0:
        problems.append(f"{name} oil: nu40 = {card.oil.nu40:g} is too small. Give viscosities in mm2/s.")
    return problems


def card_warnings(path: Path | None, card: Card) -> list[str]:
    """Keys that nothing reads, and words that nothing understands."""
    if path is None:
        return ["no card: default accuracies and priors."]
    raw = json.loads(path.read_text(encoding="utf-8"))
    fields = {f.alias or name for name, f in Card.model_fields.items()}
    found: list[tuple[str, str, set[str]]] = [("", key, fields) for key in raw if key not in fields]
    found += [("channels.", key, set(DEFAULTS)) for key in card.channels if key not in DEFAULTS]
    found += [("prior_sd.", key, set(PRIOR)) for key in card.prior_sd if key not in PRIOR]
    if isinstance(raw.get("protocol"), Mapping):
        known = set(Protocol.model_fields)
        found += [("protocol.", key, known) for key in raw["protocol"] if key not in known]
    warnings = [f'{path.name}: "{at}{key}" is not used.{suggestion(key, names)}' for at, key, names in found]
    return warnings + _words(path.name, card)


def _words(name: str, card: Card) -> list[str]:
    """A protocol in words, and words of it that are not the ones known."""
    defaults = Protocol()
    if isinstance(card.protocol, str):
        return [
            f"{name}: the protocol is in words. Taken: a stop of {defaults.stop_min:g} min, a start at the room's"
            " temperature, the room in a straight line between its readings."
        ]
    return [
        f'{name}: protocol.{key} is taken as "{getattr(defaults, key)}", the only one known.'
        for key in ("ambient", "reading")
        if getattr(card.run, key) != getattr(defaults, key)
    ]
