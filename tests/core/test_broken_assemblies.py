"""Slips in a gearbox of real parts: each message names the port or equation, the part, and what to do."""

from collections.abc import Iterator

import pytest
from broken_assemblies import BROKEN, NETS, Brake, gearbox, without
from gearheat.model.core.component import Component, Equation, equation
from gearheat.model.core.connect import Assembly
from gearheat.model.core.declare import Parameter, Variable
from gearheat.model.core.flatten import flatten
from gearheat.model.errors import StructureError
from gearheat.model.parts import PARTS
from gearheat.model.parts.ports import HeatPort

#: What the message of each slip has to say.
SAYS: dict[str, tuple[str, ...]] = {
    "open_heat_port": ("bearing_a.inner is connected to nothing", "no way out", "Connect it to the heat port"),
    "open_load": ("bearing_a.load is connected to nothing", "load it carries", "Connect it to the load"),
    "no_lubricant": (
        "gear.lubricant is connected to nothing",
        "there is no lubricant",
        "Connect it to",
        "OilBath or a Grease",
    ),
    "part_without_connection": (
        "hall (Room) is connected to nothing",
        "Connect hall.air or hall.floor",
        "take hall out",
    ),
    "nothing_given": (
        "Nothing determines motor.flange.w, gear.wheel.w.",
        "Give motor.w or motor.tau",
        "connect a source",
    ),
    "no_room": ("nothing gives seal.inner, seal.outer a temperature", "Connect a storage", "Room"),
    "two_speeds": ("motor.w and fan.w are given", "motor.flange, fan.flange", "Do not give motor.w or fan.w"),
    "speed_and_torques": (
        "motor.w, motor.tau and fan.tau are given",
        "motor.flange, fan.flange",
        "Do not give motor.w",
    ),
    "two_rooms": (
        "room.T and hall.T are given",
        "room.floor, hall.floor",
        "Take room or hall away",
        "ThermalConductor",
    ),
    "inertia_at_given_speed": ("rotor.w is a state", "motor.w, which is given", "rotor.flange", "leave rotor out"),
    "capacity_in_the_room": (
        "wall.T is a state",
        "room.T, which is given",
        "wall.heat",
        "put a ThermalConductor between",
    ),
    "held_shaft": ("motor.w is given", "mount: held", "motor.flange, mount.flange", "Do not give motor.w"),
    "no_bearing_locates": (
        "support has bearing a carry axial force",
        "bearing_a (CylindricalRollerBearing) holds no shaft along its axis",
        "Let bearing b locate (axial_share_a = 0)",
    ),
    "one_tapered_bearing": (
        "bearing_a (TaperedRollerBearing) pushes the shaft along",
        'Give support arrangement = "face-to-face" or "back-to-back"',
    ),
    "thrust_bearing_under_a_gear": (
        "support has bearing a carry radial force, and bearing_a (ThrustBallBearing) carries none",
        "Connect a radial bearing to support.load_a",
    ),
    "thrusts_that_point_the_same_way": (
        "support.load_a loads bearing_a (TaperedRollerBearing), and support.thrust_a is that of bearing_b",
        "Connect both ports to one bearing",
    ),
    "loop_of_gears": ("rotor.w is a state", "second: gears roll", "gear.wheel, second.wheel", "its ratios have to fit"),
    "parallel_gears": (
        "two equations say the same",
        "gear.wheel, second.wheel",
        "Take gear or second away, or put a LoadingClutch",
    ),
    "shared_port": (
        "bearing_a.inner is named in two connections",
        "oil and one with wall",
        "Name bearing_a.inner in one",
    ),
    "starts_apart": ("cover.T starts at 300 K", "wall.T = 320: that is 320 K", "Give one of these starts only"),
    "doubled_name": ('two parts are called "wall"', "Rename one"),
    "wrong_kinds": ("gear.wheel is a Flange and room.floor is a HeatPort", "Connect ports of one kind"),
    "one_port": ("connect [room.air] names one port only", "Name at least two"),
    "unknown_port": ('"gear.forces", and there is no such port', 'Did you mean "gear.force"'),
    "no_equations": ("brake: Empty has no equations", "Write a method equations()"),
    "decides_on_a_symbol": ('brake: after equation "becomes heat"', "value of a symbol", "smooth functions", "if_else"),
    "undeclared_name": ('brake: after equation "becomes heat"', '"tau_mx" is not declared', 'Did you mean "tau_max"'),
    "wrong_shape": ('brake: after equation "becomes heat"', "neither a number nor a symbol", "Yield one equation for"),
    "wrong_sizes": ('brake: after equation "becomes heat"', "Dimension mismatch", "Correct what follows"),
    "column_for_a_number": ('brake: a side of equation "brakes" has the shape 2 x 1', "yield an equation for every"),
    "strange_symbol": ("brake: brakes:", 'the symbol "mood" is not declared', "Declare it"),
    "function_of_numbers": ("brake: brakes:", "not a number", "casadi.sqrt, not math.sqrt"),
}


