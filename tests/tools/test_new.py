"""`gearheat new`: a rig from a name plate that runs at once."""

from __future__ import annotations

import math
import re

import casadi as ca
import gearheat as gh
import pint
import pytest
from for_each import thin
from gearheat.model.errors import ScenarioError
from gearheat.model.machines.roles import Roles
from gearheat.model.parts import TwoGearSupport
from gearheat.model.units import si_of
from gearheat.scenarios.entries import catalogue
from gearheat.scenarios.load import load
from gearheat.scenarios.nuisances import nuisances, usual_priors
from gearheat.tools.build import rig_file, sizing
from gearheat.tools.build.bearings import LIFE, TAPERED, choose
from gearheat.tools.build.new import new
from gearheat.tools.build.plausible import usual
from gearheat.tools.build.shafts import find_tight
from gearheat.tools.solve.settings import flat_of
from gearheat.tools.solve.simulate import simulate
from gearheat.tools.solve.steady import steady

FORCES = ("F_t", "F_r", "F_a")
PLATES = {
    "two": ("helical,helical", 12.56, "7.5 kW"),
    "three": ("helical,helical,helical", 60.0, "5.5 kW"),
    "spur": ("spur", 3.0, "2 kW"),
    "mixed": ("spur,helical", 9.0, "1.5 kW"),
    "bevel": ("bevel,helical", 20.0, "5.5 kW"),
    "bevel_alone": ("bevel", 2.0, "3 kW"),
    "worm": ("worm", 20.0, "1.5 kW"),
    "worm_geared": ("helical,worm", 100.0, "1.5 kW"),
    "planetary": ("planetary", 4.0, "5.5 kW"),
    "planetary_three": ("planetary,planetary,planetary", 150.0, "15 kW"),
    "planetary_bevel": ("bevel,planetary", 25.0, "5.5 kW"),
    "four": ("helical,helical,helical,helical", 300.0, "0.75 kW"),
}


@pytest.fixture(scope="module")
def known(tmp_path_factory):
    """Folder of the rigs that are made, and what was told of each by name."""
    return tmp_path_factory.mktemp("made"), {}


@pytest.fixture
def made(gearheat, known):
    """The rig file of a name plate, and what was told of it; made once."""
    folder, told = known

    def make(name):
        stages, ratio, power = PLATES[name]
        path = folder / f"{name}.toml"
        if name not in told:
            plate = ("--stages", stages, "--ratio", ratio, "--power", power, "--speed", "1450 1/min")
            told[name] = gearheat("new", name, *plate, "--oil", "ISO VG 220", "-o", path, "--json", "-")
        return path, told[name]

    return make


@pytest.mark.parametrize("name", PLATES)
def test_it_runs_and_says_of_every_number_how_it_came_about(made, name):
    path, answer = made(name)
    assert answer.code == 0, answer.err
    found = answer.json
    assert found["ratio"] == pytest.approx(PLATES[name][1], rel=0.02)
    assert (0.7 if "worm" in name else 0.9) < found["efficiency"] < 0.995
    assert 21 < found["oil_degC"] < (105 if "worm" in name else 80)  # a worm of 1.5 kW in mineral oil wants a fan
    assert "{{" not in path.read_text("utf-8")
    scenario = load(path)
    assert all(source for source in scenario.value_sources.values())
    assert found["assumed"] > 50
    assert scenario.drives == "input" and scenario.operating_point["output.load"] > 0
    assert flat_of(scenario).states


@pytest.mark.parametrize("name", PLATES)
def test_it_says_how_uncertain_its_rules_are_and_a_card_leaves_it_there(made, name):
    scenario = load(made(name)[0])
    roles = Roles.of(scenario.spec)
    lossy = roles.scaled(*(part for role in ("teeth", "bearing", "seal", "churning") for part in roles.having(role)))
    assert scenario.rough.issuperset(lossy) and scenario.rough.issuperset(roles.scaled(*roles.oil_side))
    kinds = {f"{scenario.spec.part(part).type}.{key}" for part, _, key in (p.rpartition(".") for p in scenario.rough)}
    assert kinds.isdisjoint(usual_priors(scenario)) and scenario.rough.isdisjoint(usual_priors(scenario))


def test_splash_on_walls_is_uncertain_by_its_law_even_where_rules_hold(made):
    """A bearing is near what its rule says, or far; the coefficient of splash was compared with no gearbox at all."""
    scenario = load(made("two")[0])
    known = {n.name: n for n in nuisances(Roles.of(scenario.spec), {}, scenario.uncertainties, scenario.rules)}
    walls = known["oil to other bodies"]
    assert (walls.sd, walls.near * walls.sd) == pytest.approx((0.6, 0.45), rel=0.01)
    assert known["oil to what turns"].near * known["oil to what turns"].sd == pytest.approx(0.2)


def test_what_it_made_is_told(gearheat, tmp_path):
    plate = ("--stages", "bevel,spur", "--ratio", 9, "--power", "3 kW", "--speed", "14500 rpm")
    answer = gearheat("new", "told", *plate, "-o", tmp_path / "told.toml")
    assert answer.code == 0, answer.err
    assert "turns at 14,500 rpm, and motors of industrial units at most at 6,000 rpm" in answer.err
    for words in ("stage 1: bevel", "d_e2", "stage 2: spur", "efficiency 9", "each with its rule"):
        assert words in answer.out


def test_what_is_too_hot_or_too_weak_is_told(gearheat, tmp_path):
    plate = ("--stages", "worm", "--ratio", 60, "--power", "3 kW", "--speed", "1450 rpm")
    answer = gearheat("new", "hot", *plate, "-o", tmp_path / "hot.toml")
    assert answer.code == 0, answer.err
    assert "needs --fan or --cooler (for 1.2 kW), fins, or a larger housing" in answer.err
    assert "the largest loss is that of teeth" in answer.err and "more starts of the worm" in answer.err
    plate = ("--stages", "helical,helical", "--ratio", 20, "--power", "600 kW", "--speed", "1450 rpm")
    answer = gearheat("new", "weak", *plate, "--bearings", "ball", "-o", tmp_path / "weak.toml")
    assert answer.code == 0, answer.err
    assert "the catalogue has no stronger one" in answer.err
    with pytest.raises(ScenarioError, match="--speed, or give it --cooler"):
        new("hotter", stages="planetary", ratio=4, power="5 MW", speed="6000 rpm")


@pytest.mark.parametrize(
    ("stages", "ratio"),
    [
        ("helical", 1.0),
        ("bevel", 1.25),
        ("helical,helical,helical", 40.0),
        ("helical,helical,helical", 31.5),
        ("helical,helical,helical,helical", 300.0),
        ("spur", 4.52),
    ],
)
def test_the_ratio_is_that_of_the_name_plate(stages, ratio):
    """Helix angle and module leave room for the numbers of teeth; what is off is told."""
    for power in (400.0, 40e3):
        made = sizing.unit(stages.split(","), ratio, power, 1480 * math.pi / 30)
        assert made.ratio == pytest.approx(ratio, rel=0.005)
        assert all(7.9 < math.degrees(s.beta) < 20.1 for s in made.stages if s.kind == "helical")


def test_a_ratio_that_whole_teeth_do_not_have_is_told():
    made = new("a", stages="worm", ratio=10.8, power="30 kW", speed="1450 rpm", cooler=True)
    assert any("% from 10.8, as teeth are whole" in note for note in made.notes)


