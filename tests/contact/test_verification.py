"""The verification of the contact solver: its quick subset, what it keeps, its pages, and its reference data."""

import json
import sys
from pathlib import Path

import pytest
from gearheat.model.errors import DataError, SolveError
from gearheat.model.laws import film_point
from gearheat.model.sources import sources
from gearheat.tools.bench import contact as peer
from gearheat.tools.cli.app import app
from gearheat.tools.verify.contact import cases, command, pages, rows, steady
from gearheat.tools.verify.contact.rows import Job, bound, row
from pages import problems_of
from typer.testing import CliRunner

ROOT = Path(__file__).parents[2]
REFERENCES = ("hamrock_dowson", "nvm", "line", "ball_on_disc", "rolling_moment")


@pytest.fixture(scope="module")
def quick(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict]:
    """The folder of a quick run, and its answer."""
    out = tmp_path_factory.mktemp("verified")
    result = CliRunner().invoke(app, ["verify-contact", "-o", str(out), "--quick", "--json", "-"])
    assert result.exit_code == 0, result.output
    return out, json.loads(result.stdout)


def test_the_quick_subset_is_within_its_tolerances(quick: tuple[Path, dict]) -> None:
    rows = quick[1]["rows"]
    assert not [r for r in rows if r["verdict"] == "outside"]
    assert {"Hamrock and Dowson", "Nijenbanning, Venner and Moes", "Hertz", "Line contact"} <= {r["item"] for r in rows}
    assert {"Convergence", "Moving dent", "Load"} <= {r["item"] for r in rows}
    assert sum(r["verdict"] == "within" for r in rows) >= 15


def test_what_is_kept_is_not_computed_again_and_gives_the_same_bytes(
    quick: tuple[Path, dict], monkeypatch: pytest.MonkeyPatch
) -> None:
    out, _ = quick
    before = {p.name: p.read_bytes() for p in out.iterdir() if p.is_file()}
    assert {"verification.md", "verification.html", "verification.csv", "films.svg", "convergence.svg"} <= set(before)
    assert problems_of(before["verification.html"].decode()) == []
    assert all(len(content) < 200_000 for name, content in before.items() if name.endswith(".svg"))
    monkeypatch.setattr(steady, "solve", lambda *_, **__: pytest.fail("solved again"))
    command.verify_contact(out, quick=True)
    assert {p.name: p.read_bytes() for p in out.iterdir() if p.is_file()} == before


def test_a_kept_result_of_another_solver_is_void(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    calls = []
    job = Job("item", "name", lambda: calls.append(1) or {"rows": []})
    monkeypatch.setattr(rows, "fingerprint", lambda job: "one")
    rows.run([job], tmp_path)
    rows.run([job], tmp_path)
    assert len(calls) == 1
    monkeypatch.setattr(rows, "fingerprint", lambda job: "two")
    rows.run([job], tmp_path)
    assert len(calls) == 2


def test_a_contact_without_solution_is_a_row_outside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def work() -> dict:
        raise SolveError("contact: no film found")

    monkeypatch.setattr(rows, "fingerprint", lambda job: "one")
    (found,) = rows.run([Job("item", "stiff", work)], tmp_path)
    (line,) = found[1]["rows"]
    assert (line["case"], line["verdict"]) == ("stiff", "outside")


def test_verdicts() -> None:
    assert row("c", "q", 2.0, 2.1, 0.1)["verdict"] == "within"
    assert row("c", "q", 2.0, 2.3, 0.1)["verdict"] == "outside"
    assert row("c", "q", 2.0, 9.0, 0.0)["verdict"] == "reported"
    assert bound("c", "q", 1.6, least=1.7)["verdict"] == "outside"
    assert bound("c", "q", 1.6, most=1.7)["verdict"] == "within"
    lost = pages.rows([(Job("item", "a", dict), {"rows": [row("c", "q", 1.0, 1.0, 0.1, load_error=-2e-4)]})])
    assert [r["verdict"] for r in lost] == ["within", "outside"]


@pytest.mark.parametrize("name", REFERENCES)
def test_reference_data_name_their_source(name: str) -> None:
    found = cases.reference(name)
    assert found.source in sources() or found.source.startswith("computed:")
    assert found.where and len(found.rows) >= 4


def test_hamrock_and_dowson_in_the_range_of_their_formula() -> None:
    rows = cases.reference("hamrock_dowson").rows
    assert len({tuple(r.values()) for r in rows}) >= 30
    for r in rows:
        assert all(low <= r[key] <= high for key, (low, high) in film_point.SOLVED.items())


def test_the_table_of_films_is_the_formula_and_the_other_reading_is_what_is_printed_of_it() -> None:
    for r in cases.reference("nvm").rows:
        assert float(film_point.nijenbanning_central(r["M"], r["L"], 1.0)) == pytest.approx(r["H_c"], rel=1e-3)
    assert steady._other_reading(20, 10) == pytest.approx(4.612, abs=5e-4)
    assert steady._other_reading(20, 2.5) == pytest.approx(2.300, abs=5e-4)


def test_the_readme_shows_the_summary_of_the_last_full_run() -> None:
    page = (ROOT / "model/contact/verification/verification.md").read_text(encoding="utf-8")
    readme = (ROOT / "model/contact/README.md").read_text(encoding="utf-8")
    summary = [line for line in page.partition("\n## ")[0].splitlines() if line.startswith("|")]
    assert len(summary) > 15
    assert "\n".join(summary) in readme
    for line in page.splitlines():
        if line.startswith("!["):
            name = line.partition("(")[2].rstrip(")")
            assert (ROOT / "model/contact/verification" / name).stat().st_size < 200_000
            assert f"verification/{name}" in readme


def test_the_peer_is_compared_at_equal_error() -> None:
    own = [{"n": 33, "s": 1.0, "error": 0.2}, {"n": 65, "s": 2.0, "error": 0.05}, {"n": 129, "s": 4.0, "error": 0.01}]
    assert peer._ratio({"n": 97, "s": 60.0, "error": 0.06}, own) == {"n_slippy": 97, "n": 65, "ratio": 30.0}


def test_without_an_interpreter_the_peer_is_refused_by_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "version_info", (3, 14, 0))
    monkeypatch.setattr(peer.shutil, "which", lambda name: None)
    with pytest.raises(DataError, match=r"slippy needs Python 3\.8 to 3\.11, here is 3\.14"):
        peer._install(tmp_path)
