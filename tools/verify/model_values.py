"""What a rig's model gives for published numbers: steady states, designs, losses at readings, contacts of a cycle.

The flattened model is shared by all rows that have the same structure: the choices, what drives the rig, and which
parameters have a value of their own.
"""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ...model.core.flat import FlatModel
from ...model.errors import ScenarioError, SolveError
from ...model.parts.contacts import ContactTable
from ...model.run.design import design
from ...model.run.steady import steady
from ...model.sources import LawInfo
from ...model.units import to_si
from ...scenarios.document import paths
from ...scenarios.measured.readings import measured_rows, table_columns
from ...scenarios.measured.study import read_study
from ...scenarios.published import Row
from ...scenarios.scenario import Scenario, parse_assignments
from ..solve.losses import at_readings, contacts_part, hold
from ..solve.settings import adjust, choice_paths, flat_of, parameter_of
from .verdicts import Value, number_of

CONSTANTS: Mapping[str, float] = {"pi": float(np.pi)}
OPERATORS: Mapping[type[ast.AST], Callable[..., Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
    ast.BitAnd: operator.and_,
    ast.BitOr: operator.or_,
    ast.USub: operator.neg,
    ast.Invert: operator.invert,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Eq: operator.eq,
}


@dataclass(frozen=True)
class _Setting:
    """A rig as a row sets it: structure in `scenario` and `flat`, numbers in `values` and start `states` (SI)."""

    scenario: Scenario
    flat: FlatModel
    values: Mapping[str, float]
    states: Mapping[str, float]


class RigValues:
    """Values of the rows of one rig, with what they share computed once."""

    def __init__(self, scenario: Scenario) -> None:
        self.scenario, self.name = scenario, scenario.name
        self._structures: dict[object, tuple[Scenario, FlatModel]] = {}
        self._losses: dict[tuple[str, ...], list[dict[str, Any]]] = {}
        self._cycles: dict[tuple[str, ...], ContactTable] = {}

    @cached_property
    def laws(self) -> tuple[LawInfo, ...]:
        """The laws that the rig's model uses."""
        return self._setting(()).flat.laws

    def value(self, row: Row) -> Value:
        """What the model gives for a row.

        Args:
            row: with run = "steady", "held", "design", "losses" or "contacts"

        Raises:
            ScenarioError: the row names what the rig does not have
        """
        found = {"steady": self._steady, "held": self._hold, "design": self._design}
        found |= {"losses": self._at_readings, "contacts": self._contacts}
        try:
            return found[row.run](row)
        except SolveError as error:
            return Value(None, problem=str(error))

    def _steady(self, row: Row) -> Value:
        setting = self._setting(_assignments(row))
        result = steady(setting.flat, setting.values, guess=setting.states)
        return _read_value(row.path, setting, {name: float(column[0]) for name, column in result.columns.items()})

    def _hold(self, row: Row) -> Value:
        setting = self._setting(_assignments(row))
        columns = hold(setting.flat, [setting.values], [to_si(row.temperature, "K", name="temperature")])
        return _read_value(row.path, setting, {name: float(column[0]) for name, column in columns.items()})

    def _design(self, row: Row) -> Value:
        free, targets = _as_list(row.free), _as_list(row.target)
        setting = self._setting(_assignments(row), free)
        aims = parse_assignments(setting.flat, targets)
        solution = design(setting.flat, free, aims, setting.values, guess=setting.states)
        columns = {name: float(column[0]) for name, column in solution.result.columns.items()}
        return _read_value(row.path or free[0], setting, columns | dict(solution.values))

    def _contacts(self, row: Row) -> Value:
        """A total of the contacts over a mesh cycle, or their columns: all of them, or at one angle."""
        found = self._cycle(_assignments(row))
        columns = {name: np.array([contact[name] for contact in found.rows]) for name in found.columns}
        theta = columns.get("theta_deg")
        if row.at is not None and theta is not None:
            if not theta.min() <= row.at <= theta.max():
                raise ScenarioError(f"at = {row.at:g} is outside the contacts, {theta.min():g} to {theta.max():g} deg.")
            order = np.argsort(theta)
            columns = {name: np.interp(row.at, theta[order], column[order]) for name, column in columns.items()}
        known = columns | dict(found.totals)

        def value_of(name: str) -> Any:
            if name not in known:
                raise ScenarioError(f'there is no "{name}" among the contacts. Known: {", ".join(known)}.')
            return known[name]

        return Value(single(row.path, value_of))

    def _cycle(self, assignments: tuple[str, ...]) -> ContactTable:
        """The contacts at the operating point with values set."""
        if assignments not in self._cycles:
            part, values = contacts_part(adjust(self.scenario, assignments))
            self._cycles[assignments] = part.contact_table(values)
        return self._cycles[assignments]

    def _at_readings(self, row: Row) -> Value:
        readings = _select_rows(self._readings(_assignments(row)), row.select)
        if not readings:
            raise ScenarioError(f"no reading of {self.scenario.name} has {row.select}.")

        def column(name: str) -> np.ndarray:
            if name not in readings[0]:
                raise ScenarioError(f'there is no column "{name}". Columns: {", ".join(readings[0])}.')
            return np.array([reading[name] for reading in readings])

        return Value(single(row.path, column), labelled=True)

    def _readings(self, assignments: tuple[str, ...]) -> list[dict[str, Any]]:
        """The losses at all measured readings beside what was measured, a row each."""
        if assignments not in self._losses:
            scenario = adjust(self.scenario, assignments)
            if (study := read_study(scenario)) is None:
                raise ScenarioError(f"{scenario.name} has no measured readings.")
            read, table = measured_rows(study), table_columns(study)
            rows = zip(study.read_rows, at_readings(study, "measured"), strict=True)
            self._losses[assignments] = [{**table[row], **read[row], **found} for row, found in rows]
        return self._losses[assignments]

    def _setting(self, assignments: Iterable[str], free: Iterable[str] = ()) -> _Setting:
        """The rig with values set, flattened once for each structure."""
        known = choice_paths(self.scenario.spec)
        chosen = [text for text in assignments if text.partition("=")[0].strip() in known]
        numbers = parse_assignments(self.scenario, [text for text in assignments if text not in chosen])
        named = [*numbers, *free]
        own = [name for name in named if (p := parameter_of(self.scenario.spec, name)) is not None and p.derived]
        structural = adjust(self.scenario, chosen, named=named)
        key = (tuple(chosen), tuple(own), tuple(structural.given.items()))
        if key not in self._structures:
            self._structures[key] = (structural, flat_of(structural))
        scenario, flat = self._structures[key]
        states = {q.name for q in flat.states}
        return _Setting(
            scenario,
            flat,
            {name: value for name, value in numbers.items() if name not in states},
            {name: value for name, value in numbers.items() if name in states},
        )


def _select_rows(rows: Iterable[Mapping[str, Any]], select: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """The rows whose columns have the values asked for, in the order of the first column that lists several."""
    wanted = {column: value if isinstance(value, list) else [value] for column, value in select.items()}
    found = [row for row in rows if all(row.get(column) in values for column, values in wanted.items())]
    for column, values in wanted.items():
        if len(values) > 1:
            return sorted(found, key=lambda row: values.index(row[column]))
    return found


def single(path: str, value_of: Callable[[str], Any]) -> float | bool:
    """The one value of an expression.

    Args:
        path: the expression
        value_of: name -> number or array

    Raises:
        ScenarioError: it is no expression, or gives many values
    """
    try:
        return number_of(evaluate(path, value_of))
    except (ValueError, IndexError, TypeError) as error:
        raise ScenarioError(f"{path}: {error}.") from None


def _read_value(path: str, setting: _Setting, columns: Mapping[str, float]) -> Value:
    """A path, or an expression in paths, of a result."""
    flat = setting.flat
    given = {q.name: q.start for q in flat.parameters} | dict(setting.values)
    if path in flat.index and path in (columns.keys() | given.keys()):
        return Value(columns.get(path, given.get(path)), flat.quantity(path).unit)

    def value_of(name: str) -> float:
        if name in columns or name in given:
            return columns[name] if name in columns else given[name]
        flat.locate(name)  # raises with suggestions for an unknown name
        raise ScenarioError(f"{name} is no result of this run.")

    return Value(single(path, value_of))


def _assignments(row: Row) -> tuple[str, ...]:
    return tuple(f"{path}={value}" for path, value in paths(row.set))


def _as_list(text: str | list[str]) -> list[str]:
    return [text] if isinstance(text, str) else list(text)


def _line(y: np.ndarray, x: np.ndarray) -> np.ndarray:
    return np.polyfit(x, y, 1)


def _misfit(y: np.ndarray, x: np.ndarray) -> float:
    return float(np.linalg.norm(y - np.polyval(_line(y, x), x)))


FUNCTIONS: Mapping[str, Callable[..., Any]] = {
    "min": np.min,
    "max": np.max,
    "mean": np.mean,
    "sum": np.sum,
    "abs": np.abs,
    "all": np.all,
    "any": np.any,
    "sqrt": np.sqrt,
    "exp": np.exp,
    "log": np.log,
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "radians": np.radians,
    "increasing": lambda x: bool(np.all(np.diff(x) > 0)),
    "decreasing": lambda x: bool(np.all(np.diff(x) < 0)),
    "slope": lambda y, x: _line(y, x)[0],
    "intercept": lambda y, x: _line(y, x)[1],
    "misfit": _misfit,  # norm of what a straight line through y over x leaves
}


def evaluate(text: str, value_of: Callable[[str], Any]) -> Any:
    """The value of an expression: a number, a truth value, or an array of either.

    "P_loss / carrier.P", "max(mu) < 0.05" and "slope(alphaA_W_K, T_oil_C - T_amb_C)" are expressions. Nothing but
    numbers, names, operators and some functions is known, so a file of numbers cannot run a program.

    Args:
        text: the expression
        value_of: name, dotted or not, -> number or array

    Raises:
        ValueError: it is no expression, with what is wrong
    """
    try:
        tree = ast.parse(text.strip(), mode="eval").body
    except SyntaxError:
        raise ValueError(f'"{text}" is no expression. Write for example "oil.T - room.T"') from None
    with np.errstate(all="ignore"):
        return _Evaluation(text, value_of).of(tree)


class _Evaluation:
    """One evaluation, node by node."""

    def __init__(self, text: str, value_of: Callable[[str], Any]) -> None:
        self.text, self.value_of = text, value_of

    def of(self, node: ast.AST) -> Any:
        """The value of one node."""
        match node:
            case ast.Constant(value=int() | float()):
                found = node.value
            case ast.Name() | ast.Attribute():
                found = self._named(node)
            case ast.Call(func=ast.Name(id=name), keywords=[]) if name in FUNCTIONS:
                found = FUNCTIONS[name](*map(self.of, node.args))
            case ast.UnaryOp(op=op) if type(op) in OPERATORS:
                found = OPERATORS[type(op)](self.of(node.operand))
            case ast.BinOp(op=op) if type(op) in OPERATORS:
                found = OPERATORS[type(op)](self.of(node.left), self.of(node.right))
            case ast.Compare():
                found = self._compared(node)
            case ast.Subscript(slice=ast.Slice() as part):
                ends = [end and self.of(end) for end in (part.lower, part.upper, part.step)]
                found = self.of(node.value)[slice(*ends)]
            case ast.Subscript():
                found = self.of(node.value)[self.of(node.slice)]
            case _:
                names = ", ".join(FUNCTIONS)
                raise ValueError(f'"{ast.unparse(node)}" in "{self.text}" is not known. Functions: {names}')
        return found

    def _named(self, node: ast.AST) -> Any:
        name = ast.unparse(node)
        return CONSTANTS[name] if name in CONSTANTS else self.value_of(name)

    def _compared(self, node: ast.Compare) -> Any:
        terms = [self.of(term) for term in (node.left, *node.comparators)]
        found: Any = True
        for op, left, right in zip(node.ops, terms, terms[1:], strict=False):
            if type(op) not in OPERATORS:
                raise ValueError(f'the comparison in "{self.text}" is not known. Write <, <=, >, >= or ==')
            found = found & OPERATORS[type(op)](left, right)
        return found
