"""The sheets of cases by name."""

from __future__ import annotations

from collections.abc import Mapping

from . import foreign, own
from .cases import Sheet
from .textbook import campaign as textbook

#: Their order is part of the draws of a case.
SHEETS: Mapping[str, Sheet] = {"own": own.draw, "foreign": foreign.draw, "textbook": textbook.draw}
