"""The reference, written from the code: part types, laws, rig file, card, units, catalogues, rigs, causes."""

from __future__ import annotations

import importlib
import inspect
import shutil
from collections import Counter
from collections.abc import Callable, Iterator
from importlib.resources import files
from itertools import groupby
from pathlib import Path
from typing import Any

from ...diagnose.library.nuisances import usual_priors
from ...diagnose.library.registry import library
from ...diagnose.model.ranges import ranges_of
from ...model import laws
from ...model.machines.roles import Roles
from ...model.parts import PARTS
from ...model.sources import LawInfo, sources
from ...model.units import PER_MINUTE, ROTATIONS, SPELLINGS, UNCLEAR
from ...scenarios import load as loading
from ...scenarios.entries import catalogue
from ...scenarios.golden import golden_rows
from ...scenarios.load import load
from ...scenarios.measured.card import read_card
from ...scenarios.measured.lubrication import oils_of
from ...scenarios.measured.read import read_campaign
from ...scenarios.measured.write import as_toml, default_card
from ...scenarios.shipped import FILES, RIGS, list_rigs
from ...scenarios.tables import CampaignTable, ErratumTable, RigTable, SensorTable, Strict
from ..describe.parts import described
from .laws import facts, law_modules, laws_of, title
from .markdown import arguments, code, docstring, fenced, listing, table, words

#: Where the pages of the contact solver and of the reference methods stand.
CONTACT, METHODS = (Path(str(files(f"gearheat.{name}"))) for name in ("model.contact", "tools.rating"))


def pages() -> Iterator[tuple[str, str]]:
    """Path below the folder of generated pages, and text, of every page."""
    yield from _parts()
    yield from _laws()
    yield "rig_file.md", _rig_file()
    yield "card_file.md", _card_file()
    yield "units.md", _units()
    yield "catalogues.md", _catalogues()
    yield "causes.md", _causes()
    yield from _rigs()


def copy_pictures(place: Path) -> None:
    """Put pages that stand beside their code, and what the pages of rigs show, where the generated pages are."""
    shutil.copy(CONTACT / "README.md", place / "contacts.md")
    shutil.copytree(CONTACT / "verification", place / "verification")
    rows = place / "verification" / "verification.md"
    rows.write_text(f"---\norphan: true\n---\n\n{rows.read_text(encoding='utf-8')}", encoding="utf-8")
    shutil.copy(METHODS / "README.md", place / "iso14179.md")
    for picture in (p for kind in ("*/*.svg", "*/*.png") for p in RIGS.glob(kind)):
        shutil.copy(picture, place / "rigs")


def toctree(names: Iterator[str] | list[str]) -> str:
    """The pages below a page."""
    return fenced("{toctree}", "\n".join([":hidden:", "", *names]))


# ------------------------------------------------------------------------------------------------- parts and laws


def _parts() -> Iterator[tuple[str, str]]:
    rows = [
        (f"[{kind}]({kind}.md)", cls.role, words(inspect.getdoc(cls)).split(". ")[0]) for kind, cls in PARTS.items()
    ]
    text = "What rigs are built of; `gearheat parts TYPE` prints the same.\n\n"
    yield "parts/index.md", f"# Part types\n\n{text}{table(('type', 'role', 'what it is'), rows)}{toctree(list(PARTS))}"
    for kind in PARTS:
        yield f"parts/{kind}.md", _part(kind)


def _part(kind: str) -> str:
    found = described(kind)
    told = (
        ("ports", ("name", "type", "carries", "doc")),
        ("parameters", ("name", "unit", "range", "default", "doc")),
        ("choices", ("name", "options", "default", "doc")),
        ("inputs", ("name", "unit", "range", "doc")),
        ("states", ("name", "unit", "range", "doc")),
        ("outputs", ("name", "unit", "doc")),
        ("laws", ("law", "where", "valid", "source")),
    )
    lists = [f"## {title.capitalize()}\n\n{listing(found[title], keys)}" for title, keys in told if found[title]]
    equations = "".join(f"- {words(name)}\n" for name in found["equations"])
    origin = f"values of the rig {found['example_from']}" if found["example_from"] else "typical sizes"
    return "\n".join(
        (
            f"# {kind}\n\n{words(found['doc'])}\n",
            *lists,
            f"## Equations\n\n{equations}",
            f"## Example\n\n{origin.capitalize()}:\n\n{fenced('toml', found['example'])}",
        )
    )


def _laws() -> Iterator[tuple[str, str]]:
    rows = Counter(row.law for row in golden_rows())
    for name in law_modules():
        body = "".join(_law(f, rows[f"{name}.{f.__name__}"]) for f in laws_of(name))
        about = words(inspect.getdoc(importlib.import_module(f"{laws.__name__}.{name}")))
        yield f"laws/{name}.md", f"# {title(name)}\n\n{about}\n\n{body}"
    titles = [f"- [{title(name)}]({name}.md)\n" for name in law_modules()]
    cited = [(code(s.key), words(s.author), words(s.year), words(s.title), words(s.where)) for s in sources().values()]
    about = "Each law is one formula of one source. `gearheat verify` compares its golden rows.\n\n"
    yield (
        "laws/index.md",
        f"# Laws\n\n{about}{''.join(titles)}\n## Sources\n\n"
        f"{table(('key', 'author', 'year', 'title', 'where'), cited)}{toctree(law_modules())}",
    )


