"""TOML files as users write them: read with the line of a syntax error, and values without a source found."""

from __future__ import annotations

import re
import tomllib
from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from collections.abc import Container, Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from ..model.errors import GearheatError, ScenarioError, suggestion, visible
from ..model.files import reading

#: Kinds of source beside a citation ("Dias2014, table 5.7"): they need a reason behind the colon.
SOURCE_KINDS = ("assumed", "inferred", "calibrated")
#: Those of values that data gave.
FROM_DATA = SOURCE_KINDS[1:]

#: Keys of a table of values that are not values.
ABOUT = ("doc", "source", "sources")

#: Marks that UTF-16 begins with, as Excel and PowerShell write it.
WIDE = (BOM_UTF16_LE, BOM_UTF16_BE)
#: What no text has.
_BINARY = re.compile(r"[\x00-\x08\x0e-\x1a]")


def read_text(path: Path, kind: str, refused: type[GearheatError], encodings: Sequence[str] = ("utf-8-sig",)) -> str:
    """The text of a file, without the mark some programs put before UTF-8; one that is marked as UTF-16 is that.

    Args:
        path: the file
        kind: what it should be, for messages: "TOML", "CSV"
        refused: class of the error
        encodings: that it may have, the surest first

    Raises:
        GearheatError: of that class: there is no such file, it is no text, or it cannot be read
    """
    try:
        raw = reading(path).read_bytes()
        encodings = ("utf-16",) if raw.startswith(WIDE) else encodings
        for encoding in encodings:
            with suppress(UnicodeDecodeError):
                text = raw.decode(encoding).replace("\r\n", "\n").replace("\r", "\n")
                if encoding == encodings[0] or not _BINARY.search(text):
                    return text
    except FileNotFoundError:
        raise refused(f"{path}: there is no such file. Check the path.") from None
    except IsADirectoryError:
        raise refused(f"{path}: is a folder. Give a {kind} file.") from None
    except OSError as error:
        raise refused(f"{path}: cannot be read ({error.strerror}). Give a {kind} file.") from None
    raise refused(f"{path.name}: is not UTF-8 text. Save it as a {kind} file.")


def read_toml(path: Path) -> dict[str, Any]:
    """The tables of a file. Raises ScenarioError naming the line of a syntax error."""
    text = read_text(path, "TOML", ScenarioError)
    try:
        found: dict[str, Any] = shown(tomllib.loads(text))
        return found
    except tomllib.TOMLDecodeError as error:
        raise ScenarioError(_syntax_problem(path.name, text, str(error))) from None
    except ValueError:  # of Python, which reads no integer of thousands of digits
        raise ScenarioError(f"{path.name}: a number has too many digits. Write it with an exponent.") from None
    except RecursionError:
        raise ScenarioError(f"{path.name}: its lists or tables lie too deep in each other. Write them flat.") from None


def shown(value: Any) -> Any:
    """A value of a file, with what cannot be seen in its texts written as escapes.

    Args:
        value: text, number, list or table
    """
    if isinstance(value, str):
        return visible(value)
    if isinstance(value, list):
        return [shown(item) for item in value]
    return {visible(key): shown(item) for key, item in value.items()} if isinstance(value, dict) else value


def _syntax_problem(name: str, text: str, message: str) -> str:
    what, _, where = message.partition(" (at ")
    found = re.match(r"line (\d+)", where)
    lines = text.splitlines()
    line = int(found[1]) if found else len(lines)
    shown = lines[line - 1].strip() if 0 < line <= len(lines) else ""
    remedy = 'Write key = "62 mm": values with a unit stand in quotation marks.'
    if what.startswith(("Cannot overwrite", "Cannot declare")):
        remedy = "It stands in the file twice. Keep one."
    return f"{name} line {line}: TOML syntax, {what[:1].lower()}{what[1:]}: {shown}\n{remedy}"


def paths(table: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """The entries of a table by dotted path, whether written `"carrier.w" = ...` or `carrier.w = ...`."""
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from ((f"{key}.{rest}", leaf) for rest, leaf in paths(value))
        else:
            yield key, value


def sources_of(where: str, table: Mapping[str, Any], known: Container[str] = ()) -> tuple[dict[str, str], list[str]]:
    """Source of each value of a table, its own in `sources` or the table's `source`; and what is wrong with them.

    Args:
        where: place of the table, for messages
        table: the table with its `source` and `sources`
        known: keys that may have a source although the table has no value for them
    """
    keys = [key for key, _ in paths({k: v for k, v in table.items() if k not in ABOUT})]
    default, given = table.get("source"), table.get("sources", {})
    if not isinstance(given, Mapping):
        return {}, [
            f'{where}: sources = {given!r} is no table. Write sources = {{ {keys[0] if keys else "key"} = "..." }}.'
        ]
    single = dict(paths(given))
    problems = [
        f'{where}: sources names "{key}", which has no value here.{suggestion(key, keys)}'
        for key in single
        if key not in keys and key not in known
    ]
    written = ([] if default is None else [("source", default)]) + [(f'source of "{k}"', t) for k, t in single.items()]
    problems += [f"{where}: {name} {problem}" for name, text in written if (problem := _source_problem(text))]
    if default is None and (bare := [key for key in keys if key not in single]):
        problems.append(
            f"{where}: no source is given for {', '.join(bare)}."
            ' Add source = "..." (a citation, or "assumed: reason") to the table.'
        )
    return {key: str(single.get(key, default)) for key in keys}, problems


def _source_problem(text: object) -> str | None:
    if not isinstance(text, str) or not text.strip():
        return f'is {text!r}. Write a citation such as "Dias2014, table 5.7", or "assumed: reason".'
    kind, colon, reason = text.partition(":")
    if kind.strip() in SOURCE_KINDS and not (colon and reason.strip()):
        return f'is "{text}" without a reason. Write "{kind.strip()}: why".'
    return None
