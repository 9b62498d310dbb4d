"""Modules stay below 400 lines, bodies of functions below 60, of laws below 13 lines; functions take few parameters."""

import ast
from collections.abc import Iterator
from pathlib import Path

from source_trees import ROOT, modules, name_of, nodes_of, text_of


def functions(path: Path) -> Iterator[ast.FunctionDef]:
    """All functions of a module, methods and nested ones as well."""
    return (node for node in nodes_of(path) if isinstance(node, ast.FunctionDef))


def body_lines(function: ast.FunctionDef) -> int:
    """Lines of what a function does, without its arguments and its docstring."""
    body = [n for n in function.body if not (isinstance(n, ast.Expr) and isinstance(n.value, ast.Constant))]
    return body[-1].end_lineno - body[0].lineno + 1 if body else 0


def parameters(function: ast.FunctionDef) -> int:
    """How many a caller has to know: options by name, which have a default, and `self` are not counted."""
    own = function.args
    given = [
        *own.posonlyargs,
        *own.args,
        *(a for a, d in zip(own.kwonlyargs, own.kw_defaults, strict=True) if d is None),
    ]
    return len([a for a in given if a.arg not in ("self", "cls")])


def test_no_module_is_longer_than_400_lines() -> None:
    lengths = {name_of(path): len(text_of(path).splitlines()) for path in modules()}
    assert not {name: length for name, length in lengths.items() if length > 400}


def test_no_function_is_longer_than_60_lines() -> None:
    assert not [
        f"{name_of(path)}: {function.name} is too long"
        for path in modules()
        for function in functions(path)
        if body_lines(function) >= 60
    ]


def test_the_diagnosis_has_at_most_13024_lines_of_python_and_c() -> None:
    sources = [*modules("tools/diagnose"), *(ROOT / "tools/diagnose").rglob("*.c")]
    assert sum(len(path.read_text(encoding="utf-8").splitlines()) for path in sources) <= 13024


def test_no_function_of_the_diagnosis_takes_more_than_six_parameters() -> None:
    assert not [
        f"{name_of(path)}: {function.name} takes {parameters(function)}"
        for path in modules("tools/diagnose")
        for function in functions(path)
        if parameters(function) > 6
    ]


def test_no_body_of_a_law_is_longer_than_12_lines() -> None:
    assert not [
        f"{name_of(path)}: the body of law {function.name} has {body_lines(function)} lines"
        for path in modules("model/laws")
        for function in functions(path)
        if any("law" in ast.dump(d) for d in function.decorator_list) and body_lines(function) > 12
    ]
