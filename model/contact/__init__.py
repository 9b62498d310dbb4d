"""Mixed elastohydrodynamic contacts solved on a grid (numpy and scipy, no CasADi): the source of film maps."""

from .case import Contact, Lubricant

__all__ = ["Contact", "Lubricant"]
