"""What wrong instruments show, and what drove the machine when they were wrong."""

import numpy as np
import pytest
from gearheat.scenarios.measured.card import Card, CardSensor, Channel
from gearheat.scenarios.measured.sensors import sensors_of
from gearheat.tools.diagnose.library.cause import Row, as_array
from gearheat.tools.diagnose.library.forms import Context
from gearheat.tools.diagnose.library.knobs import knobs, moves
from gearheat.tools.diagnose.library.sensors import BODY, causes

ORDER = np.array([0.0, 0.0, 0.5, 0.5, 1.0, 1.0])
DIRECTION = np.array([1.0, -1.0] * 3)


@pytest.fixture(scope="module")
def planetary(case):
    return case("planetary")


def row(c, **readings):
    shows = {s.name: np.full(6, c.ranges.mid[s.name]) for s in c.sensors} | readings
    rise = np.array([20.0, 20.0, 30.0, 30.0, 40.0, 40.0])
    return Row(base={}, sensors=shows, order=ORDER, direction=DIRECTION, rise=rise)


def form_of(cause, *words):
    return next(f for f in cause.forms if all(w in f.name.split(", ") for w in words))


def shown(c, cause, form, size, **shapes):
    """What the sensors show beyond the true values."""
    here = row(c)
    true = {s.name: here.sensors[s.name] for s in c.sensors if s.role == "read"}
    theta = {cause.size.name: size} | shapes
    found = form.shown(theta, here, true)
    return {name: as_array(value, 6) - true[name] for name, value in found.items()}


def truth(c, cause, form, size, **shapes):
    """What truly was, less what was shown."""
    here = row(c)
    found = form.truth({cause.size.name: size} | shapes, here)
    return {name: as_array(value, 6) - here.sensors[name] for name, value in found.items()}


def test_a_probe_that_is_compared_shows_too_much(planetary):
    cause = planetary.cause("sensor.wall_temp.offset")
    assert shown(planetary, cause, cause.forms[0], 2.0) == {"T_wall": pytest.approx(np.full(6, 2.0))}


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_error_above_a_load_follows_its_magnitude_whatever_sign_the_column_has(case, sign):
    c = case("helical_two_stage")
    cause = c.cause("sensor.oil_temp.offset")
    mid, loads = c.ranges.mid["T_output"], np.array([0.65, 0.7, 0.8, 1.2, 1.3, 1.35])
    here = row(c, T_output=sign * loads * mid)
    theta = {cause.size.name: 2.0, "threshold": mid, "width": 1.0}
    for words, moved in (("above a load", loads > 1), ("below a load", loads < 1)):
        found = form_of(cause, words).shown(theta, here, here.sensors)["T_oil"]
        assert as_array(found, 6) - here.sensors["T_oil"] == pytest.approx(2.0 * moved, abs=1e-2)


def test_where_a_room_probe_reads_too_much_the_room_was_colder(planetary):
    cause = planetary.cause("sensor.ambient.bias")
    assert truth(planetary, cause, cause.forms[0], 2.0) == {"T_amb": pytest.approx(np.full(6, -2.0))}


def test_the_zero_of_a_transducer_is_the_same_on_magnitudes_of_both_directions(planetary):
    cause = planetary.cause("sensor.torque.offset")
    assert truth(planetary, cause, form_of(cause, "T_carrier"), 4.0)["T_carrier"] == pytest.approx(np.full(6, -4.0))
    wrong = shown(planetary, cause, form_of(cause, "T_sun"), 4.0)["T_sun"]
    share = planetary.ranges.mid["T_sun"] / planetary.ranges.mid["T_carrier"]
    assert wrong == pytest.approx(np.full(6, 4.0 * share))
    assert form_of(cause, "T_sun").scale == pytest.approx(share) and form_of(cause, "T_carrier").scale == 1.0


def test_a_zero_that_moves_may_belong_to_the_signed_value(planetary):
    cause = planetary.cause("sensor.torque.drift")
    at = {"power": 1.0, "zero": 0.0}
    wrong = truth(planetary, cause, form_of(cause, "T_carrier"), 4.0, **at)["T_carrier"]
    assert wrong == pytest.approx(-4.0 * ORDER, abs=1e-6)
    signed = truth(planetary, cause, form_of(cause, "T_carrier", "opposite signs"), 4.0, **at)["T_carrier"]
    assert signed == pytest.approx(-4.0 * ORDER * DIRECTION, abs=1e-6)


def test_a_gain_is_a_share_of_the_magnitude_in_both_directions(planetary):
    cause = planetary.cause("sensor.torque.gain")
    wrong = shown(planetary, cause, form_of(cause, "T_sun"), 0.01)["T_sun"]
    assert wrong == pytest.approx(np.full(6, 0.01 * planetary.ranges.mid["T_sun"]))
    assert cause.size.high > 0.12, "a wrong sensitivity or lever is no rare error"


