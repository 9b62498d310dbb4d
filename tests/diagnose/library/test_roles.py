"""Roles are found by type and nets, in every shipped rig."""

from dataclasses import replace

import pytest
from gearheat.model.errors import ScenarioError
from gearheat.model.machines.roles import Roles
from gearheat.model.machines.spec import PartSpec, Spec
from gearheat.scenarios.load import list_rigs, load

RIGS = tuple(list_rigs())


def places(roles: Roles) -> dict[str, list[tuple[str, ...]]]:
    return {role: [place.parts for place in found] for role, found in roles.places.items()}


def test_planetary_gearbox():
    roles = Roles.of(load("planetary").spec)
    assert places(roles) == {
        "teeth": [("gear_set",)],
        "bearing": [("carrier_bearing",), ("sun_bearing",), ("planet_bearing",)],
        "seal": [("carrier_seal",), ("sun_seal",)],
        "churning": [("churning",)],
    }
    assert (roles.speed, roles.torque, roles.oil) == ("carrier.w", "carrier.tau", "oil.T")
    assert (roles.viscosity, roles.reading, roles.room) == ("oil.nu", "carrier.reading", "room")
    assert roles.surfaces == ("cooling",) and roles.foundation == ("foot",) and roles.coolers == ()
    assert roles.oil_side == ("oil_gears", "oil_carrier_body", "oil_wall")
    assert roles.contacts == ("carrier_body_wall", "wall_surface")
    assert (roles.inside, roles.outside) == (("gears", "carrier_body"), ("wall", "surface"))
    assert roles.cooling == ("cooling.A", "foot.G") and roles.air_side == ("cooling.A",)
    bearing = roles.places["bearing"][0]
    assert (bearing.shaft, bearing.inner, bearing.outer) == tuple(
        f"carrier_bearing.{port}" for port in ("shaft", "inner", "outer")
    )
    assert roles.at(bearing.lubricant, "grease", "bath") == "grease"
    assert roles.at(roles.places["seal"][0].lubricant, "grease", "bath") == "oil"  # a seal has no lubricant of its own


def test_helical_gearbox():
    roles = Roles.of(load("helical_two_stage").spec)
    assert places(roles) == {
        "teeth": [("stage_1",), ("stage_2",)],
        "bearing": [(f"{shaft}_bearing_a", f"{shaft}_bearing_b") for shaft in ("input", "middle", "output")],
        "seal": [("input_seal",), ("output_seal",)],
        "churning": [("churning_1",), ("churning_2",)],
    }
    assert (roles.speed, roles.torque) == ("input.w", "input.tau")
    assert roles.oil_side == ("oil_gears", "oil_wall")
    assert roles.contacts == ("gears_shafts", "shafts_wall", "wall_surface")
    assert (roles.inside, roles.outside) == (("gears", "shafts"), ("wall", "surface"))
    assert roles.cooling == ("cooling.A", "cooling.A_fins", "foot.G")


def test_where_no_part_moves_the_oil_the_shaft_end_does():
    (place,) = Roles.of(load("cycloidal").spec).places["churning"]
    assert (place.parts, place.shaft, place.lubricant) == ((), "input.flange", "oil.lubricant")


def test_grease_is_the_bath_of_a_greased_machine():
    roles = Roles.of(load("rv_stage").spec)
    assert (roles.bath, roles.oil, roles.viscosity, roles.oil_heat) == ("grease", "discs.T", "grease.nu", "discs.heat")


def test_a_closed_loop_is_loaded_by_its_clutch_and_cooled_by_its_thermostat():
    roles = Roles.of(load("fzg_four_square").spec)
    assert (roles.speed, roles.torque, roles.reading) == ("clutch.w_a", "clutch.tau", "clutch.reading")
    assert (roles.thermostats, roles.coolers) == (("thermostat",), ("oil_thermostat",))


def test_a_contact_without_lubricant():
    roles = Roles.of(load("harmonic_printed").spec)
    assert (roles.bath, roles.viscosity, roles.places["churning"]) == ("", "", ())
    assert [place.lubricant for place in roles.places["teeth"]] == [""]


def test_a_housing_that_tells_its_area_has_a_factor_on_its_convection():
    cooling = Roles.of(load("cycloidal_areas").spec).cooling
    assert cooling == tuple(f"{w}_cooling.{key}" for key in ("k_conv", "emissivity") for w in ("flat", "cylinder"))


@pytest.mark.parametrize("rig", RIGS)
def test_every_rig_has_teeth_a_room_and_bodies_on_one_side_each(rig):
    spec = load(rig).spec
    roles = Roles.of(spec)
    assert (roles.places["teeth"] or roles.having("pump")) and roles.room and roles.ends and roles.cooling
    assert not set(roles.inside) & set(roles.outside)
    assert {*roles.inside, *roles.outside} == set(roles.having("body"))
    conductors = (*roles.foundation, *roles.coolers, *roles.oil_side, *roles.contacts, *roles.walls)
    assert sorted(conductors) == sorted(roles.having("conductor", "jet", "cooler"))
    known = {f"{p.name}.{key}" for p in spec.parts for key in vars_of(spec, p)}
    assert set(roles.scaled(*(p.name for p in spec.parts))) <= known


def vars_of(spec: Spec, part: PartSpec) -> set[str]:
    return {name for base in spec.types[part.type].__mro__ for name in vars(base)}


def test_names_of_parts_do_not_matter():
    spec = load("helical_two_stage").spec
    renamed = {p.name: f"x{k}" for k, p in enumerate(spec.parts)}

    def new(port: str) -> str:
        name, _, key = port.partition(".")
        return f"{renamed[name]}.{key}"

    parts = tuple(replace(p, name=renamed[p.name]) for p in spec.parts)
    other = Roles.of(replace(spec, parts=parts, connections=tuple(tuple(map(new, net)) for net in spec.connections)))
    own = Roles.of(spec)
    assert (other.speed, other.oil, other.reading) == (new(own.speed), new(own.oil), new(own.reading))
    assert other.contacts == tuple(renamed[name] for name in own.contacts)


def test_a_machine_without_shaft_ends_is_refused():
    spec = load("planetary").spec
    gone = {p.name for p in spec.parts if p.type == "ShaftEnd"}
    nets = tuple(tuple(port for port in net if port.partition(".")[0] not in gone) for net in spec.connections)
    with pytest.raises(ScenarioError, match="Add a ShaftEnd"):
        Roles.of(replace(spec, parts=tuple(p for p in spec.parts if p.name not in gone), connections=nets))


def test_a_grey_box_with_oil_jets_and_a_cooler_behind_a_thermostat():
    roles = Roles.of(load("wind_turbine").spec)
    assert [place.parts for place in roles.places["bearing"]] == [("bearing_1_loss",), ("bearing_2_loss",)]
    assert (roles.switches, roles.coolers, roles.foundation) == (("thermostat",), ("cooler",), ("surface",))
    assert set(roles.oil_side) == {"circulation", "splash", "jet_1", "jet_2"}
    assert (roles.oil, roles.outside) == ("sump.T", ("housing",))