def test_what_turns_too_fast_for_a_bath_is_told(gearheat, tmp_path):
    plate = ("--stages", "helical", "--ratio", 5, "--power", "5 MW", "--oil", "ISO VG 46", "--cooler")
    answer = gearheat("new", "a", *plate, "--speed", "10000 rpm", "-o", tmp_path / "fast.toml")
    for words in ("moves at 87 m/s", "n d_m = 2.2e+06 mm/min", "rubs at 73 m/s", "friction_schlenk, v_sum = 61"):
        assert words in answer.err
    plate = ("--stages", "helical", "--ratio", 5, "--power", "5 kW", "--speed", "6000 rpm")
    assert "motors" not in gearheat("new", "a", *plate, "-o", tmp_path / "a.toml").err


def test_a_centre_distance_that_the_load_does_not_suit_is_told(gearheat, tmp_path):
    plate = ("--stages", "helical,helical", "--ratio", 12.5, "--power", "75 kW", "--speed", "1480 rpm")
    answer = gearheat("new", "a", *plate, "--centre-distance", "100 mm", "-o", (path := tmp_path / "a.toml"))
    assert "K* is 53.6 N/mm2, usual 1 to 6: the load asks for 224 mm" in answer.err
    assert "(u + 1)/u of 53.6 N/mm2 by a = 100 mm of a data sheet" in path.read_text("utf-8")
    assert "K*" not in gearheat("new", "b", *plate, "--centre-distance", "250 mm", "-o", tmp_path / "b.toml").err


@pytest.mark.parametrize(
    ("stages", "ratio", "power", "speed", "cooler", "solved"),
    [
        ("worm", 40, 750, 1400, False, True),
        ("worm", 50, 100, 1450, True, True),
        ("planetary,planetary", 100, 126, 3000, False, True),
        ("planetary,bevel", 0.05, 50, 70, False, True),
        ("helical,helical", 12.56, 7500, 1450, False, False),
    ],
)
def test_at_the_name_plate_it_takes_the_power_of_the_name_plate(tmp_path, stages, ratio, power, speed, cooler, solved):
    """Where the rule's efficiency is off by more than 2 %, the load follows from the one that is solved."""
    plate = {"power": f"{power} W", "speed": f"{speed} rpm", "cooler": cooler}
    sizes = new("a", stages=stages, ratio=ratio, **plate, out=(path := tmp_path / "a.toml")).sizes
    assert sizes["power_W"] == pytest.approx(power, rel=0.012)
    stated = re.search(r"name plate, (\S+) % efficiency( as solved)?,", path.read_text("utf-8"))
    assert float(stated[1]) == pytest.approx(100 * sizes["efficiency"], rel=0.012) and bool(stated[2]) == solved


SERVO = {"stages": "planetary", "ratio": 10, "power": "126 W", "speed": "3000 rpm"}
SPURS = {"stages": "spur,spur", "ratio": 9, "power": "30 kW", "speed": "1450 rpm", "oil": "ISO VG 460 PAG"}


@pytest.mark.parametrize(
    ("plate", "words"),
    [
        (
            SERVO,
            ("is below the usual 91 to 99.3 %.", "of another kind (--bearings ball), or an oil of a lower viscosity"),
        ),
        (SERVO | {"bearings": "roller"}, ("(--bearings ball), or",)),
        (
            SERVO | {"bearings": "ball"},
            ("bearing, 72 %: those of planets have most of it, and no option changes them",),
        ),
        (
            SERVO | {"stages": "spur", "ratio": 8, "speed": "6000 rpm"},
            (": bearings of less bore, or an oil of a lower",),
        ),
        (SPURS, ("the efficiency of 98.74 % is above the usual 95 to 98.5 %.",)),
        (
            SPURS | {"stages": "spur", "ratio": 1, "power": "7.5 kW", "speed": "2900 rpm"},
            ("of the loss, above the usual 5 to 40 %.",),
        ),
    ],
)
def test_what_is_not_usual_is_told_with_its_range_and_what_helps(plate, words):
    notes = "\n".join(new("a", **plate).notes)
    assert all(part in notes for part in words), notes


def test_a_unit_that_loses_more_without_load_than_its_power_is_told():
    notes = new("a", stages="bevel", ratio=3.0, power="1 W", speed="1450 rpm").notes
    assert any(
        re.search(r"it takes 4\.\d+ W, not the 1 W of the name plate: without load it loses 4", n) for n in notes
    )


def test_it_is_what_one_would_draw(made):
    _, answer = made("two")
    first, second = answer.json["stages"]
    assert (first["a"], second["a"]) == pytest.approx((0.09, 0.112))  # the rig helical_two_stage has 0.1 and 0.125
    assert answer.json["oil_degC"] == pytest.approx(57.3, abs=4)
    assert all(life > LIFE for shaft in answer.json["bearings"] for life in shaft["lives_h"])


@pytest.mark.parametrize(
    ("stages", "ratio", "torque", "rpm", "kg", "litres"),
    [
        ("helical", 4, 4567, 1480, 302, 22),  # Flender H1-5, H1-9 at 2/3
        ("helical", 4, 14933, 1480, 862, 68),
        ("helical,helical", 20, 61, 1400, 4, 0.25),  # SEW R17, R77, R137 at 1/1.4 of their torque
        ("helical,helical", 20, 586, 1400, 29, 1.2),
        ("helical,helical", 20, 5714, 1400, 220, 10),
        ("helical,helical", 12.5, 17670, 1480, 590, 30),  # Flender H2-8 at 2/3
        ("bevel,helical,helical", 30, 143, 1400, 11, 0.5),  # SEW K37, K127
        ("bevel,helical,helical", 30, 9286, 1400, 380, 21),
        ("worm", 20, 74, 1400, 3.5, 0.15),  # NMRV 050, 090
        ("worm", 20, 370, 1400, 13, 1.0),
        ("helical,worm", 60, 433, 1400, 27, 1.0),  # SEW S67
        ("planetary", 5, 81, 2900, 3.9, None),  # Wittenstein SP 075, 240
        ("planetary", 5, 2872, 1000, 77, None),
        ("planetary,planetary", 20, 1250, 1450, 27, 1.1),  # Bonfiglioli 301, 306, 311, 317 with two stages at 1/1.4
        ("planetary,planetary", 20, 6070, 1450, 85, 3),
        ("planetary,planetary", 20, 25000, 1450, 250, 7),
        ("planetary,planetary", 20, 107100, 1450, 950, 25),
    ],
)
def test_it_is_as_heavy_and_full_as_makers_units_are(stages, ratio, torque, rpm, kg, litres):
    speed, eta = rpm * math.pi / 30, 0.79 if "worm" in stages else 0.96
    made = sizing.unit(stages.split(","), ratio, torque * speed / ratio / eta, speed)
    bodies = rig_file.compute_bodies(made)
    assert 0.7 < (bodies["mass"] + (bodies["C_gears"] + bodies["C_shafts"]) / 470) / kg < 1.5
    assert litres is None or 0.55 < sizing.bath(made)["volume"] / litres < 1.6


def test_a_sump_makes_a_housing_larger_on_all_sides(tmp_path):
    """Small gears of a fast unit ask for more oil than the box around them holds: it was 2.5 m high, 0.3 m wide."""
    made = sizing.unit(["helical"], 0.3, 2e6, 3600 * math.pi / 30)
    assert sizing.bath(made)["volume"] == pytest.approx(220, rel=1e-3)
    assert made.height < made.length < 3 * made.width


