"""Imports go down only: every module may know the floors below its own, and nothing else of the project."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FLOORS = {
    "model.units": 0,
    "model.errors": 0,
    "model.files": 0,
    "model.sources": 0,
    "model.laws": 1,
    "model.core": 2,
    "model.parts": 3,
    "model.machines": 4,
    "model.contact": 4,
    "model.run": 5,
    "fmu": 6,
    "scenarios": 6,
    "tools": 7,
}
#: Neighbours that do not know each other: laws and core meet in the parts, fmu and scenarios in the tools.
STRANGERS = [{"model.laws", "model.core"}, {"model.machines", "model.contact"}, {"fmu", "scenarios"}]
MODULES = sorted(p for top in ("model", "fmu", "scenarios", "tools") for p in (ROOT / top).rglob("*.py"))


def floor_of(module: str) -> str:
    """The longest floor name a dotted module lies in, '' for none."""
    return max((f for f in FLOORS if module == f or module.startswith(f + ".")), key=len, default="")


def imported(path: Path) -> list[str]:
    """Project modules a file imports, dotted from the top folder."""
    package = path.relative_to(ROOT).with_suffix("").parts[:-1]
    found = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found += [a.name for a in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = list(package[: len(package) - node.level + 1]) if node.level else []
            stem = ".".join([*base, *(node.module or "").split(".")]).strip(".")
            found += [f"{stem}.{a.name}" for a in node.names]
    return [
        m.removeprefix("gearheat.")
        for m in found
        if m.removeprefix("gearheat.").split(".")[0] in ("model", "fmu", "scenarios", "tools")
    ]


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(ROOT)))
def test_imports_go_down(path: Path) -> None:
    own = floor_of(".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"))
    for module in imported(path):
        other = floor_of(module)
        assert other, f"{path}: imports {module}, which lies on no floor"
        if other == own:
            continue
        if FLOORS[other] == 0:  # units, errors, files and sources are one floor and may know each other
            continue
        assert FLOORS[other] < FLOORS[own], f"{path}: {own} must not import {other}"
        assert {own, other} not in STRANGERS, f"{path}: {own} and {other} do not know each other"
