"""What an FMU costs, from C: its parts, its calls, a warm-up; and how the cost of making it grows with the model.

All figures of one call are processor times taken by turns in one process, so that their ratios hold on a busy machine.
"""

from __future__ import annotations

import os
import subprocess
import tempfile
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

from ...fmu.compiling import FLAGS
from ...fmu.equations import equations
from ...fmu.source import source
from ...fmu.variables import table
from ...model.core.connect import Assembly
from ...model.core.flat import FlatModel
from ...model.core.flatten import flatten
from ...model.parts import PARTS
from .c_importer import HERE, Compiler, includes, program, unpack
from .harness import timed

#: Speed in each stage of the warm-up, in parts of that of the operating point [1]; as in `importer/measure.c`.
STAGES = (0.4, 0.6, 0.8, 1.0, 0.2)
#: Length of a stage, 66 min [s]; as in `importer/measure.c`.
STAGE = 3960.0


def from_c(fmu: Path, folder: Path, speed: str, truth: np.ndarray, flat: FlatModel) -> dict[str, Any]:
    """Figures of an importer in C that warms the model up by five stages of one input.

    Args:
        fmu: the FMU of `flat`
        folder: where it may be unpacked
        speed: the input
        truth: states at the ends of the stages; errors are those of temperatures [K]
    """
    facts = unpack(fmu, folder / "unpacked")
    lines = _measure(_costs(folder / "unpacked" / "sources" / "all.c"), facts, speed)
    single = {words[0]: float(words[1]) for words in lines if words[0] != "warmup"}
    rhs = single["rhs"]
    found: dict[str, Any] = {"rhs_s": rhs, "step_rhs": single["step"] / rhs, "outputs_rhs": single["outputs"] / rhs}
    found |= {f"{name}_rhs": single[name] / rhs for name in ("call", "jump")} | {"state_bytes": single["state"]}
    found |= {"instance_bytes": single["instance"]} if "instance" in single else {}
    warm = [i for i, q in enumerate(flat.states) if q.unit == "K"]
    for words in (w for w in lines if w[0] == "warmup"):
        step, seconds = words[1], float(words[2])
        states = np.array([float(w) for w in words[3:]]).reshape(len(truth), -1)
        found[f"warmup_{step}_s"] = seconds
        found[f"warmup_{step}_rhs"] = seconds / rhs
        found[f"warmup_{step}_error_K"] = float(np.abs(states[:, warm] - truth[:, warm]).max())
    return found


def run_in_rhs(fmu: Path, folder: Path) -> float:
    """Four hours in steps of a minute from C, all outputs read after each, in right-hand sides.

    Args:
        fmu: the FMU
        folder: where it may be unpacked
    """
    facts = unpack(fmu, folder)
    found = {words[0]: float(words[1]) for words in _measure(_costs(folder / "sources" / "all.c"), facts)}
    return found["run"] / found["rhs"]


def rhs_s(flat: FlatModel) -> float:
    """Seconds of a right-hand side of a model from C, its implicit equations solved from the last ones."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "all.c"
        path.write_text(source(flat, equations(flat), table(flat)), encoding="utf-8")
        return {words[0]: float(words[1]) for words in _measure(_costs(path))}["rhs"]


def chain(n: int) -> Assembly:
    """n masses in a row, a conductor between neighbours."""
    masses = [PARTS["HeatCapacity"](f"m{k}", C=1000.0) for k in range(n)]
    links = [PARTS["ThermalConductor"](f"g{k}", G=10.0) for k in range(n - 1)]
    nets = [(f"g{k}.a", f"m{k}.heat") for k in range(n - 1)] + [(f"g{k}.b", f"m{k + 1}.heat") for k in range(n - 1)]
    return Assembly("chain", "a chain of masses and conductors", (*masses, *links), tuple(nets))


def massless_chain(n: int) -> Assembly:
    """n conductors in a row between two masses: the temperatures between them are one linear system."""
    masses = [PARTS["HeatCapacity"](name, C=1000.0) for name in ("first", "last")]
    links = [PARTS["ThermalConductor"](f"g{k}", G=10.0) for k in range(n)]
    nets = [(f"g{k}.b", f"g{k + 1}.a") for k in range(n - 1)]
    ends = [("first.heat", "g0.a"), (f"g{n - 1}.b", "last.heat")]
    return Assembly("chain", "a chain of conductors", (*masses, *links), (*nets, *ends))


def massless(n: int) -> dict[str, float]:
    """Seconds to flatten n conductors in a row without masses between them, and instructions of what is left."""
    seconds, flat = timed(lambda: flatten(massless_chain(n)))
    return {"conductors": n, "flatten_s": seconds, "instructions": int(flat.function.n_instructions())}


def growth(n: int) -> dict[str, float]:
    """Seconds to flatten, to generate and to compile a chain of n masses and conductors, and those of one step."""
    flatten_s, flat = timed(lambda: flatten(chain(n)))
    generate_s, text = timed(lambda: source(flat, equations(flat), table(flat)))
    with tempfile.TemporaryDirectory() as folder, patch.dict(os.environ, {"ZIG_LOCAL_CACHE_DIR": f"{folder}/cache"}):
        path = Path(folder) / "all.c"
        path.write_text(text, encoding="utf-8")
        began = os.times()
        costs = _costs(path)
        ended = os.times()
        compiled = ended.children_user + ended.children_system - began.children_user - began.children_system
        cost = {words[0]: float(words[1]) for words in _measure(costs)}
        size = costs.stat().st_size
    return {
        "nodes": n,
        "flatten_s": flatten_s,
        "generate_s": generate_s,
        "compile_s": compiled,
        "source_kB": len(text) / 1000,
        "binary_kB": size / 1000,
        "rhs_s": cost["rhs"],
        "step_s": cost["step"],
    }


def _measure(*arguments: object) -> list[list[str]]:
    """The lines of `importer/measure.c`, in words."""
    command = [str(program([HERE / "measure.c"])), *map(str, arguments)]
    out = subprocess.run(command, check=True, capture_output=True, text=True)
    return [line.split() for line in out.stdout.splitlines()]


def _costs(path: Path) -> Path:
    """The library of the parts of an FMU by the source of it, built as the FMU is."""
    options = ("-O2", *FLAGS, f'-DSOURCE="{path.as_posix()}"', *includes())
    made = path.parent / "costs.so"
    made.write_bytes(Compiler.zig().made([HERE / "costs.c"], options))
    return made
