"""Files of published numbers: tables of numbers beside them, values that all rows set, and everything wrong at once."""

from __future__ import annotations

from pathlib import Path

import pytest
from gearheat.model.errors import ScenarioError
from gearheat.model.units import in_unit, kind_of, si_of
from gearheat.scenarios.published import read_published

SHEET = """
[set]
"gears.power_flow" = "ideal"

[[row]]
name = "one"
where = "table 1"
published = "3 W"
tol = 0.5
run = "steady"
set = { oil.V = "2 l" }
path = "oil.T"

[[table]]
name = "losses"
where = "table 2"
data = "losses.csv"
kind = "published"
tol = 0.3
unit = "W"
run = "losses"
keys = ["test"]
[table.columns]
P_mesh_W = { path = "max(P_mesh_W)", select = { direction = 1 } }
"""


def written(folder: Path, text: str, csv: str = "# note, with a comma\ntest,P_mesh_W\n1,3.5\n2,4\n") -> Path:
    (folder / "losses.csv").write_text(csv, encoding="utf-8")
    path = folder / "published.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_table_makes_a_row_of_each_number(tmp_path: Path) -> None:
    one, first, second = read_published(written(tmp_path, SHEET))
    assert one.set == {"gears.power_flow": "ideal", "oil.V": "2 l"}
    assert (first.name, first.published, first.unit, first.group) == ("losses: test 1, P_mesh_W", 3.5, "W", "losses")
    assert second.select == {"test": 2.0, "direction": 1}
    assert second.set == {"gears.power_flow": "ideal"}


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('published = "3 W"\n', "", "has no number. Give published, corrected or recomputed."),
        ("tol = 0.5", "tol = 0.5\ncorrected = 4", "why is missing"),
        ("tol = 0.5", 'tol = 0.5\ncorrected = "3 W"\nwhy = "x"', "corrected is the published number"),
        ("tol = 0.5", "tol = 0.5\nrel = 0.1", "has both tol and rel"),
        ("tol = 0.5", "tol = 0.5\nrecomputed = 4", "recomputed stands beside a printed number"),
        ('path = "oil.T"', "", 'path is missing for run = "steady"'),
        ('path = "oil.T"', 'path = "oil.T"\nfree = "oil.V"', 'free means nothing with run = "steady"'),
        ('run = "steady"', 'run = "rows"\nof = { a = "two" }', 'there is no row "two"'),
        ('keys = ["test"]', 'keys = ["tests"]', "losses.csv has no column tests"),
        ('data = "losses.csv"', 'data = "other.csv"', "there is no such file"),
    ],
)
def test_what_does_not_fit_is_named(tmp_path: Path, old: str, new: str, says: str) -> None:
    assert old in SHEET
    with pytest.raises(ScenarioError) as caught:
        read_published(written(tmp_path, SHEET.replace(old, new)))
    assert says in str(caught.value)


def test_problems_of_rows_and_of_tables_come_together(tmp_path: Path) -> None:
    text = SHEET.replace('path = "oil.T"', "")
    with pytest.raises(ScenarioError) as caught:
        read_published(written(tmp_path, text, "test,P_mesh_W\n1,3.5\nb,4\n2,x\n"))
    assert len(caught.value.problems) == 3
    assert "losses.csv line 4" in str(caught.value)


@pytest.mark.parametrize(
    ("unit", "one"), [("degC", -272.15), ("kW", 1e-3), ("rpm", 9.549296585513721), ("W at 250 K", 250.0), ("1", 1.0)]
)
def test_one_in_si_in_other_units(unit: str, one: float) -> None:
    assert in_unit(1.0, unit) == pytest.approx(one, rel=1e-12)


def test_units_of_a_kind() -> None:
    assert kind_of("W at 250 rpm") == kind_of("N.m") == kind_of("kJ")
    assert kind_of("degC") == kind_of("K (difference)")
    assert kind_of("W") != kind_of("N.m")
    with pytest.raises(ScenarioError, match='there is no unit "furlog"'):
        kind_of("furlog")
    assert si_of("85 degC") == pytest.approx(358.15)
    assert si_of(3) == 3
