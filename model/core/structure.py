"""Structural analysis: does every unknown have an equation of its own, and who is at fault if not."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from ..errors import StructureError
from .component import Equation
from .connect import Assembly
from .faults import Faults
from .matching import Matching, columns_of
from .ports_check import floating
from .solve import Unknown, incidence

#: Problems told at once: what is wrong at one place shows at several.
MOST = 5


def check_structure(
    assembly: Assembly, rows: Sequence[Equation], unknowns: Sequence[Unknown], typical: Mapping[int, float]
) -> None:
    """Refuse a system unless every unknown has an equation of its own and every temperature a level.

    The message names the smallest sets that do not come out even. What is said twice of potentials is missing for
    flows, and the other way round: then the potentials are told.

    Args:
        assembly: the parts
        rows: all equations, rigid couplings reduced
        unknowns: all unknowns
        typical: typical value of every symbol by its hash

    Raises:
        StructureError: an unknown has no equation of its own, or a temperature no level
    """
    columns = columns_of(incidence(rows, unknowns))
    if problems := floating(assembly.name, assembly.ports(), rows, unknowns, columns):
        raise StructureError(problems)
    matching = Matching(columns, len(unknowns))
    if not matching.spare_rows and not matching.free_columns:
        return
    faults = Faults(assembly, rows, unknowns, columns, typical)
    much = [faults.too_much(c) for c in _apart(sorted(map(matching.too_many, matching.spare_rows), key=len))]
    little = [faults.too_little(c) for c in _joined(map(matching.too_few, matching.free_columns))]
    found = [*much, *little]
    told = [fault for fault in found if fault.potentials] or found
    raise StructureError(list(dict.fromkeys(problem for fault in told for problem in fault.problems))[:MOST])


def _apart(sets: Iterable[list[int]]) -> list[list[int]]:
    """Those of the sets that share nothing with one before: each is a fault of its own."""
    kept: list[list[int]] = []
    for chosen in sets:
        if not any(set(chosen) & set(other) for other in kept):
            kept.append(chosen)
    return kept


def _joined(sets: Iterable[list[int]]) -> list[list[int]]:
    """The sets, those that share something as one."""
    kept: list[set[int]] = []
    for chosen in sets:
        near = [other for other in kept if not other.isdisjoint(chosen)]
        kept = [other for other in kept if other not in near] + [set(chosen).union(*near)]
    return [sorted(chosen) for chosen in kept]
