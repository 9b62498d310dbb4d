"""What the table of causes says of one of them, for a machine and its data."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca

from ....model.files import tables
from .cause import Cause, Form, Mostly, Num, Ranges, Row, Shape, Size, Small, Theta, Values
from .forms import Context, Paths, Regime, factors, weighed

TABLE: Mapping[str, Mapping[str, Any]] = tables("tools.diagnose.library", "causes.toml")
#: Kinds of priors of shapes by the table's words.
PRIORS = {"mostly": Mostly, "small": Small}
#: What sizes are in shares of.
SCALES: Mapping[str, Callable[[Ranges], float]] = {
    "": lambda ranges: 1.0,
    "loss": lambda ranges: ranges.loss,
    "rise": lambda ranges: ranges.rise,
    "conductance": lambda ranges: ranges.conductance,
    "resistance": lambda ranges: 1 / ranges.conductance,
}


@dataclass(frozen=True)
class Entry:
    """A cause of the table.

    Args:
        cause: without its forms
        shapes: of its forms
        regimes: that its forms may be limited to, those of which the data know
        part: name of its extra parts
        rubs: whether it only adds where it is limited to a speed, a load or a temperature
    """

    cause: Cause
    shapes: tuple[Shape, ...]
    regimes: tuple[Regime, ...]
    part: str
    rubs: bool

    def with_forms(self, forms: Iterable[Form], **changes: Any) -> Cause:
        """The cause with its forms, and what else is not as in the table."""
        return replace(self.cause, forms=tuple(forms), **changes)


def entry(name: str, at: Context) -> Entry:
    """What the table says of a cause by its id, or of a kind of causes by that in the table."""
    said = TABLE[name]
    acts_on, like = said.get("acts_on", ""), said.get("like", "")
    cause = Cause(
        id=name,
        doc=said["doc"],
        size=_size(at.ranges, **said["size"]),
        forms=(),
        exposes=said["exposes"],
        like=TABLE["classes"][like] if like else "",
        acts_on=at.first(acts_on) if acts_on in ("speed", "torque", "oil_temp") else acts_on,
        common=said.get("common", 1.0),
    )
    shapes = tuple(_shape(**shape) for shape in said.get("shapes", ()))
    return Entry(cause, shapes, at.regimes(said.get("regimes", ())), said.get("part", ""), said.get("rubs", False))


def _size(ranges: Ranges, *, per: str = "", unit: str = "1", **said: Any) -> Size:
    scale = SCALES[per](ranges)
    scaled = {key: said[key] * scale for key in ("sd", "low", "high")}
    return Size(said["name"], unit, said["doc"], **scaled)


def _shape(*, name: str, doc: str = "", prior: str = "", **bounds: float) -> Shape:
    return PRIORS.get(prior, Shape)(name, "1", doc or TABLE["words"][name], **bounds)


def scaled(
    at: Context,
    name: str,
    groups: Mapping[str, Paths] | None = None,
    law: Callable[[Num], Num] = ca.exp,
    **changes: Any,
) -> Iterator[Cause]:
    """A cause that is a factor on what all parts of a kind do, on what one of several does, or on all in a regime.

    Args:
        at: what it is made for
        name: in the table
        groups: part or place -> paths of its values; what parts declare for the cause if None, and no cause without
        law: factor of a size
        changes: what of the cause is not as in the table
    """
    known = entry(name, at)
    size, found = known.cause.size.name, at.roles.failing(name) if groups is None else groups
    laws = {part: factors(paths, size, law) for part, paths in found.items()}

    def every(theta: Theta, row: Row) -> Values:
        return {path: value for values in laws.values() for path, value in values(theta, row).items()}

    def limited(limit: Regime) -> Form:
        def values(theta: Theta, row: Row) -> Values:
            return every({**theta, size: theta[size] * limit.gate(theta, row, at.ranges)}, row)

        return Form(limit.name, shapes=limit.shapes(at.ranges), values=values, regime=limit.told)

    if laws:
        single = [Form(part, values=values) for part, values in laws.items()]
        yield known.with_forms(weighed([Form(values=every)], single, [limited(x) for x in known.regimes]), **changes)
