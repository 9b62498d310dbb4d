"""Docstrings of the public functions of model, fmu and scenarios: what goes in, in which unit, and what is raised."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from source_trees import modules, name_of, tree_of

Function = ast.FunctionDef | ast.AsyncFunctionDef


def public(tree: ast.Module) -> Iterator[tuple[str, Function, bool]]:
    """Name, node and whether it is a method, of every public function and method of a module."""
    for node in tree.body:
        if isinstance(node, Function) and not node.name.startswith("_"):
            yield node.name, node, False
        elif isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            for member in node.body:
                if isinstance(member, Function) and not member.name.startswith("_"):
                    yield f"{node.name}.{member.name}", member, True


def decorated(node: Function, name: str) -> bool:
    """Whether a decorator of that name stands above it."""
    return any(
        isinstance(n, ast.Name | ast.Attribute) and name in ast.unparse(n)
        for d in node.decorator_list
        for n in ast.walk(d)
    )


def parameters(node: Function, method: bool) -> list[str]:
    """Names of what is given to it, without self."""
    a = node.args
    names = [p.arg for p in (*a.posonlyargs, *a.args, *a.kwonlyargs)]
    return names[1:] if method and not decorated(node, "staticmethod") else names


def section(doc: str, title: str) -> str:
    """The text below a title, up to the next one."""
    found = re.search(rf"^{title}:\n((?:[ \t]+.*\n|\n)*)", doc + "\n", re.MULTILINE)
    return found[1] if found else ""


def described(text: str) -> dict[str, str]:
    """Name -> description, of a section; "a, b: both" describes two."""
    entries: dict[str, str] = {}
    for names, doc in re.findall(r"^ {4}([\w, *]+):(.*(?:\n {5,}.*)*)", text, re.MULTILINE):
        entries |= {name.strip(" *"): doc for name in names.split(",")}
    return entries


def raised(node: Function) -> set[str]:
    """Names of the errors that are made and raised in its own body, except for those of nested functions."""
    found: set[str] = set()
    todo: list[ast.AST] = list(node.body)
    while todo:
        n = todo.pop()
        if isinstance(n, Function | ast.Lambda | ast.ClassDef):
            continue
        if isinstance(n, ast.Raise) and isinstance(n.exc, ast.Call):
            found.add(ast.unparse(n.exc.func).rpartition(".")[2])
        todo += ast.iter_child_nodes(n)
    return {name for name in found if name.endswith("Error")}


def abstract(node: Function) -> bool:
    """Whether a subclass has to write it: there is nothing but an error below its docstring."""
    return len(node.body) == 2 and isinstance(node.body[1], ast.Raise)


def problems(path: Path) -> list[str]:
    """What the docstrings of a module do not say."""
    found = []
    for function, node, method in public(tree_of(path)):
        name = f"{name_of(path)}: {function}"
        doc = ast.get_docstring(node) or ""
        if abstract(node):
            continue
        given, args = parameters(node, method), described(section(doc, "Args"))
        if len(given) >= 2 or decorated(node, "law"):
            found += [f"{name}: Args does not describe {p}" for p in given if p not in args]
        if decorated(node, "law"):
            found += [f"{name}: {p} has no [unit]" for p in given if not UNIT.search(args.get(p, "[1]"))]
        found += [f"{name}: Raises does not name {e}" for e in sorted(raised(node)) if e not in raises(doc)]
    return found


#: A unit in brackets, or the catalogue's own; a choice of the law, described as "whether ...", has none.
UNIT = re.compile(r"\[[^\]]+\]|in its units|^ whether ")


def raises(doc: str) -> str:
    """What a docstring says of errors: a section, or a sentence "Raises ScenarioError ..." where it is one line."""
    sentences = re.findall(r"Raises [^\n]*", doc)
    return section(doc, "Raises") + " ".join(sentences)


def test_docstrings_say_what_goes_in_and_what_is_raised() -> None:
    public_modules = [path for path in modules("model", "fmu", "scenarios") if not path.name.startswith("_")]
    assert public_modules
    assert not [problem for path in public_modules for problem in problems(path)]
