"""Parts that tell their contacts in numbers: a table over the mesh cycle, single contacts, and the cycle's moments."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import Any, Protocol, runtime_checkable

from ..core.component import Component, Related
from ..laws.film_map import FilmMap
from ..laws.smooth import Num


@dataclass(frozen=True)
class ContactTable:
    """Contacts of a part at one operating point.

    Args:
        rows: a mapping of column to value per contact, in the order of the mesh cycle; SI units but for degrees
        columns: column -> what it is
        totals: what holds for all contacts together, by name
        cycle: the way of one contact through its load
    """

    rows: Sequence[Mapping[str, float]]
    columns: Mapping[str, str]
    totals: Mapping[str, Any]
    cycle: Sequence[ContactCase] = ()


@dataclass(frozen=True)
class FilmContact:
    """The contact of a part at an operating point, as a film map needs it; the oil is that of the part's lubricant.

    Args:
        F: normal force [N]
        R_x: reduced radius along the direction of rolling [m]
        length: of a line contact [m]
        u_1: speed of the first surface through the contact [m/s]
        u_2: speed of the second surface through the contact [m/s]
        E_eff: effective modulus [Pa]
        sigma: composite roughness [m]
        mu_boundary: friction coefficient of touching surfaces [1]; None where the part has none
        R_y: reduced radius across the direction of rolling [m]
    """

    F: float
    R_x: float
    length: float
    u_1: float
    u_2: float
    E_eff: float
    sigma: float
    mu_boundary: float | None = None
    R_y: float = inf


@dataclass(frozen=True, kw_only=True)
class ContactCase(FilmContact):
    """A contact at one moment of a mesh cycle, with the oil that it finds.

    Args:
        time: since the load begins [s]
        theta: angle of the cycle [rad]
        eta_0: dynamic viscosity at ambient pressure [Pa.s]
        alpha_p: pressure-viscosity coefficient [1/Pa]
    """

    time: float
    theta: float
    eta_0: float
    alpha_p: float


#: How far the modulus of a part may be from that of its film map, relative.
MODULUS_LEFT = 0.05


def fits_map(part: Component, film: FilmMap, E_eff: Num) -> Related:
    """The film map of a part is one of its own contact: of the same modulus, and of a line.

    Args:
        part: whose film it is
        film: the map
        E_eff: effective modulus of the part [Pa]
    """
    ratio = E_eff / film.E_eff if film.shape == "line" else 0.0
    return part.relation(
        f"{film.name} is a map of this contact",
        "effective modulus over that of the map's line contacts",
        ratio,
        1 - MODULUS_LEFT,
        1 + MODULUS_LEFT,
        remedy=f"Make the map of this part: gearheat film RIG --part {part.name}.",
    )


@runtime_checkable
class TellsFilmContact(Protocol):
    """A part whose film may come from a map."""

    name: str

    def film_contact(self, values: Mapping[str, float]) -> FilmContact:
        """Its contact, by parameters and outputs of the part at an operating point, by key, in SI."""
        ...


@runtime_checkable
class TellsContacts(Protocol):
    """A part that tells its contacts over a mesh cycle in numbers."""

    name: str

    def contact_table(self, values: Mapping[str, float]) -> ContactTable:
        """All contacts over a mesh cycle, by parameters and outputs of the part at an operating point in SI."""
        ...
