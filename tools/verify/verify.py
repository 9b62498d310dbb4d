"""Every published number of every machine, what the model gives for it, and the verdict."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import Any, TypeVar

from ...model.errors import GearheatError, Problems, ScenarioError
from ...model.sources import LawInfo, sources
from ...model.units import si_of
from ...scenarios.given import RigLike, scenario_of
from ...scenarios.published import Row, golden_rows, read_published
from ...scenarios.scenario import Scenario
from ...scenarios.shipped import list_rigs
from ..show.console import counting, write
from ..show.display import Display
from ..show.pages import page
from .model_values import RigValues, single
from .verdicts import HEAD, NOT_REPRODUCED, VERDICTS, Machine, Value, Verdict, counts, judge, kinds, lines

#: Draws up a machine that has `sizes`, from a name and the options of a name plate.
Draw = Callable[..., Any]
#: What makers say, beside machines of `gearheat new`.
CATALOGUES = Path(__file__).parent / "catalogues.toml"
A = TypeVar("A")
B = TypeVar("B")


class Plates:
    """Values of the rows of machines that are drawn up from name plates, each machine once."""

    name = "catalogues"

    def __init__(self, draw: Draw) -> None:
        self._draw = draw
        self._sizes: dict[str, Mapping[str, Any]] = {}

    def value(self, row: Row) -> Value:
        """What a machine gives for a row.

        Args:
            row: with run = "new", the options of the name plate in `set`
        """
        plate = repr(row.set)
        if plate not in self._sizes:
            self._sizes[plate] = self._draw("catalogue", **row.set).sizes
        return Value(single(row.path, self._sizes[plate].__getitem__), labelled=True)


#: Where the values of rows come from that no law gives.
Values = RigValues | Plates


@dataclass(frozen=True, eq=False, repr=False)
class Verification(Display):
    """Published numbers beside what the model gives.

    Attributes:
        machines: the rigs with their verdicts, and machines of `gearheat new` beside what catalogues say
        laws: verdicts on the golden rows of laws
    """

    machines: Sequence[Machine]
    laws: Sequence[Verdict]

    @cached_property
    def found(self) -> dict[str, Any]:
        """The JSON object."""
        every = [verdict for machine in self.machines for verdict in machine.verdicts] + list(self.laws)
        return {
            "schema": "gearheat.verify/1",
            "counts": counts(every),
            "kinds": kinds(every),
            "machines": [machine.as_dict() for machine in self.machines],
            "laws": {
                "counts": counts(self.laws),
                "kinds": kinds(self.laws),
                "rows": [{"law": v.row.law, **v.as_dict()} for v in self.laws],
            },
            "sources": _list_citations(verdict.row.where for verdict in every),
        }

    @property
    def failed(self) -> int:
        """Numbers that are not reproduced."""
        return int(self.found["counts"][NOT_REPRODUCED])

    @property
    def title(self) -> str:
        """What is shown."""
        return "Numbers by verdict and by kind"

    def table(self) -> tuple[Sequence[str], Sequence[Sequence[Any]]]:
        """Counts of each rig, of the laws and of all."""
        found = self.found
        named = [*((m["name"], m) for m in found["machines"] if m["rows"]), ("laws", found["laws"]), ("in all", found)]
        body = [[name, *part["counts"].values(), *part["kinds"].values()] for name, part in named]
        return ("", *VERDICTS, *found["kinds"]), body

    def details(self) -> Iterator[tuple[str, Sequence[str], Sequence[Sequence[Any]]]]:
        """Title, head and rows of the numbers of each rig, then of the laws."""
        for machine in self.machines:
            if machine.verdicts:
                yield f"{machine.name}: {machine.doc}", HEAD, lines(machine.verdicts)
        if self.laws:
            yield "Laws", HEAD, lines(self.laws)

    def remarks(self) -> Iterator[str]:
        """Rigs without published numbers, and by name what fails."""
        for machine in self.machines:
            if not machine.verdicts:
                yield f"{machine.name}: has no published numbers. {machine.reproduces}".strip()
        failed = [f"{m.name}: {v.row.name}" for m in self.machines for v in m.verdicts if v.verdict == NOT_REPRODUCED]
        failed += [f"{v.row.law}: {v.row.name}" for v in self.laws if v.verdict == NOT_REPRODUCED]
        if failed:
            numbers = "1 published number is" if len(failed) == 1 else f"{len(failed)} published numbers are"
            yield f"{numbers} not reproduced: {'; '.join(failed)}."

    def as_dict(self) -> dict[str, Any]:
        """The JSON object."""
        return self.found

    def report(self, path: str | Path) -> Path:
        """Write the HTML page.

        Args:
            path: file to write

        Raises:
            DataError: it cannot be written
        """
        write(Path(path), page("gearheat.tools.verify", "verify.html", found=self.found, verdicts=VERDICTS))
        return Path(path)


def verify(rig: RigLike | None = None, *, draw: Draw | None = None) -> Verification:
    """Published numbers of a rig and the laws it uses, or of all shipped rigs, all laws and catalogues.

    Args:
        rig: name, file or rig; all shipped rigs if None
        draw: what draws up machines from name plates, `gearheat.new`; without it what catalogues say is left out

    Raises:
        ScenarioError: everything wrong with the tables of published numbers at once

    Example:
        >>> import gearheat as gh
        >>> gh.verify("fzg_four_square").failed
        0
    """
    rigs = [RigValues(scenario_of(name)) for name in ([rig] if rig is not None else list_rigs())]
    rows = _each(_published_of, [values.scenario for values in rigs])
    laws = [row for row in golden_rows() if rig is None or law_of(row) in rigs[0].laws]
    makers = read_published(CATALOGUES) if rig is None and draw is not None else ()
    with counting("values", sum(map(len, rows)) + len(makers) + len(laws)) as advance:
        machines = _each(lambda pair: _machine(pair[0], pair[1], advance), list(zip(rigs, rows, strict=True)))
        if makers and draw is not None:
            doc, says = "machines of gearheat new beside what catalogues say", "Nothing: it is compared."
            told = tuple(map(_tell_losses, _judge_rows(makers, Plates(draw), advance)))
            machines.append(Machine("catalogues", doc, says, told, ()))
        return Verification(machines, _judge_rows(laws, None, advance))


def _tell_losses(verdict: Verdict) -> Verdict:
    """A verdict on an efficiency, with the losses over those that are published."""
    if verdict.row.unit != "%" or verdict.row.run != "new" or verdict.model is None or verdict.expected is None:
        return verdict
    return replace(verdict, why=f"losses {(100 - verdict.model) / (100 - verdict.expected):.2f} of those published")


def _each(work: Callable[[A], B], items: Sequence[A]) -> list[B]:
    """Work done on each item, or the problems of all of them."""
    found: list[B] = []
    problems = Problems()
    for item in items:
        with problems:
            found.append(work(item))
    problems.check()
    return found


def _published_of(scenario: Scenario) -> tuple[Row, ...]:
    """The published numbers beside a rig file; none where there is no such file."""
    path = scenario.path.parent / "published.toml"
    try:
        return read_published(path) if path.is_file() else ()
    except ScenarioError as error:
        raise ScenarioError([f"{scenario.name}: {problem}" for problem in error.problems]) from None


def _list_citations(places: Iterable[str]) -> dict[str, str]:
    """The sources whose keys stand in places such as "Dias2014, table 5.7": key -> author, year and title."""
    words = {word for place in places for word in re.findall(r"\w+", place)}
    return {key: s.cited for key, s in sources().items() if key in words}


def _machine(values: RigValues, rows: Sequence[Row], advance: Callable[[int], None]) -> Machine:
    scenario = values.scenario
    errata = tuple(e.model_dump() for e in scenario.errata)
    return Machine(scenario.name, scenario.doc, scenario.reproduces, _judge_rows(rows, values, advance), errata)


def _judge_rows(rows: Sequence[Row], rig: Values | None, advance: Callable[[int], None]) -> tuple[Verdict, ...]:
    """The verdict on each row; without a rig, on rows of laws alone. All that is wrong with them is told at once."""
    problems: list[str] = []
    known: dict[str, Verdict] = {}
    found = []
    for row in sorted(rows, key=lambda row: row.run == "rows"):  # they need the others
        if not known.keys() >= set(row.of.values()):  # what is wrong with the others is told
            continue
        try:
            verdict = judge(row, _value(row, rig, known))
            known[row.name] = verdict
            found.append((row, verdict))
        except GearheatError as error:
            problems += [p if p.startswith(row.name) else f"{row.name}: {p}" for p in error.problems]
        advance(1)
    if problems:
        where = f"{rig.name}: " if rig else ""
        raise ScenarioError([f"{where}{problem}" for problem in problems])
    order = {id(row): i for i, row in enumerate(rows)}
    return tuple(verdict for _, verdict in sorted(found, key=lambda pair: order[id(pair[0])]))


def _value(row: Row, rig: Values | None, known: Mapping[str, Verdict]) -> Value:
    """What the model, a law or arithmetic gives for a row."""
    if row.run == "law":
        return _law_value(row)
    if row.run in ("rows", "print"):
        return _from_rows(row, known)
    if rig is None:
        raise ScenarioError(f'run = "{row.run}" needs a rig.')
    if (row.run == "new") != isinstance(rig, Plates):
        raise ScenarioError(f'{row.name}: run = "{row.run}" has no place here; a name plate stands in catalogues.toml.')
    return rig.value(row)


def _from_rows(row: Row, known: Mapping[str, Verdict]) -> Value:
    """What an expression in other rows gives, or in printed numbers alone."""
    others = {name: known[other].model for name, other in row.of.items()}
    if lost := [row.of[name] for name, value in others.items() if value is None]:
        return Value(None, problem=f"no solution of: {', '.join(lost)}")

    def value_of(name: str) -> Any:
        if name not in others:
            raise ScenarioError(f'"{name}" is not among the names of the row ({", ".join(others) or "none"}).')
        return others[name]

    return Value(single(row.path, value_of), labelled=True)


def _law_value(row: Row) -> Value:
    arguments = {name: si_of(value) for name, value in row.args.items()}
    try:
        result = _function(row.law)(**arguments)
        return Value(float(result if row.item is None else result[row.item]))
    except (TypeError, IndexError) as error:
        raise ScenarioError(f"{row.law}: {error}.") from None


def law_of(row: Row) -> LawInfo | None:
    """What the law of a row declares."""
    return getattr(_function(row.law), "law", None)


def _function(name: str) -> Any:
    module, _, law = name.partition(".")
    try:
        return getattr(import_module(f"gearheat.model.laws.{module}"), law)
    except (ImportError, AttributeError):
        raise ScenarioError(f'there is no law "{name}". Write "module.function" of gearheat.model.laws.') from None