def test_from_one_test_on_and_in_one_direction_only(planetary):
    cause = planetary.cause("sensor.wall_temp.since")
    at = {"threshold": 0.25, "zero": 0.0}
    wrong = shown(planetary, cause, cause.forms[0], 2.0, **at)["T_wall"]
    assert wrong == pytest.approx([0, 0, 2, 2, 2, 2], abs=1e-6)
    directed = shown(planetary, cause, form_of(cause, "driven only"), 2.0, **at)["T_wall"]
    assert directed == pytest.approx([0, 0, 0, 2, 0, 2], abs=1e-6)


def test_a_probe_that_drifts(planetary):
    cause = planetary.cause("sensor.wall_temp.drift")
    wrong = shown(planetary, cause, cause.forms[0], 2.0, power=1.0, zero=0.0)["T_wall"]
    assert wrong == pytest.approx(2.0 * ORDER, abs=1e-6)


def test_a_probe_by_direction(planetary):
    cause = planetary.cause("sensor.oil_temp.by_direction")
    wrong = shown(planetary, cause, form_of(cause, "T_oil", "driving only"), 2.0)["T_oil"]
    assert wrong == pytest.approx([2, 0] * 3)


def test_above_a_temperature_of_what_a_probe_measures(planetary):
    cause = planetary.cause("sensor.wall_temp.offset")
    here = row(planetary)
    true = {"T_wall": np.array([300.0, 310.0, 320.0, 340.0, 350.0, 360.0])}
    found = form_of(cause, "above a temperature").shown({"error": 2.0, "threshold": 330.0, "width": 1.0}, here, true)
    assert as_array(found["T_wall"], 6) - true["T_wall"] == pytest.approx([0.0, 0.0, 0.0, 2.0, 2.0, 2.0], abs=1e-3)


def test_on_one_side_of_a_speed(planetary):
    c = planetary
    cause = c.cause("sensor.wall_temp.offset")
    form = form_of(cause, "above a speed")
    low, high = c.ranges.low["n_carrier"], c.ranges.high["n_carrier"]
    here = row(c, n_carrier=np.array([low, high] * 3))
    true = {s.name: here.sensors[s.name] for s in c.sensors if s.role == "read"}
    found = form.shown({"error": 2.0, "threshold": (low + high) / 2, "width": 1.0}, here, true)
    assert as_array(found["T_wall"], 6) - true["T_wall"] == pytest.approx([0, 2] * 3, abs=1e-6)


def test_exchanged_probes_show_each_others_temperature(planetary):
    c = planetary
    cause = c.cause("sensor.oil_temp.swapped")
    here = row(c)
    true = {"T_oil": np.full(6, 350.0), "T_wall": np.full(6, 330.0)}
    found = form_of(cause, "T_oil with T_wall").shown({"share": 1.0}, here, true)
    assert as_array(found["T_oil"], 6) == pytest.approx(true["T_wall"])
    assert as_array(found["T_wall"], 6) == pytest.approx(true["T_oil"])


def test_a_frozen_probe_shows_the_same_from_one_test_on(planetary):
    cause = planetary.cause("sensor.wall_temp.frozen")
    wrong = shown(planetary, cause, cause.forms[0], 1.0, threshold=0.75, held=333.0)["T_wall"]
    assert wrong[:4] == pytest.approx(np.zeros(4), abs=1e-6)
    assert wrong[4:] + planetary.ranges.mid["T_wall"] == pytest.approx(np.full(2, 333.0))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_torque_that_hangs_keeps_its_sign(case, without, sign):
    c, cause = case("drum_motor"), without("drum_motor", "order", "still: T_drum")["sensor.torque.frozen"]
    here = row(c, T_drum=np.full(6, sign * c.ranges.mid["T_drum"]))
    theta = {cause.size.name: 1.0, "threshold": 0.75, "held": 0.9 * c.ranges.mid["T_drum"]}
    shares = as_array(cause.forms[0].shown(theta, here, here.sensors)["T_drum"], 6) / here.sensors["T_drum"]
    assert shares == pytest.approx([1.0] * 4 + [0.9] * 2, abs=1e-6)


def test_a_probe_drawn_to_the_room_loses_a_share_of_its_excess(planetary):
    c = planetary
    cause = c.cause("sensor.oil_temp.position")
    wrong = shown(c, cause, form_of(cause, "T_oil"), 0.1, a=0.0, body=0.0)["T_oil"]
    assert wrong == pytest.approx(np.full(6, -0.1 * (c.ranges.mid["T_oil"] - c.ranges.mid["T_amb"])))
    beside = shown(c, cause, form_of(cause, "T_oil"), 0.1, a=0.0, body=1.0)["T_oil"]
    assert beside == pytest.approx(np.full(6, -0.1 * BODY * (c.ranges.mid["T_oil"] - c.ranges.mid["T_wall"])))


def test_a_room_probe_in_the_warm_air_reads_the_more_too_high_the_warmer_the_machine(planetary):
    c = planetary
    cause = c.cause("sensor.ambient.heated")
    wrong = -truth(c, cause, cause.forms[0], 2.0, e=1.0)["T_amb"]
    assert wrong == pytest.approx(2.0 * row(c).rise / c.ranges.rise, rel=1e-2)


