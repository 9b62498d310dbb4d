"""The command `list`: rigs and catalogues that can be named. It imports no model, so that it answers at once."""

from __future__ import annotations

from ...scenarios.shipped import FILES, list_entries, list_rigs
from ..show.console import answer, table


def list_command(json: str | None) -> None:
    """Rigs and catalogue entries that can be named."""
    rigs, reproduces = list_rigs(), list_rigs("reproduces")
    catalogues = {kind: list_entries(kind) for kind in FILES}
    found = {
        "schema": "gearheat.list/1",
        "rigs": rigs,
        "reproduces": reproduces,
        "catalogues": {kind: {name: e.doc for name, e in entries.items()} for kind, entries in catalogues.items()},
        "checked": {kind: {name: e.checked for name, e in entries.items()} for kind, entries in catalogues.items()},
    }

    def human() -> None:
        table("Rigs", ("name", "what it is", "reproduces"), [(n, doc, reproduces[n]) for n, doc in rigs.items()])
        for kind, entries in catalogues.items():
            rows = [(name, e.doc, e.checked) for name, e in entries.items()]
            table(f"Catalogue: {kind}", ("name", "what it is", "checked"), rows)

    answer(found, json, human)
