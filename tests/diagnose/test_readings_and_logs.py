"""Readings and logs of one rig, each of which leaves a cause open: together they tell more."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import gearheat as gh
import numpy as np
import pytest
from challenge.cases import Drawn, make_case
from challenge.model_rig import draw_steady
from gearheat.tools.cli.app import app
from typer.testing import CliRunner

#: Samples of a log, its step [s], and what each input is held at [columns of a duty: lowest, highest, samples].
N, STEP = 2000, 300.0
HELD = {"input.w [rpm]": (500.0, 1500.0, 9), "output.tau [N.m]": (-590.0, -100.0, 7), "room.T [degC]": (16.0, 24.0, 20)}
#: The card's columns: what is simulated, sign, and noise.
LOGGED = {
    "Drehzahl [rpm]": ("input.w [rpm]", 1, 0.0),
    "Abtrieb [N.m]": ("output.tau [N.m]", -1, 0.0),
    "Ölsumpf [degC]": ("oil.T [degC]", 1, 0.15),
    "Gehäuse [degC]": ("wall.T [degC]", 1, 0.15),
    "Halle [degC]": ("room.T [degC]", 1, 0.1),
}


def called(*words: object) -> str:
    """Output of a command that succeeds."""
    done = CliRunner().invoke(app, [str(word) for word in words])
    assert done.exit_code == 0, done.output
    return done.stdout


def written(path: Path, columns: dict[str, np.ndarray]) -> Path:
    """A table as a file."""
    with path.open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(columns)
        rows.writerows(np.round(np.transpose(list(columns.values())), 4).tolist())
    return path


def log(folder: Path, name: str, seed: int, *changes: str) -> Path:
    """A log of the rig in a random duty, with changed parameters."""
    rng = np.random.default_rng(seed)
    time = {"time [s]": STEP * np.arange(N)}
    duty = {key: np.repeat(rng.uniform(low, high, N // m + 1), m)[:N] for key, (low, high, m) in HELD.items()}
    steps, out = written(folder / f"{name}_duty.csv", time | duty), folder / f"{name}_run.csv"
    called("simulate", "helical_two_stage", "--duty", steps, "-o", out, *(w for c in changes for w in ("--set", c)))
    with out.open(encoding="utf-8", newline="") as file:
        rows = {float(row["time [s]"]): row for row in csv.DictReader(file)}
    shown = {k: np.array([float(rows[t][k]) for t in time["time [s]"]]) for k, _, _ in LOGGED.values() if k not in duty}
    known = duty | shown
    return written(
        folder / f"{name}.csv",
        time | {column: sign * known[k] + rng.normal(0.0, sd, N) for column, (k, sign, sd) in LOGGED.items()},
    )


def draw(rng: np.random.Generator) -> Drawn:
    """Readings of a rig whose foot conducts twice as much."""
    drawn = draw_steady(rng, "helical_two_stage")
    return replace(drawn, base={**drawn.base, "foot": 2.0})


def test_a_foot_that_conducts_more_is_told_by_both(tmp_path: Path) -> None:
    make_case(draw, 3, 7, 0, tmp_path, kind="clean")
    data, card = (tmp_path / "case" / name for name in ("DATA.csv", "CARD.json"))
    asked = ["diagnose", data, "--rig", "helical_two_stage", "--card", card, "--quick", "--json", "-"]
    logs = ["--logs", log(tmp_path, "now", 2, "foot.G=6 W/K"), "--reference-logs", log(tmp_path, "past", 1)]
    alone, both = (json.loads(called(*asked, *more)) for more in ([], logs))
    p, q = ({tuple(h["causes"]): h["probability"] for h in r["hypotheses"]} for r in (alone, both))
    foot = ("cooling.foundation",)
    assert p[foot] < 0.4 < 0.5 < q[foot] and q[()] < 0.1 * p[()] and p[()] > 0.3  # from the air neither tells it
    assert both["about"]["logs"] == ["now.csv", "past.csv"] and both["about"]["log_rows"] == 2 * N
    assert any(text.startswith("the logs alone") and "heat into the foundation" in text for text in both["warnings"])


@pytest.mark.parametrize(("tolerance", "off"), [("0.5 N.m", True), ("100 N.m", False)])
def test_a_rig_is_off_as_filed_beyond_what_its_instruments_may_err(tmp_path: Path, tolerance: str, off: bool) -> None:
    rng, rows = np.random.default_rng(4), []
    for speed in (700.0, 1000.0, 1300.0, 1450.0):
        for load in (250.0, 350.0, 450.0, 550.0):  # which is more than is read
            s = gh.steady("helical_two_stage", set={"input.w": f"{speed} rpm", "output.tau": f"{-1.3 * load} N.m"})
            rows.append([speed, load, *(s.to(T, "degC") + rng.normal(0.0, 0.3) for T in ("oil.T", "wall.T")), 20.0])
    columns = ("n_input_rpm", "T_output_Nm", "T_oil_C", "T_wall_C", "T_amb_C")
    data = written(tmp_path / "data.csv", dict(zip(columns, np.transpose(rows), strict=True)))
    (card := tmp_path / "card.toml").write_text(
        f'sensors.T_output.magnitude = true\nchannels.T_output.offset_sd = "{tolerance}"\n'
    )
    found = gh.diagnose(data, "helical_two_stage", card=card, quick=True)
    assert bool(found.data_quality.as_filed) is off
