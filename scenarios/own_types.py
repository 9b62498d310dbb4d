"""Part types of one's own, of installed packages and of modules that the user names."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import import_module
from importlib.metadata import entry_points

from ..model.core.component import Component
from ..model.errors import Problems, ScenarioError, suggestion

#: Entry points under which installed packages offer part types, "Cooler = my_package.parts:Cooler".
GROUP = "gearheat.parts"

#: Modules whose part types rig files may name.
_NAMED: set[str] = set()


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
            found[entry.name] = load_type(entry.value, {}, installed=True)
        except ScenarioError as error:
            problems += [f"package {entry.name}: {problem}" for problem in error.problems]
    problems += [
        f'package {n}: its class is "{c.__name__}". Give both one name.' for n, c in found.items() if n != c.__name__
    ]
    problems.check()
    return found


def use_parts(*modules: str) -> None:
    """Let rig files name the part types of modules, as "my_module:MyClass"; other modules they cannot name.

    Modules are looked for where Python looks, among what is installed and on PYTHONPATH, never beside the rig file.

    Args:
        modules: their names, such as "my_module"

    Example:
        >>> import gearheat as gh
        >>> gh.use_parts("my_module")
    """
    _NAMED.update(modules)


def load_type(kind: str, known: Mapping[str, type[Component]], *, installed: bool = False) -> type[Component]:
    """The class of one's own that "module:Class" names.

    Args:
        kind: as the rig file has it
        known: the classes of the project, by name
        installed: whether an installed package offers it; else the user has named the module, see `use_parts`

    Raises:
        ScenarioError: there is no such module or class, it fails, it is no part, or a part type has its name
    """
    module_name, _, name = kind.partition(":")
    if not all(word.isidentifier() for word in module_name.split(".")):
        raise ScenarioError(f'type "{kind}": names no module. Give module:Class.')
    if not (installed or module_name in _NAMED):
        raise ScenarioError(
            f'type "{kind}": a rig file runs no code of others. If you trust {module_name}, add --parts {module_name}.'
        )
    try:
        module = import_module(module_name)
    except ImportError as error:
        raise ScenarioError(
            f'type "{kind}": {error}. Install the package that has it, or put its folder on PYTHONPATH.'
        ) from None
    except (Exception, SystemExit) as error:  # a user's module may fail in any way
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
