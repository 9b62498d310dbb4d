"""documentation/index.html of an FMU: what it is, how to use it, what it computes and from which sources."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from math import isfinite

from ..model.core.flat import FlatModel
from ..model.sources import sources
from .description import TOLERANCE, tool
from .leading import Directions
from .parameter_set import kind_of
from .related import PARAMETERS
from .units import Display, fmi_unit, is_difference
from .units import unit as unit_of
from .variables import IMPLICIT, RESIDUAL, STORED, SUPPLIED, THROUGHPUT, VALIDITY, Table, Variable


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


_STYLE = (
    "body{font:15px/1.5 sans-serif;max-width:80em;margin:2em auto;padding:0 1em;color:#222}"
    "table{border-collapse:collapse;margin:1em 0}td,th{text-align:left;padding:.2em .8em .2em 0;"
    "border-bottom:1px solid #ddd;vertical-align:top}code{background:#f3f3f3}svg{max-width:100%;height:auto}"
    ".scroll{overflow-x:auto}"
)

_USE = f"""
<ul>
<li>Set inputs, parameters and states in any order before initialization ends. Inputs and parameters may change later.
A value that is not finite or out of its range is refused, and the message names the variable.</li>
<li>Any communication step is allowed; the error is controlled inside: one internal step may be wrong by the tolerance
times the nominal of a state. The tolerance is {TOLERANCE:g} unless <code>fmi2SetupExperiment</code> gives one.</li>
<li>An input moves with the slope last given by <code>fmi2SetRealInputDerivatives</code> until another is given; without
one it is held. Slopes pay: the error of long steps falls by orders of magnitude.</li>
<li>A step that cannot be computed is refused and changes nothing: <code>fmi2Discard</code> if a shorter one would do,
<code>fmi2Error</code> if none would.</li>
<li>States can be saved, restored and serialized; directional derivatives of outputs and derivatives are exact.</li>
</ul>
"""

_USE_3 = f"""
<ul>
<li>Set inputs, parameters and states in any order before initialization ends. Inputs and parameters may change later.
A value that is not finite or out of its range is refused, and the message names the variable.</li>
<li>Any communication step is allowed; the error is controlled inside: one internal step may be wrong by the tolerance
times the nominal of a state. The tolerance is {TOLERANCE:g} unless <code>fmi3EnterInitializationMode</code> gives
one.</li>
<li>Inputs are held over a communication step. Event mode may be used in co-simulation and brings nothing that a value
set in step mode does not. No step ends early.</li>
<li>A step that cannot be computed is refused and changes nothing: <code>fmi3Discard</code> if a shorter one would do,
<code>fmi3Error</code> if none would.</li>
<li>States can be saved, restored and serialized; directional and adjoint derivatives of outputs and derivatives are
exact. <code>terminalsAndIcons/terminalsAndIcons.xml</code> says which variables belong to a shaft end or a heat
port.</li>
</ul>
"""

_INTEGRATED = f"""
<p>The energy of each run can be audited: <code>{SUPPLIED}</code> is the integral of the power across the boundary,
<code>{STORED}</code> the energy of the states, and both grow by the same amount; judge a difference by
<code>{THROUGHPUT}</code>.</p>
"""

_BALANCE = f"""
<p><code>{RESIDUAL}</code> is the violation of the balance of energy by the equations themselves, and is zero but for
round-off. <code>{VALIDITY}</code> counts the law arguments outside the range of their source; which they
are is told once each in the log category <code>logStatusWarning</code>.</p>
"""


_VERIFIED = """
<p>The programs of the project check every release: the laws against numbers printed in their sources, every part for
conservation of energy, the runs against closed forms and other integrators, the FMU against the rules of the standard,
with FMPy and with an importer in C, in all call orders, with saved states, and against the model it was made from.</p>
"""


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
    implicit = f"<p><code>{IMPLICIT}</code> is what the implicit equations leave, in units of their typical size.</p>"
    parts = [
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width">',
        f"<title>{escape(flat.name)}</title>",
        f"<style>{_STYLE}</style></head><body>\n<h1>{escape(flat.name)}</h1>\n<p>{escape(flat.doc)}</p>",
        f"<p>Made by {escape(tool())}.</p>",
        *(f"{heading(title)}\n<figure>{svg}</figure>" for title, svg in about.figures.items()),
        heading("Use") + _serves(table, about, fmi) + (_USE if fmi == 2 else _USE_3) + heading("Energy and validity"),
        _INTEGRATED if table.audit else "",
        _BALANCE,
        implicit if flat.residual_names else "",
        _deviations(about.directions, table),
        *(_variables(title, table.of(kind)) for title, kind in _GROUPS),
        _parameters(table.of("parameter"), about),
        _choices(table.of("choice")),
        _parts(about.parts),
        _laws(flat),
        _ranges(flat),
        _cited(flat, about),
        _verification(flat, checks),
        "</body></html>\n",
    ]
    parts.insert(_HEAD_PARTS, _contents(parts))
    return "\n".join(part for part in parts if part)


def _serves(table: Table, about: About, fmi: int) -> str:
    """The interfaces it has, and how its source is compiled where it holds that."""
    kinds = "co-simulation" if table.of("deviation") else "co-simulation and model exchange"
    needed = "and the C library alone" if fmi == 2 else ", the C library and the headers of the standard"
    code = f"\n<code>sources/all.c</code> compiles with any C99 compiler {needed}.".replace(" ,", ",")
    told = f"The FMU serves FMI {fmi}.0 {kinds} on every platform whose binary it holds."
    return f"\n<p>{told}{code if about.with_sources else ''}</p>"


#: What stands before the list of contents: head, style, title, the program that made it.
_HEAD_PARTS = 5


def heading(title: str) -> str:
    """The heading of a section, which the list of contents leads to.

    Args:
        title: as it is read
    """
    return f'<h2 id="{re.sub("[^a-z]+", "-", title.lower())}">{escape(title)}</h2>'


def _contents(parts: Iterable[str]) -> str:
    found = re.findall(r'<h2 id="(.+?)">(.+?)</h2>', "\n".join(parts))
    links = "".join(f'<li><a href="#{place}">{title}</a></li>' for place, title in found)
    return f"<nav><ul>{links}</ul></nav>"


_GROUPS = (
    ("Inputs", "input"),
    ("Outputs", "output"),
    ("Standard deviations", "deviation"),
    ("States", "state"),
)

_DEVIATIONS = """
<p>A variable whose name ends in <code>.sd</code> is the standard deviation of the variable it is named after, due to
the uncertain parameters of this table. The table gives what one standard deviation changes each parameter by. Rows are
independent of each other; the parameters of a row change together. Parameters set to other values keep their relative
uncertainty.</p>
<p>Sensitivities along the run are integrated with the model, so what has happened before counts. Contained is what is
linear in the parameters: while a thermostat opens, or another switch moves, a deviation may be far too small.
Not contained are the uncertainty of inputs, of start temperatures without a row, of the laws' own form, and of
parameters without a row, and the error of the solver. There is no model exchange and no derivative of a standard
deviation.</p>
"""


def _deviations(directions: Directions | None, table: Table) -> str:
    """What the standard deviations contain and what not."""
    if directions is None:
        return ""
    known = {v.name: v for v in table}

    def told(path: str, change: float) -> str:
        sign = "-" if change < 0 else "+"
        return f"<code>{escape(path)}</code> {sign}{escape(_difference(abs(change), known[path]))}"

    rows = [(escape(r.name), ", ".join(told(*each) for each in r.changes.items())) for r in directions.reasons]
    short, left_out = directions.shortfall, ""
    if short is not None:
        left_out = (
            f" For what is left out no deviation is ever more than {short:.1%} too small in the default experiment."
        )
    kept = f"<p>Of {len(rows)} rows {directions.count} combinations are integrated, those that move most.{left_out}</p>"
    return _table("Uncertainty", ("reason", "change of the parameters"), rows, before=_DEVIATIONS + kept)


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
    return (f"<code>{escape(v.name)}</code>", *map(escape, (v.quantity.unit, start, _range(v), v.quantity.doc)))


_HEAD = ("name", "unit of the FMU", "start", "range", "meaning")


def _variables(title: str, variables: Iterable[Variable]) -> str:
    return _table(title, _HEAD, [_cells(v) for v in variables])


def _parameters(variables: Sequence[Variable], about: About) -> str:
    """Parameters with what is known of their values, and those that are left out."""
    if not about.sources and not about.uncertainties:
        shown = _variables("Parameters", variables)
    else:
        rows = [
            (*_cells(v), _uncertainty(v, about.uncertainties), escape(about.sources.get(v.name, ""))) for v in variables
        ]
        shown = _table("Parameters", (*_HEAD, "standard uncertainty", "source"), rows)
        count = Counter(kind_of(about.sources[v.name]) for v in variables if v.name in about.sources)
        count["without a source"] = len(variables) - count.total()
        told = ", ".join(f"{number} {kind}" for kind, number in sorted(count.items()) if number)
        shown += f"\n<p>Values by kind of source: {told}. <code>{PARAMETERS}</code> says the same for programs.</p>"
    if about.idle:
        names = ", ".join(f"<code>{escape(name)}</code>" for name in about.idle)
        shown += f"\n<p>Without effect on anything this FMU shows, and therefore no parameters of it: {names}.</p>"
    return shown


def _choices(variables: Iterable[Variable]) -> str:
    rows = [
        (f"<code>{escape(v.name)}</code>", str(k), escape(item.name), escape(item.doc))
        for v in variables
        for k, item in enumerate(v.choice.items if v.choice else (), 1)
    ]
    told = [f"<p><code>{escape(v.name)}</code>: {escape(v.quantity.doc)}.</p>" for v in variables]
    return _table("Choices", ("name", "value", "item", "meaning"), rows, before="\n".join(told))


def _uncertainty(v: Variable, known: Mapping[str, float]) -> str:
    return escape(_difference(known[v.name], v)) if v.name in known else ""


def _parts(parts: Sequence[PartText]) -> str:
    """The equations of every part."""
    if not parts:
        return ""
    shown = [heading("Parts and their equations"), _READING]
    for part in parts:
        rows = [f"<tr><td>{escape(says)}</td><td><code>{escape(how)}</code></td></tr>" for says, how in part.equations]
        laws = f"<p>Laws: {escape(', '.join(part.laws))}.</p>" if part.laws else ""
        shown.append(
            f"<h3><code>{escape(part.name)}</code></h3>\n<p>{escape(part.doc)}</p>\n"
            f'<div class="scroll"><table>{"".join(rows)}</table></div>{laws}'
        )
    return "\n".join(shown)


_READING = """
<p>Every quantity belongs to the part; <code>f</code> of some quantities stands for what the laws below the equations
make of them, whose formulas are in the section on laws. <code>sq</code> is the square. Flows are positive into the
part.</p>
"""


def _verification(flat: FlatModel, checks: Sequence[tuple[str, str]]) -> str:
    compared = sum(law.verified for law in flat.laws)
    own = [("laws that reproduce numbers printed in their source", f"{compared} of {len(flat.laws)}")]
    rows = [(escape(what), escape(found)) for what, found in (*(own if flat.laws else ()), *checks)]
    return _table("Verification", ("what was checked", "result"), rows, before=_VERIFIED)


def _laws(flat: FlatModel) -> str:
    rows = []
    for law in flat.laws:
        checked = "" if law.verified else "not compared with a printed number"
        told = [escape(cell) for cell in (law.name, law.source, law.where, law.valid, checked)]
        rows.append((told[0], f"<code>{escape(law.formula)}</code>" if law.formula else "", *told[1:]))
    return _table("Laws", ("law", "formula (LaTeX)", "source", "place", "valid for", ""), rows)


def _cited(flat: FlatModel, about: About) -> str:
    """What the keys stand for that laws and values cite."""
    keys = {law.source for law in flat.laws} | {text.partition(",")[0].strip() for text in about.sources.values()}
    found = [source for key, source in sorted(sources().items()) if key in keys]
    rows = [tuple(map(escape, (s.key, s.author, str(s.year), s.title, s.where))) for s in found]
    return _table("Sources", ("key", "author", "year", "title", "published in"), rows)


def _ranges(flat: FlatModel) -> str:
    rows = [
        (escape(c.component), escape(c.law.name), escape(c.argument), f"{c.low:g} .. {c.high:g}") for c in flat.checks
    ]
    once = list(dict.fromkeys(rows))  # a part may use a law several times
    return _table("Ranges that are watched", ("component", "law", "argument", "range (SI)"), once)


def _table(title: str, head: tuple[str, ...], rows: Sequence[tuple[str, ...]], before: str = "") -> str:
    if not rows and not before:
        return ""
    cells = "".join("<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>\n" for row in rows)
    line = "".join(f"<th>{h}</th>" for h in head)
    table = f'<div class="scroll"><table><tr>{line}</tr>\n{cells}</table></div>' if rows else ""
    return f"{heading(title)}{before}\n{table}"
