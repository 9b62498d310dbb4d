"""`import gearheat`: what the README promises, in a new process where it must be, and results that show themselves."""

from __future__ import annotations

import ast
import pickle
import re
import subprocess
import sys
import typing
from collections.abc import Callable
from pathlib import Path

import gearheat as gh
import numpy as np
import pytest
from gearheat.model.run.steady import steady
from matplotlib.axes import Axes

ROOT = Path(__file__).parents[2]
DUTY = "time [min],carrier.w [rpm],carrier.tau [N.m],room.T [degC]\n0,150,2000,20\n60,150,2000,22\n"
#: Longest import of the package, of the best of some tries [s].
IMPORT_S = 0.1


@pytest.fixture(scope="module")
def rig() -> gh.Rig:
    return gh.load("planetary")


@pytest.fixture
def duty(tmp_path: Path) -> Path:
    (path := tmp_path / "duty.csv").write_text(DUTY, encoding="utf-8")
    return path


def test_it_takes_no_time_and_loads_nothing() -> None:
    code = (
        "import time, sys; began = time.perf_counter(); import gearheat; took = time.perf_counter() - began\n"
        "print(took, sorted({'numpy', 'casadi', 'pint', 'typer', 'matplotlib'} & set(sys.modules)))"
    )
    runs = [subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True) for _ in range(3)]
    took, loaded = zip(*(run.stdout.strip().split(" ", 1) for run in runs), strict=True)
    assert min(map(float, took)) < IMPORT_S
    assert set(loaded) == {"[]"}


def test_without_assertions() -> None:
    code = "import gearheat as gh; print(gh.steady(gh.load('planetary'))['oil.T'])"
    done = subprocess.run([sys.executable, "-O", "-c", code], capture_output=True, text=True, check=True)
    assert float(done.stdout) == gh.steady("planetary")["oil.T"]


def test_every_public_name_is_there_and_typed() -> None:
    assert set(dir(gh)) == set(gh.__all__) == gh.PUBLIC.keys()
    for name in gh.PUBLIC:
        public = getattr(gh, name)
        assert public.__doc__, name
        if callable(public) and not isinstance(public, type):
            typing.get_type_hints(public, vars(sys.modules[public.__module__]))
            assert "Example" in public.__doc__ or name in ("assemble", "rigs", "schema"), name
    with pytest.raises(AttributeError, match="nothing_like_it"):
        gh.nothing_like_it  # noqa: B018


def test_a_steady_state_by_texts_numbers_and_quantities(rig: gh.Rig) -> None:
    import pint

    hot = gh.steady(rig, {"room.T": "35 degC"})
    assert hot["oil.T"] == gh.steady(rig, {"room.T": 308.15})["oil.T"]
    assert hot["oil.T"] == gh.steady(rig, {"room.T": pint.Quantity(35.0, "degC")})["oil.T"]
    assert hot["oil.T"] == gh.steady("planetary", ["room.T=35 degC"])["oil.T"]
    assert hot.to("oil.T", "degC") == pytest.approx(hot["oil.T"] - 273.15)
    assert sum(hot.losses().values()) == pytest.approx(hot["efficiency.P_loss"])
    assert "oil.T" in hot and "oil.X" not in hot and set(hot) >= {"oil.T", "wall.T"}
    assert isinstance(hot.plot(), Axes)


def test_which_way_power_flows_is_said_first() -> None:
    hot = gh.steady("helical_two_stage")
    power = hot.power()
    assert list(power) == ["input", "output"] and sum(power.values()) == pytest.approx(hot["efficiency.P_loss"])
    assert f"{power['input'] / 1000:.4g} kW in at input" in hot.title and not hot.backward
    turned = gh.steady("helical_two_stage", {"output.tau": -hot["output.tau"]})
    assert turned.backward and list(turned.power()) == ["output", "input"] and "in at output" in turned.title


def test_a_result_shows_itself(rig: gh.Rig) -> None:
    hot = gh.steady(rig)
    assert len(repr(hot).splitlines()) == 12 and "81.78" in repr(hot) and "degC" in repr(hot)
    assert "<table>" in hot._repr_html_() and "<svg" in hot._repr_html_()


def test_a_rig_changes_by_making_another(rig: gh.Rig) -> None:
    larger = rig.with_({"cooling.A": "1 m2", "gear_set.power_flow": "ideal"})
    assert (larger["cooling.A"], larger["gear_set.power_flow"]) == (1.0, "ideal")
    assert (rig["cooling.A"], rig["gear_set.power_flow"]) == (0.42, "successive")
    assert rig.parts["oil"] == "OilBath"
    assert gh.steady(larger)["oil.T"] < gh.steady(rig)["oil.T"]
    with pytest.raises(gh.GearheatError, match="cooling"):
        rig["colling.A"]


