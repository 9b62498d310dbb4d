from __future__ import annotations

import json
import math
import re
import shutil
from dataclasses import dataclass
from typing import Any

import pytest
from gearheat.scenarios.shipped import RIGS
from gearheat.tools.cli.app import app
from typer.testing import CliRunner


def _row(point: int, test: int, direction: int, oil: str, n: float, tau: float, shift: float) -> dict[str, object]:
    """A reading that is linear in speed and torque but for `shift`; the simulated oil is 2 K too warm."""
    rise = 5.0 + 0.1 * n + 0.005 * tau + shift
    loss = 10.0 + 0.01 * tau + shift
    power = loss * n * math.pi / 30
    return {
        "point": point, "test": test, "direction": direction, "oil": oil, "grid": f"{oil}-grid",
        "n_set_rpm": n, "T_set_Nm": tau, "n_carrier_rpm": n, "T_carrier_Nm": tau, "T_amb_C": 20.0 + direction,
        "time_s": 60.0 * (240 if direction == 1 else 335),
        "T_oil_C": 22.0 + direction + rise, "T_oil2_C": 22.0 + direction + rise, "T_wall_C": 19.0 + direction + rise,
        "loss_Nm": loss + 1.0, "P_loss_W": power, "efficiency": 0.98, "P_mesh_W": 0.6 * power, "P_seal_W": 0.4 * power,
        "T_oil_C_meas": 20.0 + direction + rise, "T_oil2_C_meas": 20.0 + direction + rise,
        "T_wall_C_meas": 20.0 + direction + rise, "loss_Nm_meas": loss, "P_loss_W_meas": power, "efficiency_meas": 0.98,
    }  # fmt: skip


@pytest.fixture
def rows() -> list[dict[str, object]]:
    """Twelve tests of two readings each; the point at 100 rpm and 1600 N.m of oil A is there twice, 0.4 apart."""
    found: list[dict[str, object]] = []
    points = [(oil, n, tau, 0.0) for oil in "AB" for n in (100.0, 200.0, 250.0) for tau in (1600.0, 2400.0)]
    for test, (oil, n, tau, shift) in enumerate([*points[:11], ("A", 100.0, 1600.0, 0.4)], start=1):
        for direction in (1, 2):
            found.append(_row(len(found) + 1, test, direction, oil, n, tau, shift))
    return found


@dataclass(frozen=True)
class Answer:
    """What a command left: exit code, standard output, standard error."""

    code: int
    out: str
    err: str

    @property
    def json(self) -> dict[str, Any]:
        return json.loads(self.out)

    def problems(self) -> list[str]:
        return self.err.split("error: ")[1:]


@pytest.fixture(scope="session")
def gearheat():
    """Run a command of the program in this process."""

    def run(*arguments: object) -> Answer:
        result = CliRunner().invoke(app, [str(a) for a in arguments])
        if result.exception is not None and not isinstance(result.exception, SystemExit):
            raise result.exception
        return Answer(result.exit_code, result.stdout, result.stderr)

    return run


@pytest.fixture
def rig(tmp_path):
    """Copy of the planetary rig, for a test to change: line(table, key, new) puts a line in the place of a key's."""

    class Copy:
        folder = tmp_path / "planetary_copy"

        def __str__(self) -> str:
            return str(self.folder)

        def line(self, table: str, key: str, new: str) -> None:
            path = self.folder / "rig.toml"
            before, header, after = path.read_text(encoding="utf-8").partition(f"[{table}]\n")
            changed, count = re.subn(rf"^{re.escape(key)} = .*\n", new + "\n", after, count=1, flags=re.MULTILINE)
            assert count == 1, f"[{table}] has no {key}"
            path.write_text(before + header + changed, encoding="utf-8")

    shutil.copytree(RIGS / "planetary", Copy.folder)
    return Copy()
