"""The modules of the project and their syntax trees, each read and parsed once for all static tests."""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1]
#: Folders of the packages.
TOPS = ("model", "fmu", "scenarios", "tools")


def modules(*tops: str) -> list[Path]:
    """Files of the modules below some folders, all packages without any, in the order of their names."""
    return [path for top in tops or TOPS for path in sorted((ROOT / top).rglob("*.py"))]


@cache
def text_of(path: Path) -> str:
    """What a file holds."""
    return path.read_text(encoding="utf-8")


@cache
def tree_of(path: Path) -> ast.Module:
    """The syntax tree of a module."""
    return ast.parse(text_of(path))


@cache
def nodes_of(path: Path) -> tuple[ast.AST, ...]:
    """All nodes of the tree of a module, outer ones first."""
    return tuple(ast.walk(tree_of(path)))


def name_of(path: Path) -> str:
    """A file as problems name it: its place in the checkout."""
    return path.relative_to(ROOT).as_posix()