@pytest.mark.parametrize(("stages", "ratio", "power"), [("planetary", 4, "5 MW"), ("worm", 40, "75 kW")])
def test_cooled_oil_takes_the_heat_of_teeth_and_bearings(stages, ratio, power):
    """Gears were 110 K warmer than oil that a pump brings to them; makers allow bearings up to 90 to 100 degC."""
    hot = steady(new("a", stages=stages, ratio=ratio, power=power, speed="1500 rpm", cooler=True))
    assert all(hot["oil.T"] < hot[f"{body}.T"] < 273.15 + 100 for body in ("gears", "shafts"))


def test_notes_of_a_plate_belong_to_the_rig():
    plate = {"stages": "helical", "ratio": 2.8, "power": "200 kW", "speed": "25 Hz"}
    told = " ".join(new("a", **plate).notes)
    assert "(PAO), as have finer flanks." in told and "worm" not in told and "mains" not in told
    assert "are those of the mains" in " ".join(new("a", **plate | {"speed": "50 Hz"}).notes)
    with pytest.raises(ScenarioError, match='"50 W" or "50 kW"'):
        new("a", **plate, motor_heat="50")


@pytest.mark.parametrize(("ratio", "torque", "speed", "idle"), [(5, 81, 2900, 0.96), (10, 174, 2800, 1.0)])
def test_a_servo_planetary_idles_as_its_maker_says(tmp_path, ratio, torque, speed, idle):
    """Wittenstein SP 075 and SP 100: no-load torque at 3000 rpm, all at 20 degC; the carrier's pair has most of it."""
    power = torque / ratio * speed * math.pi / 30
    rig = new("it", stages="planetary", ratio=ratio, power=f"{power} W", speed=f"{speed} rpm", oil="CLP PG 220")
    (duty := tmp_path / "duty.csv").write_text("time [s],input.w [rpm]\n0,3000\n1,3000\n", "utf-8")
    lost = simulate(rig, duty, {"output.load": "0 N.m"})
    assert 0.5 < lost["efficiency.P_loss"][0] / (100 * math.pi) / idle < 1.1
    assert lost["output_bearing_a.P_loss"][0] + lost["output_bearing_b.P_loss"][0] > lost["efficiency.P_loss"][0] / 2


def test_an_increaser_is_its_reducer_the_other_way_round(gearheat, tmp_path):
    """Stages are counted from the input, the slow shaft; the torque of the output is that of the fast one."""
    found = []
    for stages, ratio, speed in (("planetary,helical", 0.05, 74), ("helical,planetary", 20, 1480)):
        path = tmp_path / f"{speed}.toml"
        plate = ("--stages", stages, "--ratio", ratio, "--power", "11 kW", "--speed", f"{speed} rpm", "-o", path)
        answer = gearheat("new", "it", *plate, "--json", "-")
        assert answer.code == 0, answer.err
        assert [s["kind"] for s in answer.json["stages"]] == stages.split(",")
        assert answer.json["ratio"] == pytest.approx(ratio, rel=0.02)
        types = {p.name: p.type for p in load(path).spec.parts}
        assert types["stage_1"] == {"planetary": "PlanetarySet", "helical": "HelicalGearPair"}[stages.split(",")[0]]
        found.append(answer.json)
    assert found[0]["efficiency"] == pytest.approx(found[1]["efficiency"], abs=0.005)
    answer = gearheat("new", "it", "--stages", "worm", "--ratio", 0.05, "--power", "1 kW", "--speed", "70 rpm")
    assert answer.code == 2 and "a worm is not driven by its wheel" in answer.err


@pytest.mark.parametrize(
    ("stages", "ratio", "power"), [("worm", 5, 1.5), ("worm", 100, 0.2), ("helical,worm", 500, 0.2)]
)
def test_ratios_of_usual_worms_are_drawn(stages, ratio, power):
    made = sizing.unit(stages.split(","), ratio, 1000 * power, 1400 * math.pi / 30)
    assert made.ratio == pytest.approx(ratio, rel=0.02)


def test_centre_distances_hold_the_bearings():
    """Where bearings have no room beside each other or on the pinion's shaft, the next centre distances are tried."""
    for stages, ratio, power in (("helical", 3, 2500), ("helical,worm", 60, 770), ("helical,planetary", 3.5, 22e3)):
        made = sizing.unit(stages.split(","), ratio, power, 1400 * math.pi / 30)
        assert not find_tight(made.stages, made.shafts)


@pytest.mark.parametrize("first", ["helical", "bevel"])
def test_bearings_carry_what_they_were_chosen_for(first):
    """The statics of the middle shaft's part give the load that its bearings' lives belong to."""
    unit = sizing.unit([first, "helical", "helical"], 60.0, 5500.0, 1450 * math.pi / 30)
    wheel, pinion, shaft = unit.stages[0], unit.stages[1], unit.shafts[1]
    places = {"x": wheel.x, "r": wheel.r_2, "x_2": pinion.x, "r_2": pinion.r_1}
    part = TwoGearSupport("shaft", span=shaft.span, axial_share_a=1.0, phi=math.pi, **places)
    ports = [(part.mesh, wheel.forces[1]), (part.mesh_2, pinion.forces[0])]
    given = [(getattr(port, key), F) for port, forces in ports for key, F in zip(FORCES, forces, strict=True)]
    found = {e.name: e.rhs for e in part.equations()}
    symbols = [s for s, _ in given] + [part.symbols[key] for key in part.parameters]
    values = [F for _, F in given] + [part.values[key] for key in part.parameters]
    F = {name: float(ca.Function("F", symbols, [rhs])(*values)) for name, rhs in found.items()}
    for end, bearing, life in zip("ab", shaft.bearings, shaft.lives, strict=True):
        F_r, F_a = F[f"bearing {end} radially"], F[f"bearing {end} axially"]
        P = max(F_r, 0.56 * F_r + 1.6 * F_a)
        C = si_of(catalogue("bearing")[bearing].values["C"])
        assert life == pytest.approx(1e6 / (3600 * shaft.n) * (C / P) ** 3, rel=0.01)


def test_a_bevel_helical_unit_is_what_makers_offer(made, gearheat):
    """i = 20 and 5.5 kW: 93 to 97 % efficiency; forces on the pinion's bearings are those it was drawn with."""
    path, answer = made("bevel")
    assert 0.93 < answer.json["efficiency"] < 0.97
    assert [s["kind"] for s in answer.json["stages"]] == ["bevel", "helical"]
    found = gearheat("steady", path, "--json", "-").json["values"]
    stage = sizing.unit(["bevel", "helical"], 20.0, 5500.0, 1450 * math.pi / 30).stages[0]
    for k, forces in enumerate(stage.forces, start=1):
        assert found[f"stage_1.F_a_{k}"] == pytest.approx(forces[2], rel=0.03)


@pytest.mark.parametrize("name", ["two", "bevel", "four"])
def test_one_level_wets_all_wheels(made, gearheat, name):
    """The smallest wheel dips by three modules, none beyond its axis, and what is below the level holds the oil."""
    path, answer = made(name)
    found = gearheat("steady", path, "--json", "-").json["values"]
    parts = {p.name: p.values for p in load(path).spec.parts}
    wheels = {n: v for n, v in parts.items() if n.startswith("churning")}
    assert len(wheels) == len(answer.json["stages"])
    smallest = min(wheels, key=lambda n: wheels[n]["r"])
    assert found[f"{smallest}.h"] == pytest.approx(3 * wheels[smallest]["m_n"], rel=0.02)
    assert all(found[f"{n}.h"] < v["r"] for n, v in wheels.items())
    floor = parts["cooling"]["length"] * parts["cooling"]["width"]
    assert 0.5 < parts["oil"]["V"] / (parts["oil"]["level"] * floor) < 0.8


