"""Modules stay below 400 lines, functions below 60, law bodies below 13, inheritance below three levels of its own."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MODULES = sorted(p for top in ("model", "fmu", "scenarios", "tools") for p in (ROOT / top).rglob("*.py"))


def functions(path: Path) -> list[ast.FunctionDef]:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return [n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef)]


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(ROOT)))
def test_sizes(path: Path) -> None:
    assert len(path.read_text(encoding="utf-8").splitlines()) <= 400
    for function in functions(path):
        assert function.end_lineno - function.lineno < 60, f"{path}: {function.name} is too long"


@pytest.mark.parametrize("path", sorted((ROOT / "model/laws").glob("*.py")), ids=lambda p: p.name)
def test_law_bodies(path: Path) -> None:
    for function in functions(path):
        if not any("law" in ast.dump(d) for d in function.decorator_list):
            continue
        body = [n for n in function.body if not (isinstance(n, ast.Expr) and isinstance(n.value, ast.Constant))]
        length = body[-1].end_lineno - body[0].lineno + 1
        assert length <= 12, f"{path}: the body of law {function.name} has {length} lines"
