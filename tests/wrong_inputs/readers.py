"""How a line of each kind is read, each by the reader that commands use."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from contextlib import chdir
from functools import cache
from pathlib import Path
from typing import Any

from gearheat.model.errors import GearheatError
from gearheat.scenarios.duty import read_duty
from gearheat.scenarios.load import RIGS, load
from gearheat.scenarios.measured.card import Card, read_card
from gearheat.scenarios.measured.logs import read_log
from gearheat.scenarios.measured.nominal import Nominal
from gearheat.scenarios.measured.read import read_campaign
from gearheat.scenarios.scenario import Scenario
from gearheat.tools.cli.app import app
from gearheat.tools.export.export import export
from gearheat.tools.solve.settings import adjust
from gearheat.tools.solve.sweep_plan import Request, plan_sweep
from typer.testing import CliRunner

Table = list[list[str]]
ROWS = 24


@cache
def rig() -> Scenario:
    return load("planetary")


def unescaped(text: str) -> str:
    return text.replace("|", "\n")


def written(folder: Path, name: str, text: str) -> Path:
    (path := folder / name).write_text(text, encoding="utf-8", newline="")
    return path


@cache
def readings() -> str:
    lines = (RIGS / "planetary" / "measured.csv").read_text(encoding="utf-8").splitlines()
    return "\n".join(lines[: ROWS + 1]) + "\n"


@cache
def log() -> str:
    """Samples of steady states, ten minutes apart."""
    names = ["time_s", "n_carrier_rpm", "T_carrier_Nm", "T_sun_Nm", "T_oil_C", "T_wall_C", "T_amb_C"]
    rows, nominal = [",".join(names)], Nominal(rig())
    for k in range(10):
        n, tau = 100.0 + 15 * k, 1500.0 + 90 * k
        state = nominal.at({"carrier.w": n * math.pi / 30, "carrier.tau": tau, "room.T": 298.15})
        assert state is not None
        for i in range(12):
            shift = 0.01 * ((7 * i + k) % 12)
            told = (-state["sun.tau"] + shift, state["oil.T"] - 273.15 + shift, state["wall.T"] - 273.15 + shift)
            rows.append(",".join(f"{x:.6g}" for x in (600 * (12 * k + i), n, tau, *told, 25 + shift)))
    return "\n".join(rows) + "\n"


def changed(table: str, change: str) -> str:
    """A table with changes, apart by ";": NAME=CELL, NAME@ROW=CELL, NAME*FACTOR+SHIFT, NAME->NEW, -NAME, +NAME=CELL."""
    rows = [line.split(",") for line in table.splitlines()]
    for one in change.split("; "):
        if match := re.fullmatch(r"-(\S+)", one):
            k = rows[0].index(match[1])
            rows = [row[:k] + row[k + 1 :] for row in rows]
        elif match := re.fullmatch(r"\+(.+)=(.*)", one):
            rows = [[*row, match[2] if i else match[1]] for i, row in enumerate(rows)]
        elif match := re.fullmatch(r"(\S+)->(.+)", one):
            rows[0][rows[0].index(match[1])] = match[2]
        elif match := re.fullmatch(r"(\w+)\*([-\d.e]+)\+([-\d.e]+)", one):
            k = rows[0].index(match[1])
            for row in rows[1:]:
                row[k] = f"{float(row[k]) * float(match[2]) + float(match[3]):.6g}" if row[k] else ""
        elif match := re.fullmatch(r"(\w+)(?:@(\d+))?=(.*)", one):
            k = rows[0].index(match[1])
            for row in rows[1:] if match[2] is None else [rows[int(match[2])]]:
                row[k] = match[3]
        else:
            raise AssertionError(one)
    return "\n".join(",".join(row) for row in rows) + "\n"


def read_rig(folder: Path, line: str) -> None:
    old, _, new = unescaped(line).partition(" => ")
    text = (RIGS / "planetary" / "rig.toml").read_text(encoding="utf-8")
    assert old in text, old
    written(folder, "measured.csv", readings())
    load(written(folder, "rig.toml", text.replace(old, new, 1)))


def read_with_card(folder: Path, line: str) -> None:
    card = read_card(written(folder, "card.toml", unescaped(line)))
    read_campaign(written(folder, "table.csv", readings()), rig(), card)


def to_export(folder: Path, line: str) -> None:
    """Options as "NAME=VALUE", apart by "; "; several values of one by "&"."""
    options: dict[str, Any] = {"platform": "host"} | dict(one.split("=", 1) for one in line.split("; "))
    options |= {name: options[name].split("&") for name in ("set", "constant", "ssp") if name in options}
    export("planetary", folder / options.pop("out", "rig.fmu"), **options)


def to_output(folder: Path, line: str) -> None:
    """What is typed behind `gearheat`, in a folder with a duty, a file and a folder."""
    (folder / "folder").mkdir(exist_ok=True)
    written(folder, "file", "")
    written(folder, "duty.csv", "time [s],carrier.w [rpm]\n0,250\n60,250\n")
    with chdir(folder):
        answer = CliRunner().invoke(app, line.split())
    if answer.exception is not None and not isinstance(answer.exception, SystemExit):
        raise answer.exception
    if answer.exit_code == 2:
        raise GearheatError(answer.stderr)


READERS: dict[str, Callable[[Path, str], object]] = {
    "set": lambda folder, line: adjust(rig(), [line]),
    "vary": lambda folder, line: plan_sweep(Request("planetary", [line], sample=4)),
    "export": to_export,
    "output": to_output,
    "duty": lambda folder, line: read_duty(written(folder, "duty.csv", unescaped(line)), rig().inputs()),
    "rig": read_rig,
    "card": read_with_card,
    "readings": lambda folder, line: read_campaign(
        written(folder, "table.csv", changed(readings(), line)), rig(), Card()
    ),
    "log": lambda folder, line: read_log(written(folder, "log.csv", changed(log(), line)), rig(), Card()),
}