@pytest.mark.parametrize(
    ("stages", "ratio", "power", "most", "oil"),
    [
        ("helical,planetary", 30, "55 kW", 150, "50 l"),
        ("bevel,planetary", 25, "22 kW", 10, "30 l"),
        ("helical,worm", 60, "11 kW", 30, "12 l"),
    ],
)
def test_wheels_before_planets_and_worms_dip_as_wheels_do(gearheat, tmp_path, stages, ratio, power, most, oil):
    """They lose a few tenths of a percent at most, more where there is more oil; what is behind has a coefficient."""
    plate = ("--stages", stages, "--ratio", ratio, "--power", power, "--speed", "1480 rpm")
    lost = []
    for more in ((), ("--oil-volume", oil)):
        path = tmp_path / f"{len(more)}.toml"
        assert gearheat("new", "it", *plate, *more, "-o", path).code == 0
        types = {p.name: p.type for p in load(path).spec.parts}
        assert (types["churning_1"], types["churning_2"]) == ("GearChurning", "Churning")
        lost.append(gearheat("steady", path, "--json", "-").json["values"]["churning_1.P_loss"])
    assert lost[0] < most and lost[0] < lost[1] / 2


def test_planets_lose_less_than_a_blade_in_oil_would():
    """A blade from the axis to the reach of the planets, wholly in still oil, with a drag coefficient of 2."""
    for ratio in (3.5, 5.0, 9.0):
        stage = sizing.unit(["planetary"], ratio, 55000.0, 155.0).stages[0]
        assert stage.swept < 0.2 * (2 * stage.b * stage.reach**4 / 4)


@pytest.mark.parametrize(("ratio", "power", "b", "load"), [(10, "126 W", 3, 1.53), (7, "7.5 kW", 16, 2.68)])
def test_a_sun_is_as_wide_as_its_load_asks_and_no_disc(tmp_path, ratio, power, b, load):
    rig = new("a", stages="planetary", ratio=ratio, power=power, speed="3000 rpm", out=(path := tmp_path / "a.toml"))
    assert rig.sizes["stages"][0]["b"] == pytest.approx(b / 1000)
    text = path.read_text("utf-8")
    assert 'b = "assumed: for that load, at least 0.35 of the sun\'s diameter"' in text
    assert f"at most {load} N/mm2" in text


@pytest.mark.parametrize(("name", "count"), [("two", 0), ("four", 6)])
def test_bearings_that_reach_below_the_level_drag(made, name, count):
    path, answer = made(name)
    assert answer.code == 0, answer.err
    parts = {p.name: p for p in load(path).spec.parts}
    low = [p for n, p in parts.items() if "_bearing_" in n and p.values["oil_bath"]]
    assert len(low) == count
    level = parts["oil"].values["level"]
    assert all(p.values["height"] - p.values["D"] / 2 < level for p in low)


@pytest.mark.parametrize("name", thin(PLATES, 2))
def test_oil_side_coefficients_are_near_those_of_constants(made, gearheat, name):
    """ISO/TR 14179-2 has 200 W/(m2.K) at the walls; at rest a tenth of it is left."""
    path, _ = made(name)
    turning, rest = (
        gearheat("steady", path, *still, "--json", "-").json["values"]
        for still in ((), ("--set", "input.w=1e-3 rpm", "--set", "output.load=0 N.m"))
    )
    assert 80 < turning["oil_wall.h"] < 400
    assert 50 < turning["oil_gears_1.h"] < 1000
    assert 0 < rest["oil_wall.h"] < 0.3 * turning["oil_wall.h"]


def test_what_it_stands_on_is_a_choice(gearheat, tmp_path):
    """A frame takes more heat than a concrete floor, whose conductance grows with the size; rubber takes none."""
    share, foot = {}, {}
    for base, power in (("concrete", 7.5), ("steel", 7.5), ("flange", 7.5), ("free", 7.5), ("concrete", 0.75)):
        path = tmp_path / f"{base}{power}.toml"
        plate = ("--stages", "helical", "--ratio", 4, "--power", f"{power} kW", "--speed", "1450 rpm", "-o", path)
        answer = gearheat("new", "it", *plate, "--base", base, "--json", "-")
        assert answer.code == 0, answer.err
        share[base, power] = answer.json["foot_share"]
        found = gearheat("steady", path, "--json", "-").json["values"]
        foot[base, power] = found.get("foot.Q_flow", 0.0) / (found["surface.T"] - 20.0)
    assert share["free", 7.5] == foot["free", 7.5] == 0.0
    assert 0.05 < share["concrete", 7.5] < share["steel", 7.5] < 0.35
    assert share["steel", 7.5] < share["flange", 7.5] < 0.5
    assert foot["concrete", 0.75] < 0.8 * foot["concrete", 7.5]
    answer = gearheat("new", "it", *plate, "--base", "rubber")
    assert answer.code == 2
    assert "Bases: concrete, steel, flange, free." in answer.err


def test_a_fan_that_is_not_needed_is_told(gearheat, tmp_path):
    """What the unit without it does is said in figures; air of the room cools, too."""
    plate = ("--stages", "helical", "--ratio", 4, "--power", "7.5 kW", "--speed", "1450 rpm", "--json", "-")
    bare, fan, blown = (
        gearheat("new", "it", *plate, *option, "-o", tmp_path / f"{k}.toml")
        for k, option in enumerate(((), ("--fan",), ("--air-speed", "1.25 m/s")))
    )
    oil, eta = bare.json["oil_degC"], 100 * bare.json["efficiency"]
    assert f"without one the oil is at {oil:.1f} degC, the efficiency {eta:.2f} %" in fan.err
    assert max(answer.json["oil_degC"] for answer in (fan, blown)) < oil - 2
    assert "Leave out --fan, unless the unit has one, or give the housing that has one by --housing." in fan.err
    boxed = gearheat("new", "it", *plate, "--fan", "--housing", "1 m2", "-o", tmp_path / "boxed.toml")
    assert "Leave out --fan, unless the unit has one." in boxed.err


def test_a_motor_at_the_housing_heats_it(gearheat, tmp_path):
    plate = ("--stages", "helical", "--ratio", 4, "--power", "7.5 kW", "--speed", "1450 rpm", "--base", "flange")
    cold, warm = (
        gearheat("new", "it", *plate, *heat, "-o", tmp_path / f"{len(heat)}.toml", "--json", "-")
        for heat in ((), ("--motor-heat", "50 W", "--air-speed", "0.3 m/s"))
    )
    assert 2 < warm.json["oil_degC"] - cold.json["oil_degC"] < 15
    balance = gearheat("steady", tmp_path / "4.toml", "--json", "-").json["values"]
    assert balance["room.Q_flow"] == pytest.approx(balance["efficiency.P_loss"] + 50, rel=1e-6)
    for heat, words in (("50", "has no unit"), ("-5 W", "a motor gives heat")):
        answer = gearheat("new", "bad", *plate, f"--motor-heat={heat}", "-o", tmp_path / "bad.toml")
        assert answer.code == 2 and words in answer.err


