"""Losses and temperatures of gearboxes: simulate, design, export as FMU, compare with measurements, diagnose.

    import gearheat as gh

    rig = gh.load("planetary")
    hot = gh.steady(rig, {"room.T": "35 degC"})
    hot["oil.T"], hot.to("oil.T", "degC"), hot.losses()

Names are imported when they are asked for, so that `import gearheat` takes no time; which there are stands in
`__init__.pyi`.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any


def _read_names() -> Iterator[tuple[str, tuple[str, str]]]:
    """Each public name, the module that has it, and its name there."""
    found: dict[str, tuple[str, str]] = {}
    for line in ast.parse(Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8")).body:
        if isinstance(line, ast.ImportFrom) and line.module:
            found |= {a.name: (line.module, a.name) for a in line.names}
        elif isinstance(line, ast.Assign):
            yield ast.unparse(line.targets[0]), found.pop(ast.unparse(line.value))
    yield from found.items()


#: Public name -> module that has it, and its name there.
PUBLIC = dict(sorted(_read_names(), key=lambda named: named[0].lower()))

__all__ = list(PUBLIC)


def __getattr__(name: str) -> Any:
    """A public name, imported when it is asked for."""
    if name not in PUBLIC:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module, own = PUBLIC[name]
    return getattr(import_module(f".{module}", __name__), own)


def __dir__() -> list[str]:
    """The public names."""
    return __all__
