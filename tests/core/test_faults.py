"""Each structural fault is refused by name: what is undetermined, what is said twice, what does not fit."""

from collections.abc import Iterator

import pytest
from gearheat.model.core.component import Component, Equation, equation
from gearheat.model.core.declare import Choice, Input, Output, Parameter
from gearheat.model.errors import ScenarioError, StructureError
from small_parts import (
    Ambient,
    Body,
    Conductor,
    Flywheel,
    Friction,
    Ground,
    Heat,
    Pin,
    Resistor,
    Shaft,
    Speed,
    Torque,
    model,
    rc,
)


def fault(*parts: Component, nets: list[tuple[str, ...]]) -> str:
    with pytest.raises(StructureError) as caught:
        model(*parts, nets=nets)
    return str(caught.value)


def test_a_speed_that_nothing_determines() -> None:
    text = fault(Torque("drive"), Torque("load"), nets=[("drive.shaft", "load.shaft")])
    assert "drive.shaft.w" in text
    assert "Nothing determines" in text


def test_two_speeds_on_one_shaft() -> None:
    text = fault(Speed("one"), Speed("other"), nets=[("one.shaft", "other.shaft")])
    assert "Too much is said" in text
    assert "one: speed held" in text
    assert "other: speed held" in text


def test_two_temperatures_at_one_place_beside_a_sound_net() -> None:
    parts = (Ambient("a"), Ambient("b"), Body("oil", C=1.0), Conductor("g", G=1.0), Ambient("room"))
    text = fault(*parts, nets=[("a.heat", "b.heat"), ("oil.heat", "g.a"), ("g.b", "room.heat")])
    assert "a: temperature held" in text
    assert "b: temperature held" in text
    assert "room" not in text
    assert "oil" not in text


def test_a_circuit_without_ground() -> None:
    text = fault(Resistor("r", R=1.0), Resistor("s", R=1.0), nets=[("r.a", "s.a"), ("r.b", "s.b")])
    assert "say the same twice" in text
    assert "r." in text or "s." in text


def test_all_wrong_connections_at_once() -> None:
    parts = (Body("oil", C=1.0), Ground("ground"), Body("oil", C=2.0), Conductor("g", G=1.0))
    text = fault(*parts, nets=[("oil.heat", "ground.pin"), ("oil.haet", "g.a"), ("g.b",)])
    assert 'two parts are called "oil"' in text
    assert "different kinds: oil.heat is a Heat and ground.pin is a Pin" in text
    assert 'names "oil.haet", and there is no such port. Did you mean "oil.heat"' in text
    assert "names one port only" in text


def test_more_equations_than_unknowns() -> None:
    class Chatty(Component):
        heat = Heat()
        y = Output("K", "reading")

        def equations(self) -> Iterator[Equation]:
            yield equation("reading", self.y, self.heat.T)
            yield equation("no heat", self.heat.Q_flow, 0.0)
            yield equation("reading again", self.y, 300.0)

    text = fault(Chatty("c"), Body("oil", C=1.0), nets=[("c.heat", "oil.heat")])
    assert "c: reading again" in text


class Everything(Component):
    shaft = Shaft()
    pin = Pin()

    kind = Choice(("round", "square"), "shape", default="round")
    d = Parameter("m", "diameter", above=0.0)
    share = Parameter("1", "share", at_least=0.0, at_most=1.0)
    twice = Parameter("m", "twice the diameter", derived=lambda p: 2 * p.d)
    w = Input("rad/s", "speed", start=3.0)


def test_all_wrong_values_of_a_part_at_once() -> None:
    with pytest.raises(ScenarioError) as caught:
        Everything("e", share=1.5, diameter=2.0, kind="roundish")
    text = str(caught.value)
    assert len(caught.value.problems) == 4  # not what follows from the missing d
    assert 'unknown key "diameter"' in text
    assert "d is missing (diameter)" in text
    assert "share = 1.5" in text
    assert "at most 1" in text
    assert "'roundish' is not known. Choose one of: round, square." in text


@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf")])
def test_values_out_of_range(value: float) -> None:
    with pytest.raises(ScenarioError, match=r"e\.d = "):
        Everything("e", share=0.5, d=value)


def test_derived_values_give_way_to_given_ones() -> None:
    assert Everything("e", share=0.5, d=2.0).values["twice"] == 4.0
    assert Everything("e", share=0.5, d=2.0, twice=5.0).values["twice"] == 5.0


def test_unknown_names_of_a_flat_model() -> None:
    with pytest.raises(ScenarioError, match=r'unknown name "batery.V". Did you mean "battery.V"'):
        rc().quantity("batery.V")


def test_a_flywheel_beside_a_given_speed_is_said_twice() -> None:
    text = fault(Speed("drive"), Flywheel("rotor", J=1.0), nets=[("drive.shaft", "rotor.shaft")])
    assert "drive: speed held" in text
    assert "rotor: one speed" in text


def test_an_open_shaft_turns_freely() -> None:
    parts = (Friction("bearing", tau_dry=1.0, d_40=0.1, thinning=0.0), Body("oil", C=1.0), Flywheel("rotor", J=1.0))
    flat = model(*parts, nets=[("bearing.shaft", "rotor.shaft"), ("bearing.heat", "oil.heat")])
    assert [q.name for q in flat.states] == ["oil.T", "rotor.w"]
