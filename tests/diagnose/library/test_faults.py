"""Every part type says by which causes it may fail, and a machine that has it has them."""

from dataclasses import replace

import numpy as np
import pytest
from gearheat.model.core.component import SOUND
from gearheat.model.core.declare import Parameter, list_declared
from gearheat.model.machines.roles import FAULTS, Roles, faults_of
from gearheat.model.machines.spec import PartSpec
from gearheat.model.parts import PARTS
from gearheat.model.parts.free_form import EXTRA_PARTS
from gearheat.scenarios.load import list_rigs
from gearheat.tools.diagnose.library.cause import Row, as_array
from gearheat.tools.diagnose.library.check import parameters, problems
from gearheat.tools.diagnose.library.entries import TABLE
from gearheat.tools.diagnose.library.registry import library
from one_part import EXAMPLES

#: Parts that carry a cause by a parameter of their own.
CARRIERS = [(kind, cause) for kind, cls in PARTS.items() for cause, keys in faults_of(cls).items() if keys]


@pytest.mark.parametrize("kind", PARTS)
def test_a_part_type_says_by_what_it_may_fail(kind):
    cls = PARTS[kind]
    assert cls.faults is not None or cls.role in FAULTS, "declare `faults`, SOUND where nothing can fail"
    for cause, keys in faults_of(cls).items():
        assert TABLE[cause]["name"]
        assert set(keys) <= set(list_declared(cls, Parameter))


def test_what_adds_to_a_model_does_not_fail():
    assert all(faults_of(cls) == SOUND for cls in EXTRA_PARTS.values())


@pytest.mark.parametrize("rig", list_rigs())
def test_a_machine_has_the_causes_of_its_parts(case, rig):
    c = case(rig)
    ids = {x.id for x in c.causes}
    for part in c.scenario.spec.parts:
        faults = faults_of(c.scenario.spec.types[part.type])
        assert not faults or ids & set(faults), part.name


@pytest.mark.parametrize(("kind", "cause"), CARRIERS)
def test_a_cause_changes_the_parameters_that_carry_it(case, kind, cause):
    c = case("helical_two_stage")
    values = EXAMPLES[kind]
    spec = c.scenario.spec.with_parts([PartSpec("mine", kind, values)], [])
    found = {x.id: x for x in library(Roles.of(spec), c.ranges, c.sensors)}
    assert problems(found[cause], spec, c.sensors, c.ranges) == []
    base = parameters(spec)
    (key, exponent), *_ = faults_of(PARTS[kind])[cause].items()
    theta = {found[cause].size.name: -0.5}
    changed = [f.values(theta, Row(base, {})) for f in found[cause].forms if not f.regime and not f.spread]
    ratios = [v[f"mine.{key}"] / base[f"mine.{key}"] for v in changed if f"mine.{key}" in v]
    assert ratios == [pytest.approx(np.exp(-0.5 * exponent))] * (2 if len(changed) > 1 else 1)  # all of them, this one


def test_solid_walls_are_no_contacts(case):
    spec = case("helical_two_stage").scenario.spec
    G = 50.0 * 0.6 / 0.008
    assert spec.part("wall_surface").values["G"] != G
    wall = PartSpec("wall_surface", "PlaneWall", {"k": 50.0, "A": 0.6, "d": 0.008})
    solid = replace(spec, parts=tuple(wall if p.name == "wall_surface" else p for p in spec.parts))
    before, after = Roles.of(spec), Roles.of(replace(solid, types={**spec.types, "PlaneWall": PARTS["PlaneWall"]}))
    assert set(before.contacts) - set(after.contacts) == {"wall_surface"}
    assert after.walls == ("wall_surface",) and before.walls == ()
    assert (after.inside, after.outside) == (before.inside, before.outside)


def test_a_cooling_may_stop_in_a_warm_hall(case):
    c = case("planetary")
    forms = {f.name: f for f in c.cause("cooling.air").forms}
    form = forms["above a room temperature"]
    (room,) = [s.name for s in c.sensors if s.kind == "ambient"]
    shows = {name: np.full(2, v) for name, v in c.ranges.mid.items()} | {room: np.array([280.0, 310.0])}
    row = Row({}, shows)
    theta = {"G_ref": -1.0, "e": 0.0, "c": 0.0, "threshold": 295.0, "width": 1.0}
    cold, warm = as_array(form.values(theta, row)["extra_air.G_ref"], 2)
    assert cold == pytest.approx(0.0, abs=1e-3) and warm == pytest.approx(-1.0, rel=1e-3)


def test_a_thermometer_usually_errs_by_a_kelvin_whatever_the_machine_rises(case):
    c = case("planetary")
    cool = library(c.roles, replace(c.ranges, rise=8.0), c.sensors)
    sizes = {x.id: x.size for x in cool}
    for kind in ("oil_temp.offset", "wall_temp.offset", "ambient.bias"):
        assert sizes[f"sensor.{kind}"].sd >= 1.0 and sizes[f"sensor.{kind}"].high >= 4.0
