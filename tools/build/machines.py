"""Machines of `gearheat new` from 0.1 kW to 1 MW: run as a module, it prints the table of the page trust/machines."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .new import new
from .plausible import MACHINES, WARM, no_load, usual

HEAD = ("stages", "i", "kW", "rpm", "ISO VG", "", "efficiency [%]", "usual [%]", "oil [degC]", "bearings")


def draw_up(plate: str) -> Mapping[str, Any]:
    """A machine from a plate: the cells of its row, whether both numbers are plausible."""
    stages, ratio, power, speed, grade, *options = plate.split()
    chosen: dict[str, Any] = dict.fromkeys(options, True)
    sizes = new(
        "it",
        stages=stages,
        ratio=float(ratio),
        power=f"{power} kW",
        speed=f"{speed} rpm",
        oil=f"ISO VG {grade}",
        **chosen,
    ).sizes
    low, high = usual(stages, float(power), float(ratio))
    eta, oil = 100 * sizes["efficiency"], sizes["oil_degC"]
    first, last = sizes["bearings"][0]["a"], sizes["bearings"][-1]["a"]
    named = (stages, ratio, power, speed, grade, ", ".join(options))
    cells = (*named, f"{eta:.2f}", f"{low:g} to {high:g}", f"{oil:.0f}", f"{first} to {last}")
    (least, most), idle = no_load(stages, float(power)), 100 * sizes["no_load_W"] / sizes["loss_W"]
    return {"cells": cells, "plausible": low <= eta <= high and WARM[0] < oil < WARM[1] and least <= idle <= most}


def print_table() -> None:
    """The table of all machines."""
    print("| " + " | ".join(HEAD) + " |", "|" + "---|" * len(HEAD), sep="\n")
    for plate in MACHINES["plates"]:
        print("| " + " | ".join(draw_up(plate)["cells"]) + " |", flush=True)


if __name__ == "__main__":
    print_table()