@pytest.mark.parametrize("name", thin(PLATES, 1))
def test_a_housing_gives_off_what_the_standards_expect(made, gearheat, name):
    """10 to 14 W/(m2.K) in a small room without draught, 17 to 20 in a hall with 1.4 m/s, more if 80 K hotter."""
    path, answer = made(name)
    area = {p.name: p.values for p in load(path).spec.parts}["cooling"]["A"]
    held = answer.json["foot_share"] if answer.json["base"] == "flange" else 0.0  # what a steel plate in air takes
    assert 10 < (1 - held) * answer.json["loss_W"] / area / (answer.json["oil_degC"] - 20) < 22


def test_a_fan_without_a_shaft_is_named(made, gearheat, tmp_path):
    path, _ = made("spur")
    fan = '[part.fan]\ntype = "ShaftFan"\nk_v = "0.02 m"\nk = "1e-5 N.m.s2"\nsource = "assumed: small"\n\n'
    text = path.read_text("utf-8").replace("[part.room]", f"{fan}[part.room]")
    nets = 'air = ["room.air", "fan.room"]\nblown = ["fan.air", "cooling.air"]'
    (blown := tmp_path / "blown.toml").write_text(text.replace('air = ["room.air", "cooling.air"]', nets), "utf-8")
    answer = gearheat("steady", blown)
    assert answer.code == 2
    assert "fan.shaft is connected to nothing: no shaft is there." in answer.err


def test_churning_is_between_the_methods_of_the_standard(made, gearheat):
    """A two-stage unit at its name plate, the same depths: the methods differ by more from each other."""
    path, _ = made("bevel")
    by = [gearheat("losses", path, "--method", f"iso14179-{k}", "--json", "-").json for k in (1, 2)]
    here, first, second = (
        by[k]["losses_W"][whose]["churning"] for k, whose in ((0, "model"), (0, "method"), (1, "method"))
    )
    assert 0.5 * min(first, second) < here < 2 * max(first, second)


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        ("PAO 460", "ISO VG 460 PAO"),
        ("CLP HC 220", "ISO VG 220 PAO"),
        ("PG 680", "ISO VG 680 PAG"),
        ("CLP E 320", "ISO VG 320 ester"),
        ("VG220", "ISO VG 220 mineral"),
        ("CLP 220", "ISO VG 220 mineral"),
        ("iso vg 220 Mineral", "ISO VG 220 mineral"),
    ],
)
def test_an_oil_is_named_as_name_plates_do(written, meant):
    made = new("a", stages="Helical", ratio=3.0, power="2 kW", speed="1450 rpm", oil=written)
    assert meant in made.scenario.doc


def test_a_grease_is_no_oil(gearheat, tmp_path):
    plate = ("--stages", "helical", "--ratio", "3", "--power", "2 kW", "--speed", "1450 rpm")
    answer = gearheat("new", "a", *plate, "--oil", "bearing grease", "-o", tmp_path / "a.toml")
    assert answer.code == 2
    assert '"bearing grease" is a grease. Name an oil.' in answer.err


def test_what_is_wrong_with_a_name_plate_comes_at_once(gearheat, tmp_path):
    path = tmp_path / "a.toml"
    plate = ("--stages", "spur,warm", "--ratio", "90", "--power", "2", "--speed", "1450", "--housing", "3x2 m")
    answer = gearheat("new", "a b", *plate, "--oil", "water", "--base", "moon", "--oil-volume", "2", "-o", path)
    assert answer.code == 2 and len(answer.problems()) == 9
    assert '"3x2 m" has not three sides. Write "800x370x430 mm", or an area, "1.6 m2".' in answer.err
    assert 'no stage "warm". Stages: spur, helical, bevel, worm, planetary.' in answer.err
    assert "Give --stages helical,helical,helical." in answer.err
    assert not path.exists()


def test_one_fault_does_not_hide_another(gearheat, tmp_path):
    plate = ("--stages", "planetary", "--ratio", "-2", "--power", "2 kW", "--speed", "1450 rpm", "--bearings", "plain")
    rest = ("--base", "wall", "--motor-heat=-3 W", "--air-speed", "300 m/s", "--centre-distance", "100 mm")
    answer = gearheat("new", "a", *plate, *rest, "-o", tmp_path / "a.toml")
    assert answer.code == 2 and len(answer.problems()) == 6


@pytest.mark.parametrize(("stages", "ratio"), [(["planetary"] * 4, 2000), (["helical"] * 5, 2000)])
def test_more_stages_than_any_known_unit_are_drawn(gearheat, tmp_path, stages, ratio):
    """The usual efficiency goes on by the stage."""
    plate = ("--stages", ",".join(stages), "--ratio", ratio, "--power", "2 kW", "--speed", "1450 rpm", "--json", "-")
    answer = gearheat("new", "a", *plate, "-o", tmp_path / "a.toml")
    assert answer.code == 0, answer.err
    low, high = answer.json["usual"]["efficiency_pct"]
    fewer = usual(stages[1:], 2.0, ratio)
    assert low < fewer[0] and high < fewer[1]
    assert low < 100 * answer.json["efficiency"] < high


def test_a_file_that_was_begun_does_not_stay(monkeypatch, tmp_path):
    def fails(*_):
        raise KeyError("4")

    monkeypatch.setattr("gearheat.tools.build.new.usual", fails)
    with pytest.raises(KeyError):
        new("a", stages="helical", ratio=4.0, power="2 kW", speed="1450 rpm", out=tmp_path / "a.toml")
    assert not (tmp_path / "a.toml").exists()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--power", "90 MW"), "bearings end at 320 mm. Give 5815 kW or less"),
        (("--bearings", "needles"), 'no bearings "needles". Bearings: auto, ball, roller.'),
        (("--power", "7.5 kVA"), 'is apparent power. Give that of the shaft, such as "7.5 kW"'),
        (("--oil", "PAO PAG 220"), 'no oil "PAO PAG 220"'),
        (("--oil", "CLP 223"), 'no oil "CLP 223"'),
        (("--power", "2 kg"), 'unit "kg" does not fit'),
        (("--oil", "ISO VG 221"), 'no oil "ISO VG 221"'),
        (("--ratio", "0.1"), "expected 1/1 to 1/8. Give --stages helical,helical"),
        (("--ratio", "nan"), "a ratio of nan is none"),
        (("--ratio", "inf"), "a ratio of inf is none"),
        (("--ratio", "-4"), "a ratio of -4 is none"),
        (("--stages", ","), "no stage is given"),
        (("--stages", "helical,bevel"), "a bevel stage comes first"),
        (("--stages", "worm,helical"), "a worm stage comes last here, behind helical ones. Give --stages helical,worm"),
        (("--stages", "bevel,worm"), "shafts turn by a right angle once"),
        (("--air-speed", "-1 m/s"), "expected 0 m/s to 60 m/s"),
        (("--air-speed", "90 m/s"), "expected 0 m/s to 60 m/s"),
        (("--stages", "worm"), "expected 5 to 100"),
        (
            ("--stages", "planetary,helical"),
            "planetary stages come last here, and none with a worm. Give --stages helical,p",
        ),
        (
            ("--stages", "planetary,worm"),
            "planetary stages come last here, and none with a worm. Give --stages helical,w",
        ),
        (("--speed", "0 rpm"), "must be above 0"),
        (("--power", "22"), '--power = "22" has no unit. Write "22 kW" or "22 W"'),
        (("--power", "40 N.m"), 'unit "N.m" does not fit W. Write for example "7.5 kW".'),
        (("--power", "7.5 mW"), 'is in milliwatts. Write "7.5 MW" if megawatts are meant, else W.'),
        (("--oil-volume", "20"), '--oil-volume = "20" has no unit. Write "20 l" (expected a unit like m3).'),
        (("--power", "2,2 kW"), 'has a decimal comma. Write "2.2 kW"'),
        (("--ratio", "3,15"), '"3.15"'),
        (("--housing", "100x90x80 mm"), "is too small for the gears: expected"),
        (("--housing", "-1 m2"), "is no size"),
        (("--oil-volume", "90 l"), "which reaches the axes"),
    ],
)
def test_name_plates_that_are_wrong(gearheat, tmp_path, options, words):
    plate = {"--stages": "helical", "--ratio": "4", "--power": "2 kW", "--speed": "1450 rpm"} | dict([options])
    answer = gearheat("new", "a", *(item for pair in plate.items() for item in pair), "-o", tmp_path / "a.toml")
    assert answer.code == 2
    assert words in answer.err
    assert not (tmp_path / "a.toml").exists()


