"""The command `verify`: every published number of every shipped rig stands, and a wrong one fails."""

from __future__ import annotations

import re
from pathlib import Path

import gearheat as gh
import pytest
from gearheat.model.errors import ScenarioError
from gearheat.scenarios.load import RIGS, list_rigs
from gearheat.scenarios.published import Row, golden_rows, read_published
from gearheat.tools.docs.blocks import PAGES
from gearheat.tools.verify.verdicts import CONTRADICTED, NOT_REPRODUCED, REPRODUCED, VERDICTS, Value, judge
from gearheat.tools.verify.verify import CATALOGUES, Plates, _judge_rows, _tell_losses, law_of
from pages import problems_of

PAGE = (PAGES / "trust" / "verified.md").read_text(encoding="utf-8")
#: A line of its table of counts: name, then six numbers.
LINE = r"^\| ([a-z]\w*(?: all)?) \| (\d[\d |]*)\|$"
ROW = {"name": "a number", "where": "nowhere", "run": "steady", "path": "oil.T"}


def row(**values: object) -> Row:
    return Row.model_validate(ROW | values)


def test_every_number_of_every_rig_and_the_counts_of_the_page(gearheat, tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    answer = gearheat("verify", "--json", "-", "--html", page)
    found = answer.json
    assert problems_of(page.read_text(encoding="utf-8")) == []
    parts = {**{machine["name"]: machine for machine in found["machines"]}, "laws": found["laws"], "in all": found}
    every = [row for part in parts.values() for row in part.get("rows", ())]
    assert not [row for row in every if row["verdict"] not in (REPRODUCED, CONTRADICTED)]
    assert not [row["name"] for row in every if row["verdict"] == CONTRADICTED and not row["why"]]
    assert answer.code == 0
    assert parts.keys() >= set(list_rigs())
    assert page.read_text(encoding="utf-8").count("<h2>") == len(list_rigs()) + 3  # catalogues, laws and sources
    told = {r["name"]: r for r in parts["catalogues"]["rows"]}
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in PAGE.splitlines()]
    beside = {c[0]: c[2:] for c in cells if c[0] in told}
    assert len(beside) > 20
    assert beside == {name: [f"{told[name]['model']:.1f} %", told[name]["why"].split()[1]] for name in beside}
    warm = [r["model"] for r in told.values() if r["unit"] == "W/K"]
    given_off = [float(value) for c in cells if c[0].startswith("a = ") for value in c[2].split("; ")]
    assert given_off == pytest.approx(warm, rel=0.005)
    printed = {name: [int(n) for n in cells.split("|")[:6]] for name, cells in re.findall(LINE, PAGE, re.MULTILINE)}
    counted = {name: [*part["counts"].values(), *part["kinds"].values()] for name, part in parts.items()}
    assert printed == {name: numbers for name, numbers in counted.items() if any(numbers)}


def test_the_breakdown_of_the_planetary_rig_has_every_test_and_part() -> None:
    cells = [r for r in read_published(RIGS / "planetary" / "published.toml") if r.group]
    assert len(cells) == 36 * 7
    assert all(r.tol == 0.3 and r.run == "losses" for r in cells)


def test_catalogues_are_20_statements_or_more_and_their_ratio_is_told() -> None:
    """Rows of makers need no rig; of one machine here, all in `test_every_number_of_every_rig_...`."""
    rows = read_published(CATALOGUES)
    assert len(rows) >= 20
    assert all(r.where and r.expected is not None for r in rows)
    one = next(r for r in rows if r.run == "new")
    (verdict,) = _judge_rows([one], Plates(gh.new), lambda _: None)
    told = _tell_losses(verdict)
    assert told.verdict == REPRODUCED
    assert told.why == f"losses {(100 - told.model) / (100 - one.published):.2f} of those published"


