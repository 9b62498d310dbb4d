"""Every shipped rig through commands, at its own operating point: those that take long share the rigs."""

import csv
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy import simulate_fmu
from fmpy.validation import validate_fmu
from for_each import one_of_each, thin
from gearheat.scenarios.load import list_rigs, load

RIGS = tuple(one_of_each(list_rigs(), lambda rig: tuple(part.type for part in load(rig).spec.parts)))
END = 7200.0


def columns(path: Path) -> dict[str, np.ndarray]:
    with path.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0] if name != "status"}


@pytest.fixture(scope="module")
def told() -> dict[tuple[str, str], dict[str, Any]]:
    """What commands without options have told of a rig, by both."""
    return {}


@pytest.fixture
def json_of(gearheat, rig: str, told) -> Callable[[str], dict[str, Any]]:
    """What a command without options tells of the rig; asked once."""

    def answer(command: str) -> dict[str, Any]:
        if (command, rig) not in told:
            told[command, rig] = gearheat(command, rig, "--json", "-").json
        return told[command, rig]

    return answer


@pytest.mark.parametrize("rig", RIGS)
def test_steady_losses_and_show(gearheat, rig: str, json_of) -> None:
    found = json_of("steady")
    assert found["energy_residual"] < 1e-6
    losses = gearheat("losses", rig, "--json", "-")
    assert losses.code == 0 and losses.json["rows"], losses.err
    shown = json_of("show")
    assert shown["rig"] == rig and shown["no_steady_state"] == []
    assert gearheat("show", rig, "--errata").code == 0


@pytest.mark.parametrize("rig", thin(RIGS, 0))
def test_design_gives_the_target_back(gearheat, rig: str, json_of) -> None:
    """The room that makes the warmest body 2 K warmer than it is, or without bodies the speed that gives an output."""
    before = json_of("steady")
    bodies = {name: before["values"][name] for name in before["states"] if before["units"][name] == "degC"}
    if bodies:
        name = max(bodies, key=bodies.__getitem__)
        free, target, unit = "room.T", bodies[name] + 2.0, "degC"
        assert (free in before["inputs"]) or pytest.skip("the room of this rig is not given")
    else:
        shown = json_of("show")
        (free,) = [q["name"] for q in shown["inputs"] if q["name"].endswith(".w")]
        name = next(q["name"] for q in shown["outputs"] if q["unit"] in ("um", "m", "mm"))
        unit = before["units"][name]
        target = 1.1 * before["values"][name]
    answer = gearheat("design", rig, "--free", free, "--target", f"{name}={target!r} {unit}", "--json", "-")
    assert answer.code == 0, answer.err
    value = answer.json["free"][free]
    after = gearheat("steady", rig, "--set", f"{free}={value!r} {before['units'][free]}", "--json", "-").json
    assert after["values"][name] == pytest.approx(target, rel=1e-5)


@pytest.mark.parametrize("rig", thin(RIGS, 1))
def test_sweep_agrees_with_steady(gearheat, rig: str, json_of, tmp_path: Path) -> None:
    inputs = json_of("show")["inputs"]
    speed = next(q for q in inputs if q["name"].endswith(".w"))
    low, high = sorted((0.8 * speed["value"], speed["value"]))
    out = tmp_path / "sweep.csv"
    vary = f"{speed['name']}={low!r}..{high!r} {speed['unit']}"
    found = gearheat("sweep", rig, "--vary", vary, "--grid", "3", "-o", out, "--json", "-")
    assert found.code == 0, found.err
    table = columns(out)
    steady = json_of("steady")
    row = int(np.argmin(np.abs(next(v for k, v in table.items() if k.startswith(speed["name"])) - speed["value"])))
    for name, value in steady["values"].items():
        column = next((v for k, v in table.items() if k.partition(" [")[0] == name), None)
        if column is not None:
            assert column[row] == pytest.approx(value, rel=1e-5, abs=1e-6), name


@pytest.mark.parametrize("rig", thin(RIGS, 2))
def test_a_warm_up_in_fmpy_is_that_of_simulate(gearheat, rig: str, json_of, tmp_path: Path) -> None:
    fmu, duty, out = tmp_path / "rig.fmu", tmp_path / "duty.csv", tmp_path / "out.csv"
    assert gearheat("export", "--platform", "host", rig, "-o", fmu).code == 0
    assert validate_fmu(str(fmu)) == []
    inputs = json_of("show")["inputs"]
    line = ",".join(repr(q["value"]) for q in inputs)
    duty.write_text(
        "time [s]," + ",".join(f"{q['name']} [{q['unit']}]" for q in inputs) + f"\n0,{line}\n{END},{line}\n"
    )
    answer = gearheat("simulate", rig, "--duty", duty, "-o", out, "--json", "-")
    assert answer.code == 0, answer.err
    assert answer.json["energy_residual"] < 1e-6
    flat = load(rig).spec.flat()
    bodies = [q.name for q in flat.states if q.unit == "K"]
    table = columns(out)
    start = {name: table[f"{name} [degC]"][0] + 273.15 for name in bodies}
    played = simulate_fmu(str(fmu), stop_time=END, output_interval=60.0, start_values=start, output=bodies or None)
    for name in bodies:
        ours = np.interp(played["time"][10::10], table["time [s]"], table[f"{name} [degC]"])
        assert np.abs(played[name][10::10] - 273.15 - ours).max() <= 1e-3, name
