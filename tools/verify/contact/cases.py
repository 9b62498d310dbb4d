"""Reference data of contacts, and the contacts that belong to them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ....model.contact import Contact, Lubricant
from ....model.files import tables

#: The oil and the steel of contacts that are given by numbers without a unit; the radius cancels out.
OIL = Lubricant(eta_0=0.04, alpha_p=2.2e-8)
SIMPLE_OIL = Lubricant(eta_0=0.04, alpha_p=2.2e-8, piezoviscous="barus", compressible=False)
E_STEEL = 2.26e11
RADIUS = 0.01


@dataclass(frozen=True)
class Reference:
    """One file of reference data.

    Args:
        source: key of the source, or how it was computed
        where: place in the source
        rel: distance from it that is accepted, 0 where it is only reported
        rows: one mapping a case
        more: everything else that the file says
    """

    source: str
    where: str
    rel: float
    rows: Sequence[Mapping[str, Any]]
    more: Mapping[str, Any]


def reference(name: str) -> Reference:
    """The reference data of a name."""
    held = tables("model.contact", "reference", f"{name}.toml")
    rows = [dict(zip(held["columns"], row, strict=True)) for row in held["rows"]]
    return Reference(held["source"], held["where"], held.get("rel", 0.0), rows, held)


def circular(M: float, L: float) -> tuple[Contact, float]:
    """A circular contact of the oil and the steel above, and U by the numbers of Moes.

    Args:
        M: load number [1]
        L: lubricant number [1]
    """
    U = (L / (OIL.alpha_p * E_STEEL)) ** 4
    u = U * E_STEEL * RADIUS / OIL.eta_0 / 2
    F = M * E_STEEL * RADIUS**2 * U**0.75
    return Contact(F=F, R_x=RADIUS, R_y=RADIUS, u_1=u, u_2=u, E_eff=E_STEEL, lubricant=OIL), U


def line(M: float, L: float) -> tuple[Contact, float]:
    """A line contact of 1 m by the numbers of Moes, and U.

    Args:
        M: load number [1]
        L: lubricant number [1]
    """
    U = (L / (OIL.alpha_p * E_STEEL)) ** 4
    u = U * E_STEEL * RADIUS / OIL.eta_0 / 2
    F = M * E_STEEL * RADIUS * U**0.5
    return Contact(F=F, R_x=RADIUS, u_1=u, u_2=u, E_eff=E_STEEL, lubricant=OIL), U


def elliptical(U: float, W: float, G: float, k: float) -> Contact:
    """An elliptical contact by the numbers of Hamrock and Dowson.

    Args:
        U: speed number with the mean speed [1]
        W: load number [1]
        G: material number [1]
        k: ellipticity [1]
    """
    E = G / OIL.alpha_p
    u, R_y = U * E * RADIUS / OIL.eta_0, RADIUS * (k / 1.03) ** (1 / 0.64)
    return Contact(F=W * E * RADIUS**2, R_x=RADIUS, R_y=max(R_y, RADIUS), u_1=u, u_2=u, E_eff=E, lubricant=OIL)
