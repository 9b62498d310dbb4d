"""What may differ without being a fault, by roles."""

import math
from dataclasses import replace

import gearheat as gh
import pytest
from gearheat.model.machines.roles import Roles
from gearheat.model.parts.free_form import EXTRA_PARTS
from gearheat.model.run.rows import evaluate_at
from gearheat.model.run.steady import steady
from gearheat.scenarios.load import list_rigs, load
from gearheat.scenarios.nuisances import NEAREST, nuisances
from gearheat.tools.diagnose.library.extras import thin_film_friction
from gearheat.tools.diagnose.library.forms import Context

RIGS = tuple(list_rigs())


def named(case, rig, prior=None, uncertainties=None):
    return {n.name: n for n in nuisances(case(rig).roles, prior or {}, uncertainties or {})}


def test_groups_of_the_planetary_gearbox(case):
    found = named(case, "planetary")
    assert {name: set(n.paths) for name, n in found.items()} == {
        "mesh friction": {"gear_set.k_mu"},
        "bearing loss": {"carrier_bearing.k_loss", "sun_bearing.k_loss", "planet_bearing.k_loss"},
        "seal loss": {"carrier_seal.k_loss", "sun_seal.k_loss"},
        "churning": {"churning.k_loss"},
        "radiation": {"cooling.emissivity"},
        "oil to what turns": {"oil_gears.G"},
        "oil to other bodies": {"oil_carrier_body.G", "oil_wall.G"},
        "between bodies": {"carrier_body_wall.G", "wall_surface.G"},
        "capacities": {"gears.C", "carrier_body.C", "wall.C", "surface.C", "oil.V"},
        "capacities inside": {"gears.C", "carrier_body.C"},
        "foundation": {"foot.G"},
        "outer area": {"cooling.A"},
        "convection": {"cooling.k_conv"},
    }


def test_what_is_zero_has_no_uncertain_factor(case):
    c = case("planetary")
    without = replace(c.roles, spec=c.scenario.spec.with_values({"foot.G": 0.0}))
    assert "foundation" not in {n.name for n in nuisances(without, {}, {})}


def test_the_card_says_how_uncertain(case):
    assert named(case, "planetary")["mesh friction"].sd == 0.1
    assert named(case, "planetary", {"mu": 0.15})["mesh friction"].sd == 0.15
    both = named(case, "rv_stage", {"HelicalGearPair.k_mu": 0.05})["mesh friction"]
    assert both.sd == 0.1 and both.paths["stage_1.k_mu"] == pytest.approx(0.5)
    least = named(case, "helical_two_stage", {"HelicalGearPair.k_mu": 0.3})["mesh friction"]
    assert least.sd == pytest.approx(0.3) and set(least.paths.values()) == {1.0}


def test_a_card_may_hold_parameters_fast(case):
    assert named(case, "planetary", {"mu": 0.0})["mesh friction"].sd == 0.0
    mixed = named(case, "rv_stage", {"mu": 0.0, "HelicalGearPair.k_mu": 0.2})["mesh friction"]
    assert mixed.sd == 0.2 and mixed.paths == {"stage_1.k_mu": 1.0, "mesh.mu_fluid": 0.0, "mesh.mu_boundary": 0.0}


def test_an_area_is_known_unless_it_is_said_not_to_be(case):
    assert named(case, "helical_two_stage", {"hconv": 0.3})["outer area"].sd == 0.0
    stated = named(case, "helical_two_stage", {"FinnedBoxCooling.A": 0.3})
    assert (stated["convection"].sd, stated["outer area"].sd) == (0.08, 0.3)
    assert stated["outer area"].paths == {"cooling.A": 1.0, "cooling.A_fins": 0.0}


def test_the_rig_file_says_how_uncertain_unless_the_card_does(case):
    stated = {"foot.G": 0.19}
    assert named(case, "planetary", None, stated)["foundation"].sd == pytest.approx(0.19 / 9.332)
    assert named(case, "planetary", {"hconv": 0.3}, stated)["foundation"].sd == pytest.approx(0.15)


