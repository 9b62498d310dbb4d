"""Assemblies of a rig file: parts and nets that are met by a few ports, written once and used by name.

[assembly.shaft.part.support]                 # its parts; they may use templates and assemblies, too
type = "ShaftSupport"

[assembly.shaft.part."bearing_{a,b}"]
use = "ball"

[assembly.shaft.connect]                      # nets between them
"load_{a,b}" = ["support.load_{a,b}", "bearing_{a,b}.load"]

[assembly.shaft.ports]                        # where it is met: port = port of one of its parts
mesh = "support.mesh"

[part.input]                                  # parts input_support, input_bearing_a and input_bearing_b
use = "shaft"
support.l_a = "40 mm"                         # values of its own
"bearing_{a,b}".bearing = "SKF 6306"

[connect]
pinion = ["pair.mesh_1", "input.mesh"]        # met by its port; ports of its parts stay reachable
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from pydantic import Field

from ..model.errors import ScenarioError, suggestion
from .repeats import MOST, flat, join_tables, nets, spell_out
from .tables import Strict


class AssemblyTable(Strict):
    """Parts, the nets between them, and where they are met."""

    part: dict[str, dict[str, Any]] = Field(description="a table for each part")
    connect: dict[str, list[str]] = Field({}, description="name of a net -> list of the ports that meet")
    ports: dict[str, str] = Field({}, description="port of the assembly -> port of one of its parts")


class Assemblies(Strict):
    """All of a file."""

    assembly: dict[str, AssemblyTable] = Field({}, description="a table [assembly.NAME] for each: part, connect, ports")


@dataclass
class Unfolded:
    """Plain parts and nets.

    Args:
        parts: name as written -> table
        connect: net -> ports
        met: port of an assembly in use -> that of its part
        problems: what is wrong
    """

    parts: dict[str, Any] = field(default_factory=dict)
    connect: dict[str, Any] = field(default_factory=dict)
    met: dict[str, str] = field(default_factory=dict)
    problems: list[str] = field(default_factory=list)


def expand_assemblies(file: str, raw: Mapping[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """A rig file without assemblies, and all that is wrong with these.

    Args:
        file: its name, for messages
        raw: what TOML makes of it
    """
    rest = {key: value for key, value in raw.items() if key != "assembly"}
    parts, connect = rest.get("part"), rest.get("connect", {})
    if "assembly" not in raw or not isinstance(parts, Mapping) or not isinstance(connect, Mapping):
        return rest, []
    try:
        tables = Assemblies.read(file, {"assembly": raw["assembly"]}).assembly
    except ScenarioError as error:
        return rest, list(error.problems)
    found = _unfold(file, parts, connect, tables)
    return rest | {"part": found.parts, "connect": found.connect}, found.problems


def _unfold(
    file: str,
    parts: Mapping[str, Any],
    connect: Mapping[str, Any],
    assemblies: Mapping[str, AssemblyTable],
    above: Sequence[str] = (),
) -> Unfolded:
    """Parts and nets, by their names as written, with every assembly in its place; `above` are those that hold them."""
    found = Unfolded()
    for written, table in parts.items():
        use = table.get("use") if isinstance(table, Mapping) else None
        if not isinstance(use, str) or use not in assemblies:
            found.parts[written] = table
        elif use in above:
            found.problems.append(f'{file} [assembly.{use}]: holds itself, by part "{written}". Leave that part out.')
        else:
            for name in spell_out(written):
                _place(file, name, table, assemblies, (*above, use), found)
    for net, ports in connect.items():
        for name, own in nets(net, ports):
            found.connect[name] = [found.met.get(p, p) for p in own] if isinstance(own, list) else own
    return found


def _place(
    file: str,
    name: str,
    table: Mapping[str, Any],
    assemblies: Mapping[str, AssemblyTable],
    above: Sequence[str],
    found: Unfolded,
) -> None:
    """One use of an assembly, its parts and nets under the name of the use."""
    assembly = assemblies[above[-1]]
    inner = _unfold(file, dict(_expand(file, name, table, assembly, found)), assembly.connect, assemblies, above)
    found.problems += inner.problems
    found.parts |= {f"{name}_{part}": own for part, own in inner.parts.items()}
    if len(found.parts) > MOST:
        raise ScenarioError(f"{file} [assembly.{above[-1]}]: makes more than {MOST} parts. Write fewer.")
    found.connect |= {f"{name}_{net}": [f"{name}_{p}" for p in flat(ports)] for net, ports in inner.connect.items()}
    for port, target in assembly.ports.items():
        found.met[f"{name}.{port}"] = f"{name}_{inner.met.get(target, target)}"


def _expand(
    file: str, name: str, table: Mapping[str, Any], assembly: AssemblyTable, found: Unfolded
) -> Iterator[tuple[str, Any]]:
    """The parts of an assembly one by one, with the values that its use gives them."""
    members = {member: dict(values) for written, values in assembly.part.items() for member in spell_out(written)}
    where = f"{file} [part.{name}]"
    for key, values in (
        (k, values) for written, values in table.items() if written != "use" for k in spell_out(written)
    ):
        if key not in members:
            close = suggestion(key, members) or f" Its parts: {', '.join(members)}."
            found.problems.append(f'{where}: the assembly has no part "{key}".{close}')
        elif not isinstance(values, Mapping):
            found.problems.append(f"{where}: {key} is no table. Write {key}.NAME = ... for each of its values.")
        else:
            members[key] = join_tables(members[key], values)
    yield from members.items()
