"""The C source of an FMU for FMI 3.0: the wrapper of FMI 2.0 in the words of 3.0, and what 3.0 has otherwise."""

from __future__ import annotations

import re
from importlib.resources import files

from .fixed import tables

#: Before the source of a shared library, whose functions have the names of the standard.
OF_LIBRARY = "#define FMI3_OVERRIDE_FUNCTION_PREFIX\n"

#: The standard's headers; an importer that compiles the source brings its own.
_HEADERS = ("fmi3PlatformTypes.h", "fmi3FunctionTypes.h", "fmi3Functions.h")

_TABLES = tables("wrapper")
_DEFINITION = re.compile(rf"^(fmi2\w+) ({'|'.join(_TABLES['inner'])})\(", re.MULTILINE)


def headers() -> dict[str, str]:
    """Name and text of the standard's headers, unmodified."""
    folder = files("fmpy") / "c-code"
    return {name: (folder / name).read_text(encoding="utf-8") for name in _HEADERS}


def include_header(name: str) -> str:
    """The beginning of the source: the standard's header, with names that no other FMU in a program has.

    Args:
        name: of the model, as an identifier
    """
    prefix = f"#ifndef FMI3_FUNCTION_PREFIX\n#define FMI3_FUNCTION_PREFIX {name}_\n#endif\n"
    return f'{prefix}#include "fmi3Functions.h"\n'


def in_words_of_3(text: str) -> str:
    """A file of the wrapper in the words of FMI 3.0.

    Args:
        text: of the file; one that is of FMI 3.0 stays as it is
    """
    text = _DEFINITION.sub(lambda found: f"static {found[1]} {_TABLES['inner'][found[2]]}(", text)
    for said, instead in _TABLES["said"].items():
        text = text.replace(said, instead)
    return re.sub(r"\bfmi2\w+", _word, text)


def _word(found: re.Match[str]) -> str:
    word = found[0]
    other = f"fmi3{word[4:]}".replace("FMUstate", "FMUState").replace("DeSerialize", "Deserialize")
    return str(_TABLES["words"].get(word, other))
