"""The extended rig, exported and played over the readings by its user, leaves the error that the diagnosis states."""

from __future__ import annotations

import csv
import json
import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import jsonschema
import numpy as np
import pytest
from gearheat.fmu.play import Player
from gearheat.model.errors import SolveError
from gearheat.tools.challenge.case import make_case
from gearheat.tools.diagnose import words
from gearheat.tools.diagnose.command import Outputs, command
from gearheat.tools.diagnose.extension import extended_text
from gearheat.tools.diagnose.findings import Findings, Gain, Joint
from gearheat.tools.diagnose.hypothesis import Hypothesis
from gearheat.tools.diagnose.infer import Predictor, infer, played, problem_of
from gearheat.tools.diagnose.inputs import Request, read_inputs
from gearheat.tools.diagnose.output import schema
from gearheat.tools.effects.taxonomy import CAUSES

#: The diagnosis solves a course to a few thousandths of a kelvin, the FMU to less.
SAME = 0.005
CHANNELS = {"T_oil": "T_oil_K", "T_wall": "T_wall_K", "loss": "loss_Nm"}


def errors(fmu: Path, table: Path, card: dict, oils=None) -> dict[str, float]:
    """Root mean square of the FMU against the readings, by the protocol as the card's text states it."""
    run, zero = card["protocol"], 273.15
    tests: dict[str, list[dict[str, float]]] = {}
    with table.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            oil = row["oil"]
            numbers = {k: float(v) for k, v in row.items() if k not in ("oil", "date") and v}
            tests.setdefault(row["test"], []).append({**numbers, "oil": oil})
    left: dict[str, list[float]] = {name: [] for name in CHANNELS}
    with Player(fmu) as player:
        temperatures = [n for n in player.described.variables if n.endswith(".T") and n != "room.T"]
        for first, second in tests.values():
            room = first.get("T_amb_start_C", first["T_amb_C"] + run["ambient_start_minus_reading_K"]) + zero
            warm = first["T_start_C"] + zero if "T_start_C" in first else room + run["T_start_minus_amb_K"]
            a = 60 * first["dwell_min"]
            b = a + 60 * second.get("stop_min", run["stop_min"])
            c = b + 60 * second["dwell_min"]
            w1, w2 = (r["n_carrier_rpm"] * math.pi / 30 for r in (first, second))
            t = np.array([0.0, a, a, b, b, c])
            inputs = {
                "carrier.w": (t, np.array([w1, w1, 0, 0, w2, w2])),
                "carrier.tau": (t, np.array([1.0, 1, 0, 0, 0, 0]) * first["T_carrier_Nm"]
                                - np.array([0.0, 0, 0, 0, 1, 1]) * second["T_carrier_Nm"]),
                "room.T": (np.array([0.0, a, c]), np.array([room, first["T_amb_C"] + zero, second["T_amb_C"] + zero])),
            }  # fmt: skip
            start = {n: warm for n in temperatures if player.described.variables[n].initial == "exact"}
            start |= (oils or {}).get(first["oil"], {})
            record = ["oil.T", "wall.T", "efficiency.tau_loss"]
            found = player.run(inputs, c, 60.0, start=start, record=record, output_times=[a, a, c, c])
            for k, r in enumerate((first, second)):
                oil, wall, loss = found.values[2 * k]
                left["T_oil"].append(oil - zero - r["T_oil_C"])
                left["T_wall"].append(wall - zero - r["T_wall_C"])
                sign = 1 if r["direction"] == 1 else -1
                left["loss"].append(loss - sign * (r["T_carrier_Nm"] - 4 * r["T_sun_Nm"]))
    return {name: float(np.sqrt(np.mean(np.square(values)))) for name, values in left.items()}


@pytest.fixture(scope="module")
def case(tmp_path_factory) -> Path:
    """A campaign with churning whose tests start in a room colder than their first reading."""
    folder = tmp_path_factory.mktemp("churning")
    make_case("foreign", 51, 0, folder, kind="single", causes=("losses.churning",), series=False)
    return folder / "case"


@pytest.fixture
def card(case) -> dict:
    return json.loads((case / "CARD.json").read_text())


def test_the_fmu_of_the_extended_rig_has_the_error_that_is_stated(case, card, tmp_path, gearheat, capsys):
    assert card["protocol"]["ambient_start_minus_reading_K"] != 0.0
    kept = []

    def kept_infer(*arguments):
        kept.append(infer(*arguments))
        return kept[0]

    rig, fmu = tmp_path / "rig.toml", tmp_path / "rig.fmu"
    outputs = Outputs(None, str(tmp_path / "result.json"), tmp_path / "report.html", rig)
    request = Request(case / "DATA.csv", card=case / "CARD.json", reference=case / "REF.csv")
    command(request, outputs, 0.05, 0, kept_infer)
    findings: Findings = kept[0][0]
    assert words.applied(findings) and any(CAUSES[c].physical for c in words.applied(findings).causes)
    result = json.loads((tmp_path / "result.json").read_text())
    page = (tmp_path / "report.html").read_text()
    assert words.played(findings) in page and "<td>q &lt; 0.001</td>" in page
    jsonschema.validate(result, schema())
    known = {cause["id"]: cause for cause in result["causes"]}
    assert known["losses.churning"]["q"] < 0.001 and known["losses.churning"]["p_split"] < 0.001
    assert not {"p_split", "q"} & set(known["procedure.day_scatter"])
    assert gearheat("export", "planetary", "--extended", rig, "-o", fmu).code == 0
    left = errors(fmu, case / "DATA.csv", card)
    print(left, result["played"])
    for channel, key in CHANNELS.items():
        stated = result["played"][key]["rms_extended"]
        assert f"{words.number(stated)} {words.PLAYED[channel][1]} extended" in words.played(findings)
        assert left[channel] == pytest.approx(stated, abs=SAME), channel
        assert stated < 0.5 * result["played"][key]["rms_calibrated"]
    # the commands of the same name show it too, with the card and not without
    for options, same in ((("--card", case / "CARD.json"), True), ((), False)):
        out = tmp_path / f"out{same}"
        gearheat("run", "--extended", rig, "--data", case / "DATA.csv", *options, "--workers", "1", "--out", out)
        rows = json.loads((out / "result.json").read_text())["rows"]
        oil = np.sqrt(np.mean([(row["T_oil_C"] - row["T_oil_C_meas"]) ** 2 for row in rows]))
        assert (abs(oil - left["T_oil"]) < SAME) == same


