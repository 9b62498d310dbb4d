"""The sheets of cases by name."""

from __future__ import annotations

from collections.abc import Mapping

from . import foreign, model_rig
from .cases import Sheet
from .textbook import campaign as textbook

#: Their order is part of the draws of a case.
SHEETS: Mapping[str, Sheet] = {
    "own": model_rig.draw,
    "foreign": foreign.draw,
    "textbook": textbook.draw,
    "rigs": model_rig.draw_steady,
}
#: Sheets whose scores are pooled by `--sheet all`.
POOLED = ("own", "foreign", "textbook", "machines")
