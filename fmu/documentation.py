"""documentation/index.html of an FMU: what it is, how to use it, what it computes and from which sources."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from math import isfinite
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined, Template
from markupsafe import Markup

from ..model.core.flat import FlatModel
from ..model.sources import sources
from . import variables as names
from .description import TOLERANCE, tool
from .leading import Directions
from .parameter_set import kind_of
from .related import PARAMETERS
from .units import Display, fmi_unit, is_difference, unit as unit_of
from .variables import Table, Variable


@dataclass(frozen=True)
class PartText:
    """A part of the model as people read of it.

    Attributes:
        name, doc: of the part
        equations: what each says, and its formula
        laws: names of the laws in them
    """

    name: str
    doc: str
    equations: Sequence[tuple[str, str]]
    laws: Sequence[str] = ()


@dataclass(frozen=True)
class About:
    """What is known of a model beside its equations.

    Args:
        sources: parameter -> where its value is from
        uncertainties: parameter -> standard uncertainty of its value, in the unit of the value
        figures: title -> the model or a run of it drawn as SVG
        parts: what it is made of
        idle: parameters of the model that the FMU lacks because they have no effect
        directions: of the standard deviations, where it has some
        with_sources: whether the FMU holds its C source
    """

    sources: Mapping[str, str] = field(default_factory=dict)
    uncertainties: Mapping[str, float] = field(default_factory=dict)
    figures: Mapping[str, str] = field(default_factory=dict)
    parts: Sequence[PartText] = ()
    idle: tuple[str, ...] = ()
    directions: Directions | None = None
    with_sources: bool = True


#: What is said of a law whose source prints no number to compare it with.
_UNVERIFIED = "not compared with a printed number"

#: Title of the table of each kind of variable that has the plain columns.
_GROUPS = (
    ("Inputs", "input"),
    ("Outputs", "output"),
    ("Standard deviations", "deviation"),
    ("States", "state"),
)


def documentation(
    flat: FlatModel, table: Table, about: About | None = None, checks: Sequence[tuple[str, str]] = (), *, fmi: int = 2
) -> str:
    """The page of an FMU.

    Args:
        flat: the model
        table: its variables
        about: what else is known of it
        checks: what was checked with this very FMU, and the result
        fmi: version of the standard it serves, 2 or 3
    """
    about = about or About()
    parameters, choices = table.of("parameter"), table.of("choice")
    sourced = bool(about.sources or about.uncertainties)
    return _template().render(
        name=flat.name,
        doc=flat.doc,
        tool=tool(),
        about=about,
        fmi=fmi,
        names=names,
        tolerance=f"{TOLERANCE:g}",
        audit=table.audit,
        implicit=bool(flat.residual_names),
        **_deviations(about.directions, table),
        variables={title: [_cells(v) for v in table.of(kind)] for title, kind in _GROUPS},
        sourced=sourced,
        parameters=[(*_cells(v), *_origin(v, about)) if sourced else _cells(v) for v in parameters],
        kinds=_kinds(parameters, about.sources),
        parameter_set=PARAMETERS,
        choices=choices,
        items=[
            (v.name, k, i.name, i.doc) for v in choices for k, i in enumerate(v.choice.items if v.choice else (), 1)
        ],
        laws=[(w.name, w.formula, w.source, w.where, w.valid, "" if w.verified else _UNVERIFIED) for w in flat.laws],
        # a part may use a law several times
        ranges=list(
            dict.fromkeys((c.component, c.law.name, c.argument, f"{c.low:g} .. {c.high:g}") for c in flat.checks)
        ),
        cited=_list_citations(flat, about),
        checks=[*_list_comparisons(flat), *checks],
    )


def _template() -> Template:
    page = Environment(
        loader=PackageLoader("gearheat.fmu"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        extensions=["jinja2.ext.do"],
        finalize=_escape,
    )
    page.filters["place"] = lambda title: re.sub("[^a-z]+", "-", title.lower())
    return page.get_template("documentation.html")


def _escape(value: object) -> Markup:
    """A value as HTML with the entities of the standard library, so that pages do not change with those of Jinja."""
    return value if isinstance(value, Markup) else Markup(escape(str(value)))


def _deviations(directions: Directions | None, table: Table) -> dict[str, Any]:
    """What each reason of the standard deviations changes, and how much of them is left out at most."""
    if directions is None:
        return {"reasons": [], "shortfall": ""}
    known = {v.name: v for v in table}

    def signed(path: str, change: float) -> str:
        return f"{'-' if change < 0 else '+'}{_difference(abs(change), known[path])}"

    reasons = [(r.name, [(path, signed(path, by)) for path, by in r.changes.items()]) for r in directions.reasons]
    return {"reasons": reasons, "shortfall": "" if directions.shortfall is None else f"{directions.shortfall:.1%}"}


def _display(v: Variable) -> Display:
    """The unit that values of a variable are told in: the displayUnit of the description, else the unit itself."""
    unit = fmi_unit(v.quantity.unit)
    own = Display("" if unit == "1" else unit, 1.0)
    return own if is_difference(v.quantity.unit) else unit_of(unit).display(abs(v.start or v.quantity.nominal)) or own


def _value(value: float, v: Variable) -> str:
    shown = _display(v)
    return f"{shown.factor * value + shown.offset:.6g} {shown.name}".rstrip()


def _difference(value: float, v: Variable) -> str:
    """A difference of two values: no offset of a unit, and kelvin, touches it."""
    shown = _display(v)
    factor, name = (1.0, fmi_unit(v.quantity.unit)) if shown.offset else (shown.factor, shown.name)
    return f"{factor * value:.3g} {name}".rstrip()


def _range(v: Variable) -> str:
    """The values allowed, in words."""
    q, ends = v.quantity, []
    if isfinite(q.low):
        ends.append(f"{'above' if q.low_open else 'from'} {_value(q.low, v)}")
    if isfinite(q.high):
        ends.append(f"{'below' if q.high_open else 'to'} {_value(q.high, v)}")
    return " ".join(ends)


def _cells(v: Variable) -> tuple[str, ...]:
    start = "" if v.start is None else _value(v.start, v)
    return (v.name, v.quantity.unit, start, _range(v), v.quantity.doc)


def _origin(v: Variable, about: About) -> tuple[str, str]:
    """Standard uncertainty of a parameter and the source of its value."""
    known = about.uncertainties.get(v.name)
    return ("" if known is None else _difference(known, v), about.sources.get(v.name, ""))


def _kinds(parameters: Sequence[Variable], sources: Mapping[str, str]) -> str:
    """How many values are from each kind of source."""
    count = Counter(kind_of(sources[v.name]) for v in parameters if v.name in sources)
    count["without a source"] = len(parameters) - count.total()
    return ", ".join(f"{number} {kind}" for kind, number in sorted(count.items()) if number)


def _list_citations(flat: FlatModel, about: About) -> list[tuple[object, ...]]:
    """What the keys stand for that laws and values cite."""
    keys = {law.source for law in flat.laws} | {text.partition(",")[0].strip() for text in about.sources.values()}
    return [(s.key, s.author, s.year, s.title, s.where) for key, s in sorted(sources().items()) if key in keys]


def _list_comparisons(flat: FlatModel) -> list[tuple[str, str]]:
    compared = sum(law.verified for law in flat.laws)
    said = f"{compared} of {len(flat.laws)}"
    return [("laws that reproduce numbers printed in their source", said)] if flat.laws else []
