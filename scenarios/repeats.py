"""Repetition in rig files: tables that parts share, and names in braces that stand for several.

[template.ball]                               # what parts with `use = "ball"` have, unless they say otherwise
type = "DeepGrooveBallBearing"
K_rs = 3e-8

[part."input_bearing_{a,b}"]                  # two parts, input_bearing_a and input_bearing_b
use = "ball"
bearing = "SKF 6306"

[connect]
shaft = ["input.flange", "input_bearing_{a,b}.shaft"]                       # all of them meet
"load_{a,b}" = ["input_support.load_{a,b}", "input_bearing_{a,b}.load"]     # a net for each
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

from ..model.errors import ScenarioError, suggestion
from .document import ABOUT
from .shipped import FILES
from .values import UNCERTAINTIES

#: Keys of a part's table that hold tables: a part adds to those of its template.
ADDED = ("sources", UNCERTAINTIES)

#: Most names that one stands for, and most parts of a rig.
MOST = 10_000
#: Longest range of numbers [characters].
LONGEST = 30
_BRACES = re.compile(r"\{([^{}]*)\}")
_RANGE = re.compile(r"\s*(\d+)\s*\.\.\s*(\d+)\s*")


def options(text: str) -> list[str]:
    """What the first braces of a text stand for: "a,b" is two words, "1..3" three numbers; none without braces.

    Args:
        text: with or without braces

    Raises:
        ScenarioError: they stand for too many
    """
    match = _BRACES.search(text)
    if match is None:
        return []
    if ends := _RANGE.fullmatch(match[1]):
        if len(match[1]) > LONGEST or int(ends[2]) - int(ends[1]) >= MOST:
            raise ScenarioError(f'"{text[:60]}" stands for more than {MOST} names. Write fewer.')
        return [str(k) for k in range(int(ends[1]), int(ends[2]) + 1)]
    return [word.strip() for word in match[1].split(",")]


def spell_out(text: str) -> list[str]:
    """All that a text stands for, with any number of braces: "a_{1,2}" is "a_1" and "a_2".

    Args:
        text: with or without braces

    Raises:
        ScenarioError: they stand for too many
    """
    if not (found := options(text)):
        return [text]
    if math.prod(len(options(braces[0])) for braces in _BRACES.finditer(text)) > MOST:
        raise ScenarioError(f'"{text[:60]}" stands for more than {MOST} names. Write fewer.')
    return [whole for word in found for whole in spell_out(_BRACES.sub(word, text, count=1))]


def join_tables(base: Mapping[str, Any], own: Mapping[str, Any]) -> dict[str, Any]:
    """The table of a part over that which it builds on.

    Args:
        base: keys and values
        own: those that go before them
    """
    base = _attribute_values(base, own)
    both = [key for key in ADDED if isinstance(base.get(key), Mapping) and isinstance(own.get(key), Mapping)]
    return {**base, **own, **{key: {**base[key], **own[key]} for key in both}}


def _attribute_values(base: Mapping[str, Any], own: Mapping[str, Any]) -> Mapping[str, Any]:
    """The table a part builds on, its `source` told value by value where the part has a `source` for its own values."""
    if "source" not in own or not isinstance(singles := base.get("sources", {}), Mapping):
        return base
    kept = [key for key in base if key not in (*own, *ABOUT, *ADDED, *FILES, "type", "use")]
    default = {key: base["source"] for key in kept if "source" in base}
    return {**base, "sources": default | {key: text for key, text in singles.items() if key not in own}}


def expand(file: str, raw: Mapping[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """A rig file without templates and braces, and all that is wrong with these.

    Args:
        file: its name, for messages
        raw: what TOML makes of it
    """
    templates = raw.get("template", {})
    if not isinstance(templates, Mapping) or not all(isinstance(t, Mapping) for t in templates.values()):
        return dict(raw), [f"{file} [template]: is no table of tables. Write [template.NAME] for each."]
    problems = [
        f'{file} [template.{name}]: uses "{table["use"]}". A template holds values, it uses no other.'
        for name, table in templates.items()
        if "use" in table
    ]
    found = {key: value for key, value in raw.items() if key != "template"}
    if isinstance(parts := raw.get("part"), Mapping):
        found["part"] = {}
        for written, table in parts.items():
            whole = _use_template(f"{file} [part.{written}]", table, templates, problems)
            for name in spell_out(written):
                if name in found["part"]:
                    problems.append(f'{file} [part.{written}]: there is a part "{name}" already. Rename one.')
                found["part"][name] = whole
    if isinstance(connect := raw.get("connect"), Mapping):
        found["connect"] = {name: ports for written, own in connect.items() for name, ports in nets(written, own)}
    if isinstance(losses := raw.get("losses"), Mapping):
        found["losses"] = {column: flat(paths) for column, paths in losses.items()}
    return found, problems


def _use_template(where: str, table: Any, templates: Mapping[str, Any], problems: list[str]) -> Any:
    """The table of a part with what its template holds."""
    if not isinstance(table, Mapping) or "use" not in table:
        return table
    own = {key: value for key, value in table.items() if key != "use"}
    if (name := table["use"]) not in templates:
        close = suggestion(str(name), templates) or f" Templates: {', '.join(templates) or 'none'}."
        problems.append(f'{where}: there is no template "{name}".{close}')
        return own
    return join_tables(templates[name], own)


def flat(texts: Any) -> Any:
    """A list of texts as TOML has them with all that each stands for; what is no list stays."""
    if not isinstance(texts, list):
        return texts
    return [name for text in texts for name in (spell_out(text) if isinstance(text, str) else [text])]


def nets(written: str, ports: Any) -> list[tuple[str, Any]]:
    """The nets that a name in braces stands for: ports with as many options go with it one by one.

    Args:
        written: name of the net
        ports: that meet
    """
    spell_out(written)  # refuses too many
    if not (own := options(written)):
        return [(written, flat(ports))]
    found = []
    for k, word in enumerate(own):
        mine = ports
        if isinstance(ports, list):
            mine = [
                _BRACES.sub(theirs[k], port, count=1)
                if isinstance(port, str) and len(theirs := options(port)) == len(own)
                else port
                for port in ports
            ]
        found += nets(_BRACES.sub(word, written, count=1), mine)
    return found
