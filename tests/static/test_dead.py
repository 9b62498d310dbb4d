"""Nothing dead: what a module defines, the source, a list of part types or an example uses; tests do not count."""

import ast
import re
from collections import Counter
from itertools import chain

import gearheat as gh
from gearheat.model.parts import PARTS
from gearheat.tools.docs.blocks import blocks
from source_trees import ROOT, modules, name_of, nodes_of

#: Decorators that register what they decorate: commands of the program, checks of a file's table.
REGISTERED = ("command", "field_validator", "model_validator")
#: Python examples of the pages: what is offered to users.
EXAMPLES = [
    block.text
    for page in (ROOT / "tools" / "docs" / "pages").rglob("*.md")
    for block in blocks(page.read_text("utf-8"))
    if block.language == "python"
]
#: Laws by the rows of published numbers that `gearheat verify` calls them for.
VERIFIED = re.findall(
    r'^law = "\w+\.(\w+)"$',
    "\n".join(p.read_text("utf-8") for p in sorted((ROOT / "scenarios" / "rigs").glob("*/published.toml"))),
    re.MULTILINE,
)
#: What is offered to users of the library beyond that.
OFFERED = {"model/run/search.py: sensitivities", "model/laws/film_point.py: nijenbanning_central"}
#: Methods of results that notebooks and users call.
METHODS = {"_repr_html_", "to_pandas", "to_xarray"}


def used() -> Counter[str]:
    """How often each name is read or imported; its definition does not count."""
    names = Counter([*VERIFIED, *PARTS, *(name for _, name in gh.PUBLIC.values())])
    for node in chain(*map(nodes_of, modules()), *(ast.walk(ast.parse(example)) for example in EXAMPLES)):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load):
            names[node.id] += 1
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Load):
            names[node.attr] += 1
    return names


def registered(node: ast.FunctionDef | ast.ClassDef) -> bool:
    """Whether a decorator hands it to somebody who calls it."""
    return any(word in ast.dump(d) for d in node.decorator_list for word in REGISTERED)


def test_every_function_and_class_is_used() -> None:
    names = used()
    defined = [
        (path, node)
        for path in modules()
        for node in nodes_of(path)
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and not registered(node)
    ]
    dead = {
        f"{name_of(path)}: {node.name}"
        for path, node in defined
        if names[node.name] == 0 and node.name not in METHODS and not node.name.startswith("__")
    }
    assert dead <= OFFERED, f"nobody uses {sorted(dead - OFFERED)}. Remove it, or use it."
