"""terminalsAndIcons.xml of an FMU for FMI 3.0: the variables that belong together where two FMUs are joined.

Terminals follow from names and units: `P.w` with `P.tau` is a shaft end, whose torque counts into the model; a
temperature `P.T` with the heat flow rate `P.Q_flow_external` that may be given a heat port, and so is a given
temperature with the heat flow rate `P.Q_flow` that follows, which counts out of the model.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from .fixed import xml
from .variables import Table


@dataclass(frozen=True)
class _Terminal:
    """Two variables that are connected together: a potential and a flow with the names they have in any terminal.

    Attributes:
        kind: name of the kind of terminal, for importers that connect like with like
        inflow: whether the flow counts into the model
    """

    name: str
    kind: str
    doc: str
    potential: str
    flow: str
    members: tuple[str, str]
    inflow: bool


def terminals(table: Table) -> bytes:
    """terminalsAndIcons.xml.

    Args:
        table: the variables of the FMU
    """
    return xml("terminals.xml", terminals=list(_list_terminals(table)))


def _list_terminals(table: Table) -> Iterator[_Terminal]:
    """The terminals in the order of their potentials."""
    known = {(v.name, v.quantity.unit): v for v in table if v.kind in ("state", "input", "output")}
    for (name, unit), v in known.items():
        path, _, last = name.rpartition(".")
        if (last, unit) == ("w", "rad/s") and (tau := known.get((f"{path}.tau", "N.m"))):
            yield _Terminal(path, "org.gearheat.Flange", "shaft end", name, tau.name, ("w", "tau"), True)
        if (last, unit) == ("T", "K"):
            given, follows = (known.get((f"{path}.{flow}", "W")) for flow in ("Q_flow_external", "Q_flow"))
            flow = follows if v.kind == "input" else given
            if flow is not None:
                names, inflow = ("T", "Q_flow"), v.kind != "input"
                yield _Terminal(path, "org.gearheat.HeatPort", "heat port", name, flow.name, names, inflow)