def test_golden_rows_of_laws_are_rows_as_well() -> None:
    rows = golden_rows()
    assert {r.run for r in rows} == {"law"}
    assert all(law_of(r) is not None and r.where for r in rows)
    corrected = [r for r in rows if r.corrected is not None and r.published is not None]
    assert corrected and all(r.why for r in corrected)


class TestVerdicts:
    def test_within_the_tolerance_in_the_unit_of_the_number(self) -> None:
        """A tolerance in K is one in degC; one in mm is one in um."""
        warm = row(published="139.1 degC", tol="0.6 K")
        assert judge(warm, Value(273.15 + 139.5, "K")).verdict == REPRODUCED
        assert judge(warm, Value(273.15 + 139.8, "K")).verdict == NOT_REPRODUCED
        assert judge(warm, Value(273.15 + 139.5, "K")).model == pytest.approx(139.5)
        film = row(published="0.88 um", tol="0.001 mm", path="mesh.h_min")
        assert judge(film, Value(1.8e-6, "m")).verdict == REPRODUCED
        assert judge(film, Value(1.9e-6, "m")).verdict == NOT_REPRODUCED

    def test_relative_to_the_corrected_number(self) -> None:
        both = row(published="2 W", corrected="4 W", why="twice", rel=0.1, path="P")
        assert judge(both, Value(3.7, "W")).verdict == CONTRADICTED
        assert judge(both, Value(2.0, "W")).verdict == NOT_REPRODUCED

    def test_a_recomputed_number_contradicts_nothing(self) -> None:
        assert judge(row(recomputed="4 W", tol=0.1), Value(4.0, "W")).verdict == REPRODUCED
        assert judge(row(corrected="4 W", why="hand", tol=0.1), Value(4.0, "W")).kind == "recomputed"

    def test_a_contradiction_shows_what_the_model_gives(self) -> None:
        found = judge(row(published="1 MPa", contradiction=True, why="no closed form"), Value(2e6, "Pa"))
        assert (found.verdict, found.model, found.unit, found.why) == (CONTRADICTED, 2.0, "MPa", "no closed form")

    def test_words_in_print_that_begin_with_a_number_have_no_unit(self) -> None:
        words = row(published="1 - x / P = -61", corrected=0.9996, why="sign", tol=0.001, path="eta")
        assert judge(words, Value(0.9995)).verdict == CONTRADICTED
        shown = row(published="1 of 4", contradiction=True, why="three", unit="1", path="n")
        assert judge(shown, Value(3.0)).model == 3.0

    def test_a_statement_holds_or_not(self) -> None:
        assert judge(row(published="rising"), Value(True)).verdict == REPRODUCED
        assert judge(row(published="rising"), Value(False)).verdict == NOT_REPRODUCED
        corrected = row(published="rising", corrected="falling", why="sign")
        assert judge(corrected, Value(True)).verdict == CONTRADICTED

    def test_no_solution_is_not_reproduced_and_says_why(self) -> None:
        found = judge(row(published="1 degC", tol="1 K"), Value(None, problem="no steady state"))
        assert (found.verdict, found.why, found.shown) == (NOT_REPRODUCED, "no steady state", "no solution")

    @pytest.mark.parametrize(
        ("values", "value", "says"),
        [
            ({"published": "3 W", "tol": 1}, Value(300.0, "K"), "does not fit K"),
            ({"published": "3 degC", "tol": "1 W"}, Value(300.0, "K"), 'tol = "1 W" does not fit "degC"'),
            ({"published": "warm", "tol": "1 K"}, Value(300.0, "K"), "is no number with a unit"),
            ({"published": "3 degC"}, Value(300.0, "K"), "has no tolerance"),
            ({"published": 3, "tol": 1}, Value(300.0, "K"), "has no unit"),
            ({"published": "3 xyzzy", "tol": 1}, Value(300.0, "m"), 'there is no unit "xyzzy"'),
        ],
    )
    def test_rows_that_do_not_fit_their_value_are_refused(self, values, value, says) -> None:
        with pytest.raises(ScenarioError, match=re.escape(says)):
            judge(row(**values), value)


