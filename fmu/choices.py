"""What an importer chooses by name: enumerations of an FMU, each item of which gives parameters other values."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace

from ..model.core.flat import FlatModel

#: Name of the choice how a run begins.
START = "start"
#: Its item: at the start values of the states.
GIVEN = "given"
#: Its item: all temperatures as the room's.
ROOM = "room"
#: Its item: at the steady state of the initial inputs.
STEADY = "steady"


@dataclass(frozen=True)
class Item:
    """One item of a choice.

    Attributes:
        values: parameter -> its value (SI) with this item
    """

    name: str
    doc: str
    values: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Choice:
    """An enumeration. Its first item leaves all as exported.

    Attributes:
        fixed: whether it counts at the start alone
        room: of a choice how a run begins, the input or parameter with the temperature of the room; "" where none is
    """

    name: str
    doc: str
    items: tuple[Item, ...]
    fixed: bool = False
    room: str = ""

    @property
    def parameters(self) -> frozenset[str]:
        """The parameters that its items give values to."""
        return frozenset(name for item in self.items for name in item.values)


def start_choice(room: str | None = None) -> Choice:
    """How a run begins.

    Args:
        room: the input or parameter with the temperature of the room; None where there is none
    """
    given = Item(GIVEN, "the start values of the states")
    at_room = Item(ROOM, f"all temperatures as {room}, their start values do not count")
    steady = Item(STEADY, "the steady state at the initial inputs, looked for from the given states")
    doc = "how the run begins; it takes effect when initialization ends"
    return Choice(START, doc, (given, *([at_room] if room else []), steady), fixed=True, room=room or "")


def drop_idle(choices: Iterable[Choice], flat: FlatModel) -> Iterator[Choice]:
    """The choices without values of parameters that a model does not have; those of parameters left without any go.

    Args:
        choices: of the FMU
        flat: the model
    """
    known = {q.name for q in flat.parameters}
    for choice in choices:
        items = (
            Item(i.name, i.doc, {name: value for name, value in i.values.items() if name in known})
            for i in choice.items
        )
        kept = replace(choice, items=tuple(items))
        if kept.parameters or not choice.parameters:
            yield kept
