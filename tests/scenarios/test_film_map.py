"""Film maps as files: the law gives the films back, holds them at its edges, and bad files are refused by name."""

import pickle

import casadi as ca
import numpy as np
import pytest
from film_tables import E_EFF, LENGTH, LOADS, SPEEDS, VISCOSITIES, R, central, rows, written
from gearheat.model.errors import DataError, ScenarioError
from gearheat.model.sources import recording
from gearheat.scenarios.film_map import read_film_map
from gearheat.scenarios.load import RIGS, load
from gearheat.scenarios.write import rig_text


@pytest.fixture
def law(tmp_path):
    return read_film_map(written(tmp_path / "map.csv"), "map:map.csv").law


def test_the_law_gives_a_power_law_back_between_and_at_the_points(law):
    for F in (100.0, 333.0, 1e4):
        for u_m in (0.1, 0.77, 10.0):
            h_c, h_min = law.films(0.07, 2 * u_m, F / LENGTH, R)
            assert h_c == pytest.approx(central(F, u_m, 0.07), rel=5e-3)
            assert h_min == pytest.approx(0.8 * h_c, rel=1e-3)
    assert max(law.central.error, law.minimum.error) < 1e-8


def test_a_map_holds_for_other_radii(law):
    assert law.films(0.07, 2.0, 500 / LENGTH, 2 * R)[0] == pytest.approx(central(500, 1.0, 0.07, 2 * R), rel=1e-4)


def test_beyond_its_range_the_law_stays_at_the_edge_and_says_so(law):
    edge = law.films(VISCOSITIES[-1], 2 * SPEEDS[-1], LOADS[-1] / LENGTH, R)[0]
    with recording() as uses:
        beyond = law.films(10 * VISCOSITIES[-1], 50 * SPEEDS[-1], 7 * LOADS[-1] / LENGTH, R)[0]
    assert beyond == pytest.approx(edge, rel=0.05)
    used = uses[0]
    assert used.law.name == "film_map"
    assert used.law.where == "map:map.csv"
    assert not used.law.verified
    outside = [k for k, (low, high) in used.law.ranges.items() if not low <= float(used.arguments[k]) <= high]
    assert outside == ["load", "speed", "eta_0"]
    assert law.films(10 * VISCOSITIES[-1], 500 * SPEEDS[-1], 70 * LOADS[-1] / LENGTH, R)[0] == pytest.approx(
        beyond, rel=1e-3
    )


def test_the_law_is_smooth_at_rest_without_load_and_across_its_edges(law):
    v = ca.SX.sym("v", 3)
    films = ca.vertcat(*law.films(v[0], v[1], v[2], R))
    f = ca.Function("f", [v], [films, ca.jacobian(films, v)])
    for point in ((0.07, 0.0, 0.0), (0.07, 2 * SPEEDS[0], 5e3), (0.5, -1.0, -1e4), (1e-4, 1e3, 1e9)):
        value, slope = (x.full() for x in f(point))
        assert np.isfinite(value).all()
        assert np.isfinite(slope).all()
        assert (value > 0).all()
    at, step = np.array([0.07, 2 * SPEEDS[0], 1e4]), 1e-7
    here = (f(at + [0, step, 0])[0] - f(at - [0, step, 0])[0]).full() / (2 * step)
    assert here.ravel() == pytest.approx(f(at)[1].full()[:, 1], rel=1e-4)


def test_the_same_file_gives_the_same_law(tmp_path, law):
    again = read_film_map(written(tmp_path / "map.csv"), "map:map.csv").law
    assert again == law
    assert hash(again) == hash(law)
    assert pickle.loads(pickle.dumps(law)) == law


def changed(at: int, **values):
    """The map with values of one row replaced."""
    table = rows()
    table[at] |= values
    return table


@pytest.mark.parametrize(
    ("table", "without", "says"),
    [
        (None, "h_c [m]", 'column "h_c [m]" is missing'),
        (None, "eta_0 [Pa.s]", 'column "eta_0 [Pa.s]" (dynamic viscosity) is missing'),
        (changed(7, **{"h_c [m]": "nan"}), "", "map.csv line 9: h_c [m]"),
        (changed(7, **{"h_min [m]": ""}), "", 'line 9: h_min [m] has no film, but status is "ok"'),
        (changed(7, **{"F [N]": 0}), "", "The normal force must be above 0"),
        (changed(7, **{"R_x [m]": 0.02}), "", "R_x [m] changes from 0.01 to 0.02"),
        (rows()[:3], "", "3 contacts with a film are too few for a law"),
        ([r | {"status": "failed"} for r in rows()], "", "0 contacts with a film"),
    ],
)
def test_a_bad_map_is_refused(tmp_path, table, without, says):
    with pytest.raises(DataError) as caught:
        read_film_map(written(tmp_path / "map.csv", table, without))
    assert any(says in problem for problem in caught.value.problems), caught.value.problems


def test_contacts_without_a_film_are_left_out(tmp_path):
    failed = {"status": "failed", "h_c [m]": "", "h_min [m]": "", "mu_fluid [1]": ""}
    found = read_film_map(written(tmp_path / "map.csv", changed(7, **failed)))
    assert (found.points, found.failed) == (63, 1)
    assert found.law.central.error < 1e-8


def rig(folder, film: str, E: str = "206 GPa"):
    """The two-stage reducer with a film for its first stage."""
    text = (RIGS / "helical_two_stage" / "rig.toml").read_text("utf-8")
    text = text.replace('E = "206 GPa"', f'E = "{E}"', 1)
    text = text.replace("z_1 = 20\n", f'z_1 = 20\nfilm = "{film}"\n', 1)
    (folder / "rig.toml").write_text(text, encoding="utf-8")
    return load(folder)


def test_a_rig_takes_a_map_from_beside_its_file_and_is_written_with_it(tmp_path):
    written(tmp_path / "map.csv")
    scenario = rig(tmp_path, "map:map.csv")
    film = scenario.spec.part("stage_1").values["film"]
    assert film == read_film_map(tmp_path / "map.csv", "map:map.csv").law
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "rig.toml").write_text(rig_text(scenario), encoding="utf-8")
    again = load(tmp_path / "other").spec.part("stage_1").values["film"]
    assert again.central == film.central


@pytest.mark.parametrize(
    ("film", "E", "says"),
    [
        ("map:none.csv", "206 GPa", "[part.stage_1]: .*none.csv: there is no such file"),
        ("grobin", "206 GPa", "film = 'grobin' is not known"),
        ("map:map.csv", "70 GPa", "map:map.csv is a map of this contact"),
    ],
)
def test_a_rig_with_a_wrong_film_is_refused(tmp_path, film, E, says):
    written(tmp_path / "map.csv")
    with pytest.raises(ScenarioError, match=says.replace("[", r"\[").replace("]", r"\]")):
        rig(tmp_path, film, E)


def test_the_modulus_of_the_map_is_that_of_the_tables():
    assert pytest.approx(206e9 / (1 - 0.3**2), rel=0.01) == E_EFF