GOOD = """
[[row]]
name = "ratio"
where = "by construction"
published = "12.6"
rel = 0.01
run = "steady"
path = "input.w / output.w"

[[row]]
name = "ratio over itself"
where = "by construction"
published = 1
tol = 1e-9
run = "rows"
of = { i = "ratio" }
path = "i / i"

[[row]]
name = "area that holds 40 degC, over 0.1 m2"
where = "by construction"
published = "more"
run = "design"
free = "cooling.A"
target = "oil.T=40 degC"
path = "cooling.A > 0.1"
"""
WRONG = (
    GOOD
    + """
[[row]]
name = "oil"
where = "nowhere"
published = "20 degC"
tol = "1 K"
run = "steady"
set = { "room.T" = "30 degC" }
path = "oil.T"
"""
)


CONTACTS = """
[[row]]
name = "torque of the pins over that of the disc"
where = "by construction"
published = 1
tol = 1e-3
run = "contacts"
path = "torque_recovery"

[[row]]
name = "angle"
where = "by construction"
published = "60 deg"
tol = 1e-9
unit = "deg"
run = "contacts"
path = "radians(theta_deg)"
at = 60

[[row]]
name = "films"
where = "by construction"
published = "above zero"
run = "contacts"
path = "min(h_c_m) > 0"
"""


@pytest.fixture
def reducer(tmp_path: Path):
    """A rig of one's own with published numbers beside it."""

    def made(published: str | None) -> Path:
        folder = tmp_path / "own"
        folder.mkdir(exist_ok=True)
        text = (RIGS / "helical_two_stage" / "rig.toml").read_text(encoding="utf-8")
        (folder / "rig.toml").write_text(text, encoding="utf-8")
        if published is not None:
            (folder / "published.toml").write_text(published, encoding="utf-8")
        return folder

    return made