def message(assembly: Assembly) -> str:
    with pytest.raises(StructureError) as caught:
        flatten(assembly)
    assert len(caught.value.problems) == 1, caught.value
    return str(caught.value)


def test_the_sound_gearbox_flattens() -> None:
    assert [q.name for q in flatten(gearbox()).states] == ["oil.T", "wall.T"]


@pytest.mark.parametrize("make", BROKEN, ids=lambda make: make.__name__)
def test_the_message_names_place_and_remedy(make) -> None:
    text = message(make())
    for words in SAYS[make.__name__]:
        assert words in text
    assert text.count("\n") < 3
    assert "Traceback" not in text and "casadi/core" not in text


def test_a_fault_far_from_a_large_sound_rest_is_told_alone() -> None:
    """The set at fault does not grow with what hangs on it."""
    text = message(gearbox({"hall": ("Room", {})}, {"floor": ("foot.b", "room.floor", "hall.floor")}))
    assert "more" not in text
    assert "gear" not in text.removeprefix("gearbox")


def test_an_error_in_the_energies_of_a_part() -> None:
    class Leaky(Brake):
        def stored_energy(self):
            return self.J * self.shaft.w**2 / 2

    nets = {"wheel": (*NETS["wheel"], "brake.shaft"), "inside": (*NETS["inside"], "brake.heat")}
    text = message(gearbox({"brake": Leaky}, nets))
    assert 'brake: supplied_power or stored_energy of Leaky: "J" is not declared' in text


def test_how_many_values_are_missing() -> None:
    text = message(gearbox({"motor": ("ShaftEnd", {}), "fan": ("ShaftEnd", {})}))
    assert "Nothing determines motor.flange.w, gear.wheel.w." in text
    assert "Give 2 of motor.w, motor.tau, fan.w or fan.tau, or connect a source or a storage." in text


def test_readers_without_a_giver_are_told_together() -> None:
    text = message(gearbox(nets={"lubricant": ("gear.lubricant", "bearing_a.lubricant", "bearing_b.lubricant")}))
    assert "gear.lubricant, bearing_a.lubricant, bearing_b.lubricant meet readers only: there is no lubricant." in text
    assert "Connect them to the lubricant of an OilBath or a Grease." in text


def test_an_information_given_twice_names_its_ports() -> None:
    text = message(
        gearbox(
            nets={
                "load_a": ("support.load_a", "support.load_b", "bearing_a.load"),
                "load_b": ("bearing_b.load", "support.load_b"),
            }
        )
    )
    assert "support: bearing a axially, support: bearing b axially" in text
    assert "Connect support.load_a or support.load_b elsewhere." in text


@pytest.mark.parametrize("port", ["bearing_a.shaft", "motor.flange"])
def test_a_brake_or_a_shaft_end_needs_a_shaft(port: str) -> None:
    """Without a shaft a bearing would stand still, and a given speed would turn nothing."""
    read = {"reading": ("motor.reading", "efficiency.a", "efficiency.b")}  # the motor alone would be told as a part
    text = message(gearbox({"efficiency": ("Efficiency", {})}, without("pinion", port) | read))
    assert f"{port} is connected to nothing: no shaft is there. Connect it to the flange of" in text


def test_ports_that_may_stay_open() -> None:
    """Air of a room, force and wheel of a gear: nothing flows there, or nobody reads it."""
    flat = flatten(gearbox(nets={"force": ("gear.force", "support.mesh"), "wheel": ("fan.flange", "gear.wheel")}))
    assert flat.index["room.Q_flow"][0] == "output"
    idle = [part for part in gearbox().parts if part.name != "fan"]
    connections = tuple(c for c in gearbox().connections if "fan.flange" not in c)
    assert flatten(Assembly("idle", "", tuple(idle), connections)).index["gear.P_loss"][0] == "output"


def test_a_temperature_held_by_a_controller_is_a_level() -> None:
    """What gives a temperature need not be a storage or a room: only what gives none is refused."""

    class Thermostat(Component):
        heat = HeatPort()

        T = Variable("K", "temperature kept", nominal=300.0)
        dT = Parameter("K (difference)", "above 300 K", default=20.0)

        def equations(self) -> Iterator[Equation]:
            yield equation("temperature wanted", self.T, 300.0 + self.dT)
            yield equation("kept", self.heat.T - self.T, 0.0)

    parts = (Thermostat("bath"), *(PARTS["ThermalConductor"](name, G=2.0) for name in ("film", "pin")))
    flat = flatten(Assembly("rod", "", parts, (("bath.heat", "film.a"), ("film.b", "pin.a", "pin.b"))))
    assert [q.name for q in flat.outputs] == ["film.Q_flow", "pin.Q_flow"]