def test_a_rig_knows_its_names(rig: gh.Rig) -> None:
    assert all(name in rig for name in ("cooling.A", "room.T", "oil.T", "gear_set.power_flow"))
    assert not any(name in rig for name in ("cooling.a", "oil", "efficiency.eta"))


def test_answers_go_to_other_processes(rig: gh.Rig) -> None:
    hot = gh.design(rig, ["cooling.A"], {"oil.T": "80 degC"})
    for answer in (gh.steady(rig), hot, gh.sweep(rig, {"room.T": ("10 degC", "30 degC")}, sample=2)):
        assert repr(pickle.loads(pickle.dumps(answer))) == repr(answer)
    assert steady(pickle.loads(pickle.dumps(rig.flat)), {})["oil.T"][0] == gh.steady(rig)["oil.T"]


def test_a_rig_is_written_and_read(rig: gh.Rig, tmp_path: Path) -> None:
    path = rig.with_({"cooling.A": "1 m2"}).save(tmp_path / "mine.toml")
    assert gh.steady(path)["oil.T"] == pytest.approx(gh.steady(rig, {"cooling.A": "1 m2"})["oil.T"], rel=1e-12)


def test_a_run_over_time(rig: gh.Rig, duty: Path, tmp_path: Path) -> None:
    run = gh.simulate(rig, duty)
    assert run.to("oil.T", "degC")[0] == pytest.approx(20.0)
    assert isinstance(run.plot("oil.T", "wall.T"), Axes)
    again = gh.TimeSeries.load(run.save(tmp_path / "run.csv"))
    np.testing.assert_allclose(again["oil.T"], run["oil.T"], rtol=1e-8)
    assert again.units["carrier.w"] == "rad/s"
    np.testing.assert_allclose(again["carrier.w"], run["carrier.w"], rtol=1e-8)


def test_frames_of_pandas_go_in_and_out(rig: gh.Rig, duty: Path) -> None:
    pandas = pytest.importorskip("pandas")
    run, by_file = gh.simulate(rig, pandas.read_csv(duty)), gh.simulate(rig, duty)
    np.testing.assert_array_equal(run["oil.T"], by_file["oil.T"])
    assert run.to_pandas()["oil.T [degC]"].iloc[0] == pytest.approx(20.0)
    given = run.to_pandas()[["carrier.w [rpm]", "carrier.tau [N.m]", "room.T [degC]"]]
    assert gh.simulate(rig, given)["oil.T"][-1] == pytest.approx(run["oil.T"][-1], abs=1e-3)
    assert "oil.T" in set(gh.steady(rig).to_pandas()["name"])