def test_spreads_are_told(planetary):
    assert {f.spread for f in planetary.cause("sensor.torque.random_walk").forms} == {"walk", "test"}
    assert {f.spread for f in planetary.cause("sensor.torque.mounting").forms} == {"mounting"}
    assert {f.spread for f in planetary.cause("procedure.day_scatter").forms} == {"test"}


def test_every_kind_of_instrument_has_the_same_errors(planetary):
    ids = {x.id for x in planetary.causes}
    for kind in ("oil_temp", "wall_temp", "ambient", "torque", "speed"):
        offset = "bias" if kind == "ambient" else "offset"
        since = "step" if kind == "torque" else "since"
        for key in (offset, since, "gain", "drift", "by_direction", "mounting", "random_walk"):
            assert f"sensor.{kind}.{key}" in ids


def test_what_is_drawn_anew_with_each_mounting_may_follow_direction_or_speed(planetary):
    c = planetary
    probe = c.cause("sensor.oil_temp.mounting")
    form = form_of(probe, "T_oil", "by direction", "anew with each mounting")
    assert form.spread == "mounting" and shown(c, probe, form, 2.0)["T_oil"] == pytest.approx(2.0 * DIRECTION)
    churning = c.cause("losses.churning")
    form, low, mid, high = (
        form_of(churning, "by speed"),
        *(by["n_carrier"] for by in (c.ranges.low, c.ranges.mid, c.ranges.high)),
    )
    assert form.spread == "mounting" and sum(f.weight for f in churning.forms) == pytest.approx(1.0)
    theta = {s.name: s.mean or (s.low + s.high) / 2 for s in form.shapes} | {churning.size.name: 3.0}
    here = row(c, n_carrier=np.array([low, mid, high] * 2))
    powers = [as_array(v, 6) for path, v in form.values(theta, here).items() if path.endswith("P_ref")]
    assert sum(powers) == pytest.approx(3.0 * np.array([low - mid, 0.0, high - mid] * 2) / ((high - low) / 2), abs=0.1)


def test_an_instrument_that_was_checked_is_right_but_may_be_in_the_wrong_place(planetary):
    card = Card(channels={name: Channel(checked=True) for name in ("T_oil", "T_oil2", "T_amb", "T_sun")})
    sensors = sensors_of(planetary.scenario, card)
    assert {s.name for s in sensors if s.checked} == {"T_amb", "T_sun", "T_oil", "T_oil2"}
    at = Context(planetary.roles, planetary.ranges, sensors)
    kinds = {cause.id.split(".")[1] for cause in causes(at)}
    assert kinds == {"speed", "torque", "wall_temp", "oil_temp"}
    assert [cause.id for cause in causes(at) if ".oil_temp." in cause.id] == ["sensor.oil_temp.position"]
    torque = next(cause for cause in causes(at) if cause.id == "sensor.torque.gain")
    assert [form.name for form in torque.forms] == [""], "of two transducers one is left"
    differ = {knob.sensor: knob.cause for knob in knobs(planetary.roles, sensors, 100.0) if knob.sensor}
    assert not differ["T_oil"] and not differ["T_amb"] and differ["T_wall"] == "sensor.wall_temp.offset"


def test_a_loss_of_logs_may_have_changed_in_one_part_or_in_all(planetary):
    found = {cause.id: cause for cause in moves(knobs(planetary.roles, planetary.sensors, 100.0))}
    forms = {form.name: form for form in found["losses.bearing_preload"].forms}
    here = Row({}, {}, 1.0)
    together = forms["all of them"].values({"ln_factor": 0.5}, here)
    assert len(together) > 1 and set(together.values()) == {0.5}
    assert sum(form.weight for form in forms.values()) == pytest.approx(1.0)
    single = [name for name in forms if name.endswith(": loss")]
    assert {next(iter(forms[name].values({"ln_factor": 0.5}, here))) for name in single} == together.keys()
    assert not any("all of them" in form.name for form in found["sensor.oil_temp.offset"].forms)


def test_a_heat_a_flow_and_the_air_have_instruments_of_their_own(planetary):
    card = Card(sensors={"Q": CardSensor(reads="room.Q_flow"), "v": CardSensor(reads="room.air_speed")})
    sensors = [s for s in sensors_of(planetary.scenario, card) if s.name in ("Q", "v")]
    assert {s.name: (s.kind, s.role) for s in sensors} == {"Q": ("heat", "read"), "v": ("air_speed", "given")}
    found = {cause.id: cause for cause in causes(Context(planetary.roles, planetary.ranges, sensors))}
    assert found["sensor.heat.gain"].size.high >= 0.5 and "sensor.air_speed.gain" in found
    in_logs = {cause.id for cause in moves(knobs(planetary.roles, sensors, 100.0))}
    assert in_logs >= {"sensor.heat.gain", "sensor.air_speed.gain"}
