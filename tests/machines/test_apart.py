"""A machine cut into pieces: what they pass to each other, and which cuts are refused."""

import pytest
from gearheat.model.errors import ScenarioError
from gearheat.model.machines.apart import REST, Joint, Pieces, cut_machine
from gearheat.model.machines.spec import PartSpec, Spec

PARTS = (
    PartSpec("oil", "HeatCapacity", {"C": 5e3}),
    PartSpec("wall", "HeatCapacity", {"C": 2e4}),
    PartSpec("film", "ThermalConductor", {"G": 50.0}),
    PartSpec("shell", "CylinderCooling", {"A": 0.5, "emissivity": 0.9, "D": 0.3, "share_ends": 0.3}),
    PartSpec("foot", "ThermalConductor", {"G": 4.0}),
    PartSpec("cooler", "ThermalConductor", {"G": 8.0}),
    PartSpec("fins", "ThermalConductor", {"G": 3.0}),
    PartSpec("room", "ClosedRoom", {"C": 2e5, "altitude": 500.0}),
    PartSpec("walls", "ThermalConductor", {"G": 60.0}),
    PartSpec("outdoors", "PrescribedTemperature"),
)
NETS = (
    ("oil.heat", "film.a", "cooler.a"),
    ("wall.heat", "film.b", "shell.surface", "foot.a", "fins.a"),
    ("room.air", "shell.air"),
    ("room.floor", "foot.b", "cooler.b", "fins.b", "walls.a"),
    ("walls.b", "outdoors.heat"),
)
BLOCK = Spec("block", "a warm block in a room", PARTS, NETS)
ROOM = ("room", "walls", "outdoors")


def inputs(pieces: Pieces, name: str) -> set[str]:
    return {q.name for q in pieces.specs[name].flat().inputs}


def test_pieces_pass_temperatures_and_heat() -> None:
    pieces = cut_machine(BLOCK, {"cooler": ("cooler",), "room": ROOM})
    assert list(pieces.specs) == [REST, "cooler", "room"]
    assert set(pieces.joints) == {
        Joint(REST, "oil.T", "cooler", "oil.T"),
        Joint("cooler", "oil.Q_flow", REST, "cooler.Q_flow"),
        Joint("room", "room.T", REST, "room.T"),
        Joint(REST, "room.Q_flow", "room", f"{REST}.Q_flow"),
        Joint("room", "room.T", "cooler", "room.T"),
        Joint("cooler", "room.Q_flow", "room", "cooler.Q_flow"),
    }
    assert pieces.shared == {}
    assert inputs(pieces, "cooler") == {"oil.T", "room.T"}
    assert inputs(pieces, REST) >= {"cooler.Q_flow", "room.T", "room.air_speed"}
    room = pieces.specs[REST].part("room")
    assert (room.type, room.values) == ("Room", {"altitude": 500.0})


def test_two_bodies_of_one_piece_are_told_apart() -> None:
    pieces = cut_machine(BLOCK, {"cooler": ("cooler", "fins"), "room": ROOM})
    assert {"cooler_oil.Q_flow", "cooler_wall.Q_flow"} <= inputs(pieces, REST)
    assert "cooler.Q_flow" in inputs(pieces, "room")


def test_a_given_temperature_is_given_to_each() -> None:
    pieces = cut_machine(BLOCK, {"world": ("outdoors",), "room": ("room", "walls")})
    assert pieces.shared == {"outdoors.T": ("world", "room")}
    assert "outdoors.T" in inputs(pieces, "room")


@pytest.mark.parametrize(
    ("groups", "says"),
    [
        ({"cooler": ("coler",)}, r'no part "coler"\. Did you mean "cooler"'),
        ({"a": ("cooler",), "b": ("cooler",)}, "cooler is in a and in b"),
        ({"a b": ("cooler",)}, "one word"),
        ({REST: ("cooler",)}, "holds all parts that are named nowhere"),
        ({"all": tuple(p.name for p in PARTS)}, f"no part is left for {REST}"),
    ],
)
def test_groups_that_do_not_work(groups: dict[str, tuple[str, ...]], says: str) -> None:
    with pytest.raises(ScenarioError, match=says):
        cut_machine(BLOCK, groups)


def test_only_heat_is_cut_and_only_at_bodies() -> None:
    through = BLOCK.with_parts([PartSpec("sleeve", "ThermalConductor", {"G": 5.0})], [("walls.b", "sleeve.b")])
    bare = Spec("bare", "", through.parts, (*NETS[:4], ("walls.b", "sleeve.a"), ("sleeve.b", "outdoors.heat")))
    with pytest.raises(ScenarioError, match="no part of it is a body"):
        cut_machine(bare, {"out": ("sleeve", "outdoors")})
    shaft = [PartSpec("motor", "ShaftEnd", {"given": ("w",)}), PartSpec("fan", "FanLoad", {"k": 0.1})]
    with pytest.raises(ScenarioError, match=r"it is a Flange\. Only nets of heat ports are cut"):
        cut_machine(BLOCK.with_parts(shaft, [("motor.flange", "fan.flange")]), {"fan": ("fan",)})
