"""Heat radiation between a housing and the room, and that of the sun."""

from __future__ import annotations

from ..sources import law
from .smooth import Num

#: Stefan-Boltzmann constant [W/(m2.K4)].
SIGMA = 5.670374419e-8


@law(
    source="Incropera2007", where="radiation between a surface and large surroundings", valid="grey surface, large room"
)
def radiated(T_1: Num, T_2: Num, A: Num, emissivity: Num) -> Num:
    r"""Net heat flow rate [W] from a surface to the room around it.

    .. math:: \dot Q = \sigma \varepsilon A (T_1^4 - T_2^4)

    Args:
        T_1: temperature of the surface [K]
        T_2: temperature of the room's walls [K]
        A: area of the surface [m2]
        emissivity: emissivity of the surface [1]
    """
    return SIGMA * emissivity * A * (T_1**4 - T_2**4)


@law(source="Vasic2022", where="eq 16, temperatures in K", valid="grey surface, large room", verified=False)
def radiation_coefficient(T_1: Num, T_2: Num, emissivity: Num) -> Num:
    r"""Radiated heat over area and temperature difference [W/(m2.K)].

    .. math:: h = \sigma \varepsilon (T_1^2 + T_2^2)(T_1 + T_2)

    Args:
        T_1: temperature of the surface [K]
        T_2: temperature of the room's walls [K]
        emissivity: emissivity of the surface [1]
    """
    return SIGMA * emissivity * (T_1**2 + T_2**2) * (T_1 + T_2)


@law(source="Holman2010", where="solar radiation, Example 8-20", valid="opaque surface", verified=False)
def absorbed_sun(G: Num, A: Num, absorptivity: Num) -> Num:
    r"""Heat flow rate [W] that a surface takes from the sun.

    .. math:: \dot Q = \alpha_s G A

    Args:
        G: irradiance by sun and sky on a plane across the rays [W/m2]
        A: area of the shadow that the surface casts on that plane [m2]
        absorptivity: absorptivity of the surface for sunlight; not its emissivity, which is that of long waves [1]
    """
    return absorptivity * G * A
