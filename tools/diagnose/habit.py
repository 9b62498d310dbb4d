"""Friction in thin films that is the rig's own, not a cause: how much of it, a healthy campaign tells.

A cause that warms the oil takes the rig to films thinner than any of its healthy days. What its teeth make of them the
model knows but roughly, and the difference would be taken for a second cause.
"""

from __future__ import annotations

from dataclasses import replace

from ..effects.cause import Cause, Size
from ..effects.forms import extra_part

(_LOSS,), _NETS = extra_part("extra_habit", "gears")
#: Path of its size.
POWER = f"{_LOSS.name}.P_ref"
#: As film starvation in the middle of its family.
HABIT = Cause(
    id="thin films",
    doc="Friction of the teeth that grows as films get thin, more or less than the model's.",
    size=Size("P_ref", "W", "loss at 200 rpm, 75 cSt and 2000 N.m", 40.0, -200.0, 200.0),
    parts=(replace(_LOSS, values={**_LOSS.values, "a": -0.35, "b": -1.2, "c": 1.2, "oil_share": 0.8}),),
    connections=_NETS,
    values=lambda base, theta, rows: {POWER: theta["P_ref"]},
)
