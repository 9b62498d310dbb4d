"""Imports go down only: every module may know the floors below its own, and nothing else of the project; no circles."""

import ast
from collections.abc import Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

from source_trees import ROOT, modules, nodes_of

#: Order of the floors, by the names under which they are installed below `gearheat`; those of one row stand side by
#: side.
ORDER = (
    ("model.units", "model.errors", "model.files", "model.sources", "model.expressions"),
    ("model.laws",),
    ("model.core",),
    ("model.parts",),
    ("model.machines", "model.contact"),
    ("model.run",),
    ("fmu", "scenarios"),
    ("tools.show",),
    ("tools.diagnose.library",),
    ("tools.diagnose.model",),
    ("tools.diagnose.infer",),
    ("tools.diagnose.setting",),
    ("tools.diagnose.answer",),
    ("tools.diagnose.report",),
    ("tools.diagnose", "tools.solve", "tools.check"),
    ("tools.describe", "tools.export", "tools.films", "tools.rating"),
    ("tools.build", "tools.compare", "tools.page", "tools.verify", "tools.docs", "tools.watch"),
    ("tools.bench", "api"),
    ("tools.desk",),
    ("tools.cli",),
    ("tools", "api.__main__"),
)
FLOORS = {name: floor for floor, names in enumerate(ORDER) for name in names}
#: Neighbours that do not know each other: laws and core meet in the parts, fmu and scenarios above them.
STRANGERS = [{"model.laws", "model.core"}, {"model.machines", "model.contact"}, {"fmu", "scenarios"}]


def installed(path: Path) -> str:
    """The dotted name of a file below `gearheat`, `__init__` included; the API is `gearheat` itself."""
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).replace("tools.api", "api", 1)


#: Dotted name -> file; of the API that which names what it imports.
MODULES = {installed(path): path for path in modules()} | {"api.__init__": ROOT / "tools" / "api" / "__init__.pyi"}


def floor_of(module: str) -> str:
    """The longest floor name a dotted module lies in, '' for none."""
    return max((f for f in FLOORS if module == f or module.startswith(f + ".")), key=len, default="")


def named(node: ast.AST, package: list[str]) -> list[tuple[str, str]]:
    """Module and name of each import of a statement, within the project; the name is '' where a module is meant."""
    if isinstance(node, ast.Import):
        found = [(a.name, "") for a in node.names]
    elif isinstance(node, ast.ImportFrom):
        base = ["gearheat", *package][: len(package) + 2 - node.level] if node.level else []
        stem = ".".join([*base, *([node.module] if node.module else [])])
        found = [(stem, a.name) for a in node.names]
    else:
        found = []
    return [(m.removeprefix("gearheat").removeprefix("."), n) for m, n in found if m.split(".")[0] == "gearheat"]


def module_of(stem: str, name: str) -> str:
    """The module that an import of a name reads; '' where there is none."""
    if not stem and f"{name}.__init__" not in MODULES:  # a public name
        return "api.__init__"
    full = f"{stem}.{name}".strip(".")
    return next((m for m in (full, f"{full}.__init__", stem, f"{stem}.__init__") if m in MODULES), "")


@cache
def imported(module: str) -> list[str]:
    """Modules of the project that a module imports. Raises AssertionError for one that does not exist."""
    found = []
    for node in nodes_of(MODULES[module]):
        for stem, name in named(node, [] if module.startswith("api.") else module.split(".")[:-1]):
            found.append(module_of(stem, name))
            assert found[-1], f"{module}: there is no module {stem}.{name}"
    return found


def problems(module: str) -> Iterator[str]:
    """What a module imports and should not."""
    own = floor_of(module)
    for name in imported(module):
        other = floor_of(name)
        if not other:
            yield f"{module}: imports {name}, which lies on no floor"
        elif own == other or FLOORS[other] == 0:  # units, errors, files and sources may know each other
            continue
        elif FLOORS[other] >= FLOORS[own]:
            yield f"{module}: {own} must not import {other}"
        elif {own, other} in STRANGERS:
            yield f"{module}: {own} and {other} do not know each other"


def test_imports_go_down() -> None:
    assert not [problem for module in MODULES for problem in problems(module)]


def room_of(module: str) -> str:
    """The room a module lies in, '' below the rooms and for the start of the program, which only calls the last."""
    if module == "api.__init__":
        return "api"
    return module.split(".")[1] if module.startswith("tools.") and module.count(".") > 1 else ""


def test_the_desk_knows_the_public_names_alone() -> None:
    known = {name for module in MODULES if module.startswith("tools.desk") for name in imported(module)}
    assert {name for name in known if not name.startswith("tools.desk")} == {"api.__init__"}


def test_rooms_stand_on_at_most_seven_levels() -> None:
    rooms: dict[str, set[str]] = {}
    for module in MODULES:
        rooms.setdefault(room_of(module), set()).update(map(room_of, imported(module)))
    levels = {"": 0}
    for room in TopologicalSorter({room: known - {room, ""} for room, known in rooms.items() if room}).static_order():
        levels[room] = 1 + max((levels[other] for other in rooms[room] - {room}), default=0)
    assert max(levels.values()) <= 7, levels  # the last is the program, which starts the desk


def test_the_diagnosis_stands_on_at_most_eleven_levels() -> None:
    own = {m: [o for o in imported(m) if o.startswith("tools.diagnose.")] for m in MODULES if "tools.diagnose." in m}
    levels: dict[str, int] = {}
    for module in TopologicalSorter(own).static_order():
        levels[module] = 1 + max((levels[other] for other in own[module]), default=0)
    assert levels["tools.diagnose.api"] <= 11


def circle(graph: dict[str, list[str]]) -> list[str]:
    """Modules that import each other in a circle; none where there is none."""
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def test_no_module_imports_itself_through_others() -> None:
    assert not circle({m: imported(m) for m in MODULES})


def test_a_circle_would_be_found() -> None:
    assert circle({"a": ["b"], "b": ["c"], "c": ["a"]})
