"""documentation/index.html of an FMU: what it is, how to use it, what it computes and from which sources."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape

from gearheat.model.core.flat import FlatModel
from gearheat.model.sources import sources
from gearheat.model.units import text

from .description import TOLERANCE, tool
from .leading import Directions
from .parameter_set import kind_of
from .related import PARAMETERS
from .variables import IMPLICIT, RESIDUAL, STORED, SUPPLIED, THROUGHPUT, VALIDITY, Table, Variable


@dataclass(frozen=True)
class About:
    """What is known of a model beside its equations.

    Args:
        sources: parameter -> where its value is from
        uncertainties: parameter -> standard uncertainty of its value, in the unit of the value
        picture: the model drawn, as SVG
        idle: parameters of the model that the FMU lacks because they have no effect
        directions: of the standard deviations, where it has some
    """

    sources: Mapping[str, str] = field(default_factory=dict)
    uncertainties: Mapping[str, float] = field(default_factory=dict)
    picture: str = ""
    idle: tuple[str, ...] = ()
    directions: Directions | None = None


_STYLE = (
    "body{font:15px/1.5 sans-serif;max-width:80em;margin:2em auto;padding:0 1em;color:#222}"
    "table{border-collapse:collapse;margin:1em 0}td,th{text-align:left;padding:.2em .8em .2em 0;"
    "border-bottom:1px solid #ddd;vertical-align:top}code{background:#f3f3f3}svg{max-width:100%;height:auto}"
    ".scroll{overflow-x:auto}"
)

_USE = f"""
<p>The FMU serves FMI 2.0 co-simulation and model exchange on every platform whose binary it holds.
<code>sources/all.c</code> compiles with any C99 compiler and the C library alone.</p>
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
<p>The FMU serves FMI 3.0 co-simulation and model exchange on every platform whose binary it holds.
<code>sources/all.c</code> compiles with any C99 compiler, the C library and the headers of the standard.</p>
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
        f"<h2>Network</h2>\n<figure>{about.picture}</figure>" if about.picture else "",
        f"<h2>Use</h2>{_USE if fmi == 2 else _USE_3}\n<h2>Energy and validity</h2>",
        _INTEGRATED if table.audit else "",
        _BALANCE,
        implicit if flat.residual_names else "",
        _deviations(about.directions),
        *(_variables(title, table.of(kind)) for title, kind in _GROUPS),
        _parameters(table.of("parameter"), about),
        _choices(table.of("choice")),
        _laws(flat),
        _ranges(flat),
        _cited(flat, about),
        _verification(flat, checks),
        "</body></html>\n",
    ]
    return "\n".join(part for part in parts if part)


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
linear in the parameters. Not contained are the uncertainty of inputs, of start temperatures without a row, of the laws'
own form, and of parameters without a row, and the error of the solver. There is no model exchange and no derivative of
a standard deviation.</p>
"""


def _deviations(directions: Directions | None) -> str:
    """What the standard deviations contain and what not."""
    if directions is None:
        return ""
    rows = [
        (escape(r.name), ", ".join(f"<code>{escape(path)}</code> {change:+.3g}" for path, change in r.changes.items()))
        for r in directions.reasons
    ]
    short, left_out = directions.shortfall, ""
    if short is not None:
        left_out = (
            f" For what is left out no deviation is ever more than {short:.1%} too small in the default experiment."
        )
    kept = f"<p>Of {len(rows)} rows {directions.count} combinations are integrated, those that move most.{left_out}</p>"
    return _table("Uncertainty", ("reason", "change of the parameters (SI)"), rows, before=_DEVIATIONS + kept)


def _cells(v: Variable) -> tuple[str, ...]:
    return (
        f"<code>{escape(v.name)}</code>",
        escape(v.quantity.unit),
        "" if v.start is None else escape(text(v.start, v.quantity.unit)),
        escape(v.range_text if v.range_text != "finite" else ""),
        escape(v.quantity.doc),
    )


_HEAD = ("name", "unit", "start", "range in that unit", "meaning")


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
    unit = v.quantity.unit.removesuffix("(difference)").strip()
    return escape(f"{known[v.name]:.3g} {unit}".removesuffix(" 1")) if v.name in known else ""


def _verification(flat: FlatModel, checks: Sequence[tuple[str, str]]) -> str:
    compared = sum(law.verified for law in flat.laws)
    own = [("laws that reproduce numbers printed in their source", f"{compared} of {len(flat.laws)}")]
    rows = [(escape(what), escape(found)) for what, found in (*(own if flat.laws else ()), *checks)]
    return _table("Verification", ("what was checked", "result"), rows, before=_VERIFIED)


def _laws(flat: FlatModel) -> str:
    rows = []
    for law in flat.laws:
        checked = "" if law.verified else "not compared with a printed number"
        rows.append(tuple(escape(cell) for cell in (law.name, law.source, law.where, law.valid, checked)))
    return _table("Laws", ("law", "source", "place", "valid for", ""), rows)


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
    return f"<h2>{title}</h2>{before}\n{table}"
