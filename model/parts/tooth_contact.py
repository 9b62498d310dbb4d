"""The contact of two teeth."""

from __future__ import annotations

from dataclasses import dataclass

from ..laws.smooth import Num


@dataclass(frozen=True)
class ToothContact:
    """One tooth contact at its pitch point: what does not depend on speed and load.

    `rho` radius of curvature of the first gear [m], `R` reduced radius normal to the teeth [m], `l` length of the
    lines of contact [m], `base` and `normal` base tangential and normal force over tangential force [1].
    """

    rho: Num
    R: Num
    l: Num  # noqa: E741
    base: Num
    normal: Num