def of_hypothesis(inputs, causes: tuple[str, ...]) -> Findings:
    """Findings with causes of middle form and usual size, on the rig as it is."""
    theta = {}
    for cause in (CAUSES[c] for c in causes):
        size = cause.size.sd if cause.size.sd <= cause.size.high else -cause.size.sd
        theta[cause.id] = {**cause.forms(cause.sample(1, 1)[0])[0], cause.size.name: size}
    problem = problem_of(inputs)
    linear = problem.linearised(np.full(len(problem.parameters.names), 0.3))
    stated = played(SimpleNamespace(problem=problem, null=linear), Hypothesis(causes, 0.0, theta))
    n = len(inputs.data.readings)
    return Findings(
        verdict="explained", alpha=0.05, p_any=0.0, p_omnibus=0.0, p_adequacy=1.0, draws=1,
        hypotheses=(Joint(causes, 1.0, theta),), causes=(), confusable=(), impact={},
        gain=Gain("leave-one-operating-point", "T_oil_C", 1.0, 1.0, (1.0, 1.0), None, n),
        next_experiment=(), warnings=(), nominal={}, extended=linear.values, played=stated,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("causes", "oils"),
    [
        (("losses.oil_viscosity", "sensor.ambient.bias"), ("PAOR",)),
        (("losses.oil_viscosity", "heat.external_source"), ("PAOR", "MINR")),
        (("thermal.mass", "procedure.not_stationary"), ("PAOR",)),
        (("cooling.contact", "procedure.order"), ("OURS",)),
    ],
)
def test_faults_that_the_rig_cannot_hold_are_not_in_the_statement(case, card, tmp_path, gearheat, causes, oils):
    lines = (case / "DATA.csv").read_text().splitlines()
    lines = [lines[0], *(line.replace("PAOR", oils[k // 4 % len(oils)]) for k, line in enumerate(lines[1:]))]
    (data := tmp_path / "DATA.csv").write_text("\n".join(lines) + "\n")
    card["oil"] = {"nu40": 200.0, "nu100": 21.0, "rho15": 880.0, "alpha_T": 6.5e-4}
    (tmp_path / "CARD.json").write_text(json.dumps(card))
    inputs = read_inputs(Request(data, card=tmp_path / "CARD.json"))
    findings = of_hypothesis(inputs, causes)
    rig, fmu = tmp_path / "rig.toml", tmp_path / "rig.fmu"
    rig.write_text(extended_text(inputs, findings))
    assert gearheat("export", "planetary", "--extended", rig, "-o", fmu).code == 0
    left = errors(fmu, data, card, inputs.oils if len(oils) > 1 else None)
    print(causes, oils, left, findings.played)
    ran = gearheat("run", "--extended", rig, "--data", data, "--card", tmp_path / "CARD.json", "--workers", "1",
                   "--out", tmp_path / "out", "--json", "-")  # fmt: skip
    rows = ran.json["rows"]
    for channel, column in (("T_oil", "T_oil_C"), ("T_wall", "T_wall_C"), ("loss", "loss_Nm")):
        stated = findings.played[channel][1]
        assert left[channel] == pytest.approx(stated, abs=SAME), channel
        shown = np.sqrt(np.mean([(row[column] - row[f"{column}_meas"]) ** 2 for row in rows]))
        assert shown == pytest.approx(stated, abs=SAME), channel


def test_a_card_belongs_to_measured_data(case, gearheat):
    (problem,) = gearheat("run", "--card", case / "CARD.json").problems()
    assert "--data" in problem


def test_a_nominal_rig_that_runs_away_gives_way_to_the_explained_one_without_its_cause(case):
    inputs = read_inputs(Request(case / "DATA.csv", card=case / "CARD.json", predict=case / "POINTS.csv"))
    theta = of_hypothesis(inputs, ("losses.churning",)).hypotheses[0].theta
    problem = problem_of(inputs)
    healthy = problem.linearised(np.full(len(problem.parameters.names), 0.3))
    explained = Hypothesis(("losses.churning",), 0.0, theta, linear=healthy)
    bent = replace(healthy, values={**healthy.values, "gear_set.k_mu": 1e4})
    known = Predictor(problem, healthy, ((1.0, explained),), inputs.oils)(inputs.points)
    instead = Predictor(problem, bent, ((1.0, explained),), inputs.oils)(inputs.points)
    assert (known[1] > known[0] + 1).all()
    np.testing.assert_array_equal(instead, known)
    with pytest.raises(SolveError):
        Predictor(problem, bent, ((1.0, Hypothesis((), 0.0, linear=bent)),), inputs.oils)(inputs.points)
