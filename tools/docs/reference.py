"""The reference, written from the code: part types, laws, rig file, card, units, catalogues, rigs, causes."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import re
import shutil
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache
from importlib.resources import files
from itertools import groupby
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from ...model import laws
from ...model.files import tables
from ...model.machines.roles import Roles
from ...model.parts import PARTS
from ...model.sources import LawInfo, sources
from ...model.units import PER_MINUTE, ROTATIONS, SPELLINGS
from ...scenarios import load as loading
from ...scenarios.entries import catalogue
from ...scenarios.load import load
from ...scenarios.measured.card import read_card
from ...scenarios.measured.lubrication import oils_of
from ...scenarios.measured.read import read_campaign
from ...scenarios.measured.write import as_toml, default_card
from ...scenarios.nuisances import usual_priors
from ...scenarios.published import golden_rows
from ...scenarios.shipped import FILES, RIGS, list_rigs
from ...scenarios.tables import CampaignTable, ErratumTable, RigTable, SensorTable
from ..describe.parts import describe_part
from ..diagnose.library.cause import Cause
from ..diagnose.library.registry import library
from ..diagnose.setting import ranges_of

#: What the pages tell of, and settings of the web site.
TABLES: dict[str, Any] = tables("tools.docs", "docs.toml")
MATH = re.compile(r"^\.\. math::[ \n]*((?:.+\n?)+?)(?:\n|\Z)", re.MULTILINE)
#: Where the pages of the contact solver and of the reference methods stand.
CONTACT = Path(str(files("gearheat.model.contact")))
#: Folder of the reference methods.
METHODS = Path(str(files("gearheat.tools.rating")))

BLOCK = re.compile(r"^```\{(laws|ranges|evidence)\} *(.*)\n```$", re.MULTILINE)

Law = Callable[..., Any]


def words(value: Any) -> str:
    """A value as words of a page: nothing in it is markup but text between backticks."""
    text = ", ".join(map(str, value)) if isinstance(value, list | tuple) else str(value)
    parts = re.split(r"(`[^`]*`)", " ".join(text.split()))
    return "".join(re.sub(r"(\|)" if k % 2 else r"([*<\[\]|])", r"\\\1", part) for k, part in enumerate(parts))


def code(value: Any) -> str:
    """A name or a value as code; nothing for nothing."""
    text = str(value).replace("|", "\\|")
    return f"`{text}`" if text else ""


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table, nothing where it has no rows."""
    lines = [f"| {' | '.join(row)} |" for row in rows]
    return "\n".join([f"| {' | '.join(head)} |", f"|{'---|' * len(head)}", *lines]) + "\n\n" if lines else ""


def listing(lines: Sequence[Mapping[str, Any]], keys: Sequence[str]) -> str:
    """A table of dictionaries, columns in which all are empty left out; names are code.

    Args:
        lines: the rows
        keys: the columns
    """
    kept = [key for key in keys if any(str(line[key]) for line in lines)]
    shown = ((code(line[key]) if key == "name" else words(line[key]) for key in kept) for line in lines)
    return table([key.replace("_", " ") for key in kept], [list(row) for row in shown])


def fenced(language: str, text: str) -> str:
    """A block of code."""
    return f"```{language}\n{text.rstrip()}\n```\n\n"


def docstring(of: Any) -> str:
    """What a docstring says before its arguments, its formulas as formulas."""
    text = re.split(r"^(?:Args|Returns|Raises):$", inspect.getdoc(of) or "", maxsplit=1, flags=re.MULTILINE)[0]
    pieces = MATH.split(text)
    shown = [fenced("{math}", p) if k % 2 else "\n\n".join(map(words, p.split("\n\n"))) for k, p in enumerate(pieces)]
    return "\n\n".join(piece.strip() for piece in shown if piece.strip()) + "\n\n"


def list_arguments(of: Any) -> list[tuple[str, str]]:
    """The arguments that a docstring tells, with what it says of them."""
    told = (inspect.getdoc(of) or "").partition("Args:\n")[2].partition("\n\n")[0]
    return re.findall(r"^    (\w[\w, ]*): (.*(?:\n {5,}.*)*)", told, re.MULTILINE)


