"""Every cause on every rig: sound forms, symbols and numbers alike, nothing at size zero."""

from collections.abc import Mapping
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from gearheat.model.machines.roles import Roles
from gearheat.model.machines.spec import PartSpec
from gearheat.model.parts.free_form import EXTRA_PARTS
from gearheat.model.run.steady import steady
from gearheat.scenarios.load import list_rigs, load
from gearheat.tools.diagnose.library.cause import Row, as_array
from gearheat.tools.diagnose.library.check import parameters, problems
from gearheat.tools.diagnose.library.extras import thin_film_friction
from gearheat.tools.diagnose.library.forms import BY_LAW, Context
from gearheat.tools.diagnose.library.losses import CONTACT
from gearheat.tools.diagnose.library.registry import library
from gearheat.tools.diagnose.report.extension import Applied, calibration, extended

RIGS = tuple(list_rigs())
ROWS = 4
FEATURES = {
    "order": np.linspace(0, 1, ROWS),
    "direction": np.array([1.0, -1.0, 1.0, -1.0]),
    "rise": np.array([12.0, 30.0, 41.0, 55.0]),
    "humidity": np.array([0.3, 0.5, 0.6, 0.4]),
    "second": np.array([0.0, 1.0, 0.0, 1.0]),
    "dwell": np.array([14400.0, 5400.0, 14400.0, 5400.0]),
}


@pytest.mark.parametrize("rig", RIGS)
def test_forms_are_sound_and_neutral_at_size_zero(case, rig):
    c = case(rig)
    assert len({x.id for x in c.causes}) == len(c.causes)
    assert [p for x in c.causes for p in problems(x, c.scenario.spec, c.sensors, c.ranges)] == []


@pytest.mark.parametrize("share", [0.001, 0.5])
@pytest.mark.parametrize("rig", RIGS)
def test_a_rig_with_what_causes_and_calibration_add_is_a_rig(case, rig, share, tmp_path):
    c, added = case(rig), {}
    for cause, form in ((x, f) for x in c.causes for f in x.forms if f.parts and not f.spread):
        size = cause.size_of(form)
        theta = {s.name: s.low + share * (s.high - s.low) for s in form.shapes} | {size.name: size.sd}
        added.setdefault(form.connections, Applied(cause.id, cause.doc, form, theta))
    films = thin_film_friction(Context(c.roles, c.ranges, c.sensors))
    also = [calibration(films, dict.fromkeys(films.paths, 0.1))] if films else []
    (path := tmp_path / "extended.toml").write_text(extended(c.scenario, {}, [*added.values()], "x", 1, also).text({}))
    parts = {p.name for p in load(path).spec.parts} - {p.name for p in c.scenario.spec.parts}
    assert len(parts) > len(also) and all(name.startswith("found_") for name in parts)


class Symbols(Mapping):
    """A symbol for every name that is asked for, of known numbers."""

    def __init__(self, numbers):
        self.numbers, self.made = numbers, {}

    def __getitem__(self, name):
        self.numbers[name]
        return self.made.setdefault(name, ca.SX.sym(name.replace(".", "_")))

    def __iter__(self):
        return iter(self.numbers)

    def __len__(self):
        return len(self.numbers)


def said(form, theta, row, read):
    """All that a form says, by name."""
    found = dict(form.values(theta, row)) if form.values else {}
    found |= form.truth(theta, row) if form.truth else {}
    found |= form.shown(theta, row, read) if form.shown else {}
    return found | ({"pace": form.pace(theta, row)} if form.pace else {})


def test_oil_beside_the_main_bath_is_no_joint(case):
    c = case("helical_two_stage")
    splash = PartSpec("splash", "SplashConductor", {"A": 0.1, "r": 0.05, "c_p": 2e3, "alpha_T": -7e-4, "share": 0.5})
    nets = [("gears.heat", "splash.a"), ("wall.heat", "splash.b"), ("input_seal.shaft", "splash.shaft")]
    roles = Roles.of(c.scenario.spec.with_parts([splash], [*nets, ("oil.lubricant", "splash.lubricant")]))
    assert "splash" in roles.oil_side and "splash" not in (*roles.contacts, *roles.walls)
    forms = {x.id: [f.name for f in x.forms] for x in library(roles, c.ranges, c.sensors)}
    assert not any("splash" in name for name in forms["cooling.contact"])


