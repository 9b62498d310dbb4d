"""What is the same in every FMU: files of the wrapper in C, and tables."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib.resources import files
from typing import Any


def wrapper(name: str) -> str:
    """Text of a file of the wrapper."""
    return (files("gearheat.fmu") / "wrapper" / name).read_text(encoding="utf-8")


@cache
def tables(name: str) -> dict[str, Any]:
    """The tables of a file."""
    return tomllib.loads((files("gearheat.fmu") / "tables" / f"{name}.toml").read_text(encoding="utf-8"))
