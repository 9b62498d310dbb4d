"""Parts whose film comes from a map: the gears' film, and the same numbers in CasADi and in the C of an FMU."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from film_tables import R, written
from gearheat.fmu.export import export
from gearheat.fmu.play import play
from gearheat.model.core.component import Component, Equation, equation
from gearheat.model.core.declare import Choice, Input, Output, State
from gearheat.model.laws.film import film_thickness
from gearheat.model.laws.film_map import FilmMap
from gearheat.model.machines.spec import assemble
from gearheat.model.parts.contacts import FilmContact
from gearheat.model.run.schedule import Schedule
from gearheat.model.run.simulate import simulate
from gearheat.model.run.steady import steady
from gearheat.scenarios.film_map import read_film_map
from gearheat.scenarios.load import load
from small_parts import model


@pytest.fixture
def law(tmp_path: Path) -> FilmMap:
    return read_film_map(written(tmp_path / "map.csv"), "map:map.csv").law


def test_the_film_of_gears_is_that_of_the_map(law: FilmMap) -> None:
    scenario = load("helical_two_stage")
    spec = scenario.spec
    results = []
    for film in ("grubin", law):
        flat = spec.with_values({"stage_1.film": film}).flat()
        results.append((flat, steady(flat, {q.name: q.start for q in flat.inputs})))
    (flat, before), (_, after) = results
    values = {q.name.removeprefix("stage_1."): q.start for q in flat.parameters if q.name.startswith("stage_1.")}
    values |= {k.removeprefix("stage_1."): float(c[0]) for k, c in before.columns.items() if k.startswith("stage_1.")}
    part = next(p for p in assemble(spec).parts if p.name == "stage_1")
    contact: FilmContact = part.film_contact(values)
    rho = values_of_oil(spec, "rho_15") * (1 + values_of_oil(spec, "alpha_T") * (before["oil.T"][0] - 288.15))
    eta, nu = before["oil.nu"][0] * rho, before["oil.nu"][0]
    alpha_p = 1e-9 * values_of_oil(spec, "s_p") * (1e6 * nu) ** values_of_oil(spec, "t_p")
    load_ = contact.F / contact.length
    of_map, _ = law.films(eta, 2 * contact.u_1, load_, contact.R_x)
    of_grubin = film_thickness(eta, 2 * contact.u_1, alpha_p, load_, contact.R_x, contact.E_eff / 2)
    ratio = after["stage_1.Lambda"][0] / before["stage_1.Lambda"][0]
    assert ratio == pytest.approx(float(of_map / of_grubin), rel=1e-6)
    assert after["oil.T"][0] == pytest.approx(before["oil.T"][0], abs=1e-6)  # a diagnosis, no part of a loss


def values_of_oil(spec: Any, key: str) -> float:
    return float(spec.part("oil").values[key])


class Disc(Component):
    """A contact whose film comes from a map, and wear that grows with the film."""

    film = Choice((), "map", also=FilmMap)
    u = Input("m/s", "mean speed", start=1.0)
    F = Input("N/m", "load per length", nominal=1e4, start=5e4)
    x = State("1", "integral of the film, in um")
    h = Output("m", "central film", nominal=1e-6)
    h_min = Output("m", "minimum film", nominal=1e-6)

    def equations(self) -> Iterator[Equation]:
        h_c, h_min = self.film.films(0.07, 2 * self.u, self.F, R)
        yield equation("film", self.h, h_c)
        yield equation("minimum film", self.h_min, h_min)
        yield equation("integral", self.der("x"), 1e6 * self.h)


def test_an_fmu_has_the_map_in_its_equations(law: FilmMap, tmp_path: Path) -> None:
    """Through rest, reversal and both edges of the map; the file of the map is gone."""
    flat = replace(model(Disc("disc", film=law), nets=[]), name="disc")
    (tmp_path / "map.csv").unlink()
    export(flat, tmp_path / "disc.fmu")
    duty = {
        "disc.u": (np.array([0.0, 10.0, 20.0]), np.array([-30.0, 30.0, 0.05])),
        "disc.F": (np.array([0.0, 20.0]), np.array([1e3, 1e6])),
    }
    times = np.linspace(0.0, 20.0, 41)
    played = play(tmp_path / "disc.fmu", duty, 20.0, 0.5, tolerance=1e-8, output_times=times)
    result = simulate(flat, Schedule(*_joined(duty)), times=times, tolerance=1e-8)
    for name, rel in (("disc.h", 1e-9), ("disc.h_min", 1e-9), ("disc.x", 1e-5)):
        assert played[name] == pytest.approx(np.asarray(result[name]), rel=rel), name
    outside = {(o.law, o.argument) for o in result.outside}
    assert outside == {("film_map", "load"), ("film_map", "speed")}


def _joined(duty: dict[str, tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    time = np.unique(np.concatenate([t for t, _ in duty.values()]))
    return time, {name: np.interp(time, *line) for name, line in duty.items()}
