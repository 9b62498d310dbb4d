"""Pure cited functions, one formula of one source each."""

from ..expressions import shorten

shorten()
