"""One named constant a line: none packed into tuples, so that each has its unit, meaning and reason."""

import ast

from source_trees import modules, name_of, nodes_of


def is_packed(node: ast.AST) -> bool:
    """Whether an assignment gives several constants their values."""
    targets = node.targets if isinstance(node, ast.Assign) else []
    names = [n for t in targets if isinstance(t, ast.Tuple) for n in t.elts if isinstance(n, ast.Name)]
    return any(n.id.strip("_").isupper() and len(n.id.strip("_")) > 1 for n in names)


def test_constants_stand_one_a_line() -> None:
    trees = {path: [n for n in nodes_of(path) if isinstance(n, ast.Module | ast.ClassDef)] for path in modules()}
    bodies = [(path, node) for path, owners in trees.items() for owner in owners for node in owner.body]
    assert not [f"{name_of(path)} line {node.lineno}" for path, node in bodies if is_packed(node)]
