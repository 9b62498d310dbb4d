"""Oil and housing of one machine, held against each other."""

from __future__ import annotations

from collections.abc import Iterator

from ..model.machines.spec import Spec
from ..model.parts.lubrication import SIDES

#: Rounding of what is written [1].
ROUNDED = 1.02


def oil_problems(spec: Spec) -> Iterator[str]:
    """A level above the housing, or more oil than there is room for, each with the values that would do.

    Args:
        spec: a machine; where it has several housings or sumps, nobody knows which holds which
    """
    of = {role: [p for p in spec.parts if spec.types[p.type].role == role] for role in ("bath", "surface")}
    boxes = [p for p in of["surface"] if {*SIDES} <= p.values.keys()]
    if len(boxes) != 1 or len(of["bath"]) != 1:
        return
    box, oil = boxes[0], of["bath"][0]
    length, width, height = (float(box.values[side]) for side in SIDES)
    V, level = float(oil.values.get("V", 0.0)), float(oil.values.get("level", 0.0))
    if level >= height:
        yield (
            f"{oil.name}.level = {1000 * level:.4g} mm is above the top of the housing: {box.name}.height ="
            f" {1000 * height:.4g} mm. Measure both from its bottom."
        )
    if ROUNDED * length * width * height < V:
        most = 1000 * length * width * height
        yield f"{oil.name}.V = {1000 * V:.4g} l is more than {box.name} holds, {most:.4g} l. Check its unit."
    elif 0 < level < height and ROUNDED * level * length * width < V:
        yield (
            f"{oil.name}.V = {1000 * V:.4g} l does not fit below a level of {1000 * level:.4g} mm in {box.name} of"
            f" {1000 * length:.4g} x {1000 * width:.4g} mm. Give at most {1000 * level * length * width:.4g} l, or a"
            f" level of at least {1000 * V / length / width:.4g} mm."
        )
