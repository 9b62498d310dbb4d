"""Components: declarations followed by named equations. `PARTS` holds every type of the physics, see `types.toml`."""

import tomllib
from importlib import import_module
from importlib.resources import files

from ..core.component import Component

_MODULES: dict[str, str] = tomllib.loads(files(__name__).joinpath("types.toml").read_text(encoding="utf-8"))

PARTS: dict[str, type[Component]] = {
    name: getattr(import_module(f"{__name__}.{module}"), name) for name, module in _MODULES.items()
}


def __getattr__(name: str) -> type[Component]:
    """A type by its name, for imports."""
    if name not in PARTS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return PARTS[name]