@pytest.mark.parametrize(
    ("option", "told"),
    [
        ({"power": "1.100 kW"}, '--power: 1.100 is read as 1.1 kW. Write "1100 kW" if a thousand is meant.'),
        ({"speed": "1.450 rpm"}, '--speed: 1.450 is read as 1.45 rpm. Write "1450 rpm" if a thousand is meant.'),
        ({"speed": "1.450 min-1"}, '--speed: 1.450 is read as 1.45 min-1. Write "1450 min-1" if a thousand is meant.'),
        ({"power": "9 kW", "oil_volume": "1.200 l"}, '--oil-volume: 1.200 is read as 1.2 l. Write "1200 l" if'),
        ({"power": "0.750 kW", "housing": "1.125 m2"}, ""),
        ({"power": "55.000 kW", "speed": "1450.125 rpm"}, ""),
    ],
)
def test_what_may_be_thousands_is_told(option, told):
    notes = new("a", stages="helical", ratio=4.0, **({"power": "1 W", "speed": "1450 rpm"} | option)).notes
    assert [note[: len(told)] for note in notes if "a thousand" in note] == [told] * bool(told)


def test_what_may_be_thousands_is_told_of_what_is_refused():
    with pytest.raises(ScenarioError, match=r"too small for the gears.*\n--housing: 1\.200 is read as 1\.2 mm\. Write"):
        new("a", stages="helical", ratio=4.0, power="1 kW", speed="1450 rpm", housing="1.200x370x430 mm")


UREG = pint.UnitRegistry()


@pytest.mark.parametrize(
    ("given", "same"),
    [
        ({"power": 750, "speed": 151.8}, {"power": "750 W", "speed": "151.8 rad/s"}),
        ({"power": 7.5 * UREG.kW, "speed": 1450 * UREG.rpm}, {"power": "7.5 kW"}),
        ({"housing": 1.2}, {"housing": "1.2 m2"}),
        ({"housing": 0.8 * UREG.m**2, "oil_volume": 1 * UREG.l}, {"housing": "0.8 m2", "oil_volume": "1 l"}),
        ({"centre_distance": 0.14, "motor_heat": 50}, {"centre_distance": "140 mm", "motor_heat": "50 W"}),
        ({"ratio": "4"}, {"ratio": 4.0}),
    ],
)
def test_numbers_in_si_and_quantities_are_taken_as_texts_are(given, same):
    plate = {"stages": "helical", "ratio": 4.0, "power": "2 kW", "speed": "1450 rpm"}
    one, other = (new("a", **(plate | values)).sizes for values in (given, same))
    assert {key: one[key] for key in ("stages", "loss_W")} == {key: other[key] for key in ("stages", "loss_W")}


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"name": 5}, "name = 5 is no text."),
        ({"oil": 5, "bearings": None}, "--oil = 5 is no text.\n--bearings = None is no text."),
        ({"stages": None}, '--stages = None is no text. Name them from the input on, such as "helical,helical".'),
        ({"stages": [1, 2]}, "--stages = [1, 2] is no text."),
        ({"speed": None}, '--speed = None is no value. Give one text, like "1450 rpm", number in SI, or quantity of'),
        ({"power": 7.5 * UREG.m}, '--power = "7.5 m": unit "m" does not fit W. Write for example "7.5 kW".'),
        ({"ratio": [4]}, "--ratio = [4] is no value."),
    ],
)
def test_what_is_no_value_in_python_is_named(wrong, words):
    plate = {"name": "a", "stages": "helical", "ratio": 4.0, "power": "2 kW", "speed": "1450 rpm"}
    with pytest.raises(ScenarioError, match=re.escape(words)):
        new(**(plate | wrong))


def test_a_power_too_small_for_standard_sizes_leaves_no_rig(gearheat, tmp_path):
    plate = ("--stages", "bevel", "--ratio", "3", "--speed", "1450 rpm", "-o", tmp_path / "a.toml")
    answer = gearheat("new", "a", *plate, "--power", "1e-6 W")
    assert answer.code == 2
    assert "1e-6 W at 1450 rpm gives no gearbox. Check --power and --speed." in answer.err
    assert not (tmp_path / "a.toml").exists()
    answer = gearheat("new", "a", *plate, "--power", "1 W")
    assert answer.code == 0
    assert "most of the power is lost" in answer.err


@pytest.mark.parametrize(
    ("stages", "ratio", "power"), [("helical,helical,helical", "60", "1 MW"), ("helical,helical", "12", "7.5 MW")]
)
def test_what_a_refusal_advises_works(gearheat, tmp_path, stages, ratio, power):
    """Bearings end at 320 mm; the power, ratio and speed that are named go, and but little more."""
    plate = {"--stages": stages, "--ratio": ratio, "--power": power, "--speed": "1450 rpm"}
    args = [item for pair in plate.items() for item in pair]
    told = gearheat("new", "a", *args, "-o", tmp_path / "a.toml").err
    kW, ratio, rpm = map(
        float, re.search(r"Give (\S+) kW or less, a ratio of (\S+) or less or (\S+) rpm", told).groups()
    )
    for option, value, off in (("--power", "{} kW", kW), ("--ratio", "{}", ratio), ("--speed", "{} rpm", rpm)):
        for factor, code in ((1.0, 0), (1.03, 2)):
            scaled = off / factor if option == "--speed" else off * factor
            other = [item for pair in (plate | {option: value.format(scaled)}).items() for item in pair]
            path = tmp_path / f"{option}{code}.toml"
            assert gearheat("new", "a", *other, "--cooler", "-o", path).code == code, (option, factor)


def test_carriers_of_a_wind_turbine_have_bearings_and_gears_before_planets_little_ratio():
    """3 MW at 15 rpm: gearboxes of such turbines lose about 3 %, and a high-speed stage is about 600 mm wide."""
    made = new("a", stages="planetary,planetary,helical", ratio=0.0103, power="3 MW", speed="15 rpm", cooler=True)
    assert made.sizes["bearings"][-1]["a"].startswith("NU 10/")
    assert 0.96 < made.sizes["efficiency"] < 0.98
    assert 0.4 < made.sizes["stages"][-1]["a"] < 0.7
    with pytest.raises(ScenarioError, match=r"at a shaft inside need 347 mm, and the catalogue's bearings for it end"):
        new("a", stages="planetary,helical,helical", ratio=0.015, power="2 MW", speed="17 rpm", cooler=True)


