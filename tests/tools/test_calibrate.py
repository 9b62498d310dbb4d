"""Calibration finds the parameters that made the data, and says what it cannot find."""

from __future__ import annotations

import csv
import io

import pytest


@pytest.fixture
def made(gearheat, rig, tmp_path):
    """A copy of the rig whose five MINR tests were measured on a machine with known area and foot."""
    settings = ("--set", "cooling.A=0.62 m2", "--set", "foot.G=7 W/K")
    arguments = ("--out", tmp_path / "out", "--tests", "22-26", "--jobs", "1", "--json", "-", *settings)
    rows = {row["point"]: row for row in gearheat("run", "planetary", *arguments).json["rows"]}
    table = rig.folder / "measured.csv"
    lines = list(csv.DictReader(io.StringIO(table.read_text())))
    kept = [
        line | {"T_oil_C": f"{rows[int(line['point'])]['T_oil_C']:.6f}"} for line in lines if int(line["point"]) in rows
    ]
    text = io.StringIO()
    writer = csv.DictWriter(text, kept[0], lineterminator="\n")
    writer.writeheader()
    writer.writerows(kept)
    table.write_text(text.getvalue())
    return rig


def test_the_parameters_that_made_the_data_are_found(gearheat, made):
    arguments = ("--grid", "MINR-5", "--free", "cooling.A", "--free", "foot.G", "--json", "-")
    found = gearheat("calibrate", made, *arguments).json
    assert found["readings"] == 10
    assert found["free"]["cooling.A"]["value"] == pytest.approx(0.62, rel=1e-3)
    assert found["free"]["foot.G"]["value"] == pytest.approx(7.0, rel=1e-2)
    assert found["rmse_after_K"] < 1e-3 < found["rmse_before_K"]
    assert found["correlation"]["cooling.A"]["foot.G"] < -0.9


def test_a_value_at_its_bound_has_no_standard_error(gearheat, made):
    arguments = ("--grid", "MINR-5", "--free", "cooling.A", "--free", "foot.G", "--json", "-")
    found = gearheat("calibrate", made, *arguments, "--bounds", "cooling.A=0.7 m2..2 m2").json
    assert found["free"]["cooling.A"]["value"] == pytest.approx(0.7, rel=1e-3)
    assert found["free"]["cooling.A"]["at_bound"] and found["free"]["cooling.A"]["standard_error"] is None
    assert found["free"]["foot.G"]["standard_error"] > 0


def test_empty_cells_take_no_part(gearheat, made):
    head, first, *rest = (table := made.folder / "measured.csv").read_text().splitlines()
    cells = first.split(",")
    cells[head.split(",").index("T_oil_C")] = ""
    table.write_text("\n".join([head, ",".join(cells), *rest]) + "\n")
    found = gearheat("calibrate", made, "--grid", "MINR-5", "--free", "cooling.A", "--json", "-").json
    assert found["readings"] == 9
    assert len(gearheat("losses", made, "--json", "-").json["rows"]) == 9
    assert len(gearheat("losses", made, "--temperature", "model", "--json", "-").json["rows"]) == 10
