"""What too many linear equations say, all together, about the quantities that are not theirs to determine."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from .component import Component, Equation
from .connect import Assembly
from .eliminate import Factors, Singular, typical_sizes
from .solve import Unknown, column

#: A coefficient of a constraint below this is none.
NOTHING = 1e-12


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
        """Whether an expression holds nothing but parameters.

        Args:
            expression: CasADi expression of any shape
        """
        return all(s.element_hash() in self.parameters for s in ca.symvar(expression))

    def values(self, expression: Any) -> Any:
        """An expression at typical values, as a CasADi matrix of numbers.

        Args:
            expression: CasADi expression of any shape
        """
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
