"""The command `diagnose` around an inference: all problems at once, files whole or not at all."""

from __future__ import annotations

import json
from importlib.resources import files
from pathlib import Path

import pytest
from fabricated_findings import explained
from gearheat.fmu.compiling import Progress
from gearheat.model.errors import DataError
from gearheat.scenarios.shipped import RIGS
from gearheat.tools.cli import app as cli
from gearheat.tools.diagnose import api, diagnosis
from gearheat.tools.diagnose.answer.findings import Findings, Prediction
from gearheat.tools.diagnose.api import Outputs
from gearheat.tools.diagnose.request import Inputs, Request
from gearheat.tools.show.console import as_json
from jsonschema import validate
from threadpoolctl import threadpool_info, threadpool_limits
from typer.testing import CliRunner

RIG = "planetary"
DATA = RIGS / RIG / "measured.csv"


def infer(inputs: Inputs, progress: Progress) -> Findings:
    """Findings that need no work."""
    progress("thinking", 0.5)
    said = explained(
        extended_rig='kind = "network"\n',
        predictions=(Prediction(point="1", nominal={"T_oil": 60.0}, extended={"T_oil": 61.5}),),
    )
    return said.model_copy(update={"about": said.about.model_copy(update={"readings": inputs.data.n})})  # type: ignore[union-attr]


def diagnose_command(data: Path | None, outputs: Outputs, infer, rig: str = RIG, **options) -> None:
    """What the command does with an inference."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(diagnosis, "diagnose", infer)
        (found := api.diagnose(data, rig, outputs=outputs, **options)).write(outputs)
    print(as_json(found.as_dict()) if outputs.json == "-" else found.text(), end="")


def test_everything_is_written_whole(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    outputs = Outputs(tmp_path / "p.csv", str(tmp_path / "o.json"), tmp_path / "o.html", tmp_path / "o.toml")
    diagnose_command(DATA, outputs, infer, predict=DATA)
    assert (tmp_path / "p.csv").read_text() == "point,T_oil_nominal_C,T_oil_extended_C\n1,60.000,61.500\n"
    found = json.loads((tmp_path / "o.json").read_text())
    schema = files("gearheat.tools.diagnose.report").joinpath("diagnosis.schema.json")
    validate(found, json.loads(schema.read_text(encoding="utf-8")))
    assert found["about"]["readings"] > 10
    assert (tmp_path / "o.html").read_text().startswith("<!doctype html>")
    assert (tmp_path / "o.toml").read_text() == 'kind = "network"\n'
    shown = capsys.readouterr()
    assert shown.out.startswith("verdict    One cause explains the data")
    assert shown.err == "", "no bar where there is no terminal"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["o.html", "o.json", "o.toml", "p.csv"]


def test_rows_that_a_test_lacks_are_no_readings() -> None:
    case = Path(__file__).parents[2] / "challenge" / "practice_cases" / "rough_005"
    found = api.diagnose(case / "data.csv", RIG, card=case / "card.json", reference=case / "reference.csv", quick=True)
    rows = [len((case / name).read_text().splitlines()) - 1 for name in ("data.csv", "reference.csv")]
    assert [found.about.readings, found.about.reference_readings] == rows == [26, 28]
    assert any("rows are missing" in text for text in found.warnings)


def test_linear_algebra_has_one_thread_while_it_runs() -> None:
    threads = []

    def counting(inputs: Inputs, progress: Progress) -> Findings:
        threads.extend(pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas")
        return infer(inputs, progress)

    with threadpool_limits(2, "blas"):
        diagnose_command(DATA, Outputs(), counting)
        assert {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"} == {2}
    assert threads and set(threads) == {1}


def test_json_alone_goes_to_stdout(capsys: pytest.CaptureFixture[str]) -> None:
    diagnose_command(DATA, Outputs(json="-"), infer)
    assert json.loads(capsys.readouterr().out)["verdict"] == "explained"


def test_all_problems_at_once(tmp_path: Path) -> None:
    (card := tmp_path / "card.toml").write_text("day_cooling_sd = -1.0\n")
    page = tmp_path / "page"
    outputs = Outputs(page, str(tmp_path / "nowhere" / "o.json"), page, card)
    with pytest.raises(DataError) as caught:
        options = {"reference": tmp_path / "none.csv", "causes": 0, "alpha": 1e-4, "seed": -1}
        diagnose_command(DATA, outputs, infer, card=card, **options)
    told = "\n".join(caught.value.problems)
    words = ("--alpha 0.0001", "--causes 0", "--seed -1", "--reference", "there is no such file", "day_cooling_sd")
    words += ("--predictions needs the points", "nowhere", "is the file of --card", "is the file of --predictions")
    for word in words:
        assert word in told, word
    assert list(tmp_path.iterdir()) == [card]


def test_a_card_that_cannot_be_read_is_the_one_problem(tmp_path: Path) -> None:
    (card := tmp_path / "card.toml").write_text("columns = {")
    for wrong, told in ((card, "TOML syntax"), (tmp_path, "is a folder")):
        with pytest.raises(DataError, match=told) as caught:
            diagnose_command(DATA, Outputs(), infer, card=wrong)
        assert len(caught.value.problems) == 1


def test_a_series_needs_the_readings_of_its_tests() -> None:
    request = Request(RIG, series=DATA, reference_series=DATA)
    told = "\n".join(request.problems())
    assert "--series needs the readings" in told and "--reference-series needs the readings" in told
    assert {"--series", "--reference-series"} <= {name for name, _ in request.files()}


def test_logs_alone_predict_no_points_and_extend_no_rig(tmp_path: Path) -> None:
    points = tmp_path / "points.csv"
    outputs = Outputs(predictions=tmp_path / "p.csv", extended=tmp_path / "e.toml")
    with pytest.raises(DataError) as caught:
        diagnose_command(None, outputs, infer, logs=[DATA], predict=points)
    told = "\n".join(caught.value.problems)
    assert "--predict needs a table of readings" in told and "--extended needs a table of readings" in told
    assert list(tmp_path.iterdir()) == []


def test_no_data_and_no_rig_are_told_together() -> None:
    with pytest.raises(DataError) as caught:
        diagnose_command(None, Outputs(), infer, "planetry")
    told = "\n".join(caught.value.problems)
    assert "no data are given" in told
    assert "planetary" in told


def test_an_interrupted_run_writes_nothing(tmp_path: Path) -> None:
    def interrupted(inputs: Inputs, progress: Progress) -> Findings:
        raise KeyboardInterrupt

    before = tmp_path / "o.json"
    before.write_text("earlier")
    with pytest.raises(KeyboardInterrupt):
        diagnose_command(DATA, Outputs(None, str(before), tmp_path / "o.html"), interrupted)
    assert before.read_text() == "earlier"
    assert list(tmp_path.iterdir()) == [before]


def test_the_command_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(diagnosis, "diagnose", infer)
    done = CliRunner().invoke(cli.app, ["diagnose", str(DATA), "--rig", RIG, "--all", "--seed", "3"])
    assert done.exit_code == 0, done.output
    assert "Smallest size found in 80 of 100 such campaigns" in done.output
    wrong = CliRunner().invoke(cli.app, ["diagnose", "--rig", RIG, "--logs", str(tmp_path / "no.csv")])
    assert wrong.exit_code == 2
    assert "--logs" in wrong.output