@pytest.mark.parametrize(
    ("stages", "ratio"),
    [
        ("worm", 150),
        ("worm", 3),
        ("planetary", 20),
        ("planetary,planetary", 500),
        ("spur", 90),
        ("helical,worm", 2000),
        ("bevel", 6),
        ("bevel", 200),
    ],
)
def test_the_stages_that_a_refusal_names_go(stages, ratio):
    plate = 2000.0, 1450 * math.pi / 30
    with pytest.raises(ScenarioError) as refused:
        sizing.unit(stages.split(","), ratio, *plate)
    named = re.search(r"Give --stages (\S+)\.", str(refused.value)).group(1).split(",")
    assert sizing.unit(named, ratio, *plate).ratio == pytest.approx(ratio, rel=0.06)
    assert ("worm" in named) == ("worm" in stages and ratio > 60) and ("bevel" in named) == ("bevel" in stages)
    assert ("planetary" in named) == ("planetary" in stages)


def test_planetary_stages_in_series_pass_the_torque_on(made, gearheat):
    """Each carrier drives the next sun; the ideal forces of one set, which follow from its shaft end, are refused."""
    path, answer = made("planetary_three")
    assert [s["kind"] for s in answer.json["stages"]] == ["planetary"] * 3
    assert 0.94 < answer.json["efficiency"] < 0.975  # the three units by themselves: .985^3
    values = gearheat("steady", path, "--json", "-").json["values"]
    assert values["input.tau"] < values["output.load"] / 130
    forces = [values[f"stage_{k}.F_t_sp"] for k in (1, 2, 3)]
    assert forces == sorted(forces)
    refused = gearheat("steady", path, "--set", "stage_1.power_flow=ideal")
    assert "stage_1.reading is connected to nothing" in refused.err


def test_a_worm_shaft_has_bearings_and_a_seal_of_its_size(gearheat, tmp_path):
    """12.6 mm by torsion: tapered rollers against each other, not a ball bearing of 60 or 85 mm for the thrust."""
    plate = ("--stages", "worm", "--ratio", 40, "--power", "1.5 kW", "--speed", "1450 rpm")
    found = {}
    for bearings in ("auto", "ball"):
        path = tmp_path / f"{bearings}.toml"
        answer = gearheat("new", "a", *plate, "--bearings", bearings, "-o", path, "--json", "-")
        parts = {part.name: part for part in load(path).spec.parts}
        found[bearings] = answer.json
        if bearings == "auto":
            assert parts["input_bearing_a"].type == "TaperedRollerBearing"
            assert parts["input_support"].values["arrangement"] == "face-to-face"
            assert parts["input_seal"].values["d_sh"] <= 0.025
            assert max(parts[f"input_bearing_{k}"].values["d"] for k in "ab") <= 0.032
    assert found["auto"]["oil_degC"] < found["ball"]["oil_degC"]
    assert found["auto"]["efficiency"] > found["ball"]["efficiency"]


@pytest.mark.parametrize(
    ("stages", "ratio", "kW"),
    [
        ("helical,helical", 11.2, 250.0),
        ("helical,helical,helical", 40.0, 200.0),
        ("bevel,helical,helical", 25.0, 110.0),
        ("helical,helical,helical", 31.5, 22.0),
        ("helical,helical", 20.0, 0.05),
        ("helical,worm", 60.0, 11.0),
    ],
)
def test_bearings_can_be_built(stages, ratio, kW):
    """No bore above the root of the pinion on the shaft; those beside each other leave some of the wall."""
    made = sizing.unit(stages.split(","), ratio, 1000 * kW, 1480 * math.pi / 30)
    for stage, shaft in zip(made.stages, made.shafts, strict=False):
        assert shaft.d <= max(stage.root, 0.010) and shaft.lasts
    sides = [[si_of(catalogue("bearing")[b].values["D"]) for b in shaft.bearings] for shaft in made.shafts]
    for stage, one, other in zip(made.stages, sides, sides[1:], strict=False):
        if stage.kind == "helical":
            assert all((a + b) / 2 < stage.a for a, b in zip(one, other, strict=True))


def test_a_unit_of_two_stages_and_55_kw_stands_still_air():
    """Makers sell it without a fan. Where two balls do not last one locates, and cylindrical rollers carry more."""
    made = new("a", stages="helical,helical", ratio=12.5, power="55 kW", speed="1480 rpm", oil="ISO VG 320")
    assert 75 < made.sizes["oil_degC"] < 115 and 0.96 < made.sizes["efficiency"] < 0.98
    parts = {part.name: part for part in made.scenario.spec.parts}
    for shaft, located, free in (("input", "b", "a"), ("middle", "a", "b")):
        assert parts[f"{shaft}_bearing_{located}"].type == "DeepGrooveBallBearing"
        assert parts[f"{shaft}_bearing_{free}"].type == "CylindricalRollerBearing"
        assert parts[f"{shaft}_support"].values["axial_share_a"] == (located == "a")
    assert 0.96 < gh.rate_by_method(made, "iso14179-1").found["eta"]["method"] < 0.99


@pytest.mark.parametrize(("axial", "steep"), [(2e3, False), (9e3, False), (3e4, True)])
def test_steep_tapered_bearings_are_for_axial_loads(axial, steep):
    ((a, b), lives, _), *_ = choose(0.065, 0.08, (1e4, 8e3), axial, 2.0, (TAPERED,))
    assert min(lives) > LIFE and a.D == b.D
    assert (a.name.startswith("SKF 313"), b.name.startswith("SKF 313")) == (steep, steep)


@pytest.mark.parametrize(("power", "rule"), [("7.5 kW", "1.506 times 41.3 mm"), ("2 MW", "1.204 times 265.8 mm")])
def test_bearings_of_a_carrier_say_their_rule(tmp_path, power, rule):
    new("a", stages="planetary", ratio=7, power=power, speed="1450 rpm", cooler=True, out=(path := tmp_path / "a.toml"))
    said = re.findall(r"bore above (.*) by load", path.read_text("utf-8"))
    assert said[-1] == f"{rule} by torsion, on a carrier, a life above 1e6 h"
    assert "carrier" not in said[0]


def test_friction_of_tapered_bearings_goes_by_the_external_axial_load():
    """As their maker has it (SKF6000, table 2a): the thrust of their radial loads is not in it."""
    made = new("a", stages="helical", ratio=4, power="15 kW", speed="1450 rpm", bearings="roller")
    kinds = {part.values["radial_thrust"] for part in made.scenario.spec.parts if part.type == "TaperedRollerBearing"}
    assert kinds == {"left out"}


def test_bearings_that_cannot_be_built_are_told(gearheat, tmp_path):
    plate = ("--stages", "helical", "--ratio", "4", "--power", "250 kW", "--speed", "1500 rpm")
    answer = gearheat("new", "a", *plate, "--centre-distance", "160 mm", "--cooler", "-o", tmp_path / "a.toml")
    assert "SKF 32316: a bore of 80 mm, 10 mm more than the pinion" in answer.err
    assert "bearings beside each other overlap by 68 mm" in answer.err