class TestCommand:
    def test_rows_that_hold_end_with_zero(self, gearheat, reducer) -> None:
        answer = gearheat("verify", reducer(GOOD), "--json", "-")
        assert answer.code == 0, answer.err
        (machine,) = answer.json["machines"]
        assert machine["counts"] == {NOT_REPRODUCED: 0, CONTRADICTED: 0, REPRODUCED: 3}
        assert machine["kinds"] == {"published": 2, "statement": 1, "recomputed": 0}

    def test_a_wrong_number_is_not_reproduced_and_ends_with_one(self, gearheat, reducer) -> None:
        folder = reducer(WRONG)
        answer = gearheat("verify", folder)
        assert answer.code == 1
        assert "1 published number is not reproduced: own: oil." in " ".join(answer.out.split())
        assert answer.out.index("oil") < answer.out.index("ratio over itself")  # what fails is seen first
        found = gearheat("verify", folder, "--json", "-")
        assert found.code == 1
        assert [r["name"] for r in found.json["machines"][0]["rows"] if r["verdict"] == NOT_REPRODUCED] == ["oil"]

    def test_keys_of_the_json(self, gearheat, reducer) -> None:
        found = gearheat("verify", reducer(GOOD), "--json", "-").json
        assert list(found) == ["schema", "counts", "kinds", "machines", "laws", "sources"]
        assert found["schema"] == "gearheat.verify/1"
        (machine,) = found["machines"]
        assert list(machine) == ["name", "doc", "reproduces", "counts", "kinds", "rows", "errata"]
        keys = {"name", "where", "kind", "run", "published", "corrected", "recomputed", "model", "unit", "expected"}
        keys |= {"tolerance", "verdict", "why"}
        assert keys <= machine["rows"][0].keys()
        assert keys | {"law"} <= found["laws"]["rows"][0].keys()
        assert list(found["counts"]) == list(VERDICTS)
        assert 0 < len(found["laws"]["rows"]) < len(golden_rows())  # those that this rig uses

    def test_the_page_stands_alone_and_holds_every_row(self, gearheat, reducer, tmp_path) -> None:
        folder, page = reducer(WRONG), tmp_path / "page.html"
        answer = gearheat("verify", folder, "--html", page, "--json", tmp_path / "rows.json")
        assert answer.code == 1
        text = page.read_text(encoding="utf-8")
        assert not re.search(r"(src|href)=|url\(|@import", text)
        for name in ("ratio", "ratio over itself", "oil"):
            assert f"<td>{name}</td>" in text
        assert text.count('<tr class="fails">') >= 2  # the row, and the line of the rig
        gearheat("verify", folder, "--html", tmp_path / "again.html")
        assert (tmp_path / "again.html").read_bytes() == page.read_bytes()

    def test_a_rig_without_published_numbers_says_so(self, gearheat, reducer) -> None:
        answer = gearheat("verify", reducer(None))
        assert answer.code == 0
        assert "own: has no published numbers." in answer.out

    def test_an_unknown_rig(self, gearheat) -> None:
        answer = gearheat("verify", "planetry")
        assert answer.code == 2
        assert 'Did you mean "planetary"' in answer.err

    def test_all_problems_of_a_file_at_once(self, gearheat, reducer) -> None:
        broken = GOOD.replace('free = "cooling.A"', 'fre = "cooling.A"').replace('run = "rows"', 'run = "guess"')
        answer = gearheat("verify", reducer(broken))
        assert answer.code == 2 and len(answer.problems()) == 2
        assert 'unknown key "fre". Did you mean "free"' in answer.err
        assert "run = 'guess' does not fit: it should be 'steady', 'held', " in answer.err

    def test_all_names_that_the_rig_does_not_have_at_once(self, gearheat, reducer) -> None:
        broken = (
            WRONG.replace("input.w /", "inputt.w /").replace('"room.T"', '"rom.T"').replace("cooling.A >", "foo(2) >")
        )
        answer = gearheat("verify", reducer(broken))
        assert answer.code == 2
        assert 'unknown name "rom.T". Did you mean "room.T"' in answer.err
        assert "inputt.w" in answer.err and '"foo(2)"' in answer.err
        assert "Traceback" not in answer.err

    def test_what_has_no_solution_is_not_reproduced_nor_what_follows_from_it(self, gearheat, reducer) -> None:
        """No area cools the oil below the room; what is computed from that row has no value either."""
        rows = GOOD.replace("oil.T=40 degC", "oil.T=5 degC").replace(
            '{ i = "ratio" }', '{ i = "area that holds 40 degC, over 0.1 m2" }'
        )
        answer = gearheat("verify", reducer(rows), "--json", "-")
        assert answer.code == 1
        _, over, area = answer.json["machines"][0]["rows"]
        assert over["verdict"] == area["verdict"] == NOT_REPRODUCED
        assert "out of reach" in area["why"] and "no solution of: area" in over["why"]

    def test_contacts_over_a_mesh_cycle(self, gearheat, tmp_path: Path) -> None:
        """A total, a column at one angle, and a statement over all contacts."""
        (tmp_path / "rig.toml").write_text((RIGS / "rv_stage" / "rig.toml").read_text("utf-8"), encoding="utf-8")
        (tmp_path / "published.toml").write_text(CONTACTS, encoding="utf-8")
        answer = gearheat("verify", tmp_path, "--json", "-")
        assert answer.code == 0, answer.err
        assert [row["model"] for row in answer.json["machines"][0]["rows"]] == [
            pytest.approx(1.0, rel=1e-3),
            pytest.approx(60.0),
            True,
        ]

    def test_a_rig_without_readings_has_no_losses_at_readings(self, gearheat, reducer) -> None:
        rows = GOOD.replace('run = "steady"', 'run = "losses"')
        answer = gearheat("verify", reducer(rows))
        assert answer.code == 2
        assert "ratio: own has no measured readings." in answer.err
