"""modelDescription.xml and sources/buildDescription.xml of an FMU for FMI 3.0, from its table of variables."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Sequence

from ..model.core.flat import FlatModel
from .choices import Choice
from .description import (
    Dependencies,
    Owner,
    circumstances,
    identifier,
    identity,
    interfaces,
    items,
    origin,
    type_name,
    type_of,
    unknowns,
    values,
    xml,
)
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
    root = ET.Element("fmiModelDescription", {**named, **origin(flat), **owner.attributes})
    interfaces(root, flat, table, 3)
    circumstances(root, table, _types, "s")
    variables = ET.SubElement(root, "ModelVariables")
    for variable in table:
        element = ET.SubElement(variables, _TYPES[variable.type], {**identity(variable), **values(variable)})
        if variable.state is not None:
            element.set("derivative", str(variable.state))
    _time(variables, table)
    _model_structure(root, table, dependent)
    return xml(root)


def _types(definitions: ET.Element, measured: list[str], choices: Sequence[Choice]) -> None:
    for unit in measured:
        ET.SubElement(definitions, "Float64Type", type_of(unit))
    for choice in choices:
        items(ET.SubElement(definitions, "EnumerationType", name=type_name(choice)), choice)


def _time(variables: ET.Element, table: Table) -> None:
    ET.SubElement(
        variables,
        "Float64",
        name="time",
        valueReference=str(len(table.variables)),
        description="simulation time",
        causality="independent",
        variability="continuous",
        unit="s",
    )


def _model_structure(root: ET.Element, table: Table, dependent: Dependencies) -> None:
    structure = ET.SubElement(root, "ModelStructure")
    for state in table.of("state"):
        _unknown(structure, "Output", state, [state.reference])
    derivatives_last = sorted(unknowns(table, dependent.step), key=lambda pair: pair[0].kind == "derivative")
    for variable, on in derivatives_last:
        name = "ContinuousStateDerivative" if variable.kind == "derivative" else "Output"
        _unknown(structure, name, variable, on)
    for variable, on in unknowns(table, dependent.initial):
        _unknown(structure, "InitialUnknown", variable, on)


def _unknown(parent: ET.Element, name: str, variable: Variable, on: Iterable[int]) -> None:
    known = " ".join(map(str, on))
    ET.SubElement(parent, name, valueReference=str(variable.reference), dependencies=known)


def build_description(name: str) -> bytes:
    """buildDescription.xml: how the source becomes a library.

    Args:
        name: of the model
    """
    root = ET.Element("fmiBuildDescription", fmiVersion="3.0")
    built = ET.SubElement(root, "BuildConfiguration", modelIdentifier=identifier(name))
    ET.SubElement(ET.SubElement(built, "SourceFileSet", language="C99"), "SourceFile", name="all.c")
    ET.SubElement(built, "Library", name="m", external="true", description="mathematics of the C library")
    return xml(root)
