"""What a form of a cause says, as functions of its size and shapes with exact derivatives."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import casadi as ca
import numpy as np

from ..library.cause import Cause, Form, Row

#: What a formula may know of a row beside values by name.
FEATURES = ("order", "direction", "rise", "humidity", "second", "dwell")


class _Asked(Mapping[str, Any]):
    """Symbols by name, made when they are asked for."""

    def __init__(self, known: Sequence[str] | None = None) -> None:
        self.known, self.made = known, dict[str, Any]()

    def __getitem__(self, name: str) -> Any:
        if self.known is not None and name not in self.known:
            raise KeyError(name)
        return self.made.setdefault(name, ca.SX.sym(name))

    def __iter__(self) -> Iterator[str]:
        return iter(self.known or self.made)

    def __len__(self) -> int:
        return len(self.known or self.made)

    @property
    def names(self) -> tuple[str, ...]:
        """What was asked for, in order."""
        return tuple(self.made)

    @property
    def column(self) -> Any:
        """All of it."""
        return ca.vertcat(*self.made.values()) if self.made else ca.SX(0, 1)


class Formula:
    """One form of a cause. Its parameters t are the size over its prior's half width, and a standard normal number
    for each shape.

    Args:
        cause, form: what it says
        sensors: names of all sensors
        reads: names of those that are compared
    """

    def __init__(self, cause: Cause, form: Form, sensors: Sequence[str], reads: Sequence[str]) -> None:
        #: How much of it there may be, and the number of its parameters.
        self.cause, self.form, self.extent, self.size = cause, form, cause.size_of(form), 1 + len(form.shapes)
        self.t = ca.SX.sym("t", self.size)
        theta = {self.extent.name: self.extent.sd * self.t[0]}
        theta |= {shape.name: shape.at(self.t[1 + k]) for k, shape in enumerate(form.shapes)}
        self._base, self._sensors, self._reads = _Asked(), _Asked(sensors), _Asked(reads)
        features = ca.SX.sym("features", len(FEATURES))
        named = {name: features[k] for k, name in enumerate(FEATURES)}
        row = Row(base=self._base, sensors=self._sensors, **named)
        values = dict(form.values(theta, row)) if form.values else {}
        truth = dict(form.truth(theta, row)) if form.truth else {}
        shown = dict(form.shown(theta, row, self._reads)) if form.shown else {}
        pace = form.pace(theta, row) if form.pace else 1.0
        self.paths, self.given, self.read = tuple(values), tuple(truth), tuple(shown)
        self.paced = form.pace is not None
        #: Paths of the values that it builds on.
        self.bases = self._base.names
        #: Those of `paths` that the size itself changes; the others follow shapes alone.
        self.sized = tuple(p for p, v in values.items() if ca.jacobian(ca.SX(v), self.t[0]).nnz())
        self._arguments = [self.t, self._base.column, self._sensors.column, self._reads.column, features]
        physics = [*values.values(), *truth.values(), pace]
        self._physics = self._function("physics", physics, [self.t, self._base.column])
        self._instruments = self._function("instruments", list(shown.values()), [self.t, self._reads.column])
        self._theta = ca.Function("theta", [self.t], [ca.vertcat(*map(ca.SX, theta.values()))])
        self.names = tuple(theta)
        self._rows: dict[tuple[str, int], _Rows] = {}

    @property
    def limits(self) -> tuple[float, float]:
        """Lowest and highest size, in prior half widths."""
        size = self.extent
        return max(self.form.low, size.low) / size.sd, size.high / size.sd

    def theta(self, t: np.ndarray) -> dict[str, float]:
        """Size and shapes in their units."""
        return dict(zip(self.names, np.asarray(self._theta(t)).ravel().tolist(), strict=True))

    def _function(self, name: str, expressions: Sequence[Any], by: Sequence[Any]) -> Any:
        column = ca.vertcat(*map(ca.SX, expressions)) if expressions else ca.SX(0, 1)
        slopes = [ca.densify(ca.jacobian(column, symbols)) for symbols in by]
        return ca.Function(name, self._arguments, [ca.densify(column), *slopes], {"cse": True})

    def physics(
        self, t: np.ndarray, base: Mapping[str, np.ndarray], sensors: Mapping[str, np.ndarray], features: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]:
        """Values of `paths`, truth of `given` and pace, one after the other, for n rows.

        Args:
            t: parameters (k,)
            base: path -> value without the cause (n,)
            sensors: sensor -> reading (n,)
            features: of the rows (features, n)

        Returns:
            values (v, n), by t (v, n, k), by each path of base (v, n)
        """
        value, by_t, by_base = self._evaluated(self._physics, t, features, base, sensors, {})
        return value, by_t, {name: by_base[:, :, i] for i, name in enumerate(self._base.names)}

    def instruments(
        self, t: np.ndarray, sensors: Mapping[str, np.ndarray], reads: Mapping[str, np.ndarray], features: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]:
        """What the sensors `read` show (v, n), by t (v, n, k), by each true reading (v, n)."""
        value, by_t, by_reads = self._evaluated(self._instruments, t, features, {}, sensors, reads)
        return value, by_t, {name: by_reads[:, :, i] for i, name in enumerate(self._reads.names)}

    def _evaluated(
        self, function: Any, t: np.ndarray, features: np.ndarray, *known: Mapping[str, np.ndarray]
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Values and slopes by what is known: base, sensors and reads."""
        key = (function.name(), features.shape[1])
        if key not in self._rows:
            self._rows[key] = _Rows(function, features.shape[1])
        rows = self._rows[key]
        rows.given[0][:], rows.given[4][:] = t, features.T
        for own, asked, given in zip(rows.given[1:4], (self._base, self._sensors, self._reads), known, strict=True):
            for k, name in enumerate(asked.names):
                own[:, k] = given.get(name, 0.0)
        value, by_t, by_other = rows()
        return value[:, :, 0], by_t, by_other


#: Forms that act, each with its parameters.
Parts = Sequence[tuple[Formula, np.ndarray]]


class _Rows:
    """A function of columns at n rows a call, without copies on the way."""

    def __init__(self, function: Any, n: int) -> None:
        self.given = [np.zeros((n, function.size1_in(i))) for i in range(function.n_in())]
        self._found = [np.zeros((n, *function.size_out(i)[::-1])) for i in range(function.n_out())]
        self._mapped = function.map(n)
        self._buffer, self._evaluate = self._mapped.buffer()
        for place, arrays in ((self._buffer.set_arg, self.given), (self._buffer.set_res, self._found)):
            for i, array in enumerate(arrays):
                if array.size:
                    place(i, array.data)

    def __call__(self) -> list[np.ndarray]:
        """Results (rows, n, columns) for what is given."""
        self._evaluate()
        return [found.transpose(2, 0, 1).copy() for found in self._found]