def arguments(of: Any) -> str:
    """The arguments that a docstring tells, as a list."""
    found = list_arguments(of)
    return "".join(f"- `{name}`: {words(text)}\n" for name, text in found) + "\n" if found else ""


@cache
def _templates() -> Environment:
    found = Environment(
        loader=PackageLoader("gearheat.tools.docs"), undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    found.filters |= {"words": words, "code": code, "doc": inspect.getdoc}
    found.globals |= {f.__name__: f for f in (fenced, listing, docstring, arguments)}
    return found


def page(name: str, /, **values: Any) -> str:
    """A page by its template.

    Args:
        name: of the template
        values: what it asks for
    """
    return f"{_templates().get_template(f'{name}.md.jinja').render(values).rstrip()}\n"


def pages() -> Iterator[tuple[str, str]]:
    """Path below the folder of generated pages, and text, of every page."""
    yield "parts/index.md", page("parts", parts=PARTS)
    for kind in PARTS:
        yield f"parts/{kind}.md", page("part", kind=kind, part=describe_part(kind), lists=TABLES["lists"])
    yield from _laws()
    yield "rig_file.md", _rig_file()
    scenario = load("helical_two_stage")
    yield "card_file.md", page("card_file", card=as_toml(default_card(scenario, usual_priors(scenario))))
    turns = _group({**PER_MINUTE, **ROTATIONS})
    yield "units.md", page("units", spellings=_group(SPELLINGS), turns=turns)
    yield "catalogues.md", page("catalogues", catalogues={kind: catalogue(kind) for kind in FILES})
    yield "causes.md", page("causes", causes=_causes())
    rigs, reproduces = list_rigs(), list_rigs("reproduces")
    yield "rigs/index.md", page("rigs", rigs=rigs, reproduces=reproduces)
    for name, doc in rigs.items():
        own = RIGS / name / "README.md"
        written = page("rig", name=name, doc=doc, reproduces=reproduces[name])
        yield f"rigs/{name}.md", own.read_text(encoding="utf-8") if own.exists() else written


def copy_pictures(place: Path) -> None:
    """Put pages that stand beside their code, and what the pages of rigs show, where the generated pages are."""
    shutil.copy(CONTACT / "README.md", place / "contacts.md")
    shutil.copytree(CONTACT / "verification", place / "verification")
    rows = place / "verification" / "verification.md"
    rows.write_text(f"---\norphan: true\n---\n\n{rows.read_text(encoding='utf-8')}", encoding="utf-8")
    shutil.copy(METHODS / "README.md", place / "iso14179.md")
    for picture in (p for kind in ("*/*.svg", "*/*.png") for p in RIGS.glob(kind)):
        shutil.copy(picture, place / "rigs")


def _laws() -> Iterator[tuple[str, str]]:
    rows, titles = Counter(row.law for row in golden_rows()), {name: title(name) for name in law_modules()}
    for name, heading in titles.items():
        about = inspect.getdoc(importlib.import_module(f"{laws.__name__}.{name}"))
        own: list[tuple[Any, dict[str, str]]] = [
            (f, facts(info(f), rows[f"{name}.{f.__name__}"])) for f in laws_of(name)
        ]
        yield f"laws/{name}.md", page("law_module", title=heading, about=about, laws=own)
    yield "laws/index.md", page("laws", titles=titles, sources=sources().values())


def _rig_file() -> str:
    text, _, example = (inspect.getdoc(loading) or "").partition("\n\n")
    example, _, rest = example.partition("\n\nA source is")
    models = (RigTable, SensorTable, CampaignTable, ErratumTable)
    return page("rig_file", text=text, example=inspect.cleandoc(example), rest=rest, models=models)


def _group(spellings: dict[str, str]) -> list[tuple[str, list[str]]]:
    return [(unit, list(same)) for unit, same in groupby(spellings, key=lambda s: spellings[s])]


def _causes() -> Sequence[Cause]:
    """Those of the measured campaign that comes with gearheat."""
    scenario = load("planetary")
    folder = RIGS / "planetary"
    card = read_card(folder / "card.json")
    data = read_campaign(folder / "measured.csv", scenario, card)
    roles = Roles.of(scenario.spec)
    oils = oils_of(scenario, card, list(data.oil))
    ranges = ranges_of(scenario.spec, roles, data, oils, scenario.operating_point)
    return library(roles, ranges, data.sensors)


def fill_blocks(text: str) -> str:
    """A page with what its blocks ask for.

    | block | what it becomes |
    |---|---|
    | `{laws} MODULE, ...` | the equations of all laws of these modules |
    | `{ranges}` | every range that a law declares |
    | `{evidence}` | by module, how many laws were compared with print, and how many rows are from print |
    """
    return BLOCK.sub(_block, text)


def law_modules() -> list[str]:
    """Names of the modules of laws, those without a law left out."""
    return [module.name for module in pkgutil.iter_modules(laws.__path__) if list(laws_of(module.name))]


def laws_of(module: str) -> Iterator[Law]:
    """The laws of a module of `model.laws` in the order of its file."""
    found = importlib.import_module(f"{laws.__name__}.{module}")
    yield from (f for f in vars(found).values() if hasattr(f, "law") and f.__module__ == found.__name__)


def title(module: str) -> str:
    """What a module is about: its first sentence, or what stands before its colon."""
    about = words(inspect.getdoc(importlib.import_module(f"{laws.__name__}.{module}")))
    return re.split(r"\.(?: |$)|: ", about, maxsplit=1)[0]


def facts(law: LawInfo, rows: int) -> dict[str, str]:
    """Source, validity, ranges and comparisons of a law, by what they are.

    Args:
        law: the law
        rows: number of its golden rows
    """
    compared = f"{rows} golden rows{'' if law.verified else ', none of them from print'}" if rows else "with no row"
    ranges = "; ".join(f"{name} from {low:.4g} to {high:.4g}" for name, (low, high) in law.ranges.items())
    return {"Source": f"{law.source}, {law.where}", "Valid": law.valid, "Range, in SI": ranges, "Compared": compared}


def info(law: Law) -> LawInfo:
    """What a law declares."""
    return law.law  # type: ignore[attr-defined, no-any-return]


def _block(match: re.Match[str]) -> str:
    kind, asked = match.groups()
    if kind == "ranges":
        return _ranges()
    if kind == "evidence":
        return _evidence()
    rows = Counter(row.law for row in golden_rows())
    modules = asked.split(", ")
    return "".join(_equation(name, law, rows[f"{name}.{law.__name__}"]) for name in modules for law in laws_of(name))


def _link(module: str, law: Law) -> str:
    return f"[{law.__name__}](../generated/laws/{module}.md#{law.__name__.replace('_', '-')})"


def _equation(module: str, law: Law, rows: int) -> str:
    physics = {p.name for p in inspect.signature(law).parameters.values() if p.kind == p.POSITIONAL_OR_KEYWORD}
    symbols = "; ".join(f"`{key}` {words(text)}" for key, text in list_arguments(law) if key in physics)
    about = ". ".join(f"{key}: {words(value)}" for key, value in facts(info(law), rows).items() if value)
    return f"**{_link(module, law)}**: {docstring(law)}{symbols}\n\n*{about}.*\n\n"


def _ranges() -> str:
    rows = [
        (_link(module, law), code(name), f"{low:.4g}", f"{high:.4g}", words(info(law).regimes.get(name, "")))
        for module in law_modules()
        for law in laws_of(module)
        for name, (low, high) in info(law).ranges.items()
    ]
    return table(("law", "argument", "from", "to", "beyond"), rows)


def _evidence() -> str:
    kinds = Counter((row.law, row.recomputed is None) for row in golden_rows())
    rows = []
    for module in law_modules():
        found = list(laws_of(module))
        counts = (sum(kinds[f"{module}.{law.__name__}", printed] for law in found) for printed in (True, False))
        compared = sum(info(law).verified for law in found)
        rows.append((f"[{title(module)}](../generated/laws/{module}.md)", *map(str, (len(found), compared, *counts))))
    return table(("laws on", "laws", "with print", "rows from print", "recomputed rows"), rows)
