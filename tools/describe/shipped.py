"""Rigs and catalogues that can be named. It imports no model, so that it answers at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ...scenarios.shipped import FILES, Listed, list_entries, list_rigs
from ..show.display import Display


@dataclass(frozen=True, eq=False, repr=False)
class Shipped(Display):
    """What is shipped.

    Attributes:
        rigs: name -> what it is
        reproduces: name of a rig -> the published results it reproduces
        catalogues: kind -> entry -> what it is, and whether its values were compared with a print
    """

    rigs: Mapping[str, str]
    reproduces: Mapping[str, str]
    catalogues: Mapping[str, Mapping[str, Listed]]

    @property
    def title(self) -> str:
        """What is shown."""
        return "Rigs"

    def table(self) -> tuple[Sequence[str], Sequence[Sequence[Any]]]:
        """The rigs."""
        head = ("name", "what it is", "reproduces")
        return head, [(name, doc, self.reproduces[name]) for name, doc in self.rigs.items()]

    def as_dict(self) -> dict[str, Any]:
        """Rigs and catalogues."""
        return {
            "schema": "gearheat.list/1",
            "rigs": dict(self.rigs),
            "reproduces": dict(self.reproduces),
            "catalogues": {kind: {n: e.doc for n, e in entries.items()} for kind, entries in self.catalogues.items()},
            "checked": {kind: {n: e.checked for n, e in entries.items()} for kind, entries in self.catalogues.items()},
        }


def shipped() -> Shipped:
    """The shipped rigs and the entries of the catalogues.

    Example:
        >>> import gearheat as gh
        >>> "planetary" in gh.shipped().rigs
        True
    """
    return Shipped(list_rigs(), list_rigs("reproduces"), {kind: list_entries(kind) for kind in FILES})
