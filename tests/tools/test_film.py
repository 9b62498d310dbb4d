"""The command `film`: maps of a contact and of a part, resumed, drawn, fitted, and refused by name."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from film_tables import CASE, written
from gearheat.model.contact import solve
from gearheat.scenarios.film_map import read_film_map
from gearheat.scenarios.load import load
from gearheat.tools.films import film
from gearheat.tools.films.case import from_rig

SMALL = ("--grid", "2x2x2", "--nodes", "61")


@pytest.fixture
def case(tmp_path: Path) -> Path:
    path = tmp_path / "disc.toml"
    path.write_text(CASE, encoding="utf-8")
    return path


def test_a_map_of_a_contact_with_picture_and_law(gearheat, case, tmp_path):
    out, plot = tmp_path / "map.csv", tmp_path / "map.svg"
    answer = gearheat("film", case, "-o", out, "--plot", plot, *SMALL, "--json", "-")
    assert answer.code == 0, answer.err
    found = json.loads(answer.out)
    assert (found["contacts"], found["failed"], found["shape"]) == (8, [], "line")
    assert found["fit"]["h_c"]["largest"] < 1e-6  # as many terms as contacts
    assert plot.read_text("utf-8").startswith("<svg")
    assert not list(tmp_path.glob("*.part"))
    law = read_film_map(out).law
    made = film.case_of(case)
    point = np.array([2000.0, 2.0, 348.15])
    contact = film.contact_at(made, point)
    h, _ = law.films(contact.lubricant.eta_0, 2 * contact.u_m, contact.F / contact.length, contact.R_x)
    assert h == pytest.approx(solve(contact, n=61).h_c, rel=0.02)  # between the points


def test_the_same_case_gives_the_same_bytes_and_goes_on_where_it_was_interrupted(gearheat, case, tmp_path, monkeypatch):
    first, second = tmp_path / "first.csv", tmp_path / "second.csv"
    assert gearheat("film", case, "-o", first, *SMALL).code == 0
    real, left = film._solution, [3]

    def interrupted(contact, nodes):
        if not left[0]:
            raise KeyboardInterrupt
        left[0] -= 1
        return real(contact, nodes)

    monkeypatch.setattr(film, "_solution", interrupted)
    assert gearheat("film", case, "-o", second, *SMALL).code == 130
    monkeypatch.setattr(film, "_solution", real)
    answer = gearheat("film", case, "-o", second, *SMALL)
    assert "3 of 8 contacts were solved before" in answer.err
    assert second.read_bytes() == first.read_bytes()


def test_contacts_without_a_film_are_named(gearheat, case, tmp_path, monkeypatch):
    real = film._solution
    fails = lambda c, n: [0.0] * 6 if c.F > 3000 and c.u_m > 3 else real(c, n)  # noqa: E731
    monkeypatch.setattr(film, "_solution", fails)
    out = tmp_path / "map.csv"
    answer = gearheat("film", case, "-o", out, "--grid", "2x3x2", "--nodes", "61")
    assert answer.code == 0, answer.err
    assert "without a film: F = 4000 N, u_m = 4 m/s, T = 60 degC: no film found" in answer.out
    assert answer.out.count("no film found") == 2
    assert out.read_text("utf-8").count(",failed,") == 2


def test_a_part_of_a_rig_tells_its_contact():
    case = from_rig(load("helical_two_stage"), "stage_1", ["F=500..1000 N"])
    assert case.part == "stage_1"
    ranges = {axis.name: (axis.first, axis.second) for axis in case.axes}
    assert ranges["F"] == (500, 1000)
    assert ranges["u_m"][1] / ranges["u_m"][0] == pytest.approx(8)
    assert case.contact.R_x == pytest.approx(0.0055, rel=0.2)
    assert case.contact.E_eff == pytest.approx(206e9 / 0.91, rel=1e-6)
    eta_0, alpha_p = case.oil(313.15)
    assert eta_0 == pytest.approx(220e-6 * 880, rel=0.03)
    assert 15e-9 < alpha_p < 30e-9


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('F = "1000..4000 N"', "", "F is missing (normal force)"),
        ('F = "1000..4000 N"', 'F = "0..4000 N"', 'F = "0 N" is out of range'),
        ('R_x = "10 mm"', 'R_x = "0 mm"', "R_x = 0 is out of range"),
        ('R_x = "10 mm"', "R_x = 10", "R_x = 10 has no unit"),
        ('R_x = "10 mm"', 'R_z = "10 mm"', 'unknown key "R_z"'),
        ('length = "10 mm"', "", "length is missing"),
        ('oil = "ISO VG 220 mineral"', 'oil = "ISO VG 221"', 'unknown oil "ISO VG 221"'),
        ('oil = "ISO VG 220 mineral"', "", "eta_0 is missing"),
        ('T = "60..90 degC"', 'P = "60..90 degC"', 'a map does not vary "P"'),
        ('source = "assumed: a disc machine"', "", "source"),
        ("[vary]", "[varied]", "unknown table [varied]"),
    ],
)
def test_a_bad_case_is_refused(gearheat, case, tmp_path, old, new, says):
    assert old in CASE
    case.write_text(CASE.replace(old, new, 1), encoding="utf-8")
    answer = gearheat("film", case, "-o", tmp_path / "map.csv", *SMALL)
    assert answer.code == 2
    assert says in answer.err, answer.err
    assert not (tmp_path / "map.csv").exists()


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("helical_two_stage", "-o", "map.csv"), "Name one of them with --part: stage_1, stage_2"),
        (("helical_two_stage", "-o", "map.csv", "--part", "stage_3"), 'there is no part "stage_3"'),
        (("helical_two_stage", "-o", "map.csv", "--part", "oil"), "oil has no contact with a film"),
        (("harmonic_printed", "-o", "map.csv"), "no part has a contact with a film"),
        (
            ("rv_stage", "-o", "map.csv", "--part", "mesh", "--set", "output.tau=0 N.m"),
            "a contact without load or speed",
        ),
        (("none.toml", "-o", "map.csv"), "none.toml: there is no such file"),
        (("disc.toml", "-o", "map.txt"), "-o map.txt: unknown kind of file"),
        (("disc.toml", "-o", "map.csv", "--plot", "map.pdf"), "--plot map.pdf: unknown kind of file"),
        (("disc.toml", "-o", "map.csv", "--grid", "3x3"), "--grid 3x3: does not fit F, u_m, T"),
        (("disc.toml", "-o", "map.csv", "--part", "stage_1"), "--part and --set belong to a rig"),
        (("disc.toml", "-o", "map.csv", "--vary", "u=1..2 m/s"), 'a map does not vary "u"'),
        (("disc.toml", "-o", "map.csv", "--grid", "2x2x2", "--nodes", "9"), "at least 51 nodes"),
    ],
)
def test_bad_options_are_refused(gearheat, case, tmp_path, monkeypatch, arguments, says):
    monkeypatch.chdir(tmp_path)
    answer = gearheat("film", *arguments)
    assert answer.code == 2
    assert says in answer.err, answer.err


def test_a_film_is_chosen_on_the_command_line(gearheat, tmp_path):
    written(tmp_path / "map.csv")
    answer = gearheat("show", "helical_two_stage", "--json", "-")
    assert {c["name"]: c["value"] for c in json.loads(answer.out)["choices"]}["stage_1.film"] == "grubin"
    chosen = f"stage_1.film=map:{tmp_path / 'map.csv'}"
    answer = gearheat("steady", "helical_two_stage", "--set", chosen, "--set", "input.w=20 rpm", "--json", "-")
    assert answer.code == 0, answer.err
    assert any(o["law"] == "film_map" for o in json.loads(answer.out)["outside"])
    answer = gearheat("steady", "helical_two_stage", "--set", "stage_1.film=map:none.csv")
    assert answer.code == 2
    assert "none.csv: there is no such file" in answer.err


@pytest.mark.parametrize(("slope", "found"), [(0.3, film.FOUND), (2.0, film.COARSE)])
def test_an_ellipse_on_too_coarse_a_grid_has_no_film(case, monkeypatch, slope, found):
    """A film whose error falls with the square of the number of nodes, known on 65 of them and on every other one."""
    case.write_text(CASE.replace('length = "10 mm"', 'length = "10 mm"\nR_y = "20 mm"'), encoding="utf-8")
    made = film.case_of(case)

    def solved(contact, n):
        h = 1e-7 / (1 + slope * (32 / (n - 1)) ** 2)
        return SimpleNamespace(h_c=h, h_min=h, mu=0.03, asperity_share=0.0, p=np.array([1e9]))

    monkeypatch.setattr(film, "solve", solved)
    assert film._solution(made.contact, 65)[-1] == found
    assert film.WRONG[film.COARSE] == ("coarse", "the grid is too coarse; give more --nodes")


def test_an_ellipse_needs_a_grid_to_compare_with(gearheat, case, tmp_path):
    case.write_text(CASE.replace('length = "10 mm"', 'length = "10 mm"\nR_y = "20 mm"'), encoding="utf-8")
    answer = gearheat("film", case, "-o", tmp_path / "map.csv", "--nodes", "33")
    assert answer.code == 2
    assert "--nodes 33: give 2^k + 1, at least 65" in answer.err
