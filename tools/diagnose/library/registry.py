"""All causes of a machine and a campaign."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ..campaign.table import Sensor
from . import cooling, losses
from . import sensors as instruments
from .cause import Cause, Ranges
from .roles import Roles

FAMILIES = (losses.causes, cooling.causes, instruments.causes)


def library(
    roles: Roles, ranges: Ranges, sensors: Sequence[Sensor], extra_files: Sequence[Path] = ()
) -> tuple[Cause, ...]:
    """All causes that the machine and its instruments allow, in the order of the taxonomy.

    Args:
        roles: of the machine
        ranges: of the data
        sensors: of the campaign
        extra_files: files of the user that define `causes(roles, ranges, sensors)`
    """
    return tuple(cause for family in FAMILIES for cause in family(roles, ranges, sensors))
