"""The sheets of cases by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from . import foreign, logs, machines, model_rig, plates
from .cases import Sheet, make_case
from .textbook import campaign as textbook

#: Their order is part of the draws of a case.
SHEETS: Mapping[str, Sheet] = {
    "own": model_rig.draw,
    "foreign": foreign.draw,
    "textbook": textbook.draw,
    "rigs": model_rig.draw_steady,
}
#: Writes a case of a sheet by seed, number, folder and kind, and returns its truth. The number of the sheet is part of
#: the draws.
MAKERS: Mapping[str, Callable[..., dict[str, Any]]] = {
    **{name: partial(make_case, draw, number) for number, (name, draw) in enumerate(SHEETS.items())},
    "machines": partial(machines.make, machines.Machine, len(SHEETS)),
    "logs": partial(machines.make, partial(logs.Logged, True), len(SHEETS) + 1),
    "lone_logs": partial(machines.make, partial(logs.Logged, False), len(SHEETS) + 2),
    "plates": partial(machines.make, plates.Plated, len(SHEETS) + 3),
}
#: Sheets whose scores are pooled by `--sheet all`.
POOLED = ("own", "foreign", "textbook", "machines")