def test_a_package_that_is_not_there_is_named(rig: gh.Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(gh.GearheatError, match="pip install pandas"):
        gh.steady(rig).to_pandas()


def test_designs_sweeps_and_maps(rig: gh.Rig, tmp_path: Path) -> None:
    small = gh.design(rig, free=["cooling.A"], target={"oil.T": "80 degC"})
    assert small["oil.T"] == pytest.approx(353.15)
    assert gh.steady(rig, {"cooling.A": small["cooling.A"]})["oil.T"] == pytest.approx(353.15)
    rows = gh.sweep(rig, vary={"carrier.w": ("50 rpm", "250 rpm", 3)}, output=["oil.T"])
    assert [float(v) for v in rows.rows[:, 0]] == pytest.approx(
        [gh.steady(rig, {"carrier.w": f"{n} rpm"})["oil.T"] for n in (50, 150, 250)]
    )
    points = gh.map("helical_two_stage", grid="2x2")
    assert len(points.save(tmp_path / "map.csv").read_text().splitlines()) == 5
    assert gh.rating("helical_two_stage", {"oil.T": "95 degC"}, grid="2x2").as_dict()["limit"].startswith("oil.T")


@pytest.mark.parametrize(
    ("ask", "told"),
    [
        (lambda rig: gh.sweep(rig, {"room.T": ("0 degC",)}, sample=2), "is no range. Give its lowest and highest"),
        (lambda rig: gh.sweep(rig, {"room.T": (280, 300)}, sample=2, jobs=-1), "--jobs -1 is below zero"),
        (lambda rig: gh.losses(rig, temperature="oil"), '--temperature oil is not known. Choose "measured"'),
    ],
)
def test_what_nobody_can_mean_is_said(rig: gh.Rig, ask: Callable[[gh.Rig], object], told: str) -> None:
    with pytest.raises(gh.GearheatError, match=re.escape(told)):
        ask(rig)


def test_an_fmu_is_written_and_played(rig: gh.Rig, duty: Path, tmp_path: Path) -> None:
    fmu = gh.export(rig, tmp_path / "planetary.fmu", platform="host").path
    played = gh.play(fmu, duty)
    assert played["oil.T"][-1] == pytest.approx(gh.simulate(rig, duty)["oil.T"][-1], abs=1e-3)
    assert list(gh.play(fmu, duty, every="2 min").time) == [*np.arange(0, played.time[-1], 120), played.time[-1]]


def test_a_year_of_an_fmu_has_fewer_rows_and_says_so(
    rig: gh.Rig, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fmu = gh.export(rig, tmp_path / "planetary.fmu", platform="host").path
    (year := tmp_path / "year.csv").write_text("time [h],room.T [degC]\n0,20\n8760,22\n")
    assert len(gh.play(fmu, year, step="1 h")) == 8761
    assert len(gh.play(fmu, year, step="10 min")) == 17521
    assert "a row every 30 min" in capsys.readouterr().err
    with pytest.raises(gh.GearheatError, match="above 0"):
        gh.play(fmu, year, every=0)


def test_a_part_of_ones_own_joins_a_rig(rig: gh.Rig) -> None:
    from gearheat.model.core.component import Component, Equation, equation
    from gearheat.model.core.declare import Parameter
    from gearheat.model.parts import PARTS
    from gearheat.model.parts.ports import HeatPort

    class OilCooler(Component):
        """Heat from the oil to water, in proportion to their difference."""

        oil = HeatPort()
        water = HeatPort()
        G = Parameter("W/K", "conductance", at_least=0.0)

        def equations(self) -> typing.Iterator[Equation]:
            yield equation("heat leaves the oil", self.oil.Q_flow, self.G * (self.oil.T - self.water.T))
            yield equation("and warms the water", self.water.Q_flow, -self.oil.Q_flow)

    water = PARTS["PrescribedTemperature"]("mains", T=288.15)
    nets = [("cooler.oil", "oil.heat"), ("cooler.water", "mains.heat")]
    cooled = rig.join(OilCooler("cooler", G=2.0), water, nets=nets)
    assert cooled.parts["cooler"] == "OilCooler"
    assert gh.steady(cooled)["oil.T"] < gh.steady(rig)["oil.T"] - 1
    assert gh.steady(cooled, {"cooler.G": "0 W/K"})["oil.T"] == pytest.approx(gh.steady(rig)["oil.T"], abs=1e-6)
    with pytest.raises(gh.GearheatError, match='a part "oil" already'):
        rig.join(OilCooler("oil", G=1.0), nets=[])
    linear = PARTS["LipSeal"]("seal", law="linear", count=1, inner_share=0.5, d_sh=0.05, c_sh=73.0, c_d=1.0)
    with pytest.raises(gh.GearheatError, match='seal: LipSeal does not use "c_sh" with its other values'):
        rig.join(linear, nets=[])


def test_a_rig_of_parts_without_a_file() -> None:
    from gearheat.model.parts import PARTS

    parts = [
        PARTS["PrescribedHeatFlow"]("heater", Q_flow=50.0),
        PARTS["HeatCapacity"]("body", C=1000.0),
        PARTS["ThermalConductor"]("path", G=2.0),
        PARTS["PrescribedTemperature"]("outside", T=293.15),
    ]
    nets = [("heater.heat", "body.heat", "path.a"), ("path.b", "outside.heat")]
    box = gh.assemble("box", parts, nets, drive={})
    assert gh.steady(box)["body.T"] == pytest.approx(293.15 + 25.0)


def test_a_rig_from_a_name_plate(tmp_path: Path) -> None:
    mine = gh.new("mine", stages="helical,helical", ratio=12.56, power="7.5 kW", speed="1450 rpm")
    assert gh.steady(mine).to("oil.T", "degC") == pytest.approx(mine.sizes["oil_degC"])


#: What commands may know beside `gearheat` itself; the desk knows no more of it than they do.
MAY_KNOW = ("gearheat", "gearheat.model.errors", "gearheat.scenarios.shipped", "gearheat.tools.desk")
#: Rooms of the commands for developers, which are no part of the public interface.
DEVELOPERS = ("gearheat.tools.bench", "gearheat.tools.docs")


def test_commands_are_options_one_call_and_printing() -> None:
    problems = []
    for path in sorted((ROOT / "tools" / "cli").glob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                names = [a.name for a in node.names]
            elif isinstance(node, ast.ImportFrom):
                base = ["gearheat", "tools", "cli"][: 4 - node.level] if node.level else []
                names = [".".join([*base, *([node.module] if node.module else [])])]
            else:
                continue
            for name in names:
                ours = name == "gearheat" or name.startswith("gearheat.")
                room = name.startswith(("gearheat.tools.show", "gearheat.tools.cli")) or name == "gearheat.tools"
                room = room or (path.name == "developers.py" and name in DEVELOPERS)
                if ours and name not in MAY_KNOW and not room:
                    problems.append(f"{path.name}: {name}")
    assert not problems


H = "helical_two_stage"


@pytest.mark.parametrize(
    ("ask", "told"),
    [
        (lambda: gh.rating(H, {"oil.T": "95 degC", "gears.T": "99 degC"}), "one at a time"),
        (lambda: gh.rating(H, "oil.T=95 degC", set=["room.T=30 degC"]), "room.T is set, and varied"),
        (lambda: gh.export(H, "a.fmu", fmi=1), "there is FMI 2 and FMI 3"),
        (lambda: gh.steady(None), "is no rig"),
        (lambda: gh.steady(H).save("rig.toml"), "JSON is written"),
        (lambda: gh.map(H, grid="2x2").save_picture("map.pdf"), "unknown kind of picture"),
    ],
)
def test_what_cannot_be_is_refused(tmp_path, monkeypatch, ask: Callable[[], object], told: str) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(gh.GearheatError, match=told):
        ask()
    assert not list(tmp_path.iterdir())


def test_one_text_stands_for_a_list_of_one() -> None:
    assert gh.steady(H, "room.T=30 degC")["room.T"] == pytest.approx(303.15)
    assert np.allclose(gh.map(H, grid="2x2", output="oil.T").columns["oil.T"], gh.map(H, grid="2x2").columns["oil.T"])
    assert list(gh.map(H, grid="2x2", output=["oil.T", "oil.T"]).columns)[-1] == "oil.T"
    assert gh.design(H, "cooling.A", "oil.T=50 degC")["oil.T"] == pytest.approx(323.15)


def test_a_rig_whose_parts_have_other_letters_is_saved_and_read_again(tmp_path: Path, rig: gh.Rig) -> None:
    text = rig.save(tmp_path / "a.toml").read_text(encoding="utf-8")
    (other := tmp_path / "b.toml").write_text(text.replace("part.foot", 'part."Fuß"').replace('"foot.', '"Fuß.'))
    again = gh.load(other).save(tmp_path / "c.toml")
    assert gh.steady(again)["oil.T"] == pytest.approx(gh.steady(rig)["oil.T"])


def test_losses_of_a_state_are_the_power_between_its_shafts() -> None:
    state = gh.steady("e_axle")
    assert sum(state.losses().values()) == pytest.approx(state["efficiency.P_loss"], rel=1e-6)
    assert gh.steady(H, {"input.w": "0 rpm"}).headlines[0].startswith("loss")
    assert "between the shafts, in all loss" in gh.steady("drum_motor").headlines[0]


def test_a_thermostat_starts_closed_in_the_cold(tmp_path: Path) -> None:
    """Its threshold is no body: it does not start at the temperature of the room, and is not the hottest of them."""
    rig = gh.load("wind_turbine")
    (relay,) = [p.name for p in rig.scenario.spec.parts if p.type == "Thermostat"]
    (duty := tmp_path / "duty.csv").write_text("time [s],nacelle.T [degC]\n0,-10\n600,-10\n")
    run = gh.simulate(rig, duty, set={f"{relay}.relay": "true"})
    assert run[f"{relay}.T_switch"][0] > 300.0 > run["sump.T"][0]
    assert run["cooler.share"].max() < 0.01


def test_results_print_the_heads_of_their_columns() -> None:
    assert repr(gh.rating(H, "oil.T=95 degC", grid="2x2")).splitlines()[1].split()[:2] == ["room.T", "[degC]"]
    assert str(gh.losses(H)).splitlines()[1].startswith("P_mesh_W")
    assert str(gh.plan(H)).startswith("helical_two_stage: which causes a campaign can tell apart\nexperiment")
