"""Rigid couplings: states that linear equations tie to each other are fewer states.

Two inertias on one shaft line, two heat capacities at one place, three inertias on a planetary set: the equations then
say more about the states than they may. The relation between the states is differentiated once, its coefficients being
parameters, and one of its states becomes an unknown that follows the others (the method of dummy derivatives, Mattsson
and Soederlind 1993, for linear constraints).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import casadi as ca

from ..errors import StructureError
from .component import Component, Equation
from .connect import Assembly
from .eliminate import Factors, Singular, typical_sizes
from .solve import Matching, Unknown, column, columns_of, incidence

#: A coefficient of a constraint below this is none.
NOTHING = 1e-12
#: How well the start values of states that follow each other agree, relative to their size.
AGREE = 1e-9


@dataclass(frozen=True)
class Known:
    """The quantities that equations do not determine: states, inputs and parameters, by the hash of their symbols.

    `typical` holds a typical value of every symbol of the model.
    """

    states: Mapping[int, tuple[Component, str]]
    inputs: Mapping[int, str]
    parameters: Collection[int]
    typical: Mapping[int, float]

    @staticmethod
    def of(assembly: Assembly, typical: Mapping[int, float]) -> Known:
        """Those of all parts of an assembly.

        Args:
            assembly: the parts
            typical: hash of a symbol -> value at which coefficients are judged
        """
        parts = assembly.parts
        return Known(
            {part.symbols[k].element_hash(): (part, k) for part in parts for k in part.states},
            {
                part.symbols[k].element_hash(): f"{part.name}.{k}"
                for part in parts
                for k in part.inputs
                if part.is_input(k)
            },
            {part.symbols[k].element_hash() for part in parts for k in part.parameters},
            typical,
        )

    def constant(self, expression: Any) -> bool:
        """Whether a CasADi expression of any shape holds nothing but parameters."""
        return all(s.element_hash() in self.parameters for s in ca.symvar(expression))

    def values(self, expression: Any) -> Any:
        """A CasADi expression of any shape at typical values, as a matrix of numbers."""
        free = ca.symvar(expression)
        point = [self.typical.get(s.element_hash(), 1.0) for s in free]
        return ca.Function("values", free, [expression])(*point) if free else ca.DM(expression)


def constraint(rows: Sequence[Equation], unknowns: Sequence[Unknown], known: Known) -> Any:
    """The one relation, an expression that has to be zero, that is left when all unknowns are eliminated.

    Args:
        rows: one equation more than unknowns, without other unknowns
        unknowns: what to eliminate
        known: the quantities that may be left

    Returns:
        the relation between states, inputs and parameters; None where the equations are not linear in the unknowns
        with coefficients of parameters, or do not determine them
    """
    z = column([u.symbol for u in unknowns])
    residual = column([r.residual for r in rows])
    matrix = ca.jacobian(residual, z)
    if not known.constant(matrix):
        return None
    rest = ca.substitute(residual, z, ca.SX.zeros(*z.shape))
    for left in reversed(range(len(rows))):
        others = [i for i in range(len(rows)) if i != left]
        chosen = matrix[others, :]
        try:
            answer = Factors(chosen, typical_sizes(chosen, known.typical)).solve(-rest[others, :])
        except Singular:
            continue
        return rest[left] + ca.mtimes(matrix[left, :], answer)
    return None


@dataclass(frozen=True)
class Constraint:
    """A constraint as sum of coefficient times state, plus what inputs and parameters say.

    Attributes:
        states: part and key of each state, in the order of the parts
        coefficients: theirs, expressions of parameters
        sizes: the coefficients at the values of the parameters; 0.0 where one vanishes there, as in a closed loop
            whose ratios fit
        inputs: paths of the inputs that act at these values
        rest: what is left without states
    """

    states: tuple[tuple[Component, str], ...]
    coefficients: tuple[Any, ...]
    sizes: tuple[float, ...]
    inputs: tuple[str, ...]
    rest: Any

    @property
    def acting(self) -> list[int]:
        """Positions of the states whose coefficient does not vanish."""
        return [k for k, size in enumerate(self.sizes) if size]

    @staticmethod
    def of(expression: Any, known: Known) -> Constraint | None:
        """A constraint in this form; None where it is not linear in the states and inputs.

        Args:
            expression: scalar that has to be zero
            known: the quantities that stand in it
        """
        held = {s.element_hash(): s for s in ca.symvar(expression)}
        states, inputs = [h for h in known.states if h in held], [h for h in known.inputs if h in held]
        z = column([held[h] for h in (*states, *inputs)])
        slopes = ca.jacobian(expression, z)
        if not known.constant(slopes):
            return None
        found = [float(size) for size in known.values(ca.densify(slopes)).full().ravel()]
        sizes = [size if abs(size) > NOTHING else 0.0 for size in found]
        x = z[: len(states)]
        return Constraint(
            tuple(known.states[h] for h in states),
            tuple(slopes[0, k] for k in range(len(states))),
            tuple(sizes[: len(states)]),
            tuple(known.inputs[h] for h, size in zip(inputs, sizes[len(states) :], strict=True) if size),
            ca.substitute(expression, x, ca.SX.zeros(*x.shape)),
        )


@dataclass
class Reduced:
    """The equations and unknowns without rigid couplings.

    `joined` says of each state that is none any more, by path, which ones it follows; `columns` the positions of the
    unknowns of each equation.
    """

    rows: list[Equation]
    unknowns: list[Unknown]
    columns: list[list[int]]
    joined: dict[str, str] = field(default_factory=dict)


def reduce(assembly: Assembly, rows: list[Equation], unknowns: list[Unknown], typical: Mapping[int, float]) -> Reduced:
    """Let states that linear equations tie together follow each other, until as few are left as may be chosen freely.

    What cannot be reduced (a state tied to an input, a relation that is not linear) stays as it is, for
    `check_structure` to refuse.

    Args:
        assembly: the parts, whose states, inputs and parameters are looked at
        rows: all equations, in the symbols of the nets
        unknowns: all unknowns
        typical: typical value of every symbol by its hash

    Raises:
        StructureError: start values given for two states that follow each other do not fit together
    """
    columns = columns_of(incidence(rows, unknowns))
    reduced = Reduced(list(rows), list(unknowns), columns)
    if not Matching(columns, len(unknowns)).spare_rows:
        return reduced
    known = Known.of(assembly, typical)
    standing = _standing(rows, known)
    place = {u.symbol.element_hash(): i for i, u in enumerate(unknowns)}
    while (found := _coupling(reduced, known)) is not None:
        relation, k = found
        follower = relation.states[k]
        for row in standing[_path(*follower)]:
            columns[row].append(len(reduced.unknowns))
        columns.append([place[part.derivatives[key].element_hash()] for part, key in relation.states])
        _demote(assembly.name, relation, k, known, reduced)
    return reduced


def _standing(rows: list[Equation], known: Known) -> dict[str, list[int]]:
    """In which equations each state stands, by its path."""
    states = [Unknown(part.symbols[key], _path(part, key)) for part, key in known.states.values()]
    found: dict[str, list[int]] = {state.name: [] for state in states}
    for row, columns in enumerate(columns_of(incidence(rows, states))):
        for place in columns:
            found[states[place].name].append(row)
    return found


def _coupling(reduced: Reduced, known: Known) -> tuple[Constraint, int] | None:
    """The first relation between states alone, and which of them is to follow."""
    columns = reduced.columns
    matching = Matching(columns, len(reduced.unknowns))
    for spare in matching.spare_rows:
        chosen = matching.too_many(spare)
        inside = sorted({c for r in chosen for c in columns[r]})
        relation = tie([reduced.rows[r] for r in chosen], [reduced.unknowns[c] for c in inside], known)
        if relation is not None and known.constant(relation.rest) and len(relation.acting) > 1:
            return relation, _follower(relation)
    return None


def tie(rows: list[Equation], unknowns: list[Unknown], known: Known) -> Constraint | None:
    """What equations, one more than unknowns, say about states and inputs; None where that is not linear.

    Args:
        rows: the equations
        unknowns: one fewer than equations
        known: the symbols of the parts
    """
    expression = constraint(rows, unknowns, known)
    return None if expression is None else Constraint.of(expression, known)


def _follower(relation: Constraint) -> int:
    """The last state of those whose start nobody has given, the last of all where each was given."""
    starts = [(part.values[key], part.states[key].start) for part, key in relation.states]
    unasked = [k for k in relation.acting if starts[k][0] == starts[k][1]]
    return (unasked or relation.acting)[-1]


def _demote(model: str, relation: Constraint, k: int, known: Known, reduced: Reduced) -> None:
    """Make the k-th state of a relation an unknown, with the relation's derivative to go with its derivative."""
    (part, key), others = relation.states[k], [i for i in range(len(relation.states)) if i != k]
    path, leaders = _path(part, key), [_path(*relation.states[i]) for i in others]
    _check_start(model, relation, k, known)
    followed = ca.SX(0)
    for i in others:
        other, name = relation.states[i]
        followed = followed - relation.coefficients[i] / relation.coefficients[k] * other.derivatives[name]
    reduced.rows.append(Equation(f"{path} follows", part.derivatives[key], followed))
    reduced.unknowns.append(Unknown(part.symbols[key], path, part.states[key].nominal))
    reduced.joined[path] = f"{path} follows {' and '.join(leaders)}"


def _check_start(model: str, relation: Constraint, k: int, known: Known) -> None:
    """Raise StructureError where a start that was given is not the one that follows from the others."""
    part, key = relation.states[k]
    given, state = part.values[key], part.states[key]
    if given == state.start:
        return
    others = [i for i in range(len(relation.states)) if i != k]
    total = float(known.values(relation.rest))
    total += sum(relation.sizes[i] * relation.states[i][0].values[relation.states[i][1]] for i in others)
    expected = -total / relation.sizes[k]
    if abs(given - expected) <= AGREE * max(abs(given), abs(expected), state.nominal):
        return
    leaders = ", ".join(
        f"{_path(*relation.states[i])} = {relation.states[i][0].values[relation.states[i][1]]:g}" for i in others
    )
    raise StructureError(
        f"{model}: {_path(part, key)} starts at {given:g} {state.unit}, but it is rigidly coupled and follows from "
        f"{leaders}: that is {expected:g} {state.unit}. Give one of these starts only, or starts that fit."
    )


def _path(part: Component, key: str) -> str:
    return f"{part.name}.{key}"
