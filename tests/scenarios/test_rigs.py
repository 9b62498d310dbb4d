"""The shipped rigs: they load, become models, cite a source for every number, and do what they say."""

from pathlib import Path

import numpy as np
import pytest
from gearheat.model.core.flat import FlatModel
from gearheat.model.run.rows import evaluate_at
from gearheat.model.run.steady import steady
from gearheat.model.sources import sources
from gearheat.scenarios.document import SOURCE_KINDS
from gearheat.scenarios.load import list_rigs, load
from gearheat.scenarios.scenario import Scenario

NAMES = tuple(list_rigs())


def flat_model(scenario: Scenario) -> FlatModel:
    return scenario.spec.flat()


@pytest.fixture(scope="module")
def planetary() -> Scenario:
    return load("planetary")


@pytest.fixture(scope="module")
def ideal(planetary: Scenario) -> FlatModel:
    """The planetary rig as its source computes it: mesh forces from the input torque."""
    return planetary.spec.with_values({"gear_set.power_flow": "ideal"}).flat()


@pytest.fixture(scope="module")
def helical() -> FlatModel:
    return flat_model(load("helical_two_stage"))


def test_all_are_listed() -> None:
    assert NAMES == (
        "actuator",
        "cycloidal",
        "cycloidal_areas",
        "cycloidal_printed",
        "drum_motor",
        "drum_motor_planetary",
        "e_axle",
        "fzg_four_square",
        "harmonic",
        "harmonic_printed",
        "helical_two_stage",
        "hydraulic",
        "planetary",
        "rv_stage",
        "wind_turbine",
    )
    assert all(list_rigs().values())
    assert all(list_rigs("reproduces").values())


@pytest.mark.parametrize("name", NAMES)
class TestEveryRig:
    def test_it_becomes_a_model_at_its_operating_point(self, name: str) -> None:
        scenario = load(name)
        flat = flat_model(scenario)
        starts = {q.name: q.start for q in flat.inputs}
        assert scenario.operating_point.items() <= starts.items()
        assert flat.name == scenario.name == name

    def test_every_value_has_a_source_that_exists(self, name: str) -> None:
        scenario = load(name)
        values = {f"{part.name}.{key}" for part in scenario.spec.parts for key in part.values}
        values -= {v for v in values if v.endswith((".given", ".dynamic", ".drives"))}
        assert values == set(scenario.value_sources)
        for path, text in scenario.value_sources.items():
            known = text.split(",")[0] in sources() or text.split(":")[0] in SOURCE_KINDS
            assert known, f"{path}: {text}"

    def test_losses_add_up_to_the_power_that_is_lost(self, name: str) -> None:
        scenario = load(name)
        result = steady(flat_model(scenario), {})
        summed = {column: sum(float(result[p][0]) for p in paths) for column, paths in scenario.losses.items()}
        parts = sum(value for column, value in summed.items() if column.startswith("P_") and column != "P_total_W")
        assert parts == pytest.approx(summed["P_total_W"], rel=1e-9)
        takes = [part.name for part in scenario.spec.parts if part.type in ("Room", "PrescribedTemperature")]
        assert parts == pytest.approx(sum(float(result[f"{name}.Q_flow"][0]) for name in takes), rel=1e-6)

    def test_loading_twice_is_loading_once(self, name: str) -> None:
        assert load(name).spec == load(name).spec


class TestPlanetary:
    def test_forces_speeds_and_seals_are_the_printed_ones(self, ideal: FlatModel) -> None:
        """Dias2014: table 5.1 (forces), 5.2 (speeds), seal losses."""
        result = steady(ideal, {})
        assert result["gear_set.F_t_sp"][0] == pytest.approx(5699.1, abs=0.05)
        assert result["sun.w"][0] * 30 / np.pi == pytest.approx(1000, rel=1e-9)
        assert result["carrier_seal.P_loss"][0] == pytest.approx(37.681, abs=5e-4)
        assert result["sun_seal.P_loss"][0] == pytest.approx(55.560, abs=5e-4)

    def test_bearing_losses_are_the_printed_ones_at_85_degC(self, ideal: FlatModel) -> None:
        """Dias2014, tables 5.7 and 5.8, at oil and grease of 85 degC; the tapered bearing without its printed drag."""
        x = np.full(len(ideal.states), 85 + 273.15)
        y = evaluate_at(ideal, x, ideal.starts("input"), ideal.starts("parameter"))["y"]
        shown = dict(zip((q.name for q in ideal.outputs), y, strict=True))
        assert 1e3 * shown["carrier_bearing.tau_rr"] == pytest.approx(2064.5, rel=2e-4)
        assert 1e3 * shown["carrier_bearing.tau_sl"] == pytest.approx(2995.1, rel=2e-4)
        assert shown["sun_bearing.P_loss"] == pytest.approx(43.65, rel=2e-4)
        assert shown["planet_bearing.P_loss"] / 6 == pytest.approx(6.9937, rel=3e-3)

    def test_heat_capacities_sum_to_those_of_the_masses(self, planetary: Scenario) -> None:
        flat = flat_model(planetary)
        C = {q.name: q.start for q in flat.parameters}
        assert C["wall.C"] + C["surface.C"] == 15e3
        assert C["oil.V"] * C["oil.rho_15"] * C["oil.c_p"] == pytest.approx(1.75e3, rel=2e-3)

    def test_values_from_the_catalogue_are_the_oil_s(self, planetary: Scenario) -> None:
        oil = planetary.spec.part("oil").values
        assert oil["nu_40"] == pytest.approx(324.38e-6)
        assert planetary.value_sources["oil.nu_40"].startswith("Dias2014")
        assert planetary.entries["oil"] == {"oil": "PAOR"}

    def test_errata_say_what_and_why(self, planetary: Scenario) -> None:
        assert len(planetary.errata) == 33
        assert all(all(vars(erratum).values()) for erratum in planetary.errata)
        assert len({(e.place, e.says) for e in planetary.errata}) == 33

    def test_sensors_are_columns_of_its_table(self, planetary: Scenario) -> None:
        assert planetary.data is not None
        header = planetary.data.read_text(encoding="utf-8").splitlines()[0].split(",")
        assert set(planetary.sensors) <= set(header)