@pytest.mark.parametrize(("power", "ways"), [(1e-4, ["turning slower", "clogged"]), (0.0, [""])])
def test_a_fan_that_turns_slower_takes_less_power_and_a_clogged_one_as_much(case, power, ways):
    c = case("helical_two_stage")
    part, nets = PartSpec("fan", "ShaftFan", {"k_v": 0.02, "k": power}), [("input.flange", "fan.shaft")]
    roles = Roles.of(c.scenario.spec.with_parts([part], nets))
    cause = next(x for x in library(roles, c.ranges, c.sensors) if x.id == "cooling.fan")
    forms = {f.name: f for f in cause.forms if f.name in (*ways, "")}
    assert list(forms) == ways and sum(f.weight for f in cause.forms) == pytest.approx(1.0)
    row, theta = Row(base={"fan.k_v": 0.02, "fan.k": power}, sensors={}), {"ln_factor": np.log(0.4)}
    found = [{path: float(v) for path, v in f.values(theta, row).items()} for f in forms.values()]
    assert all(values["fan.k_v"] == pytest.approx(0.008) for values in found)
    assert [values.get("fan.k", power) for values in found] == pytest.approx([0.16e-4, 1e-4] if power else [0.0])


@pytest.mark.parametrize("rig", RIGS)
def test_symbols_and_arrays_of_rows_give_the_same(case, rig):
    c, rng = case(rig), np.random.default_rng(1)
    own = parameters(c.scenario.spec)
    for cause in c.causes:
        for form in cause.forms:
            added = {f"{p.name}.{key}": v for p in form.parts for key, v in p.values.items()}
            base = {path: np.full(ROWS, v) for path, v in (own | added).items()}
            shows = {s.name: c.ranges.mid[s.name] * rng.uniform(0.8, 1.2, ROWS) for s in c.sensors}
            size = cause.size_of(form)
            theta = {size.name: 0.4 * size.sd}
            theta |= {shape.name: float(shape.at(rng.normal())) for shape in form.shapes}
            numbers = said(form, theta, Row(base=base, sensors=shows, **FEATURES), shows)
            b, s, r = Symbols(base), Symbols(shows), Symbols(shows)
            f = {name: ca.SX.sym(name) for name in FEATURES}
            t = {name: ca.SX.sym(name) for name in theta}
            symbols = said(form, t, Row(base=b, sensors=s, **f), r)
            assert symbols.keys() == numbers.keys()
            whole = ca.vertcat(*(ca.SX(v) for v in symbols.values()))
            made = [*b.made.values(), *s.made.values(), *r.made.values(), *f.values(), *t.values()]
            function = ca.Function("form", made, [whole, ca.jacobian(whole, ca.vertcat(*t.values()))])
            given = [base[k] for k in b.made] + [shows[k] for k in s.made] + [shows[k] for k in r.made]
            for k in range(ROWS):
                at = [v[k] for v in (*given, *FEATURES.values())] + list(theta.values())
                value, slope = function(*at)
                expected = [as_array(v, ROWS)[k] for v in numbers.values()]
                np.testing.assert_allclose(value.full().ravel(), expected, rtol=1e-9, atol=1e-12, err_msg=cause.id)
                assert np.isfinite(slope.full()).all(), (cause.id, form.name)


@pytest.mark.parametrize("rig", RIGS)
def test_extra_parts_of_all_causes_change_nothing(case, rig):
    c = case(rig)
    parts = {p.name: p for x in c.causes for f in x.forms for p in f.parts}
    nets = dict.fromkeys(net for x in c.causes for f in x.forms for net in f.connections)
    flat = c.scenario.spec.with_parts(parts.values(), nets, EXTRA_PARTS).flat()
    found = steady(flat, c.scenario.operating_point)
    for q in flat.states:
        assert found[q.name][0] == pytest.approx(c.nominal[q.name][0], abs=1e-4), q.name


@pytest.mark.parametrize(
    ("rig", "cause"),
    [
        ("planetary", "losses.bearing_preload"),
        ("helical_two_stage", "losses.churning"),
        ("helical_two_stage", "losses.seal_drag"),
        ("harmonic", "losses.mesh_friction"),
        ("fzg_four_square", "losses.seal_drag"),
    ],
)
def test_the_size_is_the_power_of_all_parts_at_the_reference(case, rig, cause):
    c = case(rig)
    x = c.cause(cause)
    general = [f for f in x.forms if not f.regime]
    for form in general[:2] + [f for f in general if f.name == BY_LAW]:
        spec = c.scenario.spec.with_parts(form.parts, form.connections, EXTRA_PARTS)
        theta = {"P_ref": 0.01 * c.ranges.loss} | {s.name: float(s.at(0.0)) for s in form.shapes}
        row = Row(base=parameters(spec), sensors=dict(c.ranges.mid))
        values = {k: float(v) for k, v in form.values(theta, row).items()}
        found = steady(spec.flat(), {**c.scenario.operating_point, **values})
        acting = {k.partition(".")[0] for k in values}
        if form.parts:
            power = sum(found[f"{p.name}.P"][0] for p in form.parts)
            assert acting <= {p.name for p in form.parts}
        else:
            power = sum(found[f"{p}.P_loss"][0] - c.nominal[f"{p}.P_loss"][0] for p in acting)
        assert power == pytest.approx(theta["P_ref"], rel=0.05)
        assert found[c.roles.oil][0] >= c.nominal[c.roles.oil][0] - 1e-3


