"""Diagnosis: measured data against the model, causes by name, the extended model and its measured gain."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .api import diagnose as diagnose
    from .api import plan as plan

__all__ = ["diagnose", "plan"]


def __getattr__(name: str) -> Any:
    """The public functions, imported when they are asked for: the commands start without the model."""
    if name in __all__:
        from . import api

        return getattr(api, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
