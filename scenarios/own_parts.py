"""Part types of one's own: `type = "my_package.parts:Cooler"` in a rig file is a class of an importable module.

Modules are looked for where Python looks, among what is installed and on PYTHONPATH, never beside the rig file: a rig
file of somebody else brings no code of its own.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import import_module
from importlib.metadata import entry_points

from ..model.core.component import Component
from ..model.errors import Problems, ScenarioError, suggestion

#: Entry points under which installed packages offer part types, "Cooler = my_package.parts:Cooler".
GROUP = "gearheat.parts"


@cache
def load_installed_types() -> dict[str, type[Component]]:
    """Part types of installed packages, by name.

    Raises:
        ScenarioError: all that cannot be loaded, is no part or has another name than its class
    """
    found: dict[str, type[Component]] = {}
    problems = Problems()
    for entry in sorted(entry_points(group=GROUP), key=lambda e: e.name):
        try:
            found[entry.name] = load_type(entry.value, {})
        except ScenarioError as error:
            problems += [f"package {entry.name}: {problem}" for problem in error.problems]
    problems += [
        f'package {n}: its class is "{c.__name__}". Give both one name.' for n, c in found.items() if n != c.__name__
    ]
    problems.check()
    return found


def load_type(kind: str, known: Mapping[str, type[Component]]) -> type[Component]:
    """The class that "module:Class" names.

    Args:
        kind: as the rig file has it
        known: the classes of the project, by name

    Raises:
        ScenarioError: there is no such module or class, it fails, it is no part, or a part type has its name
    """
    module_name, _, name = kind.partition(":")
    if not all(word.isidentifier() for word in module_name.split(".")):
        raise ScenarioError(f'type "{kind}": names no module. Give module:Class.')
    try:
        module = import_module(module_name)
    except ImportError as error:
        raise ScenarioError(
            f'type "{kind}": {error}. Install the package that has it, or put its folder on PYTHONPATH.'
        ) from None
    except Exception as error:  # a user's module may fail in any way
        raise ScenarioError(f'type "{kind}": {module_name} fails: {type(error).__name__}: {error}.') from error
    cls = getattr(module, name, None)
    if not (isinstance(cls, type) and issubclass(cls, Component)):
        parts = [n for n, c in vars(module).items() if isinstance(c, type) and issubclass(c, Component)]
        close = suggestion(name, parts) or f" Its parts: {', '.join(parts) or 'none'}."
        raise ScenarioError(f'type "{kind}": {module_name} has no part "{name}".{close}')
    if known.get(cls.__name__, cls) is not cls:
        raise ScenarioError(
            f'type "{kind}": there is a part type "{cls.__name__}" already. Give the class another name.'
        )
    return cls