def test_which_causes_a_rig_has(case):
    helical = {x.id for x in case("helical_two_stage").causes}
    assert {"losses.churning", "losses.seal_drag", "cooling.air", "cooling.contact", "thermal.split"} <= helical
    assert not {"losses.mesh_direction", "cooling.thermostat", "sensor.oil_temp.by_direction"} & helical
    assert "losses.torque_only" not in helical  # no torque is compared
    assert {"losses.mesh_direction", "losses.torque_only", "sensor.torque.step"} <= {
        x.id for x in case("planetary").causes
    }
    assert {"cooling.thermostat", "cooling.cooler"} <= {x.id for x in case("fzg_four_square").causes}


def test_every_cause_says_what_it_is_and_what_exposes_it(case):
    c = case("planetary")
    names = {s.name for s in c.sensors}
    for x in c.causes:
        assert x.doc.endswith(".") and x.exposes and x.size.doc and 0 < x.common <= 1
        assert x.acts_on in {"", "rise", "order", "humidity", *names}
        assert not x.like or ": " in x.like  # the class and why
        assert all(shape.doc and shape.low < shape.high for f in x.forms for shape in f.shapes)


def test_where_nothing_varies_there_are_no_thresholds(case):
    c = case("helical_two_stage")
    one = replace(c.ranges, low=c.ranges.mid, high=c.ranges.mid)
    causes = library(c.roles, one, c.sensors)
    assert [p for x in causes for p in problems(x, c.scenario.spec, c.sensors, one)] == []
    limited = {x.id for x in causes for f in x.forms if f.regime and f.regime["quantity"] != "order above"}
    assert limited == set()


def test_a_low_oil_level_wets_less_and_stirs_less(case):
    """Beside a healthy campaign low oil shows by hot oil, not by the little that the wheels stir."""
    c = case("helical_two_stage")
    cause = c.cause("losses.oil_level")
    form = next(f for f in cause.forms if f.name == CONTACT)
    own = parameters(c.scenario.spec)
    base = own | {f"{p.name}.{key}": v for p in form.parts for key, v in p.values.items()}
    theta = {s.name: s.mean for s in form.shapes} | {cause.size_of(form).name: float(np.log(0.4)), "inside": 0.5}
    found = form.values(theta, Row(base=base, sensors={}))
    shares = {path: float(found[path] / own[path]) for path in c.roles.scaled(*c.roles.oil_side)}
    walls = {path: shares.pop(path) for path in c.roles.scaled(*c.roles.wetted)}
    assert list(walls.values()) == pytest.approx([0.4] * len(walls))
    assert list(shares.values()) == pytest.approx([0.4**0.5] * len(shares))
    (lost,) = (float(found[f"{part.name}.P_ref"]) for part in form.parts)
    assert lost == pytest.approx(-0.6 * theta["stir"] * c.ranges.loss)


def test_classes_that_count_as_one_answer(case):
    families = {}
    for x in case("planetary").causes:
        families.setdefault(x.family, set()).add(x.id)
    shared = {frozenset(ids) for ids in families.values() if len(ids) > 1}
    assert shared == {
        frozenset({"losses.churning", "losses.windage", "losses.oil_level"}),
        frozenset({"losses.bearing_preload", "losses.seal_drag", "losses.bearing_friction"}),
        frozenset({"cooling.humidity", "procedure.day_scatter"}),
    }


def test_what_is_not_known_of_the_rows_is_left_out(without):
    everything = without("planetary", "order", "dwell", "mounting", "humidity")
    for known, ids in {
        "humidity": ["cooling.humidity"],
        "dwell": ["procedure.not_stationary"],
        "mounting": ["sensor.torque.mounting"],
        "order": ["procedure.order", "sensor.torque.drift", "sensor.oil_temp.since"],
    }.items():
        others = {"order", "dwell", "mounting", "humidity"} - {known}
        assert set(ids) <= set(everything) and not set(ids) & set(without("planetary", *others))


def test_one_of_several_parts_is_a_form(case):
    names = {f.name for f in case("helical_two_stage").cause("losses.bearing_preload").forms}
    assert {"", "input_bearing_a, input_bearing_b", "middle_bearing_a, middle_bearing_b"} <= names
    assert {"above a speed", "below a speed", "above a temperature"} <= names


def test_sizes_follow_the_loss_and_the_cooling_of_the_rig(case):
    for rig in ("planetary", "harmonic"):
        c = case(rig)
        assert c.cause("losses.churning").size.sd == pytest.approx(0.085 * c.ranges.loss)
        assert c.cause("cooling.air").size.sd == pytest.approx(0.14 * c.ranges.loss / c.ranges.rise)


