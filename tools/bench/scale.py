"""How processor time and memory grow with the size of what is asked, each row by a process of its own."""

from __future__ import annotations

import csv
import gzip
import os
import shlex
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from datetime import UTC, datetime, timedelta
from itertools import cycle, islice
from math import log
from pathlib import Path
from typing import Any

import numpy as np

from ...model.errors import DataError
from ...scenarios.shipped import RIGS
from ..show.columns import table_text
from ..show.console import note
from .harness import PROGRAM, TABLES

#: Head of the table of `rows_of`.
HEAD = ("what", "size", "processor time [s]", "peak memory [GiB]", "grows as n to the: time", "memory")
#: A measured log.
LOG = RIGS / "wind_turbine" / "R80711.csv.gz"
#: A measured campaign, the sensors that are added to it, and those whose readings they repeat.
MEASURED = RIGS / "planetary" / "measured.csv"
ADDED = {"T_oil3_C": "T_oil_C", "T_oil4_C": "T_oil2_C", "T_wall2_C": "T_wall_C"}
READ = ("T_sun_Nm", "T_oil_C", "T_wall_C", "T_oil2_C")
#: Noise of repetitions, in units of their columns: what repeats itself is refused.
NOISE = 0.02
#: Step of the log.
STEP = timedelta(minutes=10)


def measure() -> dict[str, Any]:
    """Processor time and peak memory of each command at each of its sizes, those of all its processes.

    Raises:
        DataError: a command fails
    """
    return {"jobs": [_grow(**job) for job in TABLES["scale"]]}


def _grow(what: str, make: str, command: str, sizes: Sequence[int]) -> dict[str, Any]:
    """One command at its sizes, and the exponents by which it grows from the first to the last of them."""
    runs = []
    for size in sizes:
        note(f"{what}, {size}")
        with tempfile.TemporaryDirectory() as folder:
            MADE[make](Path(folder), size)
            runs.append({"size": size, **_run(shlex.split(command.format(size=size)), Path(folder))})
    grown = {key: log(runs[-1][key] / runs[0][key]) / log(sizes[-1] / sizes[0]) for key in ("s", "GiB")}
    return {"what": what, "runs": runs, "exponents": grown}


def _run(words: Sequence[str], folder: Path) -> dict[str, float]:
    with (folder / "said").open("w+") as said:
        process = subprocess.Popen([*PROGRAM, *words], cwd=folder, stdout=subprocess.DEVNULL, stderr=said)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        if process.returncode:
            raise DataError(f"{' '.join(words)}: {said.read()[-500:]}")
    return {"s": used.ru_utime + used.ru_stime, "GiB": used.ru_maxrss / 2**20}


def rows_of(found: Mapping[str, Any]) -> list[tuple[Any, ...]]:
    """The rows of the table under `HEAD`; the exponents stand at the last size of a command."""
    return [
        (
            job["what"],
            run["size"],
            round(run["s"], 1),
            round(run["GiB"], 2),
            *([round(job["exponents"][key], 2) for key in ("s", "GiB")] if run is job["runs"][-1] else ["", ""]),
        )
        for job in found["jobs"]
        for run in job["runs"]
    ]


def network(folder: Path, n: int) -> None:
    """A rig of n masses in a row, each in a room; a heater warms the first."""
    parts = {"room": ("PrescribedTemperature", ""), "heater": ("PrescribedHeatFlow", "")}
    parts |= {f"m{k}": ("HeatCapacity", 'C = "1000 J/K"') for k in range(n)}
    parts |= {f"c{k}": ("ThermalConductor", 'G = "0.1 W/K"') for k in range(n)}
    parts |= {f"g{k}": ("ThermalConductor", 'G = "10 W/K"') for k in range(n - 1)}
    nets = [["heater.heat", "m0.heat"], ["room.heat", *(f"c{k}.b" for k in range(n))]]
    nets += [[f"m{k}.heat", f"c{k}.a"] for k in range(n)]
    nets += [[f"g{k}.{end}", f"m{k + step}.heat"] for k in range(n - 1) for end, step in (("a", 0), ("b", 1))]
    source = 'source = "assumed: a network of any length"'
    about = ['kind = "network"', 'doc = "Masses in a row"', "[drive]", "[operating_point]"]
    about += ['room.T = "20 degC"', 'heater.Q_flow = "50 W"', source]
    body = [f'[part.{name}]\ntype = "{kind}"\n{value}\n{source}' for name, (kind, value) in parts.items()]
    joined = [f"n{k} = {net}" for k, net in enumerate(nets)]
    (folder / "given.toml").write_text("\n".join([*about, *body, "[connect]", *joined]), encoding="utf-8")


def duty(folder: Path, n: int) -> None:
    """A duty of n rows, one a minute: load and speed of the planetary rig change every ten."""
    random, time = np.random.default_rng(0), np.arange(n)
    speed, load = (np.repeat(random.uniform(*ends, n // 10 + 1), 10)[:n] for ends in ((100.0, 250.0), (500.0, 2500.0)))
    columns = {"carrier.w [rpm]": speed, "carrier.tau [N.m]": load, "room.T [degC]": 20 + 5 * np.sin(time / 500)}
    (folder / "given.csv").write_text(table_text({"time [min]": time.astype(float), **columns}), encoding="utf-8")


def wind(folder: Path, n: int) -> None:
    """A log of n samples of a wind turbine."""
    random, begin = np.random.default_rng(0), datetime(1990, 1, 1, tzinfo=UTC)
    with gzip.open(LOG, "rt", encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    with (folder / "given.csv").open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(head)
        for k, (_, _, *cells) in enumerate(islice(cycle(rows), n)):
            noisy = random.uniform(-NOISE, NOISE, len(cells))
            read = [f"{float(cell) + noise:.3f}" if cell else "" for cell, noise in zip(cells, noisy, strict=True)]
            writer.writerow([k // len(rows), (begin + k * STEP).strftime("%Y-%m-%dT%H:%MZ"), *read])


def campaign(folder: Path, n: int) -> None:
    """A campaign of n rows and ten sensors of the planetary rig: measured rows again and again, with noise."""
    random = np.random.default_rng(0)
    card = [f'[sensors.{name}]\nreads = "{name[2:].partition("_")[0].rstrip("234")}.T"' for name in ADDED]
    (folder / "card.toml").write_text("\n".join(card) + "\n", encoding="utf-8")
    with MEASURED.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    with (folder / "given.csv").open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, [*rows[0], *ADDED])
        writer.writeheader()
        for k, row in enumerate(islice(cycle(rows), n)):
            test = int(row["test"]) + k // len(rows) * int(rows[-1]["test"])
            read = {name: row[ADDED.get(name, name)] for name in (*READ, *ADDED)}
            noisy = {name: f"{float(cell) + random.uniform(-NOISE, NOISE):.3f}" for name, cell in read.items() if cell}
            writer.writerow({**row, **noisy, "point": k + 1, "test": test})


def nothing(folder: Path, n: int) -> None:
    """What needs no file."""


MADE: Mapping[str, Callable[[Path, int], None]] = {f.__name__: f for f in (network, duty, wind, campaign, nothing)}