def _law(function: Callable[..., Any], rows: int) -> str:
    law: LawInfo = function.law  # type: ignore[attr-defined]
    told = "".join(f"- {key}: {words(value)}\n" for key, value in facts(law, rows).items() if value)
    return f"## {law.name}\n\n{docstring(function)}{arguments(function)}{told}\n"


# ------------------------------------------------------------------------------------------------- files and units


def _rig_file() -> str:
    text, _, example = (inspect.getdoc(loading) or "").partition("\n\n")
    example, _, rest = example.partition("\n\nA source is")
    models: tuple[type[Strict], ...] = (RigTable, SensorTable, CampaignTable, ErratumTable)
    keys = "".join(
        f"## {words((model.__doc__ or '').splitlines()[0].rstrip('.'))}\n\n"
        + table(
            ("key", "needed", "meaning"),
            [(code(k), "yes" if f.is_required() else "", words(f.description)) for k, f in model.model_fields.items()],
        )
        for model in models
    )
    schema = "`gearheat schema -o rig.schema.json` writes the JSON schema with which editors complete and check it.\n\n"
    shown = fenced("toml", inspect.cleandoc(example))
    return f"# Rig file\n\n{words(text)} {schema}{shown}A source is {words(rest)}\n\n{keys}"


def _card_file() -> str:
    scenario = load("helical_two_stage")
    card = as_toml(default_card(scenario, usual_priors(scenario)))
    return f"# A card with every key\n\n`gearheat card helical_two_stage` writes it:\n\n{fenced('toml', card)}"


def _units() -> str:
    text = 'Values are text with a unit, `"62 mm"`; a bare number only where the unit is 1. Spellings that pint lacks:'
    rows = [(", ".join(code(s) for s in same), code(unit)) for unit, same in _grouped(SPELLINGS)]
    turns = [(", ".join(code(s) for s in same), code(unit)) for unit, same in _grouped({**PER_MINUTE, **ROTATIONS})]
    unclear = ", ".join(code(u) for u in UNCLEAR)
    return (
        f"# Units\n\n{text}\n\n{table(('written', 'read as'), rows)}Of rotational speeds alone:\n\n"
        f"{table(('written', 'read as'), turns)}Refused for a speed, which may mean radians: {unclear}.\n"
    )


def _grouped(spellings: dict[str, str]) -> list[tuple[str, list[str]]]:
    return [(unit, list(same)) for unit, same in groupby(spellings, key=lambda s: spellings[s])]


# ------------------------------------------------------------------------------------------- catalogues and rigs


def _catalogues() -> str:
    tables = "".join(
        f"## {kind}\n\n"
        + table(
            ("name", "what it is", "checked"),
            [
                (code(name), words(e.doc), words("; ".join(f"{k}: {v}" for k, v in e.checked.items())))
                for name, e in catalogue(kind).items()
            ],
        )
        for kind in FILES
    )
    return f"# Catalogues\n\n`gearheat list` prints them.\n\n{tables}"


def _rigs() -> Iterator[tuple[str, str]]:
    reproduces = list_rigs("reproduces")
    rows = [(f"[{name}]({name}.md)", words(doc), words(reproduces[name])) for name, doc in list_rigs().items()]
    about = (
        "A source that prints results is a rig of its own, as printed; the physical rig beside it takes no shortcut."
    )
    yield (
        "rigs/index.md",
        f"# Rigs\n\n{about}\n\n{table(('rig', 'what it is', 'reproduces'), rows)}{toctree(list(reproduces))}",
    )
    for name, doc in list_rigs().items():
        page = RIGS / name / "README.md"
        about = (
            f"{words(doc)}\n\nReproduces: {words(reproduces[name])}\n\n`gearheat show {name} --all` prints all of it.\n"
        )
        yield f"rigs/{name}.md", page.read_text(encoding="utf-8") if page.exists() else f"# {name}\n\n{about}"


def _causes() -> str:
    scenario = load("planetary")
    folder = RIGS / "planetary"
    card = read_card(folder / "card.json")
    data = read_campaign(folder / "measured.csv", scenario, card)
    roles = Roles.of(scenario.spec)
    oils = oils_of(scenario, card, list(data.oil))
    ranges = ranges_of(scenario.spec, roles, data, oils, scenario.operating_point)
    rows = [(code(c.id), words(c.doc), words(c.exposes)) for c in library(roles, ranges, data.sensors)]
    text = "What `gearheat diagnose` may name, here for the measured campaign of the rig `planetary`.\n\n"
    return f"# Causes\n\n{text}{table(('cause', 'what it is', 'what would show it'), rows)}"
