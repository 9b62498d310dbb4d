"""What a housing stands in: radiation to walls that are not as warm as the air, sun, thin air, a fan."""

import pytest
from gearheat.model.core.connect import Assembly
from gearheat.model.core.flatten import flatten
from gearheat.model.laws.convection import air_pressure
from gearheat.model.laws.radiation import SIGMA
from gearheat.model.parts import PARTS
from gearheat.model.run.rows import evaluate_at

FAN = dict(k_v=0.02, k=1e-5)
BOX = dict(A=0.5, emissivity=0.9, height=0.3, length=0.4, width=0.2, share_top=0.2, share_bottom=0.2)


def outputs(fan: bool = False, **given: float) -> dict[str, float]:
    """A box at 330 K in a room at 300 K: its outputs and those of the room, at given inputs and room parameters."""
    room = {k: given.pop(k) for k in ("dT_radiant", "altitude") if k in given}
    parts = [PARTS["HeatCapacity"]("body", C=1e4), PARTS["BoxCooling"]("box", **BOX), PARTS["Room"]("room", **room)]
    nets = [("body.heat", "box.surface")]
    if fan:
        parts += [PARTS["ShaftEnd"]("shaft", given=("w",)), PARTS["ShaftFan"]("fan", **FAN)]
        nets += [("shaft.flange", "fan.shaft"), ("room.air", "fan.room"), ("fan.air", "box.air")]
    else:
        nets += [("room.air", "box.air")]
    flat = flatten(Assembly("box", "", tuple(parts), tuple(nets)))
    known = {"room.T": 300.0} | given
    found = evaluate_at(flat, [330.0], [known.get(q.name, 0.0) for q in flat.inputs], flat.starts("parameter"))
    return dict(zip([q.name for q in flat.outputs], found["y"].tolist(), strict=True))


@pytest.mark.parametrize("dT", [-40.0, 0.0, 25.0])
def test_a_surface_radiates_to_what_stands_around_it(dT: float) -> None:
    plain, found = outputs(), outputs(dT_radiant=dT)
    assert found["box.Q_flow_convection"] == plain["box.Q_flow_convection"]
    radiated = SIGMA * 0.9 * 0.5 * (330.0**4 - (300.0 + dT) ** 4)
    assert found["box.Q_flow_radiation"] == pytest.approx(radiated, rel=1e-12)


@pytest.mark.parametrize(("absorptivity", "emissivity", "T"), [(0.12, 0.9, 312.462), (0.96, 0.95, 377.746)])
def test_a_plate_in_the_sun_rests_where_it_radiates_what_it_absorbs(absorptivity, emissivity, T) -> None:
    """White paint and black lacquer at 700 W/m2 in a room of 298 K."""
    parts = [PARTS["HeatCapacity"]("body", C=1e4), PARTS["BoxCooling"]("box", **BOX | {"emissivity": emissivity})]
    parts += [PARTS["Sun"]("sun", A=0.5, absorptivity=absorptivity), PARTS["Room"]("room")]
    flat = flatten(
        Assembly("plate", "", tuple(parts), (("body.heat", "box.surface", "sun.surface"), ("room.air", "box.air")))
    )
    known = {"room.T": 298.0, "sun.G": 700.0}
    found = evaluate_at(flat, [T], [known.get(q.name, 0.0) for q in flat.inputs], flat.starts("parameter"))
    values = dict(zip([q.name for q in flat.outputs], found["y"].tolist(), strict=True))
    assert values["sun.Q_flow"] == pytest.approx(700.0 * 0.5 * absorptivity)
    assert values["box.Q_flow_radiation"] == pytest.approx(values["sun.Q_flow"], rel=1e-4)
    assert float(found["ode"][0]) == pytest.approx(-values["box.Q_flow_convection"] / 1e4, rel=1e-3)


def test_thin_air_cools_less() -> None:
    """Powers of the density: free convection 1/2 to 2/3, forced 1/2 (laminar) to 4/5 (turbulent)."""
    thinner = air_pressure(3000.0) / air_pressure(0.0)
    for speed, most in ((0.0, 2 / 3), (20.0, 4 / 5)):
        sea, high = (outputs(**{"altitude": h, "room.air_speed": speed})["box.h"] for h in (0.0, 3000.0))
        assert thinner**most < high / sea < thinner**0.45
    assert outputs(altitude=0.0) == outputs()


@pytest.mark.parametrize("w", [-150.0, 150.0])
def test_a_fan_moves_the_air_as_a_draught_does(w: float) -> None:
    found, draught = outputs(fan=True, **{"shaft.w": w}), outputs(**{"room.air_speed": 3.0})
    assert found["fan.v"] == pytest.approx(3.0, rel=1e-5)
    assert found["box.h"] == pytest.approx(draught["box.h"], rel=1e-5)
    assert found["fan.P_loss"] == pytest.approx(1e-5 * 150.0**3, rel=1e-6)
    leaves = found["box.Q_flow_convection"] + found["box.Q_flow_radiation"] + found["fan.P_loss"]
    assert found["room.Q_flow"] == pytest.approx(leaves, rel=1e-9)


def test_a_fan_at_rest_leaves_the_draught_of_the_room() -> None:
    assert outputs(fan=True, **{"room.air_speed": 1.0})["fan.v"] == pytest.approx(1.0, rel=1e-4)