class TestHelical:
    def test_whole_teeth_give_the_ratio_and_the_centre_distances(self, helical: FlatModel) -> None:
        v = {q.name: q.start for q in helical.parameters}
        ratio = v["stage_1.z_1"] * v["stage_2.z_1"] / v["stage_1.z_2"] / v["stage_2.z_2"]
        turning = steady(helical, {})
        assert turning["output.w"][0] / turning["input.w"][0] == pytest.approx(ratio, rel=1e-12)
        for stage, a in (("stage_1", 0.100), ("stage_2", 0.125)):
            z = v[f"{stage}.z_1"] + v[f"{stage}.z_2"]
            assert z == round(z)
            assert v[f"{stage}.m_n"] * z / 2 / np.cos(v[f"{stage}.beta"]) == pytest.approx(a, rel=1e-7)

    def test_gears_sit_on_their_radii(self, helical: FlatModel) -> None:
        v = {q.name: q.start for q in helical.parameters}
        radii = {
            "input_support.r": "stage_1.z_1",
            "middle_support.r": "stage_1.z_2",
            "middle_support.r_2": "stage_2.z_1",
        }
        for radius, z in (radii | {"output_support.r": "stage_2.z_2"}).items():
            stage = z.split(".")[0]
            assert v[radius] == pytest.approx(v[f"{stage}.m_n"] * v[z] / 2 / np.cos(v[f"{stage}.beta"]), rel=1e-4)

    def test_a_motor_that_gives_torque_only_runs_up(self) -> None:
        scenario = load("helical_two_stage").driven({"input": ("tau",), "output": ("tau",)})
        flat = flat_model(scenario)
        assert "rotor.w" in flat.index


class TestChanges:
    def test_a_value_beside_the_catalogue_overrides_it(self, tmp_path: Path) -> None:
        text = (load("planetary").path).read_text(encoding="utf-8").replace('data = "measured.csv"\n', "")
        (path := tmp_path / "rig.toml").write_text(text.replace('V = "1 l"', 'V = "1 l"\nrho_15 = "0.9 kg/l"'))
        scenario = load(path)
        assert scenario.entries["oil"] == {"oil": "PAOR"}
        assert scenario.spec.part("oil").values["rho_15"] == pytest.approx(900)
        assert scenario.value_sources["oil.rho_15"] == "Dias2014, chapter 4"
        assert scenario.data is None
        assert scenario.protocol is not None

    def test_a_part_of_one_s_own(self, tmp_path: Path) -> None:
        text = (load("planetary").path).read_text(encoding="utf-8").replace('data = "measured.csv"\n', "")
        cooler = '[part.cooler]\ntype = "ThermalConductor"\nG = "3 W/K"\nsource = "assumed: a finned tube"\n'
        net = '[connect]\ninlet = ["oil.heat", "cooler.a"]\noutlet = ["cooler.b", "room.floor"]\n'
        (path := tmp_path / "cooled.toml").write_text(text + cooler + net)
        cooled, bare = load(path), load("planetary")
        assert cooled.name == "cooled"
        T = [float(steady(flat_model(s), {})["oil.T"][0]) for s in (cooled, bare)]
        assert T[0] < T[1] - 1

    def test_with_values_moves_inputs_and_says_where_they_are_from(self, planetary: Scenario) -> None:
        changed = planetary.with_values({"room.T": 300.0, "oil.V": 2e-3}, "a test")
        assert changed.operating_point["room.T"] == 300.0
        assert "oil.V" not in changed.operating_point
        assert changed.value_sources["oil.V"] == "a test"
        flat = flat_model(changed)
        assert flat.quantity("room.T").start == 300.0
        assert flat.quantity("oil.V").start == 2e-3
        assert planetary.spec.part("oil").values["V"] == pytest.approx(1e-3)