def test_what_rules_give_may_be_nearer(case):
    roles, rules = case("planetary").roles, {"sun_seal.k_loss": 0.7, "carrier_seal.k_loss": 0.7, "cooling.A": 0.084}
    found = {n.name: n for n in nuisances(roles, {}, {"foot.G": 0.19}, rules)}
    near = {name: n.near for name, n in found.items() if n.near < 1}
    assert near == {"seal loss": pytest.approx(0.15 / 0.7), "outer area": NEAREST}
    assert found["seal loss"].sd == pytest.approx(0.7) and found["outer area"].sd == pytest.approx(0.2)
    carded = {n.name: n for n in nuisances(roles, {"LipSeal.k_loss": 0.4}, {}, rules)}["seal loss"]
    assert (carded.sd, carded.near) == (0.4, 1.0)


@pytest.mark.parametrize("rig", ["planetary", "helical_two_stage", "cycloidal"])
def test_more_convection_does_not_radiate_more(case, rig):
    c = case(rig)
    flat = c.scenario.spec.flat()
    convection = named(case, rig)["convection"]
    own = dict(zip([q.name for q in flat.parameters], flat.starts("parameter"), strict=True))
    factor = {path: own[path] * math.exp(0.2 * e) for path, e in convection.paths.items()}

    def flows(values):
        """Convected and radiated at the same temperatures."""
        x = [c.nominal[q.name][0] for q in flat.states]
        u = [c.scenario.operating_point.get(q.name, q.start) for q in flat.inputs]
        found = evaluate_at(flat, x, u, list((own | values).values()))
        y = dict(zip([q.name for q in flat.outputs], found["y"], strict=True))
        return [sum(float(y[f"{s}.Q_flow_{way}"]) for s in c.roles.surfaces) for way in ("convection", "radiation")]

    (convected, radiated), (more, same) = flows({}), flows(factor)
    assert same == pytest.approx(radiated, rel=1e-9)
    assert more / convected == pytest.approx(math.exp(0.2), rel=0.12)


@pytest.mark.parametrize("rig", RIGS)
def test_every_path_is_a_parameter_of_the_rig(case, rig):
    c = case(rig)
    known = {q.name for q in c.scenario.spec.flat().parameters}
    for n in nuisances(c.roles, {}, {}):
        assert set(n.paths) <= known and (n.sd > 0) == (n.wide > 0) == (n.name != "outer area")


def test_friction_in_thin_films_is_none_until_a_reference_tells_it(case):
    c = case("helical_two_stage")
    films = thin_film_friction(Context(c.roles, c.ranges, c.sensors))
    assert films.sd == 0.0 and films.wide == 1.0
    flat = c.scenario.spec.with_parts(films.parts, films.connections, EXTRA_PARTS).flat()
    none, some = (
        steady(flat, {**c.scenario.operating_point, **{path: math.exp(z) for path in films.paths}}) for z in (0.0, 0.5)
    )
    assert none["oil.T"][0] == pytest.approx(c.nominal["oil.T"][0], abs=1e-4)
    assert some["oil.T"][0] > none["oil.T"][0] + 0.1
    assert thin_film_friction(Context(case("harmonic_printed").roles, c.ranges, c.sensors)) is None


def test_a_healthy_campaign_tells_the_flow_of_a_fan(tmp_path):
    gh.new("mine", stages="helical", ratio=3, power="30 kW", speed="1450 rpm", fan=True, out=tmp_path / "mine.toml")
    scenario = load(tmp_path / "mine.toml")
    found = {n.name: n for n in nuisances(Roles.of(scenario.spec), {}, scenario.uncertainties)}["flow of fans"]
    assert found.paths.keys() == {"fan.k_v"} and found.sd == 0.0 < found.wide
