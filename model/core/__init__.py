"""The acausal machinery: declarations, connections, flattening. Knows no physics."""

from ..expressions import shorten

shorten()
