"""Components: declarations followed by named equations. `PARTS` holds every type of the physics, see `types.toml`."""

from importlib import import_module

from ..core.component import Component
from ..files import tables

PARTS: dict[str, type[Component]] = {
    name: getattr(import_module(f"{__name__}.{module}"), name)
    for name, module in tables("model.parts", "types.toml").items()
}


def __getattr__(name: str) -> type[Component]:
    """A type by its name, for imports."""
    if name not in PARTS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return PARTS[name]