@pytest.mark.parametrize("stages", ["helical,helical", "bevel,helical", "planetary"])
def test_rollers_are_a_choice(gearheat, tmp_path, stages):
    plate = ("--stages", stages, "--ratio", 8, "--power", "15 kW", "--speed", "1450 rpm", "--bearings", "roller")
    answer = gearheat("new", "a", *plate, "-o", tmp_path / "a.toml", "--json", "-")
    assert answer.code == 0, answer.err
    types = {p.type for p in load(tmp_path / "a.toml").spec.parts if p.type.endswith("RollerBearing")}
    assert types == {"TaperedRollerBearing", *(["CylindricalRollerBearing"] if stages == "planetary" else [])}
    assert 0.94 < answer.json["efficiency"] < 0.99


def test_a_fan_and_a_cooler_cool(gearheat, tmp_path):
    plate = ("--stages", "helical,helical", "--ratio", 12, "--power", "200 kW", "--speed", "1480 rpm", "--json", "-")
    oil = {
        how: gearheat("new", "a", *plate, *how, "-o", tmp_path / f"{len(how)}{how[-1:]}.toml").json["oil_degC"]
        for how in ((), ("--fan",), ("--cooler",))
    }
    assert oil[()] > oil[("--fan",)] + 10
    assert 40 < oil[("--cooler",)] < 75


@pytest.mark.parametrize(
    ("stages", "power", "speed"), [("helical", "5 MW", "10000 rpm"), ("planetary", "1 MW", "1480 rpm")]
)
def test_a_cooler_takes_what_is_lost(stages, power, speed):
    """By the loss of the rig itself at the oil's temperature, no more than 50 K above its water."""
    made = new("it", stages=stages, ratio=5.0, power=power, speed=speed, oil="ISO VG 46 mineral", cooler=True)
    taken = next(p for p in made.scenario.spec.parts if p.name == "cooler").values["G"] * 50
    assert taken == pytest.approx(made.sizes["loss_W"], rel=0.02)
    assert 40 < made.sizes["oil_degC"] < 70
    assert not any("--cooler" in note for note in made.notes)


def test_a_data_sheet_takes_the_place_of_the_rules(gearheat, tmp_path):
    plate = ("--stages", "helical,helical", "--ratio", 12.56, "--power", "7.5 kW", "--speed", "1450 rpm", "--json", "-")
    sheet = ("--centre-distance", "140 mm", "--housing", "520x260x350 mm", "--oil-volume", "7 l")
    answer = gearheat("new", "a", *plate, *sheet, "-o", tmp_path / "a.toml")
    assert answer.code == 0, answer.err
    parts = {part.name: part.values for part in load(tmp_path / "a.toml").spec.parts}
    assert parts["stage_2"]["a_w"] == pytest.approx(0.140)
    assert [parts["cooling"][key] for key in ("length", "width", "height")] == pytest.approx([0.52, 0.26, 0.35])
    assert parts["oil"]["V"] == pytest.approx(7e-3)
    assert answer.json["usual"]["efficiency_pct"][0] < 100 * answer.json["efficiency"]
    assert sum(answer.json["losses_W"].values()) == pytest.approx(answer.json["loss_W"], rel=1e-6)
    assert answer.json["no_load_W"] < answer.json["loss_W"]


@pytest.mark.parametrize(
    ("plate", "housing"),
    [({"stages": "planetary", "ratio": 5, "power": "11 kW"}, "0.05 m2"), ({"stages": "worm", "ratio": 20}, "0.1 m2")],
)
def test_the_housing_that_a_refusal_names_goes(plate, housing):
    plate = {"power": "1.5 kW", "speed": "1450 rpm"} | plate
    with pytest.raises(ScenarioError) as refused:
        new("a", **plate, housing=housing)
    sides, area = re.search(r"expected (\S+ mm) at least, or (\S+ m2) by", str(refused.value)).groups()
    assert si_of(area) > si_of(housing)
    for other in (sides, area):
        assert new("a", **plate, housing=other).sizes["oil_degC"] > 20


@pytest.mark.parametrize(("power", "housing"), [("1.5 kW", "185x125x165 mm"), ("4 kW", "235x130x175 mm")])
def test_the_stages_of_a_geared_motor_lie_back_to_back(power, housing):
    """Its output stands behind its input: all stages beside one another would not go into its housing."""
    plate = {"stages": "helical,helical", "ratio": 20, "power": power, "speed": "1420 rpm", "base": "flange"}
    rig = new("a", **plate, centre_distance="80 mm", housing=housing)
    length, _, rest = housing.partition("x")
    assert rig.scenario.spec.part("cooling").values["length"] == pytest.approx(float(length) / 1000)
    with pytest.raises(ScenarioError, match="too small for the gears"):
        new("a", **plate, centre_distance="80 mm", housing=f"{0.7 * float(length):.0f}x{rest}")


def test_a_housing_that_is_much_too_large_is_told():
    plate = {"stages": "helical,helical", "ratio": 12.0, "power": "7.5 kW", "speed": "1450 rpm"}
    notes = new("a", **plate, housing="328x155x210 cm").notes
    assert "--housing has 30.5 m2, 100 times the 0.305 m2 of a box around the gears. Check its unit." in notes
    assert not any("--housing" in note for note in new("a", **plate, housing="1.1 m2").notes)


@pytest.mark.parametrize("base", ["concrete", "flange"])
@pytest.mark.parametrize(("stages", "ratio"), [("helical", 7.5), ("spur", 8), ("planetary", 5), ("worm", 60)])
@pytest.mark.parametrize("speed", ["60 rpm", "6000 rpm"])
def test_the_smallest_gearboxes(tmp_path, stages, ratio, speed, base):
    for power in ("5 W", "0.1 kW", "0.4 kW"):
        rig = new("a", stages=stages, ratio=ratio, power=power, speed=speed, base=base, out=tmp_path / f"{power}.toml")
        assert rig.sizes["ratio"] == pytest.approx(ratio, rel=0.05)


def test_a_centre_distance_that_holds_no_gears(gearheat, tmp_path):
    plate = ("--stages", "helical", "--ratio", "7.5", "--power", "1 kW", "--speed", "1450 rpm")
    answer = gearheat("new", "a", *plate, "--centre-distance", "15 mm", "-o", tmp_path / "a.toml")
    assert answer.code == 2
    assert "--centre-distance of 15 mm holds no gears" in answer.err and "mm or more" in answer.err


def test_a_file_that_is_there_stays(gearheat, tmp_path):
    (path := tmp_path / "a.toml").write_text("mine")
    plate = ("--stages", "spur", "--ratio", "3", "--power", "2 kW", "--speed", "1450 rpm")
    assert "is there already" in gearheat("new", "a", *plate, "-o", path).err
    assert path.read_text() == "mine"


def test_a_name_that_no_file_can_have(gearheat, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    answer = gearheat("new", "x" * 300, "--stages", "spur", "--ratio", "3", "--power", "2 kW", "--speed", "1450 rpm")
    assert answer.code == 2
    assert "x.toml: cannot be written (File name too long)" in answer.err


@pytest.mark.parametrize("name", ["two", "planetary", "bevel"])
def test_tooth_friction_is_as_its_formula_is_printed(made, name):
    """F_bt/b of Schlenk1994, with which ISO/TR 14179-2 prints the same friction."""
    path, _ = made(name)
    toothed = [part.values for part in load(path).spec.parts if "k_mu" in part.values]
    assert toothed
    assert {(values["line_load"], values["k_mu"]) for values in toothed} == {("F_bt/b", 1.0)}
