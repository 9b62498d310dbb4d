"""modelDescription.xml and sources/buildDescription.xml of an FMU for FMI 3.0, from its table of variables."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from ..model.core.flat import FlatModel
from .description import Dependencies, Owner, circumstances, identifier, identity, origin, unknowns, values
from .fixed import xml
from .variables import Table, Variable

#: What the types of FMI 2.0 are called.
_TYPES = {"Real": "Float64", "Integer": "Int32", "Enumeration": "Enumeration"}


def description(flat: FlatModel, table: Table, token: str, dependent: Dependencies, owner: Owner = Owner()) -> bytes:
    """modelDescription.xml.

    Args:
        flat: the model, for its name and meaning
        table: its variables; behind them stands the independent variable that FMI 3.0 asks for
        token: unique identification
        dependent: what outputs and derivatives depend on
        owner: what its owner says of it
    """
    named = {"fmiVersion": "3.0", "modelName": flat.name, "instantiationToken": token}
    step = sorted(unknowns(table, dependent.step), key=lambda pair: pair[0].kind == "derivative")  # these last
    names = ["ContinuousStateDerivative" if v.kind == "derivative" else "Output" for v, _ in step]
    structure = [("Output", _unknown(state, [state.reference])) for state in table.of("state")]
    structure += [(name, _unknown(v, on)) for name, (v, on) in zip(names, step, strict=True)]
    structure += [("InitialUnknown", _unknown(v, on)) for v, on in unknowns(table, dependent.initial)]
    return xml(
        "fmi3.xml",
        root={**named, **origin(flat), **owner.attributes},
        variables=[(_TYPES[v.type], {**identity(v), **values(v)}) for v in table],
        structure=structure,
        **circumstances(flat, table, 3),
    )


def _unknown(variable: Variable, on: Iterable[int]) -> dict[str, Any]:
    return {"valueReference": variable.reference, "dependencies": " ".join(map(str, on))}


def build_description(name: str) -> bytes:
    """buildDescription.xml: how the source becomes a library.

    Args:
        name: of the model
    """
    return xml("build.xml", identifier=identifier(name))