def test_thresholds_lie_in_the_range_of_the_data(case):
    c = case("planetary")
    for x in c.causes:
        for form in x.forms:
            for shape in form.shapes:
                if shape.name == "threshold" and x.id.startswith("losses") and form.regime["quantity"][:5] == "speed":
                    assert (shape.low, shape.high) == (c.ranges.low["w"], c.ranges.high["w"])


def test_early_readings_never_end_before_they_begin(case):
    c = case("planetary")
    for form in c.cause("procedure.not_stationary").forms:
        row = Row(base={}, sensors={}, second=np.array([0.0, 1.0]), dwell=np.array([14400.0, 1800.0]))
        early, most = (as_array(form.pace({"missing": size}, row), 2) for size in (0.2, 0.95))
        assert (most > 0).all() and (early <= 1 + 1e-12).all() and early.min() < 0.96
        if "minutes" in form.name and form.name == "by minutes":
            assert early[0] == pytest.approx(1 - 0.2 * 7200 / 14400, abs=0.01)


def test_capacity_is_moved_not_made(case):
    c = case("helical_two_stage")
    form = next(f for f in c.cause("thermal.split").forms if f.name == "capacity")
    base = parameters(c.scenario.spec)
    moved = form.values({"shift": 0.1}, Row(base=base, sensors={}))
    total = sum(base[path] for path in moved)
    assert sum(float(v) for v in moved.values()) == pytest.approx(total, rel=1e-9)
    inside = c.roles.scaled(*c.roles.inside)
    gained = sum(float(moved[p]) - base[p] for p in inside)
    assert gained == pytest.approx(0.1 * total, rel=1e-3)


def test_moved_heat_warms_what_it_reaches_and_loses_none(case):
    c = case("planetary")
    sensors = {s.name: c.ranges.mid[s.name] for s in c.sensors}
    forms = {f.name: f for f in c.cause("thermal.split").forms}
    for name, warmer in (
        ("heat of all losses, from the housing", "gears.T"),
        ("heat of all losses, from the oil", "gears.T"),
        ("heat of all losses, from the oil to the housing", "wall.T"),
    ):
        f = forms[name]
        flat = c.scenario.spec.with_parts(f.parts, f.connections, EXTRA_PARTS).flat()
        values = f.values({"shift": 0.2, "a": 0.0}, Row(base={}, sensors=sensors))
        found = steady(flat, {**c.scenario.operating_point, **{k: float(v) for k, v in values.items()}})
        assert found[warmer][0] - found["oil.T"][0] > c.nominal[warmer][0] - c.nominal["oil.T"][0] + 0.5, name
        assert found["room.Q_flow"][0] == pytest.approx(found["efficiency.P_loss"][0], rel=1e-6)


def test_a_loss_of_the_couplings_is_seen_by_torque_and_not_by_heat(case):
    c = case("planetary")
    f = c.cause("losses.torque_only").forms[0]
    flat = c.scenario.spec.with_parts(f.parts, f.connections, EXTRA_PARTS).flat()
    theta = {"P_ref": 50.0} | {s.name: float(s.at(0.0)) for s in f.shapes}
    values = {k: float(v) for k, v in f.values(theta, Row(base={}, sensors={})).items()}
    found = steady(flat, {**c.scenario.operating_point, **values})
    more = found["efficiency.P_loss"][0] - c.nominal["efficiency.P_loss"][0]
    assert more == pytest.approx(50.0, rel=0.1)
    assert found["oil.T"][0] == pytest.approx(c.nominal["oil.T"][0], abs=0.5)


def test_a_thermostat_keeps_another_temperature(case):
    c = case("fzg_four_square")
    x = c.cause("cooling.thermostat")
    values = x.forms[0].values({"dT": 5.0}, Row(base={"thermostat.dT": 0.0}, sensors={}))
    found = steady(c.scenario.spec.flat(), {**c.scenario.operating_point, **values})
    assert found["oil.T"][0] - c.nominal["oil.T"][0] == pytest.approx(5.0, abs=1.0)


def test_a_cooler_that_is_stuck_part_open_takes_more_while_closed(case):
    c = case("wind_turbine")
    form = next(f for f in c.cause("cooling.thermostat").forms if "stuck" in f.name)
    base = parameters(c.scenario.spec)
    values = {k: float(v) for k, v in form.values({"dT": -0.5 * c.ranges.rise}, Row(base=base, sensors={})).items()}
    assert values["cooler.G_closed"] > base["cooler.G_closed"] + 0.3 * base["cooler.G_open"]
    both = values["cooler.G_closed"] + values["cooler.G_open"]
    assert both == pytest.approx(base["cooler.G_closed"] + base["cooler.G_open"], rel=0.05)
